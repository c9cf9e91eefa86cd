//! Measured forces and sinkage, and those that identified parameters predict, against slip
//! (Fig. 25-27).

use super::envelope::bounds;
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, PALETTE, Panel, Stroke, reading};
use crate::identification::{
    Estimate, Predicted, Prediction, Predictor, RIGID_SINKAGE, SteadyLoad,
};
use crate::statistics::mean;
use crate::table::four_digits;
use crate::terrain::class::Wtic;

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Margin at the sides [px].
const MARGIN: f64 = 16.0;
/// Room left of a panel for its tick labels [px].
const TICKS: f64 = 62.0;
/// Room right of a panel [px].
const RIGHT: f64 = 18.0;
/// Height of a panel [px].
const HEIGHT: f64 = 270.0;
/// Height of a line of text [px].
const LINE: f64 = 22.0;
/// Half of a bar's foot, and of a cross [px].
const FOOT: f64 = 4.0;
/// Ratio of neighbouring loads [-] from which they are two.
const APART: f64 = 1.1;
/// Slips [-] closer than this are one point of a curve.
const SAME_SLIP: f64 = 0.01;
/// Points of a curve between two slips.
const POINTS: usize = 12;
/// Room [of the range of marks and lines] that is left for the ends of intervals.
const ROOM: f64 = 0.5;

/// What a panel shows.
struct Quantity {
    header: &'static str,
    measured: fn(&SteadyLoad) -> f64,
    /// Standard uncertainty.
    deviation: fn(&SteadyLoad) -> f64,
    /// What is predicted from load and slip; none of the load itself.
    predicted: Option<fn(&Prediction) -> Predicted>,
    /// By how much the panel's unit is finer than SI's.
    scale: f64,
    /// Whether a wheel held by static friction does not show it.
    slips: bool,
}

const QUANTITIES: [Quantity; 4] = [
    Quantity {
        header: "Drawbar pull F_{DP} [N]",
        measured: |row| row.drawbar_pull,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.drawbar_pull),
        predicted: Some(|prediction| prediction.drawbar_pull),
        scale: 1.0,
        slips: true,
    },
    Quantity {
        header: "Load W_{} [N]",
        measured: |row| row.load,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.load),
        predicted: None,
        scale: 1.0,
        slips: false,
    },
    Quantity {
        header: "Driving torque T_{D} [N·m]",
        measured: |row| row.driving_torque,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.driving_torque),
        predicted: Some(|prediction| prediction.driving_torque),
        scale: 1.0,
        slips: true,
    },
    Quantity {
        header: "Sinkage of the rim z_{} [mm]",
        measured: |row| 1.0e3 * row.sinkage,
        deviation: |row| row.uncertainty.map_or(0.0, |u| 1.0e3 * u.sinkage),
        predicted: Some(|prediction| prediction.sinkage),
        scale: 1.0e3,
        slips: false,
    },
];

/// Pull, torque and, where lugs enter soil, sinkage against slip as measured (marks, bars of one
/// standard uncertainty) and as predicted from load and slip (lines, dashed the interval that
/// holds 95 % of measurements), and the load beside what Eq. (62) gives at the sinkage measured
/// (crosses); one colour a load. One SVG 1200 px wide.
///
/// Between rows a line takes the load between theirs. Rows of hard ground that static friction
/// holds are hollow: no shear law gives their pull and torque. Where the soil does not carry the
/// load there is no line.
pub fn force_curves(
    title: &str,
    estimate: &Estimate,
    predictor: &Predictor,
    rows: &[SteadyLoad],
) -> String {
    let curves = Curves {
        estimate,
        predictor,
        loads: by_load(rows),
    };
    let mut canvas = Canvas::new([WIDTH, 0.0], title);
    let top = curves.draw_head(&mut canvas, title);
    let shown = if estimate.class == Wtic::Leis { 4 } else { 3 };
    let columns = if shown == 4 { 2 } else { 3 };
    let pitch = [
        WIDTH / columns as f64,
        Panel::HEADER + HEIGHT + Panel::FOOTER + 10.0,
    ];
    for (number, quantity) in QUANTITIES.iter().take(shown).enumerate() {
        let area = Area {
            left: (number % columns) as f64 * pitch[0] + TICKS,
            top: top + (number / columns) as f64 * pitch[1] + Panel::HEADER,
            width: pitch[0] - TICKS - RIGHT,
            height: HEIGHT,
        };
        curves.draw_panel(&mut canvas, area, quantity);
    }
    canvas.set_height(top + (shown / columns) as f64 * pitch[1]);
    canvas.finish()
}

