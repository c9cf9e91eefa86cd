//! What an import took for granted or did to the data, for the run's attributes.

use std::cell::RefCell;
use std::rc::Rc;

/// Notes on one run, shared by all readers of its files, without duplicates.
#[derive(Debug, Clone, Default)]
pub(super) struct Notes(Rc<RefCell<Vec<String>>>);

impl Notes {
    /// Adds a note about `file`, which is named by its last part.
    pub(super) fn add(&self, file: &str, note: &str) {
        self.of_run(format!("{}: {note}", last_part(file)));
    }

    /// Adds a note about the whole run.
    pub(super) fn of_run(&self, note: String) {
        let mut notes = self.0.borrow_mut();
        if !notes.contains(&note) {
            notes.push(note);
        }
    }

    /// All of them, in the order in which they were made.
    pub(super) fn all(&self) -> Vec<String> {
        self.0.borrow().clone()
    }
}

/// The last part of a path, by which notes name a file.
pub(super) fn last_part(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}
