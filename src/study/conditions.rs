//! What the runs of a condition have in common: means of their steady values, from `runs.csv`.

use super::runs::{BANDS, RunRow, STEADY, Tested};
use crate::statistics::{mean_and_variance, student_quantile};
use crate::table::four_digits;
use crate::trace::without_rounding;
use serde::Serialize;

/// A steady value of a run, as a reader wants it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// What it is.
    pub name: &'static str,
    /// Its unit as shown.
    pub unit: &'static str,
    value: Value,
    /// From the unit of the table to the one shown.
    factor: f64,
}

/// What of a run it is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    /// The mean of a channel, by its place in [`STEADY`].
    Mean(usize),
    /// The root mean square of the acceleration in a band, by its place in [`BANDS`].
    Rms(usize),
}

const fn quantity(name: &'static str, unit: &'static str, value: Value) -> Quantity {
    Quantity {
        name,
        unit,
        value,
        factor: 1.0,
    }
}

impl Quantity {
    /// A value of it as shown, 0 where it is below what a simulated mean resolves.
    pub fn without_rounding(&self, value: f64) -> f64 {
        let channel = match self.value {
            Value::Mean(place) => STEADY[place].0,
            Value::Rms(_) => "acceleration_y",
        };
        self.factor * without_rounding(channel, value / self.factor)
    }

    /// Its mean over the runs of a condition.
    fn mean(&self, rows: &[RunRow]) -> Option<Mean> {
        let of_run = |row: &RunRow| match self.value {
            Value::Mean(place) => row.steady[place][0].get(),
            Value::Rms(place) => row.bands[place][0].get(),
        };
        let values = rows.iter().filter_map(of_run);
        let values: Vec<f64> = values.map(|value| self.factor * value).collect();
        Mean::of(&values)
    }

    /// In how many runs of a condition it is not steady.
    fn unsteady(&self, rows: &[RunRow]) -> Option<Unsteady> {
        let Value::Mean(place) = self.value else {
            return None;
        };
        let tested = rows.iter().map(|row| &row.steadiness[place]);
        Unsteady::of(
            self,
            tested.map(|Tested { state, rate }| (state.as_str(), rate.get())),
        )
    }

    /// Unit of its rate of change as shown.
    pub fn unit_of_rate(&self) -> String {
        match self.unit {
            "-" => "1/s".to_owned(),
            unit => format!("{unit}/s"),
        }
    }
}

/// What is reported of every condition.
pub const QUANTITIES: [Quantity; 5 + BANDS.len()] = [
    quantity("drawbar pull", "N", Value::Mean(1)),
    quantity("load", "N", Value::Mean(0)),
    quantity("driving torque", "N m", Value::Mean(2)),
    Quantity {
        factor: 1.0e3,
        ..quantity("sinkage", "mm", Value::Mean(3))
    },
    quantity("slip", "-", Value::Mean(4)),
    quantity("acceleration 2 to 20 Hz, rms", "m/s²", Value::Rms(0)),
    quantity("20 to 200 Hz", "m/s²", Value::Rms(1)),
    quantity("200 to 800 Hz", "m/s²", Value::Rms(2)),
];

/// Place of the sinkage in [`QUANTITIES`].
pub const SINKAGE: usize = 3;

/// A condition and the means of its runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Condition {
    /// The scenario.
    pub scenario: String,
    /// Values of the swept keys, as TOML.
    pub values: Vec<String>,
    /// Runs that did not fail.
    pub runs: usize,
    /// Runs that failed.
    pub failed: usize,
    /// Every quantity, in the order of [`QUANTITIES`]; none where no run has it.
    pub means: [Option<Mean>; QUANTITIES.len()],
    /// How many runs are not known to be steady in a quantity, where there are any.
    pub unsteady: Vec<Unsteady>,
}

impl Condition {
    /// Whether the rim is above the surface in the mean, as the wheel stands on its lugs.
    pub fn is_on_lugs(&self) -> bool {
        self.means[SINKAGE].is_some_and(|mean| mean.value < 0.0)
    }
}

/// A quantity whose means are not all those of a steady state.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unsteady {
    /// Its name.
    pub quantity: &'static str,
    /// Runs in which it drifts.
    pub drifting: usize,
    /// Runs too short to show that it is steady.
    pub too_short: usize,
    /// Least and greatest rate at which it drifts, in `unit`; none where it drifts in no run.
    pub rates: Option<[f64; 2]>,
    /// Unit of the rates.
    pub unit: String,
}

/// The mean of some runs, in the unit of its [`Quantity`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Student's 95 % interval over the runs; none of one run.
    pub ci95: Option<[f64; 2]>,
}

impl Mean {
    /// `None` of nothing.
    pub fn of(values: &[f64]) -> Option<Self> {
        let n = values.len() as f64;
        if values.is_empty() {
            return None;
        }
        let [value, variance] = mean_and_variance(values);
        let half = student_quantile(0.975, n - 1.0) * libm::sqrt(variance / n);
        Some(Self {
            value,
            ci95: (n > 1.0).then_some([value - half, value + half]),
        })
    }
}

