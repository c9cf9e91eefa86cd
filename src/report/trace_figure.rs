//! One run in one drawing: the wheel on its ground, the class, every channel over time, the order
//! spectrum, and what is missing.

use super::ReportError;
use super::channel_groups::{GROUPS, Group, Line, drawable, remarks_on_channels, time_range};
use super::class_strip::{self, ClassSpan, merged};
use super::envelope::{Extent, bounds, envelope, extent};
use super::figure::{
    Anchor, Area, Axis, Canvas, Font, INK, Layout, MUTED, PALETTE, Panel, REMARK, Stroke,
};
use super::run_words::{origin, terrain_name, wheel_and_condition};
use super::scene::Scene;
use super::wheel_picture::{Ground, draw_wheel_on_ground};
use crate::signal::{OrderSpectrum, order_spectrum};
use crate::table::four_digits;
use crate::trace::{Channel, ClassWindow, Mean, RunAttributes, Trace};

/// Room at the right edge [px].
const RIGHT: f64 = 28.0;
/// Lug orders that the spectrum shows.
const ORDERS: f64 = 10.0;
/// Height [-] of a panel in a compact layout, by that in another.
const COMPACT: f64 = 0.53;

/// Acceleration, forces, torque, sinkage and slip over time, the true class where it is known, the
/// order spectrum, and the wheel on its ground in the middle of the run, as one SVG 1200 px wide.
///
/// Any channel may be missing, empty or hold samples that are no numbers: what there is is drawn,
/// and a remark under the title lists what is not. A line of many samples is drawn by the bounds of
/// each pixel's samples, so no spike is lost.
///
/// # Errors
/// `Empty` when not even one channel, mean or ground profile can be drawn.
pub fn trace_figure(trace: &Trace, id: &str) -> Result<String, ReportError> {
    laid_out_trace_figure(trace, id, Layout::SCREEN)
}

/// The [`trace_figure`] of another width, with or without the lines above it that a caption replaces.
///
/// # Errors
/// As [`trace_figure`].
pub fn laid_out_trace_figure(
    trace: &Trace,
    id: &str,
    layout: Layout,
) -> Result<String, ReportError> {
    let groups: Vec<&Group> = GROUPS.iter().filter(|it| it.is_drawable(trace)).collect();
    let still = Still::of(trace);
    let spectrum = spectrum(trace);
    if groups.is_empty() && trace.means.is_empty() && still.is_err() {
        return Err(ReportError::Empty(id.to_owned()));
    }
    let mut sheet = Sheet::new(id, layout);
    if layout.is_titled {
        sheet.title(id, &trace.attributes);
        let of_spectrum = spectrum.as_ref().err().into_iter().flatten().cloned();
        let remarks = remarks_on_channels(trace).into_iter();
        let remarks = remarks.chain(not_drawn(trace)).chain(still_remarks(&still));
        sheet.remarks(&remarks.chain(of_spectrum).collect::<Vec<_>>());
    }
    if let Ok(still) = &still {
        sheet.scene(still);
    }
    sheet.channels(trace, &groups);
    if let Ok(spectrum) = &spectrum {
        sheet.spectrum(spectrum);
    }
    sheet.means(trace);
    Ok(sheet.finish())
}

/// Which channels are recorded and have no place in the drawing.
fn not_drawn(trace: &Trace) -> Option<String> {
    const USED: [&str; 2] = ["wheel_angle", "forward_speed"];
    let lines = GROUPS.iter().flat_map(|group| group.lines);
    let known: Vec<&str> = lines.map(|line| line.channel).chain(USED).collect();
    let names = trace.channels.iter().map(|channel| channel.name.as_str());
    let unknown: Vec<&str> = names.filter(|name| !known.contains(name)).collect();
    (!unknown.is_empty()).then(|| format!("Recorded and not drawn: {}.", unknown.join(", ")))
}

/// The order spectrum, or why there is none.
fn spectrum(trace: &Trace) -> Result<OrderSpectrum, Option<String>> {
    let signal = trace.channel("acceleration_y").ok_or(None)?;
    let angle = trace
        .channel("wheel_angle")
        .ok_or_else(|| "No order spectrum: it needs the channel wheel_angle.".to_owned())?;
    order_spectrum(signal, angle, trace.attributes.lug_count.unwrap_or(0))
        .map_err(|error| Some(format!("No order spectrum: {error}.")))
}

