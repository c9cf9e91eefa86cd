//! Answers counted against truth, as a picture.

use super::figure::{Anchor, Area, Canvas, Font, INK, MUTED, PALETTE, Stroke};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::statistics::Share;

/// Width of the drawing [px].
const WIDTH: f64 = 820.0;
/// Room left of the cells for the true classes [px].
const LEFT: f64 = 110.0;
/// Where the cells begin [px].
const TOP: f64 = 132.0;
/// Width and height of a cell [px].
const CELL: [f64; 2] = [120.0, 84.0];

/// How often each true class (row) was answered by each class (column), with shares of the row,
/// and the share answered rightly with its 95 % interval. `title` names what was counted. One SVG
/// 820 px wide.
pub fn confusion_figure(confusion: &Confusion, title: &str) -> String {
    let height = TOP + 4.0 * CELL[1] + 24.0;
    let mut canvas = Canvas::new([WIDTH, height], title);
    let title = Font::TITLE.fit(title, WIDTH - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &title);
    let accuracy = confusion.accuracy().map_or_else(
        || "no window has a known class".to_owned(),
        |share| format!("answered rightly: {} windows", interval(&share)),
    );
    canvas.text([16.0, 54.0], Anchor::Start, Font::SMALL, &accuracy);
    let right = LEFT + 4.0 * CELL[0];
    let over = [LEFT + 2.0 * CELL[0], TOP - 36.0];
    canvas.text(over, Anchor::Middle, Font::SMALL, "answered");
    let true_at = [LEFT - 14.0, TOP - 12.0];
    canvas.text(true_at, Anchor::End, Font::SMALL, "true class");
    let recall_at = [right + 16.0, TOP - 12.0];
    canvas.text(recall_at, Anchor::Start, Font::SMALL, "answered rightly");
    for (place, class) in CLASSES.iter().enumerate() {
        let middle = LEFT + (place as f64 + 0.5) * CELL[0];
        let base = TOP + (place as f64 + 0.5) * CELL[1] + 6.0;
        let name = class.as_str();
        canvas.text([middle, TOP - 12.0], Anchor::Middle, Font::HEADER, name);
        canvas.text([LEFT - 14.0, base], Anchor::End, Font::HEADER, name);
        let recall = confusion.recall(*class);
        let text = recall.map_or("did not occur".to_owned(), |share| interval(&share));
        canvas.text([right + 16.0, base], Anchor::Start, Font::SMALL, &text);
        draw_row(&mut canvas, place, &confusion.counts[place]);
    }
    canvas.finish()
}

fn draw_row(canvas: &mut Canvas, row: usize, counts: &[u64; 4]) {
    let total: u64 = counts.iter().sum();
    for (column, &count) in counts.iter().enumerate() {
        let cell = Area {
            left: LEFT + column as f64 * CELL[0],
            top: TOP + row as f64 * CELL[1],
            width: CELL[0],
            height: CELL[1],
        };
        let share = Share::of(count, total).map_or(0.0, |share| share.value);
        let colour = if row == column {
            PALETTE[0]
        } else {
            PALETTE[1]
        };
        let [truth, answer] = [row, column].map(|class| CLASSES[class].as_str());
        let reading = format!(
            "{truth} answered {answer}: {count} of {total} windows, {:.1} %",
            100.0 * share
        );
        canvas.mark(&reading, |canvas| canvas.shade(&cell, colour, 0.85 * share));
        let [left, right, top, bottom] = [cell.left, cell.right(), cell.top, cell.bottom()];
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        canvas.polygon(&corners, "none", Stroke::solid("#9aa1ad", 1.0));
        if total == 0 {
            continue;
        }
        let dark = share > 0.5;
        let [strong, weak] = if dark { ["#ffffff"; 2] } else { [INK, MUTED] };
        let middle = (left + right) / 2.0;
        let number = Font {
            size: 24.0,
            colour: if count == 0 { weak } else { strong },
            bold: row == column,
        };
        let at = [middle, top + 40.0];
        canvas.text(at, Anchor::Middle, number, &count.to_string());
        let percent = Font {
            colour: weak,
            ..Font::SMALL
        };
        let at = [middle, top + 64.0];
        let text = format!("{:.1} %", 100.0 * share);
        canvas.text(at, Anchor::Middle, percent, &text);
    }
}

/// A share in percent with its interval and number.
fn interval(share: &Share) -> String {
    let [value, low, high] = share.percent();
    format!("{value:.1} % ({low:.1} to {high:.1}) of {}", share.n)
}
