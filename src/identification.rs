//! Terrain parameters from steady loads, slip and sinkage: the closed forms of
//! [`soil`](crate::soil::closed_form) run backward.
//!
//! The class of wheel-terrain interaction switches the model (Table 4): `c = K = 0`, `E = 1` where
//! all lugs touch (ALCT), `c = 0` where some do (SLCT), all parameters free where lugs enter the
//! soil (LEIS); sinkage is [0.01 mm](RIGID_SINKAGE) unless they do. Three least-squares stages
//! find `{c_1, c_2}` from Eq. (73), `{k_s, n_0, n_1}` from (74) and `{c, φ, K}` from (75), as in
//! the paper; from there all rows and three channels are fitted at once by Eq. (62)-(64).
//!
//! Conventions, all stated and none fitted: stresses are the paper's triangles; radius is the
//! rim's unless the [`Setting`] takes the [lugs' tips](Cylinder::LugTips); `c_3` is the setting's
//! (0 unless given); `j(θ_m)` is Wong and Reece's with that radius as shear surface.
//!
//! Parameters fitted to a lugged wheel hold what its lugs do, and every interval presumes the
//! model: where it misses the loads by more than their uncertainties, a
//! [warning](Warning::Misfit) says so.
//!
//! An [`Estimate`] says what the data fix and what they leave open: a parameter that they do not
//! fix has no interval and is [not identifiable](Standing::NotIdentifiable), and a
//! [`Combination`] names what is known of it together with others. On hard ground, for example,
//! `k_s` and `n_0` are not, `k_s z^n0` is.

mod combination;
mod directions;
mod estimate;
mod fitted;
mod force_error;
mod forces;
mod joint;
mod known;
mod least_squares;
mod model;
mod observation;
mod parameter;
mod plates;
mod precision;
mod prediction;
mod profile;
mod row;
mod stages;
mod steady;
mod warning;
mod weight;

pub use combination::Combination;
pub use estimate::{Estimate, Identified, Standing};
pub use force_error::ForceErrors;
pub use forces::{Force, PredictedForce};
pub use known::Known;
pub use least_squares::Termination;
pub use parameter::{Parameter, TerrainParameters};
pub use plates::{PlateError, PlateFit};
pub use prediction::{Predicted, Prediction, Predictor};
pub use row::{Cylinder, RIGID_SINKAGE, STATIC_SLIP, Setting, SteadyLoad, Uncertainty};
pub use stages::{Stage, Staged};
pub use steady::{CALIBRATION, SteadyError, steady_loads};
pub use warning::Warning;

use crate::quantity::RangeError;
use crate::terrain::class::Wtic;
use directions::Directions;
use forces::Knowledge;
use joint::Joint;
use least_squares::{Minimum, Residuals, minimise_from};
use model::Model;
use parameter::Coordinates;
use precision::Precision;
use profile::Profile;
use stages::{ANGLES, STRENGTHS};
use weight::Scale;

/// Why rows cannot be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// A number of the setting is out of its range.
    #[error("setting: {0}")]
    Setting(RangeError),
    /// A number of a row is out of its range.
    #[error("row {row}: {reason}")]
    Row {
        /// The row, from 1.
        row: usize,
        /// Column, range and value.
        reason: RangeError,
    },
    /// A stage has fewer rows than parameters.
    #[error("{stage} need {needed} rows or more for class {class}, got {given}{}", hint(.class))]
    TooFewRows {
        /// The stage.
        stage: Stage,
        /// The class.
        class: Wtic,
        /// Rows needed.
        needed: usize,
        /// Rows that count for the stage.
        given: usize,
    },
    /// All rows have the same slip.
    #[error(
        "all rows have slip {slip}: c2, n1 and K show in how loads change with slip; give rows at \
         two slips or more"
    )]
    OneSlip {
        /// The slip ratio [-].
        slip: f64,
    },
    /// The class is unknown, so that no model belongs to it.
    #[error(
        "class UWTIC has no model: Table 4 switches by ALCT, SLCT or LEIS only; give the class if \
         it is known otherwise"
    )]
    UnknownClass,
    /// No row has a torque, and there are fewer forces than parameters.
    #[error(
        "without driving torque {needed} rows or more are needed for class {class}, got {given}"
    )]
    TooFewPulls {
        /// The class.
        class: Wtic,
        /// Rows needed.
        needed: usize,
        /// Rows given.
        given: usize,
    },
    /// The equations gave no finite number from any start.
    #[error("the equations give no finite loads for these rows: check their units")]
    NotFinite,
}

