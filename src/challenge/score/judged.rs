//! One case: what was done, what was answered, and how that agrees.

use crate::challenge::answer::{Answer, Suspect, Verdict};
use crate::challenge::order::Set;
use crate::challenge::truth::{Hidden, Truth};
use crate::diagnosis::place_of;
use crate::effects::{Application, Stage};

/// The right answer where no effect was withheld.
const NOTHING: &str = "nothing";

/// A case with its answer.
#[derive(Debug, Clone)]
pub(super) struct Judged {
    pub(super) truth: Truth,
    /// None where the diagnosis failed, which is a miss.
    pub(super) answer: Option<Answer>,
    pub(super) seconds: Option<f64>,
}

/// A magnitude found beside the true one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Magnitude {
    /// Error over the distance of the effect's typical magnitude from neutral [-].
    pub(super) of_typical: f64,
    /// Error over the distance of the true magnitude from neutral [-].
    pub(super) of_true: f64,
    /// Whether the interval covers the true one; none without an interval.
    pub(super) is_covered: Option<bool>,
}

/// Whether a 90 % set of an answer contains the truth.
#[derive(Debug, Clone, Copy)]
pub(super) struct PredictionSet {
    pub(super) size: usize,
    pub(super) is_right: bool,
}

/// Probability [-] below which none counts in the log score: an answer of 0 is not infinitely wrong.
const LEAST_PROBABILITY: f64 = 1.0e-3;

impl Judged {
    pub(super) fn is_of(&self, set: Set) -> bool {
        self.truth.set == set
    }

    pub(super) fn is(&self, verdict: Verdict) -> bool {
        self.verdict() == Some(verdict)
    }

    pub(super) fn verdict(&self) -> Option<Verdict> {
        self.answer.as_ref().map(|answer| answer.verdict)
    }

    /// The effect of a case with one.
    pub(super) fn hidden(&self) -> Option<&Hidden> {
        match self.truth.effects.as_slice() {
            [hidden] => Some(hidden),
            _ => None,
        }
    }

    /// Whether the verdict names the effect, and no other.
    pub(super) fn is_named(&self) -> bool {
        let name = self.answer.as_ref().and_then(Answer::single);
        self.hidden()
            .is_some_and(|hidden| name.as_ref() == Some(&hidden.name))
    }

    /// Whether the verdict names the effect or a set that it is in.
    pub(super) fn is_named_up_to_equivalence(&self) -> bool {
        let set = self.set();
        self.hidden()
            .is_some_and(|hidden| set.contains(&hidden.name))
    }

    /// The set of effects of a verdict that names one.
    pub(super) fn set(&self) -> Vec<String> {
        match &self.answer {
            Some(answer) if answer.verdict == Verdict::Effect => {
                answer.sets().into_iter().next().unwrap_or_default()
            }
            _ => Vec::new(),
        }
    }

    /// Whether an answer that names effects has the effect among its three likeliest.
    pub(super) fn is_in_first_three(&self) -> bool {
        let Some(answer) = &self.answer else {
            return false;
        };
        let names = matches!(answer.verdict, Verdict::Effect | Verdict::Effects);
        let mut first = answer.effects.iter().take(3);
        let hidden = self.hidden();
        names && hidden.is_some_and(|hidden| first.any(|suspect| suspect.name == hidden.name))
    }

    /// How many effects of a pair the verdict names, up to equivalence.
    pub(super) fn named_of_pair(&self) -> usize {
        let sets = self.answer.as_ref().map(Answer::sets).unwrap_or_default();
        let effects = &self.truth.effects;
        let holds = |set: &Vec<String>, hidden: &Hidden| set.contains(&hidden.name);
        match (sets.as_slice(), effects.as_slice()) {
            // Two names for one effect are one hit.
            ([a, b], [e, f]) => [[a, b], [b, a]]
                .map(|[a, b]| usize::from(holds(a, e)) + usize::from(holds(b, f)))
                .into_iter()
                .max()
                .unwrap_or(0),
            ([a], [e, f]) => usize::from(holds(a, e) || holds(a, f)),
            _ => 0,
        }
    }

