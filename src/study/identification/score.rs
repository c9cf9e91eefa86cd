//! Results of the identification of a study: parameters, force errors by the right model and the wrong ones,
//! and accuracy of predictions.
//!
//! - [`GroundScore`]: force errors by ground and model, with the published ones. A model is fitted to all
//!   rows of a group, and, for *left out* (cross-validation), to those at the other values of the first key
//!   joined. *Means* are those of a condition over its repeats. *Scatter* is the error expected from the
//!   rows' stated uncertainties alone: on loose stones most of it.
//! - [`GroupScore`]: the parameters of every group by every model, with 95 % intervals, and the scenario's
//!   true values where its ground has them: `φ = atan μ` of wheel on stone on hard ground, all of them on
//!   sand. Every model is of a smooth rim: parameters absorb the effect of lugs, so an interval need not
//!   cover the soil's true value.
//! - [`RepeatScore`]: every repeat fitted separately.
//! - [`PredictionScore`]: the parameters found at the values of `from` predict all other groups.
//! - [`CarriedScore`]: the parameters found on one ground predict another, as for a rover that neither
//!   switches the model nor identifies again.
//!
//! Predictions use the model of the class recognised in the group fitted, or of its label where none was
//! recognised. Where that class sets the sinkage it also sets the load: pull and torque are then predicted at
//! the measured load (Eq. 68, 69), and the load is that of the fit. The 95 % prediction intervals cover the
//! uncertainty of the estimate and the scatter of the rows about the model.
//!
//! `identification.csv` has a row for every number:
//!
//! | columns | content |
//! |---|---|
//! | `scenario`, every swept key not joined | the group |
//! | `label`, `recognized` | its ground, and the class recognised |
//! | `model` | the class whose model was fitted |
//! | `what` | `parameter`, `fitted`, `means`, `left_out`, `predicted` (by the group of `from`), `carried from` a scenario, `not_steady` |
//! | `name`, `unit` | parameter or force, errors in %; of `not_steady` the channel that drifts and the unit of its rate |
//! | `value`, `low`, `high` | with its 95 % interval, where it is identified; of `not_steady` mean, least and greatest rate |
//! | `own` | the scenario's true value |
//! | `covered`, `of` | forces within their intervals, and forces with one; of `not_steady` rows that drift, and all rows |

use super::Published;
use crate::identification::{
    Estimate, Force, ForceErrors, Identification, Identified, Parameter, Predictor, Setting,
    SteadyLoad,
};
use crate::statistics::Share;
use crate::terrain::class::{TerrainLabel, Wtic};
use serde::Serialize;
use std::collections::BTreeMap;

/// The classes that have a model.
pub const MODELS: [Wtic; 3] = [Wtic::Alct, Wtic::Slct, Wtic::Leis];

/// What the steady loads of a study gave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IdentificationScore {
    /// Published errors [%], where the study file has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published: Option<Published>,
    /// Force errors by ground and model.
    pub grounds: Vec<GroundScore>,
    /// Every group.
    pub groups: Vec<GroupScore>,
    /// Groups predicted from those at the values of `from`.
    pub predictions: Vec<PredictionScore>,
    /// Grounds predicted from others.
    pub carried: Vec<CarriedScore>,
}

/// How well forces were predicted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accuracy {
    /// Relative errors.
    pub force_error_percent: ForceErrors,
    /// Relative errors expected from the scatter of the rows alone.
    pub scatter_percent: ForceErrors,
    /// Share of the forces that lie in their 95 % interval, of those that have one.
    pub covered: BTreeMap<Force, Share>,
}

/// Force errors on a ground, all its groups together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroundScore {
    /// The scenario.
    pub scenario: String,
    /// Its ground.
    pub label: TerrainLabel,
    /// Its groups.
    pub groups: usize,
    /// Those of them whose class was recognised as the label's.
    pub recognized: usize,
    /// Every way to choose a model.
    pub models: Vec<ModelScore>,
}

/// How a model is chosen for a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Choice {
    /// By the class recognised.
    Recognized,
    /// Always that of one class.
    Always(Wtic),
}

/// Force errors of one way to choose a model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelScore {
    /// Which.
    pub choice: Choice,
    /// Groups it could be fitted to.
    pub groups: usize,
    /// On the rows fitted.
    pub fitted: Accuracy,
    /// On the means of the rows of each condition.
    pub means: Accuracy,
    /// On rows left out of the fit.
    pub left_out: Accuracy,
}

/// The parameters of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupScore {
    /// The scenario.
    pub scenario: String,
    /// Swept keys that all its runs share, and their values as TOML.
    pub shared: Vec<(String, String)>,
    /// Its ground.
    pub label: TerrainLabel,
    /// Answers to its windows: ALCT, SLCT, LEIS and UWTIC.
    pub answers: [u64; 4],
    /// The class recognised.
    pub recognized: Wtic,
    /// Steady rows.
    pub rows: usize,
    /// Number of rows with the rim held above the ground by the lugs.
    pub above_ground: usize,
    /// Rows in which something still changes; the change over the interval is in their uncertainty.
    pub not_steady: usize,
    /// What changes in them.
    pub drifts: Vec<DriftScore>,
    /// Numbers of runs without a steady row, and why.
    pub without: Vec<(u64, String)>,
    /// The models of ALCT, SLCT and LEIS.
    pub fits: Vec<FitScore>,
    /// Every repeat fitted alone by the label's model.
    pub repeats: Vec<RepeatScore>,
    /// The estimate of [`parameters`](Self::parameters) and what it was fitted to.
    #[serde(skip)]
    pub source: Option<Source>,
}

