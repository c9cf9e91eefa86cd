//! Measured forces and those that identified parameters give back, against slip (Fig. 25-27).

use super::envelope::bounds;
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, PALETTE, Panel, Stroke};
use crate::identification::{Estimate, RIGID_SINKAGE, Setting, SteadyLoad};
use crate::soil::wheel_load::WheelLoad;
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
/// Half of a bar's foot [px].
const FOOT: f64 = 4.0;
/// Ratio of neighbouring loads [-] from which they are two.
const APART: f64 = 1.1;
/// Slips [-] closer than this are one point of a curve.
const SAME_SLIP: f64 = 0.01;
/// Points of a curve between two slips.
const POINTS: usize = 12;

/// What a panel shows.
struct Quantity {
    header: &'static str,
    measured: fn(&SteadyLoad) -> f64,
    /// Standard uncertainty.
    deviation: fn(&SteadyLoad) -> f64,
    /// What the parameters give; none where they take it as given.
    fitted: Option<fn(&WheelLoad) -> f64>,
    /// Whether a wheel held by static friction does not show it.
    slips: bool,
}

const QUANTITIES: [Quantity; 4] = [
    Quantity {
        header: "Drawbar pull F_DP [N]",
        measured: |row| row.drawbar_pull,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.drawbar_pull),
        fitted: Some(|load| load.drawbar_pull),
        slips: true,
    },
    Quantity {
        header: "Load W [N]",
        measured: |row| row.load,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.load),
        fitted: Some(|load| load.normal_force),
        slips: false,
    },
    Quantity {
        header: "Driving torque T_D [N·m]",
        measured: |row| row.driving_torque,
        deviation: |row| row.uncertainty.map_or(0.0, |u| u.driving_torque),
        fitted: Some(|load| load.driving_torque),
        slips: true,
    },
    Quantity {
        header: "Sinkage of the rim z [mm], as measured",
        measured: |row| 1.0e3 * row.sinkage,
        deviation: |row| row.uncertainty.map_or(0.0, |u| 1.0e3 * u.sinkage),
        fitted: None,
        slips: false,
    },
];

/// Pull, load and torque against slip as measured (marks, bars of one standard uncertainty) and as
/// the estimate gives them back at the sinkage measured (lines), one colour a load; where lugs
/// enter soil, the sinkage too. One SVG 1200 px wide.
///
/// Between rows a line takes the sinkage between theirs, or the one that the class sets. Rows of hard ground that static friction
/// holds are hollow: no shear law says their pull and torque.
pub fn force_curves(
    title: &str,
    estimate: &Estimate,
    setting: &Setting,
    rows: &[SteadyLoad],
) -> String {
    let curves = Curves {
        estimate,
        setting,
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
    setting: &'a Setting,
    /// Rows of one load each, by slip.
    loads: Vec<Vec<SteadyLoad>>,
}

impl Curves<'_> {
    /// Title, remark and legend; where they end [px].
    fn draw_head(&self, canvas: &mut Canvas, title: &str) -> f64 {
        let mut top = MARGIN + 14.0;
        let fitted = Font::TITLE.fit(title, WIDTH - 2.0 * MARGIN);
        canvas.text([MARGIN, top], Anchor::Start, Font::TITLE, &fitted);
        let sinkage = if self.estimate.class == Wtic::Leis {
            "the sinkage measured".to_owned()
        } else {
            format!("a sinkage of {} mm", 1.0e3 * RIGID_SINKAGE)
        };
        let remark = format!(
            "Marks: measured, bars one standard uncertainty. Lines: by the parameters identified, \
             at {sinkage}."
        );
        let held = if self.holds_any() {
            " Hollow: held by static friction, pull and torque not fitted."
        } else {
            ""
        };
        for line in Font::SMALL.wrap(&format!("{remark}{held}"), WIDTH - 2.0 * MARGIN) {
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
            let name = format!("load {:.0} N", mean(rows.iter().map(|row| row.load)));
            let width = 42.0 + font.width(&name) + 18.0;
            if left + width > WIDTH - MARGIN {
                left = MARGIN;
                top += LINE;
            }
            let (colour, y) = (colour(number), top - 5.0);
            let line = [[left, y], [left + 32.0, y]];
            canvas.polyline(&line, Stroke::solid(colour, 2.0));
            canvas.circle([left + 16.0, y], 4.5, colour, Stroke::solid("#ffffff", 0.8));
            canvas.text([left + 42.0, top], Anchor::Start, font, &name);
            left += width;
        }
        top + 8.0
    }

    fn draw_panel(&self, canvas: &mut Canvas, area: Area, quantity: &Quantity) {
        let lines: Vec<Vec<[f64; 2]>> = self
            .loads
            .iter()
            .map(|rows| self.line(rows, quantity))
            .collect();
        let measured = self.loads.iter().flatten().flat_map(|row| {
            let (value, deviation) = ((quantity.measured)(row), (quantity.deviation)(row));
            [value - deviation, value + deviation]
        });
        let fitted = lines.iter().flatten().map(|point| point[1]);
        let values: Vec<f64> = measured.chain(fitted).collect();
        let slips: Vec<f64> = self.loads.iter().flatten().map(|row| row.slip).collect();
        let [low, high] = bounds(&values).unwrap_or([0.0, 1.0]);
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
        for (number, (rows, line)) in self.loads.iter().zip(&lines).enumerate() {
            let path: Vec<[f64; 2]> = line.iter().map(|point| panel.at(*point)).collect();
            canvas.polyline(&path, Stroke::solid(colour(number), 2.0));
            for row in rows {
                let hollow = quantity.slips && self.is_held(row.slip);
                draw_row(canvas, &panel, (row, quantity), (colour(number), hollow));
            }
        }
    }

    /// Slip and fitted value along the rows of a load.
    fn line(&self, rows: &[SteadyLoad], quantity: &Quantity) -> Vec<[f64; 2]> {
        let Some(fitted) = quantity.fitted else {
            return Vec::new();
        };
        let shown = |slip: f64| !(quantity.slips && self.is_held(slip));
        let knots: Vec<[f64; 2]> = knots(rows)
            .into_iter()
            .filter(|[slip, _]| shown(*slip))
            .collect();
        let points = along(&knots).into_iter();
        points
            .map(|[slip, sinkage]| {
                let loads = self.estimate.loads_at(self.setting, slip, sinkage);
                [slip, fitted(&loads)]
            })
            .collect()
    }

    fn is_held(&self, slip: f64) -> bool {
        self.setting.is_held(slip, self.estimate.class)
    }

    fn holds_any(&self) -> bool {
        let mut rows = self.loads.iter().flatten();
        rows.any(|row| self.is_held(row.slip))
    }
}

