//! Lines of text of bounded width.

use crate::report::page::wrapped;
use std::fmt;

/// Width of a line of text.
pub const LINE: usize = 96;

/// A count with its noun.
pub fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        count if what.ends_with("ch") => format!("{count} {what}es"),
        count => format!("{count} {what}s"),
    }
}

/// A list item: continuation lines are indented below its text.
pub fn write_item(f: &mut fmt::Formatter<'_>, lead: &str, text: &str) -> fmt::Result {
    let width = lead.chars().count();
    let lines = wrapped(text, LINE - width);
    let indented = lines.join(&format!("\n{:width$}", ""));
    writeln!(f, "{lead}{indented}")
}
