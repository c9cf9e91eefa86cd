//! Where measured and simulated runs differ: statistics read what was put in, p-values are uniform
//! where nothing is wrong, and a difference is found where it is.

use lugwheel::dataset::csv::Campaign;
use lugwheel::features::Settings;
use lugwheel::features::reference::Reference;
use lugwheel::gap::{
    Caveat, Cell, Colour, Comparison, Domain, GapError, Margins, ParameterSpread, Reading,
    Readings, Run, Scores, Statistic, Statistician, closed, stages,
};
use lugwheel::identification::{Setting, SteadyLoad};
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::table_6;
use lugwheel::terrain::class::Wtic;
use lugwheel::trace::{Channel, RunAttributes, Trace};
use proptest::prelude::*;
use rand_distr::{Distribution, Normal};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

const RATE: f64 = 2000.0;
const SECONDS: f64 = 10.0;
/// Wheel speed [rad/s]: 2.2 turns, 62 lug passes.
const WHEEL_SPEED: f64 = 1.4;

fn statistician() -> Statistician {
    Statistician::new(Settings::default(), Reference::computed()).unwrap()
}

fn channel(name: &str, unit: &str, value: impl Fn(f64) -> f64) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        sample_rate: RATE,
        start: 0.0,
        samples: (0..(SECONDS * RATE) as u32)
            .map(|i| value(f64::from(i) / RATE))
            .collect(),
    }
}

fn angle(time: f64) -> f64 {
    0.3 + WHEEL_SPEED * time
}

/// Repeatable noise of unit variance, another for every `stream`.
fn noise(stream: u64) -> impl Fn(f64) -> f64 {
    let mut rng = Seed(stream).rng("noise", 0);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let samples: Vec<f64> = (0..(SECONDS * RATE) as usize)
        .map(|_| normal.sample(&mut rng))
        .collect();
    move |time| samples[(time * RATE).round() as usize]
}

fn trace(channels: Vec<Channel>) -> Trace {
    let mut channels = channels;
    channels.push(channel("wheel_angle", "rad", angle));
    Trace {
        attributes: RunAttributes {
            wheel_radius: 0.14,
            wheel_width: 0.15,
            lug_count: Some(28),
            lug_height: 0.015,
            load: 100.0,
            speed: 0.9 * 0.14 * WHEEL_SPEED,
            slip_ratio: 0.1,
            ..RunAttributes::default()
        },
        channels,
        ..Trace::default()
    }
}

fn value(readings: &Readings, channel: &str, statistic: Statistic) -> f64 {
    let cell = Cell::new(channel, statistic);
    readings
        .get(&cell)
        .unwrap_or_else(|| panic!("no {cell}"))
        .value
}

fn read(channels: Vec<Channel>) -> Readings {
    statistician().read(&trace(channels))
}

#[test]
fn a_wave_at_the_lug_order_reads_its_amplitude_and_its_two_parts() {
    let readings = read(vec![channel("normal_force", "N", |t| {
        100.0 + 5.0 * libm::cos(28.0 * angle(t) - 0.7)
    })]);
    let of = |statistic| value(&readings, "normal_force", statistic);
    // The window ends up to a sample from whole turns: 0.01 dB.
    assert!((of(Statistic::OrderLevel(28)) - 20.0 * libm::log10(5.0)).abs() < 0.01);
    assert!((of(Statistic::OrderCosine(28)) - 5.0 * libm::cos(0.7)).abs() < 0.02);
    assert!((of(Statistic::OrderSine(28)) - 5.0 * libm::sin(0.7)).abs() < 0.02);
    assert!(of(Statistic::OrderLevel(29)) < -20.0 && of(Statistic::OrderLevel(1)) < -20.0);
    // The effective value of the average over the pass, but for the width of its places.
    assert!((of(Statistic::LugAverage) - 20.0 * libm::log10(5.0 / 2_f64.sqrt())).abs() < 0.1);
    assert!(of(Statistic::LugResidue) < -5.0);
    assert!((of(Statistic::SteadyMean) - 100.0).abs() < 0.2);
}

