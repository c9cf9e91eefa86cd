//! A measured run over what each arm of a diagnosis makes of its condition: traces and spectrum.

use super::arm_column::{ArmColumn, MEASURED, blocks, columns};
use super::channel_groups::drawable;
use super::channel_row::{
    ACCELERATION, ChannelRow, DRAWBAR_PULL, DRIVING_TORQUE, NORMAL_FORCE, SINKAGE,
};
use super::envelope::{bounds, envelope};
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, Layout, Panel, Stroke};
use crate::diagnosis::ArmTraces;
use crate::signal::density_spectrum;
use crate::trace::{Channel, Trace};

/// Height of the names of the arms [px].
const NAMES: f64 = 34.0;
/// Height of a panel [px].
const HEIGHT: f64 = 170.0;
/// Width [px] over which a trace is summed up by its least and largest sample.
const STRETCH: f64 = 3.0;
/// Bands of the spectrum in a factor of two.
const PER_OCTAVE: f64 = 12.0;
/// Decades of the spectrum shown below its largest value.
const DECADES: f64 = 4.0;

const ROWS: [ChannelRow; 4] = [NORMAL_FORCE, DRAWBAR_PULL, DRIVING_TORQUE, SINKAGE];

/// The channel whose spectrum is drawn.
const SPECTRUM: ChannelRow = ChannelRow {
    header: "Acceleration [m/s² per √Hz]",
    ..ACCELERATION
};

/// A simulated variant of the measured run.
#[derive(Clone, Copy)]
struct Simulated<'t> {
    arm: ArmColumn,
    trace: &'t Trace,
}

/// A column an arm, a row a channel, last the spectrum of the acceleration; in each panel the
/// measured run in grey and the simulated one in colour, one scale in a row. Where a line would be
/// crowded, its least and largest samples are drawn: grey beyond the coloured lines was measured and
/// not simulated. `effect` names what the last arm adds. None where no arm was simulated or nothing
/// was measured as a series. One SVG as wide as `layout` says, on a telephone with the columns one below the other.
pub fn arm_traces(traces: &ArmTraces, effect: &str, layout: Layout) -> Option<String> {
    let arms = arms(traces);
    let rows: Vec<(&ChannelRow, [f64; 2])> = ROWS
        .iter()
        .filter_map(|row| Some((row, range(traces, row)?)))
        .collect();
    let spectra = Spectra::of(&traces.measured, &arms);
    if arms.is_empty() || (rows.is_empty() && spectra.is_none()) {
        return None;
    }
    let title = format!("Measured and simulated at {}", traces.condition);
    let mut canvas = Canvas::laid_out(layout, &title);
    let drawn = Drawn {
        traces,
        rows: &rows,
        spectra: spectra.as_ref(),
        effect,
        layout,
    };
    let mut below = draw_head(&mut canvas, &title, layout);
    let numbered: Vec<(usize, Simulated)> = arms.into_iter().enumerate().collect();
    for arms in blocks(&numbered, layout) {
        below = drawn.draw_block(&mut canvas, arms, below);
    }
    canvas.set_height(below + 8.0);
    Some(canvas.finish())
}

/// What the columns show.
struct Drawn<'a> {
    traces: &'a ArmTraces,
    rows: &'a [(&'a ChannelRow, [f64; 2])],
    spectra: Option<&'a Spectra>,
    effect: &'a str,
    layout: Layout,
}

impl Drawn<'_> {
    /// Columns of some arms, each with its number, below `top` [px]; where they end.
    fn draw_block(&self, canvas: &mut Canvas, arms: &[(usize, Simulated)], top: f64) -> f64 {
        let columns = columns(arms.len(), self.layout);
        self.draw_names(canvas, arms, top);
        let mut below = top + NAMES;
        let time = [0.0, self.traces.measured.duration()];
        for (number, (row, range)) in self.rows.iter().enumerate() {
            let top = below + Panel::HEADER;
            below = top + HEIGHT;
            for ((_, simulated), [left, width]) in arms.iter().zip(&columns) {
                let area = panel_area([*left, top], *width);
                let panel = Panel {
                    area,
                    x: Axis::exact(time, [area.left, area.right()]),
                    y: Axis::roomy(*range, [area.bottom(), area.top]),
                };
                panel.draw_frame(canvas, row.header);
                canvas.clip(&area);
                draw_band(canvas, &panel, &self.traces.measured, row);
                draw_bounds(canvas, &panel, simulated, row);
                canvas.unclip();
                if number + 1 == self.rows.len() {
                    panel.draw_footer(canvas, "time [s]");
                }
            }
        }
        if !self.rows.is_empty() {
            below += Panel::FOOTER;
        }
        let Some(spectra) = self.spectra else {
            return below;
        };
        for ((number, simulated), [left, width]) in arms.iter().zip(&columns) {
            let area = panel_area([*left, below + Panel::HEADER], *width);
            spectra.draw(canvas, area, *number, simulated.arm);
        }
        below + Panel::HEADER + HEIGHT + Panel::FOOTER
    }

    fn draw_names(&self, canvas: &mut Canvas, arms: &[(usize, Simulated)], top: f64) {
        let columns = columns(arms.len(), self.layout);
        for ((_, Simulated { arm, .. }), [left, width]) in arms.iter().zip(columns) {
            let y = top + 24.0;
            let line = [[left, y - 5.0], [left + 26.0, y - 5.0]];
            canvas.polyline(&line, Stroke::solid(arm.colour(), 2.5));
            let name = Font::HEADER.fit(&arm.title(self.effect), width - 34.0);
            canvas.text([left + 34.0, y], Anchor::Start, Font::HEADER, &name);
        }
    }
}

