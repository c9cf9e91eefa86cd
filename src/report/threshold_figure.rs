//! How the windows of a study lie to one of the limits of Eq. (55) to (58).

use super::figure::{Anchor, Area, Axis, Canvas, Font, INK, PALETTE, Panel, Stroke};
use crate::statistics::{quantile_nearest_rank, quantile_upper, sorted};
use crate::study;
use crate::study::thresholds::{Point, Statement};
use crate::table::four_digits;

/// Width of the drawing, and height of its panel [px].
const WIDTH: f64 = 960.0;
const PANEL: f64 = 380.0;
const MARGIN: f64 = 28.0;
/// Left of the panel: tick labels.
const LEFT: f64 = 78.0;
/// Height of a line of text [px].
const LINE: f64 = 22.0;

/// The sweep that distinguishes lugs.
const LUGS: &str = "wheel.lugs.count";

/// Every window's value over its limit by number of lugs, coloured by another sweep of the study;
/// the limit is a line.
///
/// `axes` are the sweeps of the study. A sweep over lugs goes across, or the first one where there
/// is none; of the others the one with most entries has colours. Beyond as many as there are colours
/// these repeat.
pub fn threshold_figure(statement: &Statement, axes: &[study::Axis]) -> String {
    let title = format!("{}: {}", statement.equation, statement.quantity);
    let mut canvas = Canvas::new([WIDTH, 0.0], &title);
    let room = WIDTH - 2.0 * MARGIN;
    let mut top = MARGIN + 16.0;
    for line in Font::TITLE.wrap(&title, room) {
        canvas.text([MARGIN, top], Anchor::Start, Font::TITLE, &line);
        top += LINE + 6.0;
    }
    for line in Font::SMALL.wrap(&remark(statement), room) {
        canvas.text([MARGIN, top], Anchor::Start, Font::SMALL, &line);
        top += LINE - 2.0;
    }
    let layout = Layout::new(statement, axes);
    let area = Area {
        left: LEFT,
        top: top + Panel::HEADER,
        width: WIDTH - LEFT - MARGIN,
        height: PANEL,
    };
    layout.draw_panel(&mut canvas, &area);
    let below = area.bottom() + Panel::FOOTER + 14.0;
    let height = layout.draw_legend(&mut canvas, below);
    canvas.set_height(height + MARGIN);
    canvas.finish()
}

fn remark(statement: &Statement) -> String {
    let kind = if statement.multi_lugged {
        "rim clears flat ground between the lugs"
    } else {
        "rim stands on flat ground between the lugs"
    };
    let above = statement.parts.first().map_or_else(String::new, |all| {
        let share = all.tally.violations;
        format!(
            "; {:.1} % of {} windows lie above it",
            100.0 * share.value,
            share.n
        )
    });
    format!(
        "Windows that are truly ALCT; wheels whose {kind}. Limit: {}{above}.",
        statement.limit
    )
}

