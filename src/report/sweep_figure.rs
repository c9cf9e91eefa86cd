//! Results over a swept key: means of the steady state, and right answers of a recognition.

mod means;
mod shares;

use super::figure::{Anchor, Area, Canvas, Font, Layout, Panel};
use crate::scenario::keys::unit_of;
use crate::study::conditions::Condition;
use crate::study::score::Part;
use crate::trace::behind_number;

/// Room left of a panel for its tick labels, and right of it [px].
const TICKS: f64 = 66.0;
const RIGHT: f64 = 18.0;
/// Height of a line of the title [px].
const LINE: f64 = 28.0;

/// A swept key, and what came of the runs at its values.
#[derive(Debug, Clone)]
pub struct SweptKey<'s> {
    /// The key.
    pub key: &'s str,
    /// All swept keys, in the order of the values of a condition.
    pub keys: Vec<&'s str>,
    /// Conditions whose steady means are drawn; none to draw no means.
    pub conditions: &'s [Condition],
    /// Methods of recognition whose right answers are drawn, with the same values; none to draw no answers.
    pub methods: Vec<MethodParts<'s>>,
}

/// A method, and the windows at every value of a key.
#[derive(Debug, Clone)]
pub struct MethodParts<'s> {
    /// Its name.
    pub method: &'s str,
    /// The windows, value by value.
    pub parts: Vec<&'s Part>,
}

impl SweptKey<'_> {
    /// The key, and its unit in brackets where it is a number.
    pub(super) fn key_and_unit(&self) -> String {
        unit_of(self.key).map_or_else(
            || self.key.to_owned(),
            |unit| format!("{} [{unit}]", self.key),
        )
    }
}

/// Steady means over the values of a key, a panel a quantity and a line for every scenario and combination of the
/// other swept keys; then the share of correct answers of every method at every value with Wilson's 95 % interval, a
/// panel for every true class that occurs. One SVG as wide as `layout` says: on a screen the means are in two columns.
pub fn sweep_figure(swept: &SweptKey, layout: Layout) -> String {
    let title = format!("Results over {}", swept.key_and_unit());
    let mut canvas = Canvas::laid_out(layout, &title);
    let mut below = 0.0;
    if layout.is_titled {
        for line in Font::TITLE.wrap(&title, layout.width - 32.0) {
            below += LINE;
            canvas.text([16.0, below], Anchor::Start, Font::TITLE, &line);
        }
        below += 8.0;
    }
    below = means::draw(&mut canvas, layout, below, swept);
    below = shares::draw(&mut canvas, layout, below, swept);
    canvas.set_height(below);
    canvas.finish()
}

/// The unit of a key as it stands behind a number; nothing where it has none.
pub(super) fn unit_behind_number(key: &str) -> String {
    unit_of(key).map_or_else(String::new, |unit| behind_number(&unit))
}

/// The frame of a panel as wide as the drawing, below `top` [px]; its height is for its owner to set.
fn frame_area(layout: Layout, top: f64) -> Area {
    Area {
        left: TICKS,
        top: top + Panel::HEADER,
        width: layout.width - TICKS - RIGHT,
        height: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::confusion::Confusion;
    use crate::study::conditions::{Mean, QUANTITIES};
    use crate::study::score::Counted;
    use crate::terrain::class::Wtic;

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
        let swept = SweptKey {
            key: "wheel.lugs.count",
            keys: vec!["wheel.lugs.count"],
            conditions: &[],
            methods: methods.to_vec(),
        };
        let figure = sweep_figure(&swept, Layout::SCREEN);
        assert_eq!(figure.matches("share of correct answers").count(), 2);
        for shares in ["25 % of 4", "100 % of 4", "50 % of 4"] {
            let of_method = format!("paper: {shares} windows at wheel.lugs.count");
            assert_eq!(figure.matches(&of_method).count(), 1, "{shares}");
        }
        assert!(!figure.contains("SLCT"));
    }

    fn condition(scenario: &str, values: [&str; 2], pull: f64) -> Condition {
        let mut means = [None; QUANTITIES.len()];
        means[0] = Mean::of(&[pull, pull + 1.0]);
        Condition {
            scenario: scenario.to_owned(),
            values: values.map(str::to_owned).to_vec(),
            runs: 2,
            failed: 0,
            means,
            unsteady: Vec::new(),
        }
    }

    #[test]
    fn every_condition_has_a_mark_with_both_values_and_units_and_lines_join_what_differs_in_the_key_alone()
     {
        let load = "rig.single_wheel.load";
        let conditions = [
            condition("sand", ["0.1", "100.0"], 9.0),
            condition("sand", ["0.1", "60.0"], 5.0),
            condition("sand", ["0.3", "100.0"], 29.0),
            condition("sand", ["0.3", "60.0"], 15.0),
        ];
        let swept = SweptKey {
            key: load,
            keys: vec!["rig.single_wheel.slip", load],
            conditions: &conditions,
            methods: Vec::new(),
        };
        for layout in [Layout::SCREEN, Layout::on_paper(88.0, false)] {
            let figure = sweep_figure(&swept, layout);
            assert!(figure.contains("rig.single_wheel.load [N]"), "{figure}");
            assert_eq!(figure.matches("<circle").count(), 4, "{figure}");
            let mark = "drawbar pull 29.50 N [23.15, 35.85] at rig.single_wheel.load = 100.0 N";
            assert!(figure.contains(mark), "{figure}");
            assert!(figure.contains("rig.single_wheel.slip = 0.3"), "{figure}");
            assert!(!figure.contains("Sinkage"), "{figure}");
        }
    }
}