/// The wheel on its ground in the middle of a run.
struct Still<'a> {
    scene: Scene<'a>,
    time: f64,
    position: f64,
    /// Whether the profile reaches the axle.
    is_in_place: bool,
}

impl<'a> Still<'a> {
    /// The still, or what it lacks.
    fn of(trace: &'a Trace) -> Result<Self, &'static str> {
        let scene = Scene::on_profile(trace)?;
        let [start, end] = time_range(trace).unwrap_or([0.0, 0.0]);
        let time = (start + end) / 2.0;
        let axle = scene.position(time);
        let is_in_place = scene.reaches(axle);
        let [first, last] = [scene.surface[0], scene.surface[scene.surface.len() - 1]];
        let middle = (first[0] + last[0]) / 2.0;
        Ok(Self {
            scene,
            time,
            position: if is_in_place { axle } else { middle },
            is_in_place,
        })
    }
}

/// What a reader has to know of the still.
fn still_remarks(still: &Result<Still<'_>, &'static str>) -> Vec<String> {
    let still = match still {
        Ok(still) => still,
        Err(lacking) => return vec![format!("Wheel and ground are not drawn: no {lacking}.")],
    };
    let misplaced = "The ground profile does not reach the axle: the wheel is drawn in its middle.";
    let standing = "No sinkage: the wheel is drawn standing on the ground.";
    let is_soft = still.scene.is_soft(still.time);
    let stands = is_soft && still.scene.sinkage(still.time).is_none();
    [(!still.is_in_place, misplaced), (stands, standing)]
        .into_iter()
        .filter(|(holds, _)| *holds)
        .map(|(_, remark)| remark.to_owned())
        .collect()
}

/// The drawing under way, from top to bottom.
struct Sheet {
    canvas: Canvas,
    layout: Layout,
    /// Where the next part begins [px].
    below: f64,
}

impl Sheet {
    fn new(id: &str, layout: Layout) -> Self {
        Self {
            canvas: Canvas::laid_out(layout, &format!("Run {id}")),
            layout,
            below: 0.0,
        }
    }

    fn finish(mut self) -> String {
        self.canvas.set_height(self.below + 16.0);
        self.canvas.finish()
    }

    /// Left edge of the panels [px], right of their tick labels.
    fn left(&self) -> f64 {
        if self.layout.is_compact() { 52.0 } else { 84.0 }
    }

    /// Right edge of the panels [px].
    fn right(&self) -> f64 {
        self.layout.width
            - if self.layout.is_compact() {
                10.0
            } else {
                RIGHT
            }
    }

    /// Left edge and width [px] of lines of text.
    fn margins(&self) -> [f64; 2] {
        [RIGHT, self.layout.width - 2.0 * RIGHT]
    }

    /// The next `height` [px] between the margins, below a gap.
    fn area(&mut self, gap: f64, height: f64) -> Area {
        let height = height
            * if self.layout.is_compact() {
                COMPACT
            } else {
                1.0
            };
        let top = self.below + gap;
        self.below = top + height;
        Area {
            left: self.left(),
            top,
            width: self.right() - self.left(),
            height,
        }
    }

    fn line(&mut self, font: Font, text: &str) {
        self.below += 1.5 * font.size;
        let [left, width] = self.margins();
        let text = font.fit(text, width);
        self.canvas
            .text([left, self.below], Anchor::Start, font, &text);
    }

    fn lines(&mut self, font: Font, text: &str) {
        for line in font.wrap(text, self.margins()[1]) {
            self.line(font, &line);
        }
    }

    fn title(&mut self, id: &str, run: &RunAttributes) {
        self.below = 8.0;
        let terrain = run.terrain.map_or("terrain not given", terrain_name);
        self.lines(Font::TITLE, &format!("Run {id}: {terrain}"));
        let condition = Font {
            colour: INK,
            ..Font::SMALL
        };
        for text in [wheel_and_condition(run), origin(run)] {
            if self.layout.is_compact() {
                self.lines(condition, &text);
            } else {
                self.line(condition, &text);
            }
        }
    }

    fn remarks(&mut self, remarks: &[String]) {
        let font = Font {
            colour: REMARK,
            ..Font::SMALL
        };
        self.lines(font, &remarks.join(" "));
    }

