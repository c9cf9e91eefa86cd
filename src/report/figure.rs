//! A drawing in SVG, and the axes of a panel in it.
//!
//! Written here rather than through `plotters`: that places everything on whole pixels, which
//! bends a 3 mm lug, and without a font library it cannot line up panels that share an axis.
//! The drawings carry neither style sheets nor identifiers, so that many can stand in one page.
//! In every text `F_{DP}` is a symbol with an index, and `10^{-3}` a power.

mod symbols;

use crate::table::four_digits;
use crate::trace::behind_number;
use std::fmt::Write;

/// A value as a reader of a panel with this header names it: `Drawbar pull F_{DP} [N]` and 12.3 are
/// `Drawbar pull F_DP 12.30 N`.
pub fn reading(header: &str, value: f64) -> String {
    let (name, unit) = header.split_once(" [").unwrap_or((header, "-]"));
    let unit = unit.split(']').next().unwrap_or_default();
    let name = name.replace("_{}", "").replace("_{", "_").replace('}', "");
    format!("{name} {}{}", four_digits(value), behind_number(unit))
}

/// Ink of text and frames.
pub const INK: &str = "#1f2430";
/// Ink of what matters less: ticks, remarks.
pub const MUTED: &str = "#5b6270";
/// What a reader has to know.
pub const REMARK: &str = "#a33d00";
/// The frame of a panel.
const FRAME: Stroke = Stroke::solid("#9aa1ad", 1.0);
/// Lines of the grid.
pub const GRID: &str = "#e3e6eb";
/// Colours distinct with any colour vision (Okabe and Ito, 2008).
pub const PALETTE: [&str; 6] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00",
];

/// A rectangle \[px\]; `y` runs down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Area {
    /// Right edge \[px\].
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge \[px\].
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// Which end of a text its position means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Font {
    /// Height \[px\].
    pub size: f64,
    /// Colour.
    pub colour: &'static str,
    /// Whether it is bold.
    pub bold: bool,
}

impl Font {
    /// Remarks and tick labels.
    pub const SMALL: Self = Self {
        size: 14.0,
        colour: MUTED,
        bold: false,
    };
    /// Headers of panels.
    pub const HEADER: Self = Self {
        size: 16.0,
        colour: INK,
        bold: true,
    };
    /// The title of a figure.
    pub const TITLE: Self = Self {
        size: 22.0,
        colour: INK,
        bold: true,
    };

    /// Width \[px\] that `text` takes at most in the usual sans-serif fonts.
    ///
    /// An estimate by kinds of letters, on the wide side: the reader's font is not known here.
    pub fn width(&self, text: &str) -> f64 {
        let letters = symbols::letters(text);
        let ems: f64 = letters.map(|(it, size)| size * letter_width(it)).sum();
        ems * self.size * if self.bold { 1.1 } else { 1.0 }
    }

    /// As much of `text` as fits in `width` \[px\], with an ellipsis where some does not.
    pub fn fit(&self, text: &str, width: f64) -> String {
        if self.width(text) <= width {
            return text.to_owned();
        }
        let mut kept = String::new();
        for letter in text.chars() {
            kept.push(letter);
            if self.width(&kept) + self.size > width {
                kept.pop();
                break;
            }
        }
        kept.push('…');
        kept
    }

    /// `text` broken between words into lines of at most `width` \[px\].
    pub fn wrap(&self, text: &str, width: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(line) + self.width(word) + self.size <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(self.fit(word, width)),
            }
        }
        lines
    }
}

/// Width of a letter in heights of its font.
fn letter_width(letter: char) -> f64 {
    match letter {
        ' ' | '.' | ',' | ':' | ';' | '|' | '!' | '\'' | 'i' | 'j' | 'l' | 'I' => 0.34,
        'f' | 'r' | 't' | '(' | ')' | '[' | ']' | '/' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '…' | '—' => 0.98,
        'A'..='Z' => 0.74,
        _ => 0.63,
    }
}

/// A line's colour, width \[px\] and dashes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: &'static str,
    /// Width \[px\].
    pub width: f64,
    /// Whether it is dashed.
    pub dashed: bool,
}

impl Stroke {
    /// A solid line.
    pub const fn solid(colour: &'static str, width: f64) -> Self {
        Self {
            colour,
            width,
            dashed: false,
        }
    }

    /// A dashed line.
    pub const fn dashed(colour: &'static str, width: f64) -> Self {
        Self {
            colour,
            width,
            dashed: true,
        }
    }

