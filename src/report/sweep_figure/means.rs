//! Means of the steady state over the values of a swept key.

use super::{RIGHT, SweptKey, TICKS, unit_behind_number};
use crate::report::envelope::bounds;
use crate::report::figure::{
    Anchor, Area, Axis, Canvas, Font, GRID, INK, Layout, MUTED, PALETTE, Panel, Scale, Stroke,
};
use crate::study::conditions::{Condition, Mean, QUANTITIES, SINKAGE};
use crate::table::{Cell, four_digits};

/// Quantities that have a panel, by their place in [`QUANTITIES`], and how a panel is headed. Load and slip are
/// commanded.
const PANELS: [(usize, &str); 6] = [
    (0, "Drawbar pull F_{DP}"),
    (2, "Driving torque T_{D}"),
    (SINKAGE, "Sinkage of the rim z_{}"),
    (5, "Acceleration a_{y}, 2 to 20 Hz, rms"),
    (6, "Acceleration a_{y}, 20 to 200 Hz, rms"),
    (7, "Acceleration a_{y}, 200 to 800 Hz, rms"),
];

/// Height of a panel [px], on a screen and in a column of a paper.
const HEIGHT: [f64; 2] = [150.0, 80.0];
/// Height of a line of the legend [px].
const LINE: f64 = 22.0;
/// Ratio [-] of the largest to the least value from which an axis is logarithmic.
const WIDE: f64 = 30.0;
/// Room [-] for intervals beyond the means, by the range of the means.
const ROOM: f64 = 0.5;

/// The panels of the quantities that were recorded; returns where they end [px].
pub(super) fn draw(canvas: &mut Canvas, layout: Layout, top: f64, swept: &SweptKey) -> f64 {
    let sweep = Sweep::of(swept);
    let shown: Vec<(usize, &str)> = PANELS
        .into_iter()
        .filter(|(quantity, _)| sweep.has(*quantity))
        .collect();
    if shown.is_empty() {
        return top;
    }
    let top = sweep.draw_legend(canvas, layout, top);
    let columns = if layout.is_compact() { 1 } else { 2 };
    let [screen, column] = HEIGHT;
    let height = if layout.is_compact() { column } else { screen };
    let pitch = [
        layout.width / columns as f64,
        Panel::HEADER + height + if layout.is_compact() { 6.0 } else { 14.0 },
    ];
    let rows = shown.len().div_ceil(columns);
    for (place, (quantity, name)) in shown.iter().enumerate() {
        let (row, column) = (place % rows, place / rows);
        let area = Area {
            left: column as f64 * pitch[0] + TICKS,
            top: top + row as f64 * pitch[1] + Panel::HEADER,
            width: pitch[0] - TICKS - RIGHT,
            height,
        };
        let panel = sweep.draw_panel(canvas, area, *quantity, name);
        let is_last = row + 1 == rows || place + 1 == shown.len();
        sweep.draw_values(canvas, &panel, is_last);
    }
    top + rows as f64 * pitch[1] + Panel::FOOTER
}

/// The conditions as lines over the key.
struct Sweep<'s> {
    swept: &'s SweptKey<'s>,
    /// Unit of the key behind a number.
    unit: String,
    /// Whether the values of the key are numbers.
    is_numeric: bool,
    scenarios: Vec<&'s str>,
    /// Places across of the values, and the values as written.
    values: Vec<(f64, String)>,
    lines: Vec<Line<'s>>,
}

/// Conditions that differ in the key alone.
struct Line<'s> {
    /// Number of its scenario.
    scenario: usize,
    colour: &'static str,
    /// Values of the other keys.
    others: Vec<&'s str>,
    /// Place across, and the condition.
    points: Vec<(f64, &'s Condition)>,
}

/// Whether there is a colour for every line; else lines have that of their scenario.
fn is_each_coloured(lines: &[Line]) -> bool {
    lines.len() <= PALETTE.len()
}

