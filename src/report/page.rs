//! One HTML page: a question and its answer, then sections of prose, tables, figures and code, at
//! last what was run and how to run it again.
//!
//! Every page of the program is built of the same parts:
//!
//! ```
//! use lugwheel::report::page::{Cell, Column, Page, Provenance, Section, Table};
//! use lugwheel::report::page;
//!
//! let html = page(&Page {
//!     title: "How deep does it sink?".to_owned(),
//!     answer: "By 12 mm.".to_owned(),
//!     sections: vec![
//!         Section::new("On every ground")
//!             .prose("Means of eight runs.")
//!             .table(Table {
//!                 caption: "Sinkage of the rim".to_owned(),
//!                 columns: vec![Column::new("ground", ""), Column::new("sinkage", "mm")],
//!                 rows: vec![vec![Cell::text("sand"), Cell::Estimate(12.1, [11.0, 13.2])]],
//!             }),
//!     ],
//!     provenance: Provenance {
//!         facts: vec![("seed".to_owned(), "1".to_owned())],
//!         commands: vec!["lugwheel dataset single_wheel_st --runs 8".to_owned()],
//!         ..Provenance::default()
//!     },
//!     ..Page::default()
//! });
//! assert!(html.contains("12.10 [11.00, 13.20]"));
//! ```
//!
//! A section shows its parts in the order in which they were added. All texts are plain, with blank
//! lines between paragraphs, and are escaped; drawings go into the page as they are.

mod text;

pub use crate::table::{Cell, Column, Table};
pub use text::{prose, section_text, wrapped};

use super::figure::escape;
use super::run_view::RunView;
use minijinja::{AutoEscape, Environment, Value, context};

/// A page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Title.
    pub title: String,
    /// The question; empty where the title is the question.
    pub question: String,
    /// The answer in a sentence or two; empty for none.
    pub answer: String,
    /// What else the reader needs before the sections.
    pub intro: String,
    /// Sections, in reading order.
    pub sections: Vec<Section>,
    /// What was run: the last section.
    pub provenance: Provenance,
}

/// A heading and what stands below it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    heading: String,
    blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
enum Block {
    Answer(String),
    Prose(String),
    Table(Table),
    Figure(Figure),
    Run(Box<RunView>),
    Code(Code),
    Facts(Vec<(String, String)>),
}

impl Section {
    /// A section with nothing below its heading yet.
    pub fn new(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a sentence that stands out: the answer to the heading.
    pub fn answer(self, sentence: impl Into<String>) -> Self {
        self.with(Block::Answer(sentence.into()))
    }

    /// Adds paragraphs.
    pub fn prose(self, text: impl Into<String>) -> Self {
        self.with(Block::Prose(text.into()))
    }

    /// Adds a table; one without rows is left out.
    pub fn table(self, table: Table) -> Self {
        if table.rows.is_empty() {
            return self;
        }
        self.with(Block::Table(table))
    }

    /// Adds a figure.
    pub fn figure(self, figure: Figure) -> Self {
        self.with(Block::Figure(figure))
    }

    /// Adds a run that is played and zoomed.
    pub fn run(self, run: RunView) -> Self {
        self.with(Block::Run(Box::new(run)))
    }

    /// Adds what is typed or read by a program.
    pub fn code(self, code: Code) -> Self {
        self.with(Block::Code(code))
    }

    /// Adds names and values.
    pub fn facts(self, facts: Vec<(String, String)>) -> Self {
        self.with(Block::Facts(facts))
    }

    fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// The drawing, as [`super::trace_figure`] and its neighbours return it: it goes into the
    /// page as it is, so it must not come from outside the program.
    pub svg: String,
    /// The drawing for the width of a telephone, with its panels one below the other; none where the drawing is only
    /// made smaller.
    pub narrow: Option<String>,
    /// What is seen.
    pub caption: String,
}

impl Figure {
    /// A drawing and what is seen.
    pub fn new(svg: String, caption: impl Into<String>) -> Self {
        Self {
            svg,
            narrow: None,
            caption: caption.into(),
        }
    }

    /// Adds the drawing for the width of a telephone.
    pub fn narrow(self, svg: String) -> Self {
        Self {
            narrow: Some(svg),
            ..self
        }
    }
}

/// Lines to type, or the text of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Code {
    /// What it is; empty for none.
    pub caption: String,
    /// The lines.
    pub text: String,
    /// Whether it shows its caption only, until it is opened or printed.
    pub is_folded: bool,
}

/// Provenance and reproduction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// Name and value: version, seed, scenario, machine.
    pub facts: Vec<(String, String)>,
    /// Commands that repeat the page, one a line.
    pub commands: Vec<String>,
    /// Files that the commands read: name and text.
    pub files: Vec<(String, String)>,
}

