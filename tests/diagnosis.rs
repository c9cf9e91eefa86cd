//! From a measured campaign to simulated statistics: both sides are read alike, what is simulated is
//! kept.

use lugwheel::dataset::csv::Campaign;
use lugwheel::diagnosis::arm::Arm;
use lugwheel::diagnosis::bank::{Bank, BankError, Outcome, Progress, Request};
use lugwheel::diagnosis::candidate::candidates;
use lugwheel::diagnosis::condition::{Case, CaseError, Cases, Caveat, LONGEST, statistician};
use lugwheel::diagnosis::rigs::{Origin, Population, RigError, RigSet, Table};
use lugwheel::gap::{self, Cell, Comparison, Run, Statistic};
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::trace::{Channel, Mean, RunAttributes, Trace};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

const SEED: Seed = Seed(5);

fn scenario(name: &str) -> Scenario {
    let folder = env!("CARGO_MANIFEST_DIR");
    Scenario::load(format!("{folder}/scenarios/{name}.toml")).unwrap()
}

/// A second on sand, from when the wheel is set down.
fn short() -> Scenario {
    let short = ["duration=1.0", "lead_in=0.0", "physics_rate=8000"];
    scenario("quick").with_all(&short).unwrap()
}

/// What a rig would have written of run `run`.
fn measured(scenario: &Scenario, run: u64) -> Trace {
    let go_on = &mut |_| ControlFlow::Continue(());
    let mut trace = scenario.run(SEED, run, go_on).unwrap().as_kept();
    trace.truth = None;
    trace.attributes.physics_rate = None;
    trace
}

/// A measured wheel, load, speed and slip, and one channel of so many samples at a rate [Hz].
fn rig_run(samples: usize, rate: f64) -> Trace {
    Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load: 100.0,
            speed: 0.03,
            slip_ratio: 0.1,
            ..RunAttributes::default()
        },
        channels: vec![channel("drawbar_pull", samples, rate)],
        ..Trace::default()
    }
}

fn channel(name: &str, samples: usize, rate: f64) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: "N".to_owned(),
        sample_rate: rate,
        start: 0.0,
        samples: vec![1.0; samples],
    }
}

fn mean(name: &str) -> Mean {
    Mean {
        name: name.to_owned(),
        unit: "N".to_owned(),
        value: 20.0,
        sd: 1.0,
        n: 10,
    }
}

fn cases(scenario: &Scenario, measured: &[Trace]) -> Cases {
    Cases::of(scenario, measured, LONGEST).unwrap()
}

fn one_case(scenario: &Scenario, measured: Trace) -> Case {
    cases(scenario, &[measured]).cases.remove(0)
}

/// What is said of the runs, not of the scenario.
fn texts(cases: &Cases) -> Vec<String> {
    let of_scenario = |it: &&Caveat| matches!(it, Caveat::SetDown | Caveat::Noiseless);
    let caveats = cases.caveats.iter().filter(|it| !of_scenario(it));
    caveats.map(Caveat::to_string).collect()
}

fn refused(scenario: &Scenario, measured: &[Trace]) -> String {
    let error: CaseError = Cases::of(scenario, measured, LONGEST).unwrap_err();
    error.to_string()
}

fn request(arm: &str, stream: u64) -> Request {
    Request {
        arm: arm.parse().unwrap(),
        case: 0,
        stream,
    }
}

fn bank(folder: &Path, cases: Vec<Case>) -> Bank {
    Bank::open(folder, cases, SEED, "test 1").unwrap()
}

/// Answers, and the motions simulated for them.
fn ask(bank: &Bank, requests: &[Request]) -> (Vec<Outcome>, u64) {
    let most = Mutex::new(0);
    let answers = bank.readings(requests, &|progress: Progress| {
        let mut most = most.lock().unwrap();
        *most = progress.motions.max(*most);
        ControlFlow::Continue(())
    });
    (answers.unwrap(), most.into_inner().unwrap())
}

/// Answers as text: what is not a number is equal to itself there.
fn told(answers: &[Outcome]) -> String {
    format!("{answers:?}")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = paths
        .flat_map(|path| match path.is_dir() {
            true => files(&path),
            false => vec![path],
        })
        .collect();
    files.sort();
    files
}