    fn header(&mut self, area: &Area, text: &str) {
        let at = [area.left, area.top - 9.0];
        self.canvas.text(at, Anchor::Start, Font::HEADER, text);
    }

    fn scene(&mut self, still: &Still<'_>) {
        let Still { scene, time, .. } = still;
        let along = still.position * 1e3;
        let header = if self.layout.is_compact() {
            format!("Wheel and ground at {time:.2} s")
        } else {
            format!("Wheel and ground at {time:.2} s, {along:.0} mm along the track")
        };
        let area = self.area(Panel::HEADER + 8.0, 270.0);
        self.header(&area, &header);
        let pose = scene.pose(*time, still.position);
        let rut = scene.rut(*time);
        let ground = Ground {
            surface: &scene.surface,
            rut: &rut,
            terrain: scene.terrain(*time),
        };
        draw_wheel_on_ground(&mut self.canvas, &area, &scene.shape, &pose, &ground);
    }

    /// The true class, and every group of channels, over one time axis.
    fn channels(&mut self, trace: &Trace, groups: &[&Group]) {
        let Some(range) = time_range(trace).filter(|_| !groups.is_empty()) else {
            return;
        };
        let time = Axis::exact(range, [self.left(), self.right()]);
        let windows = trace.truth.as_ref().map_or(&[][..], |t| &t.class_windows);
        if !windows.is_empty() {
            self.classes(&time, windows);
        }
        for (i, group) in groups.iter().enumerate() {
            let area = self.area(Panel::HEADER + 6.0, group.height);
            let compact = self.layout.is_compact();
            let panel = draw_group(
                &mut self.canvas,
                trace,
                &Shown { group, compact },
                area,
                time,
            );
            if i + 1 == groups.len() {
                panel.draw_footer(&mut self.canvas, "time [s]");
                self.below += Panel::FOOTER;
            }
        }
    }

    fn classes(&mut self, time: &Axis, windows: &[ClassWindow]) {
        let mut strip = self.area(Panel::HEADER + 8.0, 24.0);
        self.below += 24.0 - strip.height;
        strip.height = 24.0;
        let header = "How the lugs met the ground";
        let merged = merged(windows);
        let keys = class_strip::keys(merged.iter().map(|window| window.class));
        let panel = Panel {
            area: strip,
            x: *time,
            y: *time,
        };
        self.header(&strip, header);
        let canvas = &mut self.canvas;
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
        let compact = self.layout.is_compact();
        let header = if compact {
            "Amplitude of a_{y} [m/s²]"
        } else {
            "Order spectrum of the acceleration: amplitude [m/s²]"
        };
        draw_spectrum(&mut self.canvas, &panel, header, spectrum, &shown);
        let name = if compact {
            format!("order per {} [-]", turned(spectrum))
        } else {
            spectrum_footer(spectrum, area.width)
        };
        panel.draw_footer(&mut self.canvas, &name);
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
            let line = if mean.sd.is_nan() {
                format!("{name}: {value} {unit}")
            } else {
                format!(
                    "{name}: {value} ± {} {unit} (standard deviation, n = {})",
                    four_digits(mean.sd),
                    match mean.n {
                        0 => "unknown".to_owned(),
                        n => n.to_string(),
                    }
                )
            };
            self.line(Font::SMALL, &line);
        }
    }
}

fn draw_window(canvas: &mut Canvas, time: &Axis, strip: &Area, window: &ClassWindow) {
    let span = ClassSpan {
        time: [window.start, window.end],
        class: window.class,
        name: format!("{} on {}", window.class, window.terrain),
    };
    span.draw(canvas, time, strip);
}

/// A group of channels and how much room its names have.
struct Shown<'a> {
    group: &'a Group,
    compact: bool,
}

impl Shown<'_> {
    /// The entry of a line in the legend; none where the group has one line.
    fn entry(&self, line: &Line) -> Option<(String, Stroke)> {
        let name = if self.compact { line.symbol } else { line.name };
        let is_named = !line.name.is_empty();
        is_named.then(|| (name.to_owned(), Stroke::solid(line.colour, 2.5)))
    }

    fn header(&self) -> String {
        if self.compact {
            self.group.short_header()
        } else {
            self.group.header()
        }
    }
}

