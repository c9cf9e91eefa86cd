//! Worlds with a known truth, and what the diagnosis promises in them.
//!
//! Statistics are normal with correlated noise; parameters act linearly and differently from
//! condition to condition; effects saturate a little. Effect 1 shows as effect 0 does, effect 2 as
//! the first parameter; all else is drawn.

mod bench;
mod world;

use super::fit::Fit;
use super::hypothesis::Hypothesis;
use super::kriging::Kriging;
use super::pins::Point;
use super::ranking::Ranking;
use super::*;
use crate::quantity::Seed;
use bench::{Bench, drawn, without};
use std::sync::LazyLock;
use world::{SMALL, Size, Truth, World, cell, grown, normal, pattern};

/// One of the small worlds.
static BENCH: LazyLock<Bench> = LazyLock::new(|| Bench::new(SMALL, 2, 1));

#[track_caller]
fn assert_answer(verdict: &Verdict, answer: Answer) {
    assert_eq!(verdict.verdict, answer, "{:?}", verdict.probabilities);
}

fn answers(verdict: &Verdict) -> bool {
    matches!(verdict.verdict, Answer::None | Answer::Parameter)
}

#[test]
fn an_effect_above_twice_its_detection_limit_is_named_and_its_magnitude_found() {
    let bench = &*BENCH;
    let screened = bench.screened();
    let (mut named, mut covered, mut count) = (0, 0, 0);
    // 0 and 1 are alike, 2 is absorbed.
    for (effect, screened) in screened.iter().enumerate().skip(3) {
        let magnitude = 2.2 * screened.detectable.unwrap();
        for seed in 0..3 {
            let verdict = bench.verdict(&Truth::effect(effect, magnitude), 30 + seed);
            let name = format!("e{effect}");
            let found = verdict.verdict == Answer::Effect && verdict.named == [[name.clone()]];
            named += usize::from(found);
            let [low, high] = verdict.effects[0].ci95;
            covered += usize::from(found && low <= magnitude && magnitude <= high);
            count += 1;
        }
    }
    // 6.6 deviations less the noise of one: nearly all; 95 % of 21 intervals, less two standard
    // errors and the rounding.
    assert!(named >= count - 1, "{named} of {count}");
    assert!(covered >= count - 4, "{covered} of {count}");
}

#[test]
fn two_collinear_effects_are_an_equivalence_set_with_half_the_probability_each() {
    let bench = &*BENCH;
    let mut sum = 0.0;
    for seed in 0..6 {
        let verdict = bench.verdict(&Truth::effect(0, 1.2), 60 + seed);
        assert_answer(&verdict, Answer::Effect);
        let mut set = verdict.named[0].clone();
        set.sort();
        assert_eq!(set, ["e0", "e1"]);
        let [a, b] = ["e0", "e1"].map(|name| verdict.probabilities[name]);
        sum += a / (a + b) / 6.0;
    }
    // The emulator knows them with different errors, so one measurement may lean either way.
    assert!((sum - 0.5).abs() < 0.25, "{sum}");
}

#[test]
fn a_gap_outside_all_signatures_is_unknown_and_located() {
    let bench = &*BENCH;
    let off = [(3, 6.0), (7, 5.0), (11, -5.0)];
    for seed in 0..4 {
        let truth = Truth {
            off: off.to_vec(),
            ..Truth::default()
        };
        let verdict = bench.verdict(&truth, 50 + seed);
        assert_answer(&verdict, Answer::Unknown);
        let places = off.map(|(place, _)| cell(place));
        let strongest = &verdict.located[..5];
        assert!(
            strongest
                .iter()
                .all(|located| places.contains(&located.cell)),
            "{strongest:?}"
        );
    }
}

#[test]
fn a_wrong_parameter_is_no_effect_even_where_an_effect_shows_alike() {
    let bench = &*BENCH;
    for place in 0..SMALL.parameters {
        for (seed, offset) in [2.0, -2.5, 1.5].into_iter().enumerate() {
            let verdict = bench.verdict(&Truth::parameter(place, offset), 80 + seed as u64);
            assert_answer(&verdict, Answer::Parameter);
            let told = verdict.shrinkage.unwrap();
            assert!(told.recalibrated < told.as_shipped, "{told:?}");
        }
    }
}