fn few_requests() -> Vec<Request> {
    vec![
        request("as_shipped", 0),
        request("as_shipped", 1),
        request("soil_exponent~0.1", 0),
        request("slip_sinkage=0.8", 1),
    ]
}

#[test]
fn a_run_of_the_scenario_itself_is_read_as_its_replicate_bit_by_bit() {
    let scenario = short();
    let cases = cases(&scenario, &[measured(&scenario, 0)]);
    // The wheel still sinks: that is said of pull and torque, besides what is missing.
    let of_drift = |caveat: &Caveat| matches!(caveat, Caveat::NotSteady { .. });
    let (drifts, others): (Vec<_>, Vec<_>) = cases.caveats.iter().cloned().partition(of_drift);
    assert_eq!(others, [Caveat::SetDown, Caveat::Noiseless]);
    assert!(!drifts.is_empty());
    let case = cases.cases[0].clone();
    let folder = tempfile::tempdir().unwrap();
    let bank = bank(folder.path(), cases.cases);
    let requests = [request("", 0), request("", 1)];
    let (made, _) = ask(&bank, &requests);
    let mut statistician = statistician().unwrap();
    let real = requests.map(|request| {
        case.read_measured(&mut statistician, &measured(&scenario, bank.run(&request)))
    });
    for (real, made) in real.iter().zip(&made) {
        let made = made.as_ref().unwrap();
        assert!(real.readings.len() > 100);
        assert_eq!(real.readings, made.readings);
        // As text: what is not a number is equal to itself there.
        assert_eq!(format!("{:?}", real.loads), format!("{:?}", made.loads));
        assert_eq!(real.attributes.load, made.attributes.load);
    }
}

#[test]
fn what_a_bank_gives_stands_beside_what_was_measured_in_a_comparison() {
    let scenario = short();
    let runs = [measured(&scenario, 0), measured(&scenario, 1)];
    let cases = cases(&scenario, &runs);
    let real = cases.read(&mut statistician().unwrap(), &runs);
    let folder = tempfile::tempdir().unwrap();
    let bank = bank(folder.path(), cases.cases);
    let requests: Vec<Request> = (2..6).map(|stream| request("", stream)).collect();
    let (made, _) = ask(&bank, &requests);
    let made: Vec<Run> = made.into_iter().map(Result::unwrap).collect();
    let comparison = Comparison::new(&real, &made).unwrap();
    assert_eq!(comparison.caveats, [gap::Caveat::OneCondition]);
    let table = &comparison.tables[0];
    assert_eq!(table.condition, bank.cases()[0].condition);
    assert_eq!((table.measured.len(), table.simulated.len()), (2, 4));
    assert_eq!(table.cells.len(), real[0].readings.len());
}

#[test]
fn a_request_made_twice_is_answered_twice_and_simulated_once() {
    let case = one_case(&short(), rig_run(2000, 2000.0));
    let folder = tempfile::tempdir().unwrap();
    let requests = ["", "gain_error=0.1", ""].map(|arm| request(arm, 0));
    let (answers, motions) = ask(&bank(folder.path(), vec![case]), &requests);
    assert_eq!(
        (answers.len(), motions, files(folder.path()).len()),
        (3, 1, 2)
    );
    assert!(told(&answers[..1]) == told(&answers[2..]));
}

#[test]
fn what_is_in_the_bank_is_not_simulated_again_and_comes_back_bit_by_bit() {
    let folder = tempfile::tempdir().unwrap();
    let case = one_case(&short(), rig_run(2000, 2000.0));
    let requests = few_requests();
    let (first, motions) = ask(&bank(folder.path(), vec![case.clone()]), &requests);
    assert_eq!((files(folder.path()).len(), motions), (4, 4));
    let (second, motions) = ask(&bank(folder.path(), vec![case.clone()]), &requests);
    assert_eq!(motions, 0);
    assert!(told(&first) == told(&second));
    // Another program, seed or stream simulates anew.
    let other = Bank::open(folder.path(), vec![case.clone()], SEED, "test 2").unwrap();
    assert_eq!(ask(&other, &requests[..1]).1, 1);
    let other = Bank::open(folder.path(), vec![case.clone()], Seed(6), "test 1").unwrap();
    let (other, motions) = ask(&other, &requests[..1]);
    assert_eq!(motions, 1);
    assert!(told(&other) != told(&first[..1]));
    assert_eq!(
        ask(&bank(folder.path(), vec![case]), &[request("", 2)]).1,
        1
    );
}

