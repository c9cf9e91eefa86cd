//! How well the effects of a case could be detected: `d'`.
//!
//! An oracle is given the rig and the effect and has to decide from the statistics of a campaign whether the effect is
//! there. With the mean change `Δ` of the statistics by the effect and their covariance `C` between campaigns it is right
//! as often as for two normal distributions whose means are `d'` standard deviations apart,
//!
//! ```text
//! d'² = Σ Δᵀ C⁻¹ Δ        over the conditions of the campaign, which are independent
//! ```
//!
//! - The statistics are those of the diagnosis. A large change counts by its logarithm (`asinh`), as there.
//! - `C` is that of [`noise`](mod@noise): replicates of the nominal rig, which differ by seed only. Their seed is in no [`Family`].
//! - `Δ` is the difference of paired runs, with the effect and without any, of the same rig, seed and number. Of an effect
//!   on sensors both measure one motion. With other effects the motions diverge, so that a difference contains noise of
//!   its own: an ovality of 0.1 mm on slate would have a `d'` of 29, over some hundred statistics of which none changes on
//!   average. The square is therefore estimated from products of *different* pairs, `yᵢ · yⱼ` with `y = C^(-1/2) Δ`,
//!   the noise of which is independent. Without an effect their expectation is 0, and there is no floor to be subtracted
//!   (that ovality: 0). A negative estimate is a `d'` of 0. What is left is the scatter of the estimate, none for
//!   sensors and largest for an effect that only makes the motion diverge.
//!
//! The parameters of the rig are known to this oracle, so that `d'` is an upper bound of what an answer can rest on.
//! Whoever answers does not know them: what a parameter could have caused as well is no evidence of an effect. A second
//! oracle is therefore given their distribution in the design only. To its covariance each parameter adds the change
//! `g` by one standard deviation, in all conditions together; with the matrix `G` of the whitened changes
//!
//! ```text
//! d'² = y · y - aᵀ (1 + Gᵀ G)⁻¹ a,     a = Gᵀ y
//! ```

mod noise;

use super::design::{Design, SPREAD};
use super::order::Family;
use super::runs::{NoRuns, Runner, affected, rig};
use super::truth::{Hidden, Truth};
use crate::diagnosis::condition::statistician;
use crate::effects::Stage;
use crate::gap::Readings;
use crate::quantity::Seed;
use crate::scenario::Scenario;
use crate::scenario::experiment::ExperimentError;
use crate::trace::Trace;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use noise::{Noise, Replicates, noise};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Replicates of every condition.
const REPLICATES: usize = 20;
/// Pairs of every condition with a parameter off its value and without.
const PAIRS_OF_PARAMETERS: usize = 4;
/// Pairs of every condition for an effect on sensors, whose changes hardly differ from pair to pair.
const PAIRS_OF_SENSORS: usize = 2;
/// Pairs for another effect.
const PAIRS_OF_MOTIONS: usize = 4;
/// Digits after the point to which it is stated: the last bits depend on the processor, and a trial is to be reproducible.
const STATED: f64 = 100.0;

/// Detectability of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Detectability {
    /// `d'` [-] where the parameters are known.
    pub known: f64,
    /// `d'` [-] where only their distribution is.
    pub beside_parameters: f64,
}

/// What paired runs of one ground are compared with.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Oracle {
    noise: Vec<Noise>,
    parameters: Parameters,
}

/// How many runs an oracle simulates first.
pub(super) fn runs(design: &Design) -> usize {
    let pairs = PAIRS_OF_PARAMETERS * design.parameters();
    (REPLICATES + pairs) * design.conditions.len()
}

/// How many motions the detectability of an effect takes.
pub(super) fn motions(hidden: &Hidden, design: &Design) -> usize {
    let shares_motion = is_of_sensors(hidden);
    let of_pair = if shares_motion { 1 } else { 2 };
    of_pair * pairs(shares_motion) * design.conditions.len()
}

