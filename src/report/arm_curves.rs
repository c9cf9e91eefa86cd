//! Steady forces and sinkage against slip: measured, and by each arm of a diagnosis.

use super::arm_column::{ArmColumn, blocks, columns};
use super::channel_row::{ChannelRow, DRAWBAR_PULL, DRIVING_TORQUE, SINKAGE};
use super::envelope::bounds;
use super::figure::{
    Anchor, Area, Axis, Canvas, Font, INK, Layout, PALETTE, Panel, Stroke, reading,
};
use crate::diagnosis::InUnits;
use crate::diagnosis::condition::Case;
use crate::gap::Statistic;
use crate::table::four_digits;
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
/// names what the last arm adds. None where no steady value stands beside a slip. One SVG as wide as `layout` says, on a
/// telephone with the columns one below the other.
pub fn arm_curves(
    in_units: &[InUnits],
    cases: &[Case],
    effect: &str,
    layout: Layout,
) -> Option<String> {
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
    let mut canvas = Canvas::laid_out(layout, title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let mut below = draw_legend(&mut canvas, &groups, layout) + 8.0;
    let drawn = Drawn {
        rows: &rows,
        groups: &groups,
        effect,
        layout,
    };
    for arms in blocks(&arms, layout) {
        below = drawn.draw_block(&mut canvas, arms, below);
    }
    canvas.set_height(below + 8.0);
    Some(canvas.finish())
}

/// What the columns show.
struct Drawn<'a> {
    rows: &'a [(&'a ChannelRow, Curves)],
    /// Load and speed of the curves.
    groups: &'a [String],
    effect: &'a str,
    layout: Layout,
}

impl Drawn<'_> {
    /// Columns of some arms below `top` [px]; where they end.
    fn draw_block(&self, canvas: &mut Canvas, arms: &[ArmColumn], top: f64) -> f64 {
        let columns = columns(arms.len(), self.layout);
        for (arm, [left, width]) in arms.iter().zip(&columns) {
            let name = Font::HEADER.fit(&arm.title(self.effect), *width);
            canvas.text([*left, top + 16.0], Anchor::Start, Font::HEADER, &name);
        }
        let mut below = top + LINE;
        for (number, (row, curves)) in self.rows.iter().enumerate() {
            let top = below + Panel::HEADER;
            below = top + HEIGHT;
            for (arm, [left, width]) in arms.iter().zip(&columns) {
                let area = Area {
                    left: *left,
                    top,
                    width: *width,
                    height: HEIGHT,
                };
                let panel = panel(area, curves);
                panel.draw_frame(canvas, row.header);
                for (group, points) in curves.iter().enumerate() {
                    let shown = Shown {
                        header: row.header,
                        group: &self.groups[group],
                        arm: *arm,
                        colour: PALETTE[group % PALETTE.len()],
                    };
                    shown.draw(canvas, &panel, points);
                }
                if number + 1 == self.rows.len() {
                    panel.draw_footer(canvas, "slip ratio s_{} [-]");
                }
            }
        }
        below + Panel::FOOTER
    }
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

/// Which points a panel shows, and how.
struct Shown<'a> {
    header: &'a str,
    /// Load and speed.
    group: &'a str,
    arm: ArmColumn,
    colour: &'static str,
}

impl Shown<'_> {
    fn draw(&self, canvas: &mut Canvas, panel: &Panel, points: &[Point]) {
        let simulated = points.iter();
        let simulated = simulated.filter_map(|it| Some([it.slip, it.arms[self.arm as usize]?]));
        let simulated: Vec<[f64; 2]> = simulated.collect();
        let path: Vec<[f64; 2]> = simulated.iter().map(|point| panel.at(*point)).collect();
        let stroke = Stroke::solid(self.colour, 1.8);
        canvas.polyline(&path, stroke);
        for (at, point) in path.into_iter().zip(simulated) {
            let reading = self.reading("simulated", point);
            canvas.mark(&reading, |canvas| draw_cross(canvas, at, stroke));
        }
        for point in points {
            let point = [point.slip, point.measured];
            let reading = self.reading("measured", point);
            canvas.mark(&reading, |canvas| {
                canvas.point(panel.at(point), self.colour)
            });
        }
    }

    fn reading(&self, whose: &str, [slip, value]: [f64; 2]) -> String {
        let value = reading(self.header, value);
        format!(
            "{whose}: {value} at slip ratio {}, {}",
            four_digits(slip),
            self.group
        )
    }
}

fn draw_cross(canvas: &mut Canvas, [x, y]: [f64; 2], stroke: Stroke) {
    const ARM: f64 = 5.0;
    canvas.polyline(&[[x - ARM, y - ARM], [x + ARM, y + ARM]], stroke);
    canvas.polyline(&[[x - ARM, y + ARM], [x + ARM, y - ARM]], stroke);
}

/// Where it ends [px].
fn draw_legend(canvas: &mut Canvas, groups: &[String], layout: Layout) -> f64 {
    let mut top = 54.0;
    let text = "Marks: measured. Lines with crosses: simulated, fitted to all conditions.";
    for line in Font::SMALL.wrap(text, layout.width - 32.0) {
        canvas.text([16.0, top], Anchor::Start, Font::SMALL, &line);
        top += LINE;
    }
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let mut left = 16.0;
    for (number, name) in groups.iter().enumerate() {
        let width = 42.0 + font.width(name) + 18.0;
        if left + width > layout.width - 16.0 {
            left = 16.0;
            top += LINE;
        }
        let (colour, y) = (PALETTE[number % PALETTE.len()], top - 5.0);
        let line = [[left, y], [left + 32.0, y]];
        canvas.polyline(&line, Stroke::solid(colour, 1.8));
        canvas.point([left + 16.0, y], colour);
        canvas.text([left + 42.0, top], Anchor::Start, font, name);
        left += width;
    }
    top
}
