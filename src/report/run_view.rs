//! A run that is played, zoomed and read off in a page: what the page's script is given.
//!
//! The script (`page/run.js`) draws and does nothing else: where wheel and ground are is worked out
//! here, for every frame.

use super::ReportError;
use super::channel_groups::{
    GROUPS, Group, MOTION, drawable, is_drawable, remarks_on_channels, time_range,
};
use super::class_strip::{class_colour, class_name, merged};
use super::envelope::envelope;
use super::figure::PALETTE;
use super::packed::packed;
use super::scene::Scene;
use crate::terrain::class::TerrainLabel;
use crate::trace::{Channel, Trace, behind_number};
use serde::Serialize;

/// Values [-] of a channel that a page holds at most; of more samples it holds the bounds of stretches.
const MOST_VALUES: usize = 1 << 17;
/// Frames per second [1/s] of the moving picture, and frames at most.
const FRAME_RATE: f64 = 30.0;
const MOST_FRAMES: f64 = 4000.0;
/// Share [-] of the samples whose force is drawn no longer than an arrow may be.
const ARROW_SHARE: f64 = 0.99;

/// A run as a page shows it: its wheel moves over its ground, and its channels can be zoomed.
///
/// Samples are kept as they are, in single precision (a relative error of 6e-8); of a channel of more
/// than 131 072 samples, the least and the greatest of equal stretches.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunView {
    /// First and last time [s].
    span: [f64; 2],
    panels: Vec<Panel>,
    classes: Vec<ClassSpan>,
    scene: Option<Picture>,
    /// What the reader has to know.
    notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Panel {
    name: String,
    unit: String,
    series: Vec<Series>,
    command: Option<Command>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Command {
    name: &'static str,
    value: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Series {
    channel: String,
    name: String,
    symbol: String,
    /// Place in the palette.
    colour: usize,
    /// Factor from the channel's unit to the panel's.
    factor: f64,
    rate: f64,
    start: f64,
    /// Samples in a stretch: 1 where each is kept.
    block: usize,
    /// The samples; or the least of every stretch, then the greatest.
    data: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct ClassSpan {
    start: f64,
    end: f64,
    class: &'static str,
    meaning: &'static str,
    terrain: &'static str,
    ground: &'static str,
    colour: &'static str,
}

/// The wheel on its ground.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Picture {
    radius: f64,
    lug_count: u32,
    lug_height: f64,
    lug_thickness: f64,
    /// What the ground is where no class window says: `hard`, `stones` or `soil`.
    ground: &'static str,
    surface: [String; 2],
    rut: [String; 2],
    /// Time [s] of the first pose and between two.
    start: f64,
    step: f64,
    /// Position [m], height [m] and angle [rad].
    poses: [String; 3],
    /// Lug, start [s], end [s], and whether it entered, of every contact.
    contacts: [String; 4],
    /// Force [N] and torque [N·m] of an arrow of full length.
    force: f64,
    torque: f64,
}

impl RunView {
    /// The run as far as its channels go; notes say what is missing.
    ///
    /// # Errors
    /// `Empty` where no channel can be drawn.
    pub fn new(trace: &Trace, id: &str) -> Result<Self, ReportError> {
        let span = time_range(trace).ok_or_else(|| ReportError::Empty(id.to_owned()))?;
        let panels = panels(trace);
        let (scene, of_scene) = picture(trace, span);
        let notes = remarks_on_channels(trace).into_iter().chain(of_scene);
        let notes = notes.chain(shortened(trace));
        Ok(Self {
            span,
            notes: notes.collect(),
            classes: classes(trace),
            panels,
            scene,
        })
    }

    /// As JSON that may stand in a `script` element.
    pub(super) fn to_json(&self) -> String {
        let json = serde_json::to_string(self).expect("every part of it has a form in JSON");
        json.replace('<', "\\u003c")
    }
}

fn panels(trace: &Trace) -> Vec<Panel> {
    let groups = || GROUPS.iter().chain(&MOTION);
    let known: Vec<&str> = groups()
        .flat_map(|group| group.lines.iter().map(|line| line.channel))
        .collect();
    let named = groups()
        .filter(|group| group.is_drawable(trace))
        .map(|group| panel(trace, group));
    let others = trace.channels.iter();
    let others = others.filter(|it| is_drawable(it) && !known.contains(&it.name.as_str()));
    named.chain(others.map(unknown)).collect()
}

fn panel(trace: &Trace, group: &Group) -> Panel {
    let series = group.lines.iter().filter_map(|line| {
        let colour = PALETTE.iter().position(|colour| *colour == line.colour);
        Some(Series {
            name: line.name.to_owned(),
            symbol: line.symbol.to_owned(),
            colour: colour.unwrap_or(0),
            factor: group.factor,
            ..series(drawable(trace, line.channel)?)
        })
    });
    let command = group.command(&trace.attributes);
    Panel {
        name: group.name.to_owned(),
        unit: behind_number(group.unit).trim().to_owned(),
        series: series.collect(),
        command: command.map(|(name, value)| Command { name, value }),
    }
}

/// A channel that this program does not know.
fn unknown(channel: &Channel) -> Panel {
    Panel {
        name: channel.name.clone(),
        unit: match channel.unit.as_str() {
            "1" => String::new(),
            unit => unit.to_owned(),
        },
        series: vec![series(channel)],
        command: None,
    }
}

fn series(channel: &Channel) -> Series {
    let block = block(channel);
    let data = if block == 1 {
        packed(channel.samples.iter().copied())
    } else {
        let stretches = channel.samples.chunks(block);
        let bounds: Vec<[f64; 2]> = stretches
            .map(|it| envelope(it, 1)[0].unwrap_or([f64::NAN; 2]))
            .collect();
        let lows = bounds.iter().map(|ends| ends[0]);
        packed(lows.chain(bounds.iter().map(|ends| ends[1])))
    };
    Series {
        channel: channel.name.clone(),
        name: String::new(),
        symbol: String::new(),
        colour: 0,
        factor: 1.0,
        rate: channel.sample_rate,
        start: channel.start,
        block,
        data,
    }
}

/// Samples of a channel in a stretch of which a page holds two values.
fn block(channel: &Channel) -> usize {
    match channel.samples.len() {
        count if count <= MOST_VALUES => 1,
        count => count.div_ceil(MOST_VALUES / 2),
    }
}

/// Which channels have too many samples for a page.
fn shortened(trace: &Trace) -> impl Iterator<Item = String> + '_ {
    let long = trace.channels.iter().filter(|it| block(it) > 1);
    long.map(|channel| {
        format!(
            "{}: of {} samples, the least and the greatest of each {} are shown.",
            channel.name,
            channel.samples.len(),
            block(channel)
        )
    })
}

fn classes(trace: &Trace) -> Vec<ClassSpan> {
    let windows = trace.truth.as_ref().map_or(&[][..], |it| &it.class_windows);
    let span = |window: &crate::trace::ClassWindow| ClassSpan {
        start: window.start,
        end: window.end,
        class: window.class.as_str(),
        meaning: class_name(window.class),
        terrain: window.terrain.as_str(),
        ground: ground(Some(window.terrain)),
        colour: class_colour(window.class),
    };
    merged(windows).iter().map(span).collect()
}

/// What a ground is drawn as.
fn ground(terrain: Option<TerrainLabel>) -> &'static str {
    use TerrainLabel::{Gravel, Hard, HardWithGravel, Reference};
    match terrain {
        Some(Reference | Hard | HardWithGravel) => "hard",
        Some(Gravel) => "stones",
        _ => "soil",
    }
}

