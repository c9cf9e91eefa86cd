//! A study's runs read as campaigns of a rig: as `diagnose` reads them, and to the same bytes however
//! they are computed.

use crate::common::results::{contents, copy, done, into, resumed};
use lugwheel::dataset::hdf5::RunFile;
use lugwheel::diagnosis::condition::LONGEST;
use lugwheel::diagnosis::inference::BaseRates;
use lugwheel::diagnosis::rigs::Origin;
use lugwheel::diagnosis::{Investigation, Settings};
use lugwheel::effects::names_but;
use lugwheel::report::study_page::texts;
use lugwheel::scenario::Scenario;
use lugwheel::study::diagnosis::score::{DiagnosisScore, Truth};
use lugwheel::study::{Options, Scores, Study, StudyError};
use lugwheel::trace::Trace;
use std::fs;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Effects left out to be fast: all but the gains of the channels.
fn left_out() -> Vec<String> {
    names_but(&["gain_error"])
}

/// Budget [s] that does for the fewest rigs of the short runs.
const ENOUGH: f64 = 120.0;

fn sand() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/single_wheel_st.toml")
}

/// A study of runs of a second on sand at two slips, of which some lugs pass.
fn study(folder: &TempDir, sweep: &str, budget: f64) -> Study {
    let text = format!(
        "version = 1\nscenarios = [{:?}]\nseed = 7\nrepeats = 2\nrandom_numbers = \"independent\"\n\
         [set]\nduration = 1.0\nphysics_rate = 4000\nrig.single_wheel.forward_speed = 0.2\n\
         rig.single_wheel.start_up = 0.05\n\
         [[sweep]]\n{sweep}\n\
         [[sweep]]\nkey = \"rig.single_wheel.slip\"\nvalues = [0.1, 0.4]\n\
         [dataset]\nkeep = \"traces\"\n\
         [diagnosis]\nbudget = {budget:?}\nwithout = {:?}\n",
        sand(),
        left_out()
    );
    let file = folder.path().join("study.toml");
    fs::write(&file, text).unwrap();
    Study::load(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// Two campaigns: nothing wrong, and a force that reads 20 % too high.
fn short(folder: &TempDir) -> Study {
    let sweep = "key = \"effect.gain_error.drawbar_pull\"\nvalues = [0.0, 0.2]";
    study(folder, sweep, ENOUGH)
}

/// What the short study leaves behind on two threads, at one go.
struct Whole {
    _folder: TempDir,
    out: PathBuf,
    score: DiagnosisScore,
}

static WHOLE: LazyLock<Whole> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("whole");
    let outcome = done(&short(&folder), &into(&out));
    assert!(outcome.failed.is_empty());
    Whole {
        _folder: folder,
        out,
        score: outcome.scores.diagnosis.unwrap(),
    }
});

