//! A second opinion: a random forest over what campaigns drawn from the emulator look like.
//!
//! Campaigns are drawn for every hypothesis, parameters and magnitudes from their priors, and told
//! by projected scores: how strongly each effect's signature shows in what recalibration leaves,
//! the parameters' estimates, and how much is left in each condition. Votes are shares of the
//! leaves, the sharpness of which is set by the campaigns that a tree has not seen.
//!
//! The trees are few lines of their own because those of linfa 0.8 vote by majority, know no
//! out-of-bag shares, and break ties in the order of a hash map, which differs from run to run.
//!
//! # References
//! Breiman (2001), Mach. Learn. 45:5-32; Pudlo et al. (2016), Bioinformatics 32:859-866 (choice
//! of models).

use super::fit::Problem;
use super::hypothesis::Hypothesis;
use super::product::{add, product, scaled};
use crate::quantity::Seed;
use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Campaigns drawn for a hypothesis.
const CAMPAIGNS: usize = 40;
const TREES: usize = 120;
const DEEPEST: usize = 14;
/// Campaigns in a leaf.
const LEAF: usize = 3;
/// Exponents of the votes tried.
const SHARPNESS: [f64; 9] = [0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0];
/// Votes that every hypothesis has beforehand [trees].
const BEFOREHAND: f64 = 0.5;

/// A trained forest.
#[derive(Debug)]
pub struct Forest {
    pub(super) hypotheses: Vec<Hypothesis>,
    view: View,
    trees: Vec<Tree>,
    sharpness: f64,
    /// Mean log probability [-] that campaigns unseen give their true cause, and the share of
    /// them whose cause comes first.
    pub out_of_bag: [f64; 2],
}

impl Forest {
    /// Trained for these conditions, repeats and spreads.
    pub fn train(problem: Problem, seed: Seed) -> Self {
        let view = View::new(problem);
        let candidates =
            (0..problem.emulator.candidates.len()).map(|e| Hypothesis::Effects(vec![e]));
        let known = [Hypothesis::None, Hypothesis::Parameter, Hypothesis::Unknown];
        let hypotheses: Vec<Hypothesis> = known.into_iter().chain(candidates).collect();
        let campaigns: Vec<(Vec<f64>, usize)> = (0..hypotheses.len() * CAMPAIGNS)
            .into_par_iter()
            .map(|number| {
                let mut rng = seed.rng("diagnosis.campaign", number as u64);
                let class = number % hypotheses.len();
                (view.of(&draw(problem, &hypotheses[class], &mut rng)), class)
            })
            .collect();
        let grown: Vec<(Tree, Vec<usize>)> = (0..TREES)
            .into_par_iter()
            .map(|number| {
                let mut rng = seed.rng("diagnosis.tree", number as u64);
                let bag: Vec<usize> = (0..campaigns.len())
                    .map(|_| rng.random_range(0..campaigns.len()))
                    .collect();
                let tree = Tree::grow(&campaigns, hypotheses.len(), bag.clone(), &mut rng);
                (tree, bag)
            })
            .collect();
        let votes = unseen(&campaigns, &grown, hypotheses.len());
        let scored = SHARPNESS.map(|sharpness| (score(&votes, &campaigns, sharpness), sharpness));
        let (out_of_bag, sharpness) = scored
            .into_iter()
            .max_by(|a, b| a.0[0].total_cmp(&b.0[0]))
            .expect("some sharpness");
        Self {
            trees: grown.into_iter().map(|(tree, _)| tree).collect(),
            hypotheses,
            view,
            sharpness,
            out_of_bag,
        }
    }

    /// Probability [-] of every hypothesis of one cause, all alike beforehand.
    pub(super) fn probabilities(&self, problem: Problem) -> Vec<f64> {
        let row = self.view.of(&problem.straightened());
        let mut votes = vec![0.0; self.hypotheses.len()];
        for tree in &self.trees {
            add(&mut votes, 1.0, tree.leaf(&row));
        }
        sharpened(&votes, self.sharpness)
    }
}

/// A campaign of this cause, as departures.
fn draw(problem: Problem, hypothesis: &Hypothesis, rng: &mut impl Rng) -> Vec<Vec<f64>> {
    let scales = hypothesis.scales(problem.emulator.parameters.len());
    let mut place = rng.random::<f64>();
    let scale = scales.iter().find(|scale| {
        place -= scale.probability;
        place < 0.0
    });
    let spreads = &scale.unwrap_or(&scales[0]).spreads;
    let normal = |rng: &mut _| -> f64 { StandardNormal.sample(rng) };
    let offsets: Vec<f64> = spreads.iter().map(|spread| spread * normal(rng)).collect();
    let candidates = &problem.emulator.candidates;
    let effects: Vec<(usize, f64)> = hypothesis
        .effects()
        .iter()
        .map(|&e| (e, candidates[e].strength(candidates[e].seat.draw(rng))))
        .collect();
    // Unknown: some cells of all conditions are off, by far or by little.
    let unknown = *hypothesis == Hypothesis::Unknown;
    let (share, size) = (
        0.02 + 0.3 * rng.random::<f64>(),
        3.0 + 17.0 * rng.random::<f64>(),
    );
    problem
        .conditions()
        .map(|(emulated, observed)| {
            let noise = emulated.scatter.drawn(observed.runs.len(), rng);
            let numbers = observed.variance.iter().zip(noise);
            let mut row: Vec<f64> = numbers
                .map(|(variance, noise)| {
                    let off = match unknown && rng.random::<f64>() < share {
                        true => size * normal(rng),
                        false => 0.0,
                    };
                    libm::sqrt(*variance) * (noise + off)
                })
                .collect();
            emulated.add_parameters(&offsets, &mut row);
            emulated.add_effects(&effects, &mut row);
            row
        })
        .collect()
}