/// What is drawn.
struct Curves<'a> {
    estimate: &'a Estimate,
    predictor: &'a Predictor,
    /// Rows of one load each, by slip.
    loads: Vec<Vec<SteadyLoad>>,
}

/// A point of a line: slip, value and the ends of its interval.
#[derive(Debug, Clone, Copy)]
struct Point {
    slip: f64,
    value: f64,
    ends: [f64; 2],
}

impl Curves<'_> {
    /// Title, remark and legend; where they end [px].
    fn draw_head(&self, canvas: &mut Canvas, title: &str) -> f64 {
        let mut top = MARGIN + 14.0;
        let fitted = Font::TITLE.fit(title, WIDTH - 2.0 * MARGIN);
        canvas.text([MARGIN, top], Anchor::Start, Font::TITLE, &fitted);
        for line in Font::SMALL.wrap(&self.remark(), WIDTH - 2.0 * MARGIN) {
            top += LINE;
            canvas.text([MARGIN, top], Anchor::Start, Font::SMALL, &line);
        }
        top += LINE + 2.0;
        let font = Font {
            colour: INK,
            ..Font::SMALL
        };
        let mut left = MARGIN;
        for (number, rows) in self.loads.iter().enumerate() {
            let load = mean(loads(rows)).unwrap_or(f64::NAN);
            let name = format!("load {load:.0} N");
            let width = 42.0 + font.width(&name) + 18.0;
            if left + width > WIDTH - MARGIN {
                left = MARGIN;
                top += LINE;
            }
            let (colour, y) = (colour(number), top - 5.0);
            let line = [[left, y], [left + 32.0, y]];
            canvas.polyline(&line, Stroke::solid(colour, 2.0));
            canvas.point([left + 16.0, y], colour);
            canvas.text([left + 42.0, top], Anchor::Start, font, &name);
            left += width;
        }
        top + 8.0
    }

    /// What marks and lines are.
    fn remark(&self) -> String {
        let sinkage = if self.estimate.class == Wtic::Leis {
            "the sinkage measured".to_owned()
        } else {
            format!("a sinkage of {} mm", 1.0e3 * RIGID_SINKAGE)
        };
        let held = if self.holds_any() {
            " Hollow: held by static friction, pull and torque not fitted."
        } else {
            ""
        };
        format!(
            "Marks: measured, bars one standard uncertainty. Lines: predicted from load and slip by \
             the parameters identified; dashed, what holds 95 % of measurements. Crosses: load by \
             Eq. (62) at {sinkage}.{held}"
        )
    }

    fn draw_panel(&self, canvas: &mut Canvas, area: Area, quantity: &Quantity) {
        let lines: Vec<Vec<Vec<Point>>> = self
            .loads
            .iter()
            .map(|rows| self.line(rows, quantity))
            .collect();
        let slips: Vec<f64> = self.loads.iter().flatten().map(|row| row.slip).collect();
        let points: Vec<Point> = lines.iter().flatten().flatten().copied().collect();
        let [low, high] = self.range(quantity, &points);
        let panel = Panel {
            area,
            x: Axis::roomy(
                bounds(&slips).unwrap_or([0.0, 1.0]),
                [area.left, area.right()],
            ),
            // From 0 on, or differences of a per cent look like trends.
            y: Axis::roomy([low.min(0.0), high.max(0.0)], [area.bottom(), area.top]),
        };
        panel.draw_frame(canvas, quantity.header);
        panel.draw_footer(canvas, "slip ratio s [-]");
        canvas.clip(&area);
        for (number, (rows, line)) in self.loads.iter().zip(&lines).enumerate() {
            for part in line {
                draw_line(canvas, &panel, part, colour(number));
            }
            for row in rows {
                let hollow = quantity.slips && self.is_held(row.slip);
                let mark = Mark {
                    colour: colour(number),
                    hollow,
                };
                draw_row(canvas, &panel, row, quantity, mark);
                if quantity.predicted.is_none() {
                    let carried = [row.slip, self.carried(row)];
                    draw_cross(canvas, panel.at(carried), colour(number));
                }
            }
        }
        canvas.unclip();
    }

    /// Values from marks to lines, with some room for intervals.
    fn range(&self, quantity: &Quantity, points: &[Point]) -> [f64; 2] {
        let rows = || self.loads.iter().flatten();
        let measured = rows().flat_map(|row| {
            let (value, deviation) = ((quantity.measured)(row), (quantity.deviation)(row));
            [value - deviation, value + deviation]
        });
        let by_sinkage = quantity.predicted.is_none();
        let carried = rows().filter(|_| by_sinkage).map(|row| self.carried(row));
        let lines = points.iter().map(|point| point.value);
        let shown: Vec<f64> = measured.chain(carried).chain(lines).collect();
        let [low, high] = bounds(&shown).unwrap_or([0.0, 1.0]);
        let room = ROOM * (high - low);
        let ends = points.iter().flat_map(|point| point.ends);
        let ends: Vec<f64> = ends.map(|end| end.clamp(low - room, high + room)).collect();
        let [least, most] = bounds(&ends).unwrap_or([low, high]);
        [low.min(least), high.max(most)]
    }

    /// The load [N] that Eq. (62) gives at a row's slip and sinkage.
    fn carried(&self, row: &SteadyLoad) -> f64 {
        let setting = self.predictor.setting();
        let loads = self.estimate.loads_at(setting, row.slip, row.sinkage);
        loads.normal_force
    }

    /// What is predicted along the rows of a load, in parts where there is a prediction.
    fn line(&self, rows: &[SteadyLoad], quantity: &Quantity) -> Vec<Vec<Point>> {
        let scale = quantity.scale;
        let Some(predicted) = quantity.predicted else {
            return Vec::new();
        };
        let shown = |slip: f64| !(quantity.slips && self.is_held(slip));
        let knots = knots(rows).into_iter();
        let knots: Vec<[f64; 2]> = knots.filter(|[slip, _]| shown(*slip)).collect();
        let point = |[slip, load]: [f64; 2]| {
            let prediction = predicted(&self.predictor.at(load, slip)?);
            Some(Point {
                slip,
                value: scale * prediction.value,
                ends: prediction.interval().map(|end| scale * end),
            })
        };
        let points: Vec<Option<Point>> = along(&knots).into_iter().map(point).collect();
        let parts = points.split(Option::is_none);
        parts
            .map(|part| part.iter().copied().flatten().collect())
            .collect()
    }

    fn is_held(&self, slip: f64) -> bool {
        let class = self.estimate.class;
        self.predictor.setting().is_held(slip, class)
    }

    fn holds_any(&self) -> bool {
        let mut rows = self.loads.iter().flatten();
        rows.any(|row| self.is_held(row.slip))
    }
}

