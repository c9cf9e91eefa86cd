//! A study's results depend on its file alone: not on threads, interruptions or how it was shared.

use crate::common::results::{contents, done, into, resumed};
use lugwheel::report::study_page::texts;
use lugwheel::study::identification::score::IdentificationScore;
use lugwheel::study::{Options, Outcome, Progress, Run, Scores, Study, StudyError};
use lugwheel::terrain::class::Wtic;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use tempfile::TempDir;

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn shipped(name: &str) -> Study {
    let path = here(&format!("scenarios/studies/{name}.toml"));
    Study::load(path).unwrap_or_else(|error| panic!("{error}"))
}

fn toml_files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(here(folder)).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// A study of the scenarios with these names, in a folder of its own.
fn study(folder: &TempDir, scenarios: &[&str], rest: &str) -> Study {
    let paths: Vec<String> = scenarios
        .iter()
        .map(|name| format!("{:?}", here(&format!("scenarios/{name}.toml"))))
        .collect();
    let file = folder.path().join("study.toml");
    let head = format!("version = 1\nscenarios = [{}]\nseed = 7", paths.join(", "));
    std::fs::write(&file, format!("{head}\n{rest}")).unwrap();
    Study::load(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// Twelve runs of 0.15 s on flat stone and sand, at a rate that is good enough for bookkeeping.
fn short(folder: &TempDir) -> Study {
    let rest = "repeats = 2\nrandom_numbers = \"independent\"\n\
                [set]\nduration = 0.15\nphysics_rate = 4000\nrig.single_wheel.start_up = 0.02\n\
                [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.0, 0.1, 0.3]\n";
    study(folder, &["single_wheel_ref", "single_wheel_st"], rest)
}

fn execute(study: &Study, options: &Options) -> Result<Outcome, StudyError> {
    study.execute(options, &|_| ControlFlow::Continue(()))
}

/// What the short study leaves behind on two threads, at one go.
static WHOLE: LazyLock<Vec<(PathBuf, Vec<u8>)>> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("whole");
    let outcome = done(&short(&folder), &into(&out));
    assert_eq!((outcome.runs, outcome.failed.len()), (12, 0));
    contents(&out)
});

fn records(out: &Path, table: &str) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(out.join(table)).unwrap();
    reader.records().map(Result::unwrap).collect()
}

/// The cells of a named column of the runs.
fn column(out: &Path, name: &str) -> Vec<String> {
    column_of(out, "runs.csv", name)
}

fn column_of(out: &Path, table: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_path(out.join(table)).unwrap();
    let headers = reader.headers().unwrap().clone();
    let index = headers
        .iter()
        .position(|header| header == name)
        .unwrap_or_else(|| panic!("no column {name} among {headers:?}"));
    let records = records(out, table);
    let cells = records.iter().map(|record| record[index].to_owned());
    cells.collect()
}

/// The message after `#^ `, and the number of the line above it.
fn stated_fault(text: &str) -> (usize, &str) {
    let mut lines = text.lines().enumerate();
    lines
        .find_map(|(index, line)| line.strip_prefix("#^ ").map(|message| (index, message)))
        .expect("a bad study states its message")
}

/// How a bad study's error differs from the one it states.
fn unlike_stated(file: &Path) -> Option<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let (line, message) = stated_fault(&text);
    match Study::load(file) {
        Err(StudyError::Invalid(fault)) => {
            let like = fault.line == line && fault.message.contains(message);
            (!like).then(|| format!("line {line}: {message}\nis not\n{fault}"))
        }
        other => Some(format!("{}: {other:?}", file.display())),
    }
}

