//! A hypothesis fitted to all conditions, and to all but each one of them.
//!
//! Numbers are whitened, so that with precisions `Λ` the log likelihood of parameters `θ` and
//! strengths `m` is `−½ (r − d(m) − J θ)ᵀ Λ (r − d(m) − J θ)`. It is exact in `θ` where the
//! change bends little, else taken about the best fit of the round before; its prior is normal of one
//! of a few spreads; strengths are tried on a grid that closes in on where the
//! posterior is. `Λ` holds the spread of measurements and replicates, the emulator's error at the
//! best fit, less where [pins](super::pins) set it right; is scaled by how loud the runs of a condition
//! were; and is less the farther a number lies from the fit (Student's t; Lange, Little and Taylor
//! 1989, J. Am. Stat. Assoc. 84:881-896), so that no cell decides alone. An effect also has an error of
//! [form](super::form). Few replicates whiten many statistics in part only, and what is left correlated
//! would be counted as often as it shows: each condition's log likelihood is weighed by the share of its
//! numbers that are independent, which replicates left out of the whitening tell
//! ([`Scatter`](super::scatter::Scatter)).
//!
//! All terms are sums over conditions: leaving one out is a subtraction. What the others say of it
//! is a predictive density, Laplace's approximation over the parameters.

use super::calibration::Calibration;
use super::emulator::{BENT, Emulated, Emulator};
use super::form;
use super::grid::Axis;
use super::hypothesis::{Hypothesis, Scale};
use super::observation::{Observation, Observed};
use super::pins::{Defect, Point};
use super::product::{add, log_sum, product, scaled, scores};
use super::scatter::{Loudness, mean_square};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use statrs::function::gamma::ln_gamma;

/// Rounds in which precisions settle.
const ROUNDS: usize = 3;
/// More of them at most, one a pin.
const PINNED: usize = 2;
/// Finer looks at strengths.
const LOOKS: usize = 7;
/// Variance of a parameter that does not move.
const FIXED: f64 = 1.0e-10;
/// Posterior points that make a prediction, and the log weight under the best from which on.
const PREDICTING: (usize, f64) = (16, -5.0);

/// What is to be explained, by what, with which constants.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// What the simulator says.
    pub emulator: &'a Emulator,
    /// What was measured.
    pub observation: &'a Observation,
    /// The constants.
    pub calibration: &'a Calibration,
}

impl<'a> Problem<'a> {
    /// Conditions, emulated and observed.
    pub(super) fn conditions(self) -> impl Iterator<Item = (&'a Emulated, &'a Observed)> {
        let observed = &self.observation.conditions;
        self.emulator.conditions.iter().zip(observed)
    }

    /// Departures, condition by condition, as they would be were all changes straight: less what is
    /// bent or lacking where the best explanation so far ends.
    pub(super) fn straightened(self) -> Vec<Vec<f64>> {
        let mut residuals: Vec<Vec<f64>> = self
            .conditions()
            .map(|(_, observed)| observed.residual.clone())
            .collect();
        let Some(middle) = &self.emulator.middle else {
            return residuals;
        };
        let defects = self.emulator.defects(middle);
        for ((residual, (emulated, _)), defect) in
            residuals.iter_mut().zip(self.conditions()).zip(defects)
        {
            let mut lacking = defect.change;
            emulated.add_bends(&middle.offsets, &mut lacking);
            add(residual, -1.0, &lacking);
        }
        residuals
    }
}

/// Median of a strength and its 95 % interval, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    pub value: f64,
    pub ci95: [f64; 2],
}

impl Estimate {
    /// Standard deviation, about: a quarter of the interval.
    pub fn deviation(&self) -> f64 {
        let [low, high] = self.ci95;
        0.25 * (high - low)
    }
}