fn hint(class: &Wtic) -> String {
    match class {
        Wtic::Alct => format!(" above slip {STATIC_SLIP} where torque is concerned"),
        _ => String::new(),
    }
}

/// Terrain parameters that best explain the rows (Eq. 76, then all equations at once), with both
/// kinds of interval.
///
/// # Errors
/// As [`Identification::new`] and [`Identification::estimate`].
pub fn identify(
    rows: &[SteadyLoad],
    class: Wtic,
    setting: &Setting,
) -> Result<Estimate, IdentifyError> {
    let identification = Identification::new(rows, class, setting)?;
    let mut estimate = identification.estimate()?;
    identification.profile(&mut estimate);
    Ok(estimate)
}

/// Rows checked for one class and setting.
#[derive(Debug, Clone)]
pub struct Identification {
    model: Model,
    rows: Vec<SteadyLoad>,
}

/// Slips [-] closer than this are one.
const SAME_SLIP: f64 = 1.0e-3;

/// Where fits begin: the middle of sands, and of the paper's exponents `n_0` for hard ground.
const START: TerrainParameters = TerrainParameters {
    stress_angle: 0.4,
    stress_angle_slip: 0.0,
    sinkage_modulus: 1.0e6,
    sinkage_exponent: 0.5,
    sinkage_exponent_slip: 0.5,
    cohesion: 300.0,
    friction_angle_deg: 30.0,
    shear_modulus: 0.01,
};

impl Identification {
    /// # Errors
    /// `UnknownClass` for [`Wtic::Uwtic`]; `Setting` and `Row` for numbers out of range, the row
    /// counted from 1; `TooFewRows` for a stage with fewer rows than parameters, `TooFewPulls`
    /// without torques; `OneSlip`.
    pub fn new(rows: &[SteadyLoad], class: Wtic, setting: &Setting) -> Result<Self, IdentifyError> {
        if class == Wtic::Uwtic {
            return Err(IdentifyError::UnknownClass);
        }
        let model = Model {
            class,
            setting: *setting,
        };
        let rows = row::seen(rows, class, setting)?;
        match rows.first() {
            Some(row) if !row.has_torque() => enough_without_torque(&model, &rows)?,
            _ => enough_for_stages(&model, &rows)?,
        }
        let slip = rows[0].slip;
        if rows.iter().all(|row| (row.slip - slip).abs() < SAME_SLIP) {
            return Err(IdentifyError::OneSlip { slip });
        }
        Ok(Self { model, rows })
    }

    /// The paper's three stages, one after the other; `None` without torques, which all three
    /// need.
    pub fn staged(&self) -> Option<Staged> {
        self.rows[0].has_torque().then(|| {
            let mut at = self.start();
            let terminations = Stage::ALL.map(|stage| self.advance(stage, &self.rows, &mut at));
            Staged {
                parameters: TerrainParameters::at(&at),
                terminations,
            }
        })
    }

    /// The stages, then all rows and channels at once, with intervals from the covariance.
    ///
    /// # Errors
    /// `NotFinite` where the equations give no finite loads.
    pub fn estimate(&self) -> Result<Estimate, IdentifyError> {
        let staged = self.staged();
        let joint = Joint::new(self.model, &self.rows);
        let best = self.best(&joint, staged.as_ref())?;
        let directions = Directions::new(&joint, &best.at, &self.model.free());
        let precision = self.precision(&joint, &best, &directions);
        let mut estimate = Estimate {
            class: self.model.class,
            terrain: TerrainParameters::at(&best.at),
            parameters: Parameter::ALL
                .map(|parameter| self.identified(parameter, &best.at, &directions, precision)),
            correlation: correlation(&directions),
            combinations: Vec::new(),
            staged,
            force_errors: ForceErrors::new(&self.model, &best.at, &self.rows),
            chi_square: best.chi_square,
            degrees_of_freedom: precision.freedom,
            termination: best.termination,
            warnings: warning::all(&self.model, &self.rows, &best, (&directions, precision)),
        };
        self.demote(&mut estimate, &best.at);
        self.combine(&mut estimate, &best.at, &directions, precision);
        Ok(estimate)
    }