#[test]
fn a_bank_that_was_stopped_goes_on_and_gives_what_it_would_have_given() {
    let case = one_case(&short(), rig_run(2000, 2000.0));
    let requests = few_requests();
    let whole = tempfile::tempdir().unwrap();
    let (expected, _) = ask(&bank(whole.path(), vec![case.clone()]), &requests);
    let folder = tempfile::tempdir().unwrap();
    let broken = bank(folder.path(), vec![case]);
    let stopped = broken.readings(&requests, &|progress| match progress.done {
        0 | 1 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    });
    let Err(BankError::Stopped { done, total: 4 }) = stopped else {
        panic!("it was not stopped");
    };
    assert!((2..4).contains(&done), "{done}");
    let (found, motions) = ask(&broken, &requests);
    assert_eq!(motions, 4 - done);
    assert!(told(&found) == told(&expected));
    let bytes = |folder: &Path| -> Vec<Vec<u8>> {
        let files = files(folder).into_iter();
        files.map(|file| fs::read(file).unwrap()).collect()
    };
    assert_eq!(bytes(folder.path()), bytes(whole.path()));
}

#[test]
fn a_flipped_byte_or_a_torn_file_is_found_and_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let case = one_case(&short(), rig_run(2000, 2000.0));
    let bank = bank(folder.path(), vec![case]);
    let requests = few_requests();
    let (expected, _) = ask(&bank, &requests);
    let files = files(folder.path());
    let whole = fs::read(&files[0]).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    fs::write(&files[0], flipped).unwrap();
    fs::write(&files[1], &fs::read(&files[1]).unwrap()[..300]).unwrap();
    let (found, motions) = ask(&bank, &requests);
    assert_eq!(motions, 2);
    assert!(told(&found) == told(&expected));
    assert_eq!(fs::read(&files[0]).unwrap(), whole);
}

#[test]
fn sensor_effects_share_one_motion_and_read_as_runs_of_their_own() {
    let case = one_case(&short(), measured(&short(), 3));
    let arms = [
        "as_shipped",
        "gain_error.drawbar_pull=0.1",
        "low_pass.normal_force=40.0:other",
        "clock_error=0.01 added_noise.acceleration_y=0.2",
    ];
    let requests = arms.map(|arm| request(arm, 0));
    let folder = tempfile::tempdir().unwrap();
    let (together, motions) = ask(&bank(folder.path(), vec![case.clone()]), &requests);
    assert_eq!(motions, 1);
    for (request, found) in requests.iter().zip(&together) {
        let folder = tempfile::tempdir().unwrap();
        let bank = bank(folder.path(), vec![case.clone()]);
        let (alone, motions) = ask(&bank, std::slice::from_ref(request));
        assert_eq!(motions, 1);
        assert!(
            told(&alone) == told(std::slice::from_ref(found)),
            "{}",
            request.arm
        );
    }
    assert!(together[0] != together[1]);
}

#[test]
fn a_stream_is_the_same_ground_and_noise_in_every_arm() {
    let case = one_case(&short(), measured(&short(), 0));
    let folder = tempfile::tempdir().unwrap();
    let bank = bank(folder.path(), vec![case]);
    let arms = ["as_shipped", "soil_friction_angle~0.5"];
    let requests: Vec<Request> = (0..4)
        .flat_map(|stream| arms.map(|arm| request(arm, stream)))
        .collect();
    let (answers, _) = ask(&bank, &requests);
    let cell = Cell::new("drawbar_pull", Statistic::SteadyMean);
    let pull = |place: usize| {
        answers[place]
            .as_ref()
            .unwrap()
            .readings
            .get(&cell)
            .unwrap()
            .value
    };
    let spread = |values: [f64; 4]| {
        let mean = values.iter().sum::<f64>() / 4.0;
        values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>()
    };
    let of_arm = spread([0, 2, 4, 6].map(pull));
    let of_difference = spread([0, 2, 4, 6].map(|base| pull(base + 1) - pull(base)));
    // Half a degree is a small change: its difference scatters by a tenth of the arms' or less.
    assert!(of_difference < 0.01 * of_arm, "{of_difference} of {of_arm}");
}

