//! Ctrl-C: the first asks the running simulations to stop, the second stops the program.

use anyhow::Context;
use std::sync::atomic::{AtomicBool, Ordering};

/// Somebody asked the program to stop; says what is left behind.
#[derive(Debug, thiserror::Error)]
#[error("interrupted; {0}")]
pub struct Interrupted(pub String);

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen for Ctrl-C and for a request to terminate.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .context("cannot listen for Ctrl-C")
}

/// Whether somebody asked the program to stop.
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// # Errors
/// `Interrupted` when somebody asked the program to stop.
pub fn check() -> Result<(), Interrupted> {
    if is_requested() {
        return Err(Interrupted("nothing was written".to_owned()));
    }
    Ok(())
}
