//! Terrain parameters from steady loads, slip and sinkage: the inverse problem of the laws in
//! [`soil`](crate::soil).
//!
//! Two laws give the loads of soil that lugs enter:
//!
//! - [`Law::Paper`]: the [closed forms](crate::soil::closed_form) (62)-(66), triangular stress on a smooth
//!   cylinder. The effect of the lugs is absorbed by the parameters.
//! - [`Law::Own`]: the simulator's [quadrature](crate::soil::wheel_load) over rim and lugs. The parameters
//!   are those of the soil, given the assumed stress distribution, `c_3`, density and lugs.
//!
//! Both are evaluated with their derivatives ([`crate::soil::real`]). On ground that lugs do not enter,
//! (62)-(69) apply. True slip and sinkage of each row are nuisance parameters, eliminated at every evaluation
//! (errors in variables).
//!
//! The class of wheel-terrain interaction selects the model (Table 4): `c = K = 0`, `E = 1` where all lugs
//! touch (ALCT); `c = 0` where some do (SLCT); all parameters free where lugs enter the soil (LEIS). Sinkage
//! is [0.01 mm](RIGID_SINKAGE) in the first two. Three least-squares stages of the closed forms find `{c_1,
//! c_2}` from Eq. (73), `{k_s, n_0, n_1}` from (74) and `{c, φ, K}` from (75), as in the paper; they start a
//! joint fit of all rows and three channels by either law.
//!
//! Conventions of the closed forms, stated and not fitted: triangular stress; the rim's radius unless the
//! [`Setting`] takes the [lugs' tips](Cylinder::LugTips); `c_3` of the setting (default 0); `j(θ_m)` of Wong
//! and Reece with that radius as shear surface.
//!
//! All intervals are conditional on the model. Where the residuals exceed the stated uncertainties, the
//! estimate carries a [misfit warning](Warning::Misfit).
//!
//! A parameter at a bound of the search, or with an interval wider than is informative, is [not
//! identifiable](Standing::NotIdentifiable), with the [reason](Unidentifiable); identifiable functions of several
//! parameters are given as [`Combination`]s. On hard ground, for example, `k_s` and `n_0` are not
//! identifiable but `k_s z^n0` is. In soil under one load neither `k_s`, `n_0`, `n_1` nor `c`, `φ` are: along
//! the ridge of equal likelihood the estimate takes the greatest posterior density under a wide normal prior
//! for `n_0`, with a [warning](Warning::ExponentAssumed).

mod combination;
mod directions;
mod drift;
mod estimate;
mod exponent_prior;
mod fitted;
mod force_error;
mod forces;
mod joint;
mod known;
mod law;
mod least_squares;
mod load_missed;
mod model;
mod observation;
mod parameter;
mod plates;
mod point;
mod pooling;
mod precision;
mod prediction;
mod prediction_error;
mod pressing;
mod pressure_sinkage;
mod profile;
mod row;
mod scope;
mod search;
mod stage;
mod stages;
mod standing;
mod steady;
mod warning;
mod weight;

pub use combination::Combination;
pub use drift::{Drift, SteadyRow};
pub use estimate::{Estimate, Identified, Unidentifiable};
pub use force_error::ForceErrors;
pub use forces::{Force, PredictedForce};
pub use known::Known;
pub use law::{Law, Own};
pub use least_squares::Termination;
pub use load_missed::LoadMissed;
pub use parameter::{Parameter, TerrainParameters};
pub use plates::{PlateError, PlateFit};
pub use pooling::pool;
pub use prediction::{Predicted, Prediction, Predictor};
pub use prediction_error::PredictionErrors;
pub use pressing::Pressing;
pub use pressure_sinkage::{Interval, Moduli, PlateSize, PressureSinkage, Resampled};
pub use row::{Cylinder, RIGID_SINKAGE, STATIC_SLIP, Setting, SteadyLoad, Uncertainty};
pub use scope::Scope;
pub use stage::Stage;
pub use stages::Staged;
pub use standing::Standing;
pub use steady::{CALIBRATION, SteadyError, Stretch, steady_loads, steady_rows, steady_stretches};
pub use warning::Warning;

