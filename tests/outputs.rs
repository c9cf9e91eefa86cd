//! No command destroys a file: what exists stays unless `--force` is given, and inputs stay always. What
//! cannot be written is told before any work, with the reason and what to do; what a kill leaves behind
//! the next command removes.
//!
//! `cargo test --test all outputs:: -- --ignored` writes `output/reference/outputs.txt`.

use crate::cli::{done, program, run};
use crate::identify;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Output};
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

/// Room for what is tried before the work, not for a result.
const DISK_THAT_FILLS: &str = "trap '' XFSZ; ulimit -f 20";

#[test]
fn a_disk_that_fills_leaves_nothing_and_names_reason_and_way_out() {
    let folder = workplace();
    for (command, words) in commands() {
        // An import of two means is small.
        if command == "import" {
            continue;
        }
        let name = name_for(command);
        let before = files(folder.path());
        let words = words.replace("{}", name);
        let limited = in_shell(folder.path(), DISK_THAT_FILLS, &format!("{words} --quiet"));
        let said = error(&limited);
        assert_eq!(limited.status.code(), Some(1), "{command}: {said}");
        let first = said.lines().next().unwrap();
        assert!(first.contains("cannot write"), "{command}: {said}");
        assert!(
            first.contains(": File too large; raise the limit (ulimit -f) or name another"),
            "{command}: {said}"
        );
        assert!(files(folder.path()) == before, "{command}");
    }
}

#[test]
fn a_data_set_that_does_not_fit_says_why_and_goes_on_where_there_is_room() {
    let folder = TempDir::new().unwrap();
    // 100 KiB in blocks of 512 bytes: a run of 60 kB fits, four do not.
    let first = "trap '' XFSZ; ulimit -f 200";
    program(folder.path());
    let words = format!("dataset {SHORT} --runs 4 --quiet --out set.h5");
    let limited = in_shell(folder.path(), first, &words);
    let said = error(&limited);
    let line = said.lines().next().unwrap();
    assert!(
        line.starts_with("error: cannot write set.h5: File too large; raise the limit"),
        "{said}"
    );
    assert!(line.contains("4 of 4 runs are whole"), "{said}");
    done(run(folder.path(), &format!("{words} --resume")));
    assert!(!folder.path().join("set.h5.parts").exists());
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
fn plot_writes_what_its_output_ends_in() {
    let folder = workplace();
    let cases: [(&str, &[u8]); 5] = [
        ("--out a.svg", b"<svg "),
        ("--out a.png --width 88mm", b"\x89PNG"),
        ("--out a.pdf --width 88mm --no-title", b"%PDF-"),
        ("--out a.html", b"<!doctype html>"),
        ("--format pdf", b"%PDF-"),
    ];
    for (words, beginning) in cases {
        let drawn = run(folder.path(), &format!("plot ht.h5 {words}"));
        assert_eq!(drawn.status.code(), Some(0), "{}", error(&drawn));
        let name = String::from_utf8(drawn.stdout).unwrap();
        let written = fs::read(folder.path().join(name.trim())).unwrap();
        assert!(written.starts_with(beginning), "{words}");
    }
    let page = run(folder.path(), "plot ht.h5 --out b.html --width 88mm");
    assert!(error(&page).contains("for figures"), "{}", error(&page));
}

#[test]
fn plot_refuses_a_suffix_that_it_does_not_write() {
    let folder = workplace();
    let refused = run(folder.path(), "plot ht.h5 --out a.jpg");
    let said = error(&refused);
    let way_out = "plot writes svg, png, pdf, html and mcap; name a.svg";
    assert!(said.contains(way_out), "{said}");
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

/// A place of output, and what must come of it.
struct Row<'a> {
    case: &'a str,
    out: String,
    /// Option that follows.
    option: &'a str,
    /// What the shell does first.
    first: &'a str,
    code: i32,
    /// What the first line of error has.
    says: &'a str,
}

impl Row<'_> {
    fn new<'a>(case: &'a str, out: impl Into<String>, says: &'a str) -> Row<'a> {
        Row {
            case,
            out: out.into(),
            option: "",
            first: ":",
            code: 1,
            says,
        }
    }

    fn by_force(self) -> Self {
        Self {
            option: " --force",
            ..self
        }
    }

    fn on_a_full_disk(self) -> Self {
        Self {
            first: FULL_DISK,
            ..self
        }
    }

    fn ends_with(self, code: i32) -> Self {
        Self { code, ..self }
    }
}

