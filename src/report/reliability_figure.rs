//! Whether stated probabilities hold, as a reliability diagram.

use super::figure::{Anchor, Area, Axis, Canvas, Font, MUTED, PALETTE, Panel, Stroke};
use super::share_series::ShareSeries;
use crate::challenge::score::Reliability;

/// Size of the drawing [px].
const SIZE: [f64; 2] = [640.0, 620.0];

/// Share of the most probable answers that are right, against the mean of their stated probabilities, in classes with
/// 95 % intervals and numbers of cases. Where the probabilities hold, the shares lie on the diagonal. One SVG 640 px
/// wide.
pub fn reliability_figure(classes: &[Reliability]) -> String {
    let title = "Reliability of the most probable answer";
    let mut canvas = Canvas::new(SIZE, title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let area = Area {
        left: 70.0,
        top: 84.0,
        width: SIZE[0] - 110.0,
        height: SIZE[1] - 84.0 - 60.0,
    };
    let panel = Panel {
        area,
        x: Axis::exact([0.0, 1.0], [area.left, area.right()]),
        y: Axis::exact([0.0, 1.0], [area.bottom(), area.top]),
    };
    let header = "share right [-]";
    panel.draw_frame(&mut canvas, header);
    panel.draw_footer(&mut canvas, "stated probability, mean of a class [-]");
    let diagonal = Stroke::dashed(MUTED, 1.5);
    canvas.polyline(&[panel.at([0.0, 0.0]), panel.at([1.0, 1.0])], diagonal);
    let line = ShareSeries {
        stroke: Stroke::solid(PALETTE[0], 2.0),
        beside: 0.0,
    };
    let shares = classes.iter();
    let shares = shares.filter_map(|class| Some((class.stated?, class.right)));
    line.draw(&mut canvas, &panel, shares);
    let legend = [("calibrated", diagonal), ("answers", line.stroke)];
    let legend = legend.map(|(name, stroke)| (name.to_owned(), stroke));
    panel.draw_legend(&mut canvas, header, &legend);
    canvas.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::score::Score;

    #[test]
    fn a_class_stands_at_its_mean_probability_and_one_without_cases_nowhere() {
        let class = |stated: Option<f64>, n: usize| Reliability {
            stated,
            right: Score {
                value: stated.map(|_| 0.5),
                ci95: stated.map(|_| [0.2, 0.8]),
                n,
            },
        };
        let figure = reliability_figure(&[class(Some(0.5), 17), class(None, 0)]);
        // The middle of the panel, on the diagonal.
        assert!(figure.contains("cx=\"335\" cy=\"322\""), "{figure}");
        assert!(figure.contains(">17<") && !figure.contains(">0<"));
    }
}