#[test]
fn where_nothing_is_wrong_none_or_parameter_is_answered_in_95_of_100_worlds() {
    let size = Size {
        conditions: 6,
        cells: 24,
        parameters: 2,
        effects: 6,
    };
    let mut right = 0;
    for world in 0..2 {
        let bench = Bench::new(size, 2, 20 + world);
        let mut rng = Seed(world).rng("truth", 0);
        for seed in 0..50 {
            // As many without any change as with parameters as their priors have them.
            let scale = f64::from(seed % 2);
            let offsets = (0..size.parameters)
                .map(|_| scale * normal(&mut rng))
                .collect();
            let truth = Truth {
                offsets,
                ..Truth::default()
            };
            right += usize::from(answers(
                &bench.verdict(&truth, 200 + u64::from(seed as u32)),
            ));
        }
    }
    assert!(right >= 95, "{right} of 100");
}

#[test]
#[ignore = "300 worlds take half a minute; cargo test --lib worlds -- --ignored"]
fn probabilities_are_calibrated_within_a_tenth_on_300_worlds() {
    let benches: Vec<Bench> = (0..3)
        .map(|seed| Bench::new(SMALL, 2, 100 + seed))
        .collect();
    let mut rng = Seed(3).rng("truth", 0);
    let mut bins = [[0.0; 3]; 5];
    for number in 0..300 {
        let bench = &benches[number % 3];
        let (name, truth) = drawn(bench, &mut rng);
        let verdict = bench.verdict(&truth, 5000 + number as u64);
        for (key, probability) in &verdict.probabilities {
            let bin = &mut bins[((5.0 * probability) as usize).min(4)];
            let hit = f64::from(u8::from(*key == name));
            for (sum, part) in bin.iter_mut().zip([1.0, *probability, hit]) {
                *sum += part;
            }
        }
    }
    for [count, told, hits] in bins {
        assert!((told / count - hits / count).abs() < 0.1, "{bins:?}");
    }
}

#[test]
fn one_condition_or_one_channel_or_no_repeats_never_give_a_confident_verdict() {
    let size = Size {
        conditions: 1,
        ..SMALL
    };
    let bench = Bench::new(size, 1, 4);
    for truth in [
        Truth::default(),
        Truth::effect(4, 6.0),
        Truth::parameter(0, 3.0),
    ] {
        let verdict = bench.verdict(&truth, 9);
        assert_answer(&verdict, Answer::Undecided);
        let told = verdict.probabilities.iter();
        let told = told.filter(|(name, _)| *name != "undecided");
        assert!(told.map(|(_, p)| p).sum::<f64>() < 0.5);
        assert!(
            verdict
                .reasons
                .iter()
                .any(|why| why.starts_with("one condition"))
        );
        assert!(
            verdict
                .reasons
                .iter()
                .any(|why| why.starts_with("no repeats"))
        );
    }
}

#[test]
fn what_repeats_scatter_among_themselves_is_no_unknown() {
    let bench = &*BENCH;
    for seed in 0..4 {
        let mut measured = bench.world.measured(&Truth::default(), 2, 40 + seed);
        for Measured { runs, .. } in &mut measured {
            let middle = product::middle(runs);
            for run in runs {
                let numbers = run.iter_mut().zip(&middle);
                numbers.for_each(|(number, middle)| *number += 3.0 * (*number - middle));
            }
        }
        let verdict = bench.verdict_on(&measured);
        assert_ne!(
            verdict.verdict,
            Answer::Unknown,
            "{:?}",
            verdict.probabilities
        );
    }
}

#[test]
fn an_effect_like_a_parameter_that_drifts_raises_that_alarm_and_one_like_a_parameter_none() {
    let mut world = World::new(SMALL, 1);
    for condition in 0..SMALL.conditions {
        let drift = condition as f64 - 0.5 * (SMALL.conditions - 1) as f64;
        let slope = &world.jacobian[condition][1];
        world.signatures[condition][3] = slope.iter().map(|x| drift * x).collect();
    }
    let library = world.library(1);
    let bench = Bench::of(world, library, 2, 1);
    let observation = bench.observe(&bench.world.measured(&Truth::default(), 2, 7));
    let told = screen(bench.problem(&observation));
    // Effect 2 is the first parameter by another name: nothing is left to betray it.
    assert!(told[2].absorbed > 0.8 && told[2].alarm.is_none());
    let alarm = told[3].alarm.as_ref().unwrap();
    assert_eq!(
        (&*alarm.parameter, alarm.what),
        ("p1", Suspicion::DriftsWithSlip)
    );
}

