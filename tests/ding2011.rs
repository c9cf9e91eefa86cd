//! Predictions of a published single-wheel study: smooth and lugged wheel at 80 N, slip 0-0.6.
//!
//! Ding et al. (2011), J. Terramechanics 48(1):27-45. The soil's moduli, exponent, strength and `K`
//! are those the study measured on the soil. What it does not list is taken at round numbers in
//! the middle of what others use for dry sand: `c_1` 0.18-0.43, `c_2` 0.1-0.5, `c_3` near -0.2,
//! `n_1` 0.35-0.45. They are no fit, but they were settled after such sets had been compared on
//! these points: the sets' medians of the pull's error spread from 13 to 35 %, and the range of
//! `K` alone moves this one from 15 to 21 %. A published open kit has 27 %.
//!
//! The cleaner score calibrates the sinkage exponent on two sinkages of the smooth wheel and
//! predicts the lugged wheel, of which it has seen nothing.
//!
//! `cargo test --release --test all ding2011:: -- --nocapture` prints the tables.

use crate::common::{mean, rig, run};
use lugwheel::soil::departures::Departures;
use lugwheel::soil::wheel_load::{WheelLoad, loads, sinkage_at};
use lugwheel::soil::{Soil, StressConvention};
use lugwheel::terrain::TerrainSpec;
use lugwheel::wheel::{Lugs, Wheel};

const LOAD: f64 = 80.0;

fn soil() -> Soil {
    Soil {
        convention: StressConvention::WongReece,
        cohesive_modulus: 15.6e3,
        frictional_modulus: 2407.4e3,
        sinkage_exponent: 1.10,
        sinkage_exponent_slip: 0.4,
        cohesion: 250.0,
        friction_angle_deg: 31.9,
        // Measured from 9.7 to 13.1 mm.
        shear_modulus: 0.0114,
        stress_angle: 0.4,
        stress_angle_slip: 0.3,
        exit_angle: -0.2,
        unloading_stiffness: 2.0e7,
        damping: 3.0e4,
        bulk_density: 1605.0,
        repose_angle_deg: 31.9,
        departures: Departures::NONE,
    }
}

/// One measured point.
struct Point {
    wheel: Wheel,
    slip: f64,
    pull: f64,
    sinkage: f64,
    torque: f64,
}

/// The thickness of the study's lugs is not known: from 1 to 3 mm the median of the pull's error
/// goes from 16 to 14 %.
const LUG_THICKNESS: f64 = 0.002;

fn points() -> Vec<Point> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/ding2011/points.csv"
    );
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(file)
        .unwrap();
    let point = |record: csv::StringRecord| {
        let number = |column: usize| record[column].parse::<f64>().unwrap();
        assert_eq!(number(5), LOAD);
        let lugs = Lugs {
            count: record[4].parse().unwrap(),
            height: number(3),
            thickness: LUG_THICKNESS,
            edge_radius: None,
        };
        Point {
            wheel: Wheel {
                radius: number(1),
                width: number(2),
                lugs: (lugs.count > 0).then_some(lugs),
                ..Wheel::rover()
            },
            slip: number(6),
            pull: number(7),
            sinkage: number(8),
            torque: number(9),
        }
    };
    reader.records().map(|r| point(r.unwrap())).collect()
}

/// Relative errors of pull, sinkage and torque.
struct Errors {
    pull: Vec<f64>,
    sinkage: Vec<f64>,
    torque: Vec<f64>,
}

/// Pull [N], sinkage [m] and torque [N m] of a wheel in steady rolling.
type Prediction = [f64; 3];

/// What the quadrature of the soil's stress convention predicts.
fn by_quadrature(soil: &Soil, point: &Point) -> Prediction {
    let sinkage = sinkage_at(&point.wheel, soil, LOAD, point.slip).unwrap();
    let load: WheelLoad = loads(&point.wheel, soil, sinkage, point.slip);
    [load.drawbar_pull, sinkage, load.driving_torque]
}

/// What a simulated wheel does over the second half of a run of 0.2 m.
fn by_simulation(soil: &Soil, point: &Point) -> Prediction {
    let terrain = TerrainSpec::Sand {
        soil: *soil,
        roughness: None,
    };
    let states = run(
        &terrain,
        &point.wheel,
        &rig(0.05, point.slip, LOAD),
        8e3,
        4.0,
    );
    let late = &states[states.len() / 2..];
    [
        mean(late.iter().map(|state| state.ground.drawbar_pull)),
        mean(late.iter().map(|state| state.sinkage)),
        mean(late.iter().map(|state| state.ground.driving_torque)),
    ]
}

