//! Frequency of the vibration over that of the lug pass (Eq. 51), three ways.
//!
//! Windows contain between one and some sixteen lug passes, and the paper's limits are 15 % from 1: with few
//! passes no spectrum resolves that. Contact events can be counted, and their intervals averaged, in a window
//! of any length; this is the meaning of (51), `κ_f = 1 / mean C_f`, where `C_f` is the interval between two
//! contacts in lug angles. In soil there are no contacts to count, but the line of the lug pass is clear. So
//! the default is that line where it is found, and the event count otherwise. All methods work in wheel angle
//! instead of time, so that a changing speed does not broaden lines.

use super::record::{Record, Unusable};
use super::spectrum::gaussian_gain;
use std::f64::consts::{LN_2, PI, TAU};
use std::ops::Range;

/// Steps of the wheel angle per lug pass.
const STEPS: usize = 32;

/// Corner of the low-pass before events are counted, in lug orders [-]: an impact becomes one lobe.
const EVENT_CORNER: f64 = 1.0;

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
        let level_near = |step: i64| {
            let terms = weights.iter().zip(step - reach..);
            terms
                .map(|(weight, place)| weight * mirrored(place))
                .sum::<f64>()
                / total
        };
        (0..=last).map(level_near).collect()
    }
}

/// Contact events per lug pass [-].
///
/// An event is a lobe of upward acceleration behind a low-pass of one lug order; it weighs as much
/// as the velocity `v_i` gained in it:
///
/// ```text
/// rate = (Σ v_i)² / Σ v_i² / passes
/// ```
///
/// Equal events count fully; lobes of noise and roughness between them hardly count.
pub fn contact_rate(increments: &VelocityIncrements) -> f64 {
    let smoothed = increments.smoothed(EVENT_CORNER);
    let lobes = smoothed.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0));
    let gained = lobes
        .filter(|lobe| lobe[0] > 0.0)
        .map(|lobe| lobe.iter().sum::<f64>());
    let [sum, squares] = gained.fold([0.0, 0.0], |[sum, squares], v| [sum + v, squares + v * v]);
    sum * sum / squares / increments.passes
}

/// Corner of the low-pass before a line is fitted, in lug orders [-].
const LINE_CORNER: f64 = 1.5;
/// Orders of the line of the lug pass [lug orders], and how finely they are tried.
const LINE_ORDERS: [f64; 2] = [0.7, 1.3];
const LINE_STEP: f64 = 0.02;
/// Share of the vibration's power below the corner [-] from which a line counts.
const LINE_SHARE: f64 = 0.3;