/// What a tree sees of a campaign.
#[derive(Debug)]
struct View {
    /// By condition: precisions, weighted signatures of unit projected length, weighted `J`.
    conditions: Vec<Looks>,
    /// `(Jᵀ S⁻¹ J + I)⁻¹`, and the signatures' products with `J`.
    inverse: DMatrix<f64>,
    along: DMatrix<f64>,
}

#[derive(Debug)]
struct Looks {
    precision: Vec<f64>,
    jacobian: Vec<Vec<f64>>,
    weighted_jacobian: Vec<Vec<f64>>,
    signatures: Vec<Vec<f64>>,
}

impl View {
    fn new(problem: Problem) -> Self {
        let parameters = problem.emulator.parameters.len();
        let candidates = &problem.emulator.candidates;
        let projected = super::screen::Screen::new(problem).projected();
        let mut information = DMatrix::identity(parameters, parameters);
        let mut along = DMatrix::zeros(parameters, candidates.len());
        let mut conditions = Vec::new();
        for (emulated, observed) in problem.conditions() {
            let precision = emulated.scatter.precision(&observed.variance);
            let weighted: Vec<Vec<f64>> = emulated
                .jacobian
                .iter()
                .map(|column| scaled(column, &precision))
                .collect();
            let signatures: Vec<Vec<f64>> = candidates
                .iter()
                .enumerate()
                .map(|(number, candidate)| {
                    let mut signature = emulated.shapes[number].at(candidate.typical());
                    let length = projected.products[(number, number)].max(1.0e-12);
                    let factor = 1.0 / libm::sqrt(length);
                    for (value, precision) in signature.iter_mut().zip(&precision) {
                        *value *= factor * precision;
                    }
                    signature
                })
                .collect();
            for (i, weighted) in weighted.iter().enumerate() {
                for (j, column) in emulated.jacobian.iter().enumerate() {
                    information[(i, j)] += product(weighted, column);
                }
            }
            for (i, column) in emulated.jacobian.iter().enumerate() {
                for (j, signature) in signatures.iter().enumerate() {
                    along[(i, j)] += product(column, signature);
                }
            }
            conditions.push(Looks {
                precision,
                jacobian: emulated.jacobian.clone(),
                weighted_jacobian: weighted,
                signatures,
            });
        }
        let inverse = Cholesky::new(information).map(|c| c.inverse());
        Self {
            conditions,
            inverse: inverse.unwrap_or_else(|| DMatrix::zeros(parameters, parameters)),
            along,
        }
    }

    fn of(&self, residuals: &[Vec<f64>]) -> Vec<f64> {
        let mut scores = DVector::zeros(self.along.ncols());
        let mut projections = DVector::zeros(self.inverse.nrows());
        for (looks, residual) in self.conditions.iter().zip(residuals) {
            for (sum, signature) in scores.iter_mut().zip(&looks.signatures) {
                *sum += product(signature, residual);
            }
            for (sum, column) in projections.iter_mut().zip(&looks.weighted_jacobian) {
                *sum += product(column, residual);
            }
        }
        let offsets = &self.inverse * projections;
        scores -= self.along.transpose() * &offsets;
        let largest = scores.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let shares: Vec<f64> = scores
            .iter()
            .map(|score| score / largest.max(3.0))
            .collect();
        let mut row: Vec<f64> = scores.iter().copied().collect();
        row.extend(shares);
        row.push(largest);
        row.extend(offsets.iter());
        let (mut total, mut most, mut raw) = (0.0, 0.0_f64, 0.0);
        for (looks, residual) in self.conditions.iter().zip(residuals) {
            let weighted = scaled(residual, &looks.precision);
            raw += product(&weighted, residual);
            let mut left = residual.clone();
            for (column, offset) in looks.jacobian.iter().zip(offsets.iter()) {
                add(&mut left, -offset, column);
            }
            let squares = left.iter().zip(&looks.precision).map(|(r, p)| r * r * p);
            most = squares.clone().fold(most, f64::max);
            let square: f64 = squares.sum();
            row.push(libm::log(square / residual.len() as f64));
            total += square;
        }
        row.push(libm::log(total));
        row.push(libm::log(raw));
        row.push(libm::log(most));
        // What the strongest effect leaves.
        row.push(libm::log((total - largest * largest).max(1.0)));
        row
    }
}

