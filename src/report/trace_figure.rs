//! One run in one drawing: the wheel on its ground, the class, every channel over time, the order
//! spectrum, and what is missing.

use super::ReportError;
use super::class_strip::{self, ClassSpan};
use super::envelope::{bounds, envelope};
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, PALETTE, Panel, Stroke};
use super::page::four_digits;
use super::spectrum::{OrderSpectrum, order_spectrum};
use super::wheel_picture::{Ground, Pose, WheelShape, draw_wheel_on_ground, height_at};
use crate::terrain::class::TerrainLabel;
use crate::trace::{Channel, ClassWindow, Mean, RunAttributes, Trace};

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Left edge of the panels [px], right of their tick labels.
const LEFT: f64 = 84.0;
/// Room at the right edge [px].
const RIGHT: f64 = 28.0;
/// Lug orders that the spectrum shows.
const ORDERS: f64 = 10.0;

/// One panel over time: what is drawn together.
struct Group {
    header: &'static str,
    /// Factor from the channel's unit to the header's.
    factor: f64,
    height: f64,
    /// Channel, its name in the legend, its colour.
    lines: &'static [(&'static str, &'static str, &'static str)],
}

const GROUPS: [Group; 5] = [
    Group {
        header: "Vertical acceleration of the axle [m/s²]",
        factor: 1.0,
        height: 170.0,
        lines: &[("acceleration_y", "", PALETTE[0])],
    },
    Group {
        header: "Forces [N]",
        factor: 1.0,
        height: 150.0,
        lines: &[
            ("normal_force", "normal force F_N", PALETTE[0]),
            ("drawbar_pull", "drawbar pull F_DP", PALETTE[1]),
        ],
    },
    Group {
        header: "Driving torque [N·m]",
        factor: 1.0,
        height: 95.0,
        lines: &[("driving_torque", "", PALETTE[2])],
    },
    Group {
        header: "Sinkage of the rim [mm]",
        factor: 1e3,
        height: 95.0,
        lines: &[("sinkage", "", PALETTE[3])],
    },
    Group {
        header: "Slip ratio [-]",
        factor: 1.0,
        height: 95.0,
        lines: &[("slip_ratio", "", PALETTE[1])],
    },
];

/// Channels of a run file that are used, though not drawn as lines.
const SILENT: [&str; 2] = ["wheel_angle", "forward_speed"];

/// Acceleration, forces, torque, sinkage and slip over time, the true class where it is known, the
/// order spectrum, and the wheel on its ground in the middle of the run, as one SVG 1200 px wide.
///
/// Any channel may be missing, empty or hold samples that are no numbers: what there is is drawn,
/// and a remark under the title says what is not. A line of many samples is drawn by the bounds of
/// each pixel's samples, so no spike is lost.
///
/// # Errors
/// `Empty` when not even one channel, mean or ground profile can be drawn.
pub fn trace_figure(trace: &Trace, id: &str) -> Result<String, ReportError> {
    let mut remarks = Remarks::default();
    let groups = drawable_groups(trace, &mut remarks);
    let scene = scene(trace, &mut remarks);
    let spectrum = spectrum(trace, &mut remarks);
    if groups.is_empty() && trace.means.is_empty() && scene.is_none() {
        return Err(ReportError::Empty(id.to_owned()));
    }
    let mut sheet = Sheet::new(id);
    sheet.title(id, &trace.attributes);
    sheet.remarks(&remarks.0);
    if let Some(scene) = &scene {
        sheet.scene(scene);
    }
    sheet.channels(trace, &groups);
    if let Some(spectrum) = &spectrum {
        sheet.spectrum(spectrum);
    }
    sheet.means(trace);
    Ok(sheet.finish())
}

/// What the reader has to know of what is not drawn.
#[derive(Default)]
struct Remarks(Vec<String>);

impl Remarks {
    fn add(&mut self, remark: String) {
        self.0.push(remark);
    }
}

