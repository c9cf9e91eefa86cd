//! No command destroys a file: what exists stays unless `--force` is given, and inputs stay always.

use crate::cli::{done, program, run};
use crate::identify;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Output;
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

/// Half a second on slate.
const SHORT: &str = "single_wheel_ht --set duration=0.5 --set rig.single_wheel.forward_speed=0.02";

fn error(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Files of at most 2 KiB, as a quota would have it; the signal that comes with it ignored.
const FULL_DISK: &str = "trap '' XFSZ; ulimit -f 2";

/// The program with `words`, run by a shell that has done `first`.
fn in_shell(folder: &Path, first: &str, words: &str) -> Output {
    let program = program(folder);
    let line = format!("{first}; exec {:?} {words}", program.get_program());
    let mut shell = std::process::Command::new("sh");
    let output = shell.current_dir(folder).args(["-c", &line]).output();
    output.unwrap()
}

/// A folder with a campaign of one CSV file, its run file and a scenario.
fn workplace() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("means.csv"), "pull_n,slip\n10,0.1\n20,0.3\n").unwrap();
    fs::write(
        at("rig.toml"),
        "version = 1\n[table]\nfile = \"means.csv\"\ncolumns = { drawbar_pull = \"pull_n\" }\n\
         slip_ratio = { column = \"slip\" }\n",
    )
    .unwrap();
    done(run(folder.path(), "import rig.toml --out rig.h5"));
    done(run(folder.path(), &format!("simulate {SHORT} --out ht.h5")));
    folder
}

/// Something that a user would not want to lose, of the kind that the command writes.
fn precious(folder: &Path, command: &str) -> Vec<u8> {
    match command {
        "plot" => b"<svg>drawn in 1997</svg>".to_vec(),
        _ => fs::read(folder.join("rig.h5")).unwrap(),
    }
}

/// Every command that writes a file, with `{}` for its output.
fn commands() -> [(&'static str, String); 4] {
    [
        ("simulate", format!("simulate {SHORT} --out {{}}")),
        ("dataset", format!("dataset {SHORT} --runs 1 --out {{}}")),
        ("import", "import rig.toml --out {}".to_owned()),
        ("plot", "plot ht.h5 --out {}".to_owned()),
    ]
}

fn name_for(command: &str) -> &'static str {
    match command {
        "plot" => "out.svg",
        _ => "out.h5",
    }
}

/// Puts something precious where the command would write; its place and content.
fn in_the_way(folder: &Path, command: &str) -> (PathBuf, Vec<u8>) {
    let target = folder.join(name_for(command));
    let precious = precious(folder, command);
    fs::write(&target, &precious).unwrap();
    (target, precious)
}

#[test]
fn an_existing_file_stays_without_force_and_is_replaced_whole_with_it() {
    let folder = workplace();
    for (command, words) in commands() {
        let (target, precious) = in_the_way(folder.path(), command);
        let words = words.replace("{}", name_for(command));
        let refused = run(folder.path(), &words);
        assert_eq!(refused.status.code(), Some(1), "{command}");
        assert!(
            error(&refused).contains("exists; give --force"),
            "{command}"
        );
        assert!(fs::read(&target).unwrap() == precious, "{command}");
        done(run(folder.path(), &format!("{words} --force")));
        let replaced = fs::read(&target).unwrap();
        assert!(command == "import" || replaced != precious, "{command}");
        fs::remove_file(target).unwrap();
    }
}

#[test]
fn an_input_is_never_an_output_by_any_name() {
    let folder = workplace();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("sub")).unwrap();
    fs::copy(at("ht.h5"), at("runs.svg")).unwrap();
    symlink(at("runs.svg"), at("soft.svg")).unwrap();
    fs::hard_link(at("runs.svg"), at("hard.svg")).unwrap();
    let before = fs::read(at("runs.svg")).unwrap();
    for name in ["runs.svg", "sub/../runs.svg", "soft.svg", "hard.svg"] {
        let refused = run(
            folder.path(),
            &format!("plot runs.svg --out {name} --force"),
        );
        assert_eq!(refused.status.code(), Some(1), "{name}");
        assert!(error(&refused).contains("this command reads"), "{name}");
    }
    assert_eq!(fs::read(at("runs.svg")).unwrap(), before);
    for input in ["means.csv", "rig.toml"] {
        let refused = run(
            folder.path(),
            &format!("import rig.toml --out {input} --force"),
        );
        assert!(error(&refused).contains("this command reads"), "{input}");
    }
}

