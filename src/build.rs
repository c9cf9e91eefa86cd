//! Sets the commit of the source, where it is under git.
//!
//! Only released builds know: others would be compiled anew with every commit.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=src");
    if std::env::var("PROFILE").as_deref() != Ok("release") {
        return;
    }
    // Every commit and every change of branch is noted here.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) else {
        return;
    };
    let changes = git(&["status", "--porcelain", "--untracked-files=no"]);
    let changed = match changes.as_deref() {
        Some("") => "",
        _ => ", and changes since",
    };
    println!("cargo::rustc-env=LUGWHEEL_COMMIT={commit}{changed}");
}

/// Output of git, where there is one and a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
