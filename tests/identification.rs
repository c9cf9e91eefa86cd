//! Terrain parameters from loads that the equations themselves made: what comes back, how sure.
//!
//! Terrains are the rows of Table 6 on the rover's rim. Sand is loaded with 60, 109 and 200 N.
//! Hard ground and gravel have one sinkage and so, by Eq. (62), one load for each slip, whatever
//! the rig does: there three repeats take the place of three loads.
//!
//! `cargo test --release --test all identification:: -- --ignored --nocapture` prints the tables.

use lugwheel::identification::{
    Combination, Estimate, ForceErrors, Identification, Parameter, PredictedForce, RIGID_SINKAGE,
    Setting, SteadyLoad, TerrainParameters, Uncertainty, Warning, identify,
};
use lugwheel::quantity::Seed;
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::table_6;
use lugwheel::soil::wheel_load::sinkage_at;
use lugwheel::terrain::class::Wtic;
use lugwheel::wheel::Wheel;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

const SLIPS: [f64; 9] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6];
const LOADS: [f64; 3] = [60.0, 109.0, 200.0];

/// A row of Table 6 and its class.
#[derive(Debug, Clone, Copy)]
struct Terrain {
    name: &'static str,
    class: Wtic,
    truth: TerrainParameters,
}

const HARD: Terrain = Terrain {
    name: "HT",
    class: Wtic::Alct,
    truth: TerrainParameters {
        stress_angle: 0.8069,
        stress_angle_slip: 0.0,
        sinkage_modulus: 3.9999e8,
        sinkage_exponent: 0.6104,
        sinkage_exponent_slip: 0.0,
        cohesion: 0.0,
        friction_angle_deg: 33.34,
        shear_modulus: 0.0,
    },
};

const GRAVEL: Terrain = Terrain {
    name: "GT",
    class: Wtic::Slct,
    truth: TerrainParameters {
        stress_angle: 0.0,
        stress_angle_slip: 0.0,
        sinkage_modulus: 4.0053e8,
        sinkage_exponent: 0.5680,
        sinkage_exponent_slip: 0.054,
        cohesion: 0.0,
        friction_angle_deg: 32.17,
        shear_modulus: 0.0006,
    },
};

/// The cohesion is printed in kPa; corrected.
const SAND: Terrain = Terrain {
    name: "ST",
    class: Wtic::Leis,
    truth: TerrainParameters {
        stress_angle: 0.4424,
        stress_angle_slip: -0.6379,
        sinkage_modulus: 2.4904e6,
        sinkage_exponent: 0.8169,
        sinkage_exponent_slip: 1.296,
        cohesion: 308.6,
        friction_angle_deg: 29.67,
        shear_modulus: 0.0066,
    },
};

fn smooth_rover() -> Wheel {
    Wheel {
        lugs: None,
        ..Wheel::rover()
    }
}

fn setting() -> Setting {
    Setting::new(Rim::from(&Wheel::rover()))
}

impl Terrain {
    /// Rows without noise at every slip and load.
    fn rows(&self, loads: &[f64]) -> Vec<SteadyLoad> {
        let soil = self.truth.on(&table_6::sand());
        let rows = loads.iter().flat_map(|&load| {
            SLIPS.map(|slip| {
                let sinkage = match self.class {
                    Wtic::Leis => sinkage_at(&smooth_rover(), &soil, load, slip).unwrap(),
                    _ => RIGID_SINKAGE,
                };
                let loads = closed_form::loads(setting().rim, &soil, sinkage, slip);
                SteadyLoad::new(slip, sinkage, loads)
            })
        });
        rows.collect()
    }

    fn identify(&self, rows: &[SteadyLoad]) -> Estimate {
        identify(rows, self.class, &setting()).unwrap()
    }
}

