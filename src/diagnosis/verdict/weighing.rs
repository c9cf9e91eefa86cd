//! Probabilities after all reservations, and the answer that they give.

use super::super::fit::{Fit, Problem};
use super::super::hypothesis::Hypothesis;
use super::super::product::log_sum;
use super::super::ranking::Ranking;
use super::super::screen::{END, Projected, Screened};
use super::trust::Trust;
use super::{Answer, Suspect, UNDECIDED, equivalent, healthy, located};
use std::collections::BTreeMap;

/// Probabilities after all reservations.
pub(super) struct Weighing {
    masses: Vec<(Hypothesis, f64)>,
    undecided: f64,
    /// What an effect has of the unknown's.
    lent: Option<Lent>,
    /// Effects for which parameters within their priors may stand.
    absorbed: Vec<usize>,
    /// Whether what is left without any effect may be chance, or is little of the gap.
    cleared: bool,
    pub reasons: Vec<String>,
}

/// The effect nearest to something unknown, and the probability that it has for that.
#[derive(Clone, Copy)]
struct Lent {
    effect: usize,
    mass: f64,
}

impl Weighing {
    pub fn of(problem: Problem, ranking: &Ranking, projected: &Projected) -> Self {
        let ranked = ranking.ranked.iter();
        let absorbed = absorbed(problem, projected);
        let mut weighing = Self {
            masses: ranked
                .map(|r| (r.hypothesis.clone(), libm::exp(r.log_probability)))
                .collect(),
            undecided: 0.0,
            lent: None,
            absorbed: match keeps_to_priors(healthy(ranking)) {
                true => absorbed.clone(),
                false => Vec::new(),
            },
            cleared: true,
            reasons: Vec::new(),
        };
        weighing.check(problem, ranking, &absorbed);
        weighing.disagreement(ranking);
        weighing.stand_in(problem);
        weighing.reserve(problem.calibration.surest);
        if weighing.unknown() + weighing.lent() >= problem.calibration.confident
            && !shows(problem, healthy(ranking))
        {
            weighing.without_unknown();
        }
        for (most, why) in &problem.observation.scarce {
            weighing.keep(*most);
            weighing.reasons.push((*why).to_owned());
        }
        if !weighing.cleared {
            let why = "recalibration alone leaves more than chance would on held-out conditions";
            weighing.reasons.push(why.to_owned());
        }
        weighing
    }