    fn attributes(&self) -> String {
        let dashes = if self.dashed {
            r#" stroke-dasharray="6 4""#
        } else {
            ""
        };
        format!(
            r#"stroke="{}" stroke-width="{}"{dashes}"#,
            self.colour,
            pixels(self.width)
        )
    }
}

/// How wide a drawing is, and whether it says what it shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// Width \[px\].
    pub width: f64,
    /// Width \[mm\] on paper; `None` on a screen.
    pub paper: Option<f64>,
    /// Whether title and remarks stand above, in place of a caption.
    pub is_titled: bool,
}

impl Layout {
    /// 1200 px wide, with a title.
    pub const SCREEN: Self = Self {
        width: 1200.0,
        paper: None,
        is_titled: true,
    };

    /// As wide as a telephone, with a title.
    pub const TELEPHONE: Self = Self {
        width: 420.0,
        paper: None,
        is_titled: true,
    };

    /// `width` \[mm\] wide on paper: [`Font::SMALL`] is 7 pt high there whatever the width.
    pub fn on_paper(width: f64, is_titled: bool) -> Self {
        const POINTS_PER_MILLIMETRE: f64 = 72.0 / 25.4;
        let pixels_per_point = Font::SMALL.size / 7.0;
        Self {
            width: width * POINTS_PER_MILLIMETRE * pixels_per_point,
            paper: Some(width),
            is_titled,
        }
    }

    /// Whether there is room for a column of a paper only: short names, low panels.
    pub fn is_compact(&self) -> bool {
        self.width < 760.0
    }
}

/// An SVG drawing under way. Points that are not finite are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    size: [f64; 2],
    /// Millimetres per pixel, on paper.
    paper_scale: Option<f64>,
    title: String,
    body: String,
    depth: usize,
}

impl Canvas {
    /// An empty white drawing of `size` (width, height) \[px\]; `title` is read out to who cannot see it.
    pub fn new(size: [f64; 2], title: &str) -> Self {
        let (title, body) = (title.to_owned(), String::new());
        Self {
            size,
            paper_scale: None,
            title,
            body,
            depth: 0,
        }
    }

    /// An empty drawing as wide as `layout` says.
    pub fn laid_out(layout: Layout, title: &str) -> Self {
        Self {
            paper_scale: layout.paper.map(|paper| paper / layout.width),
            ..Self::new([layout.width, 0.0], title)
        }
    }

    /// Changes the height \[px\], where it is only known when all is drawn.
    pub fn set_height(&mut self, height: f64) {
        self.size[1] = height;
    }