/// A channel with at least one finite sample and a rate.
fn is_drawable(channel: &Channel) -> bool {
    let timed =
        channel.sample_rate > 0.0 && channel.sample_rate.is_finite() && channel.start.is_finite();
    timed && channel.samples.iter().any(|sample| sample.is_finite())
}

pub(super) fn drawable<'a>(trace: &'a Trace, name: &str) -> Option<&'a Channel> {
    trace.channel(name).filter(|channel| is_drawable(channel))
}

/// The groups with something to draw; remarks on channels that are absent or broken.
fn drawable_groups(trace: &Trace, remarks: &mut Remarks) -> Vec<&'static Group> {
    let names: Vec<&str> = GROUPS
        .iter()
        .flat_map(|group| group.lines.iter().map(|line| line.0))
        .chain(SILENT)
        .collect();
    let absent: Vec<&str> = names
        .iter()
        .copied()
        .filter(|name| trace.channel(name).is_none())
        .collect();
    if !absent.is_empty() {
        remarks.add(format!("Not recorded: {}.", absent.join(", ")));
    }
    let unknown: Vec<&str> = trace
        .channels
        .iter()
        .map(|channel| channel.name.as_str())
        .filter(|name| !names.contains(name))
        .collect();
    if !unknown.is_empty() {
        remarks.add(format!("Recorded and not drawn: {}.", unknown.join(", ")));
    }
    for channel in names.iter().filter_map(|name| trace.channel(name)) {
        if let Some(fault) = fault(channel) {
            remarks.add(format!("{}: {fault}.", channel.name));
        }
    }
    GROUPS
        .iter()
        .filter(|group| {
            let mut lines = group.lines.iter();
            lines.any(|line| drawable(trace, line.0).is_some())
        })
        .collect()
}

/// What is wrong with a channel.
fn fault(channel: &Channel) -> Option<String> {
    let count = channel.samples.len();
    let finite = channel.samples.iter().filter(|s| s.is_finite()).count();
    if count == 0 {
        return Some("no samples".to_owned());
    }
    if finite == 0 {
        return Some(format!("none of {count} samples is a finite number"));
    }
    if !is_drawable(channel) {
        let Channel {
            sample_rate, start, ..
        } = channel;
        return Some(format!(
            "a sample rate of {sample_rate} Hz from {start} s cannot be drawn"
        ));
    }
    (finite < count).then(|| {
        let broken = count - finite;
        format!("{broken} of {count} samples are no finite numbers and leave gaps")
    })
}

fn spectrum(trace: &Trace, remarks: &mut Remarks) -> Option<OrderSpectrum> {
    let signal = trace.channel("acceleration_y")?;
    let Some(angle) = trace.channel("wheel_angle") else {
        remarks.add("No order spectrum: it needs the channel wheel_angle.".to_owned());
        return None;
    };
    match order_spectrum(signal, angle, trace.attributes.lug_count.unwrap_or(0)) {
        Ok(spectrum) => Some(spectrum),
        Err(error) => {
            remarks.add(format!("No order spectrum: {error}."));
            None
        }
    }
}

/// The wheel on its ground at one time.
struct Scene<'a> {
    time: f64,
    shape: WheelShape,
    pose: Pose,
    surface: &'a [[f64; 2]],
    rut: Vec<[f64; 2]>,
    terrain: Option<TerrainLabel>,
}