/// The picture, if there can be one, and what has to be said of it.
fn picture(trace: &Trace, [start, end]: [f64; 2]) -> (Option<Picture>, Vec<String>) {
    let on_profile = Scene::on_profile(trace);
    let is_level = on_profile.is_err();
    let scene = match on_profile.or_else(|_| Scene::on_level_ground(trace)) {
        Ok(scene) => scene,
        Err(lacking) => {
            let note = format!("Wheel and ground are not drawn: no {lacking}.");
            return (None, vec![note]);
        }
    };
    let step = ((end - start) / MOST_FRAMES).max(1.0 / FRAME_RATE);
    let times = (0..).map(|frame| start + f64::from(frame) * step);
    let poses: Vec<_> = times
        .take_while(|time| *time < end + step)
        .map(|time| scene.pose(time.min(end), scene.position(time.min(end))))
        .collect();
    let picture = Picture {
        radius: scene.shape.radius,
        lug_count: scene.shape.lug_count,
        lug_height: scene.shape.lug_height,
        lug_thickness: scene.shape.lug_thickness,
        ground: ground(trace.attributes.terrain),
        surface: both(&scene.surface),
        rut: both(&scene.rut(end)),
        start,
        step,
        poses: [
            packed(poses.iter().map(|pose| pose.position)),
            packed(poses.iter().map(|pose| pose.height)),
            packed(poses.iter().map(|pose| pose.wheel_angle)),
        ],
        contacts: contacts(trace),
        force: full_length(trace, &["normal_force", "drawbar_pull"]),
        torque: full_length(trace, &["driving_torque"]),
    };
    (Some(picture), notes(trace, &scene, is_level))
}