/// A hypothesis, fitted.
#[derive(Debug)]
pub(super) struct Fit {
    pub hypothesis: Hypothesis,
    /// Where it ends.
    pub best: Point,
    /// Of each effect.
    pub strengths: Vec<Estimate>,
    /// Of each parameter [prior standard deviations], with its deviation.
    pub offsets: Vec<[f64; 2]>,
    /// Log evidence less log likelihood at the best fit [-]: what the freedom of the fit costs.
    pub occam: f64,
    /// Parameters and strengths that the measurements determine [-].
    pub determined: f64,
    /// Log likelihood [-] that each effect adds to that without it.
    pub gains: Vec<f64>,
    /// What it can score at most [-].
    pub most: f64,
    /// Mean square [-] that it leaves of all conditions beyond what measurements and replicates spread.
    pub left: f64,
    /// What the other conditions say of each.
    pub held_out: Vec<HeldOut>,
    /// Of each condition's numbers.
    spreads: Vec<Spread>,
}

/// Variance of a condition's numbers, the emulator's error with it.
#[derive(Debug)]
struct Spread {
    /// Were the runs of common loudness.
    common: Vec<f64>,
    /// As loud as they are.
    own: Vec<f64>,
    /// What effects add to both by their error of form.
    form: Vec<f64>,
}

impl Spread {
    /// Common and own variance, with this error of form.
    fn with_form(&self, form: &[f64]) -> [Vec<f64>; 2] {
        [&self.common, &self.own].map(|variance| sum(variance, form))
    }
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sum = a.to_vec();
    add(&mut sum, 1.0, b);
    sum
}

/// A condition predicted from the others.
#[derive(Debug)]
pub(super) struct HeldOut {
    /// Log predictive density of its numbers [-].
    pub log_density: f64,
    /// Its numbers less the prediction, over their deviations [-].
    pub scores: Vec<f64>,
    /// Loudness of that, and its mean square, outlying numbers cut [-]: over the deviations of runs of
    /// common loudness.
    pub loudness: f64,
    pub square: f64,
    /// Log deviations [-], summed.
    pub log_spread: f64,
    /// Share of the numbers that are independent [-].
    pub independent: f64,
    /// Numbers less those that parameters adapt to [-].
    pub freedom: f64,
    /// Whitened change predicted.
    pub shift: Vec<f64>,
}

impl Fit {
    /// A fit whose predictions are held against its own variances.
    pub fn new(problem: Problem, hypothesis: Hypothesis) -> Self {
        Self::beside(problem, hypothesis, None)
    }

    /// A fit whose predictions are held against the variances of `another`: of two explanations the
    /// one that claims less error would win by that alone.
    pub fn beside(problem: Problem, hypothesis: Hypothesis, another: Option<&Self>) -> Self {
        let mut spreads: Vec<Spread> = Vec::new();
        let mut precisions: Vec<Vec<f64>> = problem
            .conditions()
            .map(|(emulated, observed)| emulated.scatter.precision(&observed.variance))
            .collect();
        let nowhere = vec![0.0; problem.emulator.parameters.len()];
        let none = |(emulated, _): (&Emulated, &Observed)| Defect::none(emulated.cells.len());
        let mut defects: Vec<Defect> = problem.conditions().map(none).collect();
        let mut about = Local::all(problem, &nowhere, &defects);
        let mut posterior = Posterior::new(problem, &hypothesis, (&about, &precisions), None);
        // A pin draws the fit to it, and its defect changes a little on the way.
        let rounds = ROUNDS + problem.emulator.pins.len().min(PINNED);
        for _ in 1..rounds {
            let best = posterior.best();
            defects = problem.emulator.defects(&best);
            let conditions = problem.conditions().zip(&defects);
            (spreads, precisions) = conditions
                .map(|((emulated, observed), defect)| {
                    let model = Model::new(emulated, &best, defect);
                    let departure = model.departure(observed);
                    let spread =
                        model.spread((emulated, observed), &departure, problem.calibration);
                    let freedom = problem.calibration.freedom;
                    let own = sum(&spread.own, &spread.form);
                    let precision = precision(emulated, &departure, &own, freedom);
                    (spread, precision)
                })
                .unzip();
            about = Local::all(problem, &best.offsets, &defects);
            let axes = Some(posterior.axes);
            posterior = Posterior::new(problem, &hypothesis, (&about, &precisions), axes);
        }
        let best = posterior.best();
        let held_out = problem.conditions().enumerate();
        let held_out = held_out
            .map(|(number, _)| {
                let against = another.map_or(&spreads, |another| &another.spreads);
                let variances = against[number].with_form(&spreads[number].form);
                posterior.predict(problem, number, (&variances, &defects[number]))
            })
            .collect();
        Self {
            strengths: posterior.estimates(),
            offsets: posterior.offsets(),
            occam: posterior.occam(),
            // What is not held out has not paid.
            determined: match posterior.holds_out(problem) {
                true => posterior.determined(),
                false => 0.0,
            },
            gains: gains(
                problem,
                (&posterior, &best),
                (&about, &precisions),
                &spreads,
            ),
            most: f64::INFINITY,
            left: left(problem, &best),
            best,
            held_out,
            spreads,
            hypothesis,
        }
    }
}

