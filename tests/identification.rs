//! Terrain parameters from loads that the equations themselves made: what comes back, how sure.
//!
//! Terrains are the rows of Table 6 on the rover's rim. Sand is loaded with 60, 109 and 200 N.
//! Hard ground and gravel have one sinkage and so, by Eq. (62), one load for each slip, whatever
//! the rig does: there three repeats take the place of three loads.
//!
//! `cargo test --release --test identification -- --ignored --nocapture` prints the tables.

use lugwheel::identification::{
    Combination, Estimate, Identification, Parameter, RIGID_SINKAGE, Setting, SteadyLoad,
    TerrainParameters, Uncertainty, identify,
};
use lugwheel::quantity::Seed;
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::wheel_load::sinkage_at;
use lugwheel::soil::{Soil, StressConvention};
use lugwheel::terrain::class::Wtic;
use lugwheel::wheel::Wheel;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use std::time::Instant;

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

/// What the closed forms do not ask of a soil, and `c_3 = 0`.
const BASE: Soil = Soil {
    convention: StressConvention::Triangular,
    cohesive_modulus: 0.0,
    frictional_modulus: 1.0,
    sinkage_exponent: 1.0,
    sinkage_exponent_slip: 0.0,
    cohesion: 0.0,
    friction_angle_deg: 30.0,
    shear_modulus: 0.0,
    stress_angle: 0.0,
    stress_angle_slip: 0.0,
    exit_angle: 0.0,
    unloading_stiffness: 2.0e8,
    damping: 0.0,
    bulk_density: 1600.0,
    repose_angle_deg: 30.0,
};