#[test]
fn a_run_that_fails_has_its_reason_for_an_answer_and_is_not_tried_again() {
    let mut heavy = rig_run(2000, 2000.0);
    heavy.attributes.load = 2.0e4;
    let case = one_case(&short(), heavy);
    let folder = tempfile::tempdir().unwrap();
    let bank = bank(folder.path(), vec![case]);
    let requests = [request("as_shipped", 0), request("soil_exponent~9.0", 0)];
    let (answers, motions) = ask(&bank, &requests);
    assert_eq!(motions, 1);
    let reasons = answers.iter().map(|answer| answer.as_ref().unwrap_err());
    let reasons: Vec<String> = reasons.map(ToString::to_string).collect();
    assert!(
        reasons[0].contains("the ground does not carry 20000 N"),
        "{reasons:?}"
    );
    assert!(reasons[1].contains("sinkage exponent"), "{reasons:?}");
    assert_eq!(ask(&bank, &requests).1, 0);
}

#[test]
fn another_wheel_is_refused_with_both_values_and_other_lugs_are_a_caveat() {
    let mut other = rig_run(2000, 2000.0);
    other.attributes.wheel_radius = 0.145;
    let message = refused(&short(), std::slice::from_ref(&other));
    assert!(
        message.starts_with("the measured wheel has a radius of 0.145 m, the scenario's 0.14 m"),
        "{message}"
    );
    let mut lugs = rig_run(2000, 2000.0);
    lugs.attributes.wheel_width = 0.152;
    lugs.attributes.lug_height = 0.01;
    let found = cases(&short(), &[other, lugs]);
    assert_eq!(found.cases.len(), 1);
    let texts = texts(&found);
    let caveat = "the measured wheel has 28 lugs of 10 mm, the scenario's 28 lugs of 15 mm";
    assert!(texts.iter().any(|text| text == caveat), "{texts:?}");
    assert!(
        texts
            .iter()
            .any(|text| text.starts_with("run 1 of those given is left out: the measured wheel"))
    );
}

#[test]
fn repeats_of_a_condition_are_one_case_as_long_as_the_shortest_that_did_not_break_off() {
    let mut second = rig_run(1900, 2000.0);
    second.attributes.load = 100.0 + 1.0e-7;
    second.attributes.repeat = 1;
    let mut faster = rig_run(2000, 2000.0);
    faster.attributes.speed = 0.02;
    let runs = [rig_run(2000, 2000.0), second, faster, rig_run(300, 2000.0)];
    let found = cases(&short(), &runs);
    let told = found.cases.iter();
    let told: Vec<_> = told
        .map(|case| (&case.runs[..], case.scenario.duration))
        .collect();
    assert_eq!(told, [(&[0, 1][..], 0.95), (&[2][..], 1.0)]);
    assert_eq!(found.cases[1].scenario.rig.drive().forward_speed, 0.02);
    assert_eq!(
        texts(&found),
        ["run 4 of those given is left out: it lasts 0.1 s, its repeats up to 1.0 s"]
    );
}

#[test]
fn sinkage_measured_as_fast_as_the_forces_is_simulated_so() {
    let mut real = rig_run(1000, 1000.0);
    real.channels.push(channel("sinkage", 2000, 2000.0));
    let case = cases(&short(), &[real]).cases.swap_remove(0);
    assert_eq!(case.scenario.sensors.vision.frame_rate, 2000.0);
    let trace = measured(&case.scenario, 0);
    assert_eq!(trace.channel("sinkage").unwrap().sample_rate, 2000.0);
}

