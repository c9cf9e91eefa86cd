//! How well each cause explains a campaign.
//!
//! With whitened scores `t` of the campaign, the emulator's `f(θ)` with derivatives `J`, a standard normal prior of `θ` and
//! the curve `D_e g(u)` of an effect, the misfit of a cause at the size `u`, least over `θ`, is
//!
//! ```text
//! m_e(u) = |P^½ (r − D_e g(u))|²,   P = 1 − Jᵀ H⁻¹ J,   H = 1 + J Jᵀ,   r = t − f(θ₀) + Jᵀ θ₀
//! ```
//!
//! linearised about `θ₀`, the estimate under the best cause so far. It is a quadratic form in `g(u)`, so that
//! the evidence `log ∫ exp(−m_e(u)/2) du` costs three products of vectors a cause. Of two effects the misfit is minimised
//! over both sizes.

use super::emulator::Emulator;
use super::place::CURVE;
use crate::diagnosis::rigs::Part;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix3, Vector3};

/// Sizes of the quadrature.
const GRID: usize = 33;
const GRID_ENDS: [f64; 2] = [-0.1, 1.1];
/// Least half width of an interval: what the grid resolves.
const NARROWEST: f64 = 0.01;
/// Linearisations.
const ROUNDS: usize = 3;
/// Estimates of parameters stay within so many prior standard deviations.
const FARTHEST: f64 = 3.0;
/// Effects that are tried in pairs with all others.
const LEADERS: usize = 5;

fn grid() -> impl Iterator<Item = f64> {
    let [from, to] = GRID_ENDS;
    (0..GRID).map(move |i| from + (to - from) * i as f64 / (GRID - 1) as f64)
}

/// Posterior of a size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Median.
    pub middle: f64,
    /// Central 95 %.
    pub interval: [f64; 2],
}

impl Size {
    /// With an interval so many times as wide, within the sizes that are tried.
    fn widened(self, factor: f64) -> Self {
        let [least, most] = GRID_ENDS;
        let end = |end: f64| (self.middle + factor * (end - self.middle)).clamp(least, most);
        Self {
            middle: self.middle,
            interval: self.interval.map(end),
        }
    }

    /// Distance of a size from the median in half widths of the interval.
    fn distance(&self, size: f64) -> f64 {
        let half = 0.5 * (self.interval[1] - self.interval[0]);
        (size - self.middle).abs() / half.max(NARROWEST)
    }
}

/// Two effects together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Which.
    pub effects: [usize; 2],
    /// Their sizes.
    pub sizes: [f64; 2],
    /// Least misfit.
    pub misfit: f64,
}

/// What speaks for each cause.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Misfit of parameters without effects.
    pub none: f64,
    /// Log evidence of parameters without effects less that of the scenario as it is.
    pub parameters_over_nominal: f64,
    /// Log evidence of each effect.
    pub effects: Vec<f64>,
    /// Least misfit with each effect.
    pub misfits: Vec<f64>,
    /// Size of each effect.
    pub sizes: Vec<Size>,
    /// The best pairs, best first.
    pub pairs: Vec<Pair>,
}

impl Evidence {
    /// With intervals of sizes so many times as wide.
    pub fn widened(mut self, factor: f64) -> Self {
        self.sizes = self.sizes.iter().map(|size| size.widened(factor)).collect();
        self
    }

    /// Distance of an effect's true size from its estimate, in half widths of the interval; none where another effect has
    /// more evidence.
    pub fn distance(&self, part: Part) -> Option<f64> {
        let own = self.effects[part.candidate];
        let is_best = self.effects.iter().all(|other| *other <= own);
        is_best.then(|| self.sizes[part.candidate].distance(part.size))
    }
}

/// A fit of parameters and given effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Parameters [prior standard deviations].
    pub parameters: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// The problem linearised about parameters.
struct Linear {
    about: DVector<f64>,
    derivatives: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
    /// `f(θ₀) − Jᵀ θ₀`.
    offset: DVector<f64>,
}

impl Linear {
    fn about(emulator: &Emulator, parameters: &[f64]) -> Self {
        let (value, derivatives) = emulator.at(parameters);
        let about = DVector::from_row_slice(parameters);
        let mut normal = &derivatives * derivatives.transpose();
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1.0);
        Self {
            offset: value - derivatives.tr_mul(&about),
            // One plus a square is positive definite.
            factor: Cholesky::new(normal).expect("positive definite"),
            derivatives,
            about,
        }
    }

    /// Estimate of the parameters from a residual.
    fn estimate(&self, residual: &DVector<f64>) -> DVector<f64> {
        let estimate = self.factor.solve(&(&self.derivatives * residual));
        estimate.map(|x| x.clamp(-FARTHEST, FARTHEST))
    }

    /// What parameters explain of products with columns: `J x`.
    fn seen(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        &self.derivatives * columns
    }

    fn log_determinant(&self) -> f64 {
        let diagonal = self.factor.l_dirty().diagonal();
        2.0 * diagonal.iter().map(|x| libm::log(*x)).sum::<f64>()
    }
}

