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
//!
//! The vibration of a loaded wheel depends on the law of contact, which is known least. Two programs that roll one
//! wheel over one hard plane (`tests/python/mujoco_rig.py`, no cause) agree in mean forces to 1 % of the load and differ in
//! third octaves of all channels by 5 to 7 dB from 3 to 50 Hz, 9 dB at 100 Hz, 12 dB at 200 Hz and 17 dB at 400 Hz,
//! root mean square; three programs on the same beds of gravel by up to 10 dB below 20 Hz and 16 dB above
//! (`output/reference/gravel_beds.txt`). There `δ` is multiplied by a factor for each kind of statistic.

use super::rigs::{Column, Table};
use crate::gap::{Cell, Domain, Margins, Statistic};
use crate::quantity::Seed;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeMap;

/// Factors on the margins in loaded conditions, from the root mean square differences of the two programs (one campaign of five
/// loaded conditions, all channels: `python3 tests/python/discrepancy.py DIAGNOSIS.json` of `nothing.h5`): amplitudes (standard
/// deviation, crest, orders and averages of lugs; 4.5 to 7.3 margins).
const AMPLITUDE: f64 = 7.0;
/// Distributions and pairs of channels (skewness, kurtosis, correlation, coherence; 8 to 14).
const SHAPE: f64 = 12.0;
/// Classes of windows and steps between samples (27 and 28).
const SWITCHED: f64 = 28.0;
/// Share of samples near the ends of the range (3.0).
const ENDS: f64 = 3.0;
/// Vibration features and apparent mass (0.9 to 1.6).
const FEATURE: f64 = 2.0;
/// Growth of the factor on third octaves with frequency [1/decade], from 1 at 10^(1/5) Hz = 1.6 Hz.
const PER_DECADE: f64 = 5.0;
/// Wheel orders from here on belong to the passing of lugs.
const OF_LUGS: u32 = 4;

/// How far each statistic of a layout may be moved.
#[derive(Debug)]
pub struct Discrepancy<'c> {
    columns: &'c [Column],
    /// Standard deviations, in the units of the statistics.
    scales: Vec<f64>,
}

impl<'c> Discrepancy<'c> {
    /// Of `factor` times the margins; `is_loaded` of every condition.
    pub fn of(columns: &'c [Column], factor: f64, is_loaded: &[bool]) -> Self {
        let margins = Margins::default();
        let scale = |column: &Column| {
            let margin = margins.of(&column.cell, column.size);
            let is_loaded = is_loaded.get(column.condition).is_some_and(|it| *it);
            let contact = if is_loaded {
                of_contact(&column.cell)
            } else {
                1.0
            };
            factor * margin * contact
        };
        Self {
            scales: columns.iter().map(scale).collect(),
            columns,
        }
    }

    /// By how much one rig moves each statistic.
    pub fn drawn(&self, rng: &mut ChaCha8Rng) -> Vec<f32> {
        let moved = self.scales.iter().zip(drawn(self.columns, rng));
        moved.map(|(scale, draw)| (scale * draw) as f32).collect()
    }
}

/// Moves the statistics of every rig by draws of the margins, `factor` times; `is_loaded` of every condition.
pub fn add(table: &mut Table, factor: f64, is_loaded: &[bool], seed: Seed) {
    let discrepancy = Discrepancy::of(&table.columns, factor, is_loaded);
    let mut moves: BTreeMap<u64, Vec<f32>> = BTreeMap::new();
    for row in &mut table.rows {
        let own = moves.entry(row.rig).or_insert_with(|| {
            let mut rng = seed.rng("diagnosis.discrepancy", row.rig);
            discrepancy.drawn(&mut rng)
        });
        for (value, by) in row.values.iter_mut().zip(own.iter()) {
            *value += by;
        }
    }
}

/// How many times the margin of a statistic of a loaded wheel is larger because of the law of contact.
fn of_contact(cell: &Cell) -> f64 {
    use Statistic as S;
    match cell.statistic {
        // Thirds are about 10^(n/10) Hz.
        S::Band(third) | S::Line(third) => (PER_DECADE * f64::from(third) / 10.0).max(1.0),
        S::OrderLevel(order) | S::OrderCosine(order) | S::OrderSine(order) if order < OF_LUGS => {
            1.0
        }
        S::OrderLevel(_) | S::OrderCosine(_) | S::OrderSine(_) => AMPLITUDE,
        S::Deviation | S::Crest | S::LugAverage | S::LugResidue => AMPLITUDE,
        S::Skewness | S::Kurtosis | S::Correlation | S::Coherence => SHAPE,
        S::Step | S::ClassShare(_) => SWITCHED,
        S::Rails => ENDS,
        S::Feature(_) | S::ApparentMass => FEATURE,
        _ => 1.0,
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
        add(&mut moved, 1.0, &[false], Seed(1));
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
        add(&mut still, 0.0, &[true], Seed(1));
        assert_eq!(still, table());
    }

    #[test]
    fn third_octaves_of_a_loaded_wheel_move_by_five_decibels_a_decade() {
        let third = |hertz: f64| Statistic::Band((10.0 * libm::log10(hertz)).round() as i16);
        let factor = |statistic| of_contact(&Cell::new("drawbar_pull", statistic));
        assert_eq!(factor(third(1.0)), 1.0);
        assert_eq!(factor(third(10.0)), 5.0);
        assert_eq!(factor(third(100.0)), 10.0);
        assert_eq!(factor(Statistic::SteadyMean), 1.0);
        assert_eq!(factor(Statistic::OrderSine(1)), 1.0);
        let mut moved = [table(), table()];
        add(&mut moved[0], 1.0, &[true], Seed(1));
        add(&mut moved[1], 1.0, &[false], Seed(1));
        // The table's thirds lie below 10 Hz: the last, of 7.9 Hz, moves 4.5 times as far.
        let of_last = moved.map(|table| table.rows[0].values[9]);
        assert!((of_last[0] / of_last[1] - 4.5).abs() < 1.0e-4);
    }
}