impl<'s> Sweep<'s> {
    fn of(swept: &'s SweptKey<'s>) -> Self {
        let place = swept.keys.iter().position(|key| *key == swept.key);
        let place = place.unwrap_or(0);
        let of_key = |condition: &'s Condition| condition.values[place].as_str();
        let values = values(swept.conditions.iter().map(of_key));
        let mut scenarios: Vec<&str> = Vec::new();
        let mut lines: Vec<Line> = Vec::new();
        for condition in swept.conditions {
            let name = condition.scenario.as_str();
            let scenario = scenarios.iter().position(|known| *known == name);
            let scenario = scenario.unwrap_or(scenarios.len());
            if scenario == scenarios.len() {
                scenarios.push(name);
            }
            let others = condition.values.iter().enumerate();
            let others = others.filter(|(number, _)| *number != place);
            let others: Vec<&str> = others.map(|(_, value)| value.as_str()).collect();
            let written = Cell::toml(of_key(condition)).written();
            let across = values.iter().find(|(_, value)| *value == written);
            let point = (across.map_or(0.0, |(x, _)| *x), condition);
            let own = |line: &&mut Line| line.scenario == scenario && line.others == others;
            match lines.iter_mut().find(own) {
                Some(line) => line.points.push(point),
                None => lines.push(Line {
                    scenario,
                    colour: PALETTE[0],
                    others,
                    points: vec![point],
                }),
            }
        }
        let is_each_coloured = is_each_coloured(&lines);
        for (number, line) in lines.iter_mut().enumerate() {
            line.points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let colour = if is_each_coloured {
                number
            } else {
                line.scenario
            };
            line.colour = PALETTE[colour % PALETTE.len()];
        }
        Self {
            unit: unit_behind_number(swept.key),
            is_numeric: swept
                .conditions
                .iter()
                .all(|condition| of_key(condition).parse::<f64>().is_ok()),
            swept,
            scenarios,
            values,
            lines,
        }
    }

    fn means(&self, quantity: usize) -> impl Iterator<Item = Mean> {
        let conditions = self.swept.conditions.iter();
        conditions.filter_map(move |condition| condition.means[quantity])
    }

    fn has(&self, quantity: usize) -> bool {
        self.means(quantity).next().is_some()
    }

    /// The scenarios and what lines are; returns where they end [px].
    fn draw_legend(&self, canvas: &mut Canvas, layout: Layout, top: f64) -> f64 {
        let room = layout.width - 32.0;
        let mut below = top;
        if layout.is_titled {
            for line in Font::SMALL.wrap(&self.remark(), room) {
                below += LINE - 2.0;
                canvas.text([16.0, below], Anchor::Start, Font::SMALL, &line);
            }
        }
        let entries = self.legend();
        if entries.len() < 2 {
            return below + 6.0;
        }
        let font = Font {
            colour: INK,
            ..Font::SMALL
        };
        let mut left = 16.0;
        below += LINE;
        for (name, colour) in &entries {
            let name = font.fit(name, room - 30.0);
            let width = 46.0 + font.width(&name);
            if left > 16.0 && left + width > room {
                left = 16.0;
                below += LINE;
            }
            let swatch = [[left, below - 5.0], [left + 22.0, below - 5.0]];
            canvas.polyline(&swatch, Stroke::solid(colour, 2.5));
            canvas.text([left + 28.0, below], Anchor::Start, font, &name);
            left += width;
        }
        below + 6.0
    }

    /// Names and colours: of the lines where each has its own, else of the scenarios.
    fn legend(&self) -> Vec<(String, &'static str)> {
        let mut entries: Vec<(String, &str)> = Vec::new();
        let is_each_coloured = is_each_coloured(&self.lines);
        for line in &self.lines {
            let scenario = self.scenarios[line.scenario];
            let name = if is_each_coloured {
                self.name(line)
            } else {
                scenario.to_owned()
            };
            if entries.iter().all(|(known, _)| *known != name) {
                entries.push((name, line.colour));
            }
        }
        entries
    }