use crate::quantity::RangeError;
use crate::terrain::class::Wtic;
use combination::Resolution;
use directions::Directions;
use forces::Knowledge;
use joint::Joint;
use least_squares::{Minimum, minimise_from};
use model::Model;
use parameter::Coordinates;
use precision::Precision;
use profile::Profile;
use rayon::prelude::*;
use search::Search;
use std::cell::Cell;
use weight::Scale;

/// Why parameters cannot be identified from the rows.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
        /// Rows usable in the stage.
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
    /// The class is unknown: no model applies.
    #[error(
        "class UWTIC has no model: Table 4 switches by ALCT, SLCT or LEIS only; give the class if \
         it is known otherwise"
    )]
    UnknownClass,
    /// Some rows have no torque, and loads and pulls are fewer than parameters.
    #[error(
        "where driving torque is missing {needed} rows or more are needed for class {class}, got {given}"
    )]
    TooFewPulls {
        /// The class.
        class: Wtic,
        /// Rows needed.
        needed: usize,
        /// Rows given.
        given: usize,
    },
    /// The equations gave no finite loads from any start.
    #[error("the equations give no finite loads for these rows: check their units")]
    NotFinite,
}

fn hint(class: &Wtic) -> String {
    match class {
        Wtic::Alct => format!(" above slip {STATIC_SLIP} where torque is concerned"),
        _ => String::new(),
    }
}

/// Least-squares estimate of the terrain parameters (Eq. 76, then the joint fit), with covariance and
/// profile-likelihood intervals.
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

/// Rows validated for one class and setting.
#[derive(Debug, Clone)]
pub struct Identification {
    model: Model,
    rows: Vec<SteadyLoad>,
}

