//! The gap map as a picture: where measured and simulated runs differ.

use super::figure::{Anchor, Area, Canvas, Font, INK, Stroke};
use crate::gap::{Cell, Colour, Condition, Domain, Entry, GapMap};

/// Room left of the grid for the channels [px].
const LEFT: f64 = 250.0;
/// Where the grid begins [px].
const TOP: f64 = 150.0;
/// Width and height of a field [px].
const FIELD: [f64; 2] = [150.0, 66.0];
/// Height of the strip of conditions in it [px].
const STRIP: f64 = 9.0;
/// Strength |z| [-] at which the shade is full.
const FULL: f64 = 10.0;

/// Vermilion, green and grey: distinct with any colour vision.
fn ink(colour: Colour) -> &'static str {
    match colour {
        Colour::Gap => "#d55e00",
        Colour::Equivalent => "#009e73",
        Colour::Undecided => "#8a93a3",
    }
}

/// A grid of channels and domains. Each field has the colour of its strongest cell, the stronger
/// the deeper, with the cell's name and |z|; a gap goes before what is no gap. The strip below it
/// has one part a condition, in the order listed under the grid. One SVG.
pub fn gap_map(map: &GapMap, title: &str) -> String {
    let channels = distinct(map.entries.iter().map(|entry| entry.channel.as_str()));
    let domains: Vec<Domain> = Domain::ALL
        .into_iter()
        .filter(|domain| map.entries.iter().any(|entry| entry.domain == *domain))
        .collect();
    let conditions = distinct(map.entries.iter().map(|entry| &entry.condition));
    let notes = notes(map, &conditions);
    let width = (LEFT + domains.len() as f64 * FIELD[0] + 24.0).max(820.0);
    let bottom = TOP + channels.len() as f64 * FIELD[1];
    let lines: Vec<String> = notes
        .iter()
        .flat_map(|note| Font::SMALL.wrap(note, width - 32.0))
        .collect();
    let height = bottom + 30.0 + 20.0 * lines.len() as f64;
    let mut canvas = Canvas::new([width, height], title);
    draw_head(&mut canvas, map, title, width);
    for (column, domain) in domains.iter().enumerate() {
        let middle = LEFT + (column as f64 + 0.5) * FIELD[0];
        let at = [middle, TOP - 12.0];
        canvas.text(at, Anchor::Middle, Font::HEADER, domain.as_str());
    }
    for (row, channel) in channels.iter().enumerate() {
        let top = TOP + row as f64 * FIELD[1];
        draw_channel(&mut canvas, channel, top);
        for (column, domain) in domains.iter().enumerate() {
            let field = Area {
                left: LEFT + column as f64 * FIELD[0],
                top,
                width: FIELD[0],
                height: FIELD[1],
            };
            let entries: Vec<&Entry> = map
                .entries
                .iter()
                .filter(|entry| entry.channel == *channel && entry.domain == *domain)
                .collect();
            draw_field(&mut canvas, &field, &entries, &conditions);
        }
    }
    for (number, line) in lines.iter().enumerate() {
        let at = [16.0, bottom + 28.0 + 20.0 * number as f64];
        canvas.text(at, Anchor::Start, Font::SMALL, line);
    }
    canvas.finish()
}

fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

fn draw_head(canvas: &mut Canvas, map: &GapMap, title: &str, width: f64) {
    let title = Font::TITLE.fit(title, width - 32.0);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, &title);
    let global = &map.global;
    let text = format!(
        "all runs: energy distance p = {:.3}, strongest cell p = {:.3} (no less than {:.3} can \
         come of so few runs)",
        global.energy.p, global.strongest.p, global.least_p
    );
    let text = Font::SMALL.fit(&text, width - 32.0);
    canvas.text([16.0, 56.0], Anchor::Start, Font::SMALL, &text);
    let mut left = 16.0;
    for (colour, name) in [
        (Colour::Gap, "gap"),
        (Colour::Equivalent, "equivalent within its margin"),
        (Colour::Undecided, "undecided"),
    ] {
        let swatch = Area {
            left,
            top: 74.0,
            width: 22.0,
            height: 14.0,
        };
        canvas.shade(&swatch, ink(colour), 0.8);
        let text = format!("{name}: {} cells", map.count(colour));
        canvas.text([left + 30.0, 86.0], Anchor::Start, Font::SMALL, &text);
        left += 54.0 + Font::SMALL.width(&text);
    }
}

