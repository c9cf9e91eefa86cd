//! Frequency of the vibration over that of the lug pass (Eq. 51), two ways.
//!
//! Windows hold between one and some sixteen lug passes, and the paper's limits are 15 % apart
//! from 1: no spectrum resolves that. Contact events can be counted, and their intervals averaged,
//! in a window of any length; this is what (51) is, `κ_f = 1 / mean C_f`, where `C_f` is the
//! interval between two contacts in lug angles. Both ways work on wheel angle instead of time, so
//! that a changing speed does not smear the count.

use super::record::{Record, Unusable};
use super::spectrum::gaussian_gain;
use std::f64::consts::{LN_2, PI, TAU};
use std::ops::Range;

/// Steps of the wheel angle per lug pass.
const STEPS: usize = 32;

/// Corner of the low-pass before events are counted, in lug orders [-]: an impact becomes one lobe,
/// and two impacts a third of a lug angle apart stay two.
const CORNER: f64 = 2.5;

/// The change of vertical velocity [m/s] in equal steps of wheel angle.
pub struct VelocityIncrements {
    increments: Vec<f64>,
    /// Lug passes in the window [-].
    passes: f64,
}

impl VelocityIncrements {
    /// Those of a window of the measured acceleration, its mean taken off.
    ///
    /// # Errors
    /// `FewLugPasses` where the wheel turns by less than one lug pass.
    pub fn of(record: &Record, window: Range<usize>) -> Result<Self, Unusable> {
        Self::from_samples(&record.acceleration[window.clone()], record, window)
    }

    /// Those of `samples` [m/s²] while the wheel turned as in `window`.
    pub(super) fn from_samples(
        samples: &[f64],
        record: &Record,
        window: Range<usize>,
    ) -> Result<Self, Unusable> {
        let passes = record.lug_passes(&window);
        if passes < 1.0 {
            return Err(Unusable::FewLugPasses {
                passes,
                needed: 1.0,
            });
        }
        let angle = &record.angle[window];
        let direction = (angle[angle.len() - 1] - angle[0]).signum();
        let steps_per_rad = direction * STEPS as f64 / record.lug_angle;
        let count = (passes * STEPS as f64) as usize;
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let (first, period) = (angle[0], 1.0 / record.sample_rate);
        let mut increments = vec![0.0; count];
        for (sample, at) in samples.iter().zip(angle) {
            let step = ((at - first) * steps_per_rad).max(0.0) as usize;
            increments[step.min(count - 1)] += (sample - mean) * period;
        }
        Ok(Self { increments, passes })
    }

    /// Smoothed by a Gaussian low-pass at `corner` [lug orders], mirrored at its ends.
    fn smoothed(&self, corner: f64) -> Vec<f64> {
        let reach = (STEPS as f64 / corner).ceil() as i64;
        let weight =
            |offset: i64| gaussian_gain(2.0 * PI * corner * offset as f64 / STEPS as f64 / LN_2);
        let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
        let total: f64 = weights.iter().sum();
        let last = self.increments.len() as i64 - 1;
        let mirrored = |place: i64| {
            let inside = if place < 0 {
                -place
            } else if place > last {
                2 * last - place
            } else {
                place
            };
            self.increments[inside.clamp(0, last) as usize]
        };
        let around = |step: i64| {
            let terms = weights.iter().zip(step - reach..);
            terms
                .map(|(weight, place)| weight * mirrored(place))
                .sum::<f64>()
                / total
        };
        (0..=last).map(around).collect()
    }
}

/// Contact events per lug pass [-].
///
/// An event is a lobe of upward acceleration behind a low-pass of 2.5 lug orders; it weighs as much
/// as the velocity `v_i` gained in it:
///
/// ```text
/// rate = (Σ v_i)² / Σ v_i² / passes
/// ```
///
/// Equal events count fully; lobes of noise and roughness between them hardly count.
pub fn contact_rate(increments: &VelocityIncrements) -> f64 {
    let smoothed = increments.smoothed(CORNER);
    let lobes = smoothed.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0));
    let gained = lobes
        .filter(|lobe| lobe[0] > 0.0)
        .map(|lobe| lobe.iter().sum::<f64>());
    let [sum, squares] = gained.fold([0.0, 0.0], |[sum, squares], v| [sum + v, squares + v * v]);
    sum * sum / squares / increments.passes
}

/// Orders searched for the strongest line [lug orders].
const ORDERS: [f64; 2] = [0.25, 1.6];
/// Their spacing.
const ORDER_STEP: f64 = 0.01;

/// Order [-] of the strongest line of the acceleration between 0.25 and 1.6 lug orders, under a
/// Hann window. It resolves the inverse of the number of lug passes.
pub fn strongest_order(increments: &VelocityIncrements) -> f64 {
    let length = increments.increments.len() as f64;
    let hann = |step: usize| 0.5 - 0.5 * libm::cos(TAU * (step as f64 + 0.5) / length);
    let windowed: Vec<f64> = increments
        .increments
        .iter()
        .enumerate()
        .map(|(step, v)| v * hann(step))
        .collect();
    let amplitude = |order: f64| {
        let phase = TAU * order / STEPS as f64;
        let [cosine, sine] = windowed
            .iter()
            .enumerate()
            .fold([0.0, 0.0], |[c, s], (step, v)| {
                let (sin, cos) = libm::sincos(phase * step as f64);
                [c + v * cos, s + v * sin]
            });
        libm::hypot(cosine, sine)
    };
    let count = ((ORDERS[1] - ORDERS[0]) / ORDER_STEP).round() as u32;
    let orders = (0..=count).map(|i| ORDERS[0] + ORDER_STEP * f64::from(i));
    orders
        .map(|order| (order, amplitude(order)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(1.0, |(order, _)| order)
}
