//! Runs beside each other, to compare them by eye.

use super::channel_groups::drawable;
use super::channel_row::{ACCELERATION, ChannelRow, DRAWBAR_PULL, DRIVING_TORQUE, SINKAGE};
use super::envelope::{bounds, extent};
use super::figure::{Anchor, Area, Axis, Canvas, Font, PALETTE, Panel};
use super::trace_figure::ChannelLine;
use crate::trace::{Channel, Trace};

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Room left of each panel for its tick labels [px].
const TICKS: f64 = 62.0;
/// Room at the right edge [px].
const RIGHT: f64 = 16.0;
/// Height of the line with the names of the runs [px].
const NAMES: f64 = 34.0;
/// Height of a panel [px].
const HEIGHT: f64 = 130.0;

/// Rows and their colours.
const ROWS: [(ChannelRow, &str); 4] = [
    (ACCELERATION, PALETTE[0]),
    (DRAWBAR_PULL, PALETTE[1]),
    (DRIVING_TORQUE, PALETTE[2]),
    (SINKAGE, PALETTE[3]),
];

/// The same channels of several named runs from `start` to `end` \[s\] as one SVG 1200 px wide: a
/// column a run, a row a channel, and one scale in each row. A channel that no run has is left out.
pub fn side_by_side(runs: &[(&str, &Trace)], time: [f64; 2]) -> String {
    let mut canvas = Canvas::new([WIDTH, 0.0], "Runs side by side");
    let columns = columns(runs.len());
    for ((name, _), column) in runs.iter().zip(&columns) {
        let at = [column[0], NAMES - 8.0];
        let name = Font::TITLE.fit(name, column[1] - column[0]);
        canvas.text(at, Anchor::Start, Font::TITLE, &name);
    }
    let mut below = NAMES;
    let rows: Vec<(&ChannelRow, &str, [f64; 2])> = ROWS
        .iter()
        .filter_map(|(row, colour)| Some((row, *colour, range(runs, row, time)?)))
        .collect();
    for (i, (row, colour, range)) in rows.iter().enumerate() {
        let top = below + Panel::HEADER;
        below = top + HEIGHT;
        let is_last = i + 1 == rows.len();
        for ((_, trace), [left, right]) in runs.iter().zip(&columns) {
            let area = Area {
                left: *left,
                top,
                width: right - left,
                height: HEIGHT,
            };
            let panel = Panel {
                area,
                x: Axis::exact(time, [area.left, area.right()]),
                y: Axis::roomy(*range, [area.bottom(), area.top]),
            };
            let header = if *left == columns[0][0] {
                row.header
            } else {
                ""
            };
            panel.draw_frame(&mut canvas, header);
            canvas.clip(&panel.area);
            if let Some(channel) = drawable(trace, row.channel) {
                let line = ChannelLine {
                    channel,
                    name: "",
                    factor: row.factor,
                    colour,
                };
                line.draw(&mut canvas, &panel);
            }
            canvas.unclip();
            if let Some(channel) = drawable(trace, row.channel) {
                let ends = ends(&panel, channel, row.factor);
                panel.draw_beyond(&mut canvas, &ends, row.unit());
            }
            if is_last {
                panel.draw_footer(&mut canvas, "time [s]");
            }
        }
    }
    canvas.set_height(below + Panel::FOOTER + 8.0);
    canvas.finish()
}

/// Left and right edge [px] of each of `count` columns.
fn columns(count: usize) -> Vec<[f64; 2]> {
    let pitch = (WIDTH - RIGHT) / count.max(1) as f64;
    (0..count)
        .map(|i| i as f64 * pitch)
        .map(|left| [left + TICKS, left + pitch])
        .collect()
}

/// The scale of the row in this time, in the unit shown.
fn range(runs: &[(&str, &Trace)], row: &ChannelRow, [start, end]: [f64; 2]) -> Option<[f64; 2]> {
    let channels = runs
        .iter()
        .filter_map(|(_, trace)| drawable(trace, row.channel));
    let samples = channels.flat_map(|channel| channel.between(start, end));
    let samples: Vec<f64> = samples.map(|value| value * row.factor).collect();
    extent(&samples).map(|extent| extent.range)
}

/// Least and greatest value of a channel in the time of a panel, in the unit shown.
fn ends(panel: &Panel, channel: &Channel, factor: f64) -> Vec<f64> {
    let ends = bounds(channel.between(panel.x.low, panel.x.high));
    let ends = ends.into_iter().flatten();
    ends.map(|value| value * factor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(name: &str, samples: &[f64]) -> Trace {
        let channel = Channel {
            name: name.to_owned(),
            unit: "N".to_owned(),
            sample_rate: 1.0,
            start: 0.0,
            samples: samples.to_vec(),
        };
        Trace {
            channels: vec![channel],
            ..Trace::default()
        }
    }

    #[test]
    fn a_row_has_one_scale_and_a_channel_that_no_run_has_is_left_out() {
        let (weak, strong) = (
            run("drawbar_pull", &[1.0, 2.0]),
            run("drawbar_pull", &[10.0, 60.0, 900.0]),
        );
        let runs = [("weak", &weak), ("strong", &strong)];
        assert_eq!(range(&runs, &DRAWBAR_PULL, [0.0, 2.0]), Some([1.0, 60.0]));
        let svg = side_by_side(&runs, [0.0, 2.0]);
        assert_eq!(svg.matches(">Drawbar pull [N]<").count(), 1);
        assert_eq!(
            svg.matches(">60<").count(),
            2,
            "a tick in each column: {svg}"
        );
        assert!(!svg.contains("Sinkage"), "{svg}");
    }

    #[test]
    fn no_runs_and_runs_without_channels_make_an_empty_drawing() {
        let bare = Trace::default();
        for runs in [&[][..], &[("<bare>", &bare)]] {
            let svg = side_by_side(runs, [0.0, 1.0]);
            assert!(svg.starts_with("<svg") && !svg.contains("<bare>"), "{svg}");
        }
    }
}