#[test]
fn mains_hum_stands_out_of_its_third_of_an_octave_and_lies_on_no_order() {
    let noise = noise(1);
    let [quiet, humming] = [0.0, 0.3].map(|hum| {
        read(vec![channel("acceleration_y", "m/s^2", |t| {
            noise(t) + hum * libm::sin(TAU * 50.0 * t)
        })])
    });
    let change = |statistic| {
        let of = |readings| value(readings, "acceleration_y", statistic);
        of(&humming) - of(&quiet)
    };
    assert!(change(Statistic::Line(17)) > 10.0);
    assert!(change(Statistic::Band(20)).abs() < 0.1);
    assert!(change(Statistic::OrderLevel(28)).abs() < 1.0);
}

#[test]
fn a_torque_that_follows_the_force_by_5_ms_lags_by_5_ms_whatever_its_sign() {
    let wave = |t: f64| libm::sin(28.0 * angle(t)) + 0.5 * libm::sin(TAU * 3.3 * t);
    for sign in [1.0, -1.0] {
        let readings = read(vec![
            channel("normal_force", "N", |t| 100.0 + wave(t)),
            channel("driving_torque", "N m", |t| {
                4.0 + 0.1 * sign * wave(t - 0.005)
            }),
        ]);
        let lag = value(&readings, "normal_force~driving_torque", Statistic::Lag);
        assert!((lag - 0.005).abs() < 2e-4, "{lag}");
    }
}

#[test]
fn clipping_crowds_the_rails_and_quantisation_holds_samples() {
    let noise = noise(2);
    let plain = read(vec![channel("drawbar_pull", "N", &noise)]);
    let clipped = read(vec![channel("drawbar_pull", "N", |t| {
        noise(t).clamp(-1.5, 1.5)
    })]);
    let stepped = read(vec![channel("drawbar_pull", "N", |t| {
        (4.0 * noise(t)).round() / 4.0
    })]);
    let of = |readings: &Readings, statistic| value(readings, "drawbar_pull", statistic);
    // 13 % of normal samples lie beyond 1.5 standard deviations: -8.7 dB.
    assert!((of(&clipped, Statistic::Rails) + 8.7).abs() < 0.5);
    // Two or three samples of 16,000: the level's floor.
    assert!(of(&plain, Statistic::Rails) < -28.0);
    assert!((of(&stepped, Statistic::Step) - 20.0 * libm::log10(0.25)).abs() < 1e-6);
    assert!(of(&stepped, Statistic::Held) - of(&plain, Statistic::Held) > 15.0);
}

#[test]
fn a_force_that_grows_along_the_way_tells_drift_slope_and_growth() {
    let noise = noise(3);
    let speed = 0.9 * 0.14 * WHEEL_SPEED;
    let readings = read(vec![channel("normal_force", "N", |t| {
        100.0 + 2.0 * speed * t + (1.0 + 0.2 * t) * noise(t)
    })]);
    let of = |statistic| value(&readings, "normal_force", statistic);
    assert!((of(Statistic::PerMetre) - 2.0).abs() < 0.3);
    // Quarters of the settled 8 s lie 6 s apart.
    assert!((of(Statistic::Drift) - 12.0 * speed).abs() < 0.4);
    // Noise of the halves, 1.6 and 2.4 in the mean: 3.5 dB.
    assert!((of(Statistic::Growth) - 3.5).abs() < 0.5);
}

#[test]
fn a_smooth_wheel_has_no_lugs_to_lock_to_and_turns_all_the_same() {
    let mut run = trace(vec![channel("normal_force", "N", |t| {
        100.0 + libm::sin(angle(t)) + 0.1 * libm::sin(TAU * 7.0 * t)
    })]);
    run.attributes.lug_count = Some(0);
    run.attributes.lug_height = 0.0;
    let readings = statistician().read(&run);
    assert!(
        readings
            .iter()
            .all(|(cell, _)| cell.domain() != Domain::Lug)
    );
    assert!(value(&readings, "normal_force", Statistic::OrderLevel(1)).abs() < 0.1);
    assert!(
        readings
            .get(&Cell::new("normal_force", Statistic::OrderLevel(28)))
            .is_none()
    );
}

#[test]
fn runs_of_means_have_the_load_domain_only() {
    let campaign = Campaign::load("tests/data/ding2011/points.toml").unwrap();
    let mut statistician = statistician();
    for run in campaign.runs() {
        let (_, run) = run.unwrap();
        let readings = statistician.read(&run);
        assert!(!readings.is_empty());
        assert!(
            readings
                .iter()
                .all(|(cell, _)| cell.domain() == Domain::Load)
        );
    }
}