/// Products of the effects' curves with each other and the residual, parameters marginalised.
struct Products {
    /// `Dᵀ P r`, three an effect.
    residual: DVector<f64>,
    /// `J D`.
    seen: DMatrix<f64>,
    /// `H⁻¹ J D`.
    solved: DMatrix<f64>,
    none: f64,
}

/// A misfit as a function of the size.
struct Misfit<'a> {
    none: f64,
    linear: Vector3<f64>,
    square: Matrix3<f64>,
    /// `g(u)` at the sizes of the grid.
    curve: &'a [Vector3<f64>],
}

/// The least of a misfit.
#[derive(Clone, Copy)]
struct Least {
    size: f64,
    curve: Vector3<f64>,
    misfit: f64,
}

impl Misfit<'_> {
    fn at(&self, curve: &Vector3<f64>) -> f64 {
        self.none - 2.0 * curve.dot(&self.linear) + curve.dot(&(self.square * curve))
    }

    fn least(&self) -> Least {
        let tried = grid().zip(self.curve).map(|(size, curve)| Least {
            size,
            curve: *curve,
            misfit: self.at(curve),
        });
        tried
            .min_by(|a, b| a.misfit.total_cmp(&b.misfit))
            .expect("the grid has sizes")
    }

    /// With another effect held at a size.
    fn beside(&self, other: &Self, held: &Vector3<f64>, between: &Matrix3<f64>) -> Self {
        Self {
            none: other.at(held),
            linear: self.linear - between * held,
            ..*self
        }
    }
}

