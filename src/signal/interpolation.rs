//! Samples at places between them, counted in samples from the first.

use std::f64::consts::{FRAC_PI_2, PI};

/// Zeros of the kernel of [`band_limited`] on either side.
const ZEROS: f64 = 16.0;

/// The sample nearest to a place; the first or last beyond the ends.
pub fn nearest(samples: &[f64], place: f64) -> f64 {
    samples[(libm::round(place).max(0.0) as usize).min(samples.len() - 1)]
}

/// On a straight line between the neighbours, ends repeated.
pub fn linear(samples: &[f64], place: f64) -> f64 {
    let low = libm::floor(place);
    let [before, after] = [low, low + 1.0].map(|place| nearest(samples, place));
    before + (after - before) * (place - low)
}

/// Catmull-Rom value at a fractional sample position, ends repeated.
pub fn cubic(samples: &[f64], position: f64) -> f64 {
    let last = samples.len() - 1;
    let position = position.clamp(0.0, last as f64);
    let i = (position as usize).min(last - 1);
    let u = position - i as f64;
    let [a, b, c, d] = [
        samples[i.saturating_sub(1)],
        samples[i],
        samples[i + 1],
        samples[(i + 2).min(last)],
    ];
    let slope = (c - a) / 2.0;
    let bend = a - 2.5 * b + 2.0 * c - 0.5 * d;
    let twist = (d - a) / 2.0 + 1.5 * (b - c);
    b + u * (slope + u * (bend + u * twist))
}

/// Band-limited to the slower of two rates, `ratio` times the output rate being the input rate: a sinc kernel of 16
/// zeros on either side under a cosine window, flat to 1 % up to 0.4 of the slower rate.
pub fn band_limited(samples: &[f64], place: f64, ratio: f64) -> f64 {
    let stretch = ratio.max(1.0);
    let reach = ZEROS * stretch;
    let from = libm::ceil(place - reach).max(0.0) as usize;
    let to = (libm::floor(place + reach).max(0.0) as usize).min(samples.len() - 1);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, sample) in samples.iter().enumerate().take(to + 1).skip(from) {
        let away = i as f64 - place;
        let window = libm::cos(FRAC_PI_2 * away / reach);
        let weight = sinc(away / stretch) * window * window;
        sum += weight * sample;
        weights += weight;
    }
    if weights.abs() > 0.0 {
        sum / weights
    } else {
        nearest(samples, place)
    }
}

/// sin(πx)/(πx).
pub fn sinc(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    libm::sin(PI * x) / (PI * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_interpolation_meets_the_samples_and_cubics_follow_a_parabola() {
        let samples: Vec<f64> = (0..80).map(|i| f64::from(i * i)).collect();
        for of in [nearest, linear, cubic] {
            assert_eq!([of(&samples, 0.0), of(&samples, 41.0)], [0.0, 1681.0]);
        }
        assert_eq!(linear(&samples, 40.5), 1640.5);
        assert_eq!(cubic(&samples, 40.5), 1640.25);
        assert_eq!(nearest(&samples, 1000.0), 6241.0);
    }

    #[test]
    fn a_tone_below_the_slower_rate_passes_and_one_above_does_not() {
        let tone = |cycles: f64| -> Vec<f64> {
            let sample = |i| libm::sin(2.0 * PI * cycles * f64::from(i));
            (0..2000).map(sample).collect()
        };
        // Every fourth sample: a rate of 0.25 cycles per sample.
        let at = |cycles: f64, place: f64| band_limited(&tone(cycles), place, 4.0);
        let expected = libm::sin(2.0 * PI * 0.05 * 1000.3);
        assert!((at(0.05, 1000.3) - expected).abs() < 0.01);
        for place in [1000.0, 1001.3, 1002.7] {
            assert!(at(0.2, place).abs() < 0.01);
        }
    }
}