    /// The drawing as SVG.
    pub fn finish(mut self) -> String {
        while self.depth > 0 {
            self.unclip();
        }
        let [width, height] = self.size.map(pixels);
        let [across, down] = self.size.map(|length| match self.paper_scale {
            Some(scale) => format!("{}mm", pixels(scale * length)),
            None => pixels(length),
        });
        let (title, body) = (escape(&self.title), &self.body);
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{across}" height="{down}" viewBox="0 0 {width} {height}" role="img" font-family="'Helvetica Neue', Helvetica, Arial, 'Liberation Sans', sans-serif">
<title>{title}</title>
<rect width="{width}" height="{height}" fill="#ffffff"/>
{body}</svg>
"##
        )
    }

    /// Draws within `area` only, until [`Canvas::unclip`].
    pub fn clip(&mut self, area: &Area) {
        let [x, y, w, h] = [area.left, area.top, area.width, area.height].map(pixels);
        let _ = writeln!(
            self.body,
            r#"<svg x="{x}" y="{y}" width="{w}" height="{h}" viewBox="{x} {y} {w} {h}">"#
        );
        self.depth += 1;
    }

    /// Ends the latest [`Canvas::clip`].
    pub fn unclip(&mut self) {
        if self.depth > 0 {
            self.body.push_str("</svg>\n");
            self.depth -= 1;
        }
    }

    /// A line through `points`.
    pub fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        let path = path(points);
        if !path.is_empty() {
            let _ = writeln!(
                self.body,
                r#"<path d="{path}" fill="none" {} stroke-linejoin="round"/>"#,
                stroke.attributes()
            );
        }
    }

    /// A line of data in the latest frame of a panel, which a page reads off; `name` as in the legend, empty where
    /// the panel has one line.
    pub fn data_line(&mut self, points: &[[f64; 2]], stroke: Stroke, name: &str) {
        let path = path(points);
        if !path.is_empty() {
            let name = escape(name);
            let _ = writeln!(
                self.body,
                r#"<path d="{path}" fill="none" {} stroke-linejoin="round" data-line="{name}"/>"#,
                stroke.attributes()
            );
        }
    }

    /// A filled polygon of data, read off like a [`data_line`](Self::data_line).
    pub fn data_area(&mut self, points: &[[f64; 2]], fill: &str, stroke: Stroke, name: &str) {
        let path = path(points);
        if !path.is_empty() {
            let name = escape(name);
            let _ = writeln!(
                self.body,
                r#"<path d="{path}Z" fill="{fill}" {} stroke-linejoin="round" data-line="{name}"/>"#,
                stroke.attributes()
            );
        }
    }

    /// The frame of a panel with what a page reads values off by: its axes and what its header names.
    fn frame(&mut self, panel: &Panel, header: &str) {
        let corners = panel.corners();
        let [x, y] = [panel.x, panel.y].map(|axis| axis.data());
        let header = escape(header);
        let _ = writeln!(
            self.body,
            r#"<path d="{}Z" fill="none" {} stroke-linejoin="round" data-x="{x}" data-y="{y}" data-name="{header}"/>"#,
            path(&corners),
            FRAME.attributes()
        );
    }

    /// A filled polygon with an outline.
    pub fn polygon(&mut self, points: &[[f64; 2]], fill: &str, stroke: Stroke) {
        let path = path(points);
        if !path.is_empty() {
            let _ = writeln!(
                self.body,
                r#"<path d="{path}Z" fill="{fill}" {} stroke-linejoin="round"/>"#,
                stroke.attributes()
            );
        }
    }

    /// A filled circle with an outline.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, fill: &str, stroke: Stroke) {
        let [x, y, r] = [centre[0], centre[1], radius].map(pixels);
        let _ = writeln!(
            self.body,
            r#"<circle cx="{x}" cy="{y}" r="{r}" fill="{fill}" {}/>"#,
            stroke.attributes()
        );
    }

    /// The mark of a data point; `reading` shows when pointed at: its values with their units.
    pub fn mark(&mut self, reading: &str, draw: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<g><title>{}</title>", escape(reading));
        draw(self);
        self.body.push_str("</g>\n");
    }

    /// A point: a filled circle with a white outline.
    pub fn point(&mut self, at: [f64; 2], colour: &str) {
        self.circle(at, 4.5, colour, Stroke::solid("#ffffff", 0.8));
    }

    /// A filled rectangle; `title` shows when pointed at.
    pub fn rect(&mut self, area: &Area, fill: &str, title: &str) {
        let [x, y, w, h] = [area.left, area.top, area.width.max(0.0), area.height].map(pixels);
        let title = escape(title);
        let _ = writeln!(
            self.body,
            r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}"><title>{title}</title></rect>"#
        );
    }

    /// A filled rectangle that lets `opacity` [-] of its colour cover what lies below.
    pub fn shade(&mut self, area: &Area, fill: &str, opacity: f64) {
        let [x, y, w, h] = [area.left, area.top, area.width, area.height].map(pixels);
        let _ = writeln!(
            self.body,
            r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}" fill-opacity="{}"/>"#,
            pixels(opacity)
        );
    }

    /// A line of text with its base line at `at`.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, font: Font, text: &str) {
        self.text_with("", at, anchor, font, text);
    }

    /// The name of the axis below the panels drawn so far, which a page reads values off by.
    pub fn axis_name(&mut self, at: [f64; 2], name: &str) {
        self.text_with(" data-axis=\"\"", at, Anchor::Middle, Font::SMALL, name);
    }

    fn text_with(
        &mut self,
        attributes: &str,
        at: [f64; 2],
        anchor: Anchor,
        font: Font,
        text: &str,
    ) {
        let [x, y] = at.map(pixels);
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if font.bold {
            r#" font-weight="600""#
        } else {
            ""
        };
        let _ = writeln!(
            self.body,
            r#"<text x="{x}" y="{y}" text-anchor="{anchor}" font-size="{}" fill="{}"{weight}{attributes}>{}</text>"#,
            pixels(font.size),
            font.colour,
            symbols::typeset(text, font.size)
        );
    }
}

