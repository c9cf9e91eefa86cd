//! What a run comes to: its steady loads, sinkage, slip and vibration.

use crate::table::four_digits;
use crate::trace::steadiness::Steadiness;
use crate::trace::{Trace, without_rounding};
use serde::{Deserialize, Deserializer, Serialize};

/// A number that a run comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    /// Its name for machines: the channel's, or with what is made of it.
    pub key: &'static str,
    /// Its unit for machines.
    pub unit: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// Its unit for people.
    pub shown_unit: &'static str,
}

/// What a run comes to, in the order of the output.
pub const QUANTITIES: [Quantity; 6] = [
    quantity("normal_force", "N", "normal force", "N"),
    quantity("drawbar_pull", "N", "drawbar pull", "N"),
    quantity("driving_torque", "N m", "driving torque", "N·m"),
    quantity("sinkage", "m", "sinkage of the rim", "mm"),
    quantity("slip_ratio", "1", "slip ratio", "-"),
    quantity(
        "acceleration_y_rms",
        "m/s^2",
        "vertical acceleration, rms",
        "m/s²",
    ),
];

const fn quantity(
    key: &'static str,
    unit: &'static str,
    name: &'static str,
    shown_unit: &'static str,
) -> Quantity {
    Quantity {
        key,
        unit,
        name,
        shown_unit,
    }
}

/// A quantity in the middle half of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Its value in SI units; NaN for the slip of a wheel at rest, which JSON has as null.
    #[serde(deserialize_with = "number_or_null")]
    pub value: f64,
    /// Whether it is a steady value; none of a mean without a time series.
    pub steadiness: Option<Steadiness>,
}

/// A number; NaN for null.
fn number_or_null<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

impl Quantity {
    /// Its value in the middle half of the run; `None` where the run lacks it.
    pub fn of(&self, trace: &Trace) -> Option<Reading> {
        match self.key {
            "acceleration_y_rms" => vibration(trace),
            "slip_ratio" => {
                let channel = trace.channel("slip_ratio")?;
                Some(Reading {
                    value: channel.steady_mean().unwrap_or(f64::NAN),
                    steadiness: trace.steadiness("slip_ratio"),
                })
            }
            channel => Some(Reading {
                value: trace.steady_mean(channel)?,
                steadiness: trace.steadiness(channel),
            }),
        }
    }

    /// Whether a value is a steady one, as people read it; nothing where it is.
    pub fn remark(&self, steadiness: Option<Steadiness>) -> String {
        match steadiness {
            Some(Steadiness::Drifting { rate }) => {
                let way = if rate < 0.0 { "falls" } else { "rises" };
                let (rate, unit) = (self.shown(rate.abs()), self.shown_unit);
                let unit = if unit == "-" { "" } else { unit };
                format!("not steady yet: {way} by {rate} {}", per_second(unit))
            }
            Some(Steadiness::TooShort) => "too short to show that it is steady".to_owned(),
            Some(Steadiness::Steady) | None => String::new(),
        }
    }

    /// What a value means beyond its name; nothing where the name says all.
    pub fn meaning(&self, value: f64) -> &'static str {
        if self.key == "sinkage" && value < 0.0 {
            "the rim is above the surface: the wheel stands on its lugs, or is lifted"
        } else {
            ""
        }
    }

    /// A value in SI units as people read it, without its unit.
    pub fn shown(&self, value: f64) -> String {
        if value.is_nan() {
            return "undefined".to_owned();
        }
        let factor = if self.shown_unit == "mm" { 1.0e3 } else { 1.0 };
        four_digits(factor * without_rounding(self.key, value))
    }
}

fn per_second(unit: &str) -> String {
    match unit {
        "" => "per second".to_owned(),
        "m/s²" => "m/s³".to_owned(),
        unit => format!("{unit}/s"),
    }
}

/// Root mean square of the vertical acceleration, whose mean square is to be steady.
fn vibration(trace: &Trace) -> Option<Reading> {
    let channel = trace.channel("acceleration_y")?;
    let value = rms(channel.steady())?;
    Some(Reading {
        value,
        steadiness: Some(match trace.steadiness_of_square(channel) {
            // Of a square by that of its root.
            Steadiness::Drifting { rate } => Steadiness::Drifting {
                rate: rate / (2.0 * value),
            },
            other => other,
        }),
    })
}