#[test]
fn every_campaign_is_told_with_its_truth_and_its_row() {
    let campaigns = &WHOLE.score.campaigns;
    let truths: Vec<&Truth> = campaigns.iter().map(|it| &it.truth).collect();
    let gain = Truth::Effects(vec!["gain_error.drawbar_pull".to_owned()]);
    assert_eq!(truths, [&Truth::None, &gain]);
    for campaign in campaigns {
        let finding = campaign.finding().expect("the budget does");
        let sum: f64 = finding.probabilities.values().sum();
        // 1e-9: rounding of some dozen terms.
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        assert_eq!(campaign.result.runs, 4);
        assert!(!finding.effects.is_empty());
    }
    let mut reader = csv::Reader::from_path(WHOLE.out.join("diagnosis.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    assert_eq!(&header[2], "effect.gain_error.drawbar_pull");
    assert_eq!(reader.records().count(), 2);
    let text = text(&WHOLE.score);
    assert!(
        text.contains(" of 2 campaigns are diagnosed correctly."),
        "{text}"
    );
}

/// The result as text.
fn text(score: &DiagnosisScore) -> String {
    let scores = Scores {
        diagnosis: Some(score.clone()),
        ..Scores::default()
    };
    texts(&scores).remove(0).text
}

#[test]
fn a_campaign_is_answered_as_the_diagnosis_of_its_runs() {
    let file = RunFile::open(WHOLE.out.join("dataset.h5")).unwrap();
    let of_second = &file.runs()[4..8];
    let measured = of_second.iter().map(|id| Trace {
        truth: None,
        ..file.read(id).unwrap()
    });
    let measured: Vec<Trace> = measured.collect();
    let scenario = Scenario::load(sand()).unwrap();
    let scenario = scenario.with("physics_rate=4000").unwrap();
    let scenario = scenario.with("rig.single_wheel.start_up=0.05").unwrap();
    let settings = Settings {
        longest: LONGEST,
        budget: ENOUGH,
        without: left_out(),
        seed: lugwheel::quantity::Seed(7),
        rates: BaseRates::default(),
        discrepancy: 0.0,
        ablation: None,
        without_next_run: false,
    };
    let bank = WHOLE.out.join("bank");
    let kept = contents(&bank);
    let origin = Origin {
        folder: &bank,
        version: env!("CARGO_PKG_VERSION"),
        seed: settings.seed,
    };
    let investigation = Investigation::new(&measured, &scenario, &settings, origin).unwrap();
    let (diagnosis, _) = investigation.run(&|_| ControlFlow::Continue(())).unwrap();
    let finding = WHOLE.score.campaigns[1].finding().unwrap();
    assert_eq!(diagnosis.verdict.verdict, finding.verdict);
    assert_eq!(diagnosis.verdict.probabilities, finding.probabilities);
    assert!(contents(&bank) == kept, "the bank had all of it");
}

#[test]
fn campaigns_diagnosed_on_one_thread_leave_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("one");
    let alone = Options {
        jobs: NonZeroUsize::new(1),
        ..into(&out)
    };
    done(&short(&folder), &alone);
    assert!(contents(&out) == contents(&WHOLE.out));
}

#[test]
fn diagnoses_that_were_stopped_torn_or_altered_go_on_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    let stopped = study.execute(&into(&out), &|now| match now
        .diagnosing
        .is_some_and(|now| now.campaign == 1)
    {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    });
    let Err(StudyError::StoppedDiagnosing {
        answered,
        campaigns,
    }) = stopped
    else {
        panic!("{stopped:?}");
    };
    assert_eq!((answered, campaigns), (1, 2));
    let first = out.join("diagnoses/00000.toml");
    let altered = fs::read_to_string(&first).unwrap().replace("runs", "ruins");
    fs::write(&first, altered).unwrap();
    done(&study, &resumed(&out));
    assert!(contents(&out) == contents(&WHOLE.out));
}

#[test]
fn whoever_finds_all_shares_there_diagnoses_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let (study, out) = (short(&folder), folder.path().join("out"));
    let share = |number| Options {
        shard: Some((number, 2)),
        ..into(&out)
    };
    let first = done(&study, &share(1));
    assert!(first.missing_shards > 0 && first.scores.diagnosis.is_none());
    let nobody_stops = &|_| ControlFlow::Continue(());
    study.execute_share(&share(2), nobody_stops).unwrap();
    assert!(!out.join("diagnosis.csv").exists());
    copy(&WHOLE.out.join("bank"), &out.join("bank"));
    study.collect(&into(&out), nobody_stops).unwrap();
    assert!(contents(&out) == contents(&WHOLE.out));
}

#[test]
fn a_campaign_that_cannot_be_diagnosed_is_told_with_its_reason_and_does_not_stop_the_study() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let sweep = "key = \"wheel.radius\"\nvalues = [0.14, 0.2]";
    let outcome = done(&study(&folder, sweep, 1.0), &into(&out));
    let score = outcome.scores.diagnosis.unwrap();
    let reasons = score.campaigns.iter().map(|it| it.result.reason.clone());
    let reasons: Vec<String> = reasons.map(Option::unwrap).collect();
    assert!(
        reasons[0].starts_with("1 s of driving are too few"),
        "{reasons:?}"
    );
    assert!(
        reasons[1].starts_with("the measured wheel has a radius of 0.2 m"),
        "{reasons:?}"
    );
    assert_eq!(score.without_answer().count(), 2);
    let text = text(&score);
    assert!(reasons.iter().all(|reason| text.contains(reason)), "{text}");
}
