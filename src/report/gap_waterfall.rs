//! How a gap shrinks, step by step: as shipped, recalibrated, with an effect, to the floor.

use super::envelope::bounds;
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, PALETTE, Panel, Stroke};
use crate::diagnosis::Gaps;
use crate::gap::Closed;
use crate::table::four_digits;

/// Width of the drawing [px].
const WIDTH: f64 = 1100.0;
/// Where the panel begins and ends [px].
const PANEL: Area = Area {
    left: 70.0,
    top: 104.0,
    width: 1010.0,
    height: 320.0,
};
/// Half of a bar's width, in columns [-].
const HALF_BAR: f64 = 0.32;
/// Ink of the floor, and of unknown parts.
const FLOOR: &str = "#b9c0cc";
const UNKNOWN: &str = "#e69f00";

/// One bar from one score to another.
struct Step {
    name: String,
    from: f64,
    to: f64,
    fill: &'static str,
    is_total: bool,
}

/// Energy scores as a waterfall: what recalibration takes from the gap as shipped, what the effect takes (whisker: 95 %
/// interval), what is left unknown, and the floor that a perfect model reaches; dashed is what the cause would leave with the
/// assumed discrepancy. A step that widens the gap goes up and is
/// vermilion. `added` names the effect. One SVG 1100 px wide.
pub fn gap_waterfall(gaps: &Gaps, closed: Option<Closed>, added: &str) -> String {
    let steps = steps(gaps, added);
    let title = "Closed share of the difference";
    let mut canvas = Canvas::new([WIDTH, PANEL.bottom() + 76.0], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let whisker = interval(gaps, closed);
    let parts = [
        Some("Noise floor: score of a perfect model."),
        (!whisker.is_empty()).then_some("Whisker: 95 % interval of what the effect closes."),
        gaps.floor_with_discrepancy
            .map(|_| "Dashed: score of the true cause with the assumed discrepancy."),
    ];
    let note: Vec<&str> = parts.into_iter().flatten().collect();
    canvas.text([16.0, 54.0], Anchor::Start, Font::SMALL, &note.join(" "));
    let ends: Vec<f64> = steps.iter().flat_map(|step| [step.from, step.to]).collect();
    let others = whisker.iter().copied().chain(gaps.floor_with_discrepancy);
    let ends: Vec<f64> = ends.into_iter().chain(others).collect();
    let [low, high] = bounds(&ends).unwrap_or([0.0, 1.0]);
    let panel = Panel {
        area: PANEL,
        x: Axis::exact([0.0, steps.len() as f64], [PANEL.left, PANEL.right()]),
        y: Axis::roomy([low.min(0.0), high.max(0.0)], [PANEL.bottom(), PANEL.top]),
    };
    let header = "Energy score [standard deviations per statistic]";
    panel.draw_category_frame(&mut canvas, header);
    for (place, step) in steps.iter().enumerate() {
        draw_step(&mut canvas, &panel, place as f64, step);
    }
    for (place, pair) in steps.windows(2).enumerate() {
        if pair[1].is_total {
            continue;
        }
        let across = [place as f64 + 0.5 + HALF_BAR, place as f64 + 1.5 - HALF_BAR];
        let link = across.map(|x| panel.at([x, pair[1].from]));
        canvas.polyline(&link, Stroke::solid(MUTED, 1.0));
    }
    draw_whisker(&mut canvas, &panel, &whisker);
    if let Some(floor) = gaps.floor_with_discrepancy {
        let ends = [0.0, steps.len() as f64].map(|x| panel.at([x, floor]));
        canvas.polyline(&ends, Stroke::dashed(INK, 1.0));
    }
    canvas.finish()
}

fn steps(gaps: &Gaps, added: &str) -> Vec<Step> {
    let Gaps {
        as_shipped,
        recalibrated,
        with_effect,
        floor,
        ..
    } = *gaps;
    let fall = |name: String, from: f64, to: f64, fill| Step {
        name,
        from,
        to,
        fill: if to > from { PALETTE[1] } else { fill },
        is_total: false,
    };
    let total = |name: &str, to, fill| Step {
        name: name.to_owned(),
        from: 0.0,
        to,
        fill,
        is_total: true,
    };
    let left = Step {
        // What is left is no fall that widens.
        fill: UNKNOWN,
        ..fall("unknown remainder".to_owned(), with_effect, floor, UNKNOWN)
    };
    vec![
        total("nominal", as_shipped, "#8a93a3"),
        fall(
            "parameters recalibrated".to_owned(),
            as_shipped,
            recalibrated,
            PALETTE[0],
        ),
        fall(
            format!("with {added}"),
            recalibrated,
            with_effect,
            PALETTE[2],
        ),
        left,
        total("floor", floor, FLOOR),
    ]
}

/// Place of the effect's bar.
const EFFECT: f64 = 2.0;
/// The whisker stands beside the bar's number, which is above its middle [columns].
const BESIDE: f64 = 0.24;

fn draw_step(canvas: &mut Canvas, panel: &Panel, place: f64, step: &Step) {
    if !(step.from.is_finite() && step.to.is_finite()) {
        return;
    }
    let [left, right] = [-HALF_BAR, HALF_BAR].map(|half| panel.x.pixel(place + 0.5 + half));
    let [from, to] = [step.from, step.to].map(|score| panel.y.pixel(score));
    let corners = [[left, from], [right, from], [right, to], [left, to]];
    let middle = panel.x.pixel(place + 0.5);
    let value = if step.is_total {
        four_digits(step.to)
    } else {
        signed(step.to - step.from)
    };
    let reading = format!(
        "{}: energy score {value} standard deviations per statistic, from {} to {}",
        step.name,
        four_digits(step.from),
        four_digits(step.to)
    );
    canvas.mark(&reading, |canvas| {
        canvas.polygon(&corners, step.fill, Stroke::solid(INK, 1.0));
    });
    let number = Font {
        colour: INK,
        bold: true,
        ..Font::SMALL
    };
    let at = [middle, from.min(to) - 7.0];
    canvas.text(at, Anchor::Middle, number, &value);
    let name = Font {
        colour: INK,
        ..Font::SMALL
    };
    let lines = name.wrap(&step.name, panel.x.pixel(1.0) - panel.x.pixel(0.0) - 12.0);
    for (line, text) in lines.iter().take(3).enumerate() {
        let below = panel.area.bottom() + 20.0 + 18.0 * line as f64;
        canvas.text([middle, below], Anchor::Middle, name, text);
    }
}

/// Scores between which the gap with the effect lies.
fn interval(gaps: &Gaps, closed: Option<Closed>) -> Vec<f64> {
    let known = closed.filter(|closed| closed.clusters > 1);
    let ends = known.map(|closed| {
        let ends = closed.ci95;
        ends.map(|share| score(gaps.recalibrated, gaps.floor, share))
    });
    ends.into_iter().flatten().collect()
}

/// The score at which a share of the gap is closed.
fn score(recalibrated: f64, floor: f64, share: f64) -> f64 {
    recalibrated - share * (recalibrated - floor)
}

fn draw_whisker(canvas: &mut Canvas, panel: &Panel, ends: &[f64]) {
    let x = panel.x.pixel(EFFECT + 0.5 + BESIDE);
    let stroke = Stroke::solid(INK, 1.8);
    if let [low, high] = *ends {
        let ends = [low, high].map(|score| [x, panel.y.pixel(score)]);
        canvas.polyline(&ends, stroke);
        for [x, y] in ends {
            canvas.polyline(&[[x - 7.0, y], [x + 7.0, y]], stroke);
        }
    }
}

fn signed(value: f64) -> String {
    let text = four_digits(value);
    if value > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAPS: Gaps = Gaps {
        as_shipped: 4.0,
        recalibrated: 2.0,
        with_effect: 0.8,
        floor: 0.5,
        floor_with_discrepancy: Some(0.7),
    };

    fn closed(clusters: usize) -> Option<Closed> {
        Some(Closed {
            value: 0.8,
            ci95: [0.6, 0.9],
            clusters,
        })
    }

    #[test]
    fn the_steps_lead_from_the_gap_as_shipped_to_the_floor_without_a_jump() {
        let steps = steps(&GAPS, "slip_sinkage");
        let falls: f64 = steps[1..4].iter().map(|step| step.to - step.from).sum();
        assert!((steps[0].to + falls - steps[4].to).abs() < 1e-12);
        assert!(
            steps
                .windows(2)
                .all(|pair| pair[1].is_total || pair[1].from == pair[0].to)
        );
    }

    #[test]
    fn a_step_that_widens_the_gap_is_vermilion() {
        let worse = Gaps {
            with_effect: 2.5,
            ..GAPS
        };
        assert_eq!(steps(&worse, "")[2].fill, PALETTE[1]);
        assert_eq!(steps(&GAPS, "")[2].fill, PALETTE[2]);
    }

    #[test]
    fn the_whisker_is_that_of_the_share_closed() {
        // 60 and 90 % of the way from 2.0 to 0.5.
        let [low, high] = interval(&GAPS, closed(6))[..] else {
            panic!("no interval")
        };
        assert!((low - 1.1).abs() < 1e-12 && (high - 0.65).abs() < 1e-12);
        assert!(
            interval(&GAPS, closed(1)).is_empty(),
            "one cluster has no interval"
        );
    }

    #[test]
    fn scores_that_are_no_numbers_leave_their_bars_out() {
        let broken = Gaps {
            as_shipped: f64::INFINITY,
            recalibrated: f64::NAN,
            ..GAPS
        };
        let svg = gap_waterfall(&broken, closed(6), "<effect>");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(
            !svg.contains("&lt;effect&gt;"),
            "from where it falls is not known"
        );
        let whole = gap_waterfall(&GAPS, closed(6), "<effect>");
        assert!(whole.contains("&lt;effect&gt;"), "{whole}");
    }
}