/// Slips [-] closer than this count as equal.
const SAME_SLIP: f64 = 1.0e-3;

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
        let rows = row::on_cylinder(rows, class, setting)?;
        if rows.iter().all(SteadyLoad::has_torque) {
            // A row counts if rim or lugs are in the soil.
            let in_soil = rows.iter().map(|row| SteadyLoad {
                sinkage: model.depth(row.sinkage),
                ..*row
            });
            enough_for_stages(&model, &in_soil.collect::<Vec<_>>())?;
        } else {
            enough_without_torque(&model, &rows)?;
        }
        let slip = rows[0].slip;
        let same = rows.iter().all(|row| (row.slip - slip).abs() < SAME_SLIP);
        let of_slip = [
            Parameter::StressAngleSlip,
            Parameter::SinkageExponentSlip,
            Parameter::ShearModulus,
        ];
        if same && !model.moved_among(&of_slip).is_empty() {
            return Err(IdentifyError::OneSlip { slip });
        }
        Ok(Self { model, rows })
    }

    /// The paper's three stages in sequence, over the rows with a torque; `None` where a stage has too few.
    pub fn staged(&self) -> Option<Staged> {
        self.search().staged()
    }

    fn search(&self) -> Search<'_> {
        Search {
            model: &self.model,
            rows: &self.rows,
        }
    }

    /// The stages, then the joint fit of all rows and channels, with intervals from the covariance.
    ///
    /// # Errors
    /// `NotFinite` where the equations give no finite loads.
    pub fn estimate(&self) -> Result<Estimate, IdentifyError> {
        let staged = self.staged();
        let joint = Joint::new(self.model, &self.rows);
        let best = self.search().best(&joint, staged.as_ref());
        let best = best.ok_or(IdentifyError::NotFinite)?;
        let mut estimate = self.estimate_from(&self.local_model(joint, best), staged);
        self.apply_exponent_prior(&mut estimate);
        Ok(estimate)
    }

    /// An estimate whose search starts only from another one's parameters, for rows mostly in common
    /// (resampling).
    ///
    /// # Errors
    /// `NotFinite` where the equations give no finite loads.
    pub fn estimate_near(&self, other: &Estimate) -> Result<Estimate, IdentifyError> {
        let mut start = other.terrain.coordinates();
        self.model.switch(&mut start);
        let joint = Joint::new(self.model, &self.rows);
        let best = minimise_from(&joint, [start], &self.model.moved());
        let best = best.ok_or(IdentifyError::NotFinite)?;
        let mut estimate = self.estimate_from(&self.local_model(joint, best), None);
        self.apply_exponent_prior(&mut estimate);
        Ok(estimate)
    }

    /// The estimate at a minimum, with covariance intervals.
    fn estimate_from(&self, local: &LocalModel, staged: Option<Staged>) -> Estimate {
        let LocalModel {
            best,
            directions,
            precision,
            ..
        } = local;
        let mut estimate = Estimate {
            class: self.model.class,
            terrain: TerrainParameters::at(&best.at),
            parameters: Parameter::ALL.map(|parameter| self.identified(parameter, local)),
            correlation: correlation(directions),
            combinations: Vec::new(),
            staged,
            force_errors: ForceErrors::new(&self.model, &best.at, &self.rows),
            chi_square: best.chi_square,
            degrees_of_freedom: precision.freedom,
            termination: best.termination,
            warnings: warning::all(&self.model, &self.rows, local),
            minimum: *best,
        };
        self.mark_at_bounds(&mut estimate, local);
        self.mark_confounded_under_one_load(&mut estimate);
        self.mark_peak_at_end(&mut estimate, &best.at);
        self.add_combinations(&mut estimate, local);
        estimate
    }

    /// Marks `c_1`, `c_2` and `K` as not identifiable where the stress peak is at an end of the contact: its
    /// position is then set by the bound, and `K` compensates for it.
    fn mark_peak_at_end(&self, estimate: &mut Estimate, at: &Coordinates) {
        use Parameter as P;
        if self.model.peak_at_end(at, &self.rows).is_some() {
            let bounded = [P::StressAngle, P::StressAngleSlip, P::ShearModulus];
            estimate.mark_unidentifiable(&bounded, Unidentifiable::PeakAtEnd);
        }
    }

    /// Under one load, marks parameters that act only in combination as not identifiable, unless another of
    /// the combination is given. The shape of the stress over the contact would separate them, but that is an
    /// assumption of the model and not evidence from the rows.
    fn mark_confounded_under_one_load(&self, estimate: &mut Estimate) {
        use Parameter as P;
        if self.model.class != Wtic::Leis || !Scope::is_one_load(&self.rows) {
            return;
        }
        let is_given = |parameter: P| estimate.of(parameter).standing == Standing::Given;
        let strength_is_split = is_given(P::Cohesion) || is_given(P::FrictionAngle);
        let pressure_is_split = is_given(P::SinkageModulus) || is_given(P::SinkageExponent);
        if !strength_is_split {
            estimate.mark_unidentifiable(&[P::Cohesion, P::FrictionAngle], Unidentifiable::OneLoad);
        }
        if !pressure_is_split {
            estimate.mark_unidentifiable(Stage::NormalStress.parameters(), Unidentifiable::OneLoad);
        }
    }

    /// Adds profile-likelihood intervals to an estimate from these rows. A parameter with an uninformative
    /// profile becomes not identifiable. If the profile finds a lower minimum, the estimate moves there
    /// first.
    pub fn profile(&self, estimate: &mut Estimate) {
        const MOVES: u32 = 3;
        let mut moves = 0;
        while let Some(lower) = self.profile_once(estimate)
            && moves < MOVES
        {
            let joint = Joint::new(self.model, &self.rows);
            let moved = minimise_from(&joint, [lower.at], &self.model.moved());
            let moved = moved.unwrap_or(lower);
            *estimate = self.estimate_from(&self.local_model(joint, moved), estimate.staged);
            moves += 1;
        }
        self.apply_exponent_prior(estimate);
    }

    /// Where `n_0` is not identifiable, moves the estimate to the point of greatest posterior density along
    /// the ridge ([`exponent_prior`]).
    fn apply_exponent_prior(&self, estimate: &mut Estimate) {
        let exponent = estimate.of(Parameter::SinkageExponent);
        if exponent.standing != Standing::NotIdentifiable || !self.model.splits_pressure() {
            return;
        }
        let LocalModel {
            joint,
            best,
            precision,
            ..
        } = self.local_model(Joint::new(self.model, &self.rows), estimate.minimum);
        let Some(posterior) =
            exponent_prior::maximum_a_posteriori(&joint, &best, &self.model.moved(), precision)
        else {
            return;
        };
        let local = self.local_model(joint, posterior);
        estimate.terrain = TerrainParameters::at(&posterior.at);
        for identified in &mut estimate.parameters {
            identified.value = estimate.terrain.get(identified.parameter);
            let of_pressure = Stage::of(identified.parameter) == Stage::NormalStress;
            if of_pressure && identified.standing == Standing::NotIdentifiable {
                identified.unidentifiable = Some(Unidentifiable::Ridge);
            }
        }
        estimate.mark_at_bounds(&self.model.at_bounds(&posterior.at));
        self.mark_peak_at_end(estimate, &posterior.at);
        estimate.force_errors = ForceErrors::new(&self.model, &posterior.at, &self.rows);
        estimate.chi_square = posterior.chi_square;
        estimate.termination = posterior.termination;
        estimate.warnings = warning::all(&self.model, &self.rows, &local);
        let value = estimate.terrain.sinkage_exponent;
        estimate.warnings.push(Warning::ExponentAssumed { value });
        self.add_combinations(estimate, &local);
    }

    /// One pass of [`profile`](Self::profile) without moving; returns a lower minimum if one was found.
    fn profile_once(&self, estimate: &mut Estimate) -> Option<Minimum> {
        let local = self.local_model(Joint::new(self.model, &self.rows), estimate.minimum);
        let moved = self.model.moved();
        let completed = |(identified, joint): (&mut Identified, Joint)| {
            let profile = Profile {
                joint,
                best: local.best,
                directions: &local.directions,
                moved: &moved,
                limit: local.precision.limit(),
                lower: Cell::new(None),
            };
            profile.complete(identified);
            profile.lower.get()
        };
        let free = estimate
            .parameters
            .iter_mut()
            .filter(|identified| self.model.standing(identified.parameter).is_none());
        let jobs: Vec<_> = free
            .map(|identified| (identified, local.joint.clone()))
            .collect();
        let lower: Vec<Minimum> = jobs.into_par_iter().filter_map(completed).collect();
        self.add_combinations(estimate, &local);
        lower
            .into_iter()
            .min_by(|one, other| one.chi_square.total_cmp(&other.chi_square))
    }

    /// Marks as not identifiable the parameters at a bound, and those of the same stage or strongly
    /// correlated with them: their estimates are conditional on the bound.
    fn mark_at_bounds(&self, estimate: &mut Estimate, local: &LocalModel) {
        const CONFOUNDED: f64 = 0.9;
        let at_bounds = self.model.at_bounds(&local.best.at);
        let free = local.directions.free();
        let place = |of: Parameter| free.iter().position(|p| *p == of);
        let correlated = |one: Parameter, other: Parameter| {
            let places = place(one).zip(place(other));
            let correlation = places.map(|(row, column)| estimate.correlation[row][column]);
            correlation.is_some_and(|known| known.is_none_or(|c| c.abs() > CONFOUNDED))
        };
        let confounded_with = |parameter: Parameter| {
            let on = |bounded: &Parameter| {
                Stage::of(parameter) == Stage::of(*bounded) || correlated(parameter, *bounded)
            };
            let bounded = at_bounds.iter().map(|(bounded, _)| *bounded).find(on)?;
            Some((parameter, bounded))
        };
        let confounded: Vec<_> = self
            .model
            .free()
            .into_iter()
            .filter_map(confounded_with)
            .collect();
        for (parameter, bounded) in confounded {
            let identified = &mut estimate.parameters[parameter as usize];
            identified.mark_unidentifiable(Unidentifiable::With(bounded));
            identified.interval = [None; 2];
        }
        estimate.mark_at_bounds(&at_bounds);
    }

    /// Forces of `rows` predicted by an estimate from slip and sinkage, with 95 % prediction intervals.
    ///
    /// An interval covers the uncertainty of the estimate and the scatter of the row about the model; the
    /// ratio of scatter to stated uncertainty is that of the rows fitted. Pull and torque of a wheel held by
    /// static friction on hard ground are not predicted.
    ///
    /// # Errors
    /// `Row` for the first number of `rows` out of its range.
    pub fn predict(
        &self,
        estimate: &Estimate,
        rows: &[SteadyLoad],
    ) -> Result<Vec<PredictedForce>, IdentifyError> {
        self.predict_on(&self.model.setting, estimate, rows)
    }

    /// As [`predict`](Self::predict), for rows of another wheel, whose `setting` may have other lugs.
    ///
    /// # Errors
    /// `Row` for the first number of `rows` out of its range.
    pub fn predict_on(
        &self,
        setting: &Setting,
        estimate: &Estimate,
        rows: &[SteadyLoad],
    ) -> Result<Vec<PredictedForce>, IdentifyError> {
        let model = Model {
            setting: *setting,
            ..self.model
        };
        let LocalModel {
            best,
            directions,
            precision,
            ..
        } = self.local_model_of(estimate);
        let knowledge = Knowledge {
            model: &model,
            at: best.at,
            directions,
            precision,
            scale: Scale::of(&self.rows),
        };
        let rows = row::on_cylinder(rows, model.class, &model.setting)?;
        let forces = rows.iter().flat_map(|row| knowledge.forces(row));
        Ok(forces.collect())
    }

    /// The local linear model at an estimate.
    fn local_model_of(&self, estimate: &Estimate) -> LocalModel {
        let best = Minimum {
            at: estimate.terrain.coordinates(),
            chi_square: estimate.chi_square,
            termination: estimate.termination,
        };
        self.local_model(Joint::new(self.model, &self.rows), best)
    }

    /// The local linear model at a minimum: Jacobian, rank and scatter.
    fn local_model(&self, joint: Joint, best: Minimum) -> LocalModel {
        let directions = Directions::new(&joint, &best.at, &self.model.sensitive_at(&best.at));
        let freedom = joint.forces().saturating_sub(directions.rank());
        let known = Scale::of(&self.rows).known;
        let precision = Precision::new(known, best.chi_square, freedom);
        LocalModel {
            joint,
            best,
            directions,
            precision,
        }
    }

    /// Adds the identifiable combinations of the parameters that are not identifiable alone.
    fn add_combinations(&self, estimate: &mut Estimate, local: &LocalModel) {
        let identified = |of: &&Identified| of.is_identifiable();
        let known: Vec<Parameter> = estimate
            .parameters
            .iter()
            .filter(identified)
            .map(|identified| identified.parameter)
            .collect();
        let resolution = Resolution {
            identified: &known,
            half_width: local.precision.half_width(),
        };
        let (at, directions) = (&local.best.at, &local.directions);
        estimate.combinations =
            combination::fixed(&self.model, at, &self.rows, directions, resolution);
    }

    /// Value, standing and covariance interval of one parameter.
    fn identified(&self, parameter: Parameter, local: &LocalModel) -> Identified {
        let LocalModel {
            best,
            directions,
            precision,
            ..
        } = local;
        let coordinate = best.at[parameter as usize];
        let value = parameter.value(coordinate);
        let with = |standing, standard_error, interval| Identified {
            parameter,
            value,
            standing,
            unidentifiable: None,
            standard_error,
            interval,
            profile: None,
        };
        if let Some(standing) = self.model.standing(parameter) {
            return with(standing, 0.0, [Some(value); 2]);
        }
        let open = |reason, standard_error, interval| Identified {
            unidentifiable: Some(reason),
            ..with(Standing::NotIdentifiable, standard_error, interval)
        };
        if parameter.is_as_good_as_zero(coordinate) {
            let end = parameter.range()[0];
            return open(Unidentifiable::AtEnd(end), f64::INFINITY, [Some(0.0), None]);
        }
        let unit = directions.function(unit(parameter));
        let deviation = directions
            .covariance(&unit, &unit)
            .map_or(f64::INFINITY, libm::sqrt);
        let half = precision.half_width() * deviation;
        let standard_error = precision.sigma * deviation;
        if half <= parameter.uninformative() {
            let ends = [coordinate - half, coordinate + half];
            let interval = ends.map(|end| Some(parameter.value(end)));
            with(Standing::Identified, standard_error, interval)
        } else if half.is_finite() {
            open(Unidentifiable::Wide, standard_error, [None; 2])
        } else {
            open(Unidentifiable::Unbounded, standard_error, [None; 2])
        }
    }
}