    /// What neither passes its check nor explains the gap gives its share to the likeliest sound explanation, else to
    /// the unknown, and a part of it to the effect that foretells best, which may act by another law than the
    /// catalogue's; where the best does either, the unknown has a small share of what it had. That the unknown
    /// itself foretells better than all of them is not asked for: it did not, and a wrong pair was named, where a
    /// world lacked an effect. An effect that parameters absorb keeps nothing where they fail: what it explains by
    /// another law than the catalogue's is the unknown's.
    fn check(&mut self, problem: Problem, ranking: &Ranking, absorbed: &[usize]) {
        let trust = Trust::of(problem, ranking, absorbed);
        let others = ranking.ranked.iter();
        let mut others = others.filter(|ranked| ranked.hypothesis != Hypothesis::Unknown);
        let all = log_sum(others.clone().map(|ranked| ranked.log_probability));
        let best = others.next().map(|ranked| &ranked.hypothesis);
        let unknown = self.unknown();
        let is_good =
            |best: &Hypothesis| trust.kept(best) == 1.0 && (trust.is_gap() || trust.is_roomy(best));
        let is_good = best.is_some_and(is_good);
        let of_unknown = match is_good {
            true => problem.calibration.doubt * unknown,
            false => unknown,
        };
        for ((hypothesis, mass), ranked) in self.masses.iter_mut().zip(&ranking.ranked) {
            *mass = match hypothesis {
                Hypothesis::Unknown => of_unknown,
                _ => (1.0 - of_unknown) * libm::exp(ranked.log_probability - all),
            };
        }
        self.without_seconds(&trust, problem.calibration.with_second);
        self.cleared = trust.is_cleared();
        let mut lost = 0.0;
        for (hypothesis, mass) in &mut self.masses {
            let kept = match trust.is_refuted(hypothesis) {
                true => 0.0,
                false => trust.kept(hypothesis),
            };
            lost += (1.0 - kept) * *mass;
            *mass *= kept;
        }
        let first = |is: &dyn Fn(&Hypothesis) -> bool| self.masses.iter().position(|(h, _)| is(h));
        let sound = first(&|h| trust.is_sound(h));
        let nearest = first(&|h| h.effects().len() == 1).filter(|_| sound.is_none());
        let heir = sound.or_else(|| first(&|h| *h == Hypothesis::Unknown));
        let mut inherited = lost;
        if let Some(nearest) = nearest {
            // What fails its check is told, and never so surely that it is named for it.
            let share = problem.calibration.nearest;
            let own = self.masses[nearest].1;
            let of_nearest = (share * lost).min((share - own).max(0.0));
            self.masses[nearest].1 += of_nearest;
            self.lent = Some(Lent {
                effect: self.masses[nearest].0.effects()[0],
                mass: of_nearest,
            });
            inherited -= of_nearest;
        }
        if let Some(heir) = heir {
            self.masses[heir].1 += inherited;
        }
        if lost >= problem.calibration.presumed {
            let why = "what foretells best fails its check on held-out conditions and leaves much of the gap";
            self.reasons.push(why.to_owned());
        }
        let unknown = self.unknown();
        let nearest = best.filter(|best| !best.effects().is_empty());
        if let (Some(nearest), true) = (nearest, unknown >= problem.calibration.confident) {
            self.reasons.push(format!(
                "of what the library has, {} foretells best: it in another form, or what is like it",
                nearest.name(problem.emulator).replace('+', " with ")
            ));
        }
    }

    /// Of a pair that barely passes its check, leaves the effect that explains the gap alone, the better of these,
    /// best first: where the form of the first is off, a second that is not there always helps.
    fn without_seconds(&mut self, trust: &Trust, least: f64) {
        for place in 0..self.masses.len() {
            let (pair, mass) = self.masses[place].clone();
            if pair.effects().len() < 2 || trust.p(&pair) >= least {
                continue;
            }
            let alone = |(other, _): &(Hypothesis, f64)| match other.effects() {
                [one] => pair.effects().contains(one) && trust.explains(other),
                _ => false,
            };
            if let Some(single) = self.masses.iter().position(alone) {
                self.masses[single].1 += mass;
                self.masses[place].1 = 0.0;
            }
        }
    }

    /// Says which effects are not named because parameters may stand for them.
    fn stand_in(&mut self, problem: Problem) {
        for &effect in &self.absorbed {
            let probability = self.mass(|h| h.effects().contains(&effect));
            if probability >= problem.calibration.presumed {
                let name = &problem.emulator.candidates[effect].name;
                self.reasons
                    .push(format!("{name} cannot be told from parameters"));
            }
        }
    }

    fn disagreement(&mut self, ranking: &Ranking) {
        let first = |engine: usize| {
            let ranked = ranking.ranked.iter();
            ranked.max_by(|a, b| a.engines[engine].total_cmp(&b.engines[engine]))
        };
        let [refit, forest] = [first(0), first(1)].map(|r| r.map(|r| &r.hypothesis));
        if refit != forest {
            self.reasons
                .push("refit and forest disagree on what is likeliest".to_owned());
        }
    }

    /// Leaves at most this probability to causes, the unknown among them: what is like a cause and in no library, or
    /// what an emulator has wrong of a loud one, is in no score.
    fn reserve(&mut self, most: f64) {
        self.keep_of(most, |h| {
            !matches!(h, Hypothesis::None | Hypothesis::Parameter)
        });
    }

    /// Leaves at most this probability decided.
    fn keep(&mut self, most: f64) {
        self.keep_of(most, |_| true);
    }

    /// Leaves this share of the probability of those that count, and of what was lent: that is a cause's.
    fn keep_of(&mut self, share: f64, counts: impl Fn(&Hypothesis) -> bool) {
        for (_, mass) in self.masses.iter_mut().filter(|(h, _)| counts(h)) {
            self.undecided += (1.0 - share) * *mass;
            *mass *= share;
        }
        if let Some(lent) = &mut self.lent {
            lent.mass *= share;
        }
    }