/// A quantity that still changes in rows of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DriftScore {
    /// Its channel.
    pub channel: &'static str,
    /// Rows in which it changes.
    pub rows: usize,
    /// Mean rate of change, in `unit`.
    pub rate: f64,
    /// Least and greatest rate, in `unit`.
    pub rates: [f64; 2],
    /// Unit of the rates.
    pub unit: String,
}

/// An estimate and what it was fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The estimate.
    pub estimate: Estimate,
    /// Conventions of the equations.
    pub setting: Setting,
    /// The steady loads, as the model takes them.
    pub loads: Vec<SteadyLoad>,
}

impl Source {
    /// Predictions at other loads and slips; `None` where the rows cannot be identified.
    pub fn predictor(&self) -> Option<Predictor> {
        let class = self.estimate.class;
        let identification = Identification::new(&self.loads, class, &self.setting).ok()?;
        Some(Predictor::new(&identification, &self.estimate))
    }
}

/// A model fitted to a group, or why it could not be.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitScore {
    /// Whose model.
    pub class: Wtic,
    /// What came of it.
    #[serde(flatten)]
    pub outcome: FitOutcome,
}

/// What came of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FitOutcome {
    /// Parameters.
    Found(Box<FoundScore>),
    /// Why there are none.
    Refused(String),
}

/// Parameters found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoundScore {
    /// One by one, in the order of Table 6.
    pub parameters: Vec<ParameterScore>,
    /// What the rows fix of parameters that they do not fix one by one, in words.
    pub combinations: Vec<String>,
    /// Sum of squares per degree of freedom [-].
    pub reduced_chi_square: f64,
    /// What else to know.
    pub warnings: Vec<String>,
    /// On the rows fitted.
    pub fitted: Accuracy,
    /// On the means of the rows of each condition.
    pub means: Accuracy,
    /// On rows left out of the fit.
    pub left_out: Accuracy,
}

/// A parameter found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ParameterScore {
    /// Which.
    pub parameter: Parameter,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [Option<f64>; 2],
    /// Whether the rows fix it.
    pub identifiable: bool,
    /// All that is known of it.
    #[serde(skip)]
    pub identified: Identified,
    /// The scenario's own value.
    pub own: Option<f64>,
    /// Whether the interval covers it, for an identified parameter.
    pub holds_own: Option<bool>,
}

/// How the estimates of the repeats scatter about each other, in the coordinate of the fit
/// (logarithms of `k_s`, `c` and `K`; `φ` in radians).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RepeatScore {
    /// Which parameter.
    pub parameter: Parameter,
    /// Repeats fitted.
    pub fits: usize,
    /// Those of them that fix it.
    pub identified: usize,
    /// Standard deviation of their values.
    pub deviation: Option<f64>,
    /// Mean half-width of their 95 % intervals.
    pub half_width: Option<f64>,
    /// Share of intervals that cover the mean of the repeats.
    pub holds_mean: Option<Share>,
    /// Share of intervals that cover the scenario's true value.
    pub holds_own: Option<Share>,
}

/// A group predicted by the parameters of another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictionScore {
    /// The scenario.
    pub scenario: String,
    /// Swept keys that all its runs share, and their values as TOML.
    pub shared: Vec<(String, String)>,
    /// The class whose model predicts.
    pub class: Wtic,
    /// How well.
    #[serde(flatten)]
    pub accuracy: Accuracy,
    /// Forces whose error is above twice the published one.
    pub beyond: Vec<Force>,
}

/// A ground predicted by the parameters of another, all conditions together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CarriedScore {
    /// Where the parameters were found.
    pub from: String,
    /// Which scenario they predict.
    pub to: String,
    /// How well.
    #[serde(flatten)]
    pub accuracy: Accuracy,
}

impl IdentificationScore {
    /// One group of every scenario: the first that is not predicted by another.
    pub fn references(&self) -> impl Iterator<Item = &GroupScore> {
        let predicted = |group: &GroupScore| {
            let mut predictions = self.predictions.iter();
            predictions.any(|p| p.scenario == group.scenario && p.shared == group.shared)
        };
        self.grounds.iter().filter_map(move |ground| {
            let mut groups = self.groups.iter();
            groups.find(|group| group.scenario == ground.scenario && !predicted(group))
        })
    }
}

impl Accuracy {
    /// The error [%] of a force.
    pub fn error(&self, force: Force) -> Option<f64> {
        self.force_error_percent.get(force)
    }
}

impl GroupScore {
    /// The parameters by the class recognised, or by the label's where none was.
    pub fn parameters(&self) -> Option<(Wtic, &[ParameterScore])> {
        let class = match self.recognized {
            Wtic::Uwtic => self.label.class(),
            class => class,
        };
        let fit = self.fits.iter().find(|fit| fit.class == class)?;
        fit.found().map(|found| (class, &found.parameters[..]))
    }
}

impl FitScore {
    /// What was found, where something was.
    pub fn found(&self) -> Option<&FoundScore> {
        match &self.outcome {
            FitOutcome::Found(found) => Some(found),
            FitOutcome::Refused(_) => None,
        }
    }
}
