//! Measured wheels: fitted at some slips, predicted at the others.
//!
//! `cargo test --release --test all measured_soils:: -- --include-ignored --nocapture --test-threads 1`
//! prints the tables.
//!
//! What may be fixed is what was measured otherwise: of Ding's soil `n` under plates, `K`, `c` and
//! `φ` in shear; of Carnegie Mellon's `k` and `n` under plates. Every variant is printed.

use lugwheel::dataset::csv::Campaign;
use lugwheel::identification::{
    Cylinder, Estimate, Identification, Known, Parameter, PlateFit, Predicted, Prediction,
    Predictor, Pressing, Setting, Standing, SteadyLoad, Uncertainty, identify, steady_loads,
};
use lugwheel::soil::closed_form::Rim;
use lugwheel::terrain::class::Wtic;
use lugwheel::trace::Trace;
use rayon::prelude::*;
use std::path::Path;

fn campaign(name: &str) -> Vec<Trace> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let campaign = Campaign::load(folder.join(name)).unwrap();
    let mut traces = Vec::new();
    for run in campaign.runs() {
        traces.push(run.unwrap().1);
    }
    traces
}

/// One of Ding's wheels.
struct Wheel {
    name: &'static str,
    rows: Vec<SteadyLoad>,
    rim: Rim,
    lug_height: f64,
}

/// Values were traced by hand to about 5 % of the full scale, taken for two standard deviations;
/// the load was held, to 1 %.
fn ding() -> [Wheel; 2] {
    let traces = campaign("ding2011/points.toml");
    let wheel = |name, lugs: u32| {
        let of_wheel: Vec<&Trace> = traces
            .iter()
            .filter(|t| t.attributes.lug_count == Some(lugs))
            .collect();
        let attributes = &of_wheel[0].attributes;
        let rim = Rim {
            radius: attributes.wheel_radius,
            width: attributes.wheel_width,
        };
        let mut rows: Vec<SteadyLoad> = of_wheel
            .iter()
            .flat_map(|trace| steady_loads(trace).unwrap())
            .collect();
        let full = |channel: fn(&SteadyLoad) -> f64| {
            0.025
                * rows
                    .iter()
                    .map(|row| channel(row).abs())
                    .fold(0.0, f64::max)
        };
        let uncertainty = Uncertainty {
            slip: 0.005,
            sinkage: full(|row| row.sinkage),
            drawbar_pull: full(|row| row.drawbar_pull),
            load: 0.8,
            driving_torque: full(|row| row.driving_torque),
        };
        rows.iter_mut()
            .for_each(|row| row.uncertainty = Some(uncertainty));
        Wheel {
            name,
            rows,
            rim,
            lug_height: attributes.lug_height,
        }
    };
    [wheel("smooth", 0), wheel("lugged", 30)]
}

/// A slip left out: what was predicted of it.
struct HeldOut {
    row: SteadyLoad,
    prediction: Option<Prediction>,
}

/// A channel of a row and of its prediction.
struct Channel {
    name: &'static str,
    measured: fn(&SteadyLoad) -> f64,
    predicted: fn(&Prediction) -> Predicted,
}

const CHANNELS: [Channel; 3] = [
    Channel {
        name: "pull",
        measured: |row| row.drawbar_pull,
        predicted: |prediction| prediction.drawbar_pull,
    },
    Channel {
        name: "sinkage",
        measured: |row| row.sinkage,
        predicted: |prediction| prediction.sinkage,
    },
    Channel {
        name: "torque",
        measured: |row| row.driving_torque,
        predicted: |prediction| prediction.driving_torque,
    },
];

/// Every group of rows predicted from all the others.
fn leave_out(
    rows: &[SteadyLoad],
    setting: &Setting,
    group: fn(&SteadyLoad) -> i64,
) -> Vec<HeldOut> {
    rows.par_iter()
        .map(|row| {
            let kept: Vec<SteadyLoad> = rows
                .iter()
                .copied()
                .filter(|other| group(other) != group(row))
                .collect();
            let identification = Identification::new(&kept, Wtic::Leis, setting).unwrap();
            let estimate = identification.estimate().unwrap();
            let predictor = Predictor::new(&identification, &estimate);
            HeldOut {
                row: *row,
                prediction: predictor.at(row.load, row.slip),
            }
        })
        .collect()
}

