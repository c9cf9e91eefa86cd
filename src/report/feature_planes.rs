//! The feature space seen from six sides, with the paper's regions (Fig. 12).

use super::class_strip::class_colour;
use super::envelope::bounds;
use super::feature_points::{FeaturePoint, Group, draw_marks, drawable, left_out};
use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, Panel, Stroke, reading};
use crate::recognition::paper::{Region, regions};

/// Width of the drawing [px].
const WIDTH: f64 = 1200.0;
/// Room left of a panel for its tick labels [px].
const TICKS: f64 = 58.0;
/// Room right of a panel [px].
const RIGHT: f64 = 14.0;
/// Height of a panel [px].
const HEIGHT: f64 = 320.0;
/// Height of title and legend [px].
const TITLE: f64 = 92.0;

/// The planes: feature across, feature up.
const PLANES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Short names of the features.
const NAMES: [&str; 4] = [
    "p_{1} = lg κ_{f}",
    "p_{2} = lg κ_{A}",
    "p_{3} = lg κ_{mv}",
    "p_{4} = lg κ_{ms}",
];

/// Every window as a point in the six planes of the feature space, over the projections of the
/// paper's regions for a wheel with so many `lugs`. One SVG 1200 px wide.
///
/// A region without an end reaches to the edge. Windows with a feature that is no finite number
/// are left out and counted.
pub fn feature_planes(points: &[FeaturePoint], lugs: u32) -> String {
    let (shown, groups) = drawable(points);
    let regions = regions(lugs);
    let mut canvas = Canvas::new([WIDTH, 0.0], "Planes of the feature space");
    draw_heading(&mut canvas, &groups, &regions);
    let remark = left_out(points.len(), shown.len());
    let ranges: [[f64; 2]; 4] = std::array::from_fn(|i| range(&shown, &regions, i));
    let pitch = [WIDTH / 3.0, Panel::HEADER + HEIGHT + Panel::FOOTER];
    for (place, plane) in PLANES.iter().enumerate() {
        let area = Area {
            left: (place % 3) as f64 * pitch[0] + TICKS,
            top: TITLE + (place / 3) as f64 * pitch[1] + Panel::HEADER,
            width: pitch[0] - TICKS - RIGHT,
            height: HEIGHT,
        };
        let [across, up] = *plane;
        let panel = Panel {
            area,
            x: Axis::roomy(ranges[across], [area.left, area.right()]),
            y: Axis::roomy(ranges[up], [area.bottom(), area.top]),
        };
        draw_plane(&mut canvas, &panel, *plane, &shown, &regions);
    }
    let below = TITLE + 2.0 * pitch[1];
    if let Some(remark) = remark {
        let at = [16.0, below + 18.0];
        canvas.text(at, Anchor::Start, Font::SMALL, &format!("{remark}."));
    }
    canvas.set_height(below + 30.0);
    canvas.finish()
}

fn draw_heading(canvas: &mut Canvas, groups: &[Group], regions: &[Region]) {
    let title = "Planes of the feature space";
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    draw_marks(canvas, groups, [16.0, 56.0]);
    let font = Font {
        colour: INK,
        ..Font::SMALL
    };
    let mut left = 16.0;
    for region in regions {
        let swatch = Area {
            left,
            top: 66.0,
            width: 24.0,
            height: 14.0,
        };
        draw_region(canvas, &swatch, region, 0.0);
        let name = format!("region of {} in the paper", region.class);
        canvas.text([left + 32.0, 78.0], Anchor::Start, font, &name);
        left += 32.0 + font.width(&name) + 20.0;
    }
}

/// From least to greatest of the points and of the regions' finite limits.
fn range(points: &[FeaturePoint], regions: &[Region], feature: usize) -> [f64; 2] {
    let limits = regions.iter().flat_map(|region| region.limits[feature]);
    let values = points.iter().map(|point| point.p[feature]).chain(limits);
    let [low, high] = bounds(&values.collect::<Vec<f64>>()).unwrap_or([-1.0, 1.0]);
    // Room beyond the limits, in which regions without an end show.
    let room = 0.12 * (high - low);
    [low - room, high + room]
}

fn draw_plane(
    canvas: &mut Canvas,
    panel: &Panel,
    [across, up]: [usize; 2],
    points: &[FeaturePoint],
    regions: &[Region],
) {
    panel.draw_frame(canvas, NAMES[up]);
    panel.draw_footer(canvas, NAMES[across]);
    canvas.clip(&panel.area);
    for (place, region) in regions.iter().enumerate() {
        let area = projection(panel, region, [across, up]);
        // Of regions that coincide in this plane, each shows its outline within the other's.
        let seen = |region: &Region| [region.limits[across], region.limits[up]];
        let same = regions[..place]
            .iter()
            .filter(|earlier| seen(earlier) == seen(region));
        draw_region(canvas, &area, region, 1.0 + 4.0 * same.count() as f64);
    }
    for point in points {
        let at = panel.at([point.p[across], point.p[up]]);
        let [x, y] = [across, up].map(|axis| reading(NAMES[axis], point.p[axis]));
        let name = format!("{}: {x}, {y}", point.group.name());
        canvas.mark(&name, |canvas| point.group.mark(canvas, at));
    }
    canvas.unclip();
}

/// A region in a plane, as far as the panel shows it.
fn projection(panel: &Panel, region: &Region, [across, up]: [usize; 2]) -> Area {
    let [left, right] =
        region.limits[across].map(|limit| panel.x.pixel(limit.clamp(panel.x.low, panel.x.high)));
    let [bottom, top] =
        region.limits[up].map(|limit| panel.y.pixel(limit.clamp(panel.y.low, panel.y.high)));
    Area {
        left,
        top,
        width: right - left,
        height: bottom - top,
    }
}

/// A region, its outline `inset` [px] within its limits.
fn draw_region(canvas: &mut Canvas, area: &Area, region: &Region, inset: f64) {
    canvas.shade(area, class_colour(region.class), 0.55);
    let [left, right] = [area.left + inset, area.right() - inset];
    let [top, bottom] = [area.top + inset, area.bottom() - inset];
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    let outline = Stroke::dashed(Group::Class(region.class).colour(), 1.6);
    canvas.polygon(&corners, "none", outline);
}