/// Uncertainties: 2 % of a force or of a tenth of its range, whichever is more, as a sensor's
/// sheet would have them; of slip and sinkage as given.
fn with_uncertainty(rows: &[SteadyLoad], [slip, sinkage]: [f64; 2]) -> Vec<SteadyLoad> {
    let range = |channel: fn(&SteadyLoad) -> f64| {
        let values = || rows.iter().map(channel);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let force = |row: &SteadyLoad, channel: fn(&SteadyLoad) -> f64| {
        0.02 * channel(row).abs().max(0.1 * range(channel))
    };
    let stated = |row: &SteadyLoad| SteadyLoad {
        uncertainty: Some(Uncertainty {
            slip,
            sinkage,
            drawbar_pull: force(row, |row| row.drawbar_pull),
            load: force(row, |row| row.load),
            driving_torque: force(row, |row| row.driving_torque),
        }),
        ..*row
    };
    rows.iter().map(stated).collect()
}

/// Rows with normal errors of their uncertainties.
fn noisy(rows: &[SteadyLoad], run: u64) -> Vec<SteadyLoad> {
    let mut rng = Seed(1).rng("identification noise", run);
    let mut error = |sd: f64| -> f64 {
        let normal: f64 = StandardNormal.sample(&mut rng);
        sd * normal
    };
    rows.iter()
        .map(|row| {
            let Some(sd) = row.uncertainty else {
                return *row;
            };
            SteadyLoad {
                slip: row.slip + error(sd.slip),
                sinkage: (row.sinkage + error(sd.sinkage)).max(1e-5),
                drawbar_pull: row.drawbar_pull + error(sd.drawbar_pull),
                load: row.load + error(sd.load),
                driving_torque: row.driving_torque + error(sd.driving_torque),
                ..*row
            }
        })
        .collect()
}

/// What many noisy data sets gave of one quantity, in the coordinate of the fit.
struct Recovery {
    name: &'static str,
    /// Mean and median error over the standard deviation of the estimates.
    bias: f64,
    median_bias: f64,
    sd: f64,
    /// Share of the covariance's, and of the profile's, 95 % intervals that hold the truth.
    coverage: f64,
    profile_coverage: f64,
    /// Median half-width of the covariance's intervals.
    half_width: f64,
    /// Share of the data sets that identify it.
    identified: f64,
}

/// What one data set gave of one quantity.
struct Found {
    at: f64,
    half_width: f64,
    profile: [Option<f64>; 2],
    identified: bool,
}

impl Found {
    fn parameter(estimate: &Estimate, parameter: Parameter) -> Self {
        let identified = estimate.of(parameter);
        let profile = identified.profile.unwrap();
        Self {
            at: parameter.coordinate(identified.value),
            half_width: 1.959_964 * identified.standard_error,
            profile: profile.map(|end| end.map(|end| parameter.coordinate(end))),
            identified: identified.is_identifiable(),
        }
    }

    /// The interval of a combination is the covariance's alone.
    fn combination(combination: &Combination) -> Self {
        let [low, high] = combination.interval.map(f64::ln);
        Self {
            at: combination.value.ln(),
            half_width: 0.5 * (high - low),
            profile: [Some(low), Some(high)],
            identified: true,
        }
    }

    fn profile_holds(&self, truth: f64) -> bool {
        let [low, high] = self.profile;
        low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high)
    }
}

impl Recovery {
    fn of(name: &'static str, truth: f64, found: &[Found]) -> Self {
        let count = found.len() as f64;
        let mean = found.iter().map(|f| f.at).sum::<f64>() / count;
        let square: f64 = found.iter().map(|f| (f.at - mean) * (f.at - mean)).sum();
        let sd = (square / (count - 1.0)).sqrt();
        let share = |holds: &dyn Fn(&Found) -> bool| {
            found.iter().filter(|f| holds(f)).count() as f64 / count
        };
        Self {
            name,
            bias: (mean - truth) / sd,
            median_bias: (median(found, |f| f.at) - truth) / sd,
            sd,
            coverage: share(&|f| (f.at - truth).abs() <= f.half_width),
            profile_coverage: share(&|f| f.profile_holds(truth)),
            half_width: median(found, |f| f.half_width),
            identified: share(&|f| f.identified),
        }
    }

    fn print(&self) {
        println!(
            "{:9} {:8.4} {:10.4} {:8.3} {:8.3} {:9.1} {:9.1} {:11.1}",
            self.name,
            self.sd,
            self.half_width,
            self.bias,
            self.median_bias,
            100.0 * self.coverage,
            100.0 * self.profile_coverage,
            100.0 * self.identified,
        );
    }
}

