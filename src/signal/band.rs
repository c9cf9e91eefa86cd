//! Bands of vibration, cut out by filters whose bits are the same on every machine.

use std::f64::consts::PI;

/// Frequencies from `low` to `high` \[Hz\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower corner \[Hz\], 3 dB down.
    pub low: f64,
    /// Upper corner \[Hz\], 3 dB down.
    pub high: f64,
}

/// Damping ratios of the two sections of a Butterworth filter of fourth order: cos(π/8), cos(3π/8).
const DAMPING: [f64; 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];

impl Band {
    /// The part of `samples`, taken at `rate` \[Hz\], within the band: Butterworth filters of fourth
    /// order at both corners, started at rest. `None` where the band reaches beyond 0.4 of the
    /// rate, whence anti-alias filters take over.
    pub fn of(&self, samples: &[f64], rate: f64) -> Option<Vec<f64>> {
        if self.high > 0.4 * rate {
            return None;
        }
        let mut filtered = samples.to_vec();
        for damping in DAMPING {
            Section::high_pass(self.low, damping, rate).apply(&mut filtered);
            Section::low_pass(self.high, damping, rate).apply(&mut filtered);
        }
        Some(filtered)
    }
}

/// A filter of second order by the bilinear transform, exact at its corner.
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    fn low_pass(corner: f64, damping: f64, rate: f64) -> Self {
        let k = libm::tan(PI * corner / rate);
        Self::new(k, damping, [k * k, 2.0 * k * k, k * k])
    }

    fn high_pass(corner: f64, damping: f64, rate: f64) -> Self {
        Self::new(libm::tan(PI * corner / rate), damping, [1.0, -2.0, 1.0])
    }

    fn new(k: f64, damping: f64, b: [f64; 3]) -> Self {
        let scale = 1.0 / (1.0 + 2.0 * damping * k + k * k);
        Self {
            b: b.map(|b| b * scale),
            a: [
                2.0 * (k * k - 1.0) * scale,
                (1.0 - 2.0 * damping * k + k * k) * scale,
            ],
        }
    }

    fn apply(&self, samples: &mut [f64]) {
        let ([b0, b1, b2], [a1, a2]) = (self.b, self.a);
        let mut state = [0.0; 2];
        for sample in samples {
            let x = *sample;
            let y = b0 * x + state[0];
            state = [b1 * x - a1 * y + state[1], b2 * x - a2 * y];
            *sample = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    /// Gain of a band on a tone of whole periods, after its transient.
    fn gain(band: Band, frequency: f64) -> f64 {
        let rate = 2000.0;
        let tone: Vec<f64> = (0..20_000)
            .map(|i| libm::sin(TAU * frequency * f64::from(i) / rate))
            .collect();
        let filtered = band.of(&tone, rate).unwrap();
        let steady = &filtered[10_000..];
        let square: f64 = steady.iter().map(|x| x * x).sum();
        (2.0 * square / steady.len() as f64).sqrt()
    }

    const BAND: Band = Band {
        low: 20.0,
        high: 200.0,
    };

    #[test]
    fn a_band_passes_its_middle_and_halves_the_power_at_its_corners() {
        // 1e-3: at 63 Hz each corner, half a decade away, still takes (0.32)^8 / 2 of the amplitude.
        assert!((gain(BAND, 63.0) - 1.0).abs() < 1e-3);
        for corner in [BAND.low, BAND.high] {
            assert!(
                (gain(BAND, corner) - FRAC_1_SQRT_2).abs() < 1e-3,
                "{corner}"
            );
        }
    }

    #[test]
    fn an_octave_beyond_its_corners_24_db_are_gone() {
        let gone = 10.0_f64.powf(-24.0 / 20.0);
        assert!(gain(BAND, 10.0) < 1.01 * gone, "{}", gain(BAND, 10.0));
        assert!(gain(BAND, 400.0) < 1.01 * gone, "{}", gain(BAND, 400.0));
    }

    #[test]
    fn there_is_no_band_beyond_two_fifths_of_the_rate() {
        assert_eq!(BAND.of(&[1.0; 10], 499.0), None);
        assert!(BAND.of(&[1.0; 10], 500.0).is_some());
    }
}