#[test]
fn every_bad_study_gives_the_message_it_states_at_the_line_it_states() {
    let files = toml_files("tests/studies/bad");
    assert!(files.len() >= 84);
    let wrong: Vec<String> = files
        .iter()
        .filter_map(|file| unlike_stated(file))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_shipped_study_is_sound_in_every_condition() {
    let files = toml_files("scenarios/studies");
    assert!(files.len() >= 25, "{}", files.len());
    for file in files {
        Study::load(&file).unwrap_or_else(|error| panic!("{error}"));
    }
}

/// Whole windows in all runs of a study.
fn windows(study: &Study) -> f64 {
    let in_run = |run: Run| {
        let scenario = study.scenario(&run);
        (scenario.duration / scenario.window()).floor()
    };
    study.runs().map(in_run).sum()
}

#[test]
fn table_3_has_300_windows_and_table_5_has_432_as_in_the_paper() {
    let (table3, table5) = (shipped("table3"), shipped("table5"));
    assert_eq!((table3.run_count(), windows(&table3)), (300, 300.0));
    assert_eq!((table5.run_count(), windows(&table5)), (144, 432.0));
    let speed = |run: &Run| table5.scenario(run).rig.drive().forward_speed;
    let reverse = table5.runs().filter(|run| speed(run) < 0.0).count();
    assert_eq!(reverse, 72, "half of the runs go in reverse");
}

#[test]
fn the_sweeps_span_what_their_names_say() {
    let span = |name: &str, value: &dyn Fn(&Study, &Run) -> f64| {
        let study = shipped(name);
        let values = study.runs().map(|run| value(&study, &run));
        values.fold([f64::MAX, f64::MIN], |[low, high], v| {
            [low.min(v), high.max(v)]
        })
    };
    let speed = span("sweep_speed", &|study, run| {
        study.scenario(run).rig.drive().forward_speed
    });
    assert_eq!(speed, [0.003, 0.05]);
    let load = span("sweep_load", &|study, run| study.scenario(run).rig.load());
    assert_eq!(load, [30.0, 300.0]);
    for (name, fewest) in [("sweep_lugs", 0.0), ("thresholds", 4.0)] {
        let lugs = span(name, &|study, run| {
            f64::from(study.scenario(run).wheel.lug_count())
        });
        assert_eq!(lugs, [fewest, 48.0], "{name}");
    }
}

#[test]
fn sweeps_are_crossed_the_last_one_fastest_and_the_keys_of_a_row_change_together() {
    let folder = TempDir::new().unwrap();
    let rest = "repeats = 2\nrandom_numbers = \"common\"\n\
                [[sweep]]\nkey = \"duration\"\nvalues = [1.0, 2.0]\n\
                [[sweep]]\nkeys = [\"rig.single_wheel.slip\", \"rig.single_wheel.load\"]\n\
                rows = [[0.1, 50.0], [0.3, 60.0]]\n";
    let study = study(&folder, &["quick"], rest);
    let conditions: Vec<[f64; 3]> = study
        .runs()
        .step_by(2)
        .map(|run| {
            let scenario = study.scenario(&run);
            let slip = scenario.rig.drive().slip.unwrap().get();
            [scenario.duration, slip, scenario.rig.load()]
        })
        .collect();
    let expected = [
        [1.0, 0.1, 50.0],
        [1.0, 0.3, 60.0],
        [2.0, 0.1, 50.0],
        [2.0, 0.3, 60.0],
    ];
    assert_eq!(conditions, expected);
}

#[test]
fn common_random_numbers_are_the_repeats_and_independent_ones_the_runs() {
    let streams = |random_numbers| {
        let folder = TempDir::new().unwrap();
        let rest = format!(
            "repeats = 2\nrandom_numbers = {random_numbers:?}\n\
             [[sweep]]\nkey = \"duration\"\nvalues = [1.0, 2.0]\n"
        );
        let study = study(&folder, &["quick"], &rest);
        study.runs().map(|run| run.stream).collect::<Vec<u64>>()
    };
    assert_eq!(streams("common"), [0, 1, 0, 1]);
    assert_eq!(streams("independent"), [0, 1, 2, 3]);
}

#[test]
fn the_quick_study_has_six_whole_runs_whose_forces_carry_their_load() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("quick");
    let outcome = done(&shipped("quick"), &into(&out));
    assert_eq!((outcome.runs, outcome.failed.len()), (6, 0));
    assert!(!out.join("failed.txt").exists());
    let labels = column(&out, "label");
    assert_eq!(labels, ["REF", "REF", "REF", "ST", "ST", "ST"]);
    let numbers = |name: &str| -> Vec<f64> {
        let cells = column(&out, name);
        cells.iter().map(|cell| cell.parse().unwrap()).collect()
    };
    // 2 %: the steady second is no whole number of lug passes.
    for force in numbers("normal_force_mean_n") {
        assert!((force / 100.0 - 1.0).abs() < 0.02, "{force} N");
    }
    let sinkage = numbers("sinkage_mean_m");
    assert!(
        sinkage[..3].iter().all(|z| *z < 0.0),
        "lugs hold the rim up"
    );
    assert!(sinkage[3..].iter().all(|z| *z > 0.001), "sand gives way");
    assert!(
        numbers("acceleration_rms_20_200_hz_m_s2")
            .iter()
            .all(|a| *a > 0.0)
    );
    let times = std::fs::read_to_string(out.join("timing.csv")).unwrap();
    assert_eq!(times.lines().count(), 7);
}