/// Changes by effects and by parameters.
struct Model<'a> {
    point: &'a Point,
    by_effects: Vec<f64>,
    by_parameters: Vec<f64>,
    defect: &'a Defect,
}

impl<'a> Model<'a> {
    fn new(emulated: &Emulated, point: &'a Point, defect: &'a Defect) -> Self {
        let mut by_effects = vec![0.0; emulated.cells.len()];
        let mut by_parameters = by_effects.clone();
        emulated.add_effects(&point.effects, &mut by_effects);
        emulated.add_parameters(&point.offsets, &mut by_parameters);
        Self {
            point,
            by_effects,
            by_parameters,
            defect,
        }
    }

    /// The change of the numbers.
    fn change(&self) -> Vec<f64> {
        let mut change = self.by_effects.clone();
        add(&mut change, 1.0, &self.by_parameters);
        add(
            &mut change,
            1.0,
            &self.defect.change_at(&self.point.offsets),
        );
        change
    }

    fn departure(&self, observed: &Observed) -> Vec<f64> {
        let mut departure = observed.residual.clone();
        add(&mut departure, -1.0, &self.change());
        departure
    }

    /// The loudness of the runs is what the fit leaves of them.
    fn spread(
        &self,
        (emulated, observed): (&Emulated, &Observed),
        departure: &[f64],
        calibration: &Calibration,
    ) -> Spread {
        let mut of_emulator = vec![0.0; observed.variance.len()];
        for &(effect, strength) in &self.point.effects {
            emulated.shapes[effect].add_error(strength, &mut of_emulator);
        }
        for (error, offset) in emulated.jacobian_error.iter().zip(&self.point.offsets) {
            add(&mut of_emulator, offset * offset, error);
        }
        let relative = calibration.relative_error * calibration.relative_error;
        for part in [&self.by_effects, &self.by_parameters] {
            add(&mut of_emulator, relative, &scaled(part, part));
        }
        let variance = |loudness: f64| {
            let mut variance: Vec<f64> = observed.variance.iter().map(|v| loudness * v).collect();
            add(&mut variance, self.defect.left, &of_emulator);
            add(&mut variance, 1.0, &self.defect.error);
            variance
        };
        let (common, form) = (
            variance(1.0),
            form::scattered(emulated, &self.point.effects, calibration.equivalent),
        );
        let loudness = Loudness::of(&scores(departure, sum(&common, &form)));
        Spread {
            own: variance(observed.loudness.possible(loudness)),
            common,
            form,
        }
    }
}

/// Log likelihood [-] that each effect of a fit adds to that without it, the emulator as it is for both: what
/// pins are off by chance is in neither. Beside others it has to show where their error of form does not.
fn gains(
    problem: Problem,
    (fitted, best): (&Posterior, &Point),
    (about, precisions): (&[Local], &[Vec<f64>]),
    spreads: &[Spread],
) -> Vec<f64> {
    let likelihood = |effects: &[usize], precisions: &[Vec<f64>]| {
        let hypothesis = Hypothesis::Effects(effects.to_vec());
        Posterior::new(problem, &hypothesis, (about, precisions), None).likelihood()
    };
    let gain = |effect: &usize| {
        let others = best.effects.iter().copied();
        let others: Vec<(usize, f64)> = others.filter(|(other, _)| other != effect).collect();
        let without: Vec<usize> = others.iter().map(|(other, _)| *other).collect();
        if others.is_empty() {
            return fitted.likelihood() - likelihood(&without, precisions);
        }
        let beside = beside(problem, best, &others, spreads);
        likelihood(&fitted.effects, &beside) - likelihood(&without, &beside)
    };
    fitted.effects.iter().map(gain).collect()
}

