//! Promises about the source itself.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules in the order of the tour in `lib.rs`: each uses only those before it.
const ORDER: [&str; 25] = [
    "quantity",
    "document",
    "wheel",
    "whole_file",
    "soil",
    "terrain",
    "vibration",
    "simulation",
    "trace",
    "sensors",
    "dataset",
    "features",
    "recognition",
    "table",
    "identification",
    "gap",
    "effects",
    "scenario",
    "diagnosis",
    "learning",
    "study",
    "challenge",
    "report",
    "guide",
    "cli",
];

/// Files of the library and the program; the Python package is a crate of its own.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("src/python") {
            continue;
        }
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Code of a file, without what only its tests use.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    text.split("#[cfg(test)]\nmod tests")
        .next()
        .unwrap()
        .to_owned()
}

fn module_of(path: &Path) -> String {
    let first = path
        .strip_prefix(root())
        .unwrap()
        .components()
        .next()
        .unwrap();
    first
        .as_os_str()
        .to_str()
        .unwrap()
        .trim_end_matches(".rs")
        .to_owned()
}

#[test]
fn modules_use_only_the_modules_above_them() {
    let mut faults = Vec::new();
    for path in sources(&root()) {
        let module = module_of(&path);
        let Some(rank) = ORDER.iter().position(|name| *name == module) else {
            continue;
        };
        for (number, line) in code(&path).lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for below in &ORDER[rank + 1..] {
                if line.contains(&format!("crate::{below}")) {
                    faults.push(format!(
                        "{}:{}: {module} uses {below}",
                        path.display(),
                        number + 1
                    ));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_module_of_the_library_has_its_place_in_the_order() {
    let lib = fs::read_to_string(root().join("lib.rs")).unwrap();
    let modules: Vec<&str> = lib
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    assert_eq!(modules, ORDER);
}

#[test]
fn every_foreign_world_has_one_door() {
    let doors = [
        ("rapier2d::", "simulation"),
        ("hdf5::", "dataset"),
        ("hdf5_sys::", "dataset"),
        ("clap::", "cli"),
        ("indicatif::", "cli"),
        ("toml::", "document"),
        ("levenberg_marquardt::", "identification"),
        ("linfa", "recognition"),
        ("resvg::", "report"),
        ("svg2pdf::", "report"),
        ("mcap::", "report"),
    ];
    let mut faults = Vec::new();
    for path in sources(&root()) {
        let module = module_of(&path);
        for (world, door) in doors {
            let used = code(&path).lines().any(|line| {
                let line = line.trim_start();
                !line.starts_with("//") && line.replace("dataset::hdf5::", "").contains(world)
            });
            // These two also write what they read.
            let writes = world == "toml::" && ["scenario", "study"].contains(&module.as_str());
            if used && module != door && !writes {
                faults.push(format!("{} uses {world}", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
