//! Where along a swept value classes are recognised: right answers against the value.

use super::{MethodParts, SweptKey, frame_area};
use crate::recognition::confusion::CLASSES;
use crate::report::figure::{
    Anchor, Area, Axis, Canvas, Font, INK, Layout, PALETTE, Panel, Stroke,
};
use crate::statistics::Share;
use crate::study::score::Part;
use crate::table::Cell;
use crate::terrain::class::Wtic;

/// Height of a panel [px], on a screen and in a column of a paper.
const HEIGHT: [f64; 2] = [120.0, 76.0];
/// Room between panels, and below the last for the values [px].
const BELOW: [f64; 2] = [14.0, 52.0];
/// Shares [-] at the ends of a panel: room for marks at 0 and 1.
const RANGE: [f64; 2] = [-0.07, 1.07];
/// Part of a value's column that the methods share [-].
const SPREAD: f64 = 0.4;

/// A panel for every true class that occurs, a column for every value in the order of the sweep, however far apart
/// they are: the share of correct answers of every method with Wilson's 95 % interval. Returns where they end [px].
pub(super) fn draw(canvas: &mut Canvas, layout: Layout, top: f64, swept: &SweptKey) -> f64 {
    let methods = swept.methods.as_slice();
    let values = methods.first().map_or(&[][..], |first| &first.parts);
    if values.is_empty() {
        return top;
    }
    let occurs = |class: &Wtic| {
        let mut parts = values.iter();
        parts.any(|part| part.counted.recalls.contains_key(class))
    };
    let [screen, column] = HEIGHT;
    let height = if layout.is_compact() { column } else { screen };
    let mut bottom = top;
    for class in CLASSES.into_iter().filter(occurs) {
        let area = Area {
            height,
            ..frame_area(layout, bottom)
        };
        let panel = Panel {
            area,
            x: Axis::exact([0.0, values.len() as f64], [area.left, area.right()]),
            y: Axis::exact(RANGE, [area.bottom(), area.top]),
        };
        draw_class(canvas, &panel, class, methods, &swept.key_and_unit());
        bottom = area.bottom() + BELOW[0];
    }
    draw_values(canvas, &frame_area(layout, bottom), bottom, values);
    let middle = frame_area(layout, bottom);
    let at = [middle.left + 0.5 * middle.width, bottom + 30.0];
    let name = Font::SMALL.fit(&swept.key_and_unit(), middle.width);
    canvas.text(at, Anchor::Middle, Font::SMALL, &name);
    bottom + BELOW[1]
}

/// The swept values below their columns.
fn draw_values(canvas: &mut Canvas, area: &Area, bottom: f64, values: &[&Part]) {
    let width = area.width / values.len() as f64;
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let texts: Vec<String> = values
        .iter()
        .map(|part| Cell::toml(&part.value).written())
        .collect();
    let widest = texts.iter().map(|text| font.width(text));
    let widest = widest.fold(0.0, f64::max).min(4.0 * width);
    // Where labels are wider than columns, some columns are not labelled.
    let every = ((widest + 6.0) / width).ceil().max(1.0) as usize;
    for (column, text) in texts.iter().enumerate().step_by(every) {
        let at = [area.left + (column as f64 + 0.5) * width, bottom + 6.0];
        let text = font.fit(text, every as f64 * width - 6.0);
        canvas.text(at, Anchor::Middle, font, &text);
    }
}

fn draw_class(canvas: &mut Canvas, panel: &Panel, class: Wtic, methods: &[MethodParts], key: &str) {
    let header = format!("{}, share of correct answers [-]", class.as_str());
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
                    "{}: {:.0} % of {} windows at {key} = {}",
                    of.method,
                    100.0 * share.value,
                    share.n,
                    part.value
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