    /// Whether no effect was withheld, and the answer agrees.
    pub(super) fn is_cleared(&self) -> bool {
        matches!(self.verdict(), Some(Verdict::None | Verdict::Parameter))
    }

    /// Whether the answer blames an effect.
    pub(super) fn is_blaming(&self) -> bool {
        matches!(self.verdict(), Some(Verdict::Effect | Verdict::Effects))
    }

    /// The right answer as a key of [`labels`](Self::labels).
    pub(super) fn label(&self) -> String {
        match (self.truth.set, self.truth.effects.as_slice()) {
            (Set::C3, _) => Verdict::Unknown.name().to_owned(),
            (_, [hidden]) => hidden.name.clone(),
            (_, [a, b]) => pair(&a.name, &b.name),
            _ => NOTHING.to_owned(),
        }
    }

    /// Probabilities of all answers that commit themselves: `nothing` for none or parameter,
    /// pairs in the order of their letters.
    pub(super) fn labels(&self) -> Vec<(String, f64)> {
        let Some(answer) = &self.answer else {
            return Vec::new();
        };
        let known = answer.probabilities.iter();
        let others = known.filter(|(name, _)| {
            let apart = [Verdict::None, Verdict::Parameter, Verdict::Undecided];
            apart.iter().all(|verdict| verdict.name() != name.as_str())
        });
        let mut labels = vec![(NOTHING.to_owned(), answer.probability_of_nothing())];
        labels.extend(others.map(|(name, probability)| (label_of(name), *probability)));
        labels
    }

    /// Probability [-] of the right answer; 0 where there is none.
    pub(super) fn probability_on_truth(&self) -> f64 {
        let Some(answer) = &self.answer else {
            return 0.0;
        };
        match (self.truth.set, self.truth.effects.as_slice()) {
            (Set::C3, _) => answer.probability(Verdict::Unknown.name()),
            (_, [hidden]) => answer.probability(&hidden.name),
            (_, [a, b]) => answer.probability_of_pair([&a.name, &b.name]),
            _ => answer.probability_of_nothing(),
        }
    }

    /// Logarithm of the probability of the right answer [-].
    pub(super) fn log_score(&self) -> f64 {
        libm::log(self.probability_on_truth().max(LEAST_PROBABILITY))
    }

    /// Sum of squared differences of the probabilities from 1 for the right answer and 0 for others [-].
    pub(super) fn brier_score(&self) -> f64 {
        let truth = self.label();
        let mut on_truth = 0.0;
        let mut others = 0.0;
        for (label, probability) in self.labels() {
            if label == truth {
                on_truth += probability;
            } else {
                others += probability * probability;
            }
        }
        others + (1.0 - on_truth) * (1.0 - on_truth)
    }

    /// The 90 % set of the answer; none where it states none.
    pub(super) fn prediction_set(&self) -> Option<PredictionSet> {
        let set = &self.answer.as_ref()?.set;
        let truth = self.label();
        let mut labels = set.iter().map(|name| label_of(name));
        (!set.is_empty()).then(|| PredictionSet {
            size: set.len(),
            is_right: labels.any(|label| label == truth),
        })
    }

    /// Detectability `d'` [-] of the effect, or of the less detectable of two; none where it is not known.
    pub(super) fn detectability(&self, which: fn(&Hidden) -> Option<f64>) -> Option<f64> {
        let each = self.truth.effects.iter().map(which);
        let each: Vec<f64> = each.collect::<Option<_>>()?;
        each.into_iter().reduce(f64::min)
    }

    /// Whether the verdict names the effect, up to equivalence, or the answer states where it acts.
    pub(super) fn is_effect_or_mechanism(&self) -> bool {
        let stated = self.answer.as_ref().and_then(|it| it.mechanism.as_ref());
        let effect = self.hidden().and_then(|it| it.application().ok());
        let place = effect.map(|it| {
            let changes_motion = it.effect().stage == Stage::Physics;
            place_of(changes_motion, it.seat().channel)
        });
        let is_place = stated.is_some_and(|stated| place.as_ref() == Some(&stated.of));
        self.is_named_up_to_equivalence() || is_place
    }

