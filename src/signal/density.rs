//! Spectral density over frequency, and the averaged periodograms behind it.

use super::Plans;
use crate::trace::Channel;
use std::f64::consts::TAU;

/// Lug passes that a block needs: with fewer, Hann's main lobe (four lines wide) smears each
/// harmonic of the lug pass into the next.
pub(super) const FEWEST_PASSES: usize = 4;

/// Why a channel has no spectrum.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectrumError {
    /// Fewer than two samples, or a rate that is not above 0.
    #[error("channel {0} has no samples to speak of (it needs two, at a rate above 0 Hz)")]
    NoSamples(String),
    /// A sample is infinite or not a number.
    #[error("channel {channel} is not a finite number at {time:.4} s; cut or repair it first")]
    NotFinite {
        /// Which channel.
        channel: String,
        /// When \[s\].
        time: f64,
    },
    /// The wheel did not turn far enough.
    #[error(
        "the wheel made {passes:.1} {what} while both channels were recorded, and an order spectrum needs {FEWEST_PASSES}; record longer"
    )]
    TooFewPasses {
        /// Lug passes, or turns of a smooth wheel.
        passes: f64,
        /// Which of the two.
        what: &'static str,
    },
}

/// One-sided amplitude spectral density over frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct DensitySpectrum {
    /// Distance of two lines \[Hz\]: line `i` stands at `i` times that.
    pub spacing: f64,
    /// Density of each line [channel's unit per root hertz], root mean square over the blocks.
    pub density: Vec<f64>,
}

/// Blocks, each half over the one before, into which a record is cut for its density.
const DENSITY_BLOCKS: usize = 7;

/// Amplitude spectral density of a channel, by seven blocks under Hann's window (Welch 1967, IEEE
/// Trans. Audio Electroacoust. 15:70-73).
///
/// ```text
/// D_k = |Σ_j w_j (a_j - ā) exp(-2πi j k / N)| √(2 / (f_s Σ_j w_j²))
/// ```
///
/// # Errors
/// `NoSamples`, `NotFinite`.
pub fn density_spectrum(signal: &Channel) -> Result<DensitySpectrum, SpectrumError> {
    check(signal)?;
    let count = signal.samples.len();
    let block = (2 * (count / (DENSITY_BLOCKS + 1))).max(2).min(count);
    let (power, _) = mean_power(&signal.samples, block);
    let spacing = signal.sample_rate / block as f64;
    // Hann's noise bandwidth is 1.5 lines.
    let to_density = |power: &f64| libm::sqrt(power / (2.0 * 1.5 * spacing));
    Ok(DensitySpectrum {
        spacing,
        density: power.iter().map(to_density).collect(),
    })
}

/// Mean squared amplitude of every line, and the number of blocks.
pub(super) fn mean_power(even: &[f64], block: usize) -> (Vec<f64>, usize) {
    let transform = Plans::default().forward(block);
    let hann: Vec<f64> = (0..block)
        .map(|j| 0.5 - 0.5 * libm::cos(TAU * j as f64 / block as f64))
        .collect();
    let scale = 2.0 / hann.iter().sum::<f64>();
    let mut power = vec![0.0; block / 2 + 1];
    let mut blocks = 0;
    for start in (0..=even.len() - block).step_by(block / 2) {
        let piece = &even[start..start + block];
        let mean = piece.iter().sum::<f64>() / block as f64;
        let windowed = (0..block).map(|j| (piece[j] - mean) * hann[j]).collect();
        for (sum, line) in power.iter_mut().zip(transform.apply(windowed)) {
            *sum += line.norm_sqr() * scale * scale;
        }
        blocks += 1;
    }
    for sum in &mut power {
        *sum /= f64::from(blocks);
    }
    (power, blocks as usize)
}

pub(super) fn check(channel: &Channel) -> Result<(), SpectrumError> {
    let rate = channel.sample_rate;
    if channel.samples.len() < 2 || !rate.is_finite() || rate <= 0.0 {
        return Err(SpectrumError::NoSamples(channel.name.clone()));
    }
    match channel.samples.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(index) => Err(SpectrumError::NotFinite {
            channel: channel.name.clone(),
            time: channel.start + index as f64 / rate,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::sampled;

    #[test]
    fn the_density_of_white_noise_is_its_deviation_over_the_root_of_half_its_rate() {
        let mut state = 1_u64;
        let noise = sampled("acceleration_y", 1000.0, 40.0, |_| 0.0);
        let samples = noise.samples.iter().map(|_| {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        });
        let noise = Channel {
            samples: samples.collect(),
            ..noise
        };
        let spectrum = density_spectrum(&noise).unwrap();
        assert_eq!(spectrum.spacing, 0.1);
        let inner = &spectrum.density[10..4990];
        let square = inner.iter().map(|d| d * d).sum::<f64>() / inner.len() as f64;
        // Evenly distributed over a unit; 5000 lines of 7 blocks scatter by a per cent.
        let expected = 1.0 / 12.0 / 500.0;
        assert!((square / expected - 1.0).abs() < 0.04, "{square}");
    }

    #[test]
    fn two_samples_have_a_density_and_one_has_none() {
        let mut signal = sampled("acceleration_y", 10.0, 0.2, |t| t);
        assert_eq!(density_spectrum(&signal).unwrap().density.len(), 2);
        signal.samples.pop();
        assert!(density_spectrum(&signal).is_err());
    }
}