/// Root mean square of the numbers among `samples`.
fn rms(samples: &[f64]) -> Option<f64> {
    let finite = || samples.iter().filter(|sample| sample.is_finite());
    let count = finite().count();
    let sum: f64 = finite().map(|sample| sample * sample).sum();
    (count > 0).then(|| libm::sqrt(sum / count as f64))
}

/// A quantity over several runs, in SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean of the runs.
    pub mean: f64,
    /// Least of the runs.
    pub min: f64,
    /// Greatest of the runs.
    pub max: f64,
    /// Unit.
    pub unit: &'static str,
    /// Runs in which it still drifts.
    pub drifting: usize,
    /// Runs too short to show that it is steady.
    pub too_short: usize,
}

impl Spread {
    /// In how many of `runs` it is no steady value, as people read it; nothing where it is in all.
    pub fn remark(&self, runs: usize) -> String {
        let mut remarks = Vec::new();
        if self.drifting > 0 {
            remarks.push(format!("not steady in {} of {runs}", self.drifting));
        }
        if self.too_short > 0 {
            remarks.push(format!("too short to show it in {}", self.too_short));
        }
        remarks.join(", ")
    }

    /// The spread of the `readings` that are there and defined; `None` where there is none.
    pub fn of(
        quantity: &Quantity,
        readings: impl Iterator<Item = Option<Reading>>,
    ) -> Option<Self> {
        let readings = readings.flatten().filter(|reading| !reading.value.is_nan());
        let readings: Vec<Reading> = readings.collect();
        let values: Vec<f64> = readings.iter().map(|reading| reading.value).collect();
        let states = || readings.iter().filter_map(|reading| reading.steadiness);
        let min = values.iter().copied().reduce(f64::min)?;
        let max = values.iter().copied().reduce(f64::max)?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(Self {
            mean,
            min,
            max,
            unit: quantity.unit,
            drifting: states().filter(|state| state.rate().is_some()).count(),
            too_short: states()
                .filter(|state| *state == Steadiness::TooShort)
                .count(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drift_is_written_with_its_way_and_unit() {
        let remark =
            |index: usize, rate| QUANTITIES[index].remark(Some(Steadiness::Drifting { rate }));
        assert_eq!(remark(1, 3.0), "not steady yet: rises by 3.000 N/s");
        assert_eq!(remark(3, -0.002), "not steady yet: falls by 2.000 mm/s");
        assert_eq!(
            remark(4, 0.02),
            "not steady yet: rises by 0.02000 per second"
        );
        assert_eq!(QUANTITIES[1].remark(Some(Steadiness::Steady)), "");
    }

    #[test]
    fn the_slip_of_a_wheel_at_rest_comes_back_from_json() {
        let at_rest = Reading {
            value: f64::NAN,
            steadiness: None,
        };
        let json = serde_json::to_string(&at_rest).unwrap();
        let read: Reading = serde_json::from_str(&json).unwrap();
        assert!(read.value.is_nan());
    }

    #[test]
    fn rms_leaves_gaps_out_and_an_empty_channel_has_none() {
        assert_eq!(rms(&[3.0, f64::NAN, -3.0]), Some(3.0));
        assert_eq!(rms(&[f64::NAN]), None);
    }

    #[test]
    fn a_spread_has_mean_least_and_greatest_of_what_is_there() {
        let values = [Some(1.0), None, Some(2.0), Some(6.0), Some(f64::NAN)];
        let drifts = |value| (value == 6.0).then_some(Steadiness::Drifting { rate: 1.0 });
        let readings = values.map(|value| {
            value.map(|value| Reading {
                value,
                steadiness: drifts(value),
            })
        });
        let spread = Spread::of(&QUANTITIES[0], readings.into_iter()).unwrap();
        assert_eq!((spread.mean, spread.min, spread.max), (3.0, 1.0, 6.0));
        assert_eq!(spread.remark(4), "not steady in 1 of 4");
        assert_eq!(Spread::of(&QUANTITIES[0], [None].into_iter()), None);
    }
}