    /// Probability [-] of the effect and of all in its equivalence set.
    pub(super) fn probability_on_set(&self) -> f64 {
        let (Some(answer), Some(hidden)) = (&self.answer, self.hidden()) else {
            return 0.0;
        };
        let alike = answer.suspect(&hidden.name);
        let alike = alike.map_or(&[][..], |suspect| &suspect.equivalent_to);
        let others = alike.iter().filter(|name| **name != hidden.name);
        let others: f64 = others.map(|name| answer.probability(name)).sum();
        answer.probability(&hidden.name) + others
    }

    /// Whether what is left is located in a channel in which the effect shows.
    pub(super) fn is_located(&self) -> bool {
        let (Some(answer), Some(Ok(effect))) =
            (&self.answer, self.hidden().map(Hidden::application))
        else {
            return false;
        };
        let shows = effect.effect().signature.channels.iter().copied();
        let channels: Vec<&str> = shows.chain([effect.seat().channel]).collect();
        let mut cells = answer.located.iter().map(ToString::to_string);
        cells.any(|cell| {
            channels
                .iter()
                .any(|it| !it.is_empty() && cell.contains(it))
        })
    }

    /// What was found of the effect's magnitude, where the verdict names it.
    pub(super) fn magnitude(&self) -> Option<Magnitude> {
        let (hidden, suspect, effect) = self.found()?;
        let found = suspect.magnitude?;
        let error = (found - hidden.magnitude).abs();
        let [_, typical, _] = effect.seat().levels;
        let open = [f64::NEG_INFINITY, f64::INFINITY];
        let covered = suspect.ci95.map(|ends| {
            let low = ends[0].unwrap_or(open[0]);
            let high = ends[1].unwrap_or(open[1]);
            (low..=high).contains(&hidden.magnitude)
        });
        Some(Magnitude {
            of_typical: error / distance(&effect, typical),
            of_true: error / distance(&effect, hidden.magnitude),
            is_covered: covered,
        })
    }

    fn found(&self) -> Option<(&Hidden, &Suspect, Application)> {
        let hidden = self.hidden().filter(|_| self.is_named())?;
        let suspect = self.answer.as_ref()?.suspect(&hidden.name)?;
        Some((hidden, suspect, hidden.application().ok()?))
    }

    /// The true magnitude's distance from neutral over the detection limit [-], inverted for magnitudes whose
    /// neutral value is infinite; none where the answer does not state it.
    pub(super) fn power(&self) -> Option<f64> {
        let hidden = self.hidden()?;
        let effect = hidden.application().ok()?;
        let screen = &self.answer.as_ref()?.screen;
        let screened = screen
            .iter()
            .find(|screened| screened.name == hidden.name)?;
        let detectable = screened.detectable.filter(|it| *it > 0.0)?;
        let size = distance(&effect, hidden.magnitude);
        Some(if effect.seat().neutral.is_finite() {
            size / detectable
        } else {
            detectable / size
        })
    }
}

/// Distance of a magnitude from neutral; the magnitude itself where neutral is infinite.
fn distance(effect: &Application, magnitude: f64) -> f64 {
    let neutral = effect.seat().neutral;
    if neutral.is_finite() {
        (magnitude - neutral).abs()
    } else {
        magnitude.abs()
    }
}

/// The label of an answer's name: `nothing` for none or parameter, pairs in the order of their letters.
fn label_of(name: &str) -> String {
    let nothing = [Verdict::None, Verdict::Parameter];
    match name.split_once('+') {
        Some((a, b)) => pair(a, b),
        None if nothing.iter().any(|it| it.name() == name) => NOTHING.to_owned(),
        None => name.to_owned(),
    }
}

fn pair(a: &str, b: &str) -> String {
    if a <= b {
        format!("{a}+{b}")
    } else {
        format!("{b}+{a}")
    }
}
