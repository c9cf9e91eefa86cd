//! Where along a swept value classes are recognised: right answers against the value.

use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, PALETTE, Panel, Stroke};
use crate::recognition::confusion::CLASSES;
use crate::statistics::Share;
use crate::study::score::Part;
use crate::table::Cell;
use crate::terrain::class::Wtic;

/// Width of the drawing [px].
const WIDTH: f64 = 1100.0;
/// Room left of a panel for its tick labels [px].
const TICKS: f64 = 62.0;
/// Room right of a panel [px].
const RIGHT: f64 = 18.0;
/// Height of a panel [px].
const HEIGHT: f64 = 120.0;
/// Height of the title [px].
const TITLE: f64 = 46.0;
/// Room between panels, and below the last for the values [px].
const BELOW: [f64; 2] = [14.0, 52.0];
/// Shares [-] at the ends of a panel: room for marks at 0 and 1.
const RANGE: [f64; 2] = [-0.07, 1.07];
/// Part of a value's column that the methods share [-].
const SPREAD: f64 = 0.4;

/// A method, and the windows at every value of a key.
#[derive(Debug, Clone)]
pub struct MethodParts<'s> {
    /// Its name.
    pub method: &'s str,
    /// The windows, value by value.
    pub parts: Vec<&'s Part>,
}

/// The share of right answers of every method at every value of a swept key, with Wilson's 95 %
/// intervals and the number of windows: a panel for every true class that occurs, a column for every
/// value in the order of the sweep, however far apart they are. One SVG 1100 px wide.
///
/// The methods have the same values.
pub fn sweep_figure(key: &str, methods: &[MethodParts]) -> String {
    let title = format!("Right answers over {key}");
    let mut canvas = Canvas::new([WIDTH, 0.0], &title);
    let text = Font::TITLE.fit(&title, WIDTH - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &text);
    let values = methods.first().map_or(&[][..], |first| &first.parts);
    let occurs = |class: &Wtic| {
        let mut parts = values.iter();
        parts.any(|part| part.counted.recalls.contains_key(class))
    };
    let mut bottom = TITLE;
    for class in CLASSES.into_iter().filter(occurs) {
        let area = Area {
            left: TICKS,
            top: bottom + Panel::HEADER,
            width: WIDTH - TICKS - RIGHT,
            height: HEIGHT,
        };
        let panel = Panel {
            area,
            x: Axis::exact([0.0, values.len() as f64], [area.left, area.right()]),
            y: Axis::exact(RANGE, [area.bottom(), area.top]),
        };
        draw_class(&mut canvas, &panel, class, methods);
        bottom = area.bottom() + BELOW[0];
    }
    let width = (WIDTH - TICKS - RIGHT) / values.len().max(1) as f64;
    for (column, part) in values.iter().enumerate() {
        let at = [TICKS + (column as f64 + 0.5) * width, bottom + 6.0];
        let font = Font {
            colour: INK,
            ..Font::SMALL
        };
        let text = font.fit(&Cell::toml(&part.value).written(), width - 6.0);
        canvas.text(at, Anchor::Middle, font, &text);
    }
    let at = [TICKS + 0.5 * (WIDTH - TICKS - RIGHT), bottom + 30.0];
    canvas.text(at, Anchor::Middle, Font::SMALL, key);
    canvas.set_height(bottom + BELOW[1]);
    canvas.finish()
}

fn draw_class(canvas: &mut Canvas, panel: &Panel, class: Wtic, methods: &[MethodParts]) {
    let header = format!("{}, share of right answers [-]", class.as_str());
    panel.draw_category_frame(canvas, &header);
    let strokes = PALETTE.map(|colour| Stroke::solid(colour, 2.0));
    let named = methods.iter().zip(strokes);
    let legend: Vec<_> = named
        .map(|(of, stroke)| (of.method.to_owned(), stroke))
        .collect();
    panel.draw_legend(canvas, &header, &legend);
    let step = SPREAD / methods.len().max(1) as f64;
    for (place, (of, stroke)) in methods.iter().zip(strokes).enumerate() {
        let aside = step * (place as f64 + 0.5) - 0.5 * SPREAD;
        for (column, part) in of.parts.iter().enumerate() {
            if let Some(share) = part.counted.recalls.get(&class) {
                let x = panel.x.pixel(column as f64 + 0.5 + aside);
                draw_interval(canvas, panel, x, share, stroke);
                let tip = format!(
                    "{}: {:.0} % of {} windows",
                    of.method,
                    100.0 * share.value,
                    share.n
                );
                let at = [x, panel.y.pixel(share.value)];
                canvas.rect(&mark(at), stroke.colour, &tip);
            }
        }
    }
}

fn draw_interval(canvas: &mut Canvas, panel: &Panel, x: f64, share: &Share, stroke: Stroke) {
    let [low, high] = share.ci95.map(|end| panel.y.pixel(end));
    canvas.polyline(&[[x, low], [x, high]], stroke);
}

fn mark([x, y]: [f64; 2]) -> Area {
    Area {
        left: x - 4.0,
        top: y - 4.0,
        width: 8.0,
        height: 8.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::confusion::Confusion;
    use crate::study::score::Counted;

    fn part(value: &str, class: Wtic, right: u64, wrong: u64) -> Part {
        let mut confusion = Confusion::default();
        for _ in 0..right {
            confusion.add(class, class);
        }
        for _ in 0..wrong {
            confusion.add(class, Wtic::Uwtic);
        }
        Part {
            by: "wheel.lugs.count".to_owned(),
            value: value.to_owned(),
            counted: Counted::from(confusion),
        }
    }

    #[test]
    fn every_class_that_occurs_has_a_panel_and_every_share_its_mark() {
        let parts = [
            part("6", Wtic::Alct, 1, 3),
            part("28", Wtic::Alct, 4, 0),
            part("48", Wtic::Leis, 2, 2),
        ];
        let parts: Vec<&Part> = parts.iter().collect();
        let methods = ["paper", "improved"].map(|method| MethodParts {
            method,
            parts: parts.clone(),
        });
        let figure = sweep_figure("wheel.lugs.count", &methods);
        assert_eq!(figure.matches("share of right answers").count(), 2);
        for shares in ["25 % of 4", "100 % of 4", "50 % of 4"] {
            let of_method = format!("paper: {shares} windows");
            assert_eq!(figure.matches(&of_method).count(), 1, "{shares}");
        }
        assert!(!figure.contains("SLCT"));
    }
}