    /// Nothing says that what is left is more than repeats scatter.
    fn without_unknown(&mut self) {
        let unknown = self.masses.iter_mut();
        for (_, mass) in unknown.filter(|(hypothesis, _)| *hypothesis == Hypothesis::Unknown) {
            self.undecided += std::mem::take(mass);
        }
        self.lent = None;
        let why = "what recalibration leaves is no wider than repeats scatter, and shows in no statistic by itself";
        self.reasons.push(why.to_owned());
    }

    /// What the nearest effect has of the unknown's.
    fn lent(&self) -> f64 {
        self.lent.map_or(0.0, |lent| lent.mass)
    }

    fn unknown(&self) -> f64 {
        self.mass(|h| *h == Hypothesis::Unknown)
    }

    fn mass(&self, counts: impl Fn(&Hypothesis) -> bool) -> f64 {
        let masses = self
            .masses
            .iter()
            .filter(|(hypothesis, _)| counts(hypothesis));
        masses.map(|(_, mass)| mass).sum()
    }

    /// The answer and the effects it names.
    pub fn answer(&self, problem: Problem, projected: &Projected) -> (Answer, Vec<usize>) {
        let confident = problem.calibration.confident;
        let unknown = self.unknown();
        let [none, parameter] =
            [Hypothesis::None, Hypothesis::Parameter].map(|known| self.mass(|h| *h == known));
        if self.undecided > 1.0 - confident {
            return (Answer::Undecided, Vec::new());
        }
        let absorbed = self.of_absorbed();
        if self.cleared && none + parameter + absorbed >= problem.calibration.presumed {
            let answer = match none >= parameter + absorbed {
                true => Answer::None,
                false => Answer::Parameter,
            };
            return (answer, Vec::new());
        }
        // The nearest effect by another law is one way of being unknown.
        let lent = self.lent();
        if unknown > lent && unknown + lent >= confident {
            return (Answer::Unknown, Vec::new());
        }
        let effects = self.effects(problem, projected);
        let answer = match effects.len() {
            0 => Answer::Undecided,
            1 => Answer::Effect,
            _ => Answer::Effects,
        };
        (answer, effects)
    }

    /// Mass of the effects for which parameters may stand, but for what one of them was lent: that is the unknown's.
    fn of_absorbed(&self) -> f64 {
        let is_absorbed = |effect: &usize| self.absorbed.contains(effect);
        let lent = self.lent.filter(|lent| is_absorbed(&lent.effect));
        self.mass(|h| h.effects().iter().any(is_absorbed)) - lent.map_or(0.0, |lent| lent.mass)
    }

    /// The pair, or else the effect, that is probable enough to be named.
    fn effects(&self, problem: Problem, projected: &Projected) -> Vec<usize> {
        let confident = problem.calibration.confident;
        let alike = |a: usize, b: usize| a == b || equivalent(problem, projected, a, b);
        let same = |a: &[usize], b: &[usize]| match (a, b) {
            (&[a], &[b]) => alike(a, b),
            (&[a, b], &[c, d]) => (alike(a, c) && alike(b, d)) || (alike(a, d) && alike(b, c)),
            _ => false,
        };
        // Of those whose likes together are probable enough, the one that is likeliest by itself.
        let likeliest = |of: &dyn Fn(&Hypothesis) -> bool, mass: &dyn Fn(&[usize]) -> f64| {
            let masses = self.masses.iter();
            let probable = masses.filter(|(h, _)| of(h) && mass(h.effects()) >= confident);
            let best = probable.max_by(|a, b| a.1.total_cmp(&b.1));
            best.map(|(hypothesis, _)| hypothesis.effects().to_vec())
        };
        let pairs = |h: &Hypothesis| h.effects().len() == 2;
        let of_pair = |pair: &[usize]| self.mass(|h| same(h.effects(), pair));
        let singles = |h: &Hypothesis| h.effects().len() == 1;
        let of_single =
            |one: &[usize]| self.mass(|h| h.effects().iter().any(|&e| alike(e, one[0])));
        likeliest(&pairs, &of_pair)
            .or_else(|| likeliest(&singles, &of_single))
            .unwrap_or_default()
    }