/// A tree of splits.
#[derive(Debug)]
enum Tree {
    Leaf(Vec<f64>),
    Split {
        feature: usize,
        at: f64,
        below: Box<Tree>,
        above: Box<Tree>,
    },
}

impl Tree {
    fn grow(
        campaigns: &[(Vec<f64>, usize)],
        classes: usize,
        bag: Vec<usize>,
        rng: &mut impl Rng,
    ) -> Self {
        Self::node(campaigns, classes, bag, DEEPEST, rng)
    }

    fn node(
        campaigns: &[(Vec<f64>, usize)],
        classes: usize,
        bag: Vec<usize>,
        depth: usize,
        rng: &mut impl Rng,
    ) -> Self {
        let mut counts = vec![0.0; classes];
        for &number in &bag {
            counts[campaigns[number].1] += 1.0;
        }
        let pure = counts.iter().filter(|count| **count > 0.0).count() < 2;
        let split = match pure || depth == 0 || bag.len() < 2 * LEAF {
            true => None,
            false => best_split(campaigns, &bag, &counts, rng),
        };
        let Some((feature, at)) = split else {
            let total = bag.len() as f64;
            return Self::Leaf(counts.iter().map(|count| count / total).collect());
        };
        let (below, above): (Vec<usize>, Vec<usize>) = bag
            .into_iter()
            .partition(|&number| campaigns[number].0[feature] <= at);
        let mut child = |bag| Box::new(Self::node(campaigns, classes, bag, depth - 1, rng));
        Self::Split {
            feature,
            at,
            below: child(below),
            above: child(above),
        }
    }

    fn leaf(&self, row: &[f64]) -> &[f64] {
        match self {
            Self::Leaf(shares) => shares,
            Self::Split {
                feature,
                at,
                below,
                above,
            } => if row[*feature] <= *at { below } else { above }.leaf(row),
        }
    }
}

/// The split of least Gini impurity among a few features drawn, if one leaves enough on each side.
fn best_split(
    campaigns: &[(Vec<f64>, usize)],
    bag: &[usize],
    counts: &[f64],
    rng: &mut impl Rng,
) -> Option<(usize, f64)> {
    let features = campaigns[0].0.len();
    let tried = 2 * (features as f64).sqrt().ceil() as usize;
    let mut best: Option<(f64, usize, f64)> = None;
    for _ in 0..tried {
        let feature = rng.random_range(0..features);
        let mut order: Vec<(f64, usize)> = bag
            .iter()
            .map(|&number| (campaigns[number].0[feature], campaigns[number].1))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut above = counts.to_vec();
        let mut below = vec![0.0; counts.len()];
        let mut squares_above: f64 = above.iter().map(|count| count * count).sum();
        let mut squares_below = 0.0;
        for (place, pair) in order.windows(2).enumerate() {
            let class = pair[0].1;
            squares_above += 1.0 - 2.0 * above[class];
            squares_below += 1.0 + 2.0 * below[class];
            above[class] -= 1.0;
            below[class] += 1.0;
            let (left, right) = (place + 1, order.len() - place - 1);
            if pair[0].0 >= pair[1].0 || left < LEAF || right < LEAF {
                continue;
            }
            let purity = squares_below / left as f64 + squares_above / right as f64;
            if best.is_none_or(|(most, ..)| purity > most) {
                best = Some((purity, feature, 0.5 * (pair[0].0 + pair[1].0)));
            }
        }
    }
    best.map(|(_, feature, at)| (feature, at))
}

/// Votes on every campaign by the trees that have not seen it.
fn unseen(
    campaigns: &[(Vec<f64>, usize)],
    grown: &[(Tree, Vec<usize>)],
    classes: usize,
) -> Vec<Vec<f64>> {
    let mut votes = vec![vec![0.0; classes]; campaigns.len()];
    for (tree, bag) in grown {
        let mut seen = vec![false; campaigns.len()];
        for &number in bag {
            seen[number] = true;
        }
        for (number, (row, _)) in campaigns.iter().enumerate() {
            if !seen[number] {
                add(&mut votes[number], 1.0, tree.leaf(row));
            }
        }
    }
    votes
}

/// Votes as probabilities.
fn sharpened(votes: &[f64], sharpness: f64) -> Vec<f64> {
    let raised = votes
        .iter()
        .map(|vote| libm::pow(vote + BEFOREHAND / votes.len() as f64, sharpness));
    let raised: Vec<f64> = raised.collect();
    let sum: f64 = raised.iter().sum();
    raised.iter().map(|vote| vote / sum).collect()
}

/// Mean log probability of the true class, and the share of campaigns where it comes first.
fn score(votes: &[Vec<f64>], campaigns: &[(Vec<f64>, usize)], sharpness: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (votes, (_, class)) in votes.iter().zip(campaigns) {
        let probabilities = sharpened(votes, sharpness);
        sums[0] += libm::log(probabilities[*class]);
        let first = probabilities.iter().all(|p| *p <= probabilities[*class]);
        sums[1] += f64::from(first);
    }
    sums.map(|sum| sum / campaigns.len() as f64)
}
