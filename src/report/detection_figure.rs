//! Which effects are named from which detectability on, as a picture.

use super::figure::{Anchor, Area, Axis, Canvas, Font, GRID, PALETTE, Panel, Stroke};
use crate::challenge::Set;
use crate::challenge::score::Detected;
use crate::table::four_digits;

/// Width of the drawing [px].
const WIDTH: f64 = 820.0;
/// Room left of the panel for the names of effects [px].
const LEFT: f64 = 220.0;
/// Height of the title and the legend [px].
const TOP: f64 = 92.0;
/// Height of a row [px].
const ROW: f64 = 22.0;
/// `d'` [-] at the ends of the axis; a case below the first is drawn there.
const ENDS: [f64; 2] = [1.0, 1000.0];
/// Radius of a case [px].
const RADIUS: f64 = 5.0;
/// Distance of a case from the middle of its row [px]: up for the catalogue's form, down for another.
const BESIDE: f64 = 3.5;

/// Every case of one effect in the row of the effect at its `d'` \[-\] beside unknown parameters: filled where the effect
/// was named, up to equivalence, blue in the catalogue's form and orange in another. One SVG 820 px wide.
pub fn detection_figure(detections: &[Detected]) -> String {
    let mut effects: Vec<&str> = detections.iter().map(|it| it.effect.as_str()).collect();
    effects.dedup();
    let rows = effects.len().max(1) as f64;
    let area = Area {
        left: LEFT,
        top: TOP,
        width: WIDTH - LEFT - 30.0,
        height: ROW * rows,
    };
    let panel = Panel {
        area,
        x: Axis::decades(ENDS, [area.left, area.right()]),
        y: Axis::exact([0.0, rows], [area.top, area.bottom()]),
    };
    let title = "Effects named, by detectability";
    let height = area.bottom() + Panel::FOOTER + 8.0;
    let mut canvas = Canvas::new([WIDTH, height], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    draw_legend(&mut canvas, TOP - 22.0);
    for (row, effect) in effects.iter().enumerate() {
        let ends = ENDS.map(|end| panel.at([end, row as f64 + 0.5]));
        canvas.polyline(&ends, Stroke::solid(GRID, 1.0));
        let base = ends[0][1] + 5.0;
        let name = Font::SMALL.fit(effect, LEFT - 24.0);
        canvas.text([LEFT - 12.0, base], Anchor::End, Font::SMALL, &name);
    }
    for detection in detections {
        let row = effects.iter().position(|name| *name == detection.effect);
        let at = [
            detection.detectability.max(ENDS[0]),
            row.unwrap_or(0) as f64 + 0.5,
        ];
        let [x, y] = panel.at(at);
        let beside = if detection.set == Set::C2 {
            BESIDE
        } else {
            -BESIDE
        };
        draw_case(&mut canvas, [x, y + beside], detection);
    }
    panel.draw_footer(&mut canvas, "detectability d' [-], 1 or less at the left");
    canvas.finish()
}

/// The kinds of marks, as they are drawn.
const KINDS: [(Set, bool, &str); 4] = [
    (Set::C1, true, "catalogue's form, named"),
    (Set::C1, false, "not named"),
    (Set::C2, true, "another form, named"),
    (Set::C2, false, "not named"),
];

fn draw_legend(canvas: &mut Canvas, base: f64) {
    let mut left = LEFT;
    for (set, is_named, text) in KINDS {
        draw_mark(canvas, [left + RADIUS, base - 5.0], set, is_named);
        left += 2.0 * RADIUS + 6.0;
        canvas.text([left, base], Anchor::Start, Font::SMALL, text);
        left += Font::SMALL.width(text) + 16.0;
    }
}

fn draw_case(canvas: &mut Canvas, at: [f64; 2], detection: &Detected) {
    let Detected {
        effect,
        set,
        detectability,
        is_named,
    } = detection;
    let named = if *is_named { "named" } else { "not named" };
    let detectability = four_digits(*detectability);
    let reading = format!("{effect} ({set}): d' {detectability}, {named}");
    canvas.mark(&reading, |canvas| draw_mark(canvas, at, *set, *is_named));
}

fn draw_mark(canvas: &mut Canvas, at: [f64; 2], set: Set, is_named: bool) {
    let colour = PALETTE[usize::from(set == Set::C2)];
    let fill = if is_named { colour } else { "#ffffff" };
    canvas.circle(at, RADIUS, fill, Stroke::solid(colour, 2.0));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_stands_in_the_row_of_its_effect_at_its_detectability() {
        let of = |effect: &str, detectability: f64, is_named: bool| Detected {
            effect: effect.to_owned(),
            set: Set::C1,
            detectability,
            is_named,
        };
        let cases = [
            of("slope", 0.0, false),
            of("slope", 1000.0, true),
            of("thin_layer", 31.6, true),
        ];
        let figure = detection_figure(&cases);
        assert!(
            figure.contains(&format!("cx=\"{LEFT}\" cy=\"99.5\"")),
            "{figure}"
        );
        assert!(figure.contains("cx=\"790\" cy=\"99.5\""), "{figure}");
        assert!(figure.contains(" cy=\"121.5\"") && figure.contains(">thin_layer<"));
        assert!(
            figure.contains("slope (C1): d&#39; 1000, named"),
            "{figure}"
        );
    }
}
