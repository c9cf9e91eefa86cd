//! Shares of cases with their intervals and numbers, as a line in a panel.

use super::figure::{Anchor, Canvas, Font, Panel, Stroke};
use crate::challenge::score::Score;

/// A line of shares.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShareSeries {
    pub(super) stroke: Stroke,
    /// Distance \[px\] from the place of a share, so that intervals of two series do not hide one another.
    pub(super) beside: f64,
}

impl ShareSeries {
    /// Draws a share with its 95 % interval at every place across (in the panel's unit), and the number of its cases;
    /// a share without cases is left out.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        panel: &Panel,
        shares: impl IntoIterator<Item = (f64, Score)>,
    ) {
        let mut points = Vec::new();
        for (place, score) in shares {
            let Some(value) = score.value else {
                continue;
            };
            let [x, y] = panel.at([place, value]);
            let x = x + self.beside;
            points.push([x, y]);
            if let Some(ends) = score.ci95 {
                let [bottom, top] = ends.map(|end| panel.y.pixel(end));
                canvas.polyline(&[[x, bottom], [x, top]], self.stroke);
            }
            // Away from the other series, and beside the end of the interval that is farther from lines and frame.
            let (away, anchor) = if self.beside < 0.0 {
                (-5.0, Anchor::End)
            } else {
                (5.0, Anchor::Start)
            };
            let end = |[low, high]: [f64; 2]| if value < 0.5 { high } else { low };
            let end = score.ci95.map_or(value, end).clamp(0.02, 0.98);
            let at = [x + away, panel.y.pixel(end) + 5.0];
            canvas.text(at, anchor, Font::SMALL, &score.n.to_string());
        }
        canvas.polyline(&points, self.stroke);
        for point in points {
            canvas.point(point, self.stroke.colour);
        }
    }
}