#[test]
fn what_the_simulator_refutes_is_not_named() {
    let bench = Bench::new(SMALL, 2, 1);
    let named = bench.verdict(&Truth::effect(5, 2.0), 3);
    assert_eq!(named.named, [["e5"]]);
    assert_eq!(named.clone().tried([1.5, 1.1], 0.4), named);
    let refuted = named.tried([1.1, 1.5], 0.4);
    assert_eq!(refuted.verdict, Answer::Undecided);
    assert!(refuted.named.is_empty() && refuted.effects[0].probability < 0.5);
    let sum: f64 = refuted.probabilities.values().sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
}

#[test]
fn no_cause_is_answered_where_recalibration_simulated_leaves_no_more_than_the_floor() {
    let bench = Bench::new(SMALL, 2, 1);
    let effect = bench.verdict(&Truth::effect(5, 2.0), 3);
    assert_eq!(effect.named, [["e5"]]);
    let off = Truth {
        off: vec![(3, 6.0), (7, 5.0), (11, -5.0)],
        ..Truth::default()
    };
    let unknown = bench.verdict(&off, 50);
    assert_answer(&unknown, Answer::Unknown);
    let calibration = |beyond_floor| Calibration {
        beyond_floor,
        ..Calibration::default()
    };
    let [strict, lax] = [f64::INFINITY, f64::NEG_INFINITY].map(calibration);
    for cause in [effect, unknown] {
        let floor = cause.shrinkage.as_ref().unwrap().floor;
        assert_eq!(cause.clone().recalibrated(1.5 * floor, &strict), cause);
        assert_eq!(cause.clone().recalibrated(floor, &lax), cause);
        let cleared = cause.recalibrated(floor, &strict);
        assert_answer(&cleared, Answer::Parameter);
        assert!(cleared.named.is_empty() && cleared.probabilities["parameter"] > 0.5);
        let sum: f64 = cleared.probabilities.values().sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    }
    // Where no parameter may move, nothing is off.
    let mut fixed = bench.verdict(&Truth::effect(5, 2.0), 3);
    fixed.recalibration.clear();
    let floor = fixed.shrinkage.as_ref().unwrap().floor;
    assert_answer(&fixed.recalibrated(floor, &strict), Answer::None);
}

#[test]
fn parameters_are_not_answered_where_recalibration_fails_its_check() {
    let bench = Bench::new(SMALL, 2, 1);
    let Calibration {
        failed, left_over, ..
    } = bench.calibration;
    let mut rng = Seed(11).rng("truths", 0);
    for seed in 0..40 {
        let (_, truth) = drawn(&bench, &mut rng);
        let verdict = bench.verdict(&truth, seed);
        if verdict.verdict != Answer::Parameter {
            continue;
        }
        let told = |name: &str| {
            let mut all = verdict.explanations.iter();
            all.find(|it| it.name == name).unwrap()
        };
        let [left, all] = ["parameter", "none"].map(|name| told(name).excess.unwrap());
        assert!(told("parameter").p.unwrap() >= failed || left < left_over * all);
    }
}

#[test]
fn a_fit_says_more_of_what_it_has_seen_than_of_what_it_has_not() {
    let mut bench = Bench::new(SMALL, 2, 1);
    let measured = bench.world.measured(&Truth::effect(2, 1.0), 2, 3);
    let density = |bench: &Bench| -> f64 {
        let observation = bench.observe(&measured);
        let fit = Fit::new(bench.problem(&observation), Hypothesis::Effects(vec![2]));
        fit.held_out.iter().map(|it| it.log_density).sum()
    };
    let unseen = density(&bench);
    Ablation::HeldOut.of_calibration(&mut bench.calibration);
    assert!(density(&bench) > unseen);
}

