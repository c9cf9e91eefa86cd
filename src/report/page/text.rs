//! Sections of a page as text: headings, paragraphs, tables and code, without figures.

use super::{Block, Code, Section, paragraphs};

/// Letters of a line of prose.
const WIDTH: usize = 112;

/// The sections one below the other; those of figures alone are left out.
pub fn section_text(sections: &[Section]) -> String {
    let written = sections.iter().filter(|section| !section.is_of_figures());
    let texts: Vec<String> = written.map(Section::to_text).collect();
    texts.join("\n")
}

impl Section {
    /// Whether without its figures nothing is left but words on them.
    fn is_of_figures(&self) -> bool {
        let has = |is_it: fn(&Block) -> bool| self.blocks.iter().any(is_it);
        has(|it| matches!(it, Block::Figure(_) | Block::Run(_)))
            && !has(|it| matches!(it, Block::Table(_) | Block::Code(_) | Block::Facts(_)))
    }

    fn to_text(&self) -> String {
        let mut text = format!("{}\n{}\n", self.heading, "-".repeat(letters(&self.heading)));
        let blocks: Vec<String> = self.blocks.iter().filter_map(Block::to_text).collect();
        text.push_str(&blocks.join("\n"));
        text
    }
}

impl Block {
    fn to_text(&self) -> Option<String> {
        Some(match self {
            Self::Answer(text) | Self::Prose(text) => prose(text),
            Self::Table(table) => {
                let caption = match table.caption.as_str() {
                    "" => String::new(),
                    caption => prose(&format!("{caption}:")),
                };
                caption + &table.to_text(2)
            }
            Self::Code(Code { caption, text, .. }) => {
                let lines = text.lines().map(|line| format!("  {line}\n"));
                prose(caption) + &lines.collect::<String>()
            }
            Self::Facts(facts) => {
                let lines = facts
                    .iter()
                    .map(|(name, value)| format!("{name}: {value}\n"));
                lines.collect()
            }
            Self::Figure(_) | Self::Run(_) => return None,
        })
    }
}

/// Paragraphs with lines broken between words.
pub fn prose(text: &str) -> String {
    let paragraph = |text: &String| wrapped(text, WIDTH).join("\n") + "\n";
    let paragraphs: Vec<String> = paragraphs(text).iter().map(paragraph).collect();
    paragraphs.join("\n")
}

/// `text` broken between words into lines of at most `width` letters; longer words are not broken.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if letters(line) + letters(word) < width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::page::{Cell, Figure, Table};

    #[test]
    fn a_section_is_its_heading_prose_and_tables_and_one_of_figures_alone_is_left_out() {
        let table = Table::of(["a", "b"], [vec![Cell::text("x"), Cell::Count(2)]]);
        let figure = || Figure::new("<svg/>".to_owned(), "drawn");
        let sections = [
            Section::new("One")
                .prose(format!("{}end.\n\nNext.", "word ".repeat(30)))
                .figure(figure())
                .table(table.captioned("Counts")),
            Section::new("Drawn").prose("To be seen.").figure(figure()),
        ];
        let text = section_text(&sections);
        let expected = format!(
            "One\n---\n{}\nword word word word word word word word end.\n\nNext.\n\nCounts:\n  a  b\n  x  2\n",
            ["word"; 22].join(" ")
        );
        assert_eq!(text, expected);
    }
}