fn panel_area([left, top]: [f64; 2], width: f64) -> Area {
    Area {
        left,
        top,
        width,
        height: HEIGHT,
    }
}

fn arms(traces: &ArmTraces) -> Vec<Simulated<'_>> {
    let ArmTraces {
        as_shipped,
        recalibrated,
        with_effect,
        ..
    } = traces;
    let made = [as_shipped, recalibrated, with_effect];
    let arms = ArmColumn::ALL.into_iter().zip(made);
    arms.filter_map(|(arm, trace)| {
        let trace = trace.as_ref()?;
        Some(Simulated { arm, trace })
    })
    .collect()
}

/// Title and what is grey; where they end [px].
fn draw_head(canvas: &mut Canvas, title: &str, layout: Layout) -> f64 {
    let mut top = 30.0;
    for line in Font::TITLE.wrap(title, layout.width - 32.0) {
        canvas.text([16.0, top], Anchor::Start, Font::TITLE, &line);
        top += 28.0;
    }
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let swatch = Area {
        left: 16.0,
        top: top - 14.0,
        width: 26.0,
        height: 12.0,
    };
    canvas.shade(&swatch, MEASURED, 0.55);
    canvas.text([50.0, top - 3.0], Anchor::Start, font, "measured");
    top
}

/// Least and largest value of a row in the unit shown; none where it was not measured.
fn range(traces: &ArmTraces, row: &ChannelRow) -> Option<[f64; 2]> {
    let measured = drawable(&traces.measured, row.channel)?;
    let simulated = arms(traces);
    let simulated = simulated
        .iter()
        .filter_map(|it| drawable(it.trace, row.channel));
    let ends = std::iter::once(measured)
        .chain(simulated)
        .filter_map(|channel| bounds(&channel.samples));
    let ends: Vec<f64> = ends.flatten().map(|value| value * row.factor).collect();
    bounds(&ends)
}

/// Stretches of a channel: time from the record's start, least and largest value in the panel's
/// unit.
fn stretches(panel: &Panel, channel: &Channel, factor: f64) -> Vec<Option<[f64; 3]>> {
    let count = (panel.area.width / STRETCH) as usize;
    let parts = envelope(&channel.samples, count);
    let length = channel.duration() / parts.len() as f64;
    let stretches = parts.into_iter().enumerate().map(|(place, bounds)| {
        let [low, high] = bounds?.map(|value| value * factor);
        Some([(place as f64 + 0.5) * length, low, high])
    });
    stretches.collect()
}

/// What was measured, as a grey band, a line where it is narrow.
fn draw_band(canvas: &mut Canvas, panel: &Panel, trace: &Trace, row: &ChannelRow) {
    let Some(channel) = drawable(trace, row.channel) else {
        return;
    };
    let parts = stretches(panel, channel, row.factor);
    for piece in parts.split(Option::is_none) {
        let piece: Vec<[f64; 3]> = piece.iter().copied().flatten().collect();
        let above = piece.iter().map(|[time, _, high]| panel.at([*time, *high]));
        let below = piece.iter().rev();
        let below = below.map(|[time, low, _]| panel.at([*time, *low]));
        let outline: Vec<[f64; 2]> = above.chain(below).collect();
        canvas.data_area(
            &outline,
            "#c6ccd6",
            Stroke::solid(MEASURED, 1.0),
            "measured",
        );
    }
}

/// What was simulated, as its lower and upper bound.
fn draw_bounds(canvas: &mut Canvas, panel: &Panel, simulated: &Simulated, row: &ChannelRow) {
    let Some(channel) = drawable(simulated.trace, row.channel) else {
        return;
    };
    let parts = stretches(panel, channel, row.factor);
    let stroke = Stroke::solid(simulated.arm.colour(), 1.3);
    for piece in parts.split(Option::is_none) {
        let piece: Vec<[f64; 3]> = piece.iter().copied().flatten().collect();
        let line = |end: usize| -> Vec<[f64; 2]> {
            let points = piece.iter().map(|part| panel.at([part[0], part[end]]));
            points.collect()
        };
        let (low, high) = (line(1), line(2));
        canvas.data_line(&low, stroke, "simulated");
        if low != high {
            canvas.data_line(&high, stroke, "simulated");
        }
    }
}

/// Spectra in bands: measured, and of each arm where it has one.
struct Spectra {
    measured: Vec<[f64; 2]>,
    arms: Vec<Vec<[f64; 2]>>,
}

