//! A matrix as shades: which truths are taken for which, which effects look alike.

use super::figure::{Anchor, Area, Canvas, Font, INK, MUTED, PALETTE, Stroke};
use crate::challenge::score::Matrix;

/// Room left of the cells for the names of rows [px].
const LEFT: f64 = 250.0;
/// Where the cells begin [px].
const TOP: f64 = 96.0;
/// Width and height of a cell [px].
const CELL: f64 = 27.0;
/// Width of the column of the key's numbers and names [px].
const KEY: f64 = 250.0;
/// Value below which nothing is written into a cell [-].
const WRITTEN: f64 = 0.005;

/// What the numbers of a matrix are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entries {
    /// Counts, shaded by their share of the row.
    Counts,
    /// Numbers from 0 to 1, shaded as they are.
    Shares,
}

/// Rows by columns, the deeper the larger, blue where both have the same name.
/// Columns have numbers, which stand for the names at the right. One SVG.
pub fn matrix_figure(matrix: &Matrix, entries: Entries, title: &str) -> String {
    let [rows, columns] = [matrix.rows.len(), matrix.columns.len()];
    let right = LEFT + columns as f64 * CELL;
    let width = (right + KEY + 24.0).max(640.0);
    let height = TOP + rows.max(columns) as f64 * CELL + 24.0;
    let mut canvas = Canvas::new([width, height], title);
    let text = Font::TITLE.fit(title, width - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &text);
    let note = match entries {
        Entries::Counts => "rows: true; columns: answered; shades are shares of the row",
        Entries::Shares => "hundredths",
    };
    canvas.text([16.0, 54.0], Anchor::Start, Font::SMALL, note);
    for (number, name) in matrix.columns.iter().enumerate() {
        let middle = LEFT + (number as f64 + 0.5) * CELL;
        let label = (number + 1).to_string();
        canvas.text([middle, TOP - 10.0], Anchor::Middle, Font::SMALL, &label);
        let at = [right + 16.0, TOP + (number as f64 + 0.5) * CELL + 5.0];
        let text = Font::SMALL.fit(&format!("{label} {name}"), KEY);
        canvas.text(at, Anchor::Start, Font::SMALL, &text);
    }
    for (row, name) in matrix.rows.iter().enumerate() {
        let base = TOP + (row as f64 + 0.5) * CELL + 5.0;
        let text = Font::SMALL.fit(name, LEFT - 20.0);
        canvas.text([LEFT - 10.0, base], Anchor::End, Font::SMALL, &text);
        draw_row(&mut canvas, matrix, row, entries);
    }
    canvas.finish()
}

fn draw_row(canvas: &mut Canvas, matrix: &Matrix, row: usize, entries: Entries) {
    let values = &matrix.values[row];
    let total = match entries {
        Entries::Counts => values.iter().sum::<f64>().max(1.0),
        Entries::Shares => 1.0,
    };
    for (column, value) in values.iter().enumerate() {
        let cell = Area {
            left: LEFT + column as f64 * CELL,
            top: TOP + row as f64 * CELL,
            width: CELL,
            height: CELL,
        };
        let is_right = matrix.rows[row] == matrix.columns[column];
        let share = value / total;
        canvas.shade(&cell, PALETTE[usize::from(!is_right)], 0.85 * share);
        let [left, right, top, bottom] = [cell.left, cell.right(), cell.top, cell.bottom()];
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
        let frame = if is_right { MUTED } else { "#d5d9e0" };
        canvas.polygon(&corners, "none", Stroke::solid(frame, 1.0));
        if *value < WRITTEN {
            continue;
        }
        let number = match entries {
            Entries::Counts => format!("{value:.0}"),
            Entries::Shares => format!("{:.0}", 100.0 * value),
        };
        let font = Font {
            size: 12.0,
            colour: if share > 0.5 { "#ffffff" } else { INK },
            bold: false,
        };
        let at = [(left + right) / 2.0, top + 18.0];
        canvas.text(at, Anchor::Middle, font, &number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_shows_its_counts_and_names() {
        let matrix = Matrix {
            rows: ["nothing", "slope"].map(str::to_owned).to_vec(),
            columns: ["nothing", "slope", "undecided"]
                .map(str::to_owned)
                .to_vec(),
            values: vec![vec![7.0, 0.0, 1.0], vec![0.0, 0.25, 0.0]],
        };
        let counts = matrix_figure(&matrix, Entries::Counts, "<answers>");
        assert!(counts.contains("&lt;answers&gt;") && counts.contains(">3 undecided<"));
        assert!(counts.contains(">7<") && !counts.contains(">25<"));
        let probabilities = matrix_figure(&matrix, Entries::Shares, "posterior");
        assert!(probabilities.contains(">25<"));
    }
}