fn by_slip(row: &SteadyLoad) -> i64 {
    (row.slip * 20.0).round() as i64
}

/// Errors of one channel over slips.
struct Errors {
    /// Over the channel's range, a number per slip left out; infinite where nothing was predicted.
    of_range: Vec<f64>,
    /// Over the value, where it exceeds a tenth of the range.
    relative: Vec<f64>,
    covered: usize,
}

fn errors(predicted: &[&HeldOut], all: &[SteadyLoad], channel: &Channel) -> Errors {
    let values = || all.iter().map(channel.measured);
    let range = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
    let mut errors = Errors {
        of_range: Vec::new(),
        relative: Vec::new(),
        covered: 0,
    };
    for one in predicted {
        let measured = (channel.measured)(&one.row);
        let found = one.prediction.as_ref().map(channel.predicted);
        let error = found.map_or(f64::INFINITY, |found| (found.value - measured).abs());
        errors.of_range.push(100.0 * error / range);
        if measured.abs() > 0.1 * range {
            errors.relative.push(100.0 * error / measured.abs());
        }
        errors.covered += usize::from(found.is_some_and(|found| found.covers(measured)));
    }
    errors
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

fn print_predicted(predicted: &[HeldOut]) {
    println!(
        "  slip   pull [N]               sinkage [mm]           torque [N m]  (predicted ± half of 95 %, measured)"
    );
    for one in predicted {
        print!("  {:5.2}", one.row.slip);
        let Some(prediction) = &one.prediction else {
            println!("  no sinkage carries {:.1} N", one.row.load);
            continue;
        };
        for (channel, scale) in CHANNELS.iter().zip([1.0, 1e3, 1.0]) {
            let found = (channel.predicted)(prediction);
            print!(
                "  {:7.2} ±{:6.2} {:6.2}",
                scale * found.value,
                scale * found.half_width,
                scale * (channel.measured)(&one.row)
            );
        }
        println!();
    }
}

/// Prints one line and returns the medians over the range [%] of pull, sinkage and torque.
fn print_errors(title: &str, predicted: &[&HeldOut], all: &[SteadyLoad]) -> [f64; 3] {
    let found = CHANNELS
        .each_ref()
        .map(|channel| (channel.name, errors(predicted, all, channel)));
    print!("  {title:12}");
    for (name, errors) in &found {
        if errors.of_range.iter().all(|error| error.is_nan()) {
            print!("  {name} not measured");
            continue;
        }
        let [range, value] = [&errors.of_range, &errors.relative].map(|e| median(e));
        let n = predicted.len();
        print!(
            "  {name} {range:5.1} % {value:5.1} % {}/{n}",
            errors.covered
        );
    }
    println!();
    found.map(|(_, errors)| median(&errors.of_range))
}

fn print_estimate(estimate: &Estimate) {
    for identified in &estimate.parameters {
        let told = match (identified.standing, identified.ci95()) {
            (Standing::Identified, [Some(low), Some(high)]) => format!("[{low:.4}, {high:.4}]"),
            (Standing::Given, _) => "given".to_owned(),
            _ => "not identifiable".to_owned(),
        };
        let (parameter, value) = (identified.parameter, identified.value);
        println!(
            "  {:4} {value:12.4} {told} {}",
            parameter.name(),
            parameter.unit()
        );
    }
    let per_freedom = estimate.chi_square / estimate.degrees_of_freedom as f64;
    println!("  reduced chi square {per_freedom:.1}");
    for warning in &estimate.warnings {
        println!("  warning: {warning}");
    }
}

/// What is fixed, and the cylinder that stands for the wheel.
struct Variant {
    title: &'static str,
    fixed: &'static [(Parameter, f64)],
    cylinder: Cylinder,
}

impl Variant {
    const fn of_rim(title: &'static str, fixed: &'static [(Parameter, f64)]) -> Self {
        Self {
            title,
            fixed,
            cylinder: Cylinder::Rim,
        }
    }

    fn setting(&self, rim: Rim, lug_height: f64) -> Setting {
        Setting {
            cylinder: self.cylinder,
            lug_height,
            ..setting(rim, self.fixed)
        }
    }
}

const RING_SHEAR: (Parameter, f64) = (Parameter::ShearModulus, 0.0114);

/// What Ding et al. measured on the soil itself: `n` under plates, `K`, `c` and `φ` in shear.
const VARIANTS: [Variant; 6] = [
    Variant::of_rim("nothing fixed", &[]),
    Variant::of_rim("n0 1.10 fixed", &[(Parameter::SinkageExponent, 1.10)]),
    Variant::of_rim("K 11.4 mm fixed", &[RING_SHEAR]),
    Variant::of_rim("K 9.7 mm fixed", &[(Parameter::ShearModulus, 0.0097)]),
    Variant::of_rim(
        "K, c and phi fixed",
        &[
            RING_SHEAR,
            (Parameter::Cohesion, 250.0),
            (Parameter::FrictionAngle, 31.9),
        ],
    ),
    Variant {
        title: "K 11.4 mm fixed, at the lugs' tips",
        fixed: &[RING_SHEAR],
        cylinder: Cylinder::LugTips,
    },
];

fn setting(rim: Rim, fixed: &[(Parameter, f64)]) -> Setting {
    let known = fixed
        .iter()
        .fold(Known::default(), |known, (parameter, value)| {
            known.with(*parameter, *value)
        });
    Setting {
        known,
        ..Setting::new(rim)
    }
}

fn is_inner(row: &SteadyLoad) -> bool {
    row.slip > 0.05 && row.slip < 0.55
}

/// Prints what is predicted of a wheel and returns the medians over the range [%] at inner slips.
fn predict_held_out(wheel: &Wheel, variant: &Variant) -> [f64; 3] {
    let setting = variant.setting(wheel.rim, wheel.lug_height);
    println!("\n{} wheel, {}", wheel.name, variant.title);
    let identification = Identification::new(&wheel.rows, Wtic::Leis, &setting).unwrap();
    print_estimate(&identification.estimate().unwrap());
    let predicted = leave_out(&wheel.rows, &setting, by_slip);
    print_predicted(&predicted);
    let (inner, ends): (Vec<&HeldOut>, Vec<&HeldOut>) =
        predicted.iter().partition(|one| is_inner(&one.row));
    print_errors("the two ends", &ends, &wheel.rows);
    print_errors("inner slips", &inner, &wheel.rows)
}

#[test]
fn dings_wheels_are_predicted_at_inner_slips_within_10_percent() {
    for wheel in ding() {
        let [pull, sinkage, torque] = predict_held_out(&wheel, &VARIANTS[1]);
        assert!(pull <= 10.0 && torque <= 10.0, "{pull}, {torque}");
        assert!(sinkage <= 15.0, "{sinkage}");
    }
}

#[test]
#[ignore = "a minute: some hundred fits from many starts"]
fn a_shear_modulus_from_the_ring_is_several_times_that_of_the_wheels() {
    println!(
        "medians of the errors over the channel's range, over the value; how many lie within their 95 %"
    );
    for wheel in ding() {
        for variant in &VARIANTS {
            let by_tips = variant.cylinder == Cylinder::LugTips;
            if by_tips && wheel.lug_height == 0.0 {
                continue;
            }
            let [pull, sinkage, _] = predict_held_out(&wheel, variant);
            assert!(sinkage <= 15.0, "{sinkage}");
            // Asked are 10 %. The ring's shear modulus fits neither wheel by its rim; the lugged
            // one by the circle through its lugs' edges.
            let fixed = variant.fixed.iter();
            let by_ring = fixed.map(|(p, _)| p).any(|p| *p == Parameter::ShearModulus);
            assert_eq!(
                pull > 10.0,
                by_ring && !by_tips,
                "{}: {pull}",
                variant.title
            );
        }
        let setting = VARIANTS[1].setting(wheel.rim, wheel.lug_height);
        let estimate = identify(&wheel.rows, Wtic::Leis, &setting).unwrap();
        let [_, most] = estimate.of(Parameter::ShearModulus).ci95();
        assert!(most.unwrap() < 0.5 * 0.0097, "{most:?}");
    }
}

/// Plates of the testbed: diameter [m], and the points while the force grows.
fn plates() -> Vec<(f64, Vec<[f64; 2]>)> {
    let traces = campaign("cmu-single-wheel/plates.toml");
    let plate = |trace: &Trace| {
        let Pressing { plate, points } = Pressing::of(trace).unwrap();
        (2.0 * plate.smaller_dimension(), points)
    };
    traces.iter().map(plate).collect()
}

#[test]
fn carnegie_mellons_wheel_follows_from_its_plates() {
    let plates = plates();
    for (diameter, points) in &plates {
        let fit = PlateFit::of(points).unwrap();
        println!(
            "plate of {:.0} mm: k {:.3e} N/m^(n+2), n {:.3}, {:.2e} Pa at 15 mm",
            1e3 * diameter,
            fit.modulus,
            fit.exponent,
            fit.modulus * 0.015f64.powf(fit.exponent)
        );
    }
    // The wheel is 50 mm wide: the plates of 60 mm are the nearest.
    let nearest = plates.iter().filter(|(diameter, _)| *diameter < 0.07);
    let points: Vec<[f64; 2]> = nearest.flat_map(|(_, points)| points.clone()).collect();
    let plate = PlateFit::of(&points).unwrap();
    println!(
        "60 mm together: k {:.3e} N/m^(n+2), n {:.3}",
        plate.modulus, plate.exponent
    );
    let mut rows: Vec<SteadyLoad> = campaign("cmu-single-wheel/smooth_wheel_runs.toml")
        .iter()
        .flat_map(|trace| steady_loads(trace).unwrap())
        .filter(|row| row.slip > -0.01)
        .collect();
    // The repeats' spread, most of them of different days.
    let uncertainty = Uncertainty {
        slip: 0.005,
        sinkage: 0.00073,
        drawbar_pull: 0.8,
        load: 1.05,
        driving_torque: f64::NAN,
    };
    rows.iter_mut()
        .for_each(|row| row.uncertainty = Some(uncertainty));
    let rim = Rim {
        radius: 0.058,
        width: 0.05,
    };
    for (title, fixed) in [
        (
            "k and n from the plates",
            &[
                (Parameter::SinkageModulus, plate.modulus),
                (Parameter::SinkageExponent, plate.exponent),
            ][..],
        ),
        (
            "n from the plates",
            &[(Parameter::SinkageExponent, plate.exponent)],
        ),
        ("nothing fixed", &[]),
    ] {
        let setting = setting(rim, fixed);
        println!("\n{} rows at slip 0 and above, {title}", rows.len());
        let identification = Identification::new(&rows, Wtic::Leis, &setting).unwrap();
        let estimate = identification.estimate().unwrap();
        print_estimate(&estimate);
        for combination in &estimate.combinations {
            let [low, high] = combination.interval;
            let (name, place, value) = (combination.name, &combination.place, combination.value);
            println!(
                "  {name} ({place}) = {value:.3e} [{low:.3e}, {high:.3e}] {}",
                combination.unit
            );
        }
        let predicted = leave_out(&rows, &setting, by_slip);
        print_predicted(&predicted);
        let slipping: Vec<&HeldOut> = predicted.iter().filter(|one| one.row.slip > 0.05).collect();
        let [pull, sinkage, _] = print_errors("slip 0.23 on", &slipping, &rows);
        if fixed.len() == 2 {
            // Strength is all that load and pull fix of c, phi and K.
            for open in [
                Parameter::Cohesion,
                Parameter::FrictionAngle,
                Parameter::ShearModulus,
            ] {
                assert!(!estimate.of(open).is_identifiable(), "{}", open.name());
            }
            assert!(sinkage <= 15.0, "{pull}, {sinkage}");
        }
    }
}