fn colour(number: usize) -> &'static str {
    PALETTE[number % PALETTE.len()]
}

/// A row's mark and bar; nothing where it was not measured.
fn draw_row(
    canvas: &mut Canvas,
    panel: &Panel,
    (row, quantity): (&SteadyLoad, &Quantity),
    (colour, hollow): (&'static str, bool),
) {
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
    if hollow {
        canvas.circle([x, y], 4.5, "#ffffff", Stroke::solid(colour, 1.5));
    } else {
        canvas.circle([x, y], 4.5, colour, Stroke::solid("#ffffff", 0.8));
    }
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

/// Slip and sinkage [m] through which a curve goes: rows of about one slip are one.
fn knots(rows: &[SteadyLoad]) -> Vec<[f64; 2]> {
    let groups = rows.chunk_by(|one, other| other.slip - one.slip < SAME_SLIP);
    let knot = |rows: &[SteadyLoad]| {
        [
            mean(rows.iter().map(|row| row.slip)),
            mean(rows.iter().map(|row| row.sinkage)),
        ]
    };
    groups.map(knot).collect()
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

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::identify;
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
    fn repeats_at_one_slip_are_one_point_of_the_curve_at_their_mean_sinkage() {
        let deeper = SteadyLoad {
            sinkage: 0.02,
            ..row(0.0, 100.0)
        };
        let knots = knots(&[row(0.0, 100.0), deeper, row(0.5, 100.0)]);
        assert_eq!(knots, [[0.0, 0.015], [0.5, 0.02]]);
        let line = along(&knots);
        assert_eq!((line.len(), line[POINTS / 2]), (POINTS + 1, [0.25, 0.0175]));
    }

    #[test]
    fn a_row_that_static_friction_holds_is_hollow_and_what_nobody_measured_is_not_drawn() {
        let setting = Setting::new(Rim {
            radius: 0.155,
            width: 0.15,
        });
        let unsunk = |slip: f64| SteadyLoad {
            sinkage: f64::NAN,
            ..row(slip, 100.0)
        };
        let rows = [0.0, 0.1, 0.2, 0.4].map(unsunk);
        let estimate = identify(&rows, Wtic::Alct, &setting).unwrap();
        let svg = force_curves("hard", &estimate, &setting, &rows);
        assert_eq!(
            svg.matches(r##"fill="#ffffff" stroke="##).count(),
            2,
            "{svg}"
        );
        assert!(
            svg.contains("at a sinkage of 0.01 mm. Hollow") && !svg.contains("Sinkage of the rim")
        );
        let sunk = [0.0, 0.1, 0.2, 0.4].map(|slip| row(slip, 100.0));
        let estimate = identify(&sunk, Wtic::Leis, &setting).unwrap();
        let svg = force_curves("soil", &estimate, &setting, &sunk);
        assert!(!svg.contains("Hollow") && svg.contains("Sinkage of the rim z [mm]"));
    }
}