/// A length [px] with at most two decimals; 0 where it is not finite.
fn pixels(value: f64) -> String {
    if !value.is_finite() {
        return "0".to_owned();
    }
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

fn path(points: &[[f64; 2]]) -> String {
    let finite: Vec<_> = points
        .iter()
        .filter(|[x, y]| x.is_finite() && y.is_finite())
        .collect();
    if finite.len() < 2 {
        return String::new();
    }
    let mut path = String::new();
    for (i, &&[x, y]) in finite.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", pixels(x), pixels(y));
    }
    path
}

/// `text` as XML character data: markup escaped, characters that XML forbids replaced.
pub fn escape(text: &str) -> String {
    text.chars()
        .map(|letter| match letter {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            '\'' => "&#39;".to_owned(),
            '\t' | '\n' | '\r' => " ".to_owned(),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => '\u{fffd}'.to_string(),
            other => other.to_string(),
        })
        .collect()
}

/// How values lie along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences.
    Linear,
    /// Equal steps for equal ratios.
    Logarithmic,
}

/// One axis of a panel: values [any unit] to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Value at `from`.
    pub low: f64,
    /// Value at `to`.
    pub high: f64,
    /// Pixel of `low`.
    pub from: f64,
    /// Pixel of `high`.
    pub to: f64,
    /// How values lie between.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis over exactly `[low, high]`, widened where they are equal.
    pub fn exact([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        let [low, high] = if high > low {
            [low, high]
        } else {
            let room = low.abs().max(1e-3) * 0.1;
            [low - room, low + room]
        };
        Self {
            low,
            high,
            from,
            to,
            scale: Scale::Linear,
        }
    }

    /// A linear axis with 8 % of room beyond the bounds, and 0.5 % of their size at least: what
    /// varies by less than that is drawn as the constant it is.
    pub fn roomy([low, high]: [f64; 2], pixels: [f64; 2]) -> Self {
        let room = (0.08 * (high - low)).max(0.005 * low.abs().max(high.abs()));
        Self::exact([low - room, high + room], pixels)
    }

    /// A logarithmic axis over whole decades around `[low, high]`, both above 0.
    pub fn decades([low, high]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        let first = libm::floor(libm::log10(low) + 1e-9);
        let last = libm::ceil(libm::log10(high) - 1e-9).max(first + 1.0);
        Self {
            low: libm::pow(10.0, first),
            high: libm::pow(10.0, last),
            from,
            to,
            scale: Scale::Logarithmic,
        }
    }

    /// Pixel of `value`; a value at or below 0 lies at the low end of a logarithmic axis.
    pub fn pixel(&self, value: f64) -> f64 {
        let part = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => {
                libm::log10(value.max(self.low) / self.low) / libm::log10(self.high / self.low)
            }
        };
        self.from + part * (self.to - self.from)
    }

    /// Bounds and pixels, for a page that reads values off.
    fn data(&self) -> String {
        let Self {
            low,
            high,
            from,
            to,
            scale,
        } = self;
        let scale = match scale {
            Scale::Linear => "",
            Scale::Logarithmic => " log",
        };
        format!("{low} {high} {} {}{scale}", pixels(*from), pixels(*to))
    }

    /// Values at round numbers and what to write there, at least `spacing` \[px\] apart.
    pub fn ticks(&self, spacing: f64) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => self.linear_ticks(spacing),
            Scale::Logarithmic => self.decade_ticks(spacing),
        }
    }

    fn linear_ticks(&self, spacing: f64) -> Vec<(f64, String)> {
        let most = ((self.to - self.from).abs() / spacing).max(1.0);
        let step = round_step((self.high - self.low) / most);
        let first = (self.low / step - 1e-9).ceil();
        let count = ((self.high / step + 1e-9).floor() - first).max(0.0) as usize;
        (0..=count)
            .map(|i| {
                let value = (first + i as f64) * step;
                (value, label(value, step))
            })
            .collect()
    }

    fn decade_ticks(&self, spacing: f64) -> Vec<(f64, String)> {
        let first = libm::log10(self.low).round() as i32;
        let last = libm::log10(self.high).round() as i32;
        let pitch = (self.to - self.from).abs() / f64::from(last - first);
        let every = (spacing / pitch).ceil().max(1.0) as usize;
        let plain = first >= -2 && last <= 3;
        let written = |decade: i32, value: f64| {
            if plain {
                format!("{value}")
            } else {
                minus(format!("10^{{{decade}}}"))
            }
        };
        (first..=last)
            .step_by(every)
            .map(|decade| (decade, libm::pow(10.0, f64::from(decade))))
            .map(|(decade, value)| (value, written(decade, value)))
            .collect()
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(step)));
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|times| times * decade)
        .find(|round| *round >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// A tick's value with the decimals its step needs.
fn label(value: f64, step: f64) -> String {
    if !(1e-4..1e5).contains(&step) {
        return minus(format!("{value:.1e}"));
    }
    let decimals = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
    let value = if value.abs() < step * 1e-6 {
        0.0
    } else {
        value
    };
    minus(format!("{value:.decimals$}"))
}

/// A hyphen is shorter than the minus it stands for.
fn minus(text: String) -> String {
    text.replace('-', "−")
}

/// A panel: a frame, two axes, a header above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    /// The frame \[px\].
    pub area: Area,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
}

