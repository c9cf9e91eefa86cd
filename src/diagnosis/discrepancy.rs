//! What separates every simulator from every rig.
//!
//! No rig is the simulator plus noise: contact laws, motors and sensors differ a little everywhere, and a model that has
//! learned from the simulator alone takes each such difference for a cause. Therefore the statistics of every random rig may
//! be moved before anything is learned from them,
//!
//! ```text
//! x' = x + k δ (a + c + b) / √3
//! ```
//!
//! by the margin `δ` up to which two sides count as equivalent ([`Margins`]: 5 % of a mean, 1 dB, 0.1), `k` times. `a`, `c` and
//! `b` are standard normal: `a` is common to a channel's domain in all conditions, `c` to it in one condition, `b` is the
//! statistic's own. What a simulator has wrong is smooth: neighbouring third octaves move together. All measurements of a
//! rig are moved alike. This is the additive discrepancy of Kennedy and O'Hagan (2001, J. R. Stat. Soc. B 63:425-464), with
//! margins for its size, as no rig's repeats show it.

use super::rigs::{Column, Table};
use crate::gap::{Domain, Margins};
use crate::quantity::Seed;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;

/// Moves the statistics of every rig by draws of `margins`, `factor` times.
pub fn add(table: &mut Table, factor: f64, seed: Seed) {
    let margins = Margins::default();
    let mut moves: BTreeMap<u64, Vec<f32>> = BTreeMap::new();
    for row in &mut table.rows {
        let own = moves.entry(row.rig).or_insert_with(|| {
            let mut rng = seed.rng("diagnosis.discrepancy", row.rig);
            let draws = drawn(&table.columns, &mut rng);
            let columns = table.columns.iter().zip(draws);
            let moved = columns.map(|(column, draw)| {
                let margin = margins.of(&column.cell, column.size);
                (factor * margin * draw) as f32
            });
            moved.collect()
        });
        for (value, by) in row.values.iter_mut().zip(own.iter()) {
            *value += by;
        }
    }
}

/// `(a + c + b) / √3` of every column.
fn drawn(columns: &[Column], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut of_domain: BTreeMap<(&str, Domain), f64> = BTreeMap::new();
    let mut of_condition: BTreeMap<(&str, Domain, usize), f64> = BTreeMap::new();
    let draws = columns.iter().map(|column| {
        let (channel, domain) = (&*column.cell.channel, column.cell.domain());
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let own = normal();
        let a = *of_domain
            .entry((channel, domain))
            .or_insert_with(&mut normal);
        let key = (channel, domain, column.condition);
        let c = *of_condition.entry(key).or_insert_with(normal);
        (a + c + own) / libm::sqrt(3.0)
    });
    draws.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::rigs::Row;
    use crate::gap::{Cell, Statistic};

    /// Ten third octaves of one channel, in rigs of two rows each.
    fn table() -> Table {
        let columns = (0..10).map(|band| Column {
            condition: 0,
            cell: Cell::new("acceleration_y", Statistic::Band(band)),
            size: 1.0,
        });
        let row = |rig| Row {
            rig,
            parameters: Vec::new(),
            effects: Vec::new(),
            randomised: false,
            values: vec![0.0; 10],
        };
        Table {
            columns: columns.collect(),
            rows: (0..400).map(|number| row(number / 2)).collect(),
        }
    }

    #[test]
    fn levels_move_by_a_decibel_two_thirds_of_it_together_and_alike_in_all_rows_of_a_rig() {
        let mut moved = table();
        add(&mut moved, 1.0, Seed(1));
        assert!(
            moved
                .rows
                .chunks(2)
                .all(|rows| rows[0].values == rows[1].values)
        );
        let rigs: Vec<&[f32]> = moved
            .rows
            .chunks(2)
            .map(|rows| &rows[0].values[..])
            .collect();
        let product = |i: usize, j: usize| {
            let products = rigs.iter().map(|rig| f64::from(rig[i] * rig[j]));
            products.sum::<f64>() / rigs.len() as f64
        };
        // Standard errors of some 0.1.
        assert!((product(0, 0) - 1.0).abs() < 0.3);
        assert!((product(0, 7) - 2.0 / 3.0).abs() < 0.3);
        let mut still = table();
        add(&mut still, 0.0, Seed(1));
        assert_eq!(still, table());
    }
}