fn median(found: &[Found], of: impl Fn(&Found) -> f64) -> f64 {
    let mut values: Vec<f64> = found.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Prints and returns what 1000 noisy data sets made of `rows` give.
///
/// `fitted` is what the identification is told of the rows.
fn monte_carlo(
    terrain: &Terrain,
    title: &str,
    rows: &[SteadyLoad],
    fitted: fn(SteadyLoad) -> SteadyLoad,
) -> Vec<Recovery> {
    let estimates: Vec<Estimate> = (0..1000)
        .into_par_iter()
        .map(|run| {
            let rows: Vec<SteadyLoad> = noisy(rows, run).into_iter().map(fitted).collect();
            terrain.identify(&rows)
        })
        .collect();
    println!(
        "\n{}, {} rows, {title}: 1000 data sets",
        terrain.name,
        rows.len()
    );
    println!("            sd    half-width  bias/sd   median  coverage  profile's  identified [%]");
    let parameters = Parameter::ALL
        .into_iter()
        .filter(|parameter| parameter.is_free(terrain.class));
    let mut table: Vec<Recovery> = parameters
        .map(|parameter| {
            let truth = parameter.coordinate(terrain.truth.get(parameter));
            let found = estimates.iter().map(|e| Found::parameter(e, parameter));
            Recovery::of(parameter.name(), truth, &found.collect::<Vec<_>>())
        })
        .collect();
    table.extend(product(terrain, &estimates));
    table.iter().for_each(Recovery::print);
    let misfits = estimates.iter().filter(|e| {
        e.warnings
            .iter()
            .any(|w| matches!(w, Warning::Misfit { .. }))
    });
    println!("{} called a misfit", misfits.count());
    table
}

/// `k_s z^n0` where the class sets the sinkage.
fn product(terrain: &Terrain, estimates: &[Estimate]) -> Option<Recovery> {
    if terrain.class == Wtic::Leis {
        return None;
    }
    let truth = terrain.truth;
    let pressure = truth.sinkage_modulus * RIGID_SINKAGE.powf(truth.sinkage_exponent);
    let name = "k_s z^n0";
    let found = estimates.iter().map(|estimate| {
        let known = estimate.combinations.iter().find(|c| c.name == name);
        Found::combination(known.unwrap())
    });
    Some(Recovery::of(
        name,
        pressure.ln(),
        &found.collect::<Vec<_>>(),
    ))
}

/// Of 1000 intervals, 93 to 97 % hold the truth: 2.9 standard deviations either way.
fn assert_covers(share: f64, name: &str) {
    assert!((0.93..=0.97).contains(&share), "{name}: {share}");
}

fn exact(rows: &[SteadyLoad]) -> Vec<SteadyLoad> {
    with_uncertainty(rows, [0.0, 0.0])
}

#[test]
fn loads_without_noise_give_every_identifiable_parameter_back_within_a_thousandth() {
    for terrain in [HARD, GRAVEL, SAND] {
        let estimate = terrain.identify(&terrain.rows(&LOADS));
        let mut open = Vec::new();
        for identified in &estimate.parameters {
            let name = identified.parameter.name();
            if !identified.is_identifiable() {
                open.push(name);
                continue;
            }
            let truth = terrain.truth.get(identified.parameter);
            let error = (identified.value - truth).abs();
            let small = if truth == 0.0 {
                1e-3
            } else {
                1e-3 * truth.abs()
            };
            assert!(
                error < small,
                "{} {name}: {}",
                terrain.name,
                identified.value
            );
        }
        let expected: &[&str] = match terrain.class {
            Wtic::Alct => &["k_s", "n0", "c", "K"],
            Wtic::Slct => &["k_s", "n0", "c"],
            _ => &[],
        };
        assert_eq!(open, expected, "{}", terrain.name);
    }
}

#[test]
fn the_papers_stages_alone_give_loads_without_noise_back() {
    for terrain in [HARD, GRAVEL, SAND] {
        let rows = terrain.rows(&LOADS[1..2]);
        let identification = Identification::new(&rows, terrain.class, &setting()).unwrap();
        let staged = identification.staged().unwrap();
        assert!(staged.terminations.iter().all(|t| t.is_minimum()));
        let phi = staged.parameters.friction_angle_deg;
        let error = phi / terrain.truth.friction_angle_deg - 1.0;
        assert!(error.abs() < 1e-4, "{}: {phi}", terrain.name);
    }
}

#[test]
fn forces_of_rows_that_an_estimate_never_saw_lie_in_their_intervals() {
    for terrain in [HARD, GRAVEL, SAND] {
        let rows = exact(&terrain.rows(&LOADS));
        let held: Vec<bool> = (0..100)
            .flat_map(|run| {
                let rows = noisy(&rows, run).into_iter().enumerate();
                let (fitted, new): (Vec<_>, Vec<_>) = rows.partition(|(place, _)| place % 2 == 0);
                let [fitted, new] = [fitted, new].map(|part| -> Vec<SteadyLoad> {
                    part.into_iter().map(|(_, row)| row).collect()
                });
                let (identification, estimate) = estimated(&terrain, &fitted);
                let predicted = identification.predict(&estimate, &new).unwrap();
                let held = predicted.iter().filter_map(PredictedForce::is_covered);
                held.collect::<Vec<_>>()
            })
            .collect();
        let share = held.iter().filter(|held| **held).count() as f64 / held.len() as f64;
        // Some 3900 forces of 100 estimates; the model bends where little is known of gravel.
        assert!((0.93..=0.97).contains(&share), "{}: {share}", terrain.name);
    }
}

#[test]
fn errors_of_the_rows_fitted_are_those_of_the_estimate() {
    let rows = noisy(&exact(&HARD.rows(&LOADS)), 0);
    let (identification, estimate) = estimated(&HARD, &rows);
    let predicted = identification.predict(&estimate, &rows).unwrap();
    assert_eq!(ForceErrors::of(&predicted), estimate.force_errors);
    // Static friction holds the wheel at slip 0: three of 27 rows tell the load only.
    assert_eq!(predicted.len(), 3 * 27 - 2 * 3);
}

fn estimated(terrain: &Terrain, rows: &[SteadyLoad]) -> (Identification, Estimate) {
    let identification = Identification::new(rows, terrain.class, &setting()).unwrap();
    let estimate = identification.estimate().unwrap();
    (identification, estimate)
}

#[test]
fn an_estimate_predicts_measured_loads_of_smooth_and_lugged_wheels_as_table_7_does() {
    for (name, rows, radius) in measured() {
        let rim = Rim {
            radius,
            width: 0.165,
        };
        let estimate = identify(&rows, Wtic::Leis, &Setting::new(rim)).unwrap();
        println!("{name}: {:?}", estimate.force_errors);
        for identified in &estimate.parameters {
            let (parameter, ci95) = (identified.parameter, identified.ci95());
            println!(
                "  {} = {:.4} {ci95:.4?}",
                parameter.name(),
                identified.value
            );
        }
        let errors = estimate.force_errors;
        // Table 7, sand: 8.11, 7.64 and 7.75 %.
        assert!(errors.drawbar_pull.unwrap() < 8.11);
        assert!(errors.load.unwrap() < 7.64);
        assert!(errors.driving_torque.unwrap() < 7.75);
    }
}

/// Steady points of a published study by wheel (`tests/data/ding2011/points.csv`), and its rim's radius.
fn measured() -> Vec<(String, Vec<SteadyLoad>, f64)> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/ding2011/points.csv"
    );
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(file)
        .unwrap();
    let mut wheels: Vec<(String, Vec<SteadyLoad>, f64)> = Vec::new();
    for record in reader.records() {
        let record = record.unwrap();
        let number = |column: usize| record[column].parse::<f64>().unwrap();
        if wheels.last().is_none_or(|(name, ..)| name != &record[0]) {
            wheels.push((record[0].to_owned(), Vec::new(), number(1)));
        }
        let row = SteadyLoad {
            slip: number(6),
            sinkage: number(8),
            drawbar_pull: number(7),
            load: number(5),
            driving_torque: number(9),
            uncertainty: None,
        };
        wheels.last_mut().unwrap().1.push(row);
    }
    wheels
}