#[test]
fn a_run_that_went_astray_is_nothing_that_the_right_effect_leaves() {
    let bench = &*BENCH;
    let truth = Truth::effect(5, 6.0 * bench.screened()[5].detectable.unwrap());
    let mut measured = bench.world.measured(&truth, 2, 71);
    for number in &mut measured[2].runs[0] {
        *number += 30.0;
    }
    let observation = bench.observe(&measured);
    let left = |hypothesis| Fit::new(bench.problem(&observation), hypothesis).left;
    let [recalibrated, with_effect] =
        [Hypothesis::Parameter, Hypothesis::Effects(vec![5])].map(left);
    assert!(
        with_effect < bench.calibration.left_over * recalibrated,
        "{with_effect} of {recalibrated}"
    );
}

#[test]
fn parameters_that_do_more_together_are_found_once_the_fits_were_simulated() {
    let bench = Bench::entangled(1);
    let truth = Truth {
        offsets: vec![1.5, -1.5, 0.0],
        ..Truth::default()
    };
    let farthest = |verdict: &Verdict| {
        let found = verdict.recalibration.iter().zip(&truth.offsets);
        found.fold(0.0, |most: f64, (it, told)| {
            most.max((it.offset - told).abs())
        })
    };
    for seed in 0..4 {
        let [added, pinned] = [bench.verdict(&truth, seed), bench.pinned(&truth, seed)];
        assert_eq!(
            pinned.verdict,
            Answer::Parameter,
            "{:?}",
            pinned.probabilities
        );
        assert_ne!(
            added.verdict,
            Answer::Parameter,
            "{:?}",
            added.probabilities
        );
        for (it, told) in pinned.recalibration.iter().zip(&truth.offsets) {
            assert!((it.offset - told).abs() < 2.5 * it.deviation, "{it:?}");
        }
        assert!(farthest(&added) > 0.2, "{:?}", added.recalibration);
        assert!(
            farthest(&pinned) < farthest(&added),
            "{:?}",
            added.recalibration
        );
    }
}

#[test]
fn the_slope_of_a_defect_is_how_its_weights_change_along_a_parameter() {
    let emulator = &BENCH.emulator;
    let at = |a: f64, b: f64| Point {
        offsets: vec![a, b, 0.0],
        effects: Vec::new(),
    };
    let known = [at(0.0, 0.0), at(1.1, 0.3), at(1.6, 0.3), at(1.1, -0.2)];
    let kriging = Kriging::new(emulator, known.iter().collect());
    let [weights, lower, upper] =
        [0.9, 0.9 - 1.0e-4, 0.9 + 1.0e-4].map(|a| kriging.weights(&at(a, 0.1)).0);
    assert!(weights.iter().sum::<f64>() > 0.9);
    let slopes = kriging.slope(&at(0.9, 0.1), 0);
    for (slope, (lower, upper)) in slopes.iter().zip(lower.iter().zip(&upper)) {
        assert!((slope - (upper - lower) / 2.0e-4).abs() < 1.0e-6);
    }
}

#[test]
fn recalibration_finds_its_way_where_slopes_are_not_those_of_the_middle() {
    let world = World::cubic(SMALL, 3);
    let library = world.library(3);
    let bench = Bench::of(world, library, 2, 3);
    let truth = Truth {
        offsets: vec![2.2, -0.4, 0.0],
        ..Truth::default()
    };
    for seed in 0..4 {
        let verdict = bench.pinned(&truth, seed);
        assert_answer(&verdict, Answer::Parameter);
        let found = verdict.recalibration[0].offset;
        assert!((found - 2.2).abs() < 0.1, "{:?}", verdict.recalibration);
    }
}

#[test]
fn a_strong_effect_whose_law_is_not_quite_the_librarys_is_named_alone() {
    let bench = Bench::new(SMALL, 2, 1);
    for seed in 0..6 {
        let effect = 4 + seed as usize;
        let measured = bench.world.in_another_form(effect, 5.0, 0.3, seed);
        let verdict = bench.verdict_on(&measured);
        assert_eq!(verdict.named, [[format!("e{effect}")]], "{seed}");
    }
}

