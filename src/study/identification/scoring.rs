//! How the scores of a study come about: every group fitted by every model, then what the fits
//! predict.

use super::Plan;
use super::fit::{Fitted, GroupRows};
use super::own::{holds, own_value};
use super::repeats;
use super::score::{
    Accuracy, CarriedScore, Choice, DriftScore, FitOutcome, FitScore, FoundScore, GroundScore,
    GroupScore, IdentificationScore, MODELS, ModelScore, ParameterScore, PredictionScore,
    RepeatScore, Source,
};
use super::steady::IntervalRow;
use crate::identification::{
    Drift, Estimate, Force, ForceErrors, Identified, PredictedForce, Warning,
};
use crate::scenario::Scenario;
use crate::statistics::Share;
use crate::study::analysis::Finished;
use crate::study::{Study, StudyError, group};
use crate::terrain::class::Wtic;
use rayon::prelude::*;

/// A group and what was fitted to it, in the order of [`MODELS`].
struct FittedGroup {
    rows: GroupRows,
    fits: [Result<Fitted, String>; 3],
    repeats: Vec<RepeatScore>,
}

/// Every group of a study identified by its rows; the caller is asked before each whether to go on.
///
/// # Errors
/// `Stopped`.
pub(super) fn score(
    plan: &Plan,
    done: &Finished,
    rows: &[IntervalRow],
) -> Result<IdentificationScore, StudyError> {
    let groups = group::all(done.study, &plan.over).into_par_iter();
    let fitted = groups.map(|group| {
        done.go_on()?;
        let rows = GroupRows::new(done.study, plan, group, rows);
        Ok(FittedGroup::new(rows))
    });
    let fitted: Vec<FittedGroup> = fitted.collect::<Result<_, StudyError>>()?;
    Ok(IdentificationScore {
        published: plan.published,
        grounds: grounds(&fitted),
        groups: fitted.iter().map(GroupScore::of).collect(),
        predictions: predictions(done.study, plan, &fitted),
        carried: carried(&fitted),
    })
}

impl FittedGroup {
    fn new(rows: GroupRows) -> Self {
        let fit = |class| rows.fit(class).map_err(|error| error.to_string());
        let [all, some, into] = MODELS;
        let (all, (some, into)) =
            rayon::join(|| fit(all), || rayon::join(|| fit(some), || fit(into)));
        Self {
            fits: [all, some, into],
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
    fn of(predicted: &[PredictedForce]) -> Self {
        let covered = Force::ALL.into_iter().filter_map(|force| {
            let of_force = predicted.iter().filter(|of| of.force == force);
            let covered: Vec<bool> = of_force.filter_map(PredictedForce::is_covered).collect();
            let within = covered.iter().filter(|within| **within).count();
            Some((force, Share::of(within as u64, covered.len() as u64)?))
        });
        Self {
            force_error_percent: ForceErrors::of(predicted),
            scatter_percent: ForceErrors::of_scatter(predicted),
            covered: covered.collect(),
        }
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
            not_steady: rows.not_steady(),
            drifts: drifts(rows),
            above_ground: rows.above_ground(),
            without: rows.without.clone(),
            fits: fits
                .map(|(class, fit)| FitScore {
                    class,
                    outcome: outcome(fit),
                })
                .collect(),
            repeats: group.repeats.clone(),
            source: group.source().map(|estimate| Source {
                estimate: estimate.clone(),
                setting: rows.setting,
                loads: rows.loads(estimate.class, |_| true),
            }),
        }
    }
}

/// What still changes in the rows of a group, channel by channel.
fn drifts(rows: &GroupRows) -> Vec<DriftScore> {
    let all: Vec<Drift> = rows.drifts().collect();
    let of_channel = |channel: &'static str| {
        let found = all.iter().filter(|drift| drift.channel == channel);
        let rates: Vec<f64> = found.clone().map(|drift| drift.rate).collect();
        Some(DriftScore {
            channel,
            rows: rates.len(),
            rate: rates.iter().sum::<f64>() / rates.len() as f64,
            rates: [
                rates.iter().copied().reduce(f64::min)?,
                rates.iter().copied().reduce(f64::max)?,
            ],
            unit: found.clone().next()?.unit(),
        })
    };
    Drift::CHANNELS.into_iter().filter_map(of_channel).collect()
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
            reduced_chi_square: estimate.reduced_chi_square(),
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
    let together = |of: fn(&Fitted) -> &[PredictedForce]| {
        let all: Vec<PredictedForce> = fits.iter().flat_map(|fit| of(fit)).copied().collect();
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
