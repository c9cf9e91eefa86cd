//! One HTML page: questions, their answers, tables and figures, and how to run it all again.

use minijinja::{AutoEscape, Environment, Value, context};

/// A page; every text is plain text, with blank lines between paragraphs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Title.
    pub title: String,
    /// What the page tells, in a few sentences.
    pub intro: String,
    /// Questions and answers, in reading order.
    pub sections: Vec<Section>,
    /// What was run.
    pub provenance: Provenance,
}

/// One question and its answer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// The question.
    pub heading: String,
    /// The answer in a sentence; empty for none.
    pub answer: String,
    /// What else there is to say.
    pub text: String,
    /// Numbers.
    pub tables: Vec<Table>,
    /// Drawings.
    pub figures: Vec<Figure>,
}

/// A table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What the numbers are.
    pub caption: String,
    /// One header for every column.
    pub columns: Vec<Column>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

/// The header of a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit; empty where the cells have none or each its own.
    pub unit: String,
}

impl Column {
    /// A column of this name and unit.
    pub fn new(name: &str, unit: &str) -> Self {
        Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
        }
    }
}

/// What stands in a table. Measured and computed numbers are written with four digits.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Text.
    Text(String),
    /// How many there are.
    Count(u64),
    /// A number.
    Number(f64),
    /// A number and the interval (low, high) that holds it with 95 %; infinite where unbounded.
    Estimate(f64, [f64; 2]),
}

impl Cell {
    /// A cell of text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    fn written(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(value) => four_digits(*value),
            Self::Estimate(value, [low, high]) => format!(
                "{} [{}, {}]",
                four_digits(*value),
                four_digits(*low),
                four_digits(*high)
            ),
        }
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// The drawing, as [`super::trace_figure`] and its neighbours return it: it goes into the
    /// page as it is, so it must not come from outside the program.
    pub svg: String,
    /// What is seen.
    pub caption: String,
}

/// What was run, and how to run it again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// Name and value: version, seed, scenario, machine.
    pub facts: Vec<(String, String)>,
    /// Commands that repeat the page, one a line.
    pub commands: Vec<String>,
}

/// A number with four significant digits; `unbounded` where infinite, `–` where there is none.
pub fn four_digits(value: f64) -> String {
    if value.is_nan() {
        return "–".to_owned();
    }
    if value.is_infinite() {
        return "unbounded".to_owned();
    }
    let text = if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        format!("{value:.3e}")
    } else {
        let digits = |value: f64| libm::floor(libm::log10(value)) as i32;
        let decimals = if value == 0.0 {
            0
        } else {
            3 - digits(value.abs())
        };
        format!("{value:.*}", decimals.max(0) as usize)
    };
    text.replace('-', "−")
}

/// The page as one HTML document that needs nothing else: it loads no script, font or picture.
///
/// It reads on a telephone and prints on A4.
pub fn page(page: &Page) -> String {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment
        .render_named_str("page.html", include_str!("page.html"), values(page))
        .expect("the template is part of the program and uses only the values given here")
}

fn values(page: &Page) -> Value {
    let facts = page.provenance.facts.iter();
    context! {
        title => page.title.as_str(),
        intro => paragraphs(&page.intro),
        sections => page.sections.iter().map(section_values).collect::<Vec<_>>(),
        facts => facts.map(|(name, value)| vec![name.clone(), value.clone()]).collect::<Vec<_>>(),
        commands => page.provenance.commands.join("\n"),
    }
}

fn section_values(section: &Section) -> Value {
    let figures = section.figures.iter().map(|figure| {
        let svg = Value::from_safe_string(figure.svg.clone());
        context! { svg, caption => figure.caption.as_str() }
    });
    context! {
        heading => section.heading.as_str(),
        answer => section.answer.as_str(),
        text => paragraphs(&section.text),
        tables => section.tables.iter().map(table_values).collect::<Vec<_>>(),
        figures => figures.collect::<Vec<_>>(),
    }
}

fn table_values(table: &Table) -> Value {
    let is_number = |cell: &Cell| !matches!(cell, Cell::Text(_));
    let columns = table.columns.iter().enumerate().map(|(i, column)| {
        let first = table.rows.first().and_then(|row| row.get(i));
        context! {
            name => column.name.as_str(),
            unit => column.unit.as_str(),
            is_number => first.is_some_and(is_number),
        }
    });
    let cell = |cell: &Cell| context! { text => cell.written(), is_number => is_number(cell) };
    let rows = table
        .rows
        .iter()
        .map(|row| row.iter().map(cell).collect::<Vec<_>>());
    context! {
        caption => table.caption.as_str(),
        columns => columns.collect::<Vec<_>>(),
        rows => rows.collect::<Vec<_>>(),
    }
}

fn paragraphs(text: &str) -> Vec<String> {
    text.split("\n\n")
        .map(str::trim)
        .filter(|paragraph| !paragraph.is_empty())
        .map(str::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hostile() -> Page {
        let evil = "<script>alert('x')</script>";
        Page {
            title: evil.to_owned(),
            intro: format!("{evil}\n\nSecond."),
            sections: vec![Section {
                heading: evil.to_owned(),
                answer: evil.to_owned(),
                text: evil.to_owned(),
                tables: vec![Table {
                    caption: evil.to_owned(),
                    columns: vec![Column::new(evil, evil)],
                    rows: vec![vec![Cell::text(evil)]],
                }],
                figures: vec![Figure {
                    svg: "<svg><title>drawn</title></svg>".to_owned(),
                    caption: evil.to_owned(),
                }],
            }],
            provenance: Provenance {
                facts: vec![(evil.to_owned(), evil.to_owned())],
                commands: vec![evil.to_owned()],
            },
        }
    }

    #[test]
    fn every_text_is_escaped_and_only_figures_are_not() {
        let html = page(&hostile());
        assert!(!html.contains("<script"), "{html}");
        let escaped = html.matches("&lt;script&gt;alert(").count();
        // title twice (tab and heading), intro, heading, answer, text, caption, column and unit,
        // cell, figure's caption, fact's name and value, command
        assert_eq!(escaped, 14, "{html}");
        assert!(html.contains("<svg><title>drawn</title></svg>"));
        assert!(html.contains("<p>Second.</p>"));
    }

    #[test]
    fn a_page_loads_nothing() {
        let html = page(&hostile());
        for loads in ["src=", "href=\"http", "@import", "url("] {
            assert!(!html.contains(loads), "{loads}");
        }
    }

    #[test]
    fn an_empty_page_is_a_page() {
        let html = page(&Page::default());
        assert!(html.starts_with("<!doctype html>") && html.trim_end().ends_with("</html>"));
        assert!(!html.contains("<table") && !html.contains("<nav"));
    }

    #[test]
    fn numbers_have_four_digits_and_say_when_they_are_unbounded() {
        let written = [0.0, 15.62, -0.01234567, 12345.6, 1.5e6, 1e-7, 999.96].map(four_digits);
        let expected = [
            "0",
            "15.62",
            "−0.01235",
            "12346",
            "1.500e6",
            "1.000e−7",
            "1000.0",
        ];
        assert_eq!(written, expected);
        let cell = Cell::Estimate(1.1, [0.9, f64::INFINITY]).written();
        assert_eq!(cell, "1.100 [0.9000, unbounded]");
        assert_eq!(Cell::Number(f64::NAN).written(), "–");
        assert_eq!(Cell::Count(20).written(), "20");
    }
}
