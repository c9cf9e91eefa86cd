//! Where a command's result, warnings and progress go: to a terminal, or to the program that called it.

use std::fmt;
use std::io;
use std::sync::Arc;

/// A program that calls a command and receives what a terminal would show.
///
/// Methods are called from any thread of the command.
pub trait Console: Send + Sync {
    /// Receives the result: one text, or with `--json` one document.
    ///
    /// # Errors
    /// Those of writing it.
    fn result(&self, text: &str) -> io::Result<()>;

    /// Receives a message that is no result and no warning.
    fn message(&self, text: &str);

    /// Receives a warning.
    fn warning(&self, text: &str);

    /// Receives the `share` \[0 to 1\] of the stage `name` that is done.
    fn progress(&self, name: &str, share: f64);
}

/// The console of a command; a terminal where there is no other.
#[derive(Clone, Default)]
pub struct Attached(Option<Arc<dyn Console>>);

impl Attached {
    /// A console that a calling program brings.
    pub fn to(console: Arc<dyn Console>) -> Self {
        Self(Some(console))
    }

    /// The calling program's console; none where it is a terminal.
    pub fn caller(&self) -> Option<&dyn Console> {
        self.0.as_deref()
    }
}

impl fmt::Debug for Attached {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.0.is_some() {
            "caller"
        } else {
            "terminal"
        };
        f.write_str(kind)
    }
}