impl Provenance {
    fn section(&self) -> Option<Section> {
        if *self == Self::default() {
            return None;
        }
        let mut section = Section::new("Provenance and reproduction");
        if !self.facts.is_empty() {
            section = section.facts(self.facts.clone());
        }
        if !self.commands.is_empty() {
            section = section.code(Code {
                text: self.commands.join("\n"),
                ..Code::default()
            });
        }
        let files = self.files.iter().map(|(name, text)| Code {
            caption: name.clone(),
            text: text.clone(),
            is_folded: true,
        });
        Some(files.fold(section, Section::code))
    }
}

/// The page as one HTML document that needs nothing else: it loads no script, font or picture.
///
/// Its tables can be sorted; it reads on a telephone, in the dark, and prints on A4.
pub fn page(page: &Page) -> String {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment
        .render_named_str("page.html", include_str!("page/page.html"), values(page))
        .expect("the template is part of the program and uses only the values given here")
}

/// What a page with runs has beside the others' style and script.
const RUN_STYLE: &str = include_str!("page/run/run.css");
const RUN_SCRIPT: [&str; 5] = [
    "\"use strict\";\n",
    include_str!("page/run/series.js"),
    include_str!("page/run/traces.js"),
    include_str!("page/run/picture.js"),
    include_str!("page/run/player.js"),
];

fn values(page: &Page) -> Value {
    let has = |is_it: fn(&Block) -> bool| {
        let mut blocks = page.sections.iter().flat_map(|section| &section.blocks);
        blocks.any(is_it)
    };
    let has_runs = has(|it| matches!(it, Block::Run(_)));
    let has_figures = has(|it| matches!(it, Block::Figure(_)));
    let axes = if has_figures || has_runs {
        include_str!("page/ticks.js")
    } else {
        ""
    };
    let script = [include_str!("page/page.js"), axes].concat();
    let with_runs = |text: String| has_runs.then(|| Value::from_safe_string(text));
    let sections = page
        .sections
        .iter()
        .cloned()
        .chain(page.provenance.section());
    context! {
        run_style => with_runs(RUN_STYLE.to_owned()),
        run_script => with_runs(RUN_SCRIPT.concat()),
        style => Value::from_safe_string(include_str!("page/page.css").to_owned()),
        script => Value::from_safe_string(script),
        figure_script => has_figures.then(|| Value::from_safe_string(include_str!("page/figure.js").to_owned())),
        title => page.title.as_str(),
        question => page.question.as_str(),
        answer => page.answer.as_str(),
        intro => paragraphs(&page.intro),
        sections => sections.map(|section| section_values(&section)).collect::<Vec<_>>(),
    }
}

fn section_values(section: &Section) -> Value {
    context! {
        heading => section.heading.as_str(),
        blocks => section.blocks.iter().map(block_values).collect::<Vec<_>>(),
    }
}

fn block_values(block: &Block) -> Value {
    match block {
        Block::Answer(sentence) => context! { answer => sentence.as_str() },
        Block::Prose(text) => context! { prose => paragraphs(text) },
        Block::Table(table) => context! { table => table_values(table) },
        Block::Figure(Figure {
            svg,
            narrow,
            caption,
        }) => {
            let svg = Value::from_safe_string(svg.clone());
            let narrow = narrow.clone().map(Value::from_safe_string);
            context! { figure => context! { svg, narrow, caption => caption.as_str() } }
        }
        Block::Run(run) => context! { run => Value::from_safe_string(run.to_json()) },
        Block::Code(Code {
            caption,
            text,
            is_folded,
        }) => context! {
            code => context! { caption => caption.as_str(), text => text.trim_end(), is_folded }
        },
        Block::Facts(facts) => {
            let pairs = facts
                .iter()
                .map(|(name, value)| vec![name.clone(), value.clone()]);
            context! { facts => pairs.collect::<Vec<_>>() }
        }
    }
}

fn table_values(table: &Table) -> Value {
    let is_number: Vec<bool> = (0..table.columns.len())
        .map(|column| table.holds_numbers(column))
        .collect();
    let columns = table.columns.iter().zip(&is_number);
    let columns = columns.map(|(column, is_number)| {
        context! {
            name => breakable(&column.name),
            unit => column.unit.as_str(),
            is_number,
        }
    });
    let rows = table.rows.iter().map(|row| {
        let cells = row.iter().zip(&is_number);
        let cells = cells.map(|(cell, is_number)| cell_values(cell, *is_number));
        cells.collect::<Vec<_>>()
    });
    context! {
        caption => table.caption.as_str(),
        columns => columns.collect::<Vec<_>>(),
        rows => rows.collect::<Vec<_>>(),
    }
}