    /// The scenario, where there are several, and the values of the other keys by the last part of their names.
    fn name(&self, line: &Line) -> String {
        let scenario = (self.scenarios.len() > 1).then(|| self.scenarios[line.scenario].to_owned());
        let others = self.other_keys().zip(&line.others);
        let others = others.map(|(key, value)| {
            let last = key.rsplit('.').next().unwrap_or(key);
            let value = Cell::toml(value).written();
            format!("{last} = {value}{}", unit_behind_number(key))
        });
        scenario
            .into_iter()
            .chain(others)
            .collect::<Vec<_>>()
            .join(", ")
    }

    fn other_keys(&self) -> impl Iterator<Item = &'s str> {
        let keys = self.swept.keys.iter().copied();
        keys.filter(|key| *key != self.swept.key)
    }

    fn remark(&self) -> String {
        let others: Vec<&str> = self.other_keys().collect();
        let of_each = match others.as_slice() {
            [] => String::new(),
            [key] => format!(" A line for each value of {key}."),
            _ => format!(" A line for each combination of {}.", others.join(", ")),
        };
        let bars = if self.means(0).any(|mean| mean.ci95.is_some()) {
            " Bars: Student's 95 % interval over the repeats."
        } else {
            ""
        };
        let on_lugs = if self.swept.conditions.iter().any(Condition::is_on_lugs) {
            " Sinkage below 0: the wheel stands on its lugs, its rim above the surface."
        } else {
            ""
        };
        format!("Means of the steady state of each condition.{of_each}{bars}{on_lugs}")
    }

    fn axis(&self, ends: [f64; 2]) -> Axis {
        let places: Vec<f64> = self.values.iter().map(|(x, _)| *x).collect();
        let [low, high] = bounds(&places).unwrap_or([0.0, 1.0]);
        if !self.is_numeric {
            return Axis::exact([low - 0.5, high + 0.5], ends);
        }
        if low > 0.0 && high / low >= WIDE {
            let room = libm::pow(high / low, 0.06);
            return Axis {
                low: low / room,
                high: high * room,
                from: ends[0],
                to: ends[1],
                scale: Scale::Logarithmic,
            };
        }
        Axis::roomy([low, high], ends)
    }

    fn draw_panel(&self, canvas: &mut Canvas, area: Area, quantity: usize, name: &str) -> Panel {
        let panel = Panel {
            area,
            x: self.axis([area.left, area.right()]),
            y: Axis::roomy(self.range(quantity), [area.bottom(), area.top]),
        };
        for (x, _) in &self.values {
            let x = panel.x.pixel(*x);
            let line = [[x, area.top], [x, area.bottom()]];
            canvas.polyline(&line, Stroke::solid(GRID, 1.0));
        }
        let unit = QUANTITIES[quantity].unit.replace(' ', "·");
        let header = format!("{name} [{unit}]");
        if self.is_numeric {
            panel.draw_level_frame(canvas, &header);
        } else {
            panel.draw_category_frame(canvas, &header);
        }
        canvas.clip(&area);
        for line in &self.lines {
            self.draw_line(canvas, &panel, quantity, line);
        }
        canvas.unclip();
        panel
    }

    /// From 0 on, or differences of a per cent look like trends; intervals as far as they leave room for the means.
    fn range(&self, quantity: usize) -> [f64; 2] {
        let values: Vec<f64> = self.means(quantity).map(|mean| mean.value).collect();
        let [low, high] = bounds(&values).unwrap_or([0.0, 1.0]);
        let room = ROOM * (high - low).max(0.1 * high.abs().max(low.abs()));
        let ends = self.means(quantity).filter_map(|mean| mean.ci95).flatten();
        let ends = ends.map(|end| end.clamp(low - room, high + room));
        let all: Vec<f64> = ends.chain([low.min(0.0), high.max(0.0)]).collect();
        bounds(&all).unwrap_or([0.0, 1.0])
    }

    fn draw_line(&self, canvas: &mut Canvas, panel: &Panel, quantity: usize, line: &Line) {
        let colour = line.colour;
        let points = line.points.iter().filter_map(|(x, condition)| {
            let mean = condition.means[quantity]?;
            Some((panel.at([*x, mean.value]), mean, *condition))
        });
        let points: Vec<_> = points.collect();
        let path: Vec<[f64; 2]> = points.iter().map(|(at, ..)| *at).collect();
        if self.is_numeric {
            canvas.polyline(&path, Stroke::solid(colour, 1.5));
        }
        for (at, mean, condition) in points {
            if let Some(ends) = mean.ci95 {
                let bar = ends.map(|end| [at[0], panel.y.pixel(end)]);
                canvas.polyline(&bar, Stroke::solid(colour, 1.2));
            }
            let reading = self.reading(quantity, &mean, condition);
            canvas.mark(&reading, |canvas| canvas.point(at, colour));
        }
    }

    /// Both values of a mark with their units, and its condition.
    fn reading(&self, quantity: usize, mean: &Mean, condition: &Condition) -> String {
        let quantity = &QUANTITIES[quantity];
        let name = match quantity.name {
            name if name.ends_with("0 Hz") => format!("acceleration {name}, rms"),
            name => name.to_owned(),
        };
        let interval = mean.ci95.map_or(String::new(), |[low, high]| {
            format!(" [{}, {}]", four_digits(low), four_digits(high))
        });
        let value = four_digits(quantity.without_rounding(mean.value));
        let keys = self.swept.keys.iter().zip(&condition.values);
        let is_own = |key: &str| key == self.swept.key;
        let own = keys.clone().find(|(key, _)| is_own(key));
        let unit = &self.unit;
        let own = own.map_or_else(String::new, |(key, at)| format!(" at {key} = {at}{unit}"));
        let others = keys.filter(|(key, _)| !is_own(key));
        let others = others.map(|(key, value)| format!("; {key} = {value}"));
        format!(
            "{}: {name} {value} {}{interval}{own}{}",
            condition.scenario,
            quantity.unit,
            others.collect::<String>()
        )
    }

    /// Ticks at the swept values, and below the last panel of a column their labels, as far as they do not overlap,
    /// and the key.
    fn draw_values(&self, canvas: &mut Canvas, panel: &Panel, is_last: bool) {
        let area = &panel.area;
        let mut free = f64::NEG_INFINITY;
        for (x, text) in &self.values {
            let x = panel.x.pixel(*x);
            let tick = [[x, area.bottom()], [x, area.bottom() + 5.0]];
            canvas.polyline(&tick, Stroke::solid(MUTED, 1.0));
            let half = 0.5 * Font::SMALL.width(text);
            if is_last && x - half > free {
                let at = [x, area.bottom() + 20.0];
                canvas.text(at, Anchor::Middle, Font::SMALL, text);
                free = x + half + 8.0;
            }
        }
        if is_last {
            let at = [area.left + 0.5 * area.width, area.bottom() + 39.0];
            let name = Font::SMALL.fit(&self.swept.key_and_unit(), area.width);
            canvas.text(at, Anchor::Middle, Font::SMALL, &name);
        }
    }
}

/// The values that occur, each once: numbers by size at their size, others in their order side by side.
fn values<'v>(all: impl Iterator<Item = &'v str>) -> Vec<(f64, String)> {
    let mut found: Vec<&str> = Vec::new();
    for value in all {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    let written = |value: &&str| Cell::toml(value).written();
    let numbers: Option<Vec<f64>> = found.iter().map(|value| value.parse().ok()).collect();
    let places = numbers.unwrap_or_else(|| (0..found.len()).map(|place| place as f64).collect());
    let mut values: Vec<(f64, String)> =
        places.into_iter().zip(found.iter().map(written)).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    values
}
