//! Blind trials keep what they promise: nothing of the truth leaks, and nothing of it can be changed.

use crate::common::results::copy;
use lugwheel::challenge::{
    self, ChallengeError, Family, Manifest, Order, Question, Selection, Set, Truth, Unanswered,
};
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::effects::catalogue;
use lugwheel::quantity::Seed;
use sha2::{Digest, Sha256};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{LazyLock, Mutex};
use tempfile::TempDir;

/// Cases of the trial that the tests share.
const CASES: usize = 12;

/// Every set at least once; runs of 0.1 s, in which the wheel begins to move.
fn order(seed: u64) -> Order {
    Order {
        selection: Selection::all(),
        cases: Some(CASES),
        grounds: vec!["sand".to_owned()],
        duration: Some(0.1),
        without_detectability: false,
        seed: Seed(seed),
    }
}

fn make(folder: &Path, order: &Order) -> Result<challenge::Made, ChallengeError> {
    challenge::make(folder, order, &|_| (), &|_| ControlFlow::Continue(()))
}

static TRIAL: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let made = make(folder.path(), &order(0x5eed)).unwrap();
    assert_eq!(made.failed, []);
    folder
});

/// A trial of one's own to spoil.
fn trial() -> TempDir {
    let folder = TempDir::new().unwrap();
    copy(TRIAL.path(), folder.path());
    folder
}