/// Mean square [-] that a fit which ends here leaves of all conditions beyond what measurements and replicates
/// spread.
fn left(problem: Problem, best: &Point) -> f64 {
    let defects = problem.emulator.defects(best);
    let (mut sum, mut count) = (0.0, 0.0);
    for ((emulated, observed), defect) in problem.conditions().zip(&defects) {
        let departure = Model::new(emulated, best, defect).departure(observed);
        let precision = emulated.scatter.precision(&observed.variance);
        sum += product(&departure, &scaled(&departure, &precision));
        count += emulated.scatter.independent * departure.len() as f64;
    }
    (sum / count - 1.0).max(0.0)
}

/// What a fit's numbers tell beside the whole error of form of some of its effects.
fn beside(
    problem: Problem,
    best: &Point,
    others: &[(usize, f64)],
    spreads: &[Spread],
) -> Vec<Vec<f64>> {
    let defects = problem.emulator.defects(best);
    let conditions = problem.conditions().zip(spreads).zip(&defects);
    conditions
        .map(|(((emulated, observed), spread), defect)| {
            let [_, mut variance] = spread.with_form(&spread.form);
            let calibration = problem.calibration;
            let aligned = form::aligned(emulated, others, calibration.equivalent);
            add(&mut variance, 1.0, &aligned);
            let departure = Model::new(emulated, best, defect).departure(observed);
            precision(emulated, &departure, &variance, calibration.freedom)
        })
        .collect()
}

/// What a condition's numbers tell that lie so far from a fit, by Student's t.
fn precision(emulated: &Emulated, departure: &[f64], variance: &[f64], freedom: f64) -> Vec<f64> {
    let independent = emulated.scatter.independent;
    let precision = |(e, v): (&f64, &f64)| independent * (freedom + 1.0) / (freedom * v + e * e);
    departure.iter().zip(variance).map(precision).collect()
}

/// A condition about some parameters: `r − J θ − Q θ²`, less the defect, as a straight line in `θ`.
struct Local {
    jacobian: Vec<Vec<f64>>,
    residual: Vec<f64>,
}

impl Local {
    fn all(problem: Problem, offsets: &[f64], defects: &[Defect]) -> Vec<Self> {
        let conditions = problem.conditions().zip(defects);
        conditions
            .map(|((emulated, observed), defect)| Self::about(emulated, observed, offsets, defect))
            .collect()
    }

    fn about(emulated: &Emulated, observed: &Observed, offsets: &[f64], defect: &Defect) -> Self {
        let mut residual = observed.residual.clone();
        let nowhere = vec![0.0; offsets.len()];
        add(&mut residual, -1.0, &defect.change_at(&nowhere));
        let slopes = emulated.jacobian.iter().zip(&emulated.bend).zip(offsets);
        let jacobian = slopes.map(|((slope, bend), offset)| {
            let bent = offset.clamp(-BENT, BENT);
            let mut slope = slope.clone();
            if bent == *offset {
                add(&mut slope, 2.0 * bent, bend);
                add(&mut residual, bent * bent, bend);
            } else {
                add(&mut residual, -bent * bent, bend);
            }
            slope
        });
        let mut jacobian: Vec<Vec<f64>> = jacobian.collect();
        for (slope, lacking) in jacobian.iter_mut().zip(&defect.slopes) {
            add(slope, 1.0, lacking);
        }
        Self { jacobian, residual }
    }
}

/// Sums of one condition, at every point of the grid.
struct Terms {
    /// `Jᵀ Λ J`.
    information: DMatrix<f64>,
    /// `(r − d)ᵀ Λ (r − d)`.
    squares: Vec<f64>,
    /// `Jᵀ Λ (r − d)`, a column a point.
    projections: DMatrix<f64>,
}