    /// Adds the intervals from the profile of the likelihood to an estimate from these rows. A
    /// parameter whose profile says nothing useful is then no longer identified.
    pub fn profile(&self, estimate: &mut Estimate) {
        let Around {
            joint,
            best,
            directions,
            precision,
        } = self.around(estimate);
        let profile = Profile {
            joint: &joint,
            best,
            moved: &self.model.moved(),
            limit: precision.limit(),
        };
        for identified in &mut estimate.parameters {
            if directions.free().contains(&identified.parameter) {
                profile.complete(identified);
            }
        }
        self.combine(estimate, &best.at, &directions, precision);
    }

    /// Identifies no parameter that goes with one which the end of its range holds: it would be
    /// elsewhere if that one could go on.
    fn demote(&self, estimate: &mut Estimate, at: &Coordinates) {
        const TOGETHER: f64 = 0.9;
        let free = self.model.free();
        let moved = self.model.moved();
        let held = |p: Parameter| moved.contains(&p) && p.is_at_bound(at[p as usize]);
        for (row, parameter) in free.iter().enumerate() {
            let goes_with = |column: usize| {
                let correlation = estimate.correlation[row][column];
                column != row && correlation.is_none_or(|c| c.abs() > TOGETHER)
            };
            let leans = (0..free.len()).any(|column| held(free[column]) && goes_with(column));
            let identified = &mut estimate.parameters[*parameter as usize];
            if held(*parameter) || leans {
                identified.standing = Standing::NotIdentifiable;
                identified.interval = [None; 2];
            }
        }
    }

    /// The forces of `rows` as an estimate from this identification's rows predicts them from slip
    /// and sinkage, with 95 % intervals for what is measured, row by row.
    ///
    /// An interval holds the estimate's own error and the row's scatter about the model, taken to
    /// be as large, over its stated uncertainties, as that of the rows fitted. Pull and torque of
    /// a wheel that static friction holds on hard ground are not predicted.
    ///
    /// # Errors
    /// `Row` for the first number of `rows` out of its range.
    pub fn predict(
        &self,
        estimate: &Estimate,
        rows: &[SteadyLoad],
    ) -> Result<Vec<PredictedForce>, IdentifyError> {
        let Around {
            best,
            directions,
            precision,
            ..
        } = self.around(estimate);
        let knowledge = Knowledge {
            model: &self.model,
            at: best.at,
            directions,
            precision,
            scale: Scale::of(&self.rows),
        };
        let rows = row::seen(rows, self.model.class, &self.model.setting)?;
        let forces = rows.iter().flat_map(|row| knowledge.forces(row));
        Ok(forces.collect())
    }

    /// How the rows see an estimate made of them.
    fn around(&self, estimate: &Estimate) -> Around {
        let joint = Joint::new(self.model, &self.rows);
        let best = Minimum {
            at: estimate.terrain.coordinates(),
            chi_square: estimate.chi_square,
            termination: estimate.termination,
        };
        let directions = Directions::new(&joint, &best.at, &self.model.free());
        let precision = self.precision(&joint, &best, &directions);
        Around {
            joint,
            best,
            directions,
            precision,
        }
    }

    /// Names what is known of the parameters that are not identified.
    fn combine(
        &self,
        estimate: &mut Estimate,
        at: &Coordinates,
        directions: &Directions,
        precision: Precision,
    ) {
        let identified = |of: &&Identified| of.is_identifiable();
        let known: Vec<Parameter> = estimate
            .parameters
            .iter()
            .filter(identified)
            .map(|identified| identified.parameter)
            .collect();
        let told = (&known[..], precision.reach());
        estimate.combinations = combination::fixed(&self.model, at, &self.rows, directions, told);
    }

    /// What is known before any row: the start, switched to the class.
    fn start(&self) -> Coordinates {
        let mut start = START.coordinates();
        self.model.switch(&mut start);
        start
    }

    fn advance(&self, stage: Stage, rows: &[SteadyLoad], at: &mut Coordinates) -> Termination {
        match stages::run(stage, &self.model, rows, *at) {
            Some(minimum) => {
                *at = minimum.at;
                minimum.termination
            }
            None => Termination::NotFinite,
        }
    }