/// Runs `words` with each place for `{}`: exit code and first line are as stated, what stood in `folder`
/// before stays, and no part is left. A line of the table for each.
fn lines(folder: &Path, command: &str, words: &str, rows: &[Row]) -> String {
    let line = |row: &Row| {
        let before = files(folder);
        let words = format!("{}{} --quiet", words.replace("{}", &row.out), row.option);
        let output = in_shell(folder, row.first, &words);
        let said = error(&output);
        let said = said.lines().next().unwrap_or("-");
        let context = format!("{command}, {}: {said}", row.case);
        assert_eq!(output.status.code(), Some(row.code), "{context}");
        assert!(said.contains(row.says), "{context}");
        let after = files(folder);
        assert!(
            before.iter().all(|file| after.contains(file)),
            "lost a file: {context}"
        );
        let mut names = after.iter().map(|(path, _)| path.to_string_lossy());
        assert!(
            names.all(|name| !name.contains(".lugwheel-")),
            "left a part: {context}"
        );
        format!("{command} | {} | {} | {said}\n", row.case, row.code)
    };
    rows.iter().map(line).collect()
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("scenarios") {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push((path.clone(), fs::read(&path).unwrap()));
        }
    }
    found
}

fn protect(path: &Path) {
    fs::set_permissions(path, fs::Permissions::from_mode(0o444)).unwrap();
}

const READS: &str = "which this command reads; name another output";
const IN_THE_WAY: &str = "move the file that is in the way or name another place with --out";
const TOO_LARGE: &str = ": File too large; raise the limit (ulimit -f) or name another place";

/// What a command that writes a file does with each place for it.
fn file_lines((command, words): &(&str, String)) -> String {
    let folder = workplace();
    let at = |name: &str| folder.path().join(name);
    let name = |stem: &str| name_for(command).replace("out", stem);
    let scenario = "/scenarios/single_wheel_ht.toml";
    fs::copy(
        format!("{}{scenario}", env!("CARGO_MANIFEST_DIR")),
        at("in.toml"),
    )
    .unwrap();
    fs::copy(at("ht.h5"), at("in.svg")).unwrap();
    let input = match *command {
        "plot" => "in.svg",
        "import" => "rig.toml",
        _ => "in.toml",
    };
    let words = words.replace("plot ht.h5", "plot in.svg");
    let words = words.replace("single_wheel_ht", "in.toml");
    for stem in ["old", "protected"] {
        fs::write(at(&name(stem)), precious(folder.path(), command)).unwrap();
    }
    protect(&at(&name("protected")));
    fs::create_dir_all(at(&name("full"))).unwrap();
    fs::write(at(&name("full")).join("mine.txt"), "mine").unwrap();
    symlink(input, at(&name("soft"))).unwrap();
    fs::hard_link(at(input), at(&name("hard"))).unwrap();
    fs::create_dir(at("sub")).unwrap();
    let below = format!("{}/{}", name("old"), name("new"));
    let rows = [
        Row::new("existing file", name("old"), "exists; give --force"),
        Row::new(
            "folder with files of others",
            name("full"),
            "is a folder; name a file",
        ),
        Row::new(
            "input, relative name, --force",
            format!("sub/../{input}"),
            READS,
        )
        .by_force(),
        Row::new("input, symbolic link, --force", name("soft"), READS).by_force(),
        Row::new("input, hard link, --force", name("hard"), READS).by_force(),
        Row::new(
            "write-protected file",
            name("protected"),
            "exists; give --force",
        ),
        Row::new(
            "write-protected file, --force",
            name("protected"),
            "is write-protected, and --force does not replace such a file",
        )
        .by_force(),
        Row::new(
            "read-only folder",
            closed(&name("new")),
            "make it writable or",
        ),
        Row::new("file in place of a folder", below, IN_THE_WAY),
        Row::new("full disk", name("new"), TOO_LARGE).on_a_full_disk(),
        Row::new("missing folder", name("no/such/new"), "-").ends_with(0),
    ];
    lines(folder.path(), command, &words, &rows)
}