/// A name that may be broken within, as long keys have to be.
fn breakable(name: &str) -> Value {
    let parts = escape(name).replace('.', ".<wbr>").replace('_', "_<wbr>");
    Value::from_safe_string(parts)
}

/// Letters of a text that stays on one line.
const SHORT: usize = 28;

fn cell_values(cell: &Cell, is_number: bool) -> Value {
    let text = cell.written();
    let class = match cell {
        Cell::Code(_) => "code",
        _ if is_number => "number",
        _ if text.chars().count() <= SHORT => "short",
        _ => "text",
    };
    // A script reads `Infinity`, and numbers as they are written here.
    let key = cell.key().map(|key| match key {
        f64::INFINITY => "Infinity".to_owned(),
        f64::NEG_INFINITY => "-Infinity".to_owned(),
        key => key.to_string(),
    });
    context! { text, class, key }
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
        let evil = "</pre><script>alert('x')</script>";
        let code = |is_folded| Code {
            caption: evil.to_owned(),
            text: evil.to_owned(),
            is_folded,
        };
        Page {
            title: evil.to_owned(),
            question: evil.to_owned(),
            answer: evil.to_owned(),
            intro: format!("{evil}\n\nSecond."),
            sections: vec![
                Section::new(evil)
                    .answer(evil)
                    .prose(evil)
                    .table(Table {
                        caption: evil.to_owned(),
                        columns: vec![Column::new(evil, evil), Column::new(evil, "")],
                        rows: vec![vec![Cell::text(evil), Cell::Code(evil.to_owned())]],
                    })
                    .figure(Figure::new(
                        "<svg><title>drawn</title></svg>".to_owned(),
                        evil,
                    ))
                    .code(code(false))
                    .code(code(true))
                    .facts(vec![(evil.to_owned(), evil.to_owned())]),
            ],
            provenance: Provenance {
                facts: vec![(evil.to_owned(), evil.to_owned())],
                commands: vec![evil.to_owned()],
                files: vec![(evil.to_owned(), evil.to_owned())],
            },
        }
    }

    #[test]
    fn every_text_is_escaped_and_only_figures_are_not() {
        let html = page(&hostile());
        let scripts = html.matches("<script").count();
        assert_eq!(scripts, 2, "the page's own, and that of figures: {html}");
        let escaped = html.matches("&lt;script&gt;alert(").count();
        // title twice (tab and heading), question, answer, intro; heading, answer, prose; the
        // table's caption, two columns and a unit, two cells; the figure's caption; two codes of
        // two texts; a fact's name and value; the provenance's fact, command, file's name and text
        assert_eq!(escaped, 5 + 3 + 6 + 1 + 4 + 2 + 5, "{html}");
        assert!(html.contains("<svg><title>drawn</title></svg>"));
        assert!(html.contains("<p>Second.</p>"));
    }

    #[test]
    fn a_page_loads_nothing() {
        let html = page(&hostile());
        for loads in ["src=", "href=\"http", "@import", "url(", "fetch("] {
            assert!(!html.contains(loads), "{loads}");
        }
    }

    #[test]
    fn an_empty_page_is_a_page() {
        let html = page(&Page::default());
        assert!(html.starts_with("<!doctype html>") && html.trim_end().ends_with("</html>"));
        assert!(!html.contains("<table>") && !html.contains("<nav>") && !html.contains("<h2"));
    }

    #[test]
    fn parts_of_a_section_keep_their_order_and_a_table_without_rows_is_left_out() {
        let section = Section::new("Heading")
            .prose("first")
            .table(Table::default())
            .answer("second")
            .prose("third");
        let html = page(&Page {
            sections: vec![section],
            ..Page::default()
        });
        let places = ["first", "second", "third"].map(|text| html.find(text).unwrap());
        assert!(places.is_sorted());
        assert!(!html.contains("<table>"));
    }

    #[test]
    fn a_column_is_sorted_by_its_numbers_and_not_by_what_is_written() {
        let cells = [Cell::Number(1.5e6), Cell::Missing, Cell::Number(-2.0)];
        let html = page(&Page {
            sections: vec![Section::new("").table(Table {
                columns: vec![Column::new("a", "")],
                rows: cells.map(|cell| vec![cell]).to_vec(),
                ..Table::default()
            })],
            ..Page::default()
        });
        assert!(html.contains(r#"data-key="1500000">1.500e6<"#), "{html}");
        assert!(html.contains(r#"data-key="-2">−2.000<"#));
        assert!(html.contains(r#"<td class="number">–<"#));
    }
}