#[test]
fn a_second_effect_is_named_beside_a_first_as_loud_of_the_librarys_law() {
    let bench = Bench::new(SMALL, 2, 1);
    let named = |seed: u64| {
        let [a, b] = [seed as usize, 4 + seed as usize];
        let mut truth = Truth::effect(a, 4.0);
        truth.effects.extend(Truth::effect(b, 4.0).effects);
        let measured = bench.world.measured(&truth, 2, seed);
        bench.verdict_on(&measured).named.len()
    };
    let found = (0..6).filter(|seed| named(*seed) == 2).count();
    assert!(found >= 5, "{found}");
}

#[test]
fn an_effect_is_simulated_where_recalibration_was_if_its_fit_ends_near_and_else_where_that_ends() {
    let bench = Bench::entangled(2);
    let mut emulator = Emulator::new(&bench.library).unwrap();
    let at = |offsets: [f64; 3], effects: &[(usize, f64)]| Point {
        offsets: offsets.to_vec(),
        effects: effects.to_vec(),
    };
    emulator.pins.push(at([0.5, -0.2, 0.0], &[]));
    let near = emulator.beside_pin(&at([0.55, -0.3, 0.1], &[(5, 1.0)]));
    assert_eq!(near, at([0.5, -0.2, 0.0], &[(5, 1.0)]));
    let far = at([0.5, -0.2, 0.2], &[(5, 1.0)]);
    assert_eq!(emulator.beside_pin(&far), far);
}

#[test]
fn an_effect_and_its_magnitude_are_found_beside_parameters_that_do_more_together() {
    let bench = Bench::entangled(2);
    let truth = Truth {
        offsets: vec![1.2, 1.2, 0.0],
        effects: vec![(5, 1.4)],
        ..Truth::default()
    };
    let mut held = 0;
    for seed in 0..8 {
        let verdict = bench.pinned(&truth, seed);
        assert_eq!(verdict.named, [["e5"]], "{:?}", verdict.probabilities);
        let [low, high] = verdict.effects[0].ci95;
        assert!(high - low < 1.2, "{low} {high}");
        held += usize::from(low < 1.4 && 1.4 < high);
    }
    // Of eight 95 % intervals two miss in one of twenty tries.
    assert!(held >= 6, "{held} of 8");
}

#[test]
fn the_effect_that_fits_best_is_simulated_once_however_it_foretells() {
    let bench = Bench::new(SMALL, 2, 1);
    let mut emulator = Emulator::new(&bench.library).unwrap();
    let unseen = |emulator: &Emulator, truth: &Truth| {
        let observation = bench.observe(&bench.world.measured(truth, 2, 7));
        let fits = ranking::fits(bench.problem(&observation), None);
        pins::unseen(emulator, &fits).map(|fit| fit.hypothesis.clone())
    };
    assert_eq!(unseen(&emulator, &Truth::default()), None);
    let truth = Truth::effect(5, 4.0);
    let fifth = Hypothesis::Effects(vec![5]);
    assert_eq!(unseen(&emulator, &truth), Some(fifth));
    emulator.pins.push(Point {
        offsets: vec![0.0; SMALL.parameters],
        effects: vec![(5, 3.0)],
    });
    assert_eq!(unseen(&emulator, &truth), None);
}

/// A world whose first parameter hides effects of the sensors.
fn hiding() -> Bench {
    let world = World {
        hides: 0.6,
        ..World::new(SMALL, 1)
    };
    let mut library = world.library(1);
    for candidate in &mut library.candidates {
        candidate.of_sensors = true;
    }
    Bench::of(world, library, 2, 1)
}

#[test]
fn changes_told_anew_are_those_where_the_parameters_are() {
    let mut bench = hiding();
    let before = bench.emulator.conditions[2].shapes[6].at(2.0);
    let levels = bench.levels(6, &[1.5, 0.0, 0.0], &mut Seed(1).rng("anew", 0));
    bench.emulator.tell_anew(6, &levels);
    let shape = &bench.emulator.conditions[2].shapes[6];
    let size = |change: &[f64]| libm::sqrt(product::product(change, change));
    let share = size(&shape.at(2.0)) / size(&before);
    let hidden = 0.6 * 1.5;
    assert!(
        (share - grown(2.0 - hidden) / grown(2.0)).abs() < 0.1,
        "{share}"
    );
    assert!(size(&shape.at(0.5)) < 0.05 * size(&before));
}

