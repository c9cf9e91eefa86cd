//! Which effects show alike, as a picture.

use super::figure::{Anchor, Area, Canvas, Font, INK, PALETTE, Stroke};

/// Room left of the grid for the names [px].
const LEFT: f64 = 330.0;
/// Where the grid begins [px].
const TOP: f64 = 122.0;
/// Width and height of a field [px]: of few effects, and at least.
const FIELD: [f64; 2] = [26.0, 17.0];
/// Width [px] that the grid should not exceed.
const GRID: f64 = 850.0;

/// Cosines of the effects' signatures, as far as parameters leave them: blue where two show alike,
/// vermilion where they are opposite, white where nothing is alike; framed from `alike` [-] on, where
/// these runs cannot discriminate between them. Effects stand beside those that show like them. One SVG.
pub fn isolability_map(names: &[&str], cosines: &[Vec<f64>], alike: f64) -> String {
    let order = chain(cosines, names.len());
    let count = order.len();
    let field = (GRID / count.max(1) as f64).clamp(FIELD[1], FIELD[0]);
    let size = field * count as f64;
    let width = (LEFT + size + 24.0).max(760.0);
    let title = "Effects that show alike in these runs";
    let mut canvas = Canvas::new([width, TOP + size + 24.0], title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    draw_legend(&mut canvas, alike);
    for (row, &effect) in order.iter().enumerate() {
        let y = TOP + (row as f64 + 0.5) * field + 4.0;
        draw_name(&mut canvas, names[effect], row + 1, y);
        let x = LEFT + (row as f64 + 0.5) * field;
        let font = Font {
            size: 0.55 * field,
            ..Font::SMALL
        };
        let number = (row + 1).to_string();
        canvas.text([x, TOP - 6.0], Anchor::Middle, font, &number);
        for (column, &other) in order.iter().enumerate() {
            let area = Area {
                left: LEFT + column as f64 * field,
                top: TOP + row as f64 * field,
                width: field,
                height: field,
            };
            let cosine = cosines[effect].get(other).copied().unwrap_or(f64::NAN);
            let reading = format!("{} and {}: cosine {cosine:.2}", names[effect], names[other]);
            if is_drawn(cosine) {
                canvas.mark(&reading, |canvas| draw_field(canvas, &area, cosine));
            }
        }
    }
    // Frames last, or neighbours would cover them.
    for (row, &effect) in order.iter().enumerate() {
        for (column, &other) in order.iter().enumerate() {
            let cosine = cosines[effect].get(other).copied().unwrap_or(f64::NAN);
            if effect != other && cosine.abs() > alike {
                let corner = [LEFT + column as f64 * field, TOP + row as f64 * field];
                frame(&mut canvas, corner, [field; 2], Stroke::solid(INK, 2.0));
            }
        }
    }
    let edge = Stroke::solid("#9aa1ad", 1.0);
    frame(&mut canvas, [LEFT, TOP], [size; 2], edge);
    canvas.finish()
}

/// Effects in an order in which each stands beside the one most like it of those that are left.
fn chain(cosines: &[Vec<f64>], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..count.min(cosines.len())).collect();
    if left.is_empty() {
        return left;
    }
    let alike = |a: usize, b: usize| {
        let cosine = cosines[a].get(b).copied().unwrap_or(0.0).abs();
        if cosine.is_nan() { 0.0 } else { cosine }
    };
    let mut order = vec![left.remove(0)];
    while !left.is_empty() {
        let last = order[order.len() - 1];
        // The first of equals, as the catalogue has them.
        let nearest = (0..left.len())
            .rev()
            .max_by(|a, b| alike(last, left[*a]).total_cmp(&alike(last, left[*b])));
        order.extend(nearest.map(|place| left.remove(place)));
    }
    order
}

fn draw_legend(canvas: &mut Canvas, alike: f64) {
    let mut left = 16.0;
    for (cosine, text) in [
        (1.0, "cosine 1: alike"),
        (0.5, "0.5"),
        (0.0, "0: different"),
        (-0.5, "−0.5"),
        (-1.0, "−1: opposite"),
    ] {
        let swatch = Area {
            left,
            top: 50.0,
            width: 22.0,
            height: 14.0,
        };
        if is_drawn(cosine) {
            draw_field(canvas, &swatch, cosine);
        }
        frame(
            canvas,
            [left, 50.0],
            [22.0, 14.0],
            Stroke::solid("#9aa1ad", 1.0),
        );
        canvas.text([left + 30.0, 62.0], Anchor::Start, Font::SMALL, text);
        left += 50.0 + Font::SMALL.width(text);
    }
    let text =
        format!("Framed: beyond {alike}, where these runs cannot discriminate between the two.");
    canvas.text([16.0, 84.0], Anchor::Start, Font::SMALL, &text);
}

fn draw_name(canvas: &mut Canvas, name: &str, number: usize, y: f64) {
    let font = Font {
        size: 13.0,
        colour: INK,
        bold: false,
    };
    let text = font.fit(&format!("{name}  {number}"), LEFT - 24.0);
    canvas.text([LEFT - 8.0, y], Anchor::End, font, &text);
}

fn draw_field(canvas: &mut Canvas, area: &Area, cosine: f64) {
    let colour = if cosine < 0.0 { PALETTE[1] } else { PALETTE[0] };
    // Small cosines are common and mean nothing: the square keeps them pale.
    canvas.shade(area, colour, (cosine * cosine).min(1.0));
}

/// Whether a field is seen.
fn is_drawn(cosine: f64) -> bool {
    cosine.abs() > 0.1
}

fn frame(canvas: &mut Canvas, [left, top]: [f64; 2], [width, height]: [f64; 2], stroke: Stroke) {
    let (right, bottom) = (left + width, top + height);
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    canvas.polygon(&corners, "none", stroke);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_that_show_alike_stand_beside_each_other() {
        let cosines = vec![
            vec![1.0, 0.1, 0.9, f64::NAN],
            vec![0.1, 1.0, 0.0, -0.97],
            vec![0.9, 0.0, 1.0, 0.2],
            vec![f64::NAN, -0.97, 0.2, 1.0],
        ];
        assert_eq!(chain(&cosines, 4), [0, 2, 3, 1]);
        let svg = isolability_map(&["a", "b", "c", "d"], &cosines, 0.95);
        // The pair and its mirror image.
        assert_eq!(svg.matches("stroke-width=\"2\"").count(), 2, "{svg}");
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn no_effects_and_rows_too_short_make_a_drawing_all_the_same() {
        assert!(isolability_map(&[], &[], 0.95).starts_with("<svg"));
        assert!(isolability_map(&["a", "b"], &[vec![1.0]], 0.95).starts_with("<svg"));
    }
}