#[test]
fn a_run_is_the_same_alone_as_in_the_study() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    done(&study, &into(&out));
    let run = study.runs().nth(9).unwrap();
    let alone = study.run(&run, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(alone.attributes.repeat, run.repeat);
    let force = alone
        .channel("normal_force")
        .unwrap()
        .steady_mean()
        .unwrap();
    let in_study: f64 = column(&out, "normal_force_mean_n")[9].parse().unwrap();
    // The two sums of the same samples are the same bits.
    assert_eq!(force.to_bits(), in_study.to_bits());
}

#[test]
fn one_thread_and_two_leave_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let (study, one) = (short(&folder), folder.path().join("one"));
    let alone = Options {
        jobs: NonZeroUsize::new(1),
        ..into(&one)
    };
    done(&study, &alone);
    assert_eq!(contents(&one), *WHOLE);
    assert_eq!(records(&one, "runs.csv").len(), 12);
}

#[test]
fn shards_that_are_lost_torn_or_altered_are_redone_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    done(&study, &into(&out));
    let before = contents(&out);
    let shard = |number: u32| out.join(format!("shards/{number:05}.runs.csv"));
    std::fs::remove_file(shard(2)).unwrap();
    let torn = std::fs::read(shard(4)).unwrap();
    std::fs::write(shard(4), &torn[..torn.len() / 2]).unwrap();
    let altered = std::fs::read_to_string(shard(5)).unwrap();
    std::fs::write(shard(5), altered.replace("REF", "HT")).unwrap();
    std::fs::write(out.join("runs.csv"), "spoiled").unwrap();
    let first = AtomicU64::new(u64::MAX);
    let progress = |progress: Progress| {
        first.fetch_min(progress.done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    study.execute(&resumed(&out), &progress).unwrap();
    assert_eq!(first.into_inner(), 9, "the nine whole shards are kept");
    assert_eq!(contents(&out), before);
}

#[test]
fn a_study_interrupted_anywhere_and_resumed_leaves_the_bytes_of_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    for (attempt, calls) in [0, 3, 9].into_iter().enumerate() {
        let heard = AtomicU64::new(0);
        let progress = |_| match heard.fetch_add(1, Ordering::Relaxed) {
            n if n < calls => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        };
        let options = if attempt == 0 {
            into(&out)
        } else {
            resumed(&out)
        };
        let error = study.execute(&options, &progress).unwrap_err();
        let StudyError::Stopped { whole, shards: 12 } = error else {
            panic!("{error}");
        };
        // A run of 0.15 s reports three times: none is whole when the first report stops the
        // study, and of nine reports two threads spend at least three on one run.
        let as_stopped = [whole == 0, true, whole > 0];
        assert!(as_stopped[attempt], "{whole} shards after {calls} reports");
        assert!(!out.join("runs.csv").exists());
        let parts = contents(&out);
        let torn = parts
            .iter()
            .any(|(path, _)| path.extension().is_some_and(|end| end == "part"));
        assert!(!torn, "nothing half-written remains");
    }
    done(&study, &resumed(&out));
    assert_eq!(contents(&out), *WHOLE);
}

#[test]
fn three_shares_of_a_study_make_the_whole() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    for (share, missing) in [(1, 8), (2, 4), (3, 0)] {
        let options = Options {
            shard: Some((share, 3)),
            ..into(&out)
        };
        assert!(!out.join("runs.csv").exists());
        assert_eq!(done(&study, &options).missing_shards, missing);
        // Again without --resume would be to do it twice.
        let again = execute(&study, &options).unwrap_err();
        assert!(matches!(again, StudyError::NotEmpty { .. }), "{again}");
    }
    assert_eq!(contents(&out), *WHOLE);
    let fourth = Options {
        shard: Some((4, 3)),
        ..resumed(&out)
    };
    let message = execute(&study, &fourth).unwrap_err().to_string();
    assert_eq!(message, "share [-] must be in [1, 3], got 4");
}

#[test]
fn shares_that_run_at_the_same_time_make_the_whole() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    std::thread::scope(|scope| {
        for share in 1..=3 {
            let options = Options {
                shard: Some((share, 3)),
                jobs: NonZeroUsize::new(1),
                ..into(&out)
            };
            let study = &study;
            scope.spawn(move || done(study, &options));
        }
    });
    assert_eq!(contents(&out), *WHOLE);
}