#[test]
fn an_effect_of_the_sensors_that_a_parameter_hides_is_named_with_its_magnitude() {
    let bench = hiding();
    let truth = Truth {
        offsets: vec![1.5, 0.0, 0.0],
        effects: vec![(6, 1.8)],
        ..Truth::default()
    };
    for seed in 0..4 {
        let verdict = bench.pinned(&truth, seed);
        assert_answer(&verdict, Answer::Effect);
        assert_eq!(verdict.named, [["e6"]]);
        // Where nothing hides it, 0.9 looks like it: nearer to the truth than to that.
        let found = verdict.effects[0].magnitude;
        assert!((found - 1.8).abs() < 0.45, "{found}");
    }
}

#[test]
fn of_a_pair_one_is_named_and_mostly_both_and_the_gap_closes() {
    let bench = &*BENCH;
    let (mut one, mut both, mut count) = (0, 0, 0);
    for seed in 0..8 {
        let (a, b) = [(4, 6), (3, 7), (6, 8), (4, 9)][seed % 4];
        let truth = Truth {
            effects: vec![(a, 1.5), (b, 1.5)],
            ..Truth::default()
        };
        let verdict = bench.verdict(&truth, 300 + seed as u64);
        let named: Vec<&str> = verdict.named.iter().map(|set| &*set[0]).collect();
        let found = [a, b].map(|e| named.contains(&&*format!("e{e}")));
        one += usize::from(found[0] || found[1]);
        both += usize::from(found[0] && found[1]);
        count += 1;
        let shrinkage = verdict.shrinkage.unwrap();
        let closed = shrinkage.closed.unwrap();
        if found == [true; 2] {
            // All of it, but for the scatter of repeats.
            assert!(closed.value > 0.7 && closed.ci95[0] < 1.1, "{shrinkage:?}");
            assert!(shrinkage.placebo.unwrap() < closed.value, "{shrinkage:?}");
        }
    }
    assert!(
        one == count && both * 10 >= 6 * count,
        "{one} and {both} of {count}"
    );
}

#[test]
fn a_pair_that_passes_its_check_is_named_before_the_unknown_though_one_of_it_seems_likelier() {
    let bench = &*BENCH;
    let truth = Truth {
        effects: vec![(4, 1.5), (6, 1.5)],
        ..Truth::default()
    };
    let observation = bench.observe(&bench.world.measured(&truth, 2, 300));
    let problem = bench.problem(&observation);
    let verdict = |passes: bool| {
        let mut ranking = Ranking::new(problem, &bench.forest);
        for ranked in &mut ranking.ranked {
            ranked.log_probability = match ranked.hypothesis.effects() {
                [4] => -1e-9,
                _ => ranked.log_probability - 30.0,
            };
            if let (false, Some(check)) = (passes, &mut ranked.check) {
                check.p = 1e-6;
            }
        }
        let ranked = &mut ranking.ranked;
        ranked.sort_by(|a, b| b.log_probability.total_cmp(&a.log_probability));
        Verdict::of(problem, &ranking, Seed(1))
    };
    let named = verdict(true);
    assert_answer(&named, Answer::Effects);
    assert_eq!(named.named, [["e4"], ["e6"]]);
    // The gap is told with what is named.
    assert!(named.shrinkage.unwrap().closed.unwrap().value > 0.7);
    assert_answer(&verdict(false), Answer::Unknown);
}

#[test]
fn the_louder_a_gap_the_less_a_difference_of_scores_decides() {
    let mut bench = Bench::new(SMALL, 2, 1);
    let limit = bench.screened()[5].detectable.unwrap();
    // Log odds of the effect against all else, by scores taken at their word and by doubted ones.
    let mut odds = |times: f64| {
        [0.0, 0.05].map(|gain_error| {
            bench.calibration.gain_error = gain_error;
            let verdict = bench.verdict(&Truth::effect(5, times * limit), 3);
            assert_eq!(verdict.named, [["e5"]]);
            let others = verdict.explanations.iter().filter(|it| it.name != "e5");
            -libm::log(others.map(|it| it.by_refit).sum())
        })
    };
    let [quiet, quiet_doubted] = odds(3.0);
    let [loud, loud_doubted] = odds(12.0);
    assert!(quiet > quiet_doubted && loud > loud_doubted);
    assert!(
        loud_doubted / loud < quiet_doubted / quiet,
        "{loud} {loud_doubted}"
    );
}