/// Effects' curves, side by side.
pub struct Curves<'a> {
    emulator: &'a Emulator,
    columns: DMatrix<f64>,
    gram: Vec<Matrix3<f64>>,
    /// `g(u)` of each effect at the sizes of the grid.
    curves: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Curves<'a> {
    /// Of an emulator.
    pub fn of(emulator: &'a Emulator) -> Self {
        let mut columns = DMatrix::zeros(emulator.len(), CURVE * emulator.effects());
        for effect in 0..emulator.effects() {
            columns
                .columns_mut(CURVE * effect, CURVE)
                .copy_from(&emulator.effect(effect));
        }
        let gram = (0..emulator.effects()).map(|effect| {
            let own = columns.columns(CURVE * effect, CURVE);
            block(&own.tr_mul(&own))
        });
        let curve = |effect| {
            let curve = grid().map(|size| Vector3::from(emulator.curve(effect, size)));
            curve.collect()
        };
        Self {
            gram: gram.collect(),
            curves: (0..emulator.effects()).map(curve).collect(),
            emulator,
            columns,
        }
    }

    fn products(&self, linear: &Linear, scores: &DVector<f64>) -> Products {
        let residual = scores - &linear.offset;
        let seen = linear.seen(&self.columns);
        let solved = linear.factor.solve(&seen);
        let explained = &linear.derivatives * &residual;
        let of_residual = self.columns.tr_mul(&residual) - solved.tr_mul(&explained);
        let none = residual.norm_squared() - explained.dot(&linear.factor.solve(&explained));
        Products {
            residual: of_residual,
            seen,
            solved,
            none,
        }
    }

    fn misfit(&self, products: &Products, effect: usize) -> Misfit<'_> {
        Misfit {
            curve: &self.curves[effect],
            none: products.none,
            linear: Vector3::from_column_slice(
                products.residual.rows(CURVE * effect, CURVE).as_slice(),
            ),
            square: self.gram[effect] - products.absorbed([effect, effect]),
        }
    }

    /// What speaks for each cause of a campaign with these scores.
    pub fn evidence(&self, scores: &DVector<f64>) -> Evidence {
        let emulator = self.emulator;
        let count = emulator.parameters();
        let mut about = vec![0.0; count];
        let mut evidence = None;
        for _ in 0..ROUNDS {
            let linear = Linear::about(emulator, &about);
            let products = self.products(&linear, scores);
            let misfits: Vec<Misfit> = (0..emulator.effects())
                .map(|effect| self.misfit(&products, effect))
                .collect();
            let least: Vec<Least> = misfits.iter().map(Misfit::least).collect();
            let misfit = |effect: &usize| least[*effect].misfit;
            let best = (0..least.len()).min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
            let residual = scores - &linear.offset;
            let residual = match best {
                // An effect costs a parameter, its size.
                Some(best) if least[best].misfit + 2.0 < products.none => {
                    residual - self.change(best, least[best].size)
                }
                _ => residual,
            };
            about = linear.estimate(&residual).iter().copied().collect();
            evidence = Some((linear, products, misfits, least));
        }
        let (linear, products, misfits, least) = evidence.expect("some rounds");
        let posteriors: Vec<(f64, Size)> = misfits.iter().map(posterior).collect();
        Evidence {
            none: products.none,
            parameters_over_nominal: self.over_nominal(scores, &linear, products.none),
            pairs: self.pairs(&products, &misfits, &least),
            effects: posteriors.iter().map(|(log, _)| *log).collect(),
            misfits: least.iter().map(|it| it.misfit).collect(),
            sizes: posteriors.into_iter().map(|(_, size)| size).collect(),
        }
    }

    fn over_nominal(&self, scores: &DVector<f64>, linear: &Linear, none: f64) -> f64 {
        let (nominal, _) = self.emulator.at(&vec![0.0; linear.about.len()]);
        let misfit = (scores - nominal).norm_squared();
        -0.5 * (none + linear.log_determinant() - misfit)
    }

    fn change(&self, effect: usize, size: f64) -> DVector<f64> {
        self.columns.columns(CURVE * effect, CURVE)
            * Vector3::from(self.emulator.curve(effect, size))
    }

    /// The best partner of each of the leaders.
    fn pairs(&self, products: &Products, misfits: &[Misfit], least: &[Least]) -> Vec<Pair> {
        let mut order: Vec<usize> = (0..misfits.len()).collect();
        order.sort_by(|a, b| least[*a].misfit.total_cmp(&least[*b].misfit));
        let mut pairs: Vec<Pair> = Vec::new();
        for &first in order.iter().take(LEADERS) {
            for second in 0..misfits.len() {
                let known = |pair: &Pair| pair.effects == [second, first];
                if second == first || pairs.iter().any(known) {
                    continue;
                }
                let joint = Joint {
                    of: [first, second].map(|effect| &misfits[effect]),
                    between: self.between(products, [first, second]),
                };
                let (sizes, misfit) = joint.least(least[first]);
                pairs.push(Pair {
                    effects: [first, second],
                    sizes,
                    misfit,
                });
            }
        }
        pairs.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        pairs
    }

    /// `D_aᵀ P D_b`.
    fn between(&self, products: &Products, [a, b]: [usize; 2]) -> Matrix3<f64> {
        let [first, second] = [a, b].map(|effect| self.columns.columns(CURVE * effect, CURVE));
        block(&first.tr_mul(&second)) - products.absorbed([a, b])
    }

    /// The fit of these effects, each of a size, with the parameters free.
    pub fn fit(&self, scores: &DVector<f64>, effects: &[Part]) -> Fit {
        let changes = effects
            .iter()
            .map(|part| self.change(part.candidate, part.size));
        let scores = changes.fold(scores.clone(), |scores, change| scores - change);
        let mut about = vec![0.0; self.emulator.parameters()];
        for _ in 0..ROUNDS {
            let linear = Linear::about(self.emulator, &about);
            about = linear
                .estimate(&(&scores - &linear.offset))
                .iter()
                .copied()
                .collect();
        }
        let linear = Linear::about(self.emulator, &about);
        Fit {
            parameters: about,
            covariance: linear.factor.inverse(),
        }
    }

    /// Squared distance of each effect from none at a size, before and after what parameters absorb, near `parameters`.
    pub fn signatures(&self, parameters: &[f64], size: f64) -> Vec<[f64; 2]> {
        let linear = Linear::about(self.emulator, parameters);
        let signature = |effect| {
            let change = self.change(effect, size);
            let seen = &linear.derivatives * &change;
            let whole = change.norm_squared();
            [whole, whole - seen.dot(&linear.factor.solve(&seen))]
        };
        (0..self.emulator.effects()).map(signature).collect()
    }

    /// Cosines of what the effects show at a size once what parameters absorb is taken away.
    pub fn cosines(&self, parameters: &[f64], size: f64) -> DMatrix<f64> {
        let linear = Linear::about(self.emulator, parameters);
        let changes: Vec<DVector<f64>> = (0..self.emulator.effects())
            .map(|effect| self.change(effect, size))
            .collect();
        let changes = DMatrix::from_columns(&changes);
        let seen = linear.seen(&changes);
        let products = changes.tr_mul(&changes) - seen.tr_mul(&linear.factor.solve(&seen));
        let scale = products
            .diagonal()
            .map(|x| libm::sqrt(x.max(f64::MIN_POSITIVE)));
        DMatrix::from_fn(products.nrows(), products.ncols(), |i, j| {
            products[(i, j)] / (scale[i] * scale[j])
        })
    }
}