/// What a fault of the rig may put into a channel.
fn content() -> impl Strategy<Value = Vec<f64>> {
    let odd = prop_oneof![
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(0.0),
        Just(1.0e300),
        Just(-1.0e-300),
        -10.0..10.0_f64,
    ];
    prop_oneof![
        proptest::collection::vec(odd, 0..400),
        (0_usize..3000, -1.0e6..1.0e6_f64).prop_map(|(n, x)| vec![x; n]),
        (3_usize..3000, 0.0..2.0_f64, 1_usize..50).prop_map(|(n, top, gap)| {
            let wave = |i: usize| (libm::sin(0.1 * i as f64) * 3.0).min(top);
            (0..n)
                .map(|i| if i % 50 < gap { wave(i) } else { f64::NAN })
                .collect()
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn any_channel_content_leaves_finite_readings_or_none(
        acceleration in content(),
        force in content(),
        angle in content(),
        rate in prop_oneof![Just(0.0), Just(f64::NAN), 1.0..3000.0_f64],
        lugs in 0_u32..30,
    ) {
        let of = |name: &str, unit: &str, sample_rate, samples| Channel {
            name: name.to_owned(), unit: unit.to_owned(), sample_rate, start: 0.0, samples,
        };
        let mut run = trace(vec![]);
        run.attributes.lug_count = Some(lugs);
        run.channels = vec![
            of("acceleration_y", "m/s^2", 500.0, acceleration),
            of("normal_force", "N", rate, force),
            of("wheel_angle", "rad", 500.0, angle),
        ];
        let readings = statistician().read(&run);
        prop_assert!(readings.iter().all(|(_, r)| r.value.is_finite() && r.size.is_finite()));
    }
}

// Tests of the map on made-up readings: cells of three channels, four domains.

const CELLS: [Statistic; 8] = [
    Statistic::Deviation,
    Statistic::Crest,
    Statistic::OrderLevel(28),
    Statistic::OrderLevel(56),
    Statistic::Band(10),
    Statistic::Band(11),
    Statistic::SteadyMean,
    Statistic::PerLoad,
];

/// A run of normal readings at a slip, `shift` times their deviation added to one cell.
fn made_up(slip: f64, number: u64, seed: u64, shift: Option<(&Cell, f64)>) -> Run {
    let mut rng = Seed(seed).rng("made up", number);
    let normal = Normal::new(0.0, 1.0).unwrap();
    let channels = ["acceleration_y", "drawbar_pull", "normal_force"];
    let mut readings = Vec::new();
    for (place, name) in channels.iter().enumerate() {
        for (row, statistic) in CELLS.into_iter().enumerate() {
            let cell = Cell::new(*name, statistic);
            let spread = [0.5, 1.0, 2.0][(place + row) % 3];
            let moved = shift
                .filter(|(of, _)| **of == cell)
                .map_or(0.0, |(_, by)| by);
            let value = 50.0 + spread * (normal.sample(&mut rng) + moved);
            readings.push((cell, Reading { value, size: 50.0 }));
        }
    }
    Run {
        attributes: RunAttributes {
            slip_ratio: slip,
            load: 100.0,
            speed: 0.014,
            ..RunAttributes::default()
        },
        readings: Readings::from_iter(readings),
        loads: Vec::new(),
    }
}

/// Measured runs at three slips, `repeats` each, and eight replicates.
fn campaign(seed: u64, repeats: u64, shift: Option<(&Cell, f64)>) -> Comparison {
    let slips = [0.0, 0.1, 0.3];
    let runs =
        |numbers: std::ops::Range<u64>, seed: u64, shift: Option<(&Cell, f64)>| -> Vec<Run> {
            let at = |(place, slip): (usize, f64)| {
                let first = 1000 * place as u64;
                numbers
                    .clone()
                    .map(move |number| made_up(slip, first + number, seed, shift))
            };
            slips.into_iter().enumerate().flat_map(at).collect()
        };
    let measured = runs(100..100 + repeats, seed, shift);
    Comparison::new(&measured, &runs(0..8, seed, None)).unwrap()
}

/// Largest distance of an empirical distribution from the uniform one, times the root of its size:
/// Kolmogorov's statistic, above 1.63 in one of a hundred cases.
fn kolmogorov(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len() as f64;
    let off = sorted.iter().enumerate().map(|(i, p)| {
        (p - i as f64 / count)
            .abs()
            .max((p - (i as f64 + 1.0) / count).abs())
    });
    off.fold(0.0, f64::max) * count.sqrt()
}

fn map(comparison: &Comparison) -> lugwheel::gap::GapMap {
    comparison.map(&Margins::default(), &ParameterSpread::new(), Seed(1))
}

#[test]
fn p_values_of_normal_readings_are_uniform_where_nothing_is_wrong() {
    let mut p = Vec::new();
    for seed in 0..40 {
        let map = map(&campaign(seed, 1, None));
        // Curves are made of the same readings again.
        let own = map.entries.iter().filter(|e| e.domain != Domain::Curve);
        p.extend(own.map(|entry| entry.p));
    }
    assert_eq!(p.len(), 40 * 72);
    assert!(kolmogorov(&p) < 1.63, "{}", kolmogorov(&p));
}

#[test]
fn where_nothing_is_wrong_few_maps_show_a_gap_and_the_global_tests_are_uniform() {
    let maps: Vec<_> = (100..160)
        .map(|seed| map(&campaign(seed, 1, None)))
        .collect();
    let alarms = maps.iter().filter(|map| map.count(Colour::Gap) > 0).count();
    // 5 % of 60 are 3; 8 or more happen in one of a hundred cases.
    assert!(alarms < 8, "{alarms}");
    let energy: Vec<f64> = maps.iter().map(|map| map.global.energy.p).collect();
    let strongest: Vec<f64> = maps.iter().map(|map| map.global.strongest.p).collect();
    assert!(kolmogorov(&energy) < 1.63 && kolmogorov(&strongest) < 1.63);
}

#[test]
fn a_cell_that_is_off_by_ten_spreads_is_found_alone_and_named_by_the_global_test() {
    let off = Cell::new("drawbar_pull", Statistic::OrderLevel(28));
    let map = map(&campaign(7, 2, Some((&off, 10.0))));
    let gaps: Vec<_> = map
        .entries
        .iter()
        .filter(|e| e.colour == Colour::Gap)
        .collect();
    assert!(gaps.iter().all(|entry| entry.cell == off), "{gaps:?}");
    assert_eq!(gaps.len(), 3);
    assert_eq!(map.strongest()[0].cell, off);
    assert!(map.global.strongest.p < 0.01);
    assert_eq!(map.global.at, Some(off.clone()));
    assert_eq!(gaps[0].unit, "dB");
}

#[test]
fn within_the_margin_is_equivalent_and_a_wide_spread_decides_nothing() {
    let map = map(&campaign(3, 2, None));
    // 5 % of 50 are 2.5; spreads are 0.5, 1 and 2.
    let of = |channel: &str| {
        let cell = Cell::new(channel, Statistic::SteadyMean);
        map.entries
            .iter()
            .filter(|e| e.cell == cell)
            .map(|e| e.colour)
            .collect::<Vec<_>>()
    };
    assert_eq!(of("acceleration_y"), [Colour::Equivalent; 3]);
    assert_eq!(of("normal_force"), [Colour::Undecided; 3]);
}

#[test]
fn uncertain_parameters_take_the_surprise_out_of_a_difference() {
    let off = Cell::new("drawbar_pull", Statistic::SteadyMean);
    let comparison = campaign(5, 1, Some((&off, 10.0)));
    let mut spread = ParameterSpread::new();
    for table in &comparison.tables {
        spread
            .entry(table.condition.clone())
            .or_default()
            .insert(off.clone(), 20.0);
    }
    let strength = |spread: &ParameterSpread| {
        let map = comparison.map(&Margins::default(), spread, Seed(1));
        let of_cell = map.entries.iter().filter(|e| e.cell == off);
        of_cell.map(|e| e.z.abs()).fold(0.0, f64::max)
    };
    assert!(strength(&ParameterSpread::new()) > 5.0);
    assert!(strength(&spread) < 1.0);
}

#[test]
fn a_mean_that_grows_with_slip_only_in_the_measured_runs_bends_its_curve() {
    let mut measured = Vec::new();
    for (place, slip) in [0.0, 0.1, 0.3].into_iter().enumerate() {
        let off = Cell::new("drawbar_pull", Statistic::SteadyMean);
        let shift = (&off, 60.0 * slip);
        measured.push(made_up(slip, 1000 * place as u64 + 100, 11, Some(shift)));
    }
    let replicates: Vec<Run> = [0.0, 0.1, 0.3]
        .into_iter()
        .enumerate()
        .flat_map(|(place, slip)| {
            (0..8).map(move |i| made_up(slip, 1000 * place as u64 + i, 11, None))
        })
        .collect();
    let map = map(&Comparison::new(&measured, &replicates).unwrap());
    let slope = map
        .entries
        .iter()
        .find(|e| e.cell.to_string() == "drawbar_pull/curve/slip_slope")
        .unwrap();
    assert!(
        slope.condition.is_campaign() && slope.colour == Colour::Gap,
        "{slope:?}"
    );
}

#[test]
fn sides_without_a_common_condition_are_told_apart_by_name() {
    let replicates: Vec<Run> = (0..5).map(|i| made_up(0.1, i, 1, None)).collect();
    let error = Comparison::new(&[made_up(0.2, 9, 1, None)], &replicates).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, GapError::NoOverlap { .. }));
    assert!(
        message.contains("slip 0.2") && message.contains("slip 0.1"),
        "{message}"
    );
    assert!(
        message.contains("(5 runs), with acceleration_y, drawbar_pull"),
        "{message}"
    );
}

#[test]
fn one_condition_without_repeats_is_compared_with_both_caveats() {
    let replicates: Vec<Run> = (0..5).map(|i| made_up(0.1, i, 1, None)).collect();
    let comparison = Comparison::new(&[made_up(0.1, 9, 1, None)], &replicates).unwrap();
    assert_eq!(
        comparison.caveats,
        [Caveat::OneCondition, Caveat::NoRepeats]
    );
    let least = map(&comparison).global.least_p;
    assert!((least - 1.0 / 6.0).abs() < 1e-12);
}

// One number.

fn scores(slip: f64, [recalibrated, with_effect, floor]: [f64; 3]) -> Scores {
    let at = made_up(slip, 0, 0, None);
    let comparison = Comparison::new(
        std::slice::from_ref(&at),
        &[at.clone(), at.clone(), at.clone()],
    )
    .unwrap();
    Scores {
        condition: comparison.tables[0].condition.clone(),
        day: String::new(),
        recalibrated,
        with_effect,
        floor,
    }
}

#[test]
fn the_share_closed_has_an_interval_as_wide_as_conditions_disagree() {
    let slips = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
    let agreeing = slips.map(|slip| scores(slip, [3.0, 1.4, 1.0]));
    let closed_alike = closed(&agreeing, Seed(1)).unwrap();
    assert!((closed_alike.value - 0.8).abs() < 1e-12);
    assert!((closed_alike.ci95[1] - closed_alike.ci95[0]).abs() < 1e-9);
    assert_eq!(closed_alike.clusters, 6);
    let split = slips.map(|slip| scores(slip, [3.0, if slip < 0.25 { 1.0 } else { 2.6 }, 1.0]));
    let split = closed(&split, Seed(1)).unwrap();
    assert!((split.value - 0.6).abs() < 1e-12);
    assert!(split.ci95[0] < 0.4 && split.ci95[1] > 0.8, "{split:?}");
    assert!(closed(&[scores(0.1, [1.0, 0.5, 1.0])], Seed(1)).is_none());
}

// Stages.

/// Lugs that strike, and noise above the features' bandwidth.
fn striking(gain: f64, hiss: f64) -> Trace {
    let noise = noise(6);
    trace(vec![channel("acceleration_y", "m/s^2", |t| {
        let pass = 28.0 * angle(t) / TAU;
        let since = (pass - pass.floor()) * TAU / 28.0 / WHEEL_SPEED;
        gain * 3.0 * libm::exp(-since / 0.02) * libm::cos(TAU * 40.0 * since)
            + hiss * libm::sin(TAU * 600.0 * t)
            + 0.01 * noise(t)
    })])
}

#[test]
fn a_gain_comes_in_within_the_band_and_hiss_above_it_brings_nothing() {
    let settings = Settings::default();
    let reference = Reference::computed();
    let shares = |real: &Trace| {
        stages::vibration(real, &striking(1.0, 0.0), settings, &reference)
            .unwrap()
            .features
    };
    let gain = shares(&striking(2.0, 0.0));
    // The features' own low-pass falls gently: a part of the strikes above its corner counts too.
    assert!(gain.shares[1].share.unwrap() > 0.9, "{gain:?}");
    let sum: f64 = gain.shares.iter().map(|part| part.distance).sum();
    assert!((sum - gain.distance).abs() < 1e-9);
    let hiss = shares(&striking(1.0, 3.0));
    assert!(hiss.distance < 1e-3 * gain.distance, "{hiss:?}");
}

#[test]
fn a_torque_read_too_high_is_the_stage_that_moves_the_terrain() {
    let rim = Rim {
        radius: 0.155,
        width: 0.15,
    };
    let soil = table_6::sand();
    let row = |slip: f64| {
        let sinkage = 0.01 * (1.0 + 3.0 * slip);
        let loads = closed_form::loads(rim, &soil, sinkage, slip);
        SteadyLoad::new(slip, sinkage, loads)
    };
    let made: Vec<SteadyLoad> = [0.0, 0.1, 0.2, 0.3, 0.4, 0.6].map(row).to_vec();
    let real: Vec<SteadyLoad> = made
        .iter()
        .map(|row| SteadyLoad {
            driving_torque: 1.1 * row.driving_torque,
            ..*row
        })
        .collect();
    let stages = stages::loads(&real, &made, Wtic::Leis, &Setting::new(rim)).unwrap();
    assert!(stages.distance > 0.0);
    assert!(
        (stages.shares[4].share.unwrap() - 1.0).abs() < 1e-9,
        "{stages:?}"
    );
}

// The simulator's own runs.

/// Runs of a scenario, sensors as in a laboratory.
fn simulated(scenario: &Scenario, numbers: std::ops::Range<u64>) -> Vec<Run> {
    let mut statistician = statistician();
    numbers
        .map(|number| {
            let mut go_on = |_| ControlFlow::Continue(());
            let trace = scenario.run(Seed(5), number, &mut go_on).unwrap();
            Run::read(&mut statistician, &trace)
        })
        .collect()
}

/// A short run on sand; at this physics rate it takes half a second.
fn on_sand(edits: &[&str]) -> Scenario {
    let scenario = Scenario::load("scenarios/quick.toml").unwrap();
    scenario
        .with_all(&[&["physics_rate=8000"], edits].concat())
        .unwrap()
}

#[test]
fn replicates_hold_against_each_other_and_a_false_gain_and_hum_are_found_where_they_are() {
    let runs = simulated(&on_sand(&[]), 0..10);
    let (mut p, mut alarms) = (Vec::new(), 0);
    for place in 0..runs.len() {
        let mut others = runs.to_vec();
        let measured = others.remove(place);
        let map = map(&Comparison::new(&[measured], &others).unwrap());
        alarms += usize::from(map.count(Colour::Gap) > 0);
        // Cells in which runs cannot differ, as commanded speeds, have a p of 1.
        let varying = map.entries.iter().filter(|entry| entry.difference != 0.0);
        p.extend(varying.map(|entry| entry.p));
    }
    let below = p.iter().filter(|p| **p < 0.05).count() as f64 / p.len() as f64;
    // Cells of a run move together: ten runs tell 5 % to 4 %. Three alarms at 5 % are one in 87.
    assert!((0.01..0.09).contains(&below), "{below}");
    assert!(alarms < 3);

    let wrong = on_sand(&[
        "sensors.force_torque.normal_force.gain=1.2",
        "sensors.accelerometer.acceleration_y.hum=0.05",
    ]);
    let map = map(&Comparison::new(&simulated(&wrong, 20..22), &runs).unwrap());
    let entry = |cell: &str| {
        let found = map
            .entries
            .iter()
            .find(|entry| entry.cell.to_string() == cell);
        found.unwrap_or_else(|| panic!("no {cell}"))
    };
    let load = entry("normal_force/load/mean");
    assert_eq!(load.colour, Colour::Gap, "{load:?}");
    assert!((load.difference - 20.0).abs() < 1.0 && load.unit == "N");
    let hum = entry("acceleration_y/frequency/line_50hz");
    assert_eq!(hum.colour, Colour::Gap, "{hum:?}");
    let torque = entry("driving_torque/load/mean");
    assert_ne!(torque.colour, Colour::Gap, "{torque:?}");
}