#[test]
#[ignore = "a minute: a thousand identifications with profiles for each table"]
fn noisy_forces_give_the_parameters_and_honest_intervals() {
    for recovery in monte_carlo(
        &SAND,
        "exact slip and sinkage",
        &exact(&SAND.rows(&LOADS)),
        |r| r,
    ) {
        assert_covers(recovery.coverage, recovery.name);
        assert_covers(recovery.profile_coverage, recovery.name);
        assert!(recovery.identified > 0.9, "{}", recovery.name);
        // Forces are straight in c, so the estimate of c is unbiased and that of ln c is low by
        // half its variance.
        let straight = recovery.name != "c";
        assert!(!straight || recovery.bias.abs() < 0.1, "{}", recovery.name);
        assert!(recovery.median_bias.abs() < 0.1, "{}", recovery.name);
    }
    for recovery in monte_carlo(&GRAVEL, "sinkage set", &exact(&GRAVEL.rows(&LOADS)), |r| r) {
        let split = ["k_s", "n0"].contains(&recovery.name);
        assert_eq!(recovery.identified < 0.5, split, "{}", recovery.name);
        // phi grows with c2 almost at will (correlation 0.96), along a bend that the covariance
        // does not see (79 % for c2), nor the profile all of it (92.8 %).
        if recovery.name == "c2" {
            assert!((0.92..=0.97).contains(&recovery.profile_coverage));
        } else if !split {
            assert_covers(recovery.profile_coverage, recovery.name);
        }
    }
    for recovery in monte_carlo(&HARD, "sinkage set", &exact(&HARD.rows(&LOADS)), |r| r) {
        let fixed = ["n1", "phi", "k_s z^n0"].contains(&recovery.name);
        assert_eq!(recovery.identified > 0.5, fixed, "{}", recovery.name);
        if fixed {
            assert_covers(recovery.coverage, recovery.name);
            assert!(recovery.bias.abs() < 0.1, "{}", recovery.name);
        }
    }
    let one_load = exact(&SAND.rows(&LOADS[1..2]));
    for recovery in monte_carlo(&SAND, "one load of 109 N", &one_load, |r| r) {
        let open = ["k_s", "n0", "n1", "c"].contains(&recovery.name);
        assert_eq!(recovery.identified < 0.5, open, "{}", recovery.name);
    }
}