/// The scene in the middle of the run; a remark where it cannot be drawn or is not what was measured.
fn scene<'a>(trace: &'a Trace, remarks: &mut Remarks) -> Option<Scene<'a>> {
    let shape = WheelShape::from(&trace.attributes);
    let surface = trace.truth.as_ref().map_or(&[][..], |t| &t.profile);
    let finite = surface.iter().flatten().all(|value| value.is_finite());
    let sized = shape.radius > 0.0 && shape.tip_radius().is_finite();
    if surface.len() < 2 || !finite || !sized {
        let lacking = if sized {
            "ground profile"
        } else {
            "wheel radius"
        };
        remarks.add(format!("Wheel and ground are not drawn: no {lacking}."));
        return None;
    }
    let path = axle_path(trace);
    let range = time_range(trace).unwrap_or([0.0, 0.0]);
    let time = (range[0] + range[1]) / 2.0;
    let mut position = height_at(&path, time).unwrap_or(0.0);
    if height_at(surface, position).is_none() {
        position = (surface[0][0] + surface[surface.len() - 1][0]) / 2.0;
        remarks.add(
            "The ground profile does not reach the axle: the wheel is drawn in its middle."
                .to_owned(),
        );
    }
    let terrain = terrain_at(trace, time);
    let wheel_angle = value_at(trace, "wheel_angle", time).unwrap_or(0.0);
    let fixed = matches!(
        terrain,
        Some(TerrainLabel::Reference | TerrainLabel::Hard | TerrainLabel::HardWithGravel)
    );
    let sinkage = value_at(trace, "sinkage", time).filter(|_| !fixed);
    let height = match (sinkage, height_at(surface, position)) {
        (Some(sinkage), Some(ground)) => ground + shape.radius - sinkage,
        _ => shape.standing_height(position, wheel_angle, surface),
    };
    if sinkage.is_none() && !fixed {
        remarks.add("No sinkage: the wheel is drawn standing on the ground.".to_owned());
    }
    let rut = sinkage.map_or(Vec::new(), |_| rut(trace, &path, surface, position));
    let pose = Pose {
        position,
        height,
        wheel_angle,
    };
    Some(Scene {
        time,
        shape,
        pose,
        surface,
        rut,
        terrain,
    })
}

/// Time [s] and position of the axle [m], 0 at the start: the forward speed's integral, or the
/// commanded speed's where it was not recorded.
fn axle_path(trace: &Trace) -> Vec<[f64; 2]> {
    let commanded = trace.attributes.speed;
    let [start, end] = time_range(trace).unwrap_or([0.0, 0.0]);
    let whole = |channel: &&Channel| channel.samples.iter().all(|v| v.is_finite());
    match drawable(trace, "forward_speed").filter(whole) {
        None => vec![[start, 0.0], [end, commanded * (end - start)]],
        Some(channel) => {
            let step = 1.0 / channel.sample_rate;
            let mut position = 0.0;
            let mut before = channel.samples[0];
            let samples = channel.samples.iter().enumerate();
            samples
                .map(|(i, &speed)| {
                    if i > 0 {
                        position += step * (before + speed) / 2.0;
                    }
                    before = speed;
                    [channel.start + i as f64 * step, position]
                })
                .collect()
        }
    }
}

/// What the rim left behind: the surface less the sinkage when the axle was there.
fn rut(trace: &Trace, path: &[[f64; 2]], surface: &[[f64; 2]], position: f64) -> Vec<[f64; 2]> {
    let stride = (path.len() / 2000).max(1);
    let mut rut: Vec<[f64; 2]> = Vec::new();
    for &[time, x] in fine(path).iter().step_by(stride) {
        let forward = rut.last().is_none_or(|last| x > last[0]);
        if x > position || !forward {
            continue;
        }
        let sinkage = value_at(trace, "sinkage", time);
        if let (Some(sinkage), Some(ground)) = (sinkage, height_at(surface, x)) {
            rut.push([x, ground - sinkage.max(0.0)]);
        }
    }
    rut
}

/// A path of few points with 500 more between each two.
fn fine(path: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if path.len() != 2 {
        return path.to_vec();
    }
    let [[t0, x0], [t1, x1]] = [path[0], path[1]];
    (0..=500)
        .map(|i| f64::from(i) / 500.0)
        .map(|part| [t0 + part * (t1 - t0), x0 + part * (x1 - x0)])
        .collect()
}