    pub fn told(&self, problem: Problem) -> BTreeMap<String, f64> {
        let named = self
            .masses
            .iter()
            .map(|(hypothesis, mass)| (hypothesis.name(problem.emulator), *mass));
        named
            .chain([(UNDECIDED.to_owned(), self.undecided)])
            .collect()
    }

    pub fn suspects(
        &self,
        problem: Problem,
        ranking: &Ranking,
        projected: &Projected,
    ) -> Vec<Suspect> {
        let table = projected.table(problem.emulator, problem.calibration.equivalent);
        let mut suspects: Vec<Suspect> = table
            .into_iter()
            .enumerate()
            .filter_map(|(number, screened)| {
                let probability = self.mass(|h| h.effects().contains(&number));
                self.suspect(problem, ranking, (number, screened), probability)
            })
            .collect();
        suspects.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        suspects
    }

    /// With the magnitude of the likeliest explanation that has it.
    fn suspect(
        &self,
        problem: Problem,
        ranking: &Ranking,
        (number, screened): (usize, Screened),
        probability: f64,
    ) -> Option<Suspect> {
        let explains = self
            .masses
            .iter()
            .filter(|(h, _)| h.effects().contains(&number));
        let (hypothesis, _) = explains.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let place = hypothesis
            .effects()
            .iter()
            .position(|&effect| effect == number)?;
        let estimate = ranking.fit(hypothesis)?.strengths[place];
        let candidate = &problem.emulator.candidates[number];
        let mut ci95 = estimate.ci95.map(|end| candidate.magnitude(end));
        ci95.sort_by(f64::total_cmp);
        Some(Suspect {
            name: screened.name,
            probability,
            magnitude: candidate.magnitude(estimate.value),
            unit: candidate.seat.unit,
            ci95,
            equivalent_to: screened
                .equivalent
                .into_iter()
                .map(|(name, _)| name)
                .collect(),
            detectable: screened.detectable,
            absorbed: screened.absorbed,
        })
    }
}

/// Whether what recalibration leaves shows: in some statistic by itself, or in all of them beyond what repeats
/// scatter.
fn shows(problem: Problem, recalibrated: &Fit) -> bool {
    recalibrated.left > problem.calibration.noticeable || !located(problem, recalibrated).is_empty()
}

/// Effects that parameters, however far off, absorb as far as equivalent effects would each other.
fn absorbed(problem: Problem, projected: &Projected) -> Vec<usize> {
    let most = problem.calibration.equivalent * problem.calibration.equivalent;
    let all = 0..problem.emulator.candidates.len();
    all.filter(|&effect| projected.absorbed(effect) > most)
        .collect()
}

fn keeps_to_priors(recalibrated: &Fit) -> bool {
    let mut offsets = recalibrated.offsets.iter();
    offsets.all(|[offset, _]| offset.abs() <= END)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_unknown_lends_an_effect_that_parameters_absorb_is_no_parameter_s() {
        let effect = Hypothesis::Effects(vec![3]);
        let weighing = |own: f64, lent: f64| Weighing {
            masses: vec![
                (Hypothesis::Unknown, 1.0 - own - lent),
                (effect.clone(), own + lent),
            ],
            undecided: 0.0,
            lent: Some(Lent {
                effect: 3,
                mass: lent,
            }),
            absorbed: vec![3],
            cleared: true,
            reasons: Vec::new(),
        };
        assert_eq!(weighing(0.0, 0.4).of_absorbed(), 0.0);
        assert!((weighing(0.2, 0.2).of_absorbed() - 0.2).abs() < 1e-12);
        let of_another = Weighing {
            lent: Some(Lent {
                effect: 1,
                mass: 0.2,
            }),
            ..weighing(0.2, 0.2)
        };
        assert!((of_another.of_absorbed() - 0.4).abs() < 1e-12);
    }
}