#[test]
#[ignore = "a minute: a thousand identifications with profiles for each table"]
fn noisy_slip_and_sinkage_need_their_uncertainties_stated() {
    let rows = with_uncertainty(&SAND.rows(&LOADS), [0.01, 0.0005]);
    let title = "slip to 0.01, sinkage to 0.5 mm";
    let stated = monte_carlo(&SAND, &format!("{title}, stated"), &rows, |row| row);
    let hidden = monte_carlo(&SAND, &format!("{title}, not stated"), &rows, |row| {
        SteadyLoad {
            uncertainty: None,
            ..row
        }
    });
    for (stated, hidden) in stated.iter().zip(&hidden) {
        assert_covers(stated.coverage, stated.name);
        assert!(stated.sd <= 1.1 * hidden.sd, "{}", stated.name);
    }
}

#[test]
#[ignore = "a minute: ten thousand identifications"]
fn ten_thousand_identifications_take_less_than_a_minute() {
    let rows = exact(&SAND.rows(&LOADS));
    let start = std::time::Instant::now();
    let minima: usize = (0..10_000u64)
        .into_par_iter()
        .map(|run| {
            let rows = noisy(&rows, run);
            let identification = Identification::new(&rows, SAND.class, &setting()).unwrap();
            usize::from(identification.estimate().unwrap().termination.is_minimum())
        })
        .sum();
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "10000 identifications of 27 rows: {seconds:.1} s on {} threads",
        rayon::current_num_threads()
    );
    assert_eq!(minima, 10_000);
    assert!(seconds < 60.0);
}