fn colour(number: usize) -> &'static str {
    PALETTE[number % PALETTE.len()]
}

/// A line and, where they are known, the ends of its intervals.
fn draw_line(canvas: &mut Canvas, panel: &Panel, points: &[Point], colour: &'static str) {
    let path = |value: fn(&Point) -> f64| -> Vec<[f64; 2]> {
        let points = points.iter();
        points
            .map(|point| panel.at([point.slip, value(point)]))
            .collect()
    };
    canvas.data_line(
        &path(|point| point.value),
        Stroke::solid(colour, 2.0),
        "predicted",
    );
    let known = |point: &Point| point.ends.iter().all(|end| end.is_finite());
    if points.iter().all(known) {
        for end in [path(|point| point.ends[0]), path(|point| point.ends[1])] {
            canvas.polyline(&end, Stroke::dashed(colour, 1.0));
        }
    }
}

fn draw_cross(canvas: &mut Canvas, [x, y]: [f64; 2], colour: &'static str) {
    for slope in [1.0, -1.0] {
        let ends = [[x - FOOT, y - slope * FOOT], [x + FOOT, y + slope * FOOT]];
        canvas.polyline(&ends, Stroke::solid(colour, 1.6));
    }
}

/// The mark of a row.
#[derive(Clone, Copy)]
struct Mark {
    colour: &'static str,
    hollow: bool,
}

/// A row's mark and bar; nothing where it was not measured.
fn draw_row(canvas: &mut Canvas, panel: &Panel, row: &SteadyLoad, quantity: &Quantity, mark: Mark) {
    let Mark { colour, hollow } = mark;
    let (value, deviation) = ((quantity.measured)(row), (quantity.deviation)(row));
    if !value.is_finite() {
        return;
    }
    let [x, y] = panel.at([row.slip, value]);
    let ends = [value - deviation, value + deviation].map(|end| panel.y.pixel(end));
    let stroke = Stroke::solid(colour, 1.2);
    if deviation > 0.0 {
        canvas.polyline(&ends.map(|end| [x, end]), stroke);
        for end in ends {
            canvas.polyline(&[[x - FOOT, end], [x + FOOT, end]], stroke);
        }
    }
    let [value, load] = [reading(quantity.header, value), four_digits(row.load)];
    let reading = format!(
        "{value} at slip ratio {}, load {load} N",
        four_digits(row.slip)
    );
    canvas.mark(&reading, |canvas| {
        if hollow {
            canvas.circle([x, y], 4.5, "#ffffff", Stroke::solid(colour, 1.5));
        } else {
            canvas.point([x, y], colour);
        }
    });
}

