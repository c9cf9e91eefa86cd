//! The class over time as a strip of colours.

use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, Stroke};
use crate::recognition::confusion::CLASSES;
use crate::terrain::class::Wtic;
use crate::trace::ClassWindow;

/// A class over a stretch of time.
pub(super) struct ClassSpan {
    /// Begin and end [s].
    pub time: [f64; 2],
    /// The class.
    pub class: Wtic,
    /// What is written there if it fits; the class alone if only that does.
    pub name: String,
}

impl ClassSpan {
    /// Draws the stretch within `strip`.
    pub fn draw(&self, canvas: &mut Canvas, time: &Axis, strip: &Area) {
        let [start, end] = self.time;
        let left = time.pixel(start).max(strip.left);
        let right = time.pixel(end).min(strip.right());
        let area = Area {
            left,
            width: right - left,
            ..*strip
        };
        let times = format!("{}, {start:.2} s to {end:.2} s", self.name);
        canvas.rect(&area, class_colour(self.class), &times);
        let edge = [[left, strip.top], [left, strip.bottom()]];
        canvas.polyline(&edge, Stroke::solid("#ffffff", 1.5));
        let font = Font {
            colour: INK,
            ..Font::SMALL
        };
        let names = [self.name.as_str(), self.class.as_str()];
        if let Some(name) = names
            .iter()
            .find(|name| font.width(name) + 6.0 < area.width)
        {
            let middle = [(left + right) / 2.0, strip.bottom() - 7.0];
            canvas.text(middle, Anchor::Middle, font, name);
        }
    }
}

/// Windows with neighbours of the same class and terrain joined.
pub(super) fn merged(windows: &[ClassWindow]) -> Vec<ClassWindow> {
    let mut merged: Vec<ClassWindow> = Vec::new();
    for window in windows {
        match merged.last_mut() {
            Some(last) if (last.class, last.terrain) == (window.class, window.terrain) => {
                last.end = window.end;
            }
            _ => merged.push(*window),
        }
    }
    merged
}

/// Legend of the classes among `shown`.
pub(super) fn keys(shown: impl Iterator<Item = Wtic>) -> Vec<(String, Stroke)> {
    let shown: Vec<Wtic> = shown.collect();
    let classes = CLASSES.into_iter().filter(|class| shown.contains(class));
    classes
        .map(|class| {
            let name = format!("{class}: {}", class_name(class));
            (name, Stroke::solid(class_colour(class), 12.0))
        })
        .collect()
}

pub(super) fn class_name(class: Wtic) -> &'static str {
    match class {
        Wtic::Alct => "all lugs contact",
        Wtic::Slct => "some lugs contact",
        Wtic::Leis => "lugs enter the soil",
        Wtic::Uwtic => "unknown",
    }
}

/// Light, so that text can stand on it.
pub(super) fn class_colour(class: Wtic) -> &'static str {
    match class {
        Wtic::Alct => "#9ecae8",
        Wtic::Slct => "#b8b2a7",
        Wtic::Leis => "#f0cf7a",
        Wtic::Uwtic => "#e4e6ea",
    }
}