/// Positions and heights of a polyline.
fn both(polyline: &[[f64; 2]]) -> [String; 2] {
    [0, 1].map(|axis| packed(polyline.iter().map(|point| point[axis])))
}

fn contacts(trace: &Trace) -> [String; 4] {
    let contacts = trace.truth.as_ref().map_or(&[][..], |it| &it.contacts);
    [
        packed(contacts.iter().map(|it| f64::from(it.lug))),
        packed(contacts.iter().map(|it| it.start)),
        packed(contacts.iter().map(|it| it.end)),
        packed(contacts.iter().map(|it| f64::from(u8::from(it.entered)))),
    ]
}

/// What nearly all samples of these channels stay below; 1 where they are all 0.
fn full_length(trace: &Trace, names: &[&str]) -> f64 {
    let channels = names.iter().filter_map(|name| drawable(trace, name));
    let largest = channels.map(|channel| {
        let finite = channel.samples.iter().filter(|it| it.is_finite());
        let mut sizes: Vec<f64> = finite.map(|it| it.abs()).collect();
        let place = (ARROW_SHARE * (sizes.len() - 1) as f64) as usize;
        *sizes.select_nth_unstable_by(place, f64::total_cmp).1
    });
    let largest = largest.fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// What the reader has to know of the picture.
fn notes(trace: &Trace, scene: &Scene<'_>, is_level: bool) -> Vec<String> {
    use TerrainLabel::{Gravel, HardWithGravel, SandWithGravel};
    let has = |name| drawable(trace, name).is_some();
    let run = &trace.attributes;
    let windows = trace.truth.iter().flat_map(|it| &it.class_windows);
    let mut labels = windows.map(|it| it.terrain).chain(run.terrain);
    let has_stones = labels.any(|it| matches!(it, Gravel | HardWithGravel | SandWithGravel));
    let is_soft = scene.is_soft(time_range(trace).map_or(0.0, |range| range[0]));
    let turns = has("wheel_angle");
    let notes = [
        (
            is_level,
            "The ground's profile was not recorded: it is drawn level.",
        ),
        (
            !is_level,
            "Beyond the profile that the run recorded, the ground is drawn pale and level.",
        ),
        (
            !is_level && has_stones,
            "Stones are drawn where they lay before the wheel came: a run file does not hold how they moved.",
        ),
        (
            is_soft && !has("sinkage"),
            "Without sinkage the wheel is drawn standing on the ground.",
        ),
        (
            !turns,
            "Without its angle the wheel is drawn as if it did not turn.",
        ),
        (
            turns && run.angle_zero_unknown,
            "Where the wheel's angle is zero is not known: it turns as recorded, from any position of its lugs.",
        ),
        (
            !has("forward_speed"),
            "Without forward speed the wheel is drawn moving at the speed commanded.",
        ),
    ];
    let holding = notes.into_iter().filter(|(holds, _)| *holds);
    holding.map(|(_, note)| note.to_owned()).collect()
}
