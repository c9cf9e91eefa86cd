//! Scores by how well an effect could be detected: see [`Hidden::detectability`].
//!
//! A miss of an effect that no one could have seen is no fault, and a case of two effects is as hard as the less
//! detectable one. Below a `d'` of 3 only the probabilities count, of which the log score is the proper measure; the
//! headline is from 6 on.

use super::auroc_against;
use super::interval::Score;
use super::judged::Judged;
use crate::challenge::order::Set;
use crate::challenge::truth::Hidden;
use serde::Serialize;

/// Ends of the classes of `d'` [-].
const CLASSES: [f64; 5] = [0.0, 3.0, 6.0, 12.0, f64::INFINITY];
/// `d'` [-] from which on an effect counts in the headline.
const CLEAR: f64 = 6.0;

/// Which `d'` of an effect counts.
pub(super) type Which = fn(&Hidden) -> Option<f64>;

/// Cases of one effect whose `d'` lies in a class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OfClass {
    /// Lower end of the class [-].
    pub low: f64,
    /// Upper end [-]; none where it has none.
    pub high: Option<f64>,
    /// Share named.
    pub top1: Score,
    /// Share named up to equivalence.
    pub top1_equivalent: Score,
    /// Share named up to equivalence, or whose mechanism is the one that is stated.
    pub effect_or_mechanism: Score,
    /// Mean logarithm of the probability of the effect [-].
    pub log_score: Score,
}

/// Cases of one effect by `d'`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByClass {
    /// From 6 on.
    pub headline: OfClass,
    /// Below 3, 3 to 6, 6 to 12, above.
    pub classes: Vec<OfClass>,
}

/// Whether an effect was named, beside how well it could be detected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detected {
    /// The effect's name without channel.
    pub effect: String,
    /// C1 or C2.
    pub set: Set,
    /// `d'` [-] beside unknown parameters.
    pub detectability: f64,
    /// Whether it was named, up to equivalence.
    pub is_named: bool,
}

/// The cases of C1 and C2 whose `d'` is known, by name and `d'`.
pub(super) fn detections(cases: &[Judged]) -> Vec<Detected> {
    let of = |case: &Judged| {
        let single = case.is_of(Set::C1) || case.is_of(Set::C2);
        let effect = case.hidden().filter(|_| single)?;
        Some(Detected {
            effect: effect.effect().to_owned(),
            set: case.truth.set,
            detectability: case.detectability(|it| it.detectability_beside_parameters)?,
            is_named: case.is_named_up_to_equivalence(),
        })
    };
    let mut detections: Vec<Detected> = cases.iter().filter_map(of).collect();
    detections.sort_by(|a, b| {
        let by_name = a.effect.cmp(&b.effect);
        by_name.then(a.detectability.total_cmp(&b.detectability))
    });
    detections
}

/// Scores by `d'`; cases whose `d'` is not known are in none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ByDetectability {
    /// Effects in the catalogue's form.
    #[serde(rename = "C1")]
    pub own_form: ByClass,
    /// Effects in another form.
    #[serde(rename = "C2")]
    pub other_form: ByClass,
    /// Area under the curve by which the probability of `unknown` discriminates C3 from 6 on from all other sets.
    #[serde(rename = "C3_auroc")]
    pub unknown: Score,
    /// Share of pairs, both from 6 on, of which one effect is named at least.
    #[serde(rename = "C4_one_named")]
    pub one_named: Score,
    /// Share of them with both named.
    #[serde(rename = "C4_both_named")]
    pub both_named: Score,
}

impl OfClass {
    fn of(cases: &[&Judged], [low, high]: [f64; 2], which: Which) -> Self {
        let is_within = |case: &&&Judged| {
            let found = case.detectability(which);
            found.is_some_and(|found| low <= found && found < high)
        };
        let own: Vec<&Judged> = cases.iter().filter(is_within).copied().collect();
        let share = |is_hit: fn(&Judged) -> bool| Score::share(own.iter().map(|it| is_hit(it)));
        Self {
            low,
            high: high.is_finite().then_some(high),
            top1: share(Judged::is_named),
            top1_equivalent: share(Judged::is_named_up_to_equivalence),
            effect_or_mechanism: share(Judged::is_effect_or_mechanism),
            log_score: Score::mean(own.iter().map(|case| case.log_score())),
        }
    }
}

impl ByDetectability {
    pub(super) fn of(cases: &[Judged], which: Which) -> Self {
        let of = |set: Set| -> Vec<&Judged> { cases.iter().filter(|it| it.is_of(set)).collect() };
        let by_class = |set: Set| {
            let ends = CLASSES.windows(2).map(|ends| [ends[0], ends[1]]);
            ByClass {
                headline: OfClass::of(&of(set), [CLEAR, f64::INFINITY], which),
                classes: ends
                    .map(|ends| OfClass::of(&of(set), ends, which))
                    .collect(),
            }
        };
        let is_clear = |case: &Judged| case.detectability(which).is_some_and(|it| it >= CLEAR);
        let left_out = of(Set::C3).into_iter().filter(|case| is_clear(case));
        let left_out: Vec<&Judged> = left_out.collect();
        let others = cases.iter().filter(|case| !case.is_of(Set::C3));
        let pairs = of(Set::C4).into_iter().filter(|case| is_clear(case));
        let named: Vec<usize> = pairs.map(Judged::named_of_pair).collect();
        Self {
            own_form: by_class(Set::C1),
            other_form: by_class(Set::C2),
            unknown: auroc_against(&left_out, &others.collect::<Vec<_>>()),
            one_named: Score::share(named.iter().map(|count| *count >= 1)),
            both_named: Score::share(named.iter().map(|count| *count == 2)),
        }
    }

    /// Whether any case has a `d'`.
    pub(super) fn is_known(&self) -> bool {
        let singles = [&self.own_form, &self.other_form];
        let mut classes = singles.into_iter().flat_map(|it| &it.classes);
        classes.any(|class| class.top1.n > 0)
            || self.unknown.value.is_some()
            || self.one_named.n > 0
    }
}
