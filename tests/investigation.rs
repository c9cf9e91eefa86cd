//! From measured runs and a scenario to an answer: short runs on flat hard ground, where few
//! parameters and effects are, so that the whole way is gone in seconds.

use lugwheel::diagnosis::inference::BaseRates;
use lugwheel::diagnosis::rigs::Origin;
use lugwheel::diagnosis::{
    Answer, Diagnosis, Investigation, InvestigationError, Progress, Settings,
};
use lugwheel::effects::names_but;
use lugwheel::gap::Colour;
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::trace::Trace;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{LazyLock, Mutex, PoisonError};
use tempfile::TempDir;

/// Effects that are tried; all others are held to be impossible.
const TRIED: [&str; 4] = ["gain_error", "bias_drift", "quantization", "added_noise"];

/// A second on slate, with the noise of a real sensor. Its summits are those of the
/// run: runs are loud or quiet in all statistics alike.
fn rig() -> Scenario {
    let folder = env!("CARGO_MANIFEST_DIR");
    let scenario = Scenario::load(format!("{folder}/scenarios/single_wheel_ht.toml")).unwrap();
    let edits = [
        "duration=1.0",
        "physics_rate=8000",
        // A second is less than a drive takes to wind up.
        "rig.single_wheel.carriage.stiffness=inf",
        "rig.single_wheel.motor.stiffness=inf",
        "sensors.accelerometer.acceleration_y.noise_density=4.9e-5",
        "sensors.force_torque.normal_force.noise_density=2.0e-3",
        "sensors.force_torque.drawbar_pull.noise_density=2.0e-3",
        "sensors.force_torque.driving_torque.noise_density=1.2e-4",
        "sensors.encoder.forward_speed.noise_density=1.0e-6",
    ];
    scenario.with_all(&edits).unwrap()
}

/// Three conditions, each measured twice, of a rig with these edits; other ground than the
/// simulations'.
fn measured(edits: &[&str]) -> Vec<Trace> {
    let conditions = [[0.1, 0.03], [0.3, 0.03], [0.1, 0.06]];
    let run = |number: usize| {
        let [slip, speed] = conditions[number % 3];
        let scenario = rig().with_all(edits).unwrap();
        let scenario = scenario
            .with_all(&[
                format!("rig.single_wheel.slip={slip}"),
                format!("rig.single_wheel.forward_speed={speed}"),
            ])
            .unwrap();
        let go_on = &mut |_| ControlFlow::Continue(());
        let mut trace = scenario
            .run(Seed(77), number as u64, go_on)
            .unwrap()
            .as_kept();
        trace.truth = None;
        trace.attributes.physics_rate = None;
        trace
    };
    (0..6).map(run).collect()
}

fn settings(tried: &[&str]) -> Settings {
    Settings {
        longest: 20.0,
        budget: 300.0,
        without: names_but(tried),
        seed: Seed(5),
        rates: BaseRates::default(),
        discrepancy: 0.0,
        ablation: None,
        without_next_run: false,
    }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Simulated once for all tests: they ask for much the same.
static BANK: LazyLock<(TempDir, Mutex<()>)> =
    LazyLock::new(|| (tempfile::tempdir().unwrap(), Mutex::new(())));

fn origin(folder: &Path) -> Origin<'_> {
    Origin {
        folder,
        version: "test 1",
        seed: Seed(5),
    }
}

fn diagnosed(runs: &[Trace], tried: &[&str]) -> Diagnosis {
    let settings = settings(tried);
    let (folder, turn) = &*BANK;
    let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
    let origin = origin(folder.path());
    let investigation = Investigation::new(runs, &rig(), &settings, origin).unwrap();
    investigation.run(&go_on).unwrap().0
}

fn refused(runs: &[Trace], settings: &Settings) -> InvestigationError {
    let folder = tempfile::tempdir().unwrap();
    let investigation = Investigation::new(runs, &rig(), settings, origin(folder.path()));
    match investigation {
        Err(error) => error,
        Ok(investigation) => investigation.run(&go_on).unwrap_err(),
    }
}