    /// The least of the minima that the starts lead to; of many more where the first ends at the
    /// end of a range or misses the rows, as along the ridge that one load makes of `k_s` and
    /// `n_0`.
    fn best(&self, joint: &Joint, staged: Option<&Staged>) -> Result<Minimum, IdentifyError> {
        let moved = self.model.moved();
        let first = minimise_from(joint, self.starts(staged), &moved);
        let first = first.ok_or(IdentifyError::NotFinite)?;
        let freedom = joint.forces().saturating_sub(moved.len());
        let missed = Precision::new(Scale::of(&self.rows).known, first.chi_square, freedom);
        let held = |p: &Parameter| p.is_at_bound(first.at[*p as usize]);
        if missed.misfit.is_none() && !moved.iter().any(held) {
            return Ok(first);
        }
        let nearest = nearest(joint, self.more_starts(first.at));
        let more = minimise_from(joint, nearest, &moved);
        Ok(more
            .filter(|more| more.chi_square < first.chi_square)
            .unwrap_or(first))
    }

    /// Starts with the angles of `at`, exponents from plates on loose to layered soils, and
    /// strengths from loose to crusted sands.
    fn more_starts(&self, at: Coordinates) -> Vec<Coordinates> {
        const EXPONENTS: [f64; 4] = [0.3, 0.8, 1.3, 2.0];
        let angles = ANGLES.map(|[c_1, c_2]| {
            [
                (Parameter::StressAngle, c_1),
                (Parameter::StressAngleSlip, c_2),
            ]
        });
        let mut starts = Vec::new();
        for exponent in EXPONENTS {
            for angles in angles {
                for strength in STRENGTHS {
                    let mut start = at;
                    let shear = Stage::ShearStress.parameters().iter().copied();
                    let set = angles.into_iter().chain(shear.zip(strength));
                    for (parameter, value) in set.chain([(Parameter::SinkageExponent, exponent)]) {
                        start[parameter as usize] = parameter.coordinate(value);
                    }
                    self.model.switch(&mut start);
                    starts.push(self.with_pressure(start));
                }
            }
        }
        starts
    }

    /// `at` with the sinkage modulus that carries the mean load.
    fn with_pressure(&self, mut at: Coordinates) -> Coordinates {
        let modulus = Parameter::SinkageModulus;
        if !self.model.moved().contains(&modulus) {
            return at;
        }
        let soil = self.model.soil(&at);
        let ratio =
            |row: &SteadyLoad| row.load / self.model.contact(&at, row).loads(&soil).normal_force;
        let logarithms = self
            .rows
            .iter()
            .map(ratio)
            .filter(|r| *r > 0.0)
            .map(libm::log);
        let sum: f64 = logarithms.sum();
        at[modulus as usize] += sum / self.rows.len() as f64;
        at
    }

    /// Where the fit of all rows begins: at the stages' result, and at that of the later stages
    /// with the usual angles, for noise may lead the first stage far astray. Without torques, at
    /// the later stages' results for those torques that different angles leave.
    fn starts(&self, staged: Option<&Staged>) -> Vec<Coordinates> {
        let usual = self.start();
        if let Some(staged) = staged {
            let begun = staged.parameters.coordinates();
            return vec![begun, self.later_stages(&self.rows, usual)];
        }
        let angles = ANGLES.map(|[c_1, c_2]| {
            let mut at = usual;
            at[Parameter::StressAngle as usize] = c_1;
            at[Parameter::StressAngleSlip as usize] = c_2;
            self.model.switch(&mut at);
            at
        });
        let begun = angles.into_iter().chain([usual]).map(|at| {
            let torque = |row| self.model.with_torque(&at, row);
            let rows: Vec<SteadyLoad> = self.rows.iter().map(torque).collect();
            self.later_stages(&rows, at)
        });
        begun.collect()
    }

    fn later_stages(&self, rows: &[SteadyLoad], mut at: Coordinates) -> Coordinates {
        for stage in [Stage::NormalStress, Stage::ShearStress] {
            self.advance(stage, rows, &mut at);
        }
        at
    }

