//! Extremely randomised trees over standardised statistics.
//!
//! Geurts, Ernst and Wehenkel (2006), Mach. Learn. 63:3-42: at each node the best of some random cuts of random statistics,
//! by the weighted Gini impurity, until a leaf holds one class. Each tree is grown on a bootstrap sample of rigs, so that
//! rows of one rig are all in it or all out of it, and votes on the rows of the rigs left out are those of rigs never seen.
//! The trees know nothing of laws and sizes: where an effect follows another law they err less than the emulator does.

use crate::quantity::Seed;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Trees.
const TREES: usize = 300;
/// Share [-] of the statistics that are tried at a node.
const TRIED: f64 = 0.04;
/// How many statistics are drawn for one that varies, at most.
const DRAWS: usize = 4;

/// A node: a cut, or a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Node {
    Cut {
        column: u32,
        at: f32,
        /// Where the node above the cut stands; that below it follows its parent.
        above: u32,
    },
    Leaf {
        class: u32,
    },
}

/// A grown forest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trees {
    classes: usize,
    trees: Vec<Vec<Node>>,
}

/// What trees are grown on.
pub struct Sample<'a> {
    /// Standardised statistics, column by column.
    pub columns: Vec<Vec<f32>>,
    /// Class of each row.
    pub classes: Vec<usize>,
    /// Weight of each class.
    pub weights: Vec<f64>,
    /// Rig of each row.
    pub rigs: &'a [u64],
}

/// A tree, and the classes that it gives the rows it did not see.
struct Grown {
    nodes: Vec<Node>,
    votes: Vec<(usize, usize)>,
}

/// Shares of votes.
pub type Votes = Vec<f64>;

impl Trees {
    /// Grows trees; also the votes on each row by trees that did not see its rig.
    pub fn grow(sample: &Sample, seed: Seed) -> (Self, Vec<Votes>) {
        let mut rigs: Vec<u64> = sample.rigs.to_vec();
        rigs.sort_unstable();
        rigs.dedup();
        let grown: Vec<Grown> = (0..TREES)
            .into_par_iter()
            .map(|number| {
                let mut rng = seed.rng("diagnosis.tree", number as u64);
                let mut counts = vec![0_u32; rigs.len()];
                (0..rigs.len()).for_each(|_| counts[rng.random_range(0..rigs.len())] += 1);
                let count = |row: usize| {
                    let place = rigs.binary_search(&sample.rigs[row]);
                    place.map_or(0, |place| counts[place])
                };
                let rows = 0..sample.classes.len();
                let (inside, outside): (Vec<usize>, Vec<usize>) =
                    rows.partition(|row| count(*row) > 0);
                let mut growth = Growth {
                    sample,
                    weights: (0..sample.classes.len())
                        .map(|row| f64::from(count(row)) * sample.weights[sample.classes[row]])
                        .collect(),
                    nodes: Vec::new(),
                    rng,
                };
                growth.grow(inside);
                let nodes = &growth.nodes;
                let votes = outside.into_iter().map(|row| {
                    let class = leaf(nodes, |column| sample.columns[column][row]);
                    (row, class)
                });
                Grown {
                    votes: votes.collect(),
                    nodes: growth.nodes,
                }
            })
            .collect();
        let classes = sample.weights.len();
        let mut votes = vec![vec![0.0; classes]; sample.classes.len()];
        let mut trees = Vec::new();
        for tree in grown {
            for (row, class) in tree.votes {
                votes[row][class] += 1.0;
            }
            trees.push(tree.nodes);
        }
        votes.iter_mut().for_each(|votes| normalise(votes));
        (Self { classes, trees }, votes)
    }

    /// Votes on a row.
    pub fn votes(&self, row: &[f64]) -> Votes {
        let mut votes = vec![0.0; self.classes];
        for nodes in &self.trees {
            votes[leaf(nodes, |column| row[column] as f32)] += 1.0;
        }
        normalise(&mut votes);
        votes
    }
}

fn normalise(votes: &mut [f64]) {
    let total: f64 = votes.iter().sum();
    if total > 0.0 {
        votes.iter_mut().for_each(|votes| *votes /= total);
    }
}

fn leaf(nodes: &[Node], value: impl Fn(usize) -> f32) -> usize {
    let mut place = 0;
    loop {
        match nodes[place] {
            Node::Leaf { class } => return class as usize,
            Node::Cut { column, at, above } => {
                place = if value(column as usize) > at {
                    above as usize
                } else {
                    place + 1
                };
            }
        }
    }
}

struct Growth<'a> {
    sample: &'a Sample<'a>,
    weights: Vec<f64>,
    nodes: Vec<Node>,
    rng: ChaCha8Rng,
}

struct Cut {
    column: usize,
    at: f32,
}