#[test]
fn a_simulated_run_has_the_channels_rates_and_means_that_were_measured() {
    let mut real = rig_run(330, 333.0);
    real.channels.push(channel("sinkage", 25, 25.0));
    real.channels.push(channel("motor_current", 100, 100.0));
    real.means.push(mean("normal_force"));
    let found = cases(&short(), &[real]);
    assert_eq!(texts(&found), ["motor_current is not simulated"]);
    let case = &found.cases[0];
    // The next divisor of 128 000, and the camera's own frames.
    assert_eq!(case.scenario.sensors.output_rate.whole(), 400);
    assert_eq!(case.scenario.sensors.vision.frame_rate, 25.0);
    let trace = measured(&case.scenario, 0);
    let rng = &mut Seed(1).rng("reading", 0);
    let run = case.read_simulated(&mut statistician().unwrap(), &trace, rng);
    let channels: std::collections::BTreeSet<&str> = run
        .readings
        .iter()
        .map(|(cell, _)| &*cell.channel)
        .collect();
    let of_one = channels
        .into_iter()
        .filter(|channel| !channel.contains('~'));
    assert_eq!(
        of_one.collect::<Vec<_>>(),
        ["drawbar_pull", "normal_force", "sinkage"]
    );
    let deviation = |channel: &str| Cell::new(channel, Statistic::Deviation);
    assert!(run.readings.get(&deviation("drawbar_pull")).is_some());
    assert!(run.readings.get(&deviation("normal_force")).is_none());
}

#[test]
fn a_run_of_means_has_whole_lug_passes_and_a_wheels_width_of_track_in_its_middle() {
    let of_means = |speed: f64| {
        let mut real = rig_run(0, 2000.0);
        real.means = vec![mean("drawbar_pull")];
        real.attributes.speed = speed;
        one_case(&scenario("single_wheel_st"), real).scenario
    };
    for speed in [0.014, 0.2] {
        let scenario = of_means(speed);
        let turning = speed / (0.14 * (1.0 - 0.1));
        let passes = scenario.duration * turning * 28.0 / std::f64::consts::TAU;
        // Two times a whole number, so that the middle half holds a whole number.
        assert!(
            (0.5 * passes - (0.5 * passes).round()).abs() < 1e-9,
            "{passes}"
        );
        assert!(passes > 7.9 && scenario.duration * speed > 0.3);
    }
}

#[test]
fn a_wheel_that_spins_in_place_is_commanded_by_its_measured_angle() {
    let mut spinning = rig_run(2000, 2000.0);
    (spinning.attributes.slip_ratio, spinning.attributes.speed) = (1.0, 0.0);
    let message = refused(&short(), std::slice::from_ref(&spinning));
    assert!(
        message.contains("only a measured wheel_angle determines"),
        "{message}"
    );
    let mut angle = channel("wheel_angle", 2000, 2000.0);
    angle.samples = (0..2000).map(|k| 0.25 * f64::from(k) / 2000.0).collect();
    spinning.channels.push(angle);
    let case = one_case(&short(), spinning);
    let drive = *case.scenario.rig.drive();
    assert!((drive.wheel_speed.unwrap() - 0.25).abs() < 1e-12);
    assert_eq!((drive.slip, drive.forward_speed), (None, 0.0));
}

#[test]
fn a_run_under_no_load_is_repeated_with_the_wheel_lifted_as_high_as_it_was() {
    let lifted = |clearance: f64| {
        let edits = [
            "lead_in=0.5".to_owned(),
            format!("rig.single_wheel.lifted={clearance}"),
        ];
        measured(&short().with_all(&edits).unwrap(), 3)
    };
    for (clearance, repeated) in [(0.02, 0.02), (0.0205, 0.02), (0.05, 0.05)] {
        let run = lifted(clearance);
        assert_eq!(run.attributes.load, 0.0);
        let case = one_case(&short(), run);
        assert!(case.is_lifted());
        let own = case.scenario.rig.clearance();
        assert!((own - repeated).abs() < 0.0015, "{own} for {clearance}");
        assert_eq!(case.condition.as_str(), "ST, slip 0.1, lifted, 30 mm/s");
    }
    let other = one_case(&short(), measured(&short(), 3));
    assert_eq!(other.scenario.rig.clearance(), 0.0);
}

#[test]
fn a_wheel_lifted_over_stones_is_measured_higher_by_up_to_a_stone() {
    // The simulated wheel of 20 mm was measured 27 to 34 mm high over gravel of 50 mm, 68 to 73 mm over scattered stones.
    let clearance = |ground: &str, measured: f64| {
        let mut run = rig_run(2000, 2000.0);
        run.attributes.load = 0.0;
        let mut sinkage = channel("sinkage", 20, 10.0);
        sinkage.samples.fill(-0.015 - measured);
        run.channels.push(sinkage);
        let rig = one_case(&scenario(ground), run).scenario.rig;
        (1e3 * rig.clearance()).round()
    };
    assert_eq!(clearance("single_wheel_gt", 0.034), 20.0);
    assert_eq!(clearance("single_wheel_hgt", 0.073), 20.0);
    assert_eq!(clearance("single_wheel_ht", 0.034), 34.0);
    assert_eq!(clearance("single_wheel_gt", 0.08), 80.0);
    assert_eq!(clearance("single_wheel_gt", 0.01), 10.0);
}