/// What goes where.
struct Layout<'s> {
    points: &'s [Point],
    across: Option<(usize, &'s study::Axis)>,
    coloured: Option<(usize, &'s study::Axis)>,
    /// Entries of the sweep across that have points.
    columns: Vec<usize>,
}

impl<'s> Layout<'s> {
    fn new(statement: &'s Statement, axes: &'s [study::Axis]) -> Self {
        let numbered = || axes.iter().enumerate();
        let across = numbered()
            .find(|(_, axis)| axis.name == LUGS)
            .or_else(|| numbered().next());
        let others = numbered().filter(|(number, _)| across.is_none_or(|(of, _)| of != *number));
        let entry = |point: &Point| across.map_or(0, |(number, _)| point.entries[number]);
        let mut columns: Vec<usize> = statement.points.iter().map(entry).collect();
        columns.sort_unstable();
        columns.dedup();
        Self {
            points: &statement.points,
            across,
            coloured: others.max_by_key(|(_, axis)| axis.values.len()),
            columns,
        }
    }

    /// Column and colour of a point.
    fn place(&self, point: &Point) -> (usize, usize) {
        let entry = |axis: Option<(usize, _)>| axis.map_or(0, |(number, _)| point.entries[number]);
        let across = entry(self.across.map(|(number, _)| (number, ())));
        let column = self.columns.iter().position(|column| *column == across);
        (
            column.unwrap_or_default(),
            entry(self.coloured.map(|(number, _)| (number, ()))),
        )
    }

    fn colours(&self) -> usize {
        self.coloured.map_or(1, |(_, axis)| axis.values.len())
    }

    fn draw_panel(&self, canvas: &mut Canvas, area: &Area) {
        let ratios = sorted(self.points.iter().map(|p| p.bounded.ratio()));
        // The lowest few lie at the foot, where they would cost a decade.
        let low = quantile_upper(&ratios, 0.02).map_or(0.5, |low| low.clamp(0.01, 0.5));
        let high = ratios.last().map_or(2.0, |high| high.max(2.0));
        let y = Axis::decades([low, high], [area.bottom(), area.top]);
        self.draw_frame(canvas, area, &y);
        let pitch = area.width / self.columns.len().max(1) as f64;
        let lane = 0.86 * pitch / self.colours() as f64;
        for column in 0..self.columns.len() {
            for colour in 0..self.colours() {
                let mut here: Vec<f64> = self
                    .points
                    .iter()
                    .filter(|point| self.place(point) == (column, colour))
                    .map(|point| point.bounded.ratio())
                    .collect();
                here.sort_by(f64::total_cmp);
                let lane_of = Lane {
                    ratios: here,
                    name: self.lane_name(column, colour),
                    colour: PALETTE[colour % PALETTE.len()],
                };
                let middle = colour as f64 - 0.5 * (self.colours() as f64 - 1.0);
                let x = area.left + (column as f64 + 0.5) * pitch + middle * lane;
                lane_of.draw(canvas, [x, lane], &y);
            }
        }
        let one = y.pixel(1.0);
        let limit = [[area.left, one], [area.right(), one]];
        canvas.polyline(&limit, Stroke::solid(INK, 2.0));
    }

    /// The keys of a lane and their values.
    fn lane_name(&self, column: usize, colour: usize) -> String {
        let across = self.across.map(|(_, axis)| (axis, self.columns[column]));
        let coloured = self.coloured.map(|(_, axis)| (axis, colour));
        let entries = across.into_iter().chain(coloured);
        let names =
            entries.map(|(axis, entry)| format!("; {} = {}", axis.name, axis.values[entry]));
        names.collect()
    }

    fn draw_frame(&self, canvas: &mut Canvas, area: &Area, y: &Axis) {
        let header = "value over limit [-]";
        let frame = Panel {
            area: *area,
            // Nothing is written across: columns are no numbers.
            x: *y,
            y: *y,
        };
        frame.draw_category_frame(canvas, header);
        frame.draw_legend(
            canvas,
            header,
            &[("limit".to_owned(), Stroke::solid(INK, 2.0))],
        );
        let pitch = area.width / self.columns.len().max(1) as f64;
        for (column, entry) in self.columns.iter().enumerate() {
            let name = self.across.map_or("", |(_, axis)| &axis.values[*entry]);
            let at = [
                area.left + (column as f64 + 0.5) * pitch,
                area.bottom() + 20.0,
            ];
            canvas.text(
                at,
                Anchor::Middle,
                Font::SMALL,
                &Font::SMALL.fit(name, pitch),
            );
            if column > 0 {
                let x = area.left + column as f64 * pitch;
                let line = [[x, area.top], [x, area.bottom()]];
                canvas.polyline(&line, Stroke::solid(super::figure::GRID, 1.0));
            }
        }
        let name = self.across.map_or("", |(_, axis)| &axis.name);
        let middle = [area.left + 0.5 * area.width, area.bottom() + 42.0];
        canvas.text(middle, Anchor::Middle, Font::SMALL, name);
    }

    /// Colours and their entries in three columns; returns where they end [px].
    fn draw_legend(&self, canvas: &mut Canvas, top: f64) -> f64 {
        let Some((_, axis)) = self.coloured else {
            return top;
        };
        let room = WIDTH - 2.0 * MARGIN;
        let name = Font::SMALL.fit(&format!("colours: {}", in_short(&axis.name)), room);
        canvas.text([MARGIN, top + 6.0], Anchor::Start, Font::SMALL, &name);
        let width = room / 3.0;
        for (entry, value) in axis.values.iter().enumerate() {
            let at = [
                MARGIN + (entry % 3) as f64 * width,
                top + 6.0 + LINE * (1 + entry / 3) as f64,
            ];
            let colour = PALETTE[entry % PALETTE.len()];
            let dot = [at[0] + 6.0, at[1] - 5.0];
            canvas.circle(dot, 5.0, colour, Stroke::solid(colour, 1.0));
            let text = Font::SMALL.fit(value, width - 24.0);
            canvas.text([at[0] + 18.0, at[1]], Anchor::Start, Font::SMALL, &text);
        }
        top + 6.0 + LINE * axis.values.len().div_ceil(3) as f64
    }
}

/// The windows of one entry of both sweeps.
struct Lane {
    /// Values over limit [-], the least first.
    ratios: Vec<f64>,
    name: String,
    colour: &'static str,
}

impl Lane {
    /// The windows around `x` \[px\], side by side, and their median.
    fn draw(&self, canvas: &mut Canvas, [x, width]: [f64; 2], y: &Axis) {
        let Self { ratios, colour, .. } = self;
        for (number, ratio) in ratios.iter().enumerate() {
            // Neighbours in height stand apart.
            let aside = [-0.25, 0.25, 0.0, -0.12, 0.12][number % 5] * width;
            let at = [x + aside, y.pixel(*ratio)];
            let reading = format!("value over limit {}{}", four_digits(*ratio), self.name);
            canvas.mark(&reading, |canvas| {
                canvas.circle(at, 2.2, "none", Stroke::solid(colour, 1.0));
            });
        }
        if !ratios.is_empty() {
            let level = y.pixel(quantile_nearest_rank(ratios, 0.5));
            let line = [[x - 0.42 * width, level], [x + 0.42 * width, level]];
            canvas.polyline(&line, Stroke::solid(colour, 3.0));
        }
    }
}

/// Names of keys, with their common part once.
fn in_short(keys: &str) -> String {
    let names: Vec<&str> = keys.split(", ").collect();
    let split: Option<Vec<(&str, &str)>> = names.iter().map(|name| name.rsplit_once('.')).collect();
    match split {
        Some(parts) if parts.len() > 1 && parts.iter().all(|part| part.0 == parts[0].0) => {
            let last: Vec<&str> = parts.iter().map(|part| part.1).collect();
            format!("{} ({})", parts[0].0, last.join(", "))
        }
        _ => keys.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_one_table_are_named_once() {
        let keys = "terrain.hard.roughness.rms, terrain.hard.roughness.longest";
        assert_eq!(in_short(keys), "terrain.hard.roughness (rms, longest)");
        assert_eq!(in_short("wheel.lugs.count"), "wheel.lugs.count");
        assert_eq!(in_short("a.b, c.d"), "a.b, c.d");
    }
}
