//! The features one by one: what each is on every ground (Fig. 11).

use super::envelope::bounds;
use super::feature_points::{FEATURES, FeaturePoint, Group, drawable, left_out};
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, MUTED, Panel, Stroke, reading};
use crate::statistics::median;

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Room left of a panel for its tick labels [px].
const TICKS: f64 = 62.0;
/// Room right of a panel [px].
const RIGHT: f64 = 18.0;
/// Height of a panel [px].
const HEIGHT: f64 = 280.0;
/// Room below a panel for names and counts [px].
const NAMES: f64 = 52.0;
/// Height of title and remark [px].
const TITLE: f64 = 66.0;
/// Part of a group's column over which its points are spread [-].
const SPREAD: f64 = 0.56;

/// Each feature in a panel: a point for every window in the column of its group, spread sideways
/// by its place in the list and nothing else, and the group's median. One SVG 1200 px wide.
///
/// Windows with a feature that is no finite number are left out and counted.
pub fn feature_values(points: &[FeaturePoint]) -> String {
    let (shown, groups) = drawable(points);
    let mut canvas = Canvas::new([WIDTH, 0.0], "Vibration features");
    canvas.text(
        [16.0, 30.0],
        Anchor::Start,
        Font::TITLE,
        "Vibration features",
    );
    let what = "A mark is a window; the bar and the number are the median. 0 is the reference: the same wheel on flat hard ground.";
    let remark = left_out(points.len(), shown.len());
    let remark = remark.map_or(what.to_owned(), |remark| format!("{what} {remark}."));
    let remark = Font::SMALL.fit(&remark, WIDTH - 32.0);
    canvas.text([16.0, 53.0], Anchor::Start, Font::SMALL, &remark);
    for feature in 0..FEATURES.len() {
        let pitch = [WIDTH / 2.0, Panel::HEADER + HEIGHT + NAMES];
        let area = Area {
            left: (feature % 2) as f64 * pitch[0] + TICKS,
            top: TITLE + (feature / 2) as f64 * pitch[1] + Panel::HEADER,
            width: pitch[0] - TICKS - RIGHT,
            height: HEIGHT,
        };
        draw_feature(&mut canvas, area, feature, &shown, &groups);
    }
    canvas.set_height(TITLE + 2.0 * (Panel::HEADER + HEIGHT + NAMES));
    canvas.finish()
}

fn draw_feature(
    canvas: &mut Canvas,
    area: Area,
    feature: usize,
    points: &[FeaturePoint],
    groups: &[Group],
) {
    let values: Vec<f64> = points.iter().map(|point| point.p[feature]).collect();
    let [low, high] = bounds(&values).unwrap_or([-1.0, 1.0]);
    let columns = groups.len().max(1) as f64;
    let panel = Panel {
        area,
        x: Axis::exact([0.0, columns], [area.left, area.right()]),
        y: Axis::roomy([low.min(0.0), high.max(0.0)], [area.bottom(), area.top]),
    };
    panel.draw_category_frame(canvas, FEATURES[feature]);
    let zero = panel.y.pixel(0.0);
    canvas.polyline(
        &[[area.left, zero], [area.right(), zero]],
        Stroke::dashed(MUTED, 1.2),
    );
    for (column, group) in groups.iter().enumerate() {
        let of_group = points.iter().filter(|point| point.group == *group);
        let values: Vec<f64> = of_group.map(|point| point.p[feature]).collect();
        let shown = Shown {
            header: FEATURES[feature],
            group: *group,
            values,
        };
        shown.draw(canvas, &panel, column as f64 + 0.5);
    }
}

/// A feature of the windows of a group.
struct Shown {
    header: &'static str,
    group: Group,
    values: Vec<f64>,
}

impl Shown {
    fn draw(&self, canvas: &mut Canvas, panel: &Panel, middle: f64) {
        let Self {
            header,
            group,
            values,
        } = self;
        let Some(median) = median(values.iter().copied()) else {
            return;
        };
        let ends = [-0.42, 0.42].map(|offset| panel.at([middle + offset, median]));
        canvas.polyline(&ends, Stroke::solid(INK, 2.0));
        for (place, value) in values.iter().enumerate() {
            let x = middle + SPREAD * (radical_inverse(place as u32 + 1) - 0.5);
            let name = format!("{}: {}", group.name(), reading(header, *value));
            let at = panel.at([x, *value]);
            canvas.mark(&name, |canvas| group.mark(canvas, at));
        }
        let below = panel.area.bottom();
        let x = panel.x.pixel(middle);
        let name = Font {
            colour: INK,
            ..Font::SMALL
        };
        canvas.text([x, below + 19.0], Anchor::Middle, name, group.name());
        let text = format!("{}, n = {}", shown(median), values.len());
        canvas.text([x, below + 37.0], Anchor::Middle, Font::SMALL, &text);
    }
}

/// Two decimals; 0 has no sign.
fn shown(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" {
        return "0.00".to_owned();
    }
    text.replace('-', "−")
}

/// The digits of `number` in base 2 mirrored at the point [-]: any first few lie far apart.
fn radical_inverse(number: u32) -> f64 {
    f64::from(number.reverse_bits()) / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_spread_evenly_however_many_there_are() {
        let places: Vec<f64> = (1..8).map(radical_inverse).collect();
        assert_eq!(places, [0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875]);
    }
}