impl Products {
    /// What parameters absorb of the product of two effects.
    fn absorbed(&self, [a, b]: [usize; 2]) -> Matrix3<f64> {
        let seen = self.seen.columns(CURVE * a, CURVE);
        block(&seen.tr_mul(&self.solved.columns(CURVE * b, CURVE)))
    }
}

fn block(matrix: &DMatrix<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| matrix[(i, j)])
}

/// Log evidence, and the posterior of the size.
fn posterior(misfit: &Misfit) -> (f64, Size) {
    let sizes: Vec<f64> = grid().collect();
    let logs = misfit.curve.iter().map(|curve| -0.5 * misfit.at(curve));
    let logs: Vec<f64> = logs.collect();
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| libm::exp(log - largest)).collect();
    let total: f64 = weights.iter().sum();
    let quantile = |share: f64| {
        let mut below = 0.0;
        for (place, weight) in weights.iter().enumerate() {
            let weight = weight / total;
            if below + weight >= share {
                // Uniform within the cell of the grid.
                let cell = (GRID_ENDS[1] - GRID_ENDS[0]) / (GRID - 1) as f64;
                let within = (share - below) / weight - 0.5;
                return (sizes[place] + within * cell).clamp(GRID_ENDS[0], GRID_ENDS[1]);
            }
            below += weight;
        }
        GRID_ENDS[1]
    };
    let size = Size {
        middle: quantile(0.5),
        interval: [quantile(0.025), quantile(0.975)],
    };
    (largest + libm::log(total / GRID as f64), size)
}

/// The misfit of two effects.
struct Joint<'a> {
    of: [&'a Misfit<'a>; 2],
    /// Products of the first's curve, in rows, with the second's.
    between: Matrix3<f64>,
}

impl Joint<'_> {
    /// Sizes, one after the other from the first one's own on, and the least misfit.
    fn least(&self, first: Least) -> ([f64; 2], f64) {
        let [a, b] = self.of;
        let across = self.between.transpose();
        let second = b.beside(a, &first.curve, &across).least();
        let first = a.beside(b, &second.curve, &self.between).least();
        let second = b.beside(a, &first.curve, &across).least();
        let first = a.beside(b, &second.curve, &self.between).least();
        ([first.size, second.size], first.misfit)
    }
}

/// Sizes at which signatures are taken.
const SIZES: usize = 13;
/// The typical size.
const TYPICAL: f64 = 0.5;

/// What effects show.
#[derive(Debug, Clone, PartialEq)]
pub struct Signatures {
    /// Squared distance from no effect at the typical size, before and after what parameters absorb.
    pub typical: Vec<[f64; 2]>,
    /// Of each effect sizes in rising order, with the deviations by which it shows.
    pub by_size: Vec<Vec<[f64; 2]>>,
    /// Cosines of what effects of typical size show once what parameters absorb is taken away.
    pub cosines: DMatrix<f64>,
}

impl Signatures {
    /// Near these parameters.
    pub fn of(curves: &Curves, parameters: &[f64]) -> Self {
        let typical = curves.signatures(parameters, TYPICAL);
        let mut by_size = vec![Vec::new(); typical.len()];
        for place in 0..SIZES {
            let size = place as f64 / (SIZES - 1) as f64;
            let squares = curves.signatures(parameters, size);
            for (effect, [_, left]) in by_size.iter_mut().zip(squares) {
                effect.push([size, libm::sqrt(left.max(0.0))]);
            }
        }
        Self {
            typical,
            by_size,
            cosines: curves.cosines(parameters, TYPICAL),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_widened_interval_has_its_median_and_stays_within_the_sizes() {
        let size = Size {
            middle: 0.5,
            interval: [0.4, 0.7],
        };
        let widened = size.widened(2.0);
        assert_eq!(widened.middle, 0.5);
        assert!((widened.interval[0] - 0.3).abs() < 1e-12);
        assert!((widened.interval[1] - 0.9).abs() < 1e-12);
        assert_eq!(size.widened(100.0).interval, GRID_ENDS);
        assert!((size.distance(0.8) - 2.0).abs() < 1e-12);
    }
}
