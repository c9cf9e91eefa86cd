//! Steady forces and sinkage against slip: measured, and by each arm of a diagnosis.

use super::arm_column::{ArmColumn, WIDTH, columns};
use super::channel_row::{ChannelRow, DRAWBAR_PULL, DRIVING_TORQUE, SINKAGE};
use super::envelope::bounds;
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, PALETTE, Panel, Stroke};
use crate::diagnosis::InUnits;
use crate::diagnosis::condition::Case;
use crate::gap::Statistic;
use crate::trace::RunAttributes;

/// Height of a panel [px].
const HEIGHT: f64 = 200.0;
/// Height of a line of text [px].
const LINE: f64 = 22.0;

const ROWS: [ChannelRow; 3] = [DRAWBAR_PULL, DRIVING_TORQUE, SINKAGE];

/// A steady value at a condition, in the unit shown.
struct Point {
    slip: f64,
    measured: f64,
    arms: [Option<f64>; 3],
}

/// Points of one channel, of one load and speed each, by slip.
type Curves = Vec<Vec<Point>>;

/// Steady pull, torque and sinkage against slip: a column an arm, a row a channel; marks are means of
/// the measured runs, lines with crosses what the arm gives, one colour a load and speed. `effect`
/// names what the last arm adds. None where no steady value stands beside a slip. One SVG 1200 px
/// wide.
pub fn arm_curves(in_units: &[InUnits], cases: &[Case], effect: &str) -> Option<String> {
    let groups = groups(cases);
    let rows: Vec<(&ChannelRow, Curves)> = ROWS
        .iter()
        .map(|row| (row, curves(in_units, cases, &groups, row)))
        .filter(|(_, curves)| curves.iter().any(|points| !points.is_empty()))
        .collect();
    let has = |arm: &ArmColumn| {
        let mut points = rows.iter().flat_map(|(_, curves)| curves.iter().flatten());
        points.any(|point| point.arms[*arm as usize].is_some())
    };
    let arms: Vec<ArmColumn> = ArmColumn::ALL.into_iter().filter(has).collect();
    if arms.is_empty() {
        return None;
    }
    let title = "Steady values against slip";
    let mut canvas = Canvas::new([WIDTH, 0.0], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let mut below = draw_legend(&mut canvas, &groups) + 8.0;
    for (arm, [left, width]) in arms.iter().zip(columns(arms.len())) {
        let name = Font::HEADER.fit(&arm.title(effect), width);
        canvas.text([left, below + 16.0], Anchor::Start, Font::HEADER, &name);
    }
    below += LINE;
    for (number, (row, curves)) in rows.iter().enumerate() {
        let top = below + Panel::HEADER;
        below = top + HEIGHT;
        for (arm, [left, width]) in arms.iter().zip(columns(arms.len())) {
            let area = Area {
                left,
                top,
                width,
                height: HEIGHT,
            };
            let panel = panel(area, curves);
            panel.draw_frame(&mut canvas, row.header);
            for (group, points) in curves.iter().enumerate() {
                let colour = PALETTE[group % PALETTE.len()];
                draw_points(&mut canvas, &panel, points, *arm, colour);
            }
            if number + 1 == rows.len() {
                panel.draw_footer(&mut canvas, "slip ratio s [-]");
            }
        }
    }
    canvas.set_height(below + Panel::FOOTER + 8.0);
    Some(canvas.finish())
}

/// Load and speed, by which runs are grouped.
fn name(attributes: &RunAttributes) -> String {
    let RunAttributes { load, speed, .. } = attributes;
    format!("{load:.0} N at {:.0} mm/s", 1.0e3 * speed)
}

fn groups(cases: &[Case]) -> Vec<String> {
    let mut groups: Vec<String> = Vec::new();
    for case in cases {
        let name = name(&case.attributes);
        if !groups.contains(&name) {
            groups.push(name);
        }
    }
    groups
}

fn curves(in_units: &[InUnits], cases: &[Case], groups: &[String], shown: &ChannelRow) -> Curves {
    let of_row = in_units.iter().filter(|row| {
        row.cell.statistic == Statistic::SteadyMean && &*row.cell.channel == shown.channel
    });
    let mut curves: Curves = groups.iter().map(|_| Vec::new()).collect();
    for row in of_row {
        let mut places = cases.iter();
        let Some(case) = places.find(|case| case.condition == row.condition) else {
            continue;
        };
        let own = name(&case.attributes);
        let group = groups.iter().position(|group| *group == own);
        let scaled = |value: Option<f64>| value.filter(|x| x.is_finite()).map(|x| x * shown.factor);
        let slip = case.attributes.slip_ratio;
        if let (Some(group), Some(measured), true) =
            (group, scaled(Some(row.measured)), slip.is_finite())
        {
            let arms = [Some(row.as_shipped), row.recalibrated, row.with_effect];
            curves[group].push(Point {
                slip,
                measured,
                arms: arms.map(scaled),
            });
        }
    }
    for points in &mut curves {
        points.sort_by(|a, b| a.slip.total_cmp(&b.slip));
    }
    curves
}

fn panel(area: Area, curves: &Curves) -> Panel {
    let points = || curves.iter().flatten();
    let slips: Vec<f64> = points().map(|point| point.slip).collect();
    let values = points().flat_map(|point| {
        let arms = point.arms.into_iter().flatten();
        arms.chain([point.measured])
    });
    let values: Vec<f64> = values.collect();
    let [low, high] = bounds(&values).unwrap_or([0.0, 1.0]);
    Panel {
        area,
        x: Axis::roomy(
            bounds(&slips).unwrap_or([0.0, 1.0]),
            [area.left, area.right()],
        ),
        // From 0 on, or differences of a per cent look like trends.
        y: Axis::roomy([low.min(0.0), high.max(0.0)], [area.bottom(), area.top]),
    }
}

fn draw_points(
    canvas: &mut Canvas,
    panel: &Panel,
    points: &[Point],
    arm: ArmColumn,
    colour: &'static str,
) {
    let simulated = points
        .iter()
        .filter_map(|point| Some(panel.at([point.slip, point.arms[arm as usize]?])));
    let simulated: Vec<[f64; 2]> = simulated.collect();
    let stroke = Stroke::solid(colour, 1.8);
    canvas.polyline(&simulated, stroke);
    for [x, y] in simulated {
        draw_cross(canvas, [x, y], stroke);
    }
    for point in points {
        let at = panel.at([point.slip, point.measured]);
        canvas.circle(at, 5.0, colour, Stroke::solid("#ffffff", 1.0));
    }
}

fn draw_cross(canvas: &mut Canvas, [x, y]: [f64; 2], stroke: Stroke) {
    const ARM: f64 = 5.0;
    canvas.polyline(&[[x - ARM, y - ARM], [x + ARM, y + ARM]], stroke);
    canvas.polyline(&[[x - ARM, y + ARM], [x + ARM, y - ARM]], stroke);
}

/// Where it ends [px].
fn draw_legend(canvas: &mut Canvas, groups: &[String]) -> f64 {
    let mut top = 54.0;
    let text = "Marks: measured. Lines with crosses: simulated, fitted to all conditions.";
    canvas.text([16.0, top], Anchor::Start, Font::SMALL, text);
    top += LINE;
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let mut left = 16.0;
    for (number, name) in groups.iter().enumerate() {
        let width = 42.0 + font.width(name) + 18.0;
        if left + width > WIDTH - 16.0 {
            left = 16.0;
            top += LINE;
        }
        let (colour, y) = (PALETTE[number % PALETTE.len()], top - 5.0);
        let line = [[left, y], [left + 32.0, y]];
        canvas.polyline(&line, Stroke::solid(colour, 1.8));
        canvas.circle([left + 16.0, y], 5.0, colour, Stroke::solid("#ffffff", 1.0));
        canvas.text([left + 42.0, top], Anchor::Start, font, name);
        left += width;
    }
    top
}