fn score<'a>(
    points: impl Iterator<Item = &'a Point>,
    predict: impl Fn(&Point) -> Prediction,
) -> Errors {
    let mut errors = Errors {
        pull: vec![],
        sinkage: vec![],
        torque: vec![],
    };
    println!(
        "lugs slip    pull [N]          sinkage [mm]      torque [N m]   (predicted, measured)"
    );
    for point in points {
        let [drawbar_pull, sinkage, driving_torque] = predict(point);
        let error = |value: f64, measured: f64| (value - measured) / measured.abs();
        let (pull, sunk) = (
            error(drawbar_pull, point.pull),
            error(sinkage, point.sinkage),
        );
        errors.pull.push(pull.abs());
        errors.sinkage.push(sunk.abs());
        // At s = 0 the study reads no torque at all: no relative error.
        if point.torque > 0.0 {
            let torque = error(driving_torque, point.torque);
            errors.torque.push(torque.abs());
        }
        println!(
            "{:4} {:4.1} {drawbar_pull:7.2} {:6.1} {:4.0}% {:7.2} {:6.2} {:4.0}% {driving_torque:7.2} {:5.1}",
            point.wheel.lug_count(),
            point.slip,
            point.pull,
            100.0 * pull,
            1e3 * sinkage,
            1e3 * point.sinkage,
            100.0 * sunk,
            point.torque,
        );
    }
    println!(
        "median error: pull {:.0}%, sinkage {:.0}%, torque {:.0}%",
        100.0 * median(&errors.pull),
        100.0 * median(&errors.sinkage),
        100.0 * median(&errors.torque),
    );
    errors
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[half]
    } else {
        0.5 * (sorted[half - 1] + sorted[half])
    }
}

/// The value of `set`'s parameter in `range` at which the smooth wheel sinks as measured at `slip`.
fn calibrated(
    soil: Soil,
    [mut low, mut high]: [f64; 2],
    slip: f64,
    set: impl Fn(&mut Soil, f64),
) -> Soil {
    let points = points();
    let mut smooth = points.iter().filter(|point| point.wheel.lugs.is_none());
    let point = smooth.find(|point| point.slip == slip).unwrap();
    let mut soil = soil;
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        set(&mut soil, middle);
        match sinkage_at(&point.wheel, &soil, LOAD, slip) {
            Ok(sinkage) if sinkage < point.sinkage => low = middle,
            _ => high = middle,
        }
    }
    soil
}

#[test]
fn pull_is_predicted_within_20_percent_and_torque_within_12_at_the_median() {
    let points = points();
    let errors = score(points.iter(), |point| by_quadrature(&soil(), point));
    // The values were traced to about 5 % of full scale, and the measured range of K alone moves
    // the median between 15 and 21 %.
    assert!(median(&errors.pull) < 0.20);
    assert!(median(&errors.torque) < 0.12);
}

#[test]
fn the_lugged_wheel_is_predicted_better_than_the_smooth_one() {
    let points = points();
    let lugged = score(points.iter().filter(|p| p.wheel.lugs.is_some()), |point| {
        by_quadrature(&soil(), point)
    });
    let smooth = score(points.iter().filter(|p| p.wheel.lugs.is_none()), |point| {
        by_quadrature(&soil(), point)
    });
    assert!(median(&lugged.pull) < 0.15);
    assert!(median(&lugged.pull) < median(&smooth.pull));
}

#[test]
fn plate_moduli_sink_both_wheels_too_deep_below_slip_0_4() {
    for point in points().iter().filter(|point| point.slip < 0.4) {
        let sinkage = sinkage_at(&point.wheel, &soil(), LOAD, point.slip).unwrap();
        assert!(sinkage > 1.2 * point.sinkage && sinkage < 2.5 * point.sinkage);
    }
}

#[test]
fn two_sinkages_of_the_smooth_wheel_calibrate_the_exponent_for_the_lugged_wheel() {
    let soil = calibrated(soil(), [0.5, 1.5], 0.0, |soil, n_0| {
        soil.sinkage_exponent = n_0;
    });
    let soil = calibrated(soil, [0.0, 2.0], 0.4, |soil, n_1| {
        soil.sinkage_exponent_slip = n_1;
    });
    println!(
        "n_0 {:.3}, n_1 {:.3}",
        soil.sinkage_exponent, soil.sinkage_exponent_slip
    );
    // Table 6 has n_0 = 0.82 for sand, fitted to a wheel too, where plates gave 1.10 here.
    assert!((soil.sinkage_exponent - 0.9).abs() < 0.1);
    let points = points();
    let lugged = score(points.iter().filter(|p| p.wheel.lugs.is_some()), |point| {
        by_quadrature(&soil, point)
    });
    // No lugged point was used. At s = 0.6 lugs dig deeper still: 19 % is left there.
    assert!(median(&lugged.sinkage) < 0.10);
    assert!(lugged.sinkage.iter().all(|error| *error < 0.20));
    assert!(median(&lugged.pull) < 0.20);
    assert!(median(&lugged.torque) < 0.08);
}

#[test]
fn the_simulated_wheels_predict_pull_better_than_the_27_percent_of_an_open_kit() {
    let points = points();
    let errors = score(points.iter(), |point| by_simulation(&soil(), point));
    assert!(median(&errors.pull) < 0.27);
    assert!(median(&errors.torque) < 0.15);
}

#[test]
fn the_simulated_lugged_wheel_follows_from_two_sinkages_of_the_smooth_one() {
    let calibrated = Soil {
        sinkage_exponent: 0.909,
        sinkage_exponent_slip: 0.577,
        ..soil()
    };
    let points = points();
    let lugged = score(points.iter().filter(|p| p.wheel.lugs.is_some()), |point| {
        by_simulation(&calibrated, point)
    });
    assert!(median(&lugged.pull) < 0.27);
    assert!(median(&lugged.sinkage) < 0.10);
    assert!(median(&lugged.torque) < 0.10);
}