/// A place in which nobody may write, root included.
fn closed(name: &str) -> String {
    format!("/sys/{name}")
}

/// A command that fills a folder, with `{}` for it.
struct Filler {
    command: &'static str,
    words: &'static str,
    /// One of its inputs, which is none of a folder of its own.
    input: &'static str,
    /// A file that it writes there.
    result: &'static str,
    /// What it says of that file where it is protected, with --force.
    protected: &'static str,
    /// Why it is not run to its end.
    not_run: Option<&'static str>,
}

const PROTECTED: &str = "is write-protected, and --force does not replace such a file";

const FILLERS: [Filler; 6] = [
    Filler {
        command: "recognize",
        words: "recognize drive.h5 --out {}",
        input: "drive.h5",
        result: "run_000000.svg",
        protected: PROTECTED,
        not_run: None,
    },
    Filler {
        command: "identify",
        words: "identify loads.h5 --out {}",
        input: "loads.h5",
        result: "forces_LEIS.svg",
        protected: PROTECTED,
        not_run: None,
    },
    Filler {
        command: "study",
        words: "study tiny.toml --out {}",
        input: "tiny.toml",
        result: "runs.csv",
        protected: "is not empty; continue it (--resume) or name another folder",
        not_run: None,
    },
    Filler {
        command: "diagnose",
        words: "diagnose --measured drive.h5 --scenario in.toml --out {}",
        input: "drive.h5",
        result: "diagnosis.html",
        protected: PROTECTED,
        not_run: Some("simulates for minutes"),
    },
    Filler {
        command: "challenge make",
        words: "challenge make --set C0 --cases 1 --ground hard --duration 0.1 --out {}",
        input: "in.toml",
        result: "campaigns/manifest.json",
        protected: "is not empty; name another folder",
        not_run: None,
    },
    Filler {
        command: "demo",
        words: "demo --out {}",
        input: "in.toml",
        result: "report.html",
        protected: PROTECTED,
        not_run: Some("simulates for minutes"),
    },
];

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

/// What a command that fills a folder does with each place for it.
fn folder_lines(filler: &Filler) -> String {
    let Filler {
        command,
        words,
        input,
        result,
        protected,
        not_run,
    } = *filler;
    let folder = workplace_of_folders();
    let at = |name: &str| folder.path().join(name);
    let own = at("own").join(result);
    fs::create_dir_all(own.parent().unwrap()).unwrap();
    fs::write(&own, "mine").unwrap();
    protect(&own);
    fs::create_dir(at("full")).unwrap();
    fs::write(at("full/mine.txt"), "mine").unwrap();
    fs::write(at("file"), "mine").unwrap();
    symlink(input, at("soft")).unwrap();
    fs::hard_link(at(input), at("hard")).unwrap();
    let is_file = "is a file; name a folder";
    let rows = [
        Row::new("folder with files of others", "full", "is not empty"),
        Row::new("existing file", "file", is_file),
        Row::new("existing file, --force", "file", is_file).by_force(),
        Row::new(
            "input, relative name, --force",
            format!("sub/../{input}"),
            is_file,
        )
        .by_force(),
        Row::new("input, symbolic link, --force", "soft", is_file).by_force(),
        Row::new("input, hard link, --force", "hard", is_file).by_force(),
        Row::new("write-protected result, --force", "own", protected).by_force(),
        Row::new("read-only folder", closed("new"), "make it writable or"),
        Row::new("file in place of a folder", "file/new", IN_THE_WAY),
        Row::new("full disk", "new", TOO_LARGE).on_a_full_disk(),
    ];
    let table = lines(folder.path(), command, words, &rows);
    let last = match not_run {
        Some(reason) => format!("{command} | missing folder | not run: {reason} | -\n"),
        None => {
            let made = Row::new("missing folder", "no/such/new", "-").ends_with(0);
            lines(folder.path(), command, words, &[made])
        }
    };
    table + &last
}

