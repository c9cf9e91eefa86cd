//! Order spectrum: how strongly a channel repeats per turn of the wheel.
//!
//! Vibration of a lugged wheel is tied to its angle, not to time: at equal angle steps a lug-pass
//! line stays sharp however the speed wavers.

use super::cubic;
use super::density::{FEWEST_PASSES, SpectrumError, check, mean_power};
use crate::trace::{Channel, unwrapped};
use std::f64::consts::TAU;

/// One-sided amplitude spectrum at equal steps of wheel angle.
///
/// A sine of amplitude `A` that falls on a line reads `A` there; half-way between two lines it
/// reads 0.85 `A` (Hann). Harmonics of the lug pass always fall on lines.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderSpectrum {
    /// Amplitude of each line, in the channel's unit, root mean square over the blocks.
    pub amplitude: Vec<f64>,
    /// Lug passes (turns of a smooth wheel) in a block: line `i` is lug order `i / passes`.
    pub passes: usize,
    /// Blocks averaged, each half over the one before.
    pub blocks: usize,
    /// Lug passes per turn [-]; 1 on a smooth wheel.
    pub passes_per_turn: u32,
}

impl OrderSpectrum {
    /// Order per lug pass [-] of a line: 1 is the lug-pass frequency.
    pub fn lug_order(&self, line: usize) -> f64 {
        line as f64 / self.passes as f64
    }

    /// Order per turn of the wheel [-] of a line.
    pub fn wheel_order(&self, line: usize) -> f64 {
        self.lug_order(line) * f64::from(self.passes_per_turn)
    }
}

/// Order spectrum of `signal` over `wheel_angle` \[rad\] of a wheel with `lug_count` lugs (0: smooth, or
/// of an unknown number).
///
/// ```text
/// A_k = 2 |Σ_j w_j (a(θ_j) - ā) exp(-2πi j k / N)| / Σ_j w_j,    w Hann, θ_j equally spaced
/// ```
///
/// Blocks are one turn long where the run has a whole turn, else as many whole lug passes as it
/// has, and overlap by half. The angle may run backward, come in encoder steps, or wrap at 2π;
/// standing still adds nothing. Between samples the signal is interpolated by cubics, flat to
/// 1 % up to a tenth of its rate.
///
/// # Errors
/// `NoSamples`, `NotFinite`, and `TooFewPasses` below four lug passes.
pub fn order_spectrum(
    signal: &Channel,
    wheel_angle: &Channel,
    lug_count: u32,
) -> Result<OrderSpectrum, SpectrumError> {
    check(signal)?;
    check(wheel_angle)?;
    let passes_per_turn = lug_count.max(1);
    let pass = TAU / f64::from(passes_per_turn);
    let knots = turning(wheel_angle, signal);
    let turned = knots.last().map_or(0.0, |last| last[1]);
    let whole = (turned / pass + 1e-9) as usize;
    if whole < FEWEST_PASSES {
        return Err(SpectrumError::TooFewPasses {
            passes: turned / pass,
            what: if lug_count == 0 {
                "turns"
            } else {
                "lug passes"
            },
        });
    }
    let passes = whole.min(FEWEST_PASSES.max(passes_per_turn as usize));
    let seconds_per_pass = (knots[knots.len() - 1][0] - knots[0][0]) / (turned / pass);
    // Twice the signal's own rate at mean speed: what aliases lies above the lines kept below.
    let steps = 2 * (signal.sample_rate * seconds_per_pass).ceil().max(2.0) as usize;
    let even = resample(signal, &knots, pass / steps as f64, whole * steps);
    let block = passes * steps;
    let (power, blocks) = mean_power(&even, block);
    let amplitude = power.iter().take(block / 4 + 1).map(|p| p.sqrt()).collect();
    Ok(OrderSpectrum {
        amplitude,
        passes,
        blocks,
        passes_per_turn,
    })
}

/// Time [s] and angle turned [rad] from 0, both strictly growing, while `signal` was recorded.
fn turning(wheel_angle: &Channel, signal: &Channel) -> Vec<[f64; 2]> {
    let end = signal.start + (signal.samples.len() - 1) as f64 / signal.sample_rate;
    let angles = unwrapped(&wheel_angle.samples);
    let during: Vec<[f64; 2]> = (0..angles.len())
        .map(|i| {
            let time = wheel_angle.start + i as f64 / wheel_angle.sample_rate;
            [time, angles[i]]
        })
        .filter(|[time, _]| *time >= signal.start && *time <= end)
        .collect();
    let (Some(first), Some(last)) = (during.first(), during.last()) else {
        return Vec::new();
    };
    let direction = (last[1] - first[1]).signum();
    let mut knots: Vec<[f64; 2]> = Vec::with_capacity(during.len());
    for [time, angle] in &during {
        let turned = (angle - first[1]) * direction;
        if knots.last().is_none_or(|knot| turned > knot[1]) {
            knots.push([*time, turned.max(0.0)]);
        }
    }
    knots
}

