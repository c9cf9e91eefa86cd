//! What the steady loads of a study gave: parameters, force errors by the right model and by the
//! wrong ones, and how far an estimate predicts.
//!
//! - [`GroundScore`]: force errors by ground and model, beside those published. A model is fitted
//!   to all rows of a group, and, for the rows *left out*, to those at the other values of the
//!   first key joined. *Means* are those of a condition over its repeats. *Scatter* is what the
//!   rows' stated uncertainties alone would leave of error: on loose stones, the most of it.
//! - [`GroupScore`]: the parameters of every group by every model, with 95 % intervals, and the
//!   scenario's own values where its ground has them: `φ = atan μ` of wheel on stone on hard
//!   ground, all of them on sand. A rim stands for the wheel in every model: what lugs do is in
//!   the parameters, so an interval need not hold the soil's own value.
//! - [`RepeatScore`]: every repeat fitted alone.
//! - [`PredictionScore`]: the parameters found at the values of `from` predict all other groups.
//! - [`CarriedScore`]: the parameters found on one ground predict another, as they would for a
//!   rover that neither switches nor identifies anew.
//!
//! Predictions have the model of the class recognised where they start, or of the label's where
//! none was recognised. Their 95 % intervals hold the estimate's error and the rows' scatter about
//! the model.
//!
//! `identification.csv` has a row for every number:
//!
//! | columns | hold |
//! |---|---|
//! | `scenario`, every swept key not joined | the group |
//! | `label`, `recognized` | its ground, and the class recognised |
//! | `model` | the class whose model was fitted |
//! | `what` | `parameter`, `fitted`, `means`, `left_out`, `predicted` (by the group of `from`), `carried from` a scenario |
//! | `name`, `unit` | parameter or force; errors are in % |
//! | `value`, `low`, `high` | with its 95 % interval, where it is identified |
//! | `own` | the scenario's own value |
//! | `covered`, `of` | forces within their intervals, and forces with one |

use super::Published;
use super::fit::{Fitted, GroupRows};
use super::reading;
use super::repeats::{self, holds};
use super::{Plan, group};
use crate::identification::{
    Estimate, Force, ForceErrors, Identified, Parameter, Predicted, Warning,
};
use crate::recognition::confusion::Share;
use crate::scenario::Scenario;
use crate::study::Study;
use crate::terrain::TerrainSpec;
use crate::terrain::class::{TerrainLabel, Wtic};
use rayon::prelude::*;
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
    /// Relative errors that the scatter of the rows alone would leave.
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
    /// Rows whose rim stands above the ground on its lugs.
    pub above_ground: usize,
    /// Numbers of runs without a steady row, and why.
    pub without: Vec<(u64, String)>,
    /// The models of ALCT, SLCT and LEIS.
    pub fits: Vec<FitScore>,
    /// Every repeat fitted alone by the label's model.
    pub repeats: Vec<RepeatScore>,
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
    /// Whether the interval holds it, of a parameter that the rows fix.
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
    /// Intervals that hold the mean of the repeats.
    pub holds_mean: Option<Share>,
    /// Intervals that hold the scenario's own value.
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

/// A group and what was fitted to it, in the order of [`MODELS`].
struct FittedGroup {
    rows: GroupRows,
    fits: [Result<Fitted, String>; 3],
    repeats: Vec<RepeatScore>,
}

impl Study {
    /// Identifies the table of the steady rows, where the study has one.
    pub(in crate::study) fn identify(&self, steady: Option<&str>) -> Option<IdentificationScore> {
        let (plan, text) = (self.identification.as_ref()?, steady?);
        let rows = reading::rows(text);
        let groups = group::all(self, plan);
        let fitted: Vec<FittedGroup> = groups
            .into_par_iter()
            .map(|group| FittedGroup::new(GroupRows::new(self, plan, group, &rows)))
            .collect();
        Some(IdentificationScore {
            published: plan.published,
            grounds: grounds(&fitted),
            groups: fitted.iter().map(GroupScore::of).collect(),
            predictions: predictions(self, plan, &fitted),
            carried: carried(&fitted),
        })
    }
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

impl FittedGroup {
    fn new(rows: GroupRows) -> Self {
        Self {
            fits: MODELS.map(|class| rows.fit(class).map_err(|error| error.to_string())),
            repeats: repeats::scores(&rows, rows.label_class()),
            rows,
        }
    }