#[test]
fn a_run_that_fails_is_reported_and_the_others_go_on() {
    let folder = TempDir::new().unwrap();
    let rest = "repeats = 1\nrandom_numbers = \"common\"\n[set]\nduration = 0.15\n\
                [[sweep]]\nkey = \"rig.single_wheel.load\"\nvalues = [100.0, 1e6, 50.0]\n";
    let study = study(&folder, &["single_wheel_st"], rest);
    let out = folder.path().join("out");
    let outcome = done(&study, &into(&out));
    assert_eq!((outcome.runs, outcome.failed.as_slice()), (3, &[1][..]));
    let report = std::fs::read_to_string(out.join("failed.txt")).unwrap();
    let start = "run 1 (single_wheel_st, rig.single_wheel.load = 1000000.0): ";
    assert!(report.starts_with(start), "{report}");
    assert!(report.contains("the ground does not carry"), "{report}");
    assert_eq!(report.lines().count(), 1);
    let forces = column(&out, "normal_force_mean_n");
    assert!(!forces[0].is_empty() && forces[1].is_empty() && !forces[2].is_empty());
}

#[test]
fn a_folder_that_holds_something_is_not_overwritten() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("thesis.txt"), "years of work").unwrap();
    let message = execute(&study, &into(&out)).unwrap_err().to_string();
    assert!(
        message.ends_with("(--resume) or name another folder (--out)"),
        "{message}"
    );
    let message = execute(&study, &resumed(&out)).unwrap_err().to_string();
    assert!(
        message.contains("does not belong to this study"),
        "{message}"
    );
    assert_eq!(contents(&out).len(), 1);
}

#[test]
fn the_results_of_another_seed_are_not_resumed() {
    let folder = TempDir::new().unwrap();
    let (mut study, out) = (short(&folder), folder.path().join("out"));
    let at_once = |_| ControlFlow::Break(());
    study.execute(&into(&out), &at_once).unwrap_err();
    study.seed.0 += 1;
    let error = execute(&study, &resumed(&out)).unwrap_err();
    assert!(matches!(error, StudyError::OtherStudy { .. }), "{error}");
}

/// Two windows of one second on rough stone and on sand at two speeds, and the reference at both.
fn recognised(folder: &TempDir) -> Study {
    let reference = here("scenarios/single_wheel_ref.toml");
    let rest = format!(
        "repeats = 2\nrandom_numbers = \"independent\"\n\
         [set]\nduration = 2.0\nwindow = 1.0\nlead_in = 0.5\nphysics_rate = 4000\n\
         rig.single_wheel.start_up = 0.1\n\
         [[sweep]]\nkey = \"rig.single_wheel.forward_speed\"\nvalues = [0.05, -0.08]\n\
         [recognition]\nreference = {reference:?}\n\
         baseline = {{ key = \"rig.single_wheel.forward_speed\" }}\n\
         [recognition.published]\nALCT = [58, 0, 0, 2]\nSLCT = [0, 118, 0, 2]\nLEIS = [0, 0, 116, 4]\n"
    );
    study(folder, &["single_wheel_ht", "single_wheel_st"], &rest)
}

#[test]
fn the_windows_of_a_recognised_study_have_truth_and_the_answers_of_both_methods() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (recognised(&folder), folder.path().join("out"));
    let score = done(&study, &into(&out)).scores.recognition.unwrap();
    assert_eq!(score.windows, 16);
    let cells = |name: &str| column_of(&out, "windows.csv", name);
    let by_ground = |cells: &[String], hard: &str, sand: &str| {
        let (on_stone, in_sand) = cells.split_at(8);
        on_stone.iter().all(|cell| cell == hard) && in_sand.iter().all(|cell| cell == sand)
    };
    assert!(by_ground(&cells("label_class"), "ALCT", "LEIS"));
    assert!(
        by_ground(&cells("truth"), "ALCT", "LEIS"),
        "{:?}",
        cells("truth")
    );
    for method in ["paper", "improved"] {
        let classes = cells(&format!("{method}_class"));
        let known = ["ALCT", "SLCT", "LEIS", "UWTIC"];
        assert!(classes.iter().all(|class| known.contains(&class.as_str())));
        assert!(
            cells(&format!("{method}_reason"))
                .iter()
                .all(|reason| !reason.is_empty())
        );
    }
    for number in ["p1", "p4", "lug_passes", "power_1", "power_12"] {
        let finite = cells(number)
            .iter()
            .all(|cell| cell.parse::<f64>().unwrap().is_finite());
        assert!(finite, "{number}");
    }
    // Stone rings a hundred times louder than sand, at both speeds.
    let known = score
        .scores
        .iter()
        .find(|score| score.method == "baseline_known");
    assert_eq!(known.unwrap().all.confusion.correct(), 16);
    let scores = Scores {
        recognition: Some(score),
        ..Scores::default()
    };
    let text = &texts(&scores)[0].text;
    assert!(
        text.contains("published 292 of 300, 97.3 % [94.8, 98.6]"),
        "{text}"
    );
    let records = records(&out, "recognition.csv");
    let published = records.iter().filter(|record| &record[0] == "published");
    assert_eq!(published.count(), 4, "three classes and all");
    assert!(out.join("reference.toml").exists());
}