/// The signal at `count` angles `step` [rad] apart.
fn resample(signal: &Channel, knots: &[[f64; 2]], step: f64, count: usize) -> Vec<f64> {
    let mut right = 1;
    (0..count)
        .map(|i| {
            let angle = i as f64 * step;
            while right + 1 < knots.len() && knots[right][1] < angle {
                right += 1;
            }
            let ([t0, a0], [t1, a1]) = (knots[right - 1], knots[right]);
            let time = t0 + (t1 - t0) * (angle - a0) / (a1 - a0);
            cubic(&signal.samples, (time - signal.start) * signal.sample_rate)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::sampled;

    /// A wheel whose speed wavers by 30 %.
    fn wavering(t: f64) -> f64 {
        2.0 * t + 0.3 * libm::sin(2.0 * t)
    }

    fn strongest(spectrum: &OrderSpectrum) -> usize {
        (0..spectrum.amplitude.len())
            .max_by(|&a, &b| spectrum.amplitude[a].total_cmp(&spectrum.amplitude[b]))
            .unwrap()
    }

    #[test]
    fn a_sine_per_lug_pass_reads_its_amplitude_at_order_1_while_the_speed_wavers() {
        for sign in [1.0, -1.0] {
            let angle = sampled("wheel_angle", 500.0, 20.0, |t| sign * wavering(t));
            let signal = sampled("acceleration_y", 2000.0, 20.0, |t| {
                3.0 * libm::sin(28.0 * wavering(t)) + 5.0
            });
            let spectrum = order_spectrum(&signal, &angle, 28).unwrap();
            let line = strongest(&spectrum);
            assert_eq!(spectrum.lug_order(line), 1.0);
            assert_eq!(spectrum.wheel_order(line), 28.0);
            // 1 %: what is left of interpolating angle and signal.
            let read = spectrum.amplitude[line];
            assert!((read - 3.0).abs() < 0.03, "{read}");
            // Beyond Hann's main lobe nothing else is there; the constant 5 is no order.
            let away = spectrum.amplitude[2 * spectrum.passes];
            assert!(away < 0.03, "{away}");
            assert!(spectrum.amplitude[0] < 0.03);
        }
    }

    #[test]
    fn a_slow_short_run_still_separates_the_harmonics_of_the_lug_pass() {
        // The paper's 14 mm/s: 15 s are 6.7 lug passes.
        let angle = sampled("wheel_angle", 1000.0, 15.0, |t| 0.1 * t);
        let signal = sampled("acceleration_y", 2000.0, 15.0, |t| {
            libm::sin(2.8 * t) + 0.25 * libm::cos(3.0 * 2.8 * t)
        });
        let spectrum = order_spectrum(&signal, &angle, 28).unwrap();
        assert_eq!((spectrum.passes, spectrum.blocks), (6, 1));
        assert!((spectrum.amplitude[6] - 1.0).abs() < 0.01);
        assert!((spectrum.amplitude[18] - 0.25).abs() < 0.01);
        assert!(spectrum.amplitude[12] < 0.01);
    }

    #[test]
    fn encoder_steps_and_wrapping_do_not_move_the_lug_pass() {
        let counts = TAU / 1024.0;
        let angle = sampled("wheel_angle", 1000.0, 20.0, |t| {
            ((2.0 * t / counts).floor() * counts) % TAU
        });
        let signal = sampled("acceleration_y", 2000.0, 20.0, |t| libm::sin(56.0 * t));
        let spectrum = order_spectrum(&signal, &angle, 28).unwrap();
        let line = strongest(&spectrum);
        assert_eq!(spectrum.lug_order(line), 1.0);
        // 28 lugs and 1024 counts: a count is 0.17 rad of the lug pass, so its rounding costs
        // some 1 - 0.17²/24 = 0.1 %, and the sampling of the edges as much again.
        assert!((spectrum.amplitude[line] - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_smooth_wheel_counts_turns() {
        let angle = sampled("wheel_angle", 500.0, 20.0, |t| 2.0 * t);
        let signal = sampled("acceleration_y", 1000.0, 20.0, |t| 0.5 * libm::sin(2.0 * t));
        let spectrum = order_spectrum(&signal, &angle, 0).unwrap();
        let line = strongest(&spectrum);
        assert_eq!(spectrum.wheel_order(line), 1.0);
        assert!((spectrum.amplitude[line] - 0.5).abs() < 0.005);
    }

    #[test]
    fn a_run_too_short_says_how_far_the_wheel_turned() {
        let angle = sampled("wheel_angle", 500.0, 1.0, |t| 0.5 * t);
        let signal = sampled("acceleration_y", 1000.0, 1.0, |_| 1.0);
        let message = order_spectrum(&signal, &angle, 28).unwrap_err().to_string();
        assert!(message.contains("made 2.2 lug passes"), "{message}");
        let still = sampled("wheel_angle", 500.0, 1.0, |_| 0.0);
        let error = order_spectrum(&signal, &still, 28).unwrap_err();
        assert!(matches!(error, SpectrumError::TooFewPasses { passes, .. } if passes == 0.0));
    }

    #[test]
    fn a_sample_that_is_no_number_is_named_with_its_time() {
        let angle = sampled("wheel_angle", 500.0, 20.0, |t| 2.0 * t);
        let mut signal = sampled("acceleration_y", 1000.0, 20.0, libm::sin);
        signal.samples[2500] = f64::NAN;
        let message = order_spectrum(&signal, &angle, 28).unwrap_err().to_string();
        assert!(message.starts_with("channel acceleration_y is not a finite number at 2.5000 s"));
        signal.samples.clear();
        let error = order_spectrum(&signal, &angle, 28).unwrap_err();
        assert_eq!(error, SpectrumError::NoSamples("acceleration_y".to_owned()));
    }
}
