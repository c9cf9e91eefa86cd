//! Which explanations are good enough to be named.

use super::super::calibration::Calibration;
use super::super::check::Check;
use super::super::fit::Problem;
use super::super::form;
use super::super::hypothesis::Hypothesis;
use super::super::ranking::{Ranked, Ranking};
use super::healthy;

/// Which explanations are good enough to be named.
pub(super) struct Trust<'a> {
    ranking: &'a Ranking,
    calibration: &'a Calibration,
    /// Effects that parameters, however far off, absorb.
    absorbed: &'a [usize],
    /// Mean square [-] beyond what spread explains that the scenario as shipped leaves, outlying numbers cut, and that
    /// recalibration does, all numbers whole.
    shipped: f64,
    recalibrated: f64,
}

impl<'a> Trust<'a> {
    pub fn of(problem: Problem<'a>, ranking: &'a Ranking, absorbed: &'a [usize]) -> Self {
        Self {
            ranking,
            calibration: problem.calibration,
            absorbed,
            shipped: checked(ranking, &Hypothesis::None).map_or(0.0, |check| check.excess),
            recalibrated: healthy(ranking).left,
        }
    }

    /// Whether there is a gap to explain.
    pub fn is_gap(&self) -> bool {
        self.shipped > self.calibration.noticeable
    }

    /// Whether there is nothing against an explanation by effects: it passes its check, leaves little, and foretells
    /// better than differences of no known form.
    pub fn is_sound(&self, hypothesis: &Hypothesis) -> bool {
        !hypothesis.effects().is_empty()
            && self.passes(hypothesis)
            && self.explains(hypothesis)
            && self.score(hypothesis) > self.score(&Hypothesis::Unknown)
    }

    /// Whether what is left without any effect may be chance, or is little of the gap.
    pub fn is_cleared(&self) -> bool {
        self.kept(&healthy(self.ranking).hypothesis) == 1.0
    }

    /// Whether parameters, which absorb an effect, were tried in its place and fail, and it is not sound by itself.
    pub fn is_refuted(&self, hypothesis: &Hypothesis) -> bool {
        match hypothesis.effects() {
            [effect] => {
                self.absorbed.contains(effect) && !self.is_cleared() && !self.is_sound(hypothesis)
            }
            _ => false,
        }
    }

    /// Whether it passes its check with room to spare.
    pub fn is_roomy(&self, hypothesis: &Hypothesis) -> bool {
        self.p(hypothesis) >= self.calibration.with_second
    }

    /// Whether an explanation has the catalogue's law, or one as like it as equivalent effects are.
    pub fn has_law(&self, hypothesis: &Hypothesis) -> bool {
        let fit = self.ranking.fit(hypothesis);
        fit.is_none_or(|fit| fit.likeness > form::OTHER)
    }

    pub fn passes(&self, hypothesis: &Hypothesis) -> bool {
        self.p(hypothesis) >= self.calibration.failed
    }

    /// p-value [-] of what it leaves; one of what has no check.
    pub fn p(&self, hypothesis: &Hypothesis) -> f64 {
        checked(self.ranking, hypothesis).map_or(1.0, |check| check.p)
    }

    /// Whether an explanation leaves little of the gap: recalibration of that as shipped, effects of what
    /// recalibration leaves. An effect's loudest numbers count whole: it is there that one of another form is
    /// told from a wrong one.
    pub fn explains(&self, hypothesis: &Hypothesis) -> bool {
        let left_over = self.calibration.left_over;
        match hypothesis.effects() {
            [] => {
                let check = checked(self.ranking, hypothesis);
                check.is_some_and(|check| check.excess < left_over * self.shipped)
            }
            _ => self.left(hypothesis) < left_over,
        }
    }

    /// Share [-] of what recalibration leaves that an explanation by effects does too.
    fn left(&self, hypothesis: &Hypothesis) -> f64 {
        let fit = self.ranking.fit(hypothesis);
        match fit {
            Some(fit) if fit.left < self.recalibrated => fit.left / self.recalibrated,
            _ => 1.0,
        }
    }

    fn score(&self, hypothesis: &Hypothesis) -> f64 {
        let found = ranked(self.ranking, hypothesis);
        found.map_or(f64::NEG_INFINITY, |ranked| ranked.log_score)
    }

    /// Share [-] of its probability that an explanation keeps. One by another law than the catalogue's keeps as
    /// much as it explains of the gap: what it leaves may be its own, or that of something like it.
    pub fn kept(&self, hypothesis: &Hypothesis) -> f64 {
        let Some(check) = checked(self.ranking, hypothesis) else {
            return 1.0;
        };
        if self.explains(hypothesis) {
            return 1.0;
        }
        let passed = (check.p / self.calibration.failed).min(1.0);
        match self.has_law(hypothesis) {
            true => passed,
            false => passed.min(1.0 - self.left(hypothesis)),
        }
    }
}

fn checked(ranking: &Ranking, hypothesis: &Hypothesis) -> Option<Check> {
    ranked(ranking, hypothesis)?.check
}

fn ranked<'a>(ranking: &'a Ranking, hypothesis: &Hypothesis) -> Option<&'a Ranked> {
    let mut ranked = ranking.ranked.iter();
    ranked.find(|ranked| ranked.hypothesis == *hypothesis)
}
