//! Cells without a number in numeric columns.

use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;

/// The cells of a column without a number; they count as not measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gap {
    /// The CSV file.
    pub file: String,
    /// The column's name in its header.
    pub column: String,
    /// Line of the first such cell, from 1.
    pub line: u64,
    /// Text of the first such cell.
    pub cell: String,
    /// How many there are.
    pub cells: usize,
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            column,
            line,
            cell,
            cells,
        } = self;
        write!(f, "{file}:{line}: column {column:?} holds ")?;
        match cell.as_str() {
            "" => f.write_str("nothing")?,
            cell => write!(f, "{cell:?}")?,
        }
        f.write_str(", which counts as not measured")?;
        match cells {
            1 => Ok(()),
            cells => write!(f, "; it has {cells} such cells"),
        }
    }
}

/// The gaps met so far, shared by all that read a campaign's files.
#[derive(Debug, Clone, Default)]
pub(super) struct Gaps(Rc<RefCell<Vec<Gap>>>);

impl Gaps {
    /// Notes a `cell` of a column of a file.
    pub(super) fn note(&self, file: &str, column: &str, line: u64, cell: &str) {
        let mut gaps = self.0.borrow_mut();
        let known = gaps
            .iter_mut()
            .find(|gap| gap.file == file && gap.column == column);
        match known {
            Some(gap) => gap.cells += 1,
            None => gaps.push(Gap {
                file: file.to_owned(),
                column: column.to_owned(),
                line,
                cell: cell.to_owned(),
                cells: 1,
            }),
        }
    }

    /// All of them, a column each, in the order in which they were met.
    pub(super) fn all(&self) -> Vec<Gap> {
        self.0.borrow().clone()
    }
}