#[test]
fn a_write_protected_file_stays_even_by_force() {
    let folder = workplace();
    for (command, words) in commands() {
        let (target, precious) = in_the_way(folder.path(), command);
        fs::set_permissions(&target, fs::Permissions::from_mode(0o444)).unwrap();
        let words = words.replace("{}", name_for(command));
        let refused = run(folder.path(), &format!("{words} --force"));
        assert!(error(&refused).contains("write-protected"), "{command}");
        assert!(fs::read(&target).unwrap() == precious, "{command}");
        fs::remove_file(target).unwrap();
    }
}

#[test]
fn missing_folders_are_made_by_every_command() {
    let folder = workplace();
    for (command, words) in commands() {
        let name = format!("{command}/a/b/{}", name_for(command));
        done(run(folder.path(), &words.replace("{}", &name)));
        assert!(folder.path().join(name).is_file(), "{command}");
    }
}

#[test]
fn a_folder_of_figures_that_holds_files_needs_force() {
    let folder = workplace();
    fs::create_dir(folder.path().join("figures")).unwrap();
    fs::write(folder.path().join("figures/mine.svg"), "mine").unwrap();
    let refused = run(folder.path(), "recognize ht.h5 --out figures");
    assert!(error(&refused).contains("is not empty; give --force"));
    run(folder.path(), "recognize ht.h5 --out figures --force");
    let mine = fs::read_to_string(folder.path().join("figures/mine.svg"));
    assert_eq!(mine.unwrap(), "mine");
}

#[test]
fn a_full_disk_leaves_no_part_and_names_the_reason() {
    let folder = workplace();
    for (command, words) in commands() {
        let name = name_for(command);
        let words = words.replace("{}", name);
        let limited = in_shell(folder.path(), FULL_DISK, &words);
        assert_ne!(limited.status.code(), Some(0), "{command}");
        assert!(
            error(&limited).contains("cannot write"),
            "{command}: {}",
            error(&limited)
        );
        assert!(!folder.path().join(name).exists(), "{command}");
        let left = fs::read_dir(folder.path()).unwrap();
        let parts = left.filter(|entry| {
            let name = entry.as_ref().unwrap().file_name();
            name.to_string_lossy().starts_with(".lugwheel-")
        });
        assert_eq!(parts.count(), 0, "{command}");
    }
}

/// `dataset` of eight runs in `folder`, killed after its first run is whole.
fn killed(folder: &Path, words: &str) {
    let mut program = program(folder);
    program.args(words.split_whitespace());
    let mut child = program.spawn().unwrap();
    let first = folder.join("set.h5.parts/run_000001.json");
    while !first.exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended too early");
        thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_killed_data_set_goes_on_and_ends_with_the_same_bytes() {
    for features in ["", " --features"] {
        let words = format!("dataset {SHORT} --runs 8 --jobs 1 --quiet --out set.h5{features}");
        let (whole, broken) = (TempDir::new().unwrap(), TempDir::new().unwrap());
        done(run(whole.path(), &words));
        killed(broken.path(), &words);
        assert!(!broken.path().join("set.h5").exists());
        let refused = run(broken.path(), &words);
        assert!(error(&refused).contains("--resume"), "{}", error(&refused));
        let other = run(broken.path(), &format!("{words} --resume --seed 2"));
        assert!(
            error(&other).contains("another scenario"),
            "{}",
            error(&other)
        );
        done(run(broken.path(), &format!("{words} --resume")));
        for name in [
            "set.h5",
            "set.windows.csv",
            "set.splits.csv",
            "set.croissant.json",
        ] {
            let [a, b] =
                [&whole, &broken].map(|folder| fs::read(folder.path().join(name)).unwrap());
            assert!(a == b, "{name}{features}");
        }
        assert!(!broken.path().join("set.h5.parts").exists());
    }
}

#[test]
fn under_json_every_error_is_a_document_with_kind_message_file_and_line() {
    let folder = workplace();
    fs::write(
        folder.path().join("bad.toml"),
        "version = 1\nduration = -1\n",
    )
    .unwrap();
    let cases = [
        ("simulate bad.toml --json", "invalid_input", 3),
        ("plot ht.h5 --out ht.h5 --json", "failed", 1),
        ("inspect nothing.h5 --json", "invalid_input", 3),
        ("simulate --json", "usage", 2),
    ];
    for (words, kind, code) in cases {
        let output = run(folder.path(), words);
        assert_eq!(output.status.code(), Some(code), "{words}");
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &document["error"];
        assert_eq!(error["kind"], kind, "{words}: {error}");
        assert!(
            error["message"]
                .as_str()
                .is_some_and(|text| !text.is_empty())
        );
        assert!(error.get("file").is_some() && error.get("line").is_some());
    }
    let bad = run(folder.path(), "simulate bad.toml --json");
    let document: serde_json::Value = serde_json::from_slice(&bad.stdout).unwrap();
    assert!(
        document["error"]["file"]
            .as_str()
            .unwrap()
            .ends_with("bad.toml")
    );
    assert!(document["error"]["line"].as_u64().is_some());
}

#[test]
fn a_study_with_failed_runs_prints_its_result_alone_under_json() {
    let folder = TempDir::new().unwrap();
    let study = "version = 1\ntitle = \"t\"\nquestion = \"Do all sink?\"\nseed = 1\nrepeats = 1\nrandom_numbers = \"common\"\n\
                 scenarios = [\"scenarios/quick.toml\"]\n[set]\nrig.single_wheel.load = 50000.0\n";
    fs::write(folder.path().join("sinks.toml"), study).unwrap();
    let output = run(folder.path(), "study sinks.toml --out sinks --json");
    assert_eq!(output.status.code(), Some(4), "{}", error(&output));
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["failed"].as_array().unwrap().len(), 1);
}

