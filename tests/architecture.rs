//! Promises about the source itself.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Modules in the order of the tour in `lib.rs`: each uses only those before it.
const ORDER: [&str; 27] = [
    "quantity",
    "statistics",
    "document",
    "wheel",
    "whole_file",
    "soil",
    "terrain",
    "vibration",
    "simulation",
    "trace",
    "signal",
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
        ("RealFftPlanner", "signal"),
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

/// A module by the segments of its path.
type Module = Vec<String>;

/// What the code of a module names.
#[derive(Default)]
struct Names {
    /// Paths of its private imports and of its expressions, as written.
    used: Vec<Module>,
    /// Paths of its public imports, by the name that they give.
    exported: BTreeMap<String, Module>,
}

/// The module of a file: `soil/wheel_load/lugs.rs` is `soil::wheel_load::lugs`.
fn module_path(path: &Path) -> Module {
    let inside = path.strip_prefix(root()).unwrap().with_extension("");
    let segments = inside.components();
    segments
        .map(|it| it.as_os_str().to_str().unwrap().to_owned())
        .collect()
}

/// The paths of the tree of a `use`.
fn expand(prefix: &[String], tree: &str, paths: &mut Vec<Module>) {
    let mut depth = 0;
    let parts = tree.split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    for part in parts.map(str::trim).filter(|part| !part.is_empty()) {
        let (path, inner) = part.split_once('{').unwrap_or((part, ""));
        let segments = path.split("::").map(str::trim).filter(|it| !it.is_empty());
        let segments = segments.map(|it| it.split(" as ").next().unwrap().to_owned());
        let path: Module = prefix.iter().cloned().chain(segments).collect();
        match inner.rsplit_once('}') {
            Some((inner, _)) => expand(&path, inner, paths),
            None => paths.push(path),
        }
    }
}

/// What the code of a file names.
fn names(path: &Path) -> Names {
    let code = code(path);
    let lines = code.lines().filter(|it| !it.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n");
    let mut names = Names::default();
    let mut rest = String::new();
    for statement in code.split_inclusive(';') {
        let last = statement.rsplit('\n').find(|line| line.contains("use "));
        let start = last.and_then(|line| statement.find(line));
        let import = start.map(|start| statement[start..].trim_end_matches(';').trim());
        let Some((visibility, tree)) = import.and_then(|it| it.split_once("use ")) else {
            rest.push_str(statement);
            continue;
        };
        let mut paths = Vec::new();
        expand(&[], tree, &mut paths);
        match visibility.trim() {
            "" => names.used.extend(paths),
            _ => names.exported.extend(
                paths
                    .into_iter()
                    .filter_map(|it| Some((it.last()?.clone(), it))),
            ),
        }
    }
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let paths = rest.split(|c| !is_part(c)).filter(|it| it.contains("::"));
    names.used.extend(paths.map(|it| {
        let segments = it.split("::").filter(|segment| !segment.is_empty());
        segments.map(str::to_owned).collect()
    }));
    names
}

/// The module in which a path of `from` ends, through public imports; none outside the crate.
fn resolve(all: &BTreeMap<Module, Names>, from: &Module, path: &[String]) -> Option<Module> {
    let ups = path.iter().take_while(|it| *it == "super").count();
    let child = || all.contains_key(&[&from[..], &path[..1]].concat());
    let absolute = match path.first()?.as_str() {
        "crate" => path[1..].to_vec(),
        "super" => [&from[..from.len().checked_sub(ups)?], &path[ups..]].concat(),
        _ if child() => [&from[..], path].concat(),
        _ => return None,
    };
    let module = (1..=absolute.len()).rev().map(|end| &absolute[..end]);
    let module = module
        .map(<[String]>::to_vec)
        .find(|it| all.contains_key(it))?;
    let next = absolute.get(module.len());
    let exported = next.and_then(|name| all[&module].exported.get(name));
    let through = exported.and_then(|path| resolve(all, &module, path));
    Some(through.unwrap_or(module))
}

/// Pairs that still form a circle.
const CIRCLES: [&str; 2] = ["dataset::hdf5", "simulation::stone_bed"];

#[test]
fn files_of_a_module_that_do_not_contain_each_other_form_no_circle() {
    let files = sources(&root());
    let all: BTreeMap<Module, Names> = files
        .iter()
        .map(|path| (module_path(path), names(path)))
        .collect();
    let uses = |module: &Module| -> BTreeSet<Module> {
        let used = all[module].used.iter();
        let used = used.filter_map(|path| resolve(&all, module, path));
        used.filter(|other| {
            let apart = !other.starts_with(module) && !module.starts_with(other);
            apart && other[0] == module[0]
        })
        .collect()
    };
    let graph: BTreeMap<&Module, BTreeSet<Module>> = all.keys().map(|it| (it, uses(it))).collect();
    let mut faults = Vec::new();
    for module in all.keys() {
        let mut reached = BTreeSet::new();
        let mut open: Vec<&Module> = graph[module].iter().collect();
        while let Some(next) = open.pop() {
            if reached.insert(next) {
                open.extend(&graph[next]);
            }
        }
        let name = module.join("::");
        if reached.contains(module) && !CIRCLES.iter().any(|known| name.starts_with(known)) {
            faults.push(name);
        }
    }
    assert!(faults.is_empty(), "in circles: {}", faults.join(", "));
}

/// Words that hide a standard term of terramechanics, vibration or statistics.
const GLOSSARY: [(&str, &str); 16] = [
    ("tell", "distinguish, discriminate, report"),
    ("tells", "states, determines, reports"),
    ("told", "stated, reported, recognised"),
    ("untold", "not stated"),
    ("foretell", "predict"),
    ("foretold", "predicted"),
    ("hear", "on_progress"),
    ("hears", "is called with"),
    ("heard", "reported"),
    ("knows", "contains, has"),
    ("lives", "is in"),
    ("nobody", "unknown, not measured"),
    ("somebody", "on request"),
    ("loudness", "run gain, rms"),
    ("reckon", "estimate"),
    ("reckoned", "estimated"),
];

#[test]
fn code_and_guide_are_in_standard_terms() {
    let mut files = sources(&root());
    let guide = fs::read_dir(root().join("guide")).unwrap();
    files.extend(guide.map(|entry| entry.unwrap().path()));
    let mut faults = Vec::new();
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            // A key of the trial's scores.
            let line = line.replace("\"told\"", "");
            for word in line.split(|c: char| !c.is_alphanumeric()) {
                let word = word.to_lowercase();
                let known = GLOSSARY.iter().find(|(homely, _)| *homely == word);
                faults.extend(known.map(|(homely, term)| {
                    let place = format!("{}:{}", path.display(), number + 1);
                    format!("{place}: `{homely}`: {term}")
                }));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