#[test]
fn what_the_scenario_cannot_repeat_is_left_out_and_says_why() {
    let rover = scenario("rover_ht");
    let mut light = rig_run(2000, 2000.0);
    light.attributes.wheel_radius = 0.155;
    light.attributes.load = 30.0;
    let message = refused(&rover, &[light]);
    assert!(
        message.contains("must be above the wheel's own weight of 39.2 N"),
        "{message}"
    );
    let mut foreign = rig_run(2000, 2000.0);
    foreign.channels[0].name = "motor_current".to_owned();
    let message = refused(&rover, &[foreign]);
    assert!(
        message.contains("none of its channels is simulated: motor_current"),
        "{message}"
    );
    let mut unknown = rig_run(2000, 2000.0);
    unknown.attributes.slip_ratio = f64::NAN;
    let message = refused(&short(), &[unknown]);
    assert!(
        message.contains("its slip is not stated and no channel gives it"),
        "{message}"
    );
    assert_eq!(refused(&rover, &[]), "there are no measured runs");
}

#[test]
fn lugs_that_an_effect_puts_on_a_smooth_wheel_are_as_many_as_the_measured_one_has() {
    let smooth = short()
        .with("wheel.lugs={ count = 0, height = 0.01, thickness = 0.003 }")
        .unwrap();
    let case = one_case(&smooth, rig_run(2000, 2000.0));
    assert_eq!(case.scenario.wheel.lugs, None);
    let arm: Arm = "lug_action=0.006 short_lug=0.002".parse().unwrap();
    let lugs = arm
        .scenario(&case)
        .unwrap()
        .experiment()
        .unwrap()
        .wheel
        .lugs
        .unwrap();
    assert_eq!(
        (lugs.count, lugs.height, lugs.thickness),
        (28, 0.006, 0.003)
    );
}