#[test]
fn a_recognised_study_shared_torn_and_resumed_leaves_the_bytes_of_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let study = recognised(&folder);
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    done(&study, &into(&whole));
    for share in [2, 1] {
        let options = Options {
            shard: Some((share, 2)),
            jobs: NonZeroUsize::new(1),
            ..into(&parts)
        };
        done(&study, &options);
    }
    assert_eq!(contents(&parts), contents(&whole));
    // A shard is whole when the rows of both its tables are.
    std::fs::remove_file(parts.join("shards/00003.windows.csv")).unwrap();
    std::fs::remove_file(parts.join("shards/00005.runs.csv")).unwrap();
    let stopped = study.execute(&resumed(&parts), &|_| ControlFlow::Break(()));
    let Err(StudyError::Stopped { whole: kept, .. }) = stopped else {
        panic!("{stopped:?}");
    };
    assert_eq!(kept, 6);
    let outcome = done(&study, &resumed(&parts));
    assert!(outcome.scores.recognition.is_some());
    assert_eq!(contents(&parts), contents(&whole));
}

#[test]
fn without_reference_runs_features_are_taken_over_what_the_sensors_make_of_the_computed_one() {
    let p2 = |sensors: &str| {
        let folder = TempDir::new().unwrap();
        let rest = format!(
            "repeats = 1\nrandom_numbers = \"common\"\n\
             [set]\nduration = 1.0\nphysics_rate = 4000\nrig.single_wheel.start_up = 0.1\n\
             rig.single_wheel.forward_speed = 0.05\n{sensors}\n\
             [recognition]\nmethods = [\"paper\"]\n"
        );
        let out = folder.path().join("out");
        done(&study(&folder, &["single_wheel_ref"], &rest), &into(&out));
        column_of(&out, "windows.csv", "p2")[0]
            .parse::<f64>()
            .unwrap()
    };
    let half_gain = p2("sensors.accelerometer.acceleration_y.gain = 0.5");
    // Half the gain would be 0.3 decades; the computed reference loses it too, but for 0.01, as it
    // is cut into other windows there.
    assert!((p2("") - half_gain).abs() < 0.01, "{half_gain}");
}

#[test]
fn a_wheel_without_lugs_has_windows_whose_class_is_unknown_with_the_reason() {
    let folder = TempDir::new().unwrap();
    let rest = "repeats = 1\nrandom_numbers = \"common\"\n\
                [set]\nduration = 0.3\nphysics_rate = 4000\nwheel.lugs.count = 0\n[recognition]\n";
    let study = study(&folder, &["single_wheel_ref"], rest);
    let out = folder.path().join("out");
    let outcome = done(&study, &into(&out));
    assert_eq!(
        (
            outcome.failed.len(),
            outcome.scores.recognition.unwrap().windows
        ),
        (0, 1)
    );
    assert_eq!(column_of(&out, "windows.csv", "improved_class"), ["UWTIC"]);
    let reason = &column_of(&out, "windows.csv", "paper_reason")[0];
    assert!(reason.starts_with("the wheel has no lugs"), "{reason}");
}

#[test]
fn a_study_stopped_before_its_parameters_are_fitted_has_its_runs_whole_and_goes_on() {
    let folder = TempDir::new().unwrap();
    let rest = "repeats = 1\nrandom_numbers = \"common\"\n\
                [set]\nduration = 0.5\nphysics_rate = 4000\nrig.single_wheel.forward_speed = 0.05\n\
                [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.1, 0.3]\n\
                [identification]\n";
    let study = study(&folder, &["single_wheel_ref"], rest);
    let out = folder.path().join("out");
    study
        .execute_share(&into(&out), &|_| ControlFlow::Continue(()))
        .unwrap();
    let stopped = study.execute(&resumed(&out), &|_| ControlFlow::Break(()));
    let Err(StudyError::Stopped { whole, shards }) = stopped else {
        panic!("{stopped:?}");
    };
    assert_eq!(whole, shards);
    assert!(!out.join("identification.csv").exists());
    done(&study, &resumed(&out));
    assert!(out.join("identification.csv").exists());
}

