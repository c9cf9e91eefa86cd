//! Promises to a program that calls commands inside of itself.

use lugwheel::cli::{self, console::Console};
use std::ffi::OsString;
use std::io;
use std::sync::{Arc, Mutex};

/// Keeps what it receives.
#[derive(Default)]
struct Recorder {
    results: Mutex<Vec<String>>,
    shares: Mutex<Vec<f64>>,
}

impl Console for Recorder {
    fn result(&self, text: &str) -> io::Result<()> {
        self.results.lock().unwrap().push(text.to_owned());
        Ok(())
    }

    fn message(&self, _: &str) {}

    fn warning(&self, _: &str) {}

    fn progress(&self, _: &str, share: f64) {
        self.shares.lock().unwrap().push(share);
    }
}

fn words(line: &str) -> Vec<OsString> {
    line.split_whitespace().map(OsString::from).collect()
}

#[test]
fn a_called_command_returns_its_document_and_its_progress_to_the_caller() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run.h5");
    let line = "simulate scenarios/quick.toml --set duration=0.2 --json --out";
    let arguments = [words(line), vec![out.clone().into_os_string()]].concat();
    let recorder = Arc::new(Recorder::default());
    cli::call(arguments, recorder.clone()).unwrap();
    let results = recorder.results.lock().unwrap();
    let summary: serde_json::Value = serde_json::from_str(&results[0]).unwrap();
    assert_eq!((results.len(), &summary["duration_s"]), (1, &0.2.into()));
    let shares = recorder.shares.lock().unwrap();
    // A bar counts whole milliseconds.
    let is_whole = shares.last().is_some_and(|last| *last > 0.98);
    assert!(shares.is_sorted() && is_whole, "{shares:?}");
    assert!(out.exists());
}

#[test]
fn a_called_command_returns_its_fault_with_the_words_of_the_program() {
    let call = |line: &str| cli::call(words(line), Arc::new(Recorder::default())).unwrap_err();
    let usage = call("simulate");
    assert_eq!(usage.kind, "usage");
    let missing = call("inspect no_such_file.h5");
    assert_eq!(missing.kind, "invalid_input");
    assert_eq!(missing.file.as_deref(), Some("no_such_file.h5"));
    assert!(
        missing.message.starts_with("cannot read no_such_file.h5"),
        "{}",
        missing.message
    );
}
