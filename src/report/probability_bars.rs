//! How probable each explanation is, as bars.

use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, PALETTE, Panel};
use crate::diagnosis::Answer;
use std::collections::BTreeMap;

/// Width of the drawing [px].
const WIDTH: f64 = 1100.0;
/// Room left of the bars for names [px].
const LEFT: f64 = 400.0;
/// Room right of the bars for numbers [px].
const RIGHT: f64 = 90.0;
/// Height of a bar with its distance to the next [px].
const PITCH: f64 = 30.0;
/// Bars shown.
const SHOWN: usize = 14;
/// Probability [-] below which an explanation is summed with the others.
const UNLIKELY: f64 = 0.005;
/// Name of the bar of what is improbable.
const OTHERS: &str = "all others together";

/// Explanations, likeliest first, each with its probability; what is improbable is one bar. Blue are
/// effects and pairs of them, green nothing and parameters, orange the unknown, grey undecided. One
/// SVG 1100 px wide.
pub fn probability_bars(probabilities: &BTreeMap<String, f64>) -> String {
    let bars = bars(probabilities);
    let top = 50.0 + Panel::HEADER;
    let area = Area {
        left: LEFT,
        top,
        width: WIDTH - LEFT - RIGHT,
        height: PITCH * bars.len().max(1) as f64,
    };
    let title = "What explains the measurements";
    let mut canvas = Canvas::new([WIDTH, area.bottom() + Panel::FOOTER + 8.0], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let panel = Panel {
        area,
        x: Axis::exact([0.0, 1.0], [area.left, area.right()]),
        y: Axis::exact([bars.len().max(1) as f64, 0.0], [area.bottom(), area.top]),
    };
    panel.draw_tenths(&mut canvas);
    for (place, (name, probability)) in bars.iter().enumerate() {
        draw_bar(&mut canvas, &panel, place as f64, name, *probability);
    }
    panel.draw_footer(&mut canvas, "probability [-]");
    canvas.finish()
}

fn bars(probabilities: &BTreeMap<String, f64>) -> Vec<(String, f64)> {
    let known = probabilities.iter().filter(|(_, p)| p.is_finite());
    let mut all: Vec<(String, f64)> = known.map(|(name, p)| (name.clone(), *p)).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    let shown = all
        .iter()
        .take(SHOWN)
        .take_while(|(_, p)| *p >= UNLIKELY)
        .count();
    let others = all.split_off(shown);
    let sum: f64 = others.iter().map(|(_, p)| p).sum();
    if !others.is_empty() {
        all.push((OTHERS.to_owned(), sum));
    }
    all
}

/// Answers that name no effect: their colours and what they are called.
const PLAIN: [(Answer, &str, &str); 4] = [
    (Answer::None, PALETTE[2], "none"),
    (Answer::Parameter, PALETTE[2], "parameters"),
    (Answer::Unknown, PALETTE[5], "unknown cause"),
    (Answer::Undecided, "#8a93a3", "undecided"),
];

fn plain(name: &str) -> Option<(&'static str, &'static str)> {
    let mut plain = PLAIN.iter();
    let found = plain.find(|(answer, ..)| answer.name() == name);
    found.map(|(_, colour, label)| (*colour, *label))
}

fn colour(name: &str) -> &'static str {
    match (plain(name), name) {
        (Some((colour, _)), _) => colour,
        (None, OTHERS) => "#b9c0cc",
        (None, _) => PALETTE[0],
    }
}

/// What an explanation is called.
fn label(name: &str) -> String {
    let plain = plain(name).map(|(_, label)| label.to_owned());
    plain.unwrap_or_else(|| name.replace('+', " + "))
}

fn draw_bar(canvas: &mut Canvas, panel: &Panel, place: f64, name: &str, probability: f64) {
    let y = panel.area.top + (place + 0.5) * PITCH;
    let end = panel.x.pixel(probability.clamp(0.0, 1.0));
    let bar = Area {
        left: panel.area.left,
        top: y - 0.36 * PITCH,
        width: end - panel.area.left,
        height: 0.72 * PITCH,
    };
    let reading = format!("{}: probability {:.1} %", label(name), 100.0 * probability);
    canvas.rect(&bar, colour(name), &reading);
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let text = font.fit(&label(name), LEFT - 28.0);
    let at = [panel.area.left - 10.0, y + 5.0];
    canvas.text(at, Anchor::End, font, &text);
    let number = Font {
        colour: MUTED,
        bold: true,
        ..Font::SMALL
    };
    let text = format!("{:.1} %", 100.0 * probability);
    canvas.text([end + 8.0, y + 5.0], Anchor::Start, number, &text);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probabilities(known: &[(&str, f64)]) -> BTreeMap<String, f64> {
        let known = known.iter();
        known.map(|(name, p)| ((*name).to_owned(), *p)).collect()
    }

    #[test]
    fn bars_come_likeliest_first_and_what_is_improbable_is_one_bar() {
        let known = [
            ("none", 0.1),
            ("a", 0.003),
            ("b", 0.8),
            ("a+b", 0.097),
            ("c", f64::NAN),
            ("d", 0.0),
        ];
        let bars = bars(&probabilities(&known));
        let names: Vec<&str> = bars.iter().map(|(name, _)| &**name).collect();
        assert_eq!(names, ["b", "none", "a+b", OTHERS]);
        assert!((bars[3].1 - 0.003).abs() < 1e-12);
    }

    #[test]
    fn no_probabilities_make_an_empty_drawing() {
        assert!(probability_bars(&BTreeMap::new()).starts_with("<svg"));
    }
}