/// Rows of about one load together, each by slip; the lightest first.
fn by_load(rows: &[SteadyLoad]) -> Vec<Vec<SteadyLoad>> {
    let mut rows = rows.to_vec();
    rows.sort_by(|one, other| one.load.total_cmp(&other.load));
    let loads = rows.chunk_by(|one, other| other.load <= APART * one.load);
    let by_slip = |rows: &[SteadyLoad]| {
        let mut rows = rows.to_vec();
        rows.sort_by(|one, other| one.slip.total_cmp(&other.slip));
        rows
    };
    loads.map(by_slip).collect()
}

fn slips(rows: &[SteadyLoad]) -> impl Iterator<Item = f64> {
    rows.iter().map(|row| row.slip)
}

fn loads(rows: &[SteadyLoad]) -> impl Iterator<Item = f64> {
    rows.iter().map(|row| row.load)
}

/// Slip and load [N] through which a curve goes: rows of about one slip are one.
fn knots(rows: &[SteadyLoad]) -> Vec<[f64; 2]> {
    let groups = rows.chunk_by(|one, other| other.slip - one.slip < SAME_SLIP);
    let knot = |rows: &[SteadyLoad]| Some([mean(slips(rows))?, mean(loads(rows))?]);
    groups.filter_map(knot).collect()
}

/// Points on straight lines from knot to knot.
fn along(knots: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let between = knots.windows(2).flat_map(|pair| {
        (0..POINTS).map(|i| {
            let part = i as f64 / POINTS as f64;
            [0, 1].map(|axis| pair[0][axis] + part * (pair[1][axis] - pair[0][axis]))
        })
    });
    between.chain(knots.last().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::{Identification, Setting};
    use crate::soil::closed_form::Rim;

    fn row(slip: f64, load: f64) -> SteadyLoad {
        SteadyLoad {
            slip,
            sinkage: 0.01 + 0.02 * slip,
            drawbar_pull: load * (0.1 + 0.3 * slip),
            load,
            driving_torque: 0.06 * load * (0.2 + slip),
            uncertainty: None,
        }
    }

    fn drawn(rows: &[SteadyLoad], class: Wtic) -> String {
        let setting = Setting::new(Rim {
            radius: 0.155,
            width: 0.15,
        });
        let identification = Identification::new(rows, class, &setting).unwrap();
        let estimate = identification.estimate().unwrap();
        let predictor = Predictor::new(&identification, &estimate);
        force_curves("curves", &estimate, &predictor, rows)
    }

    #[test]
    fn loads_that_a_rig_holds_to_some_per_cent_are_one_and_curves_go_by_slip() {
        let rows = [
            row(0.4, 101.0),
            row(0.1, 60.0),
            row(0.0, 99.0),
            row(0.2, 100.0),
        ];
        let loads = by_load(&rows);
        let slips: Vec<Vec<f64>> = loads
            .iter()
            .map(|rows| rows.iter().map(|row| row.slip).collect())
            .collect();
        assert_eq!(slips, [vec![0.1], vec![0.0, 0.2, 0.4]]);
    }

    #[test]
    fn repeats_at_one_slip_are_one_point_of_the_curve_at_their_mean_load() {
        let knots = knots(&[row(0.0, 98.0), row(0.0, 102.0), row(0.5, 104.0)]);
        assert_eq!(knots, [[0.0, 100.0], [0.5, 104.0]]);
        let line = along(&knots);
        assert_eq!((line.len(), line[POINTS / 2]), (POINTS + 1, [0.25, 102.0]));
    }

    #[test]
    fn a_row_that_static_friction_holds_is_hollow_and_what_is_not_measured_is_not_drawn() {
        let unsunk = |slip: f64| SteadyLoad {
            sinkage: f64::NAN,
            ..row(slip, 100.0)
        };
        let rows = [0.0, 0.1, 0.2, 0.4].map(unsunk);
        let svg = drawn(&rows, Wtic::Alct);
        assert_eq!(
            svg.matches(r##"fill="#ffffff" stroke="##).count(),
            2,
            "{svg}"
        );
        assert!(
            svg.contains("at a sinkage of 0.01 mm. Hollow") && !svg.contains("Sinkage of the rim")
        );
        let sunk = [0.0, 0.1, 0.2, 0.4].map(|slip| row(slip, 100.0));
        let svg = drawn(&sunk, Wtic::Leis);
        assert!(!svg.contains("Hollow") && svg.contains("Sinkage of the rim "));
    }
}