/// Order [-] of the line of the lug pass where it has more than 30 % of the power below 1.5 lug orders,
/// fitted by least squares between 0.7 and 1.3; otherwise the [`contact_rate`].
///
/// With few lug passes a line is found in any signal: in white noise in a quarter of the windows of 4.8
/// passes, in nine of ten of 1.5. The frequency criterion of the paper's regions is then weak.
pub fn lug_line(increments: &VelocityIncrements) -> f64 {
    let smoothed = increments.smoothed(LINE_CORNER);
    let mean = smoothed.iter().sum::<f64>() / smoothed.len() as f64;
    let varying: Vec<f64> = smoothed.iter().map(|v| v - mean).collect();
    let count = ((LINE_ORDERS[1] - LINE_ORDERS[0]) / LINE_STEP).round() as u32;
    let orders = (0..=count).map(|i| LINE_ORDERS[0] + LINE_STEP * f64::from(i));
    let best = orders
        .map(|order| (order, line_share(&varying, order)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    match best {
        Some((order, share)) if share > LINE_SHARE => order,
        _ => contact_rate(increments),
    }
}

/// Steps of a sinusoid that are taken together.
const FINE: usize = 32;

/// Share of the power [-] that a sinusoid of this order explains, its own mean taken off.
fn line_share(varying: &[f64], order: f64) -> f64 {
    let phase = |step: usize| TAU * order / STEPS as f64 * step as f64;
    let n = varying.len() as f64;
    // Sine and cosine of the sum of a coarse and a fine step.
    let fine: [_; FINE] = std::array::from_fn(|step| libm::sincos(phase(step)));
    let coarse = (0..varying.len()).step_by(FINE);
    let waves = coarse.flat_map(|step| {
        let (sin, cos) = libm::sincos(phase(step));
        fine.map(|(s, c)| (sin * c + cos * s, cos * c - sin * s))
    });
    let waves: Vec<_> = waves.take(varying.len()).collect();
    let [s_mean, c_mean] = waves
        .iter()
        .fold([0.0, 0.0], |[s, c], (sin, cos)| [s + sin / n, c + cos / n]);
    let (mut ss, mut sc, mut cc, mut sv, mut cv) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for ((sin, cos), v) in waves.iter().zip(varying) {
        let (s, c) = (sin - s_mean, cos - c_mean);
        ss += s * s;
        sc += s * c;
        cc += c * c;
        sv += s * v;
        cv += c * v;
    }
    let power: f64 = varying.iter().map(|v| v * v).sum();
    let determinant = ss * cc - sc * sc;
    (sv * sv * cc - 2.0 * sv * cv * sc + cv * cv * ss) / determinant / power
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Increments of `passes` lug passes from the value at each, in lug angles.
    fn increments(passes: f64, value: impl Fn(f64) -> f64) -> VelocityIncrements {
        let steps = (passes * STEPS as f64) as usize;
        let at = |step: usize| (step as f64 + 0.5) / STEPS as f64;
        VelocityIncrements {
            increments: (0..steps).map(|step| value(at(step))).collect(),
            passes,
        }
    }

    /// One impact of a step's width, on ground that takes the velocity back in between.
    fn impacts(every: f64) -> impl Fn(f64) -> f64 {
        move |u| {
            let hit = (u / every).fract() < 1.0 / STEPS as f64 / every;
            f64::from(u8::from(hit)) - 1.0 / (STEPS as f64 * every)
        }
    }

    #[test]
    fn an_impact_at_every_lug_pass_reads_one_all_three_ways() {
        for passes in [4.0, 8.5, 15.0] {
            let every = increments(passes, impacts(1.0));
            let rate = contact_rate(&every);
            // The window's ends cut an event or not.
            assert!((rate - 1.0).abs() < 0.6 / passes, "{passes}: {rate}");
            assert!((lug_line(&every) - 1.0).abs() < 0.05);
            let strongest = strongest_order(&every);
            assert!(
                (strongest - 1.0).abs() < 0.6 / passes,
                "{passes}: {strongest}"
            );
        }
    }

    #[test]
    fn an_impact_at_every_third_lug_reads_a_third() {
        let third = increments(15.0, impacts(3.0));
        assert!((contact_rate(&third) - 1.0 / 3.0).abs() < 0.04);
        assert!((lug_line(&third) - 1.0 / 3.0).abs() < 0.04);
    }

    #[test]
    fn the_smooth_wave_of_a_lug_in_soil_reads_one_though_ripples_ride_on_it() {
        let soil = increments(6.3, |u| {
            libm::sin(TAU * u) + 0.4 * libm::sin(2.0 * TAU * u + 1.0) + 0.3 * libm::sin(0.37 * u)
        });
        assert!((lug_line(&soil) - 1.0).abs() < 0.05);
    }

    #[test]
    fn one_strong_event_among_weak_ones_counts_for_little_more_than_one() {
        let mixed = increments(10.0, |u| {
            let hit = u.fract() < 1.0 / STEPS as f64;
            let strength = if u < 1.0 { 20.0 } else { 1.0 };
            f64::from(u8::from(hit)) * strength - 29.0 / (10.0 * STEPS as f64)
        });
        let rate = contact_rate(&mixed);
        assert!(rate < 0.3, "{rate}");
    }
}