impl Terms {
    fn new(
        emulated: &Emulated,
        Local { jacobian, residual }: &Local,
        precision: &[f64],
        axes: &[(usize, Axis)],
    ) -> Self {
        let count = jacobian.len();
        let weighted: Vec<Vec<f64>> = jacobian
            .iter()
            .map(|column| scaled(column, precision))
            .collect();
        let project = |row: &[f64]| {
            DVector::from_iterator(count, weighted.iter().map(|column| product(column, row)))
        };
        let information = DMatrix::from_fn(count, count, |i, j| {
            product(&weighted[i.max(j)], &jacobian[i.min(j)])
        });
        let weighted_residual = scaled(residual, precision);
        let mut squares = vec![product(&weighted_residual, residual)];
        let mut projections = vec![project(residual)];
        let mut former: Option<Vec<Vec<f64>>> = None;
        for (effect, axis) in axes {
            let changes: Vec<Vec<f64>> = axis
                .strengths
                .iter()
                .map(|strength| emulated.shapes[*effect].at(*strength))
                .collect();
            let own: Vec<_> = changes
                .iter()
                .map(|change| {
                    let weighted = scaled(change, precision);
                    let along = product(&weighted, residual);
                    let square = product(&weighted, change) - 2.0 * along;
                    (square, project(change), weighted)
                })
                .collect();
            let (mut all_squares, mut all_projections) = (Vec::new(), Vec::new());
            for place in 0..squares.len() {
                for (square, projection, weighted) in &own {
                    let cross = former.as_ref().map(|f| product(&f[place], weighted));
                    all_squares.push(squares[place] + square + 2.0 * cross.unwrap_or(0.0));
                    all_projections.push(&projections[place] - projection);
                }
            }
            (squares, projections) = (all_squares, all_projections);
            former = Some(changes);
        }
        let projections =
            DMatrix::from_fn(count, squares.len(), |row, point| projections[point][row]);
        Self {
            information,
            squares,
            projections,
        }
    }
}

/// Weights of strengths and spreads of parameters, given all conditions or all but one.
struct Fold {
    /// By spread of the parameters, by point of the grid.
    log_weights: Vec<Vec<f64>>,
    /// `Jᵀ Λ (r − d)`, a column a point.
    projections: DMatrix<f64>,
    /// By spread: the parameters' precision; none where they do not move.
    precisions: Vec<Option<Cholesky<f64, Dyn>>>,
}

impl Fold {
    /// Best parameters [prior standard deviations].
    fn offsets(&self, scale: usize, point: usize) -> DVector<f64> {
        match &self.precisions[scale] {
            Some(precision) => precision.solve(&self.projections.column(point)),
            None => DVector::zeros(self.projections.nrows()),
        }
    }

    fn best(&self) -> (usize, usize) {
        let mut best = (0, 0);
        for (scale, weights) in self.log_weights.iter().enumerate() {
            for (point, weight) in weights.iter().enumerate() {
                if *weight > self.log_weights[best.0][best.1] {
                    best = (scale, point);
                }
            }
        }
        best
    }

    /// Points that make predictions with their log weights, best first, which sum to one.
    fn predicting(&self) -> Vec<(usize, usize, f64)> {
        let mut points: Vec<(usize, usize, f64)> = Vec::new();
        for (scale, weights) in self.log_weights.iter().enumerate() {
            let of_scale = weights.iter().enumerate();
            points.extend(of_scale.map(|(point, weight)| (scale, point, *weight)));
        }
        points.sort_by(|a, b| b.2.total_cmp(&a.2));
        let least = points[0].2 + PREDICTING.1;
        points.retain(|point| point.2 >= least);
        points.truncate(PREDICTING.0);
        let sum = log_sum(points.iter().map(|point| point.2));
        for point in &mut points {
            point.2 -= sum;
        }
        points
    }
}

/// What all conditions say of strengths and parameters.
struct Posterior {
    effects: Vec<usize>,
    axes: Vec<(usize, Axis)>,
    log_prior: Vec<f64>,
    scales: Vec<Scale>,
    terms: Vec<Terms>,
}