#[test]
fn the_measured_points_of_ding_are_cases_of_a_scenario_with_their_wheel() {
    let file = format!(
        "{}/tests/data/ding2011/points.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let campaign = Campaign::load(file).unwrap();
    let runs: Vec<Trace> = campaign.runs().map(|run| run.unwrap().1).collect();
    let scenario = scenario("single_wheel_st")
        .with_all(&["wheel.radius=0.157", "wheel.width=0.165"])
        .unwrap();
    let found = cases(&scenario, &runs);
    assert!(found.cases.len() > 10);
    assert!(
        found
            .cases
            .iter()
            .all(|case| case.has("drawbar_pull") && !case.has("acceleration_y"))
    );
    let texts = texts(&found);
    let speed = "forward speed is not stated: taken from the scenario";
    assert!(texts.iter().any(|text| text == speed), "{texts:?}");
}

#[test]
fn every_smooth_wheel_among_the_data_has_a_scenario_that_can_repeat_it() {
    let sets = [
        ("ding2011", "points", 12),
        ("cmu-single-wheel", "smooth_wheel_runs", 27),
        ("chrono-scm", "means", 24),
    ];
    for (set, campaign, count) in sets {
        let folder = format!("{}/tests/data/{set}", env!("CARGO_MANIFEST_DIR"));
        let campaign = Campaign::load(format!("{folder}/{campaign}.toml")).unwrap();
        let runs: Vec<Trace> = campaign.runs().map(|run| run.unwrap().1).collect();
        let scenario = Scenario::load(format!("{folder}/smooth_wheel.toml")).unwrap();
        assert_eq!(scenario.wheel.lug_count(), 0, "{set}");
        let found = cases(&scenario, &runs);
        let repeated: usize = found.cases.iter().map(|case| case.runs.len()).sum();
        assert_eq!(repeated, count, "{set}: {:?}", texts(&found));
    }
}

#[test]
fn repeats_whose_load_was_measured_and_not_told_are_still_repeats() {
    let file = format!(
        "{}/tests/data/cmu-single-wheel/smooth_wheel_runs.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let campaign = Campaign::load(file).unwrap();
    let runs: Vec<Trace> = campaign.runs().map(|run| run.unwrap().1).collect();
    let smooth = [
        "wheel.radius=0.058",
        "wheel.width=0.05",
        "wheel.lugs.count=0",
    ];
    let scenario = scenario("single_wheel_st").with_all(&smooth).unwrap();
    let found = cases(&scenario, &runs);
    // Nine commanded slips, three trials each.
    let counts: Vec<usize> = found.cases.iter().map(|case| case.runs.len()).collect();
    assert_eq!(counts, [3; 9]);
    let load = found.cases[0].attributes.load;
    let measured = found.cases[0].runs.iter();
    let mean = measured.map(|run| runs[*run].steady_mean("normal_force").unwrap());
    assert!((load - mean.sum::<f64>() / 3.0).abs() < 1e-9);
    let real = found.read(&mut statistician().unwrap(), &runs);
    assert_eq!(real.len(), 27);
    assert!(real[..3].iter().all(|run| run.attributes.load == load));
}

/// Slips at which runs are repeated that were told a slip of 0.2 and had these, and what is to be kept in mind.
fn repeated<const N: usize>(measured: [f64; N]) -> (Vec<f64>, Vec<String>) {
    let runs = measured.map(|slip| {
        let measured = Mean {
            value: slip,
            ..mean("slip_ratio")
        };
        let mut trace = rig_run(0, 0.0);
        trace.attributes.slip_ratio = 0.2;
        trace.channels.clear();
        trace.means = vec![mean("drawbar_pull"), measured];
        trace
    });
    let found = cases(&scenario("single_wheel_st"), &runs);
    let slips = found.cases.iter().map(|case| case.attributes.slip_ratio);
    (slips.collect(), texts(&found))
}

#[test]
fn a_run_whose_slip_contradicts_its_label_is_repeated_at_the_slip_measured() {
    let (slips, texts) = repeated([0.2, 0.2002, 0.2311]);
    assert_eq!(slips, [0.2, 0.2311]);
    let text = "run 3 of those given ran at another slip than stated: the measured one is taken";
    assert!(texts.iter().any(|it| it == text), "{texts:?}");
}

/// Runs at slips of 0.2 as stated, of which a third differs by 0.05: its slip alternates by `swing` from second to second.
fn slips_of_a_run_that_swings(swing: f64) -> Vec<f64> {
    let runs = [0.0, 0.0, 0.05].map(|off| {
        let mut trace = rig_run(2000, 100.0);
        trace.attributes.slip_ratio = 0.2;
        let mut slip = channel("slip_ratio", 2000, 100.0);
        for (index, sample) in slip.samples.iter_mut().enumerate() {
            let side = if index / 100 % 2 == 0 { -1.0 } else { 1.0 };
            *sample = 0.2 + off + side * swing;
        }
        trace.channels.push(slip);
        trace
    });
    let found = cases(&scenario("single_wheel_st"), &runs);
    let slips = found.cases.iter().map(|case| case.attributes.slip_ratio);
    slips.map(|slip| (1e3 * slip).round() / 1e3).collect()
}

#[test]
fn a_slip_that_scatters_does_not_contradict_its_label() {
    // Batches of 1.25 s: a standard error of 0.008 with a swing of 0.05, of 0.034 with 0.2.
    assert_eq!(slips_of_a_run_that_swings(0.05), [0.2, 0.25]);
    assert_eq!(slips_of_a_run_that_swings(0.2), [0.2]);
}

#[test]
fn where_half_of_the_runs_contradict_their_slips_the_rig_is_at_fault_and_the_slips_stated_are_kept()
{
    assert_eq!(repeated([0.2, 0.2, 0.2502, 0.2511]).0, [0.2]);
    let (slips, texts) = repeated([0.2, 0.2502, 0.2511]);
    assert_eq!(slips, [0.2]);
    let half =
        |text: &String| text.starts_with("at least half of the runs ran at another slip than");
    assert!(texts.iter().any(half), "{texts:?}");
}

#[test]
fn effects_are_tried_that_can_be_on_this_ground_and_show_in_these_channels() {
    let tried = |name: &str, without: &[&str]| -> Vec<String> {
        let case = one_case(&scenario(name), rig_run(2000, 2000.0));
        let without: Vec<String> = without.iter().map(|name| (*name).to_owned()).collect();
        let candidates = candidates(&[case]).into_iter();
        let tried = candidates.filter(|it| it.is_none_of(&without));
        tried.map(|it| it.name()).collect()
    };
    let has = |tried: &[String], name: &str| tried.iter().any(|it| it == name);
    let sand = tried("single_wheel_st", &[]);
    assert!(has(&sand, "slip_sinkage") && has(&sand, "wheel_eccentricity"));
    assert!(!has(&sand, "dust_cover"));
    assert!(has(&sand, "gain_error.drawbar_pull") && !has(&sand, "gain_error.driving_torque"));
    assert!(has(&tried("single_wheel_ht", &[]), "dust_cover"));
    let fewer = tried(
        "single_wheel_st",
        &["slip_sinkage", "gain_error.drawbar_pull"],
    );
    assert_eq!(sand.len(), fewer.len() + 2);
}

/// Rigs of a second on flat hard ground with a few effects, in a folder.
fn rig_set(folder: &Path) -> RigSet {
    let hard = scenario("single_wheel_ref").with_all(&["physics_rate=8000"]);
    let case = one_case(&hard.unwrap(), rig_run(2000, 2000.0));
    let mut tried = candidates(std::slice::from_ref(&case));
    tried.retain(|it| ["gain_error", "short_lug"].contains(&it.effect.name));
    let origin = Origin {
        folder,
        version: "test 1",
        seed: SEED,
    };
    let trace = case
        .scenario
        .run(SEED, 0, &mut |_| ControlFlow::Continue(()));
    let nominal = case.read_simulated(
        &mut statistician().unwrap(),
        &trace.unwrap().as_kept(),
        &mut SEED.rng("test", 0),
    );
    let population = Population {
        columns: Population::columns(&[nominal]),
        cases: vec![case],
        candidates: tried,
        parameters: Vec::new(),
    };
    RigSet::open(population, origin).unwrap()
}

fn drawn(set: &RigSet, count: usize) -> Table {
    set.draw(count, &|_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn rigs_are_the_same_however_often_they_are_stopped_torn_or_altered() {
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let set = rig_set(folder.path());
    let whole = drawn(&set, 6);
    // What a statistic is not is not equal to itself.
    let text = |table: &Table| format!("{table:?}");
    assert_eq!(text(&drawn(&set, 6)), text(&whole));
    let file = files(folder.path()).swap_remove(2);
    let mut bytes = fs::read(&file).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&file, bytes).unwrap();
    assert_eq!(text(&drawn(&rig_set(folder.path()), 6)), text(&whole));
    let set = rig_set(other.path());
    let stopped = set.draw(6, &|now| match now.done {
        2.. => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert!(matches!(stopped, Err(RigError::Stopped { total: 6, .. })));
    assert_eq!(text(&drawn(&set, 6)), text(&whole));
}

#[test]
fn a_gain_moves_the_statistics_of_its_channel_by_as_much_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let set = rig_set(folder.path());
    let table = drawn(&set, 10);
    let gain = set
        .population
        .candidates
        .iter()
        .position(|it| it.effect.name == "gain_error");
    let mut compared = 0;
    for row in table.rows.iter().filter(|row| !row.randomised) {
        let [part] = row.effects[..] else { continue };
        let mut rows = table.rows.iter();
        let plain = rows.find(|it| it.rig == row.rig && it.effects.is_empty());
        let (Some(plain), true) = (plain, Some(part.candidate) == gain) else {
            continue;
        };
        let gain = 1.0 + set.population.candidates[part.candidate].magnitude(part.size);
        for (place, column) in table.columns.iter().enumerate() {
            let [with, without] = [row, plain].map(|row| f64::from(row.values[place]));
            match column.cell.to_string().as_str() {
                "drawbar_pull/load/mean" => {
                    compared += 1;
                    assert!((with / without - gain).abs() < 0.01, "{with} {without}");
                }
                name if !name.contains("drawbar_pull") => assert_eq!(with, without, "{name}"),
                _ => {}
            }
        }
    }
    assert!(compared > 10);
}