fn terrain_at(trace: &Trace, time: f64) -> Option<TerrainLabel> {
    let windows = trace.truth.iter().flat_map(|truth| &truth.class_windows);
    let window = windows
        .clone()
        .find(|window| window.start <= time && time < window.end);
    window
        .map(|window| window.terrain)
        .or(trace.attributes.terrain)
}

/// The sample nearest to `time` [s], if it is finite.
fn value_at(trace: &Trace, name: &str, time: f64) -> Option<f64> {
    let channel = drawable(trace, name)?;
    let index = ((time - channel.start) * channel.sample_rate).round();
    let value = *channel
        .samples
        .get((index >= 0.0).then_some(index as usize)?)?;
    value.is_finite().then_some(value)
}

/// First and last time [s] of all that can be drawn.
fn time_range(trace: &Trace) -> Option<[f64; 2]> {
    let ends: Vec<f64> = trace
        .channels
        .iter()
        .filter(|channel| is_drawable(channel))
        .flat_map(|channel| {
            let length = (channel.samples.len() - 1) as f64 / channel.sample_rate;
            [channel.start, channel.start + length]
        })
        .collect();
    bounds(&ends)
}

/// The drawing under way, from top to bottom.
struct Sheet {
    canvas: Canvas,
    /// Where the next part begins [px].
    below: f64,
}

impl Sheet {
    fn new(id: &str) -> Self {
        Self {
            canvas: Canvas::new([WIDTH, 0.0], &format!("Run {id}")),
            below: 0.0,
        }
    }

    fn finish(mut self) -> String {
        self.canvas.set_height(self.below + 16.0);
        self.canvas.finish()
    }

    /// The next `height` [px] between the margins, below a gap.
    fn area(&mut self, gap: f64, height: f64) -> Area {
        let top = self.below + gap;
        self.below = top + height;
        Area {
            left: LEFT,
            top,
            width: WIDTH - LEFT - RIGHT,
            height,
        }
    }

    fn line(&mut self, font: Font, text: &str) {
        self.below += 1.5 * font.size;
        let text = font.fit(text, WIDTH - 2.0 * RIGHT);
        let at = [RIGHT, self.below];
        self.canvas.text(at, Anchor::Start, font, &text);
    }

    fn title(&mut self, id: &str, run: &RunAttributes) {
        self.below = 8.0;
        let terrain = run.terrain.map_or("terrain not given", terrain_name);
        self.line(Font::TITLE, &format!("Run {id}: {terrain}"));
        let condition = Font {
            colour: INK,
            ..Font::SMALL
        };
        self.line(condition, &wheel_and_condition(run));
        self.line(condition, &origin(run));
    }

    fn remarks(&mut self, remarks: &[String]) {
        let font = Font {
            colour: "#a33d00",
            ..Font::SMALL
        };
        for line in font.wrap(&remarks.join(" "), WIDTH - 2.0 * RIGHT) {
            self.line(font, &line);
        }
    }

    fn scene(&mut self, scene: &Scene<'_>) {
        let header = format!(
            "Wheel and ground at {:.2} s, {:.0} mm along the track",
            scene.time,
            scene.pose.position * 1e3
        );
        let area = self.area(Panel::HEADER + 8.0, 270.0);
        let at = [area.left, area.top - 9.0];
        let ground = Ground {
            surface: scene.surface,
            rut: &scene.rut,
            stones: &[],
            terrain: scene.terrain,
        };
        let canvas = &mut self.canvas;
        canvas.text(at, Anchor::Start, Font::HEADER, &header);
        draw_wheel_on_ground(canvas, &area, &scene.shape, &scene.pose, &ground);
    }