impl Growth<'_> {
    fn grow(&mut self, rows: Vec<usize>) {
        let place = self.nodes.len();
        let Some(Cut { column, at }) = self.cut(&rows) else {
            let class = self.heaviest(&rows) as u32;
            self.nodes.push(Node::Leaf { class });
            return;
        };
        self.nodes.push(Node::Leaf { class: 0 });
        let values = &self.sample.columns[column];
        let (above, below): (Vec<usize>, Vec<usize>) =
            rows.into_iter().partition(|row| values[*row] > at);
        self.grow(below);
        self.nodes[place] = Node::Cut {
            column: column as u32,
            at,
            above: self.nodes.len() as u32,
        };
        self.grow(above);
    }

    fn weight_by_class(&self, rows: &[usize]) -> Vec<f64> {
        let mut sums = vec![0.0; self.sample.weights.len()];
        for row in rows {
            sums[self.sample.classes[*row]] += self.weights[*row];
        }
        sums
    }

    fn heaviest(&self, rows: &[usize]) -> usize {
        let sums = self.weight_by_class(rows);
        let classes = 0..sums.len();
        classes
            .max_by(|a, b| sums[*a].total_cmp(&sums[*b]).then(b.cmp(a)))
            .unwrap_or(0)
    }

    /// The best of some random cuts; none of one class, or where nothing varies.
    fn cut(&mut self, rows: &[usize]) -> Option<Cut> {
        let first = self.sample.classes[*rows.first()?];
        if rows.iter().all(|row| self.sample.classes[*row] == first) {
            return None;
        }
        let whole = self.weight_by_class(rows);
        let total: f64 = whole.iter().sum();
        let count = self.sample.columns.len();
        let tried = ((TRIED * count as f64) as usize).max(1);
        let mut best: Option<(f64, Cut)> = None;
        let mut found = 0;
        for _ in 0..DRAWS * tried {
            if found == tried {
                break;
            }
            let column = self.rng.random_range(0..count);
            let values = &self.sample.columns[column];
            let ends = [f32::INFINITY, f32::NEG_INFINITY];
            let [least, largest] = rows.iter().fold(ends, |[least, largest], row| {
                [least.min(values[*row]), largest.max(values[*row])]
            });
            if least >= largest {
                continue;
            }
            found += 1;
            let at = between([least, largest], &mut self.rng);
            let mut above = vec![0.0; whole.len()];
            for row in rows {
                if values[*row] > at {
                    above[self.sample.classes[*row]] += self.weights[*row];
                }
            }
            let purity = purity(&whole, &above, total);
            if best.as_ref().is_none_or(|(other, _)| purity > *other) {
                best = Some((purity, Cut { column, at }));
            }
        }
        best.map(|(_, cut)| cut)
    }
}

/// A cut that leaves both ends on their sides.
fn between([least, largest]: [f32; 2], rng: &mut impl Rng) -> f32 {
    let at = least + (largest - least) * rng.random::<f32>();
    if at < largest { at } else { least }
}

/// Sum over both sides of squared class weights over the side's weight: the larger, the purer.
fn purity(whole: &[f64], above: &[f64], total: f64) -> f64 {
    let (mut squares, mut weight) = ([0.0; 2], 0.0);
    for (whole, above) in whole.iter().zip(above) {
        let below = whole - above;
        squares[0] += above * above;
        squares[1] += below * below;
        weight += above;
    }
    let side = |square: f64, weight: f64| if weight > 0.0 { square / weight } else { 0.0 };
    side(squares[0], weight) + side(squares[1], total - weight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    /// Two rows a rig; a class is where one of three columns is two deviations off.
    fn sample(rigs: usize) -> (Vec<Vec<f32>>, Vec<usize>, Vec<u64>) {
        let mut rng = Seed(2).rng("sample", 0);
        let mut columns = vec![Vec::new(); 12];
        let (mut classes, mut of) = (Vec::new(), Vec::new());
        for rig in 0..rigs {
            for row in 0..2 {
                let class = (rig + row) % 3;
                for (place, column) in columns.iter_mut().enumerate() {
                    let drawn: f32 = StandardNormal.sample(&mut rng);
                    column.push(drawn + if place == class { 4.0 } else { 0.0 });
                }
                classes.push(class);
                of.push(rig as u64);
            }
        }
        (columns, classes, of)
    }

    #[test]
    fn trees_know_rows_that_they_have_not_seen_and_are_the_same_again() {
        let (columns, classes, rigs) = sample(90);
        let sample = Sample {
            columns,
            classes,
            weights: vec![1.0; 3],
            rigs: &rigs,
        };
        let (trees, votes) = Trees::grow(&sample, Seed(1));
        let right = votes.iter().zip(&sample.classes).filter(|(votes, class)| {
            let own = votes[**class];
            votes.iter().all(|other| *other <= own)
        });
        assert!(right.count() > 160);
        assert_eq!(Trees::grow(&sample, Seed(1)).0, trees);
        let mut row = vec![0.0; 12];
        row[1] = 4.0;
        let votes = trees.votes(&row);
        assert!(votes[1] > 0.6, "{votes:?}");
        assert!((votes.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