/// Pairs of every condition for an effect, which is on sensors or not.
fn pairs(shares_motion: bool) -> usize {
    if shares_motion {
        PAIRS_OF_SENSORS
    } else {
        PAIRS_OF_MOTIONS
    }
}

fn is_of_sensors(hidden: &Hidden) -> bool {
    let effect = hidden.application();
    effect.is_ok_and(|effect| effect.effect().stage == Stage::Sensors)
}

/// What runs are made with.
#[derive(Clone, Copy)]
pub(super) struct Bench<'a> {
    pub design: &'a Design,
    pub runner: &'a Runner<'a>,
}

impl Bench<'_> {
    fn conditions(&self) -> usize {
        self.design.conditions.len()
    }

    /// The statistics of replicates of a rig, by condition.
    fn replicates(&self, rig: &Scenario, seed: Seed, count: usize) -> Result<Rows, NoRuns> {
        let runs = (0..count * self.conditions()).into_par_iter();
        // The number of a run is the same for every rig, so that runs of two rigs are pairs.
        let read = runs
            .with_max_len(1)
            .map_init(statistician, |statistician, run| {
                let scenario =
                    rig.with_all(&self.design.conditions[run % self.conditions()].set)?;
                let trace = self.runner.run(&scenario, seed, run as u64)?;
                let statistician = statistician.as_mut().map_err(|error| error.clone())?;
                Ok(statistician.read(&trace))
            });
        let read: Vec<Readings> = read.collect::<Result<_, NoRuns>>()?;
        let of = |condition: usize| read.iter().skip(condition).step_by(self.conditions());
        let rows = (0..self.conditions()).map(|it| of(it).cloned().collect());
        Ok(rows.collect())
    }
}

/// Statistics of several runs of each condition.
type Rows = Vec<Vec<Readings>>;

impl Oracle {
    /// The oracle of a ground; replicates are simulated on the current thread pool.
    pub(super) fn of(bench: Bench, family: Family, master: Seed) -> Result<Self, NoRuns> {
        let seed = family.oracle_seed(master, bench.design.ground);
        Self::of_replicates(bench, seed, [REPLICATES, PAIRS_OF_PARAMETERS])
    }

    fn of_replicates(
        bench: Bench,
        seed: Seed,
        [replicates, pairs]: [usize; 2],
    ) -> Result<Self, NoRuns> {
        let nominal = rig(bench.design, &[])?;
        let rows = bench.replicates(&nominal, seed, replicates)?;
        let conditions = bench.design.conditions.iter().zip(&rows);
        let replicates = conditions.map(|(condition, readings)| Replicates {
            is_lifted: condition.is_lifted,
            repeats: condition.repeats,
            readings: readings.clone(),
        });
        let noise = noise(&replicates.collect::<Vec<_>>());
        let noise = noise.ok_or_else(|| NoRuns::Failed("the statistics do not vary".to_owned()))?;
        let mut changes = Vec::new();
        for edits in bench.design.departures() {
            let other = bench.replicates(&rig(bench.design, &edits)?, seed, pairs)?;
            changes.push(whitened(&noise, &other, &rows));
        }
        let size = noise.iter().map(Noise::size).sum();
        Ok(Self {
            noise,
            parameters: Parameters::of(&changes, size),
        })
    }

    /// How well an effect of a case could be detected if there were no other.
    pub(super) fn detectability(
        &self,
        bench: Bench,
        truth: &Truth,
        hidden: &Hidden,
    ) -> Result<Detectability, NoRuns> {
        let rigs = Rigs {
            without: affected(truth, bench.design, &[])?,
            with: affected(truth, bench.design, std::slice::from_ref(hidden))?,
            shares_motion: is_of_sensors(hidden),
        };
        let count = pairs(rigs.shares_motion);
        let mut statistician = statistician()?;
        let mut with: Rows = vec![Vec::new(); bench.conditions()];
        let mut without = with.clone();
        for run in 0..count * bench.conditions() {
            let condition = run % bench.conditions();
            let rigs = rigs.in_condition(&bench.design.conditions[condition].set)?;
            // The runs of the campaign come before.
            let number = (bench.design.runs() + run) as u64;
            let motions = rigs.traces(bench.runner, truth.seed, number)?;
            let [changed, plain] = &motions;
            let readings = statistician.read(plain);
            with[condition].push(statistician.read_again(changed, plain, &readings));
            without[condition].push(readings);
        }
        let pairs = whitened(&self.noise, &with, &without);
        Ok(self.parameters.detectability(&pairs))
    }
}