impl Unsteady {
    /// `None` where all `states` are steady; each with its rate of change in the unit of the table, where there is
    /// one.
    fn of<'a>(
        quantity: &Quantity,
        states: impl Iterator<Item = (&'a str, Option<f64>)>,
    ) -> Option<Self> {
        let mut unsteady = Self {
            quantity: quantity.name,
            drifting: 0,
            too_short: 0,
            rates: None,
            unit: quantity.unit_of_rate(),
        };
        for (state, rate) in states {
            match state {
                "drifting" => unsteady.drifting += 1,
                "too_short" => unsteady.too_short += 1,
                _ => {}
            }
            let rate = rate.map(|rate| quantity.factor * rate);
            unsteady.rates = together(unsteady.rates, rate.map(|rate| [rate, rate]));
        }
        (unsteady.drifting + unsteady.too_short > 0).then_some(unsteady)
    }

    /// Its rates of change in a few words, with their unit; none where it drifts in no run.
    pub fn range(&self) -> Option<String> {
        let [least, greatest] = self.rates?.map(four_digits);
        let range = if least == greatest {
            least
        } else {
            format!("{least} to {greatest}")
        };
        Some(format!("changes by {range} {}", self.unit))
    }

    /// What is not steady in all of some conditions, quantity by quantity.
    pub fn of_all(conditions: &[Condition]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for unsteady in conditions.iter().flat_map(|condition| &condition.unsteady) {
            let mut known = all.iter_mut();
            match known.find(|known| known.quantity == unsteady.quantity) {
                Some(known) => {
                    known.drifting += unsteady.drifting;
                    known.too_short += unsteady.too_short;
                    known.rates = together(known.rates, unsteady.rates);
                }
                None => all.push(unsteady.clone()),
            }
        }
        all
    }
}

/// The union of both ranges.
fn together(one: Option<[f64; 2]>, other: Option<[f64; 2]>) -> Option<[f64; 2]> {
    match (one, other) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (a, b) => a.or(b),
    }
}

/// The conditions in their order, from the table of the runs.
pub(super) fn of_runs(rows: &[RunRow]) -> Vec<Condition> {
    let of_one = rows.chunk_by(|a, b| a.condition == b.condition);
    let condition = |rows: &[RunRow]| {
        let sound = rows.iter().filter(|row| row.failure.is_empty()).count();
        Condition {
            scenario: rows[0].scenario.clone(),
            values: rows[0].values.clone(),
            runs: sound,
            failed: rows.len() - sound,
            means: QUANTITIES.map(|quantity| quantity.mean(rows)),
            unsteady: QUANTITIES
                .iter()
                .filter_map(|it| it.unsteady(rows))
                .collect(),
        }
    };
    of_one.map(condition).collect()
}

/// Those of the swept keys that have two values or more.
pub fn varied<'k>(keys: impl Iterator<Item = &'k str>, conditions: &[Condition]) -> Vec<&'k str> {
    let is_varied = |place: usize| {
        let mut values = conditions.iter().map(|condition| &condition.values[place]);
        let first = values.next();
        values.any(|value| Some(value) != first)
    };
    let keys = keys.enumerate().filter(|(place, _)| is_varied(*place));
    keys.map(|(_, key)| key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_steady_is_counted_over_conditions_with_its_range_of_rates() {
        let sinkage = &QUANTITIES[3];
        let unsteady =
            |states: &[(&'static str, Option<f64>)]| Unsteady::of(sinkage, states.iter().copied());
        assert_eq!(unsteady(&[("steady", None)]), None);
        let condition = |states| Condition {
            scenario: "sand".to_owned(),
            values: Vec::new(),
            runs: 2,
            failed: 0,
            means: [None; QUANTITIES.len()],
            unsteady: unsteady(states).into_iter().collect(),
        };
        let conditions = [
            condition(&[("drifting", Some(1.0e-4)), ("too_short", None)]),
            condition(&[("drifting", Some(-2.0e-4)), ("steady", None)]),
        ];
        let [all] = &Unsteady::of_all(&conditions)[..] else {
            panic!("of one quantity");
        };
        assert_eq!((all.drifting, all.too_short), (2, 1));
        // Reported in mm.
        assert_eq!((all.rates, all.unit.as_str()), (Some([-0.2, 0.1]), "mm/s"));
    }

    /// Standard deviation 1 and t(0.975, 4) = 2.776.
    #[test]
    fn a_mean_has_students_interval_and_one_value_has_none() {
        let values = [9.0, 11.0, 10.0, 9.0, 11.0];
        let Mean { value, ci95 } = Mean::of(&values).unwrap();
        let [low, high] = ci95.unwrap();
        assert_eq!(value, 10.0);
        assert!(
            (high - 10.0 - 2.776 / libm::sqrt(5.0)).abs() < 1e-3
                && (high + low - 20.0).abs() < 1e-9
        );
        let one = Mean::of(&[3.0]).unwrap();
        assert_eq!((one.value, one.ci95), (3.0, None));
        assert_eq!(Mean::of(&[]), None);
    }
}