/// What commands that draw figures into a folder do with an input under the name of a figure there.
fn figure_lines() -> String {
    let folder = workplace_of_folders();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("own")).unwrap();
    let line = |command: &str, input: &str, figure: &str| {
        fs::copy(at(input), at("own").join(figure)).unwrap();
        let words = format!("{command} own/{figure} --out {{}}");
        let row = Row::new("input of a figure's name, --force", "own", READS).by_force();
        lines(folder.path(), command, &words, &[row])
    };
    let recognized = line("recognize", "drive.h5", "run_000000.svg");
    recognized + &line("identify", "loads.h5", "forces_LEIS.svg")
}

/// What `diagnose` does with each place for its bank.
fn bank_lines() -> String {
    let folder = workplace_of_folders();
    fs::write(folder.path().join("file"), "mine").unwrap();
    let words = "diagnose --measured drive.h5 --scenario in.toml --force --out new --bank {}";
    let rows = [
        Row::new(
            "--bank, existing file",
            "file",
            "file is a file; name a folder",
        ),
        Row::new(
            "--bank, read-only folder",
            closed("bank"),
            "make it writable or name another place with --bank",
        ),
    ];
    lines(folder.path(), "diagnose", words, &rows)
}

/// What commands that go on in the folder of a trial do with each kind of it.
fn trial_lines() -> String {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let make = "challenge make --set C0 --cases 1 --ground hard --duration 0.1 --out";
    done(run(folder.path(), &format!("{make} trial --quiet")));
    fs::create_dir(at("full")).unwrap();
    fs::write(at("full/mine.txt"), "mine").unwrap();
    fs::write(at("file"), "mine").unwrap();
    let none = |command: &str| {
        let words = format!("{command} {{}}");
        let rows = [
            Row::new(
                "existing file",
                "file",
                "cannot read file/campaigns/manifest.json: Not a directory",
            )
            .ends_with(3),
            Row::new(
                "folder with files of others",
                "full",
                "cannot read full/campaigns/manifest.json: No such file",
            )
            .ends_with(3),
            Row::new(
                "missing folder",
                "none",
                "cannot read none/campaigns/manifest.json: No such file",
            )
            .ends_with(3),
        ];
        lines(folder.path(), command, &words, &rows)
    };
    let mut table = none("challenge run");
    let words = "challenge run {}";
    let too_large = Row::new("full disk", "trial", ": File too large; raise the limit");
    let full = [too_large.on_a_full_disk()];
    table += &lines(folder.path(), "challenge run", words, &full);
    fs::write(at("trial/answers/origin.txt"), "mine").unwrap();
    protect(&at("trial/answers/origin.txt"));
    let others = "holds answers to other campaigns or of another program; remove it";
    let rows = [Row::new("write-protected answers of others", "trial", others).by_force()];
    table += &lines(folder.path(), "challenge run", words, &rows);
    table += "challenge run | input as output | not run: the folder of the trial is both | -\n";
    fs::remove_file(at("trial/answers/origin.txt")).unwrap();
    fs::write(
        at("trial/answers/case_0001.json"),
        "{\"verdict\": \"none\", \"probabilities\": {\"none\": 1.0}}\n",
    )
    .unwrap();
    table += &none("challenge score");
    let words = "challenge score {}";
    table += &lines(folder.path(), "challenge score", words, &full);
    fs::create_dir_all(at("trial/score")).unwrap();
    fs::write(at("trial/score/power.svg"), "mine").unwrap();
    protect(&at("trial/score/power.svg"));
    let rows = [Row::new("write-protected result, --force", "trial", PROTECTED).by_force()];
    table += &lines(folder.path(), "challenge score", words, &rows);
    table + "challenge score | input as output | not run: the folder of the trial is both | -\n"
}