/// Name of a channel; a pair on two lines.
fn draw_channel(canvas: &mut Canvas, channel: &str, top: f64) {
    let names: Vec<&str> = channel.split('~').collect();
    let first = top + FIELD[1] / 2.0 + 5.0 - 9.0 * (names.len() - 1) as f64;
    for (line, name) in names.iter().enumerate() {
        let name = if line == 0 {
            (*name).to_owned()
        } else {
            format!("with {name}")
        };
        let font = if names.len() > 1 {
            Font::SMALL
        } else {
            Font::HEADER
        };
        let at = [LEFT - 12.0, first + 18.0 * line as f64];
        let text = font.fit(&name, LEFT - 20.0);
        canvas.text(at, Anchor::End, font, &text);
    }
}

/// A gap before what is none, the stronger first.
fn strongest<'e>(entries: &[&'e Entry]) -> Option<&'e Entry> {
    let key = |entry: &Entry| (entry.colour == Colour::Gap, entry.z.abs());
    let later = |a: &&&Entry, b: &&&Entry| {
        let ((gap_a, z_a), (gap_b, z_b)) = (key(a), key(b));
        gap_a.cmp(&gap_b).then(z_a.total_cmp(&z_b))
    };
    entries.iter().max_by(later).copied()
}

fn draw_field(canvas: &mut Canvas, field: &Area, entries: &[&Entry], conditions: &[&Condition]) {
    let [left, right, top, bottom] = [field.left, field.right(), field.top, field.bottom()];
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    if let Some(entry) = strongest(entries) {
        let body = Area {
            height: field.height - STRIP,
            ..*field
        };
        canvas.mark(&reading(entry), |canvas| {
            canvas.shade(&body, ink(entry.colour), depth(entry));
        });
        let middle = left + field.width / 2.0;
        let name = Font {
            colour: INK,
            ..Font::SMALL
        };
        let text = name.fit(&entry.cell.statistic.to_string(), field.width - 10.0);
        canvas.text([middle, top + 23.0], Anchor::Middle, name, &text);
        let strength = format!("z = {}", number(entry.z));
        let font = Font {
            bold: entry.colour == Colour::Gap,
            ..name
        };
        canvas.text([middle, top + 44.0], Anchor::Middle, font, &strength);
        draw_strip(canvas, field, entries, conditions);
    }
    canvas.polygon(&corners, "none", Stroke::solid("#9aa1ad", 1.0));
}

/// One part a condition; a condition without such cells leaves its part white.
fn draw_strip(canvas: &mut Canvas, field: &Area, entries: &[&Entry], conditions: &[&Condition]) {
    let width = field.width / conditions.len() as f64;
    for (place, condition) in conditions.iter().enumerate() {
        let own: Vec<&Entry> = entries
            .iter()
            .copied()
            .filter(|entry| entry.condition == **condition)
            .collect();
        let Some(entry) = strongest(&own) else {
            continue;
        };
        let part = Area {
            left: field.left + place as f64 * width,
            top: field.bottom() - STRIP,
            width,
            height: STRIP,
        };
        canvas.mark(&reading(entry), |canvas| {
            canvas.shade(&part, ink(entry.colour), depth(entry).max(0.35));
        });
        let edges = [[part.left, part.top], [part.left, part.bottom()]];
        canvas.polyline(&edges, Stroke::solid("#ffffff", 1.0));
    }
}

/// The strongest difference of a field or strip, and at which condition.
fn reading(entry: &Entry) -> String {
    let Cell { channel, statistic } = &entry.cell;
    format!(
        "{channel}, {statistic}: z = {} at {}",
        number(entry.z),
        entry.condition
    )
}

/// Opacity of a field [-].
fn depth(entry: &Entry) -> f64 {
    0.12 + 0.68 * (entry.z.abs() / FULL).min(1.0)
}

/// A strength with a sign, short.
fn number(z: f64) -> String {
    let text = match z.abs() {
        size if size.is_nan() => "–".to_owned(),
        size if size.is_infinite() => format!("{}∞", if z > 0.0 { "+" } else { "-" }),
        size if size < 9.95 => format!("{z:+.1}"),
        size if size < 999.5 => format!("{z:+.0}"),
        _ => format!("{z:+.0e}"),
    };
    text.replace('-', "−")
}

/// Conditions in their order, and what to keep in mind.
fn notes(map: &GapMap, conditions: &[&Condition]) -> Vec<String> {
    let order: Vec<String> = conditions
        .iter()
        .enumerate()
        .map(|(place, condition)| format!("{}) {condition}", place + 1))
        .collect();
    let mut notes = vec![format!(
        "Strips, from left to right: {}. z is the difference over its standard error; shades are \
         full from |z| = {FULL}.",
        order.join("  ")
    )];
    notes.extend(map.caveats.iter().map(|caveat| format!("Note: {caveat}.")));
    notes
}