    /// What the data say of one parameter.
    fn identified(
        &self,
        parameter: Parameter,
        at: &Coordinates,
        directions: &Directions,
        precision: Precision,
    ) -> Identified {
        let coordinate = at[parameter as usize];
        let value = parameter.value(coordinate);
        let told = |standing, standard_error, interval| Identified {
            parameter,
            value,
            standing,
            standard_error,
            interval,
            profile: None,
        };
        if let Some(standing) = self.model.standing(parameter) {
            return told(standing, 0.0, [Some(value); 2]);
        }
        let unit = directions.function(unit(parameter));
        let deviation = directions
            .covariance(&unit, &unit)
            .map_or(f64::INFINITY, libm::sqrt);
        let half = precision.reach() * deviation;
        let standard_error = precision.sigma * deviation;
        if half <= parameter.uninformative() {
            let ends = [coordinate - half, coordinate + half];
            let interval = ends.map(|end| Some(parameter.value(end)));
            told(Standing::Identified, standard_error, interval)
        } else {
            told(Standing::NotIdentifiable, standard_error, [None; 2])
        }
    }

    fn precision(&self, joint: &Joint, best: &Minimum, directions: &Directions) -> Precision {
        let freedom = joint.forces().saturating_sub(directions.rank());
        Precision::new(Scale::of(&self.rows).known, best.chi_square, freedom)
    }
}

/// An estimate as the rows it was made of see it.
struct Around {
    joint: Joint,
    best: Minimum,
    directions: Directions,
    precision: Precision,
}

/// The few starts that explain the rows best as they are.
fn nearest(joint: &Joint, starts: Vec<Coordinates>) -> impl Iterator<Item = Coordinates> {
    const DESCENTS: usize = 4;
    let square = |at: &Coordinates| joint.residuals(at).iter().map(|r| r * r).sum::<f64>();
    let mut ranked: Vec<(f64, Coordinates)> =
        starts.into_iter().map(|at| (square(&at), at)).collect();
    ranked.sort_by(|one, other| one.0.total_cmp(&other.0));
    ranked.into_iter().take(DESCENTS).map(|(_, at)| at)
}

/// # Errors
/// `TooFewRows` for the first stage that cannot be fitted.
fn enough_for_stages(model: &Model, rows: &[SteadyLoad]) -> Result<(), IdentifyError> {
    for stage in Stage::ALL {
        let given = model.rows_of(stage, rows).len();
        let needed = model.moved_among(stage.parameters()).len();
        if given < needed {
            return Err(IdentifyError::TooFewRows {
                stage,
                class: model.class,
                needed,
                given,
            });
        }
    }
    Ok(())
}

/// # Errors
/// `TooFewPulls` where loads and pulls are fewer than parameters.
fn enough_without_torque(model: &Model, rows: &[SteadyLoad]) -> Result<(), IdentifyError> {
    let needed = model.moved().len().div_ceil(2);
    if rows.len() >= needed {
        return Ok(());
    }
    Err(IdentifyError::TooFewPulls {
        class: model.class,
        needed,
        given: rows.len(),
    })
}

/// The linear function that is one parameter itself.
fn unit(parameter: Parameter) -> impl Fn(Parameter) -> f64 {
    move |other| f64::from(u8::from(other == parameter))
}