impl Terrain {
    /// Rows without noise at every slip and load.
    fn rows(&self, loads: &[f64]) -> Vec<SteadyLoad> {
        let soil = self.truth.on(&BASE);
        let rows = loads.iter().flat_map(|&load| {
            SLIPS.map(|slip| {
                let sinkage = match self.class {
                    Wtic::Leis => sinkage_at(&smooth_rover(), &soil, load, slip).unwrap(),
                    _ => RIGID_SINKAGE,
                };
                let loads = closed_form::loads(setting().rim, &soil, sinkage, slip);
                SteadyLoad {
                    slip,
                    sinkage,
                    drawbar_pull: loads.drawbar_pull,
                    load: loads.normal_force,
                    driving_torque: loads.driving_torque,
                    uncertainty: None,
                }
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
fn noisy(rows: &[SteadyLoad], seed: Seed, run: u64) -> Vec<SteadyLoad> {
    let mut rng = seed.rng("identification noise", run);
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
    name: String,
    bias: f64,
    sd: f64,
    /// Share of the 95 % intervals that hold the truth.
    coverage: f64,
    profile_coverage: Option<f64>,
    /// Share of the data sets that call it identifiable.
    identifiable: f64,
    /// Median half-width of the intervals.
    half_width: f64,
}

impl Recovery {
    fn of(name: &str, truth: f64, found: &[Found]) -> Self {
        let count = found.len() as f64;
        let mean = found.iter().map(|f| f.at).sum::<f64>() / count;
        let square: f64 = found.iter().map(|f| (f.at - mean) * (f.at - mean)).sum();
        let share = |holds: &dyn Fn(&Found) -> bool| {
            found.iter().filter(|f| holds(f)).count() as f64 / count
        };
        let mut widths: Vec<f64> = found.iter().map(|f| f.half_width).collect();
        widths.sort_by(f64::total_cmp);
        let profiled = found.iter().all(|f| f.profile.is_some());
        Self {
            name: name.to_owned(),
            bias: mean - truth,
            sd: (square / (count - 1.0)).sqrt(),
            coverage: share(&|f| (f.at - truth).abs() <= f.half_width),
            profile_coverage: profiled.then(|| {
                share(&|f| {
                    let [low, high] = f.profile.unwrap();
                    low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high)
                })
            }),
            identifiable: share(&|f| f.identifiable),
            half_width: widths[widths.len() / 2],
        }
    }

    fn print(&self) {
        let profile = self.profile_coverage.map_or("     -".to_owned(), |share| {
            format!("{:5.1}%", 100.0 * share)
        });
        println!(
            "  {:18} sd {:9.5}  bias/sd {:7.3}  coverage {:5.1}%  by profile {profile}  \
             half-width {:9.4}  identifiable {:5.1}%",
            self.name,
            self.sd,
            self.bias / self.sd,
            100.0 * self.coverage,
            self.half_width,
            100.0 * self.identifiable
        );
    }
}

/// What one data set gave of one quantity.
struct Found {
    at: f64,
    half_width: f64,
    identifiable: bool,
    profile: Option<[Option<f64>; 2]>,
}

impl Found {
    fn parameter(estimate: &Estimate, parameter: Parameter) -> Self {
        let identified = estimate.of(parameter);
        let coordinate = |value: f64| parameter.coordinate(value);
        Self {
            at: coordinate(identified.value),
            half_width: 1.959_964 * identified.standard_error,
            identifiable: identified.is_identifiable(),
            profile: identified
                .profile
                .map(|ends| ends.map(|end| end.map(coordinate))),
        }
    }

    fn combination(found: &Combination) -> Self {
        let [low, high] = found.interval.map(f64::ln);
        Self {
            at: found.value.ln(),
            half_width: 0.5 * (high - low),
            identifiable: true,
            profile: None,
        }
    }
}

/// Prints and returns what `count` noisy data sets made of `rows` give.
fn monte_carlo(terrain: &Terrain, rows: &[SteadyLoad], count: u64, profiled: u64) -> Vec<Recovery> {
    let start = Instant::now();
    let estimates: Vec<Estimate> = (0..count)
        .into_par_iter()
        .map(|run| {
            let rows = noisy(rows, Seed(1), run);
            let identification = Identification::new(&rows, terrain.class, &setting()).unwrap();
            let mut estimate = identification.estimate().unwrap();
            if run < profiled {
                identification.profile(&mut estimate);
            }
            estimate
        })
        .collect();
    let elapsed = start.elapsed().as_secs_f64();
    println!(
        "\n{}: {count} data sets of {} rows, {:.2} ms each on {} threads",
        terrain.name,
        rows.len(),
        1e3 * elapsed * rayon::current_num_threads() as f64 / count as f64,
        rayon::current_num_threads()
    );
    let mut table: Vec<Recovery> = Parameter::ALL
        .into_iter()
        .filter(|parameter| parameter.is_free(terrain.class))
        .map(|parameter| {
            let truth = parameter.coordinate(terrain.truth.get(parameter));
            let found: Vec<Found> = estimates
                .iter()
                .map(|estimate| Found::parameter(estimate, parameter))
                .collect();
            let mut recovery = Recovery::of(parameter.name(), truth, &found);
            if profiled > 0 {
                let profiles = Recovery::of("", truth, &found[..profiled as usize]);
                recovery.profile_coverage = profiles.profile_coverage;
            }
            recovery
        })
        .collect();
    table.extend(combinations(terrain, &estimates));
    table.iter().for_each(Recovery::print);
    let misfits = estimates.iter().filter(|e| !e.warnings.is_empty()).count();
    println!("  {misfits} with a warning");
    let mut kinds = std::collections::BTreeMap::new();
    for e in &estimates {
        for w in &e.warnings {
            *kinds
                .entry(format!("{w:?}").split(" {").next().unwrap().to_owned())
                .or_insert(0) += 1;
        }
    }
    println!("{kinds:?}");
    table
}

/// `k_s z^n0` where every data set has it.
fn combinations(terrain: &Terrain, estimates: &[Estimate]) -> Option<Recovery> {
    let TerrainParameters {
        sinkage_modulus,
        sinkage_exponent,
        ..
    } = terrain.truth;
    let truth = sinkage_modulus.ln() + sinkage_exponent * RIGID_SINKAGE.ln();
    if terrain.class == Wtic::Leis {
        return None;
    }
    let name = "k_s z^n0";
    let found: Option<Vec<Found>> = estimates
        .iter()
        .map(|estimate| {
            let known = estimate.combinations.iter().find(|c| c.name == name)?;
            Some(Found::combination(known))
        })
        .collect();
    found.map(|found| Recovery::of(name, truth, &found))
}

#[test]
fn loads_without_noise_give_every_identifiable_parameter_back_within_a_thousandth() {
    for terrain in [HARD, GRAVEL, SAND] {
        let estimate = terrain.identify(&terrain.rows(&LOADS));
        for identified in &estimate.parameters {
            if identified.is_identifiable() {
                let truth = terrain.truth.get(identified.parameter);
                let error = (identified.value - truth).abs() / truth.abs().max(1.0);
                let name = identified.parameter.name();
                assert!(
                    error < 1e-3,
                    "{} {name}: {}",
                    terrain.name,
                    identified.value
                );
            }
        }
    }
}

#[test]
#[ignore = "a minute: thousands of identifications"]
fn noisy_forces_give_the_parameters_with_honest_intervals() {
    for terrain in [SAND, GRAVEL, HARD] {
        let rows = with_uncertainty(&terrain.rows(&LOADS), [0.0, 0.0]);
        monte_carlo(&terrain, &rows, 1000, 200);
    }
    let one_load = with_uncertainty(&SAND.rows(&LOADS[1..2]), [0.0, 0.0]);
    monte_carlo(&SAND, &one_load, 1000, 100);
}