    fn fit(&self, choice: Choice) -> Option<&Fitted> {
        let class = match choice {
            Choice::Recognized => self.rows.recognized(),
            Choice::Always(class) => class,
        };
        let place = MODELS.iter().position(|model| *model == class)?;
        self.fits[place].as_ref().ok()
    }

    /// What predicts elsewhere: by the class recognised, or by the label's where none was.
    fn source(&self) -> Option<&Estimate> {
        let choice = match self.rows.recognized() {
            Wtic::Uwtic => Choice::Always(self.rows.label_class()),
            _ => Choice::Recognized,
        };
        self.fit(choice).map(|fitted| &fitted.estimate)
    }
}

impl Accuracy {
    fn of(predicted: &[Predicted]) -> Self {
        let covered = Force::ALL.into_iter().filter_map(|force| {
            let of_force = predicted.iter().filter(|told| told.force == force);
            let told: Vec<bool> = of_force.filter_map(Predicted::is_covered).collect();
            let within = told.iter().filter(|within| **within).count();
            Some((force, Share::of(within as u64, told.len() as u64)?))
        });
        Self {
            force_error_percent: ForceErrors::of(predicted),
            scatter_percent: ForceErrors::of_scatter(predicted),
            covered: covered.collect(),
        }
    }

    /// The error [%] of a force.
    pub fn error(&self, force: Force) -> Option<f64> {
        self.force_error_percent.get(force)
    }
}

/// The value that a scenario's own ground has for a parameter, in its unit.
pub(super) fn own_value(scenario: &Scenario, parameter: Parameter) -> Option<f64> {
    match &scenario.terrain {
        TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => {
            Some(match parameter {
                Parameter::StressAngle => soil.stress_angle,
                Parameter::StressAngleSlip => soil.stress_angle_slip,
                Parameter::SinkageModulus => soil.sinkage_modulus(scenario.wheel.width),
                Parameter::SinkageExponent => soil.sinkage_exponent,
                Parameter::SinkageExponentSlip => soil.sinkage_exponent_slip,
                Parameter::Cohesion => soil.cohesion,
                Parameter::FrictionAngle => soil.friction_angle_deg,
                Parameter::ShearModulus => soil.shear_modulus,
            })
        }
        TerrainSpec::Hard { .. } | TerrainSpec::Reference { .. } => (parameter
            == Parameter::FrictionAngle)
            .then(|| libm::atan(scenario.wheel.friction).to_degrees()),
        _ => None,
    }
}

impl GroupScore {
    fn of(group: &FittedGroup) -> Self {
        let rows = &group.rows;
        let fits = MODELS.into_iter().zip(&group.fits);
        let outcome = |fit: &Result<Fitted, String>| match fit {
            Ok(fitted) => FitOutcome::Found(Box::new(FoundScore::of(fitted, &rows.scenario))),
            Err(reason) => FitOutcome::Refused(reason.clone()),
        };
        Self {
            scenario: rows.group.scenario.clone(),
            shared: rows.group.shared.clone(),
            label: rows.scenario.terrain.label(),
            answers: rows.answers,
            recognized: rows.recognized(),
            rows: rows.rows.len(),
            above_ground: rows.above_ground(),
            without: rows.without.clone(),
            fits: fits
                .map(|(class, fit)| FitScore {
                    class,
                    outcome: outcome(fit),
                })
                .collect(),
            repeats: group.repeats.clone(),
        }
    }

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

impl FoundScore {
    fn of(fitted: &Fitted, scenario: &Scenario) -> Self {
        let estimate = &fitted.estimate;
        let parameter = |identified: &Identified| {
            let parameter = identified.parameter;
            let own = own_value(scenario, parameter);
            let identifiable = identified.is_identifiable();
            ParameterScore {
                parameter,
                unit: parameter.unit(),
                value: identified.value,
                ci95: identified.ci95(),
                identifiable,
                identified: *identified,
                own,
                holds_own: own
                    .filter(|_| identifiable)
                    .map(|own| holds(identified, own)),
            }
        };
        let combinations = estimate.combinations.iter().map(|known| {
            let [low, high] = known.interval;
            let place = match known.place.as_str() {
                "" => String::new(),
                place => format!(" at {place}"),
            };
            format!(
                "{} = {:.4e} [{low:.4e}, {high:.4e}] {}{place}",
                known.name, known.value, known.unit
            )
        });
        Self {
            parameters: estimate.parameters.iter().map(parameter).collect(),
            combinations: combinations.collect(),
            reduced_chi_square: estimate.chi_square / estimate.degrees_of_freedom as f64,
            warnings: estimate.warnings.iter().map(Warning::to_string).collect(),
            fitted: Accuracy::of(&fitted.fitted),
            means: Accuracy::of(&fitted.means),
            left_out: Accuracy::of(&fitted.left_out),
        }
    }
}

/// Names of the scenarios, in their order.
fn scenarios(groups: &[FittedGroup]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for group in groups {
        let name = group.rows.group.scenario.as_str();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn grounds(groups: &[FittedGroup]) -> Vec<GroundScore> {
    let ground = |scenario: &str| {
        let of = groups.iter();
        let of: Vec<&FittedGroup> = of.filter(|g| g.rows.group.scenario == scenario).collect();
        let right = |group: &&&FittedGroup| group.rows.recognized() == group.rows.label_class();
        let always = MODELS.map(Choice::Always);
        let choices = std::iter::once(Choice::Recognized).chain(always);
        GroundScore {
            scenario: scenario.to_owned(),
            label: of[0].rows.scenario.terrain.label(),
            groups: of.len(),
            recognized: of.iter().filter(right).count(),
            models: choices.map(|choice| model(&of, choice)).collect(),
        }
    };
    scenarios(groups).into_iter().map(ground).collect()
}

fn model(groups: &[&FittedGroup], choice: Choice) -> ModelScore {
    let fits: Vec<&Fitted> = groups.iter().filter_map(|g| g.fit(choice)).collect();
    let together = |of: fn(&Fitted) -> &[Predicted]| {
        let all: Vec<Predicted> = fits.iter().flat_map(|fit| of(fit)).copied().collect();
        Accuracy::of(&all)
    };
    ModelScore {
        choice,
        groups: fits.len(),
        fitted: together(|fit| &fit.fitted),
        means: together(|fit| &fit.means),
        left_out: together(|fit| &fit.left_out),
    }
}

fn predictions(study: &Study, plan: &Plan, groups: &[FittedGroup]) -> Vec<PredictionScore> {
    let all: Vec<_> = groups
        .iter()
        .map(|group| group.rows.group.clone())
        .collect();
    let prediction = |group: &FittedGroup| {
        let reference = group.rows.group.reference(study, plan, &all)?;
        let source = groups.iter().find(|g| g.rows.group == *reference)?;
        let estimate = source.source()?;
        let accuracy = Accuracy::of(&source.rows.predict(estimate, &group.rows).ok()?);
        let class = group.rows.label_class();
        let is_beyond = |force: &Force| {
            let published = plan.published.and_then(|p| p.error(class, *force));
            accuracy
                .error(*force)
                .zip(published)
                .is_some_and(|(error, published)| error > 2.0 * published)
        };
        Some(PredictionScore {
            scenario: group.rows.group.scenario.clone(),
            shared: group.rows.group.shared.clone(),
            class: estimate.class,
            beyond: Force::ALL.into_iter().filter(is_beyond).collect(),
            accuracy,
        })
    };
    groups.iter().filter_map(prediction).collect()
}

/// Every ground by the parameters of every other under the same conditions and on the same rim.
fn carried(groups: &[FittedGroup]) -> Vec<CarriedScore> {
    let names = scenarios(groups);
    let pairs = names
        .iter()
        .flat_map(|from| names.iter().map(move |to| (*from, *to)));
    let carried = |(from, to): (&str, &str)| {
        let mut predicted = Vec::new();
        for source in groups.iter().filter(|g| g.rows.group.scenario == from) {
            let alike = groups.iter().find(|other| {
                let rows = &other.rows;
                rows.group.scenario == to
                    && rows.group.shared == source.rows.group.shared
                    && rows.setting == source.rows.setting
            });
            if let (Some(estimate), Some(other)) = (source.source(), alike) {
                predicted.extend(source.rows.predict(estimate, &other.rows).ok()?);
            }
        }
        (!predicted.is_empty()).then(|| CarriedScore {
            from: from.to_owned(),
            to: to.to_owned(),
            accuracy: Accuracy::of(&predicted),
        })
    };
    let different = pairs.filter(|(from, to)| from != to);
    different.filter_map(carried).collect()
}