impl Posterior {
    /// Strengths start over their priors, or about where they were `before`.
    fn new(
        problem: Problem,
        hypothesis: &Hypothesis,
        (about, precisions): (&[Local], &[Vec<f64>]),
        before: Option<Vec<(usize, Axis)>>,
    ) -> Self {
        let candidates = &problem.emulator.candidates;
        let effects = hypothesis.effects().to_vec();
        let first = before.is_none();
        let mut axes: Vec<(usize, Axis)> = match before {
            Some(axes) => axes
                .into_iter()
                .map(|(effect, axis)| (effect, axis.widened()))
                .collect(),
            None => effects
                .iter()
                .map(|&effect| (effect, Axis::over(&candidates[effect])))
                .collect(),
        };
        let scales = hypothesis.scales(problem.emulator.parameters.len());
        for look in 0.. {
            let terms = problem.conditions().zip(about).zip(precisions);
            let terms = terms
                .map(|(((emulated, _), about), precision)| {
                    Terms::new(emulated, about, precision, &axes)
                })
                .collect();
            let posterior = Self {
                effects: effects.clone(),
                log_prior: log_prior(problem, &axes),
                axes,
                scales: scales.clone(),
                terms,
            };
            let mut finer = posterior.axes.clone();
            // While precisions are those of no fit, it need not be where each fold has it.
            for ((_, axis), weights) in finer.iter_mut().zip(posterior.largest(!first)) {
                axis.refine(&weights, first && look == 0);
            }
            if look == LOOKS || finer.iter().all(|(_, axis)| axis.resolved) {
                return posterior;
            }
            axes = finer;
        }
        unreachable!("the last look returns")
    }

    /// Given all conditions but one.
    fn fold(&self, left_out: Option<usize>) -> Fold {
        let used = || {
            let terms = self.terms.iter().enumerate();
            terms.filter(move |(number, _)| Some(*number) != left_out)
        };
        let parameters = self.terms[0].information.nrows();
        let mut information = DMatrix::zeros(parameters, parameters);
        let mut squares = vec![0.0; self.log_prior.len()];
        let mut projections = DMatrix::zeros(parameters, self.log_prior.len());
        for (_, terms) in used() {
            information += &terms.information;
            add(&mut squares, 1.0, &terms.squares);
            projections += &terms.projections;
        }
        let precision = |spreads: &[f64]| {
            let moves = spreads.iter().any(|spread| *spread > 0.0);
            let prior = spreads
                .iter()
                .map(|spread| 1.0 / (spread * spread).max(FIXED));
            let prior = DMatrix::from_diagonal(&DVector::from_iterator(parameters, prior));
            moves.then(|| Cholesky::new(&information + prior)).flatten()
        };
        let precisions: Vec<_> = self
            .scales
            .iter()
            .map(|scale| precision(&scale.spreads))
            .collect();
        let log_weights = self.scales.iter().zip(&precisions);
        let log_weights = log_weights
            .map(|(scale, precision)| {
                let priors = scale
                    .spreads
                    .iter()
                    .map(|spread| libm::log((spread * spread).max(FIXED)));
                let volume = precision.as_ref().map_or(0.0, |precision| {
                    log_determinant(precision) + priors.sum::<f64>()
                });
                let gained = precision
                    .as_ref()
                    .and_then(|precision| precision.l_dirty().solve_lower_triangular(&projections));
                let point = |point: usize| {
                    let gained = gained
                        .as_ref()
                        .map_or(0.0, |g| g.column(point).norm_squared());
                    self.log_prior[point] + libm::log(scale.probability)
                        - 0.5 * (squares[point] - gained + volume)
                };
                (0..self.log_prior.len()).map(point).collect()
            })
            .collect();
        Fold {
            log_weights,
            projections,
            precisions,
        }
    }

    /// Largest log weight of each strength under the best, given all conditions, or over all
    /// folds.
    fn largest(&self, folds: bool) -> Vec<Vec<f64>> {
        let lengths: Vec<usize> = self.axes.iter().map(|(_, a)| a.strengths.len()).collect();
        let mut largest: Vec<Vec<f64>> = lengths
            .iter()
            .map(|length| vec![f64::NEG_INFINITY; *length])
            .collect();
        let folds = match self.terms.len() {
            conditions if folds && conditions > 1 => {
                (0..conditions).map(Some).chain([None]).collect()
            }
            _ => vec![None],
        };
        for left_out in folds {
            let fold = self.fold(left_out);
            let (scale, point) = fold.best();
            let best = fold.log_weights[scale][point];
            for (point, place) in (0..self.log_prior.len()).map(|p| (p, self.places(p))) {
                let weights = fold.log_weights.iter().map(|weights| weights[point] - best);
                let weight = weights.fold(f64::NEG_INFINITY, f64::max);
                for (axis, place) in place.into_iter().enumerate() {
                    largest[axis][place] = largest[axis][place].max(weight);
                }
            }
        }
        largest
    }