impl Panel {
    /// Height \[px\] above the frame that the header takes.
    pub const HEADER: f64 = 28.0;
    /// Height \[px\] below the frame that tick labels and the axis' name take.
    pub const FOOTER: f64 = 44.0;

    /// Position \[px\] of a point in the axes' units.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.pixel(x), self.y.pixel(y)]
    }

    /// Least distance [px] of ticks across: narrow panels have theirs closer.
    fn tick_spacing(&self) -> f64 {
        (self.area.width / 6.0).clamp(54.0, 90.0)
    }

    /// Grid, frame, ticks of the upright axis; `header` names the quantity and its unit.
    pub fn draw_frame(&self, canvas: &mut Canvas, header: &str) {
        let area = &self.area;
        for (value, _) in self.x.ticks(self.tick_spacing()) {
            let x = self.x.pixel(value);
            canvas.polyline(
                &[[x, area.top], [x, area.bottom()]],
                Stroke::solid(GRID, 1.0),
            );
        }
        self.draw_level_frame(canvas, header);
    }

    /// As [`draw_frame`](Self::draw_frame) without a grid of its own along the lower axis.
    pub fn draw_level_frame(&self, canvas: &mut Canvas, header: &str) {
        self.draw_levels(canvas, header);
        canvas.frame(self, header);
    }

    /// As [`draw_frame`](Self::draw_frame) where the lower axis holds categories, not numbers.
    pub fn draw_category_frame(&self, canvas: &mut Canvas, header: &str) {
        self.draw_levels(canvas, header);
        canvas.polygon(&self.corners(), "none", FRAME);
    }

    fn corners(&self) -> [[f64; 2]; 4] {
        let area = &self.area;
        let [left, right, top, bottom] = [area.left, area.right(), area.top, area.bottom()];
        [[left, top], [right, top], [right, bottom], [left, bottom]]
    }

    /// Header, and grid and ticks of the upright axis.
    fn draw_levels(&self, canvas: &mut Canvas, header: &str) {
        let area = &self.area;
        let spacing = if area.height < 90.0 { 22.0 } else { 30.0 };
        let mut ticks = self.y.ticks(spacing);
        if ticks.len() < 2 {
            // One tick is no scale.
            ticks = self.y.ticks(0.6 * spacing);
        }
        for (value, text) in ticks {
            let y = self.y.pixel(value);
            canvas.polyline(
                &[[area.left, y], [area.right(), y]],
                Stroke::solid(GRID, 1.0),
            );
            canvas.text([area.left - 8.0, y + 5.0], Anchor::End, Font::SMALL, &text);
        }
        let header_at = [area.left, area.top - 9.0];
        canvas.text(header_at, Anchor::Start, Font::HEADER, header);
    }

    /// Upright lines at every tenth of a lower axis from 0 to 1.
    pub fn draw_tenths(&self, canvas: &mut Canvas) {
        for tenth in 0..=10 {
            let x = self.x.pixel(0.1 * f64::from(tenth));
            let ends = [[x, self.area.top], [x, self.area.bottom()]];
            canvas.polyline(&ends, Stroke::solid(GRID, 1.0));
        }
    }

    /// Tick labels and name of the lower axis.
    pub fn draw_footer(&self, canvas: &mut Canvas, name: &str) {
        let area = &self.area;
        for (value, text) in self.x.ticks(self.tick_spacing()) {
            let x = self.x.pixel(value);
            let below = [[x, area.bottom()], [x, area.bottom() + 5.0]];
            canvas.polyline(&below, Stroke::solid(MUTED, 1.0));
            canvas.text(
                [x, area.bottom() + 20.0],
                Anchor::Middle,
                Font::SMALL,
                &text,
            );
        }
        let middle = [area.left + area.width / 2.0, area.bottom() + 39.0];
        canvas.axis_name(middle, name);
    }

    /// A remark in the upper right corner on that of some `values` which is farthest beyond the scale, if one is.
    pub fn draw_beyond(&self, canvas: &mut Canvas, values: &[f64], unit: &str) {
        let distance = |value: &f64| (self.y.low - value).max(value - self.y.high);
        let farthest = values
            .iter()
            .max_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(farthest) = farthest.filter(|value| distance(value) > 0.0) else {
            return;
        };
        let side = if *farthest > self.y.high {
            "above"
        } else {
            "below"
        };
        let value = four_digits(*farthest);
        let text = format!("{side} this scale: up to {value}{}", behind_number(unit));
        let font = Font {
            colour: REMARK,
            ..Font::SMALL
        };
        let at = [self.area.right() - 6.0, self.area.top + 16.0];
        canvas.text(at, Anchor::End, font, &text);
    }

    /// Names of the lines at the right of the header, as far as it leaves room.
    pub fn draw_legend(&self, canvas: &mut Canvas, header: &str, entries: &[(String, Stroke)]) {
        const SWATCH: f64 = 28.0;
        const GAP: f64 = 12.0;
        let room = self.area.left + Font::HEADER.width(header) + GAP;
        let y = self.area.top - 9.0;
        let mut right = self.area.right();
        for (name, stroke) in entries.iter().rev() {
            let left = right - Font::SMALL.width(name) - SWATCH;
            if left < room {
                return;
            }
            let swatch = [[left, y - 5.0], [left + SWATCH - 7.0, y - 5.0]];
            canvas.polyline(&swatch, *stroke);
            canvas.text([left + SWATCH, y], Anchor::Start, Font::SMALL, name);
            right = left - GAP;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_within_the_axis_and_apart() {
        for (low, high) in [(0.0, 15.0), (-3.2e-3, 8.9e-3), (99.7, 100.4), (-4e6, 7e6)] {
            let axis = Axis::roomy([low, high], [0.0, 1000.0]);
            let ticks = axis.ticks(90.0);
            assert!((4..=12).contains(&ticks.len()), "{ticks:?}");
            for pair in ticks.windows(2) {
                assert!(axis.pixel(pair[1].0) - axis.pixel(pair[0].0) >= 90.0 - 1e-6);
                assert_ne!(pair[0].1, pair[1].1);
            }
            assert!(ticks.iter().all(|(v, _)| *v >= axis.low && *v <= axis.high));
        }
    }

    #[test]
    fn decades_are_labelled_and_thinned() {
        let axis = Axis::decades([2e-6, 30.0], [180.0, 0.0]);
        assert_eq!(axis.pixel(1e-6), 180.0);
        assert!((axis.pixel(100.0)).abs() < 1e-9);
        let labels: Vec<_> = axis.ticks(40.0).into_iter().map(|t| t.1).collect();
        assert_eq!(
            labels,
            ["10^{−6}", "10^{−4}", "10^{−2}", "10^{0}", "10^{2}"]
        );
        let short = Axis::decades([0.02, 7.0], [180.0, 0.0]);
        let labels: Vec<_> = short.ticks(40.0).into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10"]);
    }

    #[test]
    fn a_constant_gets_an_axis_with_the_constant_inside() {
        for value in [0.0, 100.0, -2.5] {
            let axis = Axis::roomy([value, value], [100.0, 0.0]);
            assert!((axis.pixel(value) - 50.0).abs() < 1e-9);
        }
    }

    #[test]
    fn text_that_does_not_fit_is_shortened_or_broken() {
        let long = "sinkage ".repeat(40);
        assert!(Font::SMALL.width(&Font::SMALL.fit(&long, 200.0)) <= 200.0);
        let lines = Font::SMALL.wrap(&long, 200.0);
        assert!(lines.len() > 5 && lines.iter().all(|line| Font::SMALL.width(line) <= 200.0));
        assert_eq!(Font::SMALL.fit("slip", 200.0), "slip");
    }

    #[test]
    fn markup_and_forbidden_characters_do_not_reach_the_drawing() {
        assert_eq!(
            escape("<a href='x'>&\u{1}"),
            "&lt;a href=&#39;x&#39;&gt;&amp;\u{fffd}"
        );
    }
}