fn manifest(folder: &Path) -> Manifest {
    let text = fs::read_to_string(folder.join("campaigns/manifest.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn truth_file(folder: &Path, case: &str) -> PathBuf {
    folder.join(format!("truth/{case}.json"))
}

fn truths(folder: &Path) -> Vec<Truth> {
    let manifest = manifest(folder);
    let cases = manifest.cases.iter();
    let open = |text: &str, seal: &str| Truth::open(text, seal).unwrap();
    cases
        .map(|it| {
            open(
                &fs::read_to_string(truth_file(folder, &it.case)).unwrap(),
                &it.seal,
            )
        })
        .collect()
}

fn contains(bytes: &[u8], sought: &[u8]) -> bool {
    bytes.windows(sought.len()).any(|window| window == sought)
}

/// A diagnosis that answers by the bytes it was given.
fn by_bytes(question: &Question) -> Result<String, Unanswered> {
    let mut hash = Sha256::new();
    for file in [&question.measured, &question.scenario] {
        hash.update(fs::read(file).unwrap());
    }
    for effect in question.without {
        hash.update(effect);
    }
    let share = f64::from(hash.finalize()[0]) / 255.0;
    Ok(format!(
        "{{\"verdict\": \"none\", \"probabilities\": {{\"none\": {share:?}}}}}\n"
    ))
}

fn answer_all(folder: &Path) -> challenge::Answered {
    challenge::answer(folder, &by_bytes, &|_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_campaign_file_says_nothing_of_its_truth() {
    let folder = TRIAL.path();
    let names = catalogue().map(|effect| effect.name);
    let texts = [
        "truth",
        "physics_rate",
        "duration",
        "noise_density",
        "0x5eed",
        "24301",
    ];
    let words: Vec<&str> = names.chain(texts).collect();
    for (posed, truth) in manifest(folder).cases.iter().zip(truths(folder)) {
        let bytes = fs::read(folder.join("campaigns").join(&posed.file)).unwrap();
        for word in &words {
            assert!(!contains(&bytes, word.as_bytes()), "{}: {word}", posed.file);
        }
        let seed = truth.seed.0;
        assert!(!contains(&bytes, seed.to_string().as_bytes()));
        assert!(!contains(&bytes, &seed.to_le_bytes()) && !contains(&bytes, &seed.to_be_bytes()));
        assert!(!contains(&bytes, truth.salt.as_bytes()));
        // A half is in every file; a slip of 0.1 and a width of 0.15 are no secrets.
        let is_common = |magnitude: f64| {
            let short = magnitude.to_bits().trailing_zeros() > 20;
            short || [0.1, 0.3, 0.02, 0.15, 0.14, 0.015].contains(&magnitude)
        };
        for hidden in truth.effects.iter().filter(|it| !is_common(it.magnitude)) {
            assert!(
                !contains(&bytes, &hidden.magnitude.to_le_bytes()),
                "{}",
                hidden.name
            );
        }
    }
}

#[test]
fn a_campaign_reads_like_a_measured_one_of_twelve_runs_as_commanded() {
    let folder = TRIAL.path();
    for posed in &manifest(folder).cases {
        let file = RunFile::open(folder.join("campaigns").join(&posed.file)).unwrap();
        assert_eq!(file.provenance().scenario, None);
        assert_eq!(file.provenance().seed, None);
        assert_eq!(file.runs().len(), 12);
        let mut lifted = 0;
        for id in file.runs() {
            let trace = file.read(id).unwrap();
            let told = &trace.attributes;
            assert!(trace.truth.is_none() && told.class.is_none() && told.physics_rate.is_none());
            assert_eq!((told.day.as_str(), told.notes.as_str()), ("", ""));
            assert!([0.1, 0.3].contains(&told.slip_ratio));
            assert!([0.0, 60.0, 100.0].contains(&told.load));
            lifted += u32::from(told.is_lifted());
            assert!([0.02, 0.1].contains(&told.speed) && [1, 2].contains(&told.repeat));
            assert_eq!((told.wheel_radius, told.lug_count), (0.14, Some(28)));
            assert!(trace.channel("drawbar_pull").is_some());
        }
        assert_eq!(lifted, 2, "one at each speed");
    }
}

#[test]
fn what_is_published_names_no_set_and_an_effect_only_where_the_diagnosis_is_to_do_without() {
    let folder = TRIAL.path();
    for (posed, truth) in manifest(folder).cases.iter().zip(truths(folder)) {
        let text = serde_json::to_string(posed).unwrap();
        let left_out = truth.set == Set::C3;
        assert_eq!(!posed.without.is_empty(), left_out);
        for effect in catalogue() {
            let is_named = text.contains(effect.name);
            assert_eq!(
                is_named,
                left_out && truth.effects[0].effect() == effect.name,
                "{text}"
            );
        }
        for set in Set::ALL {
            assert!(!text.contains(&format!("\"{set}\"")), "{text}");
        }
    }
    let scenario = fs::read_to_string(folder.join("campaigns/sand.toml")).unwrap();
    assert!(!scenario.contains("[[effect]]") && !scenario.contains("physics_rate"));
}

#[test]
fn a_trial_of_twelve_cases_has_every_set_and_seeds_of_its_family() {
    let truths = truths(TRIAL.path());
    assert_eq!(truths.len(), CASES);
    for truth in &truths {
        assert_eq!(Family::of(truth.seed), Some(Family::Scoring));
    }
    for set in Set::ALL {
        assert!(truths.iter().any(|truth| truth.set == set), "{set}");
    }
}

#[test]
fn every_effect_that_is_withheld_is_sealed_with_its_detectability_which_no_campaign_states() {
    let folder = TRIAL.path();
    for (posed, truth) in manifest(folder).cases.iter().zip(truths(folder)) {
        for hidden in &truth.effects {
            let known = hidden.detectability.expect("the effect can be simulated");
            let beside = hidden.detectability_beside_parameters.unwrap();
            assert!(known >= 0.0 && known.is_finite(), "{}", hidden.name);
            assert!(beside >= 0.0 && beside.is_finite(), "{}", hidden.name);
            let text = serde_json::to_string(posed).unwrap();
            assert!(!text.contains("detectability"), "{text}");
        }
    }
}

#[test]
fn a_trial_without_detectability_hides_the_same_causes_and_campaigns_and_takes_no_further_runs() {
    let folder = TempDir::new().unwrap();
    let order = Order {
        without_detectability: true,
        ..order(0x5eed)
    };
    let sizes = Mutex::new(Vec::new());
    let size = |seconds| sizes.lock().unwrap().push(seconds);
    let go_on = |_| ControlFlow::Continue(());
    let made = challenge::make(folder.path(), &order, &size, &go_on).unwrap();
    assert_eq!(made.failed, []);
    // Twelve cases of twelve runs of 0.1 s, each after a lead-in of 0.1 s.
    let expected = (CASES * 12) as f64 * 0.2;
    assert!((sizes.into_inner().unwrap()[0] - expected).abs() < 1e-6);
    assert!(!folder.path().join("truth/oracle_sand.bin").exists());
    let sealed = manifest(TRIAL.path());
    for (own, other) in made.manifest.cases.iter().zip(&sealed.cases) {
        assert_eq!(own.sha256, other.sha256, "{}", own.case);
    }
}

#[test]
fn a_trial_sealed_before_there_was_a_detectability_goes_on_and_is_scored() {
    let folder = trial();
    let mut older = manifest(folder.path());
    let mut cases = truths(folder.path());
    for (posed, truth) in older.cases.iter_mut().zip(&mut cases) {
        for hidden in &mut truth.effects {
            hidden.detectability = None;
            hidden.detectability_beside_parameters = None;
        }
        fs::write(truth_file(folder.path(), &posed.case), truth.text()).unwrap();
        let hash = Sha256::digest(truth.text());
        posed.seal = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    }
    let text = serde_json::to_string(&older).unwrap();
    fs::write(folder.path().join("campaigns/manifest.json"), text).unwrap();
    make(folder.path(), &order(0x5eed)).unwrap();
    assert_eq!(manifest(folder.path()), older);
    answer_all(folder.path());
    let scores = challenge::score(folder.path()).unwrap();
    assert_eq!(scores.detectability.own_form.headline.top1.n, 0);
    assert_eq!(scores.answered, CASES);
}

#[test]
fn a_trial_that_was_stopped_while_it_was_made_gets_the_same_bytes_and_what_is_there_stays() {
    let folder = TempDir::new().unwrap();
    let (total, simulated) = (Mutex::new(0.0), Mutex::new(0.0));
    // After the oracle, and about half of the cases.
    let stop = |step: f64| {
        let mut simulated = simulated.lock().unwrap();
        *simulated += step;
        if *simulated < 0.8 * *total.lock().unwrap() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    let size = |seconds: f64| *total.lock().unwrap() = seconds;
    let stopped = challenge::make(folder.path(), &order(0x5eed), &size, &stop).unwrap_err();
    assert!(
        matches!(stopped, ChallengeError::Stopped { .. }),
        "{stopped}"
    );
    let oracle = folder.path().join("truth/oracle_sand.bin");
    let of_oracle = fs::metadata(&oracle).unwrap().modified().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let again = pool
        .unwrap()
        .install(|| make(folder.path(), &order(0x5eed)));
    assert_eq!(
        fs::metadata(&oracle).unwrap().modified().unwrap(),
        of_oracle
    );
    assert_eq!(again.unwrap().manifest, manifest(TRIAL.path()));
    let again = folder;
    let bytes = |folder: &Path, name: &str| fs::read(folder.join("campaigns").join(name)).unwrap();
    for name in ["manifest.json", "case_0001.h5", "sand.toml"] {
        assert!(
            bytes(again.path(), name) == bytes(TRIAL.path(), name),
            "{name}"
        );
    }
    let campaign = again.path().join("campaigns/case_0001.h5");
    let before = fs::metadata(&campaign).unwrap().modified().unwrap();
    fs::remove_file(again.path().join("campaigns/case_0002.h5")).unwrap();
    make(again.path(), &order(0x5eed)).unwrap();
    assert_eq!(fs::metadata(&campaign).unwrap().modified().unwrap(), before);
    assert_eq!(manifest(again.path()), manifest(TRIAL.path()));
    assert_eq!(challenge::begun(again.path()).unwrap(), Some(Seed(0x5eed)));
}

#[test]
fn a_folder_of_something_else_is_left_alone() {
    let other = make(TRIAL.path(), &order(2)).unwrap_err();
    assert!(matches!(other, ChallengeError::OtherOrder(_)), "{other}");
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    let foreign = make(folder.path(), &order(1)).unwrap_err();
    assert!(matches!(foreign, ChallengeError::NotEmpty(_)), "{foreign}");
    let muddy = Order {
        grounds: vec!["mud".to_owned()],
        ..order(1)
    };
    assert!(
        make(folder.path(), &muddy)
            .unwrap_err()
            .to_string()
            .contains("no ground `mud`")
    );
}

#[test]
fn a_diagnosis_answers_the_same_whether_or_not_the_truth_is_there() {
    let (with, without) = (trial(), trial());
    fs::remove_dir_all(without.path().join("truth")).unwrap();
    answer_all(with.path());
    answer_all(without.path());
    for posed in &manifest(with.path()).cases {
        let name = format!("answers/{}.json", posed.case);
        let [a, b] = [&with, &without].map(|it| fs::read(it.path().join(&name)).unwrap());
        assert_eq!(a, b, "{name}");
    }
}

#[test]
fn an_altered_truth_is_refused() {
    let folder = trial();
    answer_all(folder.path());
    assert_eq!(challenge::score(folder.path()).unwrap().answered, CASES);
    let file = truth_file(folder.path(), "case_0001");
    let text = fs::read_to_string(&file).unwrap();
    for (from, to) in [
        ("\"set\": \"C", "\"set\":  \"C"),
        ("\"salt\": \"", "\"salt\": \"0"),
    ] {
        fs::write(&file, text.replace(from, to)).unwrap();
        let error = challenge::score(folder.path()).unwrap_err();
        assert!(matches!(error, ChallengeError::TruthAltered(ref case) if case == "case_0001"));
    }
    // Nor is that of another case.
    fs::copy(truth_file(folder.path(), "case_0002"), &file).unwrap();
    assert!(challenge::score(folder.path()).is_err());
}

#[test]
fn a_case_asked_without_other_effects_than_its_truth_leaves_out_is_not_scored() {
    let folder = trial();
    answer_all(folder.path());
    let mut manifest = manifest(folder.path());
    let asked = manifest.cases.iter_mut().find(|it| !it.without.is_empty());
    asked.unwrap().without.clear();
    let text = serde_json::to_string(&manifest).unwrap();
    fs::write(folder.path().join("campaigns/manifest.json"), text).unwrap();
    let error = challenge::score(folder.path()).unwrap_err();
    assert!(
        matches!(error, ChallengeError::QuestionAltered(_)),
        "{error}"
    );
}

#[test]
fn an_altered_campaign_is_neither_diagnosed_nor_scored() {
    for published in ["case_0003.h5", "sand.toml"] {
        let folder = trial();
        let file = folder.path().join("campaigns").join(published);
        let mut bytes = fs::read(&file).unwrap();
        *bytes.last_mut().unwrap() ^= 1;
        fs::write(&file, bytes).unwrap();
        let go_on = &|_: challenge::Progress| ControlFlow::Continue(());
        let asked = challenge::answer(folder.path(), &by_bytes, go_on).unwrap_err();
        assert!(matches!(asked, ChallengeError::CampaignAltered(ref path) if *path == file));
        let scored = challenge::score(folder.path()).unwrap_err();
        assert!(matches!(scored, ChallengeError::CampaignAltered(_)));
    }
}

#[test]
fn an_answered_case_is_not_asked_again_and_a_failed_one_is() {
    let folder = trial();
    let asked = AtomicUsize::new(0);
    let once = |question: &Question| {
        asked.fetch_add(1, Ordering::Relaxed);
        match question.case {
            "case_0002" => Err(Unanswered::Failed("out of memory".to_owned())),
            "case_0003" => Ok("no JSON".to_owned()),
            _ => by_bytes(question),
        }
    };
    let go_on = &|_: challenge::Progress| ControlFlow::Continue(());
    let first = challenge::answer(folder.path(), &once, go_on).unwrap();
    assert_eq!((first.answered, first.failed.len()), (CASES - 2, 2));
    let scores = challenge::score(folder.path()).unwrap();
    assert_eq!(
        (scores.answered, scores.failed, scores.unanswered),
        (CASES - 2, 2, 0)
    );
    asked.store(0, Ordering::Relaxed);
    challenge::answer(folder.path(), &once, go_on).unwrap();
    assert_eq!(asked.load(Ordering::Relaxed), 2);
}

#[test]
fn a_stopped_trial_goes_on_with_the_other_cases() {
    let folder = trial();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let stop_after_two = |now: challenge::Progress| match now.done {
        0 | 1 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let answer = || challenge::answer(folder.path(), &by_bytes, &stop_after_two);
    let stopped = pool.install(answer).unwrap_err();
    assert!(
        matches!(
            stopped,
            ChallengeError::Stopped {
                done: 2,
                total: CASES
            }
        ),
        "{stopped}"
    );
    assert_eq!(
        challenge::score(folder.path()).unwrap().unanswered,
        CASES - 2
    );
    assert_eq!(answer_all(folder.path()).answered, CASES);
    assert_eq!(challenge::score(folder.path()).unwrap().unanswered, 0);
}

#[test]
fn the_program_makes_a_trial_and_scores_it() {
    let folder = TempDir::new().unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lugwheel"));
        command
            .current_dir(folder.path())
            .arg("challenge")
            .args(arguments);
        command.output().unwrap()
    };
    let make = [
        "make", "--out", "t", "--set", "C0", "--cases", "1", "--ground", "hard",
    ];
    let made = run(&[&make[..], &["--duration", "0.1", "--json"]].concat());
    let said = String::from_utf8(made.stdout).unwrap();
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&said).unwrap()["cases"],
        1
    );
    let unanswered = run(&["score", "t"]);
    assert_eq!(unanswered.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&unanswered.stderr).contains("no campaign in t is diagnosed"));
    assert_eq!(answer_all(&folder.path().join("t")).answered, 1);
    let scored = run(&["score", "t", "--json"]);
    let scores: serde_json::Value = serde_json::from_slice(&scored.stdout).unwrap();
    assert_eq!(scores["unanswered"], 0);
    assert!(scores["C1"]["top1"]["value"].is_null());
    for figure in ["power", "detections", "reliability"] {
        let file = folder.path().join(format!("t/score/{figure}.svg"));
        assert!(file.exists(), "{figure}");
    }
    assert_eq!(
        run(&["make", "--out", "u", "--set", "C9"]).status.code(),
        Some(2)
    );
    fs::write(folder.path().join("t/truth/case_0001.json"), "{}").unwrap();
    assert_eq!(run(&["score", "t"]).status.code(), Some(3));
}