/// Correlation of the free parameters.
fn correlation(directions: &Directions) -> Vec<Vec<Option<f64>>> {
    let units: Vec<Vec<f64>> = directions
        .free()
        .iter()
        .map(|&parameter| directions.function(unit(parameter)))
        .collect();
    let entry = |one: &Vec<f64>, other: &Vec<f64>| {
        let variances = directions.covariance(one, one)? * directions.covariance(other, other)?;
        Some(directions.covariance(one, other)? / libm::sqrt(variances))
    };
    let row = |one| units.iter().map(|other| entry(one, other)).collect();
    units.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::soil::closed_form::{self, Rim};
    use crate::soil::wheel_load::sinkage_at;
    use crate::soil::{Soil, table_6};
    use crate::wheel::Wheel;
    use rand::RngExt;

    const SLIPS: [f64; 9] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6];

    fn setting() -> Setting {
        Setting::new(Rim::from(&Wheel::rover()))
    }

    fn rows(soil: &Soil, slips: &[f64], loads: &[f64]) -> Vec<SteadyLoad> {
        let smooth = Wheel {
            lugs: None,
            ..Wheel::rover()
        };
        let row = |slip: f64, load: f64| {
            let sinkage = sinkage_at(&smooth, soil, load, slip).unwrap();
            let loads = closed_form::loads(setting().rim, soil, sinkage, slip);
            SteadyLoad {
                slip,
                sinkage,
                drawbar_pull: loads.drawbar_pull,
                load: loads.normal_force,
                driving_torque: loads.driving_torque,
                uncertainty: None,
            }
        };
        let pairs = loads
            .iter()
            .flat_map(|&load| slips.iter().map(move |&slip| (slip, load)));
        pairs.map(|(slip, load)| row(slip, load)).collect()
    }

    /// Rows on ground that lugs do not enter, whose sinkage nobody measures.
    fn rigid(soil: &Soil, rim: Rim, slips: &[f64]) -> Vec<SteadyLoad> {
        let row = |&slip: &f64| {
            let loads = closed_form::loads(rim, soil, RIGID_SINKAGE, slip);
            SteadyLoad {
                slip,
                sinkage: f64::NAN,
                drawbar_pull: loads.drawbar_pull,
                load: loads.normal_force,
                driving_torque: loads.driving_torque,
                uncertainty: None,
            }
        };
        slips.iter().map(row).collect()
    }

    fn sand(slips: &[f64], loads: &[f64]) -> Vec<SteadyLoad> {
        rows(&table_6::sand(), slips, loads)
    }

    #[test]
    fn fits_from_at_least_95_of_100_random_starts_agree() {
        let rows = sand(&SLIPS, &[60.0, 109.0, 200.0]);
        let identification = Identification::new(&rows, Wtic::Leis, &setting()).unwrap();
        let truth = identification.estimate().unwrap().terrain.coordinates();
        let joint = Joint::new(identification.model, &identification.rows);
        let mut rng = Seed(1).rng("starts", 0);
        let mut agree = 0;
        for _ in 0..100 {
            let mut draw = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
            let start = TerrainParameters {
                stress_angle: draw(0.0, 1.0),
                stress_angle_slip: draw(-1.0, 1.0),
                sinkage_modulus: libm::pow(10.0, draw(4.0, 8.0)),
                sinkage_exponent: draw(0.3, 1.7),
                sinkage_exponent_slip: draw(0.0, 2.0),
                cohesion: libm::pow(10.0, draw(0.0, 4.0)),
                friction_angle_deg: draw(10.0, 50.0),
                shear_modulus: libm::pow(10.0, draw(-4.0, -1.0)),
            };
            let found = minimise_from(&joint, [start.coordinates()], &Parameter::ALL).unwrap();
            let distance = truth.iter().zip(found.at).map(|(t, f)| (t - f).abs());
            if distance.fold(0.0, f64::max) < 1e-4 {
                agree += 1;
            }
        }
        assert!(agree >= 95, "{agree} of 100");
    }

    /// Uncertainties of 2 % of every force, which the rows do not have.
    fn stated(rows: Vec<SteadyLoad>) -> Vec<SteadyLoad> {
        let uncertain = |row: SteadyLoad| SteadyLoad {
            uncertainty: Some(Uncertainty {
                slip: 0.0,
                sinkage: 0.0,
                drawbar_pull: 0.02 * row.drawbar_pull.abs().max(1.0),
                load: 0.02 * row.load,
                driving_torque: 0.02 * row.driving_torque.abs().max(0.1),
            }),
            ..row
        };
        rows.into_iter().map(uncertain).collect()
    }

    fn message(rows: &[SteadyLoad], class: Wtic) -> String {
        let refused = Identification::new(rows, class, &setting()).unwrap_err();
        refused.to_string()
    }

    #[test]
    fn a_bad_number_is_refused_with_its_row_column_and_value() {
        let good = sand(&SLIPS, &[109.0]);
        let with = |change: fn(&mut SteadyLoad)| {
            let mut rows = good.clone();
            change(&mut rows[2]);
            message(&rows, Wtic::Leis)
        };
        assert_eq!(
            with(|row| row.load = -109.0),
            "row 3: load [N] must be above 0 and finite, got -109"
        );
        assert_eq!(
            with(|row| row.sinkage = 0.2),
            "row 3: sinkage [m] must be above 0 and not above the radius 0.155, got 0.2"
        );
        assert_eq!(
            with(|row| row.slip = f64::NAN),
            "row 3: slip ratio [-] must be in [-1, 1], got NaN"
        );
        assert!(with(|row| row.drawbar_pull = f64::NAN).ends_with("got NaN"));
        assert!(with(|row| row.driving_torque = f64::INFINITY).contains("driving torque [N·m]"));
        let mut rows = stated(good);
        rows[0].uncertainty.as_mut().unwrap().load = 0.0;
        assert!(message(&rows, Wtic::Leis).starts_with("row 1: uncertainty of the load [N]"));
    }

    #[test]
    fn an_unknown_class_has_no_model() {
        let message = message(&sand(&SLIPS, &[109.0]), Wtic::Uwtic);
        assert!(message.starts_with("class UWTIC has no model"), "{message}");
    }

    #[test]
    fn rows_are_counted_for_each_stage() {
        let rows = sand(&[0.0, 0.3], &[109.0]);
        assert_eq!(
            message(&rows, Wtic::Leis),
            "k_s, n0 and n1 (Eq. 74) need 3 rows or more for class LEIS, got 2"
        );
        let held = sand(&[0.0, 0.005], &[109.0]);
        assert_eq!(
            message(&held, Wtic::Alct),
            "c, phi and K (Eq. 75) need 1 rows or more for class ALCT, got 0 above slip 0.01 \
             where torque is concerned"
        );
        assert!(Identification::new(&rows, Wtic::Slct, &setting()).is_ok());
        assert_eq!(
            Wtic::Leis,
            identify(&sand(&SLIPS[..6], &[109.0]), Wtic::Leis, &setting())
                .unwrap()
                .class
        );
    }

    #[test]
    fn one_slip_tells_nothing_of_slip() {
        let message = message(&sand(&[0.2], &[60.0, 109.0, 200.0]), Wtic::Leis);
        assert!(
            message.starts_with("all rows have slip 0.2: c2, n1 and K"),
            "{message}"
        );
    }

    #[test]
    fn three_rows_fix_a_sand_only_as_far_as_uncertainties_are_stated() {
        let rows = sand(&[0.1, 0.3, 0.6], &[109.0]);
        // Nine forces, eight parameters: one degree of freedom.
        let scattered = identify(&rows, Wtic::Leis, &setting()).unwrap();
        assert_eq!(scattered.degrees_of_freedom, 1);
        // Six forces and, k_s and n0 counted once, six parameters.
        let two = rigid(&table_6::gravel(), setting().rim, &[0.1, 0.3]);
        let free = identify(&two, Wtic::Slct, &setting()).unwrap();
        assert_eq!(free.warnings, [Warning::NoFreedom]);
        assert!(free.parameters[..5].iter().all(|p| p.ci95() == [None; 2]));
        let known = identify(&stated(two), Wtic::Slct, &setting()).unwrap();
        assert!(known.of(Parameter::SinkageExponentSlip).is_identifiable());
    }

    #[test]
    fn one_load_leaves_modulus_exponents_and_cohesion_open_but_not_the_pressure() {
        let rows = stated(sand(&SLIPS, &[109.0]));
        let estimate = identify(&rows, Wtic::Leis, &setting()).unwrap();
        let open: Vec<&str> = estimate
            .parameters
            .iter()
            .filter(|identified| !identified.is_identifiable())
            .map(|identified| identified.parameter.name())
            .collect();
        assert_eq!(open, ["k_s", "n0", "n1", "c"]);
        let names: Vec<&str> = estimate.combinations.iter().map(|c| c.name).collect();
        assert!(names.contains(&"k_s z^(n0 + n1 s)"), "{names:?}");
        assert!(names.contains(&"c + sigma tan(phi)"), "{names:?}");
    }

    #[test]
    fn static_friction_at_slip_0_does_not_move_hard_ground() {
        let soil = table_6::hard();
        let mut rows = rigid(&soil, setting().rim, &[0.0, 0.05, 0.1, 0.3, 0.6]);
        rows[0].drawbar_pull *= 0.4;
        rows[0].driving_torque *= 0.4;
        let estimate = identify(&rows, Wtic::Alct, &setting()).unwrap();
        let phi = estimate.of(Parameter::FrictionAngle);
        assert!(
            (phi.value - soil.friction_angle_deg).abs() < 1e-6,
            "{}",
            phi.value
        );
        let pressure = soil.frictional_modulus * RIGID_SINKAGE.powf(soil.sinkage_exponent);
        let product = &estimate.combinations[0];
        assert_eq!(
            (product.name, product.place.as_str()),
            ("k_s z^n0", "z = 1.000e-5 m")
        );
        assert!((product.value / pressure - 1.0).abs() < 1e-9);
        // Table 7 without slip 0, as Fig. 25b.
        assert!(estimate.force_errors.drawbar_pull.unwrap() < 1e-6);
    }

    #[test]
    fn loads_at_the_lugs_edges_belong_to_their_circle() {
        let tips = Setting {
            lug_height: 0.010,
            cylinder: Cylinder::LugTips,
            ..setting()
        };
        let soil = table_6::hard();
        let mut rows = rigid(&soil, tips.surface(), &[0.02, 0.1, 0.3, 0.6]);
        for row in &mut rows {
            // The same motion by the rim's radius: the travel per turn is (r + l)/r longer.
            let ratio = (1.0 - row.slip) * tips.surface().radius / setting().rim.radius;
            row.slip = if ratio < 1.0 {
                1.0 - ratio
            } else {
                1.0 / ratio - 1.0
            };
        }
        let at_tips = identify(&rows, Wtic::Alct, &tips).unwrap();
        let phi = at_tips.terrain.friction_angle_deg;
        assert!((phi - soil.friction_angle_deg).abs() < 1e-6, "{phi}");
        let at_rim = identify(
            &rows,
            Wtic::Alct,
            &Setting {
                cylinder: Cylinder::Rim,
                ..tips
            },
        );
        // The rim's torque per pull is l/r = 6.5 % short: pull and torque cannot both be met.
        assert!(at_rim.unwrap().chi_square > 1e6 * at_tips.chi_square);
    }

    #[test]
    fn a_profile_is_the_covariance_where_the_model_is_straight_and_leans_where_it_bends() {
        let rows = stated(sand(&SLIPS, &[60.0, 109.0, 200.0]));
        let estimate = identify(&rows, Wtic::Leis, &setting()).unwrap();
        let relative = |parameter: Parameter| {
            let identified = estimate.of(parameter);
            let half = |interval: [Option<f64>; 2]| {
                interval.map(|end| {
                    let end = parameter.coordinate(end.unwrap());
                    (end - parameter.coordinate(identified.value)).abs()
                })
            };
            let (profile, covariance) =
                (half(identified.profile.unwrap()), half(identified.interval));
            [profile[0] / covariance[0], profile[1] / covariance[1]]
        };
        for parameter in [Parameter::FrictionAngle, Parameter::SinkageExponent] {
            let [low, high] = relative(parameter);
            assert!(
                (low - 1.0).abs() < 0.05 && (high - 1.0).abs() < 0.05,
                "{low}, {high}"
            );
        }
        // Forces are straight in c, so in ln c the lower end lies farther out.
        let [low, high] = relative(Parameter::Cohesion);
        assert!(low > 1.1 && high < 0.95, "{low}, {high}");
    }

    #[test]
    fn uncertainties_of_some_rows_are_ignored_and_that_is_told() {
        let mut rows = stated(sand(&SLIPS, &[109.0]));
        rows[3].uncertainty = None;
        let identification = Identification::new(&rows, Wtic::Leis, &setting()).unwrap();
        let warnings = identification.estimate().unwrap().warnings;
        assert!(
            warnings.contains(&Warning::UncertaintiesIgnored),
            "{warnings:?}"
        );
    }

    #[test]
    fn scatter_beyond_the_uncertainties_widens_the_intervals() {
        let mut rows = stated(sand(&SLIPS, &[60.0, 109.0, 200.0]));
        let estimate = |rows: &[SteadyLoad]| {
            let identification = Identification::new(rows, Wtic::Leis, &setting()).unwrap();
            identification.estimate().unwrap()
        };
        let error = |e: &Estimate| e.of(Parameter::FrictionAngle).standard_error;
        let stated = error(&estimate(&rows));
        for (index, row) in rows.iter_mut().enumerate() {
            // Ten per cent, five uncertainties, up and down.
            row.driving_torque *= if index % 2 == 0 { 1.1 } else { 0.9 };
        }
        let scattered = estimate(&rows);
        assert!(error(&scattered) > 2.0 * stated);
        assert!(matches!(
            scattered.warnings[..],
            [Warning::Misfit { .. }, ..]
        ));
    }
}