#[test]
fn a_wrong_gain_is_named_and_found_closes_some_of_the_gap_and_the_cache_gives_the_same_again() {
    let runs = measured(&["effect.gain_error.normal_force=0.08"]);
    let diagnosis = diagnosed(&runs, &TRIED);
    let verdict = &diagnosis.verdict;
    assert_eq!(
        verdict.verdict,
        Answer::Effect,
        "{:?}",
        verdict.probabilities
    );
    assert!(verdict.named[0].contains(&"gain_error.normal_force".to_owned()));
    let first = &verdict.effects[0];
    assert!((first.magnitude - 0.08).abs() < 0.02, "{first:?}");
    // How far is not known from a second on rough slate.
    let closed = diagnosis.closed.unwrap();
    assert!(closed.ci95[0] > 0.0, "{closed:?}");
    let gap = diagnosis.gap.unwrap();
    assert!(
        gap.with_effect < gap.recalibrated && gap.with_effect < gap.as_shipped,
        "{gap:?}"
    );
    // What is taken from the runs shows it: a load 8 % too high, as shipped and not with the gain.
    let load_error = |step: usize| {
        let step = &diagnosis.end_results[step];
        let mut means = step.means.iter();
        means.find(|it| it.channel == "normal_force").unwrap().error
    };
    assert!(
        load_error(2) < 0.3 * load_error(0),
        "{:?}",
        diagnosis.end_results
    );
    let again = diagnosed(&runs, &TRIED);
    let text = |diagnosis: &Diagnosis| serde_json::to_string(diagnosis).unwrap();
    assert_eq!(text(&diagnosis), text(&again));
}

#[test]
fn where_an_effect_is_held_to_be_impossible_no_other_is_named_and_the_map_shows_its_channel() {
    let runs = measured(&["effect.gain_error.normal_force=0.12"]);
    let diagnosis = diagnosed(&runs, &["quantization", "added_noise"]);
    let verdict = &diagnosis.verdict;
    let open = [Answer::Unknown, Answer::Undecided];
    assert!(
        open.contains(&verdict.verdict) && verdict.named.is_empty(),
        "{:?}",
        verdict.probabilities
    );
    let gaps = diagnosis
        .map
        .iter()
        .filter(|entry| entry.colour == Colour::Gap);
    let strongest = gaps.max_by(|a, b| a.z.abs().total_cmp(&b.z.abs())).unwrap();
    assert!(strongest.channel.contains("normal_force"), "{strongest:?}");
}

#[test]
fn where_nothing_is_wrong_no_effect_is_named() {
    let diagnosis = diagnosed(&measured(&[]), &TRIED);
    let verdict = &diagnosis.verdict;
    let calm = [Answer::None, Answer::Parameter, Answer::Undecided];
    assert!(
        calm.contains(&verdict.verdict),
        "{:?}",
        verdict.probabilities
    );
    assert!(
        verdict
            .effects
            .iter()
            .all(|suspect| suspect.probability < 0.5)
    );
}

#[test]
fn one_condition_measured_once_says_that_nothing_shows_how_the_gap_depends_on_it() {
    let runs = measured(&["effect.gain_error.normal_force=0.08"]);
    let diagnosis = diagnosed(&runs[..1], &TRIED);
    let caveats = diagnosis.caveats.join("; ");
    assert!(
        caveats.contains("one condition") && caveats.contains("measured twice"),
        "{caveats}"
    );
    assert!(diagnosis.closed.is_none_or(|closed| closed.clusters == 1));
}

#[test]
fn what_cannot_be_compared_is_refused_with_its_reason() {
    let runs = measured(&[]);
    let sound = settings(&TRIED);
    assert_eq!(
        refused(&[], &sound).to_string(),
        "there are no measured runs"
    );
    let mut foreign = runs[0].clone();
    for channel in &mut foreign.channels {
        channel.name = format!("my_{}", channel.name);
    }
    let message = refused(&[foreign], &sound).to_string();
    assert!(
        message.contains("none of its channels is simulated: my_"),
        "{message}"
    );
    let mut large = runs[0].clone();
    large.attributes.wheel_radius = 0.2;
    let message = refused(&[large], &sound).to_string();
    assert!(
        message.contains("radius of 0.2 m, the scenario's 0.14 m"),
        "{message}"
    );
    let without = Settings {
        without: vec!["slipsinkage".to_owned()],
        ..sound.clone()
    };
    let message = refused(&runs, &without).to_string();
    assert_eq!(
        message,
        "there is no effect `slipsinkage`; did you mean `slip_sinkage`, `clipping`, `aliasing`?"
    );
    let poor = Settings {
        budget: 1.0,
        ..sound
    };
    let message = refused(&runs, &poor).to_string();
    assert!(message.contains("1 s of driving are too few"), "{message}");
}