#[test]
fn plot_refuses_a_suffix_that_it_does_not_write() {
    let folder = workplace();
    let refused = run(folder.path(), "plot ht.h5 --out a.png");
    let said = error(&refused);
    assert!(said.contains("plot writes SVG; name a.svg"), "{said}");
}

#[test]
fn ready_studies_are_found_by_name_and_a_typo_suggests_the_near_one() {
    let folder = TempDir::new().unwrap();
    let typo = run(folder.path(), "study quik");
    assert_eq!(typo.status.code(), Some(3));
    assert!(
        error(&typo).contains("did you mean quick"),
        "{}",
        error(&typo)
    );
    let said = done(run(folder.path(), "study quick --out by_name"));
    assert_eq!(said.lines().last(), Some("report: by_name/report.html"));
}

/// The exit code and the first line of error.
fn ended(output: &Output) -> String {
    let said = error(output);
    let said = said.lines().next().unwrap_or("-");
    format!("{} | {said}", output.status.code().unwrap())
}

/// What a command does with each kind of output in its way, a row each.
fn rows(command: &str, words: &str) -> String {
    let folder = workplace();
    let at = |name: &str| folder.path().join(name);
    let name = |stem: &str| name_for(command).replace("out", stem);
    fs::copy(at("ht.h5"), at("in.svg")).unwrap();
    fs::copy(
        concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/scenarios/single_wheel_ht.toml"
        ),
        at("in.toml"),
    )
    .unwrap();
    let input = match command {
        "plot" => "in.svg",
        "import" => "rig.toml",
        _ => "in.toml",
    };
    let words = words.replace("plot ht.h5", "plot in.svg");
    let words = words.replace("single_wheel_ht", "in.toml");
    for stem in ["old", "protected"] {
        fs::write(at(&name(stem)), precious(folder.path(), command)).unwrap();
    }
    fs::set_permissions(at(&name("protected")), fs::Permissions::from_mode(0o444)).unwrap();
    symlink(input, at(&name("soft"))).unwrap();
    fs::hard_link(at(input), at(&name("hard"))).unwrap();
    fs::create_dir(at("sub")).unwrap();
    let cases = [
        ("existing file", name("old"), "", ":"),
        (
            "input, relative name, --force",
            format!("sub/../{input}"),
            " --force",
            ":",
        ),
        (
            "input, symbolic link, --force",
            name("soft"),
            " --force",
            ":",
        ),
        ("input, hard link, --force", name("hard"), " --force", ":"),
        ("read-only file", name("protected"), "", ":"),
        (
            "read-only file, --force",
            name("protected"),
            " --force",
            ":",
        ),
        ("full disk", name("new"), "", FULL_DISK),
        ("missing folder", name("no/such/new"), "", ":"),
    ];
    let rows = cases.map(|(case, out, force, limit)| {
        let words = words.replace("{}", &out);
        let output = in_shell(folder.path(), limit, &format!("{words}{force}"));
        format!("{command} | {case} | {}\n", ended(&output))
    });
    rows.concat()
}

