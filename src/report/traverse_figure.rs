//! A run on its way over the grounds: its vibration and the class of every window (Fig. 20).

use super::ReportError;
use super::channel_groups::drawable;
use super::class_strip::{ClassSpan, keys};
use super::envelope::bounds;
use super::figure::{Anchor, Area, Axis, Canvas, Font, MUTED, PALETTE, Panel, Stroke};
use super::trace_figure::ChannelLine;
use crate::recognition::Recognized;
use crate::statistics::upper_median;
use crate::table::four_digits;
use crate::trace::{Channel, Trace};

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Left edge of the panels [px], right of their tick labels.
const LEFT: f64 = 84.0;
/// Room at the right edge [px].
const RIGHT: f64 = 28.0;
/// Height of the title [px].
const TITLE: f64 = 42.0;
/// Height of the panel [px].
const HEIGHT: f64 = 260.0;
/// Height of a strip of classes [px].
const STRIP: f64 = 24.0;

/// The acceleration of run `id` over time, the borders of its windows, the class recognised in each
/// by the first method asked with its confidence, and the true class where it is known. One SVG
/// 1200 px wide.
///
/// # Errors
/// `Empty` when the run has no acceleration that can be drawn.
pub fn traverse_figure(
    trace: &Trace,
    id: &str,
    windows: &[Recognized],
) -> Result<String, ReportError> {
    let acceleration =
        drawable(trace, "acceleration_y").ok_or_else(|| ReportError::Empty(id.to_owned()))?;
    let end = acceleration.start + acceleration.duration();
    let area = Area {
        left: LEFT,
        top: TITLE + Panel::HEADER,
        width: WIDTH - LEFT - RIGHT,
        height: HEIGHT,
    };
    let (range, cut) = shown_range(acceleration, windows);
    let panel = Panel {
        area,
        x: Axis::exact([acceleration.start, end], [area.left, area.right()]),
        y: Axis::roomy(range, [area.bottom(), area.top]),
    };
    let mut canvas = Canvas::new([WIDTH, 0.0], &format!("Run {id} and its classes"));
    let title = Font::TITLE.fit(&format!("Run {id}"), WIDTH - 2.0 * RIGHT);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &title);
    let borders = (String::from("window"), Stroke::dashed(MUTED, 1.2));
    let header = format!("Vertical acceleration of the axle [m/s²]{cut}");
    panel.draw_frame(&mut canvas, &header);
    panel.draw_legend(&mut canvas, &header, &[borders]);
    canvas.clip(&area);
    let line = ChannelLine {
        channel: acceleration,
        name: "",
        factor: 1.0,
        colour: PALETTE[0],
    };
    line.draw(&mut canvas, &panel);
    for time in windows.iter().flat_map(|window| [window.start, window.end]) {
        let x = panel.x.pixel(time);
        let border = [[x, area.top], [x, area.bottom()]];
        canvas.polyline(&border, Stroke::dashed(MUTED, 1.2));
    }
    canvas.unclip();
    panel.draw_footer(&mut canvas, "time [s]");
    let below = draw_strips(&mut canvas, &panel, &recognized(windows), &truth(trace));
    canvas.set_height(below + 16.0);
    Ok(canvas.finish())
}

/// Times the median of the windows' peaks from which a peak is cut, so that the others show.
const CUT: f64 = 4.0;

/// From least to greatest sample, without peaks far beyond those of most windows; a remark on what
/// is cut.
fn shown_range(acceleration: &Channel, windows: &[Recognized]) -> ([f64; 2], String) {
    let [low, high] = bounds(&acceleration.samples).unwrap_or([-1.0, 1.0]);
    let peak = |window: &Recognized| {
        let samples = bounds(acceleration.between(window.start, window.end));
        samples.map(|[low, high]| high.max(-low))
    };
    let limit = CUT * upper_median(windows.iter().filter_map(peak)).unwrap_or(0.0);
    let highest = high.max(-low);
    if limit == 0.0 || highest <= 2.0 * limit {
        return ([low, high], String::new());
    }
    let remark = format!("; cut, peaks reach {}", four_digits(highest));
    ([low.max(-limit), high.min(limit)], remark)
}

/// The class of every window with its confidence.
fn recognized(windows: &[Recognized]) -> Vec<ClassSpan> {
    let spans = windows.iter().filter_map(|window| {
        let answer = window.answers.first()?;
        Some(ClassSpan {
            time: [window.start, window.end],
            class: answer.class,
            name: format!("{} {:.2}", answer.class, answer.confidence),
        })
    });
    spans.collect()
}

/// The true class over time.
fn truth(trace: &Trace) -> Vec<ClassSpan> {
    let windows = trace.truth.iter().flat_map(|truth| &truth.class_windows);
    let spans = windows.map(|window| ClassSpan {
        time: [window.start, window.end],
        class: window.class,
        name: format!("{} on {}", window.class, window.terrain),
    });
    spans.collect()
}

/// The strips below the panel; where they end [px].
fn draw_strips(
    canvas: &mut Canvas,
    panel: &Panel,
    recognized: &[ClassSpan],
    truth: &[ClassSpan],
) -> f64 {
    let mut below = panel.area.bottom() + Panel::FOOTER;
    for (header, spans) in [
        ("Recognised, with confidence", recognized),
        ("True class", truth),
    ] {
        if spans.is_empty() {
            continue;
        }
        let strip = Area {
            top: below + Panel::HEADER,
            height: STRIP,
            ..panel.area
        };
        let header_at = [strip.left, strip.top - 9.0];
        canvas.text(header_at, Anchor::Start, Font::HEADER, header);
        canvas.clip(&strip);
        for span in spans {
            span.draw(canvas, &panel.x, &strip);
        }
        canvas.unclip();
        below = strip.bottom();
    }
    let legend = Panel {
        area: Area {
            top: below + Panel::HEADER,
            ..panel.area
        },
        ..*panel
    };
    let all = recognized.iter().chain(truth);
    legend.draw_legend(canvas, "", &keys(all.map(|span| span.class)));
    legend.area.top
}
