//! Hierarchical false discovery rate control along the tree channel → domain → cell.
//!
//! A node's p-value is the Simes combination of its children's. Channels are tested by the Benjamini-Hochberg
//! procedure at level α; the domains of a rejected channel are tested at α times the fraction of channels
//! rejected, the cells of a rejected domain at that times the fraction of its siblings rejected. This
//! controls the average false discovery rate over the selected families.
//!
//! The q of a leaf is the largest adjusted p-value on its path from the root, so that it is below α exactly
//! if the leaf is rejected; elsewhere it orders the evidence.
//!
//! # References
//! Yekutieli (2008), J. Am. Stat. Assoc. 103:309-316 (trees); Benjamini and Bogomolov (2014), J.
//! R. Stat. Soc. B 76:297-318 (levels within selected families); Bogomolov et al. (2021),
//! Biometrika 108:575-590 (both together); Simes (1986), Biometrika 73:751-754.

/// A node's children, or the place of a leaf's p-value.
enum Node {
    Leaf(usize),
    Family(Vec<Node>),
}

/// A cell of the tree.
pub(super) struct Leaf<C, D> {
    /// Its channel.
    pub channel: C,
    /// Its domain.
    pub domain: D,
    /// Its p-value.
    pub p: f64,
}

/// q of every leaf.
pub(super) fn q_values<C: PartialEq, D: PartialEq>(leaves: &[Leaf<C, D>], level: f64) -> Vec<f64> {
    let outer = families((0..leaves.len()).collect(), |a, b| {
        leaves[a].channel == leaves[b].channel
    });
    let root = Node::Family(
        outer
            .into_iter()
            .map(|members| {
                let inner = families(members, |a, b| leaves[a].domain == leaves[b].domain);
                let domains = inner
                    .into_iter()
                    .map(|cells| Node::Family(cells.into_iter().map(Node::Leaf).collect()));
                Node::Family(domains.collect())
            })
            .collect(),
    );
    let p: Vec<f64> = leaves.iter().map(|leaf| leaf.p).collect();
    let mut q = vec![1.0; leaves.len()];
    descend(&root, &p, [1.0, 0.0], level, &mut q);
    q
}

/// Members that are alike, in order of their first.
fn families(members: Vec<usize>, alike: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut families: Vec<Vec<usize>> = Vec::new();
    for member in members {
        match families.iter_mut().find(|family| alike(family[0], member)) {
            Some(family) => family.push(member),
            None => families.push(vec![member]),
        }
    }
    families
}

/// Tests the children of a node; `penalty` is one over the share of selected siblings on the way,
/// `above` the largest adjusted p-value on it.
fn descend(node: &Node, p: &[f64], [penalty, above]: [f64; 2], level: f64, q: &mut [f64]) {
    let Node::Family(children) = node else {
        return;
    };
    let values: Vec<f64> = children.iter().map(|child| p_value(child, p)).collect();
    let adjusted: Vec<f64> = benjamini_hochberg(&values)
        .into_iter()
        .map(|value| (value * penalty).clamp(above, 1.0))
        .collect();
    let found = adjusted.iter().filter(|value| **value <= level).count();
    let share = children.len() as f64 / found.max(1) as f64;
    for (child, adjusted) in children.iter().zip(adjusted) {
        match child {
            Node::Leaf(place) => q[*place] = adjusted,
            family => descend(family, p, [penalty * share, adjusted], level, q),
        }
    }
}

fn p_value(node: &Node, p: &[f64]) -> f64 {
    match node {
        Node::Leaf(place) => p[*place],
        Node::Family(children) => {
            let values: Vec<f64> = children.iter().map(|child| p_value(child, p)).collect();
            simes(&values)
        }
    }
}

/// p-value of no effect anywhere among the hypotheses.
fn simes(p: &[f64]) -> f64 {
    let adjusted = benjamini_hochberg(p);
    adjusted.into_iter().fold(1.0, f64::min)
}

/// Adjusted p-values: the level at which each hypothesis is rejected.
pub(super) fn benjamini_hochberg(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*b].total_cmp(&p[*a]));
    let count = p.len() as f64;
    let (mut adjusted, mut least) = (vec![1.0; p.len()], 1.0_f64);
    for (behind, place) in order.into_iter().enumerate() {
        let rank = count - behind as f64;
        least = least.min(p[place] * count / rank);
        adjusted[place] = least;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn benjamini_and_hochberg_s_example_rejects_four_of_fifteen() {
        // Benjamini and Hochberg (1995), J. R. Stat. Soc. B 57:289-300, Section 4.1.
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262,
            0.5719, 0.6528, 0.7590, 1.0,
        ];
        let found = benjamini_hochberg(&p)
            .iter()
            .filter(|q| **q <= 0.05)
            .count();
        assert_eq!(found, 4);
    }

    #[test]
    fn one_strong_cell_is_found_and_its_quiet_neighbours_and_the_other_channels_are_not() {
        let mut leaves = Vec::new();
        for channel in 0..4 {
            for domain in 0..3 {
                for cell in 0..10 {
                    let p = 0.05 + 0.09 * f64::from(cell);
                    leaves.push(Leaf { channel, domain, p });
                }
            }
        }
        leaves[45].p = 1.0e-8;
        let q = q_values(&leaves, 0.05);
        assert!(q[45] < 1.0e-4, "{}", q[45]);
        let found = q.iter().filter(|q| **q <= 0.05).count();
        assert_eq!(found, 1);
    }

    #[test]
    fn a_family_selected_among_many_is_tested_at_a_level_divided_by_its_share() {
        // Of ten channels of one cell each only the first is found: ten times its p-value among the
        // channels, and within it a level divided by ten.
        let leaf = |channel| Leaf {
            channel,
            domain: 0,
            p: if channel == 0 { 1.0e-6 } else { 0.7 },
        };
        let leaves: Vec<_> = (0..10).map(leaf).collect();
        let q = q_values(&leaves, 0.05);
        assert!((q[0] / 1.0e-5 - 1.0).abs() < 1e-9, "{}", q[0]);
        assert!(q[1] > 0.6);
    }
}