    /// The true class, and every group of channels, over one time axis.
    fn channels(&mut self, trace: &Trace, groups: &[&Group]) {
        let Some(range) = time_range(trace).filter(|_| !groups.is_empty()) else {
            return;
        };
        let time = Axis::exact(range, [LEFT, WIDTH - RIGHT]);
        let windows = trace.truth.as_ref().map_or(&[][..], |t| &t.class_windows);
        if !windows.is_empty() {
            self.classes(&time, windows);
        }
        for (i, group) in groups.iter().enumerate() {
            let area = self.area(Panel::HEADER + 6.0, group.height);
            let panel = draw_group(&mut self.canvas, trace, group, area, time);
            if i + 1 == groups.len() {
                panel.draw_footer(&mut self.canvas, "time [s]");
                self.below += Panel::FOOTER;
            }
        }
    }

    fn classes(&mut self, time: &Axis, windows: &[ClassWindow]) {
        let strip = self.area(Panel::HEADER + 8.0, 24.0);
        let header = "How the lugs met the ground";
        let merged = merged(windows);
        let keys = class_strip::keys(merged.iter().map(|window| window.class));
        let panel = Panel {
            area: strip,
            x: *time,
            y: *time,
        };
        let header_at = [strip.left, strip.top - 9.0];
        let canvas = &mut self.canvas;
        canvas.text(header_at, Anchor::Start, Font::HEADER, header);
        panel.draw_legend(canvas, header, &keys);
        canvas.clip(&strip);
        for window in &merged {
            draw_window(canvas, time, &strip, window);
        }
        canvas.unclip();
    }

    fn spectrum(&mut self, spectrum: &OrderSpectrum) {
        let shown: Vec<[f64; 2]> = (1..spectrum.amplitude.len())
            .map(|line| [spectrum.lug_order(line), spectrum.amplitude[line]])
            .take_while(|point| point[0] <= ORDERS)
            .collect();
        let amplitudes: Vec<f64> = shown.iter().map(|point| point[1]).collect();
        let Some([low, high]) = bounds(&amplitudes).filter(|range| range[1] > 0.0) else {
            self.line(Font::SMALL, "The order spectrum is 0 throughout.");
            return;
        };
        let area = self.area(Panel::HEADER + 14.0, 210.0);
        let panel = Panel {
            area,
            x: Axis::exact([0.0, ORDERS], [area.left, area.right()]),
            y: Axis::decades([low.max(1e-5 * high), high], [area.bottom(), area.top]),
        };
        draw_spectrum(&mut self.canvas, &panel, spectrum, &shown);
        self.below += Panel::FOOTER;
    }

    fn means(&mut self, trace: &Trace) {
        if trace.means.is_empty() {
            return;
        }
        self.below += 14.0;
        self.line(Font::HEADER, "Means of the steady state");
        for mean in &trace.means {
            let Mean { name, unit, .. } = mean;
            let value = four_digits(mean.value);
            let line = match mean.sd.is_nan() {
                true => format!("{name}: {value} {unit}"),
                false => format!(
                    "{name}: {value} ± {} {unit} (standard deviation, n = {})",
                    four_digits(mean.sd),
                    match mean.n {
                        0 => "unknown".to_owned(),
                        n => n.to_string(),
                    }
                ),
            };
            self.line(Font::SMALL, &line);
        }
    }
}

fn terrain_name(terrain: TerrainLabel) -> &'static str {
    match terrain {
        TerrainLabel::Reference => "flat hard ground (REF)",
        TerrainLabel::Hard => "hard terrain (HT)",
        TerrainLabel::Gravel => "gravel (GT)",
        TerrainLabel::Sand => "sand (ST)",
        TerrainLabel::HardWithGravel => "hard terrain with gravel (HGT)",
        TerrainLabel::SandWithGravel => "sand with gravel (SGT)",
    }
}