impl Spectra {
    /// None where the acceleration was not measured as a series.
    fn of(measured: &Trace, arms: &[Simulated]) -> Option<Self> {
        let measured = bands(measured)?;
        let arms = arms.iter();
        Some(Self {
            measured,
            arms: arms.map(|it| bands(it.trace).unwrap_or_default()).collect(),
        })
    }

    /// The spectrum of the arm with this number beside the measured one.
    fn draw(&self, canvas: &mut Canvas, area: Area, number: usize, arm: ArmColumn) {
        let all = || self.arms.iter().chain([&self.measured]).flatten();
        let ends = |place: usize| {
            let values: Vec<f64> = all().map(|point| point[place]).collect();
            bounds(&values)
        };
        let (Some(hertz), Some([low, high])) = (ends(0), ends(1)) else {
            return;
        };
        let low = low.max(high * libm::pow(10.0, -DECADES));
        let panel = Panel {
            area,
            x: Axis::decades(hertz, [area.left, area.right()]),
            y: Axis::decades([low, high], [area.bottom(), area.top]),
        };
        panel.draw_frame(canvas, SPECTRUM.header);
        canvas.clip(&area);
        let path = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().map(|point| panel.at(*point)).collect()
        };
        let measured = Stroke::solid(MEASURED, 4.0);
        canvas.data_line(&path(&self.measured), measured, "measured");
        let own = Stroke::solid(arm.colour(), 1.6);
        canvas.data_line(&path(&self.arms[number]), own, "simulated");
        canvas.unclip();
        panel.draw_footer(canvas, "frequency [Hz]");
    }
}

/// Frequency [Hz] and density of the acceleration in bands; none without a spectrum above 0.
fn bands(trace: &Trace) -> Option<Vec<[f64; 2]>> {
    let spectrum = density_spectrum(trace.channel(SPECTRUM.channel)?).ok()?;
    let mut bands: Vec<(i32, [f64; 3])> = Vec::new();
    for (line, density) in spectrum.density.iter().enumerate().skip(1) {
        let hertz = line as f64 * spectrum.spacing;
        let band = libm::floor(PER_OCTAVE * libm::log2(hertz)) as i32;
        let own = [1.0, hertz, density * density];
        match bands.last_mut() {
            Some((last, sums)) if *last == band => {
                for (sum, own) in sums.iter_mut().zip(own) {
                    *sum += own;
                }
            }
            _ => bands.push((band, own)),
        }
    }
    let means = bands
        .into_iter()
        .map(|(_, [count, hertz, square])| [hertz / count, libm::sqrt(square / count)]);
    let points: Vec<[f64; 2]> = means.filter(|[_, density]| *density > 0.0).collect();
    (!points.is_empty()).then_some(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::Condition;

    fn trace(name: &str, value: impl Fn(f64) -> f64) -> Trace {
        let samples = (0..4000).map(|i| value(f64::from(i) / 1000.0));
        Trace {
            channels: vec![Channel {
                name: name.to_owned(),
                unit: String::new(),
                sample_rate: 1000.0,
                start: 0.0,
                samples: samples.collect(),
            }],
            ..Trace::default()
        }
    }

    fn beside(measured: Trace, as_shipped: Option<Trace>) -> ArmTraces {
        ArmTraces {
            condition: Condition::from("slip 0.1 <b>"),
            measured,
            as_shipped,
            recalibrated: None,
            with_effect: None,
        }
    }

    #[test]
    fn a_tone_stands_in_its_band() {
        let tone = trace("acceleration_y", |t| libm::sin(300.0 * t));
        let bands = bands(&tone).unwrap();
        let largest = bands.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
        // 47.7 Hz; bands are 6 % wide.
        assert!((largest[0] - 47.7).abs() < 2.0, "{largest:?}");
    }

    #[test]
    fn what_was_not_measured_is_not_drawn_and_without_an_arm_nothing_is() {
        let pull = || trace("drawbar_pull", libm::cos);
        let svg = arm_traces(&beside(pull(), Some(pull())), "", Layout::SCREEN).unwrap();
        assert!(svg.contains("Drawbar pull") && !svg.contains("Sinkage"));
        assert!(svg.contains("slip 0.1 &lt;b&gt;") && !svg.contains("with "));
        assert_eq!(arm_traces(&beside(pull(), None), "", Layout::SCREEN), None);
        let means_only = Trace::default();
        assert_eq!(
            arm_traces(&beside(means_only, Some(pull())), "", Layout::SCREEN),
            None
        );
    }

    #[test]
    fn samples_that_are_no_numbers_leave_gaps() {
        let broken = trace("drawbar_pull", |t| if t < 2.0 { f64::NAN } else { 1.0 });
        let silent = trace("acceleration_y", |_| f64::NAN);
        let svg = arm_traces(
            &beside(broken.clone(), Some(silent.clone())),
            "",
            Layout::TELEPHONE,
        )
        .unwrap();
        assert!(!svg.contains("NaN"));
        assert_eq!(
            arm_traces(&beside(silent, Some(broken)), "", Layout::SCREEN),
            None
        );
    }
}
