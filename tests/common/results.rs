//! What the tests of studies share: how a study is executed, what it leaves in its folder.

use lugwheel::study::{Options, Outcome, Study};
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The whole study on two threads, into a folder.
pub fn into(out: &Path) -> Options {
    Options {
        out: out.to_owned(),
        jobs: NonZeroUsize::new(2),
        resume: false,
        shard: None,
    }
}

/// The same, from where it was stopped.
pub fn resumed(out: &Path) -> Options {
    Options {
        resume: true,
        ..into(out)
    }
}

/// What an execution that nobody stops comes to.
pub fn done(study: &Study, options: &Options) -> Outcome {
    let outcome = study.execute(options, &|_| ControlFlow::Continue(()));
    outcome.unwrap_or_else(|error| panic!("{error}"))
}

/// Every file below a folder of results with its bytes, without what may differ between
/// executions: computing times, and what the jobs of a cluster said.
pub fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let differs = name == "timing.csv" || name.ends_with(".times.csv") || name == "slurm";
            if differs {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else {
                let relative = path.strip_prefix(folder).unwrap().to_owned();
                found.push((relative, without_commands(&name, fs::read(path).unwrap())));
            }
        }
    }
    found.sort();
    found
}

/// Copies a folder with all below it.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

/// The report says how to run the study again, into its own folder.
fn without_commands(name: &str, bytes: Vec<u8>) -> Vec<u8> {
    if name != "report.html" {
        return bytes;
    }
    let text = String::from_utf8(bytes).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let told = lines.iter().filter(|line| !line.contains("lugwheel study"));
    assert!(
        told.clone().count() + 4 > lines.len(),
        "the report is more than its commands"
    );
    told.copied().collect::<Vec<&str>>().join("\n").into_bytes()
}
