//! Ctrl-C: the first requests the running simulations to stop, the second stops the program.

use anyhow::Context;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// The program was interrupted; with the files that remain.
#[derive(Debug, thiserror::Error)]
#[error("interrupted; {0}")]
pub struct Interrupted(pub String);

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Commands that another program has called and that have not returned.
static CALLS: Mutex<usize> = Mutex::new(0);

/// A command that another program has called; a request to stop ends with the last of them.
#[derive(Debug)]
pub struct Call(());

impl Call {
    /// A command begins.
    pub fn begin() -> Self {
        *count() += 1;
        Self(())
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        let mut calls = count();
        *calls -= 1;
        if *calls == 0 {
            REQUESTED.store(false, Ordering::Relaxed);
        }
    }
}

fn count() -> std::sync::MutexGuard<'static, usize> {
    // A number is whole whatever happened to its last holder.
    CALLS
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Asks every command that another program has called to stop, as Ctrl-C does in a terminal.
pub fn request() {
    if *count() > 0 {
        REQUESTED.store(true, Ordering::Relaxed);
    }
}

/// Begins to listen for Ctrl-C and for a request to terminate.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .context("cannot listen for Ctrl-C")
}

/// Whether a stop is requested.
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// # Errors
/// `Interrupted` when a stop is requested.
pub fn check() -> Result<(), Interrupted> {
    if is_requested() {
        return Err(Interrupted("nothing was written".to_owned()));
    }
    Ok(())
}