/// A rig with an effect and without.
struct Rigs {
    with: Scenario,
    without: Scenario,
    /// Whether the effect is on sensors, which both measure the same motion.
    shares_motion: bool,
}

impl Rigs {
    fn in_condition(&self, set: &[String]) -> Result<Self, NoRuns> {
        Ok(Self {
            with: self.with.with_all(set)?,
            without: self.without.with_all(set)?,
            shares_motion: self.shares_motion,
        })
    }

    /// The same run of both.
    fn traces(&self, runner: &Runner, seed: Seed, number: u64) -> Result<[Trace; 2], NoRuns> {
        if !self.shares_motion {
            let with = runner.run(&self.with, seed, number)?;
            return Ok([with, runner.run(&self.without, seed, number)?]);
        }
        let motion = runner.record(&self.without, seed, number)?;
        let measured = |scenario: &Scenario| -> Result<Trace, NoRuns> {
            let experiment = scenario.experiment().map_err(ExperimentError::from)?;
            Ok(motion.measure(&experiment.sensors)?.as_measured())
        };
        Ok([measured(&self.with)?, measured(&self.without)?])
    }
}

/// Whitened changes of all conditions together, one a pair of runs.
fn whitened(noise: &[Noise], with: &Rows, without: &Rows) -> Vec<DVector<f64>> {
    let pairs = with.iter().map(Vec::len).min().unwrap_or(0);
    let pair = |pair: usize| {
        let conditions = noise.iter().zip(with.iter().zip(without));
        let white =
            conditions.map(|(noise, (with, without))| noise.white(&with[pair], &without[pair]));
        let white: Vec<f64> = white
            .flat_map(|it| it.iter().copied().collect::<Vec<_>>())
            .collect();
        DVector::from_vec(white)
    };
    (0..pairs).map(pair).collect()
}

/// What parameters whose distribution is known may have changed.
#[derive(Debug, Serialize, Deserialize)]
struct Parameters {
    /// Whitened change by a standard deviation, one a column.
    changes: DMatrix<f64>,
    /// Of the covariance of their coefficients, given the changes.
    factor: Cholesky<f64, Dyn>,
}

impl Parameters {
    /// From the whitened changes of the pairs of each parameter; `size` is the length of one.
    fn of(changes: &[Vec<DVector<f64>>], size: usize) -> Self {
        let columns = changes.iter().map(|pairs| {
            let sum: DVector<f64> = pairs.iter().sum();
            sum * (SPREAD / pairs.len() as f64)
        });
        let columns: Vec<f64> = columns
            .flat_map(|it| it.iter().copied().collect::<Vec<_>>())
            .collect();
        let changes = DMatrix::from_vec(size, changes.len(), columns);
        let normal = changes.tr_mul(&changes) + DMatrix::identity(changes.ncols(), changes.ncols());
        Self {
            factor: Cholesky::new(normal)
                .expect("a sum of squares and the identity is positive definite"),
            changes,
        }
    }

    /// The detectability of an effect with these whitened changes, two pairs or more.
    fn detectability(&self, pairs: &[DVector<f64>]) -> Detectability {
        let absorbed = |change: &DVector<f64>| {
            let along = self.changes.tr_mul(change);
            along.dot(&self.factor.solve(&along))
        };
        let known = unbiased(pairs, DVector::norm_squared);
        let beside = unbiased(pairs, |change| change.norm_squared() - absorbed(change));
        let stated = |square: f64| libm::round(STATED * libm::sqrt(square.max(0.0))) / STATED;
        Detectability {
            known: stated(known),
            beside_parameters: stated(beside),
        }
    }
}