/// Linearisation of the fit at a minimum.
struct LocalModel {
    joint: Joint,
    best: Minimum,
    directions: Directions,
    precision: Precision,
}

/// # Errors
/// `TooFewRows` for the first stage that cannot be fitted.
fn enough_for_stages(model: &Model, rows: &[SteadyLoad]) -> Result<(), IdentifyError> {
    match model.stage_without_rows(rows) {
        None => Ok(()),
        Some((stage, [needed, given])) => Err(IdentifyError::TooFewRows {
            stage,
            class: model.class,
            needed,
            given,
        }),
    }
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

/// The linear function that selects one parameter.
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
            SteadyLoad::new(slip, sinkage, loads)
        };
        let pairs = loads
            .iter()
            .flat_map(|&load| slips.iter().map(move |&slip| (slip, load)));
        pairs.map(|(slip, load)| row(slip, load)).collect()
    }

    /// Rows on ground that lugs do not enter, without measured sinkage.
    fn rigid(soil: &Soil, rim: Rim, slips: &[f64]) -> Vec<SteadyLoad> {
        let row = |&slip: &f64| {
            let loads = closed_form::loads(rim, soil, RIGID_SINKAGE, slip);
            SteadyLoad::new(slip, f64::NAN, loads)
        };
        slips.iter().map(row).collect()
    }

    fn sand(slips: &[f64], loads: &[f64]) -> Vec<SteadyLoad> {
        rows(&table_6::sand(), slips, loads)
    }

    #[test]
    fn under_one_load_the_prior_selects_an_exponent_that_fits_as_well() {
        let measured = |loads: &[f64]| {
            let mut rows = rows(&table_6::sand(), &SLIPS, loads);
            for (index, row) in rows.iter_mut().enumerate() {
                row.sinkage += [2e-4, -2e-4][index % 2];
                row.uncertainty = Some(Uncertainty {
                    slip: 0.0,
                    sinkage: 5e-4,
                    drawbar_pull: 1.0,
                    load: 1.0,
                    driving_torque: 0.1,
                });
            }
            identify(&rows, Wtic::Leis, &setting()).unwrap()
        };
        let assumed = |estimate: &Estimate| {
            let mut warnings = estimate.warnings.iter();
            warnings.any(|warning| matches!(warning, Warning::ExponentAssumed { .. }))
        };
        let one = measured(&[109.0]);
        let n_0 = one.of(Parameter::SinkageExponent);
        assert!(assumed(&one) && n_0.standing == Standing::NotIdentifiable);
        assert!((0.5..1.5).contains(&n_0.value), "{}", n_0.value);
        assert!(one.chi_square - one.minimum.chi_square < 1.0);
        assert!(!assumed(&measured(&[60.0, 109.0, 200.0])));
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

    /// Adds standard uncertainties of 2 % to every force; no noise is added.
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
    fn one_slip_cannot_identify_the_parameters_of_slip() {
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
        // Six forces and six identifiable directions: k_s and n0 count once.
        let two = rigid(&table_6::gravel(), setting().rim, &[0.1, 0.3]);
        let free = identify(&two, Wtic::Slct, &setting()).unwrap();
        assert_eq!(free.warnings, [Warning::NoFreedom]);
        assert!(free.parameters[..5].iter().all(|p| p.ci95() == [None; 2]));
        let known = identify(&stated(two), Wtic::Slct, &setting()).unwrap();
        assert!(known.of(Parameter::SinkageExponentSlip).is_identifiable());
    }

    #[test]
    fn under_one_load_only_pressure_and_strength_are_identifiable() {
        let rows = stated(sand(&SLIPS, &[109.0]));
        let estimate = identify(&rows, Wtic::Leis, &setting()).unwrap();
        let open: Vec<&str> = estimate
            .parameters
            .iter()
            .filter(|identified| !identified.is_identifiable())
            .map(|identified| identified.parameter.name())
            .collect();
        assert_eq!(open, ["k_s", "n0", "n1", "c", "phi"]);
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
            // The same motion in terms of the rim's radius: the travel per turn is (r + l)/r longer.
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
        // The rim's torque per pull is l/r = 6.5 % too small: pull and torque cannot both be fitted.
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
        // Forces are linear in c, so the interval in ln c is longer below.
        let [low, high] = relative(Parameter::Cohesion);
        assert!(low > 1.1 && high < 0.95, "{low}, {high}");
    }

    #[test]
    fn uncertainties_of_only_some_rows_are_ignored_with_a_warning() {
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

    /// The rover's lugged wheel on a sand with Wong and Reece's stresses.
    fn own() -> (Setting, Soil) {
        let soil = Soil {
            convention: crate::soil::StressConvention::WongReece,
            stress_angle: 0.35,
            stress_angle_slip: 0.25,
            exit_angle: -0.15,
            ..table_6::sand()
        };
        let law = Law::Own(Own {
            lugs: Wheel::rover().lugs,
            convention: soil.convention,
            bulk_density: soil.bulk_density,
        });
        let setting = Setting {
            law,
            exit_angle: soil.exit_angle,
            ..setting()
        };
        (setting, soil)
    }

    /// Loads by the quadrature, with typical uncertainties.
    fn own_rows(soil: &Soil, loads: &[f64]) -> Vec<SteadyLoad> {
        let wheel = Wheel::rover();
        let pairs = loads
            .iter()
            .flat_map(|&load| SLIPS.iter().map(move |&slip| (slip, load)));
        let row = |(slip, load)| {
            let sinkage = sinkage_at(&wheel, soil, load, slip).unwrap();
            let loads = crate::soil::wheel_load::loads(&wheel, soil, sinkage, slip);
            SteadyLoad {
                uncertainty: Some(Uncertainty {
                    slip: 0.005,
                    sinkage: 0.0005,
                    drawbar_pull: 0.01 * load,
                    load: 0.01 * load,
                    driving_torque: 0.0015 * load,
                }),
                ..SteadyLoad::new(slip, sinkage, loads)
            }
        };
        pairs.map(row).collect()
    }

    #[test]
    fn the_quadrature_gives_back_the_sand_under_a_lugged_wheel() {
        let (setting, soil) = own();
        let rows = own_rows(&soil, &[60.0, 109.0, 200.0]);
        let estimate = identify(&rows, Wtic::Leis, &setting).unwrap();
        let truth = TerrainParameters::of(&soil, setting.rim.width);
        assert!(estimate.warnings.is_empty(), "{:?}", estimate.warnings);
        for parameter in Parameter::ALL {
            let (found, truth) = (estimate.terrain.get(parameter), truth.get(parameter));
            assert!(
                (found - truth).abs() < 1e-3 * truth.abs(),
                "{}: {found}, not {truth}",
                parameter.name()
            );
        }
    }
}