/// The wheel and what was commanded, without what nobody knows.
fn wheel_and_condition(run: &RunAttributes) -> String {
    let wheel = match run.lugs() {
        lugs if lugs.are_none() => "smooth wheel".to_owned(),
        lugs => lugs.to_string(),
    };
    let known = |value: f64, text: String| value.is_finite().then_some(text);
    let (radius, width) = (run.wheel_radius * 1e3, run.wheel_width * 1e3);
    let wheel = [
        Some(wheel),
        known(radius, format!("rim radius {radius:.0} mm")),
        known(width, format!("width {width:.0} mm")),
    ];
    let wheel: Vec<String> = wheel.into_iter().flatten().collect();
    let speed = run.speed * 1e3;
    let parts = [
        Some(wheel.join(", ")),
        known(run.load, format!("load {:.1} N", run.load)),
        known(speed, format!("speed {speed:.1} mm/s")),
        known(run.slip_ratio, format!("slip {:.2}", run.slip_ratio)),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    parts.join("   |   ")
}

/// Where the run comes from, and its label.
fn origin(run: &RunAttributes) -> String {
    let source = match run.physics_rate {
        Some(rate) => format!("simulated at {} kHz", four_digits(rate / 1e3)),
        None => "measured".to_owned(),
    };
    let class = run.class.map(|class| format!("class {class}"));
    let day = (!run.day.is_empty()).then(|| format!("day {}", run.day));
    let notes = (!run.notes.is_empty()).then(|| run.notes.clone());
    let parts = [Some(source), class, Some(format!("repeat {}", run.repeat))];
    let parts: Vec<String> = parts.into_iter().chain([day, notes]).flatten().collect();
    parts.join("   |   ")
}

/// Windows with neighbours of the same class and terrain joined.
fn merged(windows: &[ClassWindow]) -> Vec<ClassWindow> {
    let mut merged: Vec<ClassWindow> = Vec::new();
    for window in windows {
        match merged.last_mut() {
            Some(last) if (last.class, last.terrain) == (window.class, window.terrain) => {
                last.end = window.end;
            }
            _ => merged.push(*window),
        }
    }
    merged
}

fn draw_window(canvas: &mut Canvas, time: &Axis, strip: &Area, window: &ClassWindow) {
    let span = ClassSpan {
        time: [window.start, window.end],
        class: window.class,
        name: format!("{} on {}", window.class, window.terrain),
    };
    span.draw(canvas, time, strip);
}

fn draw_group(canvas: &mut Canvas, trace: &Trace, group: &Group, area: Area, time: Axis) -> Panel {
    let lines: Vec<_> = group
        .lines
        .iter()
        .filter_map(|line| drawable(trace, line.0).map(|channel| (line, channel)))
        .collect();
    let command = command(&trace.attributes, group);
    let values: Vec<f64> = lines
        .iter()
        .filter_map(|(_, channel)| bounds(&channel.samples))
        .flatten()
        .map(|value| value * group.factor)
        .chain(command.iter().map(|command| command.1))
        .collect();
    let panel = Panel {
        area,
        x: time,
        y: Axis::roomy(
            bounds(&values).unwrap_or([0.0, 1.0]),
            [area.bottom(), area.top],
        ),
    };
    panel.draw_frame(canvas, group.header);
    let mut legend: Vec<(String, Stroke)> = Vec::new();
    canvas.clip(&area);
    if let Some((name, value)) = command {
        let stroke = Stroke::dashed(MUTED, 1.2);
        let y = panel.y.pixel(value);
        canvas.polyline(&[[area.left, y], [area.right(), y]], stroke);
        legend.push((name.to_owned(), stroke));
    }
    for ((_, name, colour), channel) in lines {
        draw_channel(canvas, &panel, channel, group.factor, colour);
        if !name.is_empty() {
            legend.push(((*name).to_owned(), Stroke::solid(colour, 2.5)));
        }
    }
    canvas.unclip();
    panel.draw_legend(canvas, group.header, &legend);
    panel
}

/// What was commanded of the quantity a group shows, in the header's unit.
fn command(run: &RunAttributes, group: &Group) -> Option<(&'static str, f64)> {
    let command = match group.lines[0].0 {
        "normal_force" => ("load commanded", run.load),
        "slip_ratio" => ("slip commanded", run.slip_ratio),
        _ => return None,
    };
    command.1.is_finite().then_some(command)
}

/// Samples as a line; where a pixel holds many, the bounds of each pixel.
pub(super) fn draw_channel(
    canvas: &mut Canvas,
    panel: &Panel,
    channel: &Channel,
    factor: f64,
    colour: &'static str,
) {
    let count = channel.samples.len();
    let length = (count - 1) as f64 / channel.sample_rate;
    let left = panel.x.pixel(channel.start);
    let width = panel.x.pixel(channel.start + length) - left;
    let columns = (width as usize).max(1).min(count);
    let crowded = count > 2 * columns;
    let columns = if crowded { columns } else { count };
    let pitch = width / (columns.max(2) - 1) as f64;
    let mut line: Vec<[f64; 2]> = Vec::new();
    let stroke = Stroke::solid(colour, if crowded { 1.0 } else { 1.5 });
    for (i, column) in envelope(&channel.samples, columns).into_iter().enumerate() {
        let x = left + i as f64 * pitch;
        match column {
            Some([low, high]) if crowded => {
                let ends = [low, high].map(|value| [x, panel.y.pixel(value * factor)]);
                line.extend(ends);
            }
            Some([value, _]) => line.push([x, panel.y.pixel(value * factor)]),
            None => canvas.polyline(&std::mem::take(&mut line), stroke),
        }
    }
    canvas.polyline(&line, stroke);
}

fn draw_spectrum(
    canvas: &mut Canvas,
    panel: &Panel,
    spectrum: &OrderSpectrum,
    points: &[[f64; 2]],
) {
    let header = "Order spectrum of the acceleration: amplitude [m/s²]";
    panel.draw_frame(canvas, header);
    let [top, bottom] = [panel.area.top, panel.area.bottom()];
    let harmonic = Stroke::solid("#f2b98f", 1.5);
    for order in 1..ORDERS as usize {
        let x = panel.x.pixel(order as f64);
        canvas.polyline(&[[x, top], [x, bottom]], harmonic);
    }
    let minor = minor_ticks(spectrum.passes_per_turn, panel.area.width / ORDERS);
    for tick in 0..=minor * ORDERS as u32 {
        let x = panel.x.pixel(f64::from(tick) / f64::from(minor));
        let ends = [[x, bottom], [x, bottom - 5.0]];
        canvas.polyline(&ends, Stroke::solid(MUTED, 0.8));
    }
    let line: Vec<[f64; 2]> = points.iter().map(|point| panel.at(*point)).collect();
    canvas.clip(&panel.area);
    canvas.polyline(&line, Stroke::solid(PALETTE[0], 1.5));
    canvas.unclip();
    let (unit, blocks) = match spectrum.passes_per_turn {
        1 => ("turn", format!("{} turns", spectrum.passes)),
        _ => ("lug pass", format!("{} lug passes", spectrum.passes)),
    };
    let harmonics = (format!("harmonics of the {unit}"), harmonic);
    panel.draw_legend(canvas, header, &[harmonics]);
    let ticks = match spectrum.passes_per_turn / minor {
        _ if minor == 1 => String::new(),
        1 => "; small ticks: orders of the wheel".to_owned(),
        step => format!("; small ticks: {step} orders of the wheel apart"),
    };
    let name = format!(
        "order per {unit} [-]{ticks}; Hann, {} × {blocks}",
        spectrum.blocks
    );
    panel.draw_footer(canvas, &name);
}

/// How many parts of a lug order the small ticks mark: whole wheel orders, 5 px apart or more.
fn minor_ticks(passes_per_turn: u32, pixels_per_order: f64) -> u32 {
    (1..=passes_per_turn)
        .rev()
        .find(|parts| {
            passes_per_turn.is_multiple_of(*parts) && pixels_per_order / f64::from(*parts) >= 5.0
        })
        .unwrap_or(1)
}