/// The quadratic form of the expected change, from several changes with independent noise: the mean over products of
/// different ones.
fn unbiased(changes: &[DVector<f64>], form: impl Fn(&DVector<f64>) -> f64) -> f64 {
    let count = changes.len() as f64;
    let sum: DVector<f64> = changes.iter().sum();
    let own: f64 = changes.iter().map(&form).sum();
    (form(&sum) - own) / (count * (count - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::order::Set;
    use crate::challenge::truth::{Level, Rig};
    use crate::effects::Form;
    use rand_distr::{Distribution, StandardNormal};
    use std::ops::ControlFlow;

    fn changes(mean: &[f64], noise: f64, count: usize) -> Vec<DVector<f64>> {
        let mut rng = Seed(4).rng("changes", 0);
        let mut drawn = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut change = |_| DVector::from_fn(mean.len(), |row, _| mean[row] + noise * drawn());
        (0..count).map(&mut change).collect()
    }

    #[test]
    fn without_an_effect_diverging_motions_give_no_distance_and_with_one_they_add_none() {
        // 300 statistics: the square of each change is 300 by its noise alone. The mean of 780 products has a standard
        // error of 0.6.
        for distance in [0.0, 6.0] {
            let mut mean = vec![0.0; 300];
            mean[7] = distance;
            let found = unbiased(&changes(&mean, 1.0, 40), DVector::norm_squared);
            let error = libm::sqrt(600.0 / 780.0 / 2.0 + 4.0 * distance * distance / 40.0);
            assert!((found - distance * distance).abs() < 4.0 * error, "{found}");
        }
    }

    #[test]
    fn what_a_parameter_can_have_caused_is_no_evidence_of_an_effect() {
        // A parameter moves the first of two statistics by 4 standard deviations.
        let parameter = vec![DVector::from_vec(vec![4.0 / SPREAD, 0.0])];
        let parameters = Parameters::of(&[parameter], 2);
        let of = |change: [f64; 2]| {
            let change = DVector::from_vec(change.to_vec());
            parameters.detectability(&[change.clone(), change])
        };
        // Along it the standard deviation is that of 1 + 4².
        let along = of([8.5, 0.0]);
        assert_eq!((along.known, along.beside_parameters), (8.5, 2.06));
        let across = of([0.0, 3.0]);
        assert_eq!((across.known, across.beside_parameters), (3.0, 3.0));
    }

    fn gain(magnitude: f64) -> Hidden {
        Hidden {
            name: "gain_error.drawbar_pull".to_owned(),
            magnitude,
            unit: "-".to_owned(),
            form: Form::Own,
            level: Some(Level::Low),
            detectability: None,
            detectability_beside_parameters: None,
        }
    }

    #[test]
    fn a_larger_gain_error_is_detected_better_and_parameters_hide_a_part_of_it() {
        let design = Design::of("hard", Some(0.3)).unwrap().unwrap();
        let go_on = |_: f64| ControlFlow::Continue(());
        let bench = Bench {
            design: &design,
            runner: &Runner::new(&go_on),
        };
        let oracle = Oracle::of_replicates(bench, Seed(1), [8, 2]);
        let oracle = oracle.expect("the nominal rig can be simulated");
        let truth = Truth {
            case: "case_0001".to_owned(),
            family: Family::Scoring,
            set: Set::C1,
            ground: "hard".to_owned(),
            rig: Rig::Plain,
            edits: Vec::new(),
            effects: Vec::new(),
            seed: Seed(2),
            salt: String::new(),
        };
        let found = [1.0e-6, 0.01, 0.03, 0.08].map(|magnitude| {
            let found = oracle.detectability(bench, &truth, &gain(magnitude));
            found.expect("a sensor can be off")
        });
        assert!(found[0].known < 0.1, "{found:?}");
        assert!(found.is_sorted_by(|a, b| a.known < b.known), "{found:?}");
        for it in &found {
            assert!(it.beside_parameters <= it.known, "{found:?}");
        }
    }
}