#[test]
fn one_wild_cell_of_one_run_changes_no_verdict() {
    let bench = &*BENCH;
    for (truth, answer) in [
        (Truth::default(), Answer::None),
        (Truth::effect(6, 1.5), Answer::Effect),
    ] {
        let mut measured = bench.world.measured(&truth, 2, 17);
        measured[2].runs[0][5] += 60.0;
        let verdict = bench.verdict_on(&measured);
        assert_answer(&verdict, answer);
    }
}

#[test]
fn a_parameter_that_would_have_to_drift_with_slip_or_leave_its_prior_raises_an_alarm() {
    let bench = &*BENCH;
    let alarms = |measured: &[Measured]| bench.verdict_on(measured).alarms;
    assert_eq!(
        alarms(&bench.world.measured(&Truth::parameter(1, 1.0), 2, 5)),
        []
    );
    let far = alarms(&bench.world.measured(&Truth::parameter(1, 5.0), 2, 5));
    let at_end = |alarm: &Alarm| alarm.what == Suspicion::AtItsEnd && alarm.parameter == "p1";
    assert!(far.iter().any(at_end), "{far:?}");
    let measured: Vec<Measured> = (0..SMALL.conditions)
        .map(|number| {
            let truth = Truth::parameter(1, 3.0 * (number as f64 / 7.0 - 0.5));
            bench.world.measured(&truth, 2, 5).swap_remove(number)
        })
        .collect();
    let drifting = alarms(&measured);
    let drifts = |alarm: &Alarm| {
        alarm.what == Suspicion::DriftsWithSlip && alarm.parameter == "p1" && alarm.deviations > 5.0
    };
    assert!(drifting.iter().any(drifts), "{drifting:?}");
}

#[test]
fn the_next_run_is_the_one_in_which_two_alike_effects_differ() {
    let bench = &*BENCH;
    // Two further runs: one like the others, one in which effect 1 shows the other way round.
    let mut further = bench.library.clone();
    further.conditions.truncate(2);
    for level in &mut further.conditions[1].effects[1] {
        for value in level.changes.iter_mut().flatten() {
            *value = -*value;
        }
    }
    let names = vec!["once more".to_owned(), "in reverse".to_owned()];
    let further = FurtherRuns::new(names, &further).unwrap();
    let observation = bench.observe(&bench.world.measured(&Truth::effect(0, 1.2), 2, 60));
    let problem = bench.problem(&observation);
    let ranking = Ranking::new(problem, &bench.forest);
    let verdict = Verdict::of(problem, &ranking, Seed(1)).with_next_run(problem, &further);
    let next = verdict.next_run.unwrap();
    assert_eq!(next.run, "in reverse");
    assert!(next.cosine[0] > 0.95 && next.cosine[1] < 0.95, "{next:?}");
    assert!(next.deviations[1] > 1.5 * next.deviations[0], "{next:?}");
}

#[test]
fn the_same_numbers_give_the_same_verdict_bit_for_bit() {
    let verdicts = [1, 1].map(|seed| {
        let bench = Bench::new(SMALL, 2, seed);
        bench.verdict(&Truth::effect(5, 1.0), 3)
    });
    assert_eq!(verdicts[0], verdicts[1]);
}

#[test]
fn rows_of_another_length_and_numbers_that_are_none_are_refused_with_their_condition() {
    let world = World::new(SMALL, 1);
    let mut library = world.library(1);
    library.conditions[3].base[2].pop();
    let error = Emulator::new(&library).unwrap_err().to_string();
    assert_eq!(
        error,
        "condition 3: a replicate has 35 numbers instead of 36"
    );
    let mut library = world.library(1);
    library.conditions[1].effects[4][0].changes[1][7] = f64::NAN;
    let error = Emulator::new(&library).unwrap_err().to_string();
    assert_eq!(error, "condition 1: an effect's change is not finite");
}

