//! Python, and the modules it has.

use std::path::Path;
use std::process::Command;

/// The first Python that has `modules`: the one in use, or the distribution's own, for which
/// `python3-h5py` is packaged.
pub fn with(modules: &[&str]) -> Option<&'static str> {
    let import = format!("import {}", modules.join(", "));
    ["python3", "/usr/bin/python3"].into_iter().find(|python| {
        let output = Command::new(python).args(["-c", &import]).output();
        output.is_ok_and(|output| output.status.success())
    })
}

/// As [`with`]; says that the test is skipped where there is none.
pub fn with_or_skip(modules: &[&str]) -> Option<&'static str> {
    let found = with(modules);
    if found.is_none() {
        let modules = modules.join(" ");
        eprintln!("SKIPPED: no Python has {modules}; run `pip install {modules}`");
    }
    found
}

/// A Python with h5py, which tests of run files cannot do without.
pub fn with_h5py() -> &'static str {
    with(&["h5py"]).expect(
        "Python with h5py is needed for this test: `apt-get install python3-h5py` or `pip install h5py`",
    )
}

/// Runs a script of `tests/` with these arguments; fails with what it says.
pub fn run(python: &str, script: &str, arguments: &[&str]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(script);
    let output = Command::new(python)
        .arg(path)
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{script} {arguments:?}: {said}");
}