/// Short runs at speeds and slips on stone and sand, identified.
fn identified(folder: &TempDir, scenarios: &[&str], rest: &str) -> (IdentificationScore, PathBuf) {
    let text = format!(
        "repeats = 1\nrandom_numbers = \"independent\"\n\
         [set]\nduration = 3.0\nlead_in = 1.0\nphysics_rate = 8000\n\
         sensors.vision.frame_rate = 50\n{rest}"
    );
    let out = folder.path().join("out");
    let outcome = done(&study(folder, scenarios, &text), &into(&out));
    assert_eq!(outcome.failed.len(), 0);
    (outcome.scores.identification.unwrap(), out)
}

#[test]
fn the_model_of_sand_fits_a_smooth_wheel_on_sand_as_table_7_does_and_that_of_stone_does_not() {
    let folder = TempDir::new().unwrap();
    let rest = "wheel.lugs.count = 0\nrig.single_wheel.forward_speed = 0.03\n\
                rig.single_wheel.carriage.stiffness = inf\nrig.single_wheel.motor.stiffness = inf\n\
                terrain.sand.soil.convention = \"triangular\"\n\
                [[sweep]]\nkey = \"rig.single_wheel.load\"\nvalues = [60.0, 150.0]\n\
                [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.0, 0.1, 0.2, 0.4]\n\
                [identification]\nexit_angle = -0.2\n\
                over = [\"rig.single_wheel.slip\", \"rig.single_wheel.load\"]\n";
    let (score, out) = identified(&folder, &["single_wheel_st"], rest);
    assert_eq!(records(&out, "steady.csv").len(), 8);
    let group = &score.groups[0];
    // Without lugs nothing strikes, and the class is the label's.
    assert_eq!((group.recognized, group.rows), (Wtic::Uwtic, 8));
    let (class, _) = group.parameters().unwrap();
    assert_eq!(class, Wtic::Leis);
    let errors = |class: Wtic| {
        let fit = group.fits.iter().find(|fit| fit.class == class).unwrap();
        fit.found().unwrap().fitted.force_error_percent
    };
    let (right, wrong) = (errors(Wtic::Leis), errors(Wtic::Alct));
    // Table 7 on sand; hard ground knows no sinkage, so no second load.
    assert!(right.load.unwrap() < 7.64, "{right:?}");
    assert!(right.driving_torque.unwrap() < 7.75, "{right:?}");
    assert!(wrong.load.unwrap() > 40.0, "{wrong:?}");
}

#[test]
fn parameters_from_one_speed_predict_the_others_and_those_of_one_ground_another() {
    let folder = TempDir::new().unwrap();
    let rest = "[[sweep]]\nkeys = [\"rig.single_wheel.forward_speed\", \"window\"]\n\
                rows = [[0.03, 3.0], [0.05, 2.0]]\n\
                [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.1, 0.2, 0.4]\n\
                [identification]\nfrom = { \"rig.single_wheel.forward_speed\" = 0.05 }\n";
    let (score, out) = identified(&folder, &["single_wheel_ref", "single_wheel_st"], rest);
    assert_eq!(score.groups.len(), 4);
    let places = score.predictions.iter().map(|p| &p.shared[0].1);
    // The window changes with the speed, and does not keep 0.03 m/s from being predicted.
    assert_eq!(places.collect::<Vec<_>>(), ["0.03", "0.03"]);
    let carried = score
        .carried
        .iter()
        .map(|c| (c.from.as_str(), c.to.as_str()));
    let [stone, sand] = ["single_wheel_ref", "single_wheel_st"];
    assert_eq!(carried.collect::<Vec<_>>(), [(stone, sand), (sand, stone)]);
    // Friction on stone does not change with speed.
    let errors = score.predictions[0].accuracy.force_error_percent;
    assert!(errors.drawbar_pull.unwrap() < 2.0, "{errors:?}");
    let kinds = column_of(&out, "identification.csv", "what");
    for kind in ["parameter", "fitted", "left_out", "predicted"] {
        assert!(kinds.iter().any(|what| what == kind), "{kind}");
    }
    assert!(out.join("identification.csv").exists());
}