#[test]
#[ignore = "a timing; cargo test --release --lib worlds -- --ignored --nocapture"]
fn a_verdict_on_12_conditions_of_300_cells_and_40_effects_takes_seconds() {
    let size = Size {
        conditions: 12,
        cells: 300,
        parameters: 10,
        effects: 40,
    };
    let start = std::time::Instant::now();
    let bench = Bench::new(size, 2, 1);
    println!(
        "library, emulator and forest: {:?}, {:?}",
        start.elapsed(),
        bench.forest.out_of_bag
    );
    let start = std::time::Instant::now();
    let verdict = bench.verdict(&Truth::effect(7, 1.0), 1);
    println!("verdict: {:?}", start.elapsed());
    assert_eq!(verdict.verdict, Answer::Effect);
    assert!(start.elapsed().as_secs() < 30);
}
#[test]
fn an_effect_that_is_not_in_the_library_is_unknown_and_no_other_effect() {
    let whole = &*BENCH;
    let library = without(whole.library.clone(), 3);
    let bench = Bench::of(World::new(SMALL, 1), library, 2, 1);
    for seed in 0..4 {
        let truth = Truth::effect(3, 6.0 * whole.screened()[3].detectable.unwrap());
        let verdict = bench.verdict(&truth, 900 + seed);
        assert_answer(&verdict, Answer::Unknown);
    }
}

#[test]
fn an_effect_that_is_not_in_the_library_is_unknown_though_one_that_is_takes_a_third_of_its_gap() {
    let mut world = World::new(SMALL, 1);
    let mut rng = Seed(1).rng("a third alike", 0);
    for signatures in &mut world.signatures {
        let [left_out, own] = [signatures[3].clone(), pattern(SMALL.cells, 1.0, &mut rng)];
        let size = product::product(&left_out, &left_out) / product::product(&own, &own);
        let mut alike = left_out;
        product::add(&mut alike, libm::sqrt(2.0 * size), &own);
        signatures[4] = alike;
    }
    let library = without(world.library(1), 3);
    let bench = Bench::of(world, library, 2, 1);
    for seed in 0..4 {
        let verdict = bench.verdict(&Truth::effect(3, 6.0), 920 + seed);
        assert_answer(&verdict, Answer::Unknown);
        // What was e4 in the world is e4 in the library too, for names stay.
        let nearest = "of what the library has, e4";
        assert!(
            verdict.reasons.iter().any(|it| it.starts_with(nearest)),
            "{:?}",
            verdict.reasons
        );
    }
}

#[test]
fn an_effect_of_another_form_among_runs_that_went_astray_is_named_all_the_same() {
    let bench = &*BENCH;
    let mut named = 0;
    for effect in 4..SMALL.effects {
        let truth = Truth::effect(effect, 3.0 * bench.screened()[effect].detectable.unwrap());
        let mut measured = bench.world.measured(&truth, 2, 70);
        let mut rng = Seed(effect as u64).rng("form", 0);
        for (number, measured) in measured.iter_mut().enumerate() {
            let change = bench.world.change(number, &truth);
            // Each cell changes by 40 % more or less than the library has it; every eighth run
            // and condition is three times off.
            let wrong: Vec<f64> = change.iter().map(|x| 0.4 * x * normal(&mut rng)).collect();
            for run in &mut measured.runs {
                product::add(run, 1.0, &wrong);
            }
            if number % 8 == effect % 8 {
                measured.runs[0] = measured.runs[0].iter().map(|x| 3.0 * x).collect();
            }
        }
        let verdict = bench.verdict_on(&measured);
        named += usize::from(verdict.named == [[format!("e{effect}")]]);
    }
    assert!(named >= 5, "{named} of 6");
}

#[test]
fn an_effect_that_a_parameter_absorbs_is_no_cause_of_what_that_parameter_cannot_explain() {
    let mut world = World::new(SMALL, 1);
    for condition in 0..SMALL.conditions {
        world.signatures[condition][2] = world.jacobian[condition][0].clone();
    }
    let library = world.library(1);
    let bench = Bench::of(world, library, 2, 1);
    for seed in 0..3 {
        let measured = bench.world.in_another_form(2, 5.0, 0.6, seed);
        assert_answer(&bench.verdict_on(&measured), Answer::Unknown);
    }
}
