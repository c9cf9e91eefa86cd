//! How large an effect has to be to be found, as a picture.

use super::figure::{Anchor, Area, Axis, Canvas, Font, PALETTE, Panel, Scale, Stroke};
use super::share_series::ShareSeries;
use crate::challenge::score::{Power, Score};

/// Size of the drawing [px].
const SIZE: [f64; 2] = [820.0, 420.0];
/// Magnitudes over the detection limit [-] at the ends of the axis.
const ENDS: [f64; 2] = [0.25, 32.0];

/// A curve of the figure.
struct Series {
    name: &'static str,
    /// Its score in a class.
    of: fn(&Power) -> Score,
    line: ShareSeries,
}

/// Share of cases whose effect is named, up to equivalence, against its magnitude over the least
/// that could be detected, in the catalogue's form and in another, with 95 % intervals and numbers of
/// cases. One SVG 820 px wide.
pub fn power_figure(classes: &[Power], title: &str) -> String {
    let mut canvas = Canvas::new(SIZE, title);
    let text = Font::TITLE.fit(title, SIZE[0] - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &text);
    let area = Area {
        left: 80.0,
        top: 84.0,
        width: SIZE[0] - 110.0,
        height: SIZE[1] - 84.0 - 60.0,
    };
    let panel = Panel {
        area,
        x: Axis {
            low: ENDS[0],
            high: ENDS[1],
            from: area.left,
            to: area.right(),
            scale: Scale::Logarithmic,
        },
        y: Axis::exact([0.0, 1.0], [area.bottom(), area.top]),
    };
    let header = "share named [-]";
    panel.draw_category_frame(&mut canvas, header);
    draw_ticks(&mut canvas, &panel);
    let series = [
        Series {
            name: "catalogue's form",
            of: |it| it.own,
            line: ShareSeries {
                stroke: Stroke::solid(PALETTE[0], 2.0),
                beside: -3.0,
            },
        },
        Series {
            name: "another form",
            of: |it| it.other,
            line: ShareSeries {
                stroke: Stroke::solid(PALETTE[1], 2.0),
                beside: 3.0,
            },
        },
    ];
    let mut legend = Vec::new();
    for series in series {
        legend.push((series.name.to_owned(), series.line.stroke));
        draw_series(&mut canvas, &panel, classes, &series);
    }
    panel.draw_legend(&mut canvas, header, &legend);
    canvas.finish()
}

fn draw_ticks(canvas: &mut Canvas, panel: &Panel) {
    let bottom = panel.area.bottom();
    for value in [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0] {
        let at = [panel.x.pixel(value), bottom + 20.0];
        canvas.text(at, Anchor::Middle, Font::SMALL, &value.to_string());
    }
    let middle = [panel.area.left + panel.area.width / 2.0, bottom + 42.0];
    let name = "magnitude over the least detectable [-]";
    canvas.text(middle, Anchor::Middle, Font::SMALL, name);
}

fn draw_series(canvas: &mut Canvas, panel: &Panel, classes: &[Power], series: &Series) {
    let shares = classes.iter().map(|class| {
        let [low, high] = [class.low.max(ENDS[0]), class.high.unwrap_or(ENDS[1])];
        (libm::sqrt(low * high), (series.of)(class))
    });
    series.line.draw(canvas, panel, shares);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_without_cases_has_no_point() {
        let score = |value: Option<f64>, n: usize| Score {
            value,
            ci95: value.map(|_| [0.0, 1.0]),
            n,
        };
        let class = |low: f64, n: usize| Power {
            low,
            high: Some(2.0 * low),
            own: score((n > 0).then_some(0.5), n),
            other: score(None, 0),
        };
        let figure = power_figure(&[class(0.5, 0), class(1.0, 17)], "power");
        assert!(
            figure.contains(">17<") && !figure.contains(">0<"),
            "{figure}"
        );
    }
}