#[test]
fn a_file_is_written_where_nothing_is_lost_and_refused_elsewhere_with_reason_and_way_out() {
    for command in &commands() {
        file_lines(command);
    }
}

#[test]
fn a_folder_is_filled_where_nothing_is_lost_and_refused_elsewhere_with_reason_and_way_out() {
    for filler in &FILLERS {
        folder_lines(filler);
    }
}

#[test]
fn an_input_under_the_name_of_a_figure_is_refused_even_by_force() {
    figure_lines();
}

#[test]
fn a_bank_that_cannot_be_kept_is_refused_before_any_simulation() {
    bank_lines();
}

#[test]
fn trials_are_answered_and_scored_in_their_own_folder_alone() {
    trial_lines();
}

#[test]
#[ignore = "writes output/reference/outputs.txt: cargo test --test all outputs:: -- --ignored"]
fn the_table_of_outputs_is_written() {
    let files = commands().each_ref().map(file_lines).concat();
    let folders = FILLERS.each_ref().map(folder_lines).concat();
    let table = format!(
        "command | output | exit code | message\n{files}{folders}{}{}{}",
        figure_lines(),
        bank_lines(),
        trial_lines()
    );
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/output/reference/outputs.txt");
    fs::write(path, table).unwrap();
}

/// Names of parts in a folder.
fn parts(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.starts_with(".lugwheel-"))
        .collect()
}

/// A command in `folder` that has begun to write its run file, which has a lock beside it. A part without one only tries whether
/// the folder can be written.
fn writing(folder: &Path, words: &str) -> Child {
    let mut program = program(folder);
    program.args(words.split_whitespace());
    let mut child = program.spawn().unwrap();
    let is_of_a_run_file = |name: &String| {
        let stem = name.strip_suffix(".lock");
        stem.is_some_and(|stem| folder.join(format!("{stem}.part")).exists())
    };
    while !parts(folder).iter().any(is_of_a_run_file) {
        assert!(child.try_wait().unwrap().is_none(), "it ended too early");
        thread::sleep(Duration::from_millis(5));
    }
    child
}

/// Longer than any test waits.
const LONG: &str = "simulate single_wheel_ref --set duration=1000 --quiet --out long.h5";

#[test]
fn what_a_killed_command_was_writing_the_next_one_in_the_folder_removes() {
    let folder = workplace();
    for next in [
        "plot ht.h5 --out a.svg",
        "import rig.toml --out b.h5",
        "dataset single_wheel_ht --runs 1 --set duration=0.5 --out c.h5",
    ] {
        let mut killed = writing(folder.path(), LONG);
        killed.kill().unwrap();
        killed.wait().unwrap();
        assert!(!parts(folder.path()).is_empty(), "{next}");
        done(run(folder.path(), &format!("{next} --quiet")));
        assert_eq!(parts(folder.path()), Vec::<String>::new(), "{next}");
    }
    assert!(!folder.path().join("long.h5").exists());
}

#[test]
fn a_folder_of_figures_that_a_killed_command_left_only_a_part_in_counts_as_empty() {
    let folder = workplace_of_folders();
    let figures = folder.path().join("figures");
    fs::create_dir(&figures).unwrap();
    let mut killed = writing(&figures, LONG);
    killed.kill().unwrap();
    killed.wait().unwrap();
    done(run(
        folder.path(),
        "identify loads.h5 --out figures --quiet",
    ));
    assert_eq!(parts(&figures), Vec::<String>::new());
}

#[test]
fn what_a_living_command_is_writing_stays_whatever_else_is_written_beside_it() {
    let folder = workplace();
    let mut living = writing(folder.path(), LONG);
    let before = parts(folder.path());
    done(run(folder.path(), "plot ht.h5 --out a.svg --quiet"));
    done(run(folder.path(), "import rig.toml --out b.h5 --quiet"));
    assert_eq!(parts(folder.path()), before);
    assert!(living.try_wait().unwrap().is_none(), "it still writes");
    living.kill().unwrap();
    living.wait().unwrap();
}
