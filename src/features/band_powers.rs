//! Power of a window's acceleration in bands of equal ratio: what a trained classifier is usually
//! given. Nothing of the wheel or its speed is in it.
//!
//! Bands reach from 0.5 Hz to 800 Hz, or to 0.4 of the sample rate where that is less, whence
//! anti-alias filters take over.

/// Number of bands.
pub const BANDS: usize = 12;

/// Decimal logarithms of the power [(m/s²)²] in each band, lowest band first.
pub type BandPowers = [f64; BANDS];

/// Lower end [Hz] of the lowest band.
const LOW: f64 = 0.5;
/// Upper end [Hz] of the highest band.
const HIGH: f64 = 800.0;
/// Upper end of the highest band over the sample rate [-].
const HIGH_PER_RATE: f64 = 0.4;
/// Power [(m/s²)²] of silence: far below any sensor's noise.
const SILENCE: f64 = 1.0e-30;

/// From the `powers` of a spectrum's lines, its second one first, at a `sample_rate` [Hz].
///
/// A band that lies between two lines, as low ones do in a short window, takes the line nearest to
/// its middle.
pub(super) fn of_lines(powers: &[f64], sample_rate: f64) -> BandPowers {
    let high = HIGH.min(HIGH_PER_RATE * sample_rate);
    let edge = |band: usize| LOW * libm::pow(high / LOW, band as f64 / BANDS as f64);
    // The window has two samples for every line, one of which at each end is not in `powers`.
    let lines_per_hertz = 2.0 * (powers.len() + 1) as f64 / sample_rate;
    let index = |frequency: f64| frequency * lines_per_hertz - 1.0;
    std::array::from_fn(|band| {
        let ends = [edge(band), edge(band + 1)].map(|end| index(end).ceil().max(0.0) as usize);
        let inside = powers.get(ends[0]..ends[1]).unwrap_or_default();
        let power = if inside.is_empty() {
            let middle = index(libm::sqrt(edge(band) * edge(band + 1)));
            let nearest = (middle.round().max(0.0) as usize).min(powers.len().saturating_sub(1));
            powers.get(nearest).copied().unwrap_or_default()
        } else {
            inside.iter().sum()
        };
        libm::log10(power.max(SILENCE))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::spectrum::Spectra;
    use std::f64::consts::TAU;

    fn tone(frequency: f64, amplitude: f64) -> Vec<f64> {
        let sample = |i: u32| amplitude * libm::sin(TAU * frequency * f64::from(i) / 2000.0);
        (0..8000).map(|i| 5.0 + sample(i)).collect()
    }

    fn powers(samples: &[f64]) -> BandPowers {
        of_lines(&Spectra::default().powers(samples), 2000.0)
    }

    #[test]
    fn a_tone_has_its_mean_square_in_its_band_and_nothing_in_the_others() {
        let powers = powers(&tone(100.0, 3.0));
        // 100 Hz lie ln(200) / ln(1600) * 12 = 8.6 bands above 0.5 Hz.
        assert!((powers[8] - libm::log10(4.5)).abs() < 1e-3, "{powers:?}");
        for band in (0..BANDS).filter(|band| *band != 8) {
            assert!(powers[band] < -9.0, "{powers:?}");
        }
    }

    #[test]
    fn in_a_short_window_bands_between_two_lines_take_the_nearest() {
        let short = powers(&tone(4.0, 1.0)[..1000]);
        assert!(short.iter().all(|power| power.is_finite()));
        // Lines are 2 Hz apart: band 0, 0.5 to 0.9 Hz, has none of its own.
        assert_eq!(short[0], short[1]);
    }

    #[test]
    fn silence_and_nothing_at_all_have_finite_powers() {
        for samples in [&[0.0; 100][..], &[1.0, 2.0]] {
            assert!(powers(samples).iter().all(|power| power.is_finite()));
        }
    }
}
