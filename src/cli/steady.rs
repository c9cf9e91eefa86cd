//! What a run comes to: its steady loads, sinkage, slip and vibration.

use lugwheel::report::page::four_digits;
use lugwheel::trace::Trace;
use serde::Serialize;

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

/// What a run comes to, in the order in which it is told.
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

impl Quantity {
    /// Its value in the middle half of the run, in SI units; `None` where the run lacks it, and NaN for the slip
    /// of a wheel that stands all that time.
    pub fn of(&self, trace: &Trace) -> Option<f64> {
        match self.key {
            "acceleration_y_rms" => rms(trace.channel("acceleration_y")?.steady()),
            "slip_ratio" => {
                let channel = trace.channel("slip_ratio")?;
                Some(channel.steady_mean().unwrap_or(f64::NAN))
            }
            channel => trace.steady_mean(channel),
        }
    }

    /// A value in SI units as people read it, without its unit.
    pub fn shown(&self, value: f64) -> String {
        if value.is_nan() {
            return "undefined".to_owned();
        }
        let factor = if self.shown_unit == "mm" { 1.0e3 } else { 1.0 };
        four_digits(value * factor)
    }
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
}

impl Spread {
    /// The spread of the `values` [SI] that are there and defined; `None` where there is none.
    pub fn of(quantity: &Quantity, values: impl Iterator<Item = Option<f64>>) -> Option<Self> {
        let values: Vec<f64> = values.flatten().filter(|value| !value.is_nan()).collect();
        let min = values.iter().copied().reduce(f64::min)?;
        let max = values.iter().copied().reduce(f64::max)?;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(Self {
            mean,
            min,
            max,
            unit: quantity.unit,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rms_leaves_gaps_out_and_an_empty_channel_has_none() {
        assert_eq!(rms(&[3.0, f64::NAN, -3.0]), Some(3.0));
        assert_eq!(rms(&[f64::NAN]), None);
    }

    #[test]
    fn a_spread_has_mean_least_and_greatest_of_what_is_there() {
        let values = [Some(1.0), None, Some(2.0), Some(6.0)];
        let spread = Spread::of(&QUANTITIES[0], values.into_iter()).unwrap();
        assert_eq!((spread.mean, spread.min, spread.max), (3.0, 1.0, 6.0));
        assert_eq!(Spread::of(&QUANTITIES[0], [None].into_iter()), None);
    }
}