/// Every command that fills a folder, with `{}` for it, and whether it is quick enough to be run to its end.
fn folder_commands() -> [(&'static str, &'static str, bool); 6] {
    [
        ("recognize", "recognize drive.h5 --out {}", true),
        ("identify", "identify loads.h5 --out {}", true),
        ("study", "study tiny.toml --out {}", true),
        (
            "diagnose",
            "diagnose --measured drive.h5 --scenario in.toml --out {}",
            false,
        ),
        ("challenge", "challenge make --set C0 --out {}", false),
        ("demo", "demo --out {}", false),
    ]
}

/// A folder with the inputs of these commands.
fn workplace_of_folders() -> TempDir {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let root = env!("CARGO_MANIFEST_DIR");
    fs::copy(
        format!("{root}/scenarios/single_wheel_ht.toml"),
        at("in.toml"),
    )
    .unwrap();
    let drive = "simulate in.toml --set duration=2 --set rig.single_wheel.forward_speed=0.1";
    done(run(folder.path(), &format!("{drive} --out drive.h5")));
    identify::write(&at("loads.h5"), &identify::campaign());
    let tiny = "version = 1\ntitle = \"t\"\nquestion = \"How loud?\"\nseed = 1\nrepeats = 1\n\
                random_numbers = \"common\"\nscenarios = [\"in.toml\"]\n[set]\nduration = 0.5\n";
    fs::write(at("tiny.toml"), tiny).unwrap();
    fs::create_dir_all(at("sub")).unwrap();
    folder
}

/// What a command does with each kind of folder in its way, a row each; what stood there is to stay.
fn folder_rows((command, words, is_quick): (&str, &str, bool)) -> String {
    let folder = workplace_of_folders();
    let at = |name: &str| folder.path().join(name);
    let input = words
        .split(' ')
        .find(|word| word.contains('.'))
        .unwrap_or("in.toml");
    let precious = fs::read(at(input)).unwrap();
    fs::create_dir(at("full")).unwrap();
    fs::write(at("full/mine.txt"), "mine").unwrap();
    fs::write(at("file"), "mine").unwrap();
    symlink(input, at("soft")).unwrap();
    fs::hard_link(at(input), at("hard")).unwrap();
    let relative = format!("sub/../{input}");
    let refusals = [
        ("folder with files of others", "full", ""),
        ("existing file", "file", ""),
        ("existing file, --force", "file", " --force"),
        (
            "input, relative name, --force",
            relative.as_str(),
            " --force",
        ),
        ("input, symbolic link, --force", "soft", " --force"),
        ("input, hard link, --force", "hard", " --force"),
    ];
    let mut rows = String::new();
    let mut row = |case: &str, out: &str, option: &str, limit: &str| {
        let words = words.replace("{}", out);
        let output = in_shell(folder.path(), limit, &format!("{words}{option} --quiet"));
        rows += &format!("{command} | {case} | {}\n", ended(&output));
        output
    };
    for (case, out, option) in refusals {
        let output = row(case, out, option, ":");
        assert_eq!(
            output.status.code(),
            Some(1),
            "{command}, {case}: {}",
            error(&output)
        );
        assert!(
            ["--force", "name another", "name a folder"]
                .iter()
                .any(|way| error(&output).contains(way)),
            "{command}, {case}: {}",
            error(&output)
        );
        assert!(
            fs::read(at(input)).unwrap() == precious,
            "{command}, {case}"
        );
        for mine in ["full/mine.txt", "file"] {
            assert_eq!(
                fs::read_to_string(at(mine)).unwrap(),
                "mine",
                "{command}, {case}"
            );
        }
    }
    if is_quick {
        let output = row("full disk", "new", "", FULL_DISK);
        assert_ne!(output.status.code(), Some(0), "{command}");
        assert!(
            error(&output).contains("cannot write"),
            "{command}: {}",
            error(&output)
        );
        let output = row("missing folder", "no/such/new", "", ":");
        assert_eq!(
            output.status.code(),
            Some(0),
            "{command}: {}",
            error(&output)
        );
        assert!(at("no/such/new").is_dir());
    }
    rows
}

#[test]
fn commands_that_fill_a_folder_leave_what_stands_there() {
    for command in folder_commands() {
        folder_rows(command);
    }
}

#[test]
#[ignore = "writes output/reference/outputs.txt: cargo test --test all outputs:: -- --ignored"]
fn the_table_of_outputs_is_written() {
    let rows = commands().map(|(command, words)| rows(command, &words));
    let folders = folder_commands().map(folder_rows);
    let table = format!(
        "command | output | exit code | message\n{}{}",
        rows.concat(),
        folders.concat()
    );
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/output/reference/outputs.txt");
    fs::write(path, table).unwrap();
}