fn draw_group(
    canvas: &mut Canvas,
    trace: &Trace,
    shown: &Shown<'_>,
    area: Area,
    time: Axis,
) -> Panel {
    let group = shown.group;
    let lines = group.lines.iter();
    let lines = lines.filter_map(|line| Some((line, drawable(trace, line.channel)?)));
    let lines: Vec<_> = lines.collect();
    let command = group.command(&trace.attributes);
    let extents: Vec<Extent> = lines
        .iter()
        .filter_map(|(_, channel)| extent(&channel.samples))
        .collect();
    let ends = extents.iter().flat_map(|extent| extent.range);
    let ends: Vec<f64> = ends
        .map(|value| value * group.factor)
        .chain(command.iter().map(|command| command.1))
        .collect();
    let panel = Panel {
        area,
        x: time,
        y: Axis::roomy(
            bounds(&ends).unwrap_or([0.0, 1.0]),
            [area.bottom(), area.top],
        ),
    };
    panel.draw_frame(canvas, &shown.header());
    let mut legend: Vec<(String, Stroke)> = Vec::new();
    canvas.clip(&area);
    if let Some((name, value)) = command {
        let stroke = Stroke::dashed(MUTED, 1.2);
        let y = panel.y.pixel(value);
        canvas.polyline(&[[area.left, y], [area.right(), y]], stroke);
        legend.push((name.to_owned(), stroke));
    }
    for (line, channel) in lines {
        let drawn = ChannelLine {
            channel,
            name: plain_name(line.name),
            factor: group.factor,
            colour: line.colour,
        };
        drawn.draw(canvas, &panel);
        legend.extend(shown.entry(line));
    }
    canvas.unclip();
    let farthest = extents.iter().filter_map(|extent| extent.farthest);
    let farthest: Vec<f64> = farthest.map(|value| group.factor * value).collect();
    panel.draw_beyond(canvas, &farthest, group.unit);
    panel.draw_legend(canvas, &shown.header(), &legend);
    panel
}

/// A channel as a line of a panel.
pub(super) struct ChannelLine<'a> {
    pub channel: &'a Channel,
    /// Its name where the panel has several.
    pub name: &'a str,
    /// From the channel's unit to the panel's.
    pub factor: f64,
    pub colour: &'static str,
}

/// `normal force F_{N}` without the symbol.
fn plain_name(name: &str) -> &str {
    name.rsplit_once(' ').map_or(name, |(plain, _)| plain)
}

impl ChannelLine<'_> {
    /// Draws the samples as a line; where a pixel holds many, the bounds of each pixel.
    pub(super) fn draw(&self, canvas: &mut Canvas, panel: &Panel) {
        let Self {
            channel,
            name,
            factor,
            colour,
        } = *self;
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
                None => canvas.data_line(&std::mem::take(&mut line), stroke, name),
            }
        }
        canvas.data_line(&line, stroke, name);
    }
}

fn draw_spectrum(
    canvas: &mut Canvas,
    panel: &Panel,
    header: &str,
    spectrum: &OrderSpectrum,
    points: &[[f64; 2]],
) {
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
    canvas.data_line(&line, Stroke::solid(PALETTE[0], 1.5), "");
    canvas.unclip();
    let harmonics = (format!("harmonics of the {}", turned(spectrum)), harmonic);
    panel.draw_legend(canvas, header, &[harmonics]);
}

/// What orders count.
fn turned(spectrum: &OrderSpectrum) -> &'static str {
    match spectrum.passes_per_turn {
        1 => "turn",
        _ => "lug pass",
    }
}

/// Name of the lower axis of the spectrum in a panel of this `width` [px].
fn spectrum_footer(spectrum: &OrderSpectrum, width: f64) -> String {
    let minor = minor_ticks(spectrum.passes_per_turn, width / ORDERS);
    let ticks = match spectrum.passes_per_turn / minor {
        _ if minor == 1 => String::new(),
        1 => "; small ticks: orders of the wheel".to_owned(),
        step => format!("; small ticks: {step} orders of the wheel apart"),
    };
    let blocks = match spectrum.passes_per_turn {
        1 => format!("{} turns", spectrum.passes),
        _ => format!("{} lug passes", spectrum.passes),
    };
    format!(
        "order per {} [-]{ticks}; Hann, {} × {blocks}",
        turned(spectrum),
        spectrum.blocks
    )
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