    /// Place on each axis of a point of the grid.
    fn places(&self, point: usize) -> Vec<usize> {
        let mut places = Vec::with_capacity(self.axes.len());
        let mut rest = point;
        for (_, axis) in self.axes.iter().rev() {
            places.push(rest % axis.strengths.len());
            rest /= axis.strengths.len();
        }
        places.reverse();
        places
    }

    /// A point of the grid with these parameters.
    fn at(&self, point: usize, offsets: &DVector<f64>) -> Point {
        let places = self.axes.iter().zip(self.places(point));
        Point {
            offsets: offsets.iter().copied().collect(),
            effects: places
                .map(|((effect, axis), place)| (*effect, axis.strengths[place]))
                .collect(),
        }
    }

    /// Whether conditions are predicted from the others. One condition cannot be predicted from none:
    /// its own fit stands for that.
    fn holds_out(&self, problem: Problem) -> bool {
        problem.calibration.held_out && self.terms.len() > 1
    }

    /// Largest log likelihood [-] over strengths.
    fn likelihood(&self) -> f64 {
        let fold = self.fold(None);
        let of_spread = |weights: &Vec<f64>| {
            let weights = weights.iter().zip(&self.log_prior);
            let possible = weights.filter(|(_, prior)| prior.is_finite());
            let likelihoods = possible.map(|(weight, prior)| weight - prior);
            likelihoods.fold(f64::NEG_INFINITY, f64::max)
        };
        let all = fold.log_weights.iter().map(of_spread);
        all.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The best fit.
    fn best(&self) -> Point {
        let fold = self.fold(None);
        let (scale, point) = fold.best();
        self.at(point, &fold.offsets(scale, point))
    }

    fn occam(&self) -> f64 {
        let fold = self.fold(None);
        let evidence = log_sum(fold.log_weights.iter().flatten().copied());
        let (scale, point) = fold.best();
        let offsets = fold.offsets(scale, point);
        let square: f64 = self
            .terms
            .iter()
            .map(|terms| {
                terms.squares[point] - 2.0 * terms.projections.column(point).dot(&offsets)
                    + offsets.dot(&(&terms.information * &offsets))
            })
            .sum();
        evidence + 0.5 * square
    }

    fn determined(&self) -> f64 {
        let fold = self.fold(None);
        let (scale, _) = fold.best();
        let information: DMatrix<f64> = self.terms.iter().map(|terms| &terms.information).sum();
        let parameters = fold.precisions[scale]
            .as_ref()
            .map_or(0.0, |precision| precision.solve(&information).trace());
        parameters + self.effects.len() as f64
    }

    fn offsets(&self) -> Vec<[f64; 2]> {
        let fold = self.fold(None);
        let (scale, point) = fold.best();
        let offsets = fold.offsets(scale, point);
        let inverse = fold.precisions[scale].as_ref().map(Cholesky::inverse);
        let deviation = |place: usize| {
            let variance = inverse
                .as_ref()
                .map_or(0.0, |inverse| inverse[(place, place)]);
            libm::sqrt(variance)
        };
        offsets
            .iter()
            .enumerate()
            .map(|(place, offset)| [*offset, deviation(place)])
            .collect()
    }

    fn estimates(&self) -> Vec<Estimate> {
        let fold = self.fold(None);
        let largest = fold
            .log_weights
            .iter()
            .flatten()
            .fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let mut masses: Vec<Vec<f64>> = self
            .axes
            .iter()
            .map(|(_, axis)| vec![0.0; axis.strengths.len()])
            .collect();
        for point in 0..self.log_prior.len() {
            let weights = fold
                .log_weights
                .iter()
                .map(|w| libm::exp(w[point] - largest));
            let weight: f64 = weights.sum();
            for (masses, place) in masses.iter_mut().zip(self.places(point)) {
                masses[place] += weight;
            }
        }
        let of = |((_, axis), masses): (&(usize, Axis), Vec<f64>)| {
            let below = |share| quantile(&axis.strengths, &masses, share);
            Estimate {
                value: below(0.5),
                ci95: [below(0.025), below(0.975)],
            }
        };
        self.axes.iter().zip(masses).map(of).collect()
    }

    fn predict(
        &self,
        problem: Problem,
        number: usize,
        ([common, own], defect): (&[Vec<f64>; 2], &Defect),
    ) -> HeldOut {
        let fold = self.fold(self.holds_out(problem).then_some(number));
        let (emulated, observed) = problem.conditions().nth(number).expect("one of them");
        let terms = &self.terms[number];
        let freedom = problem.calibration.freedom;
        let mut best: Option<HeldOut> = None;
        let mut logs = Vec::new();
        for (scale, point, log_weight) in fold.predicting() {
            let offsets = fold.offsets(scale, point);
            let mut adapted = offsets.clone();
            let (mut penalty, mut adapts) = (0.0, 0.0);
            if let Some(precision) = &fold.precisions[scale] {
                let of_others = precision.l() * precision.l().transpose();
                let ahead = terms.projections.column(point) - &terms.information * &offsets;
                if let Some(joint) = Cholesky::new(&of_others + &terms.information) {
                    let step = joint.solve(&ahead);
                    penalty = 0.5
                        * (step.dot(&(&of_others * &step)) + log_determinant(&joint)
                            - log_determinant(precision));
                    adapts = joint.solve(&terms.information).trace();
                    adapted += step;
                }
            }
            let adapted = self.at(point, &adapted);
            let departure = Model::new(emulated, &adapted, defect).departure(observed);
            let log_density = emulated.scatter.independent * log_density(&departure, own, freedom);
            logs.push(log_weight + log_density - penalty);
            if best.is_none() {
                let scores = |variance: &[f64]| scores(&departure, variance.iter().copied());
                let of_common = scores(common);
                let of_others = self.at(point, &offsets);
                best = Some(HeldOut {
                    log_density: 0.0,
                    scores: scores(own),
                    loudness: Loudness::of(&of_common),
                    square: mean_square(of_common.into_iter()),
                    log_spread: own.iter().map(|v| 0.5 * libm::log(*v)).sum(),
                    independent: emulated.scatter.independent,
                    freedom: (departure.len() as f64 - adapts).max(1.0),
                    shift: Model::new(emulated, &of_others, defect).change(),
                });
            }
        }
        let mut best = best.expect("a fold has a best point");
        best.log_density = log_sum(logs.into_iter());
        best
    }
}

fn log_prior(problem: Problem, axes: &[(usize, Axis)]) -> Vec<f64> {
    let mut sums = vec![0.0];
    for (effect, axis) in axes {
        let own = axis.log_prior(&problem.emulator.candidates[*effect]);
        sums = sums
            .iter()
            .flat_map(|sum| own.iter().map(move |log| sum + log))
            .collect();
    }
    sums
}

fn log_determinant(cholesky: &Cholesky<f64, Dyn>) -> f64 {
    let diagonal = cholesky.l_dirty().diagonal();
    2.0 * diagonal.iter().map(|x| libm::log(*x)).sum::<f64>()
}

/// Student's t of every number.
fn log_density(departure: &[f64], variance: &[f64], freedom: f64) -> f64 {
    let half = 0.5 * (freedom + 1.0);
    let constant =
        ln_gamma(half) - ln_gamma(0.5 * freedom) - 0.5 * libm::log(freedom * std::f64::consts::PI);
    let of = |(e, v): (&f64, &f64)| {
        constant - 0.5 * libm::log(*v) - half * libm::log1p(e * e / (freedom * v))
    };
    departure.iter().zip(variance).map(of).sum()
}

/// Where `share` of the masses lies below, straight between the places.
fn quantile(places: &[f64], masses: &[f64], share: f64) -> f64 {
    let total: f64 = masses.iter().sum();
    let mut below = -0.5 * masses[0] / total;
    let mut last = (places[0], 0.0);
    for (place, mass) in places.iter().zip(masses) {
        // Half of a place's mass lies on each side of it.
        let here = below + 0.5 * mass / total;
        let here = here.max(last.1);
        if here >= share && here > last.1 {
            return last.0 + (place - last.0) * (share - last.1) / (here - last.1);
        }
        below += mass / total;
        last = (*place, here);
    }
    last.0
}
