//! Finite impulse responses: their design by the window method, and the product that applies them.

use crate::signal::sinc;

/// Values that one pass of the inner product takes; taps are padded with zeros to a multiple.
const LANES: usize = 8;

/// Kaiser's window at `position` in [-1, 1] for a stop band `attenuation` [dB] deep (above 50 dB).
///
/// # Reference
/// Kaiser (1974), *Nonrecursive Digital Filter Design Using the I0-sinh Window Function*.
pub(super) fn kaiser(position: f64, attenuation: f64) -> f64 {
    let beta = 0.1102 * (attenuation - 8.7);
    bessel_i0(beta * libm::sqrt((1.0 - position * position).max(0.0))) / bessel_i0(beta)
}

/// Modified Bessel function of the first kind, order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}

/// Taps, odd in number and symmetric, of a low pass that is flat below `pass` and `attenuation`
/// [dB] deep above `stop`, both in cycles per sample.
pub(super) fn low_pass([pass, stop]: [f64; 2], attenuation: f64) -> Vec<f64> {
    let length = (attenuation - 7.95) / (14.36 * (stop - pass));
    let half = (length / 2.0).ceil();
    let cut = (pass + stop) / 2.0;
    let tap = |i: i32| {
        let t = f64::from(i) - half;
        sinc(2.0 * cut * t) * kaiser(t / half, attenuation)
    };
    unit_sum((0..=2 * half as i32).map(tap).collect())
}

/// Scales taps so that a constant passes unchanged.
pub(super) fn unit_sum(mut taps: Vec<f64>) -> Vec<f64> {
    let sum: f64 = taps.iter().sum();
    taps.iter_mut().for_each(|tap| *tap /= sum);
    taps
}

/// Appends zeros until [`dot`] can take the taps.
pub(super) fn padded(mut taps: Vec<f64>) -> Vec<f64> {
    taps.resize(taps.len().next_multiple_of(LANES), 0.0);
    taps
}

/// Inner product of padded taps with as many samples.
///
/// Partial sums stand side by side so that the compiler may use vector registers; their order is
/// fixed, so that bits do not depend on which it uses.
pub(super) fn dot(taps: &[f64], samples: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (taps, _) = taps.as_chunks::<LANES>();
    let (samples, _) = samples.as_chunks::<LANES>();
    for (a, b) in taps.iter().zip(samples) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Sums `Σ_t h_t x_{i+t}` of `taps` h over samples x, for every i that the samples allow, into `sums`.
///
/// Neighbouring sums stand side by side in vector registers; each is taken in the order of its taps, so that bits do not
/// depend on where a block begins.
pub(super) fn correlate(taps: &[f64], samples: &[f64], sums: &mut Vec<f64>) {
    let count = (samples.len() + 1).saturating_sub(taps.len());
    sums.clear();
    sums.resize(count, 0.0);
    let (blocks, rest) = sums.as_chunks_mut::<LANES>();
    let done = blocks.len() * LANES;
    for (number, block) in blocks.iter_mut().enumerate() {
        let mut lanes = [0.0; LANES];
        let under = &samples[number * LANES..];
        for (tap, x) in taps.iter().zip(under.windows(LANES)) {
            for (sum, x) in lanes.iter_mut().zip(x) {
                *sum += tap * x;
            }
        }
        *block = lanes;
    }
    for (sum, samples) in rest.iter_mut().zip(samples.windows(taps.len()).skip(done)) {
        for (tap, x) in taps.iter().zip(samples) {
            *sum += tap * x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bessel_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 9.8: exp(-x) I0(x) at 1 and 5, ten digits.
        for (x, scaled) in [(1.0, 0.465_759_607_6), (5.0, 0.183_540_812_6)] {
            let found = bessel_i0(x) * libm::exp(-x);
            assert!((found - scaled).abs() < 1e-10, "I0({x}): {found}");
        }
    }

    #[test]
    fn sums_by_blocks_are_the_plain_sums_to_the_bit() {
        let taps: Vec<f64> = (1..=12).map(|i| 1.0 / f64::from(i)).collect();
        let samples: Vec<f64> = (1..=45).map(|i| f64::from(i * i) / 7.0).collect();
        let plain = |window: &[f64]| taps.iter().zip(window).fold(0.0, |sum, (h, x)| sum + h * x);
        let expected: Vec<f64> = samples.windows(12).map(plain).collect();
        let mut sums = vec![1.0; 3];
        correlate(&taps, &samples, &mut sums);
        assert_eq!(sums, expected);
        correlate(&taps, &samples[..11], &mut sums);
        assert!(sums.is_empty());
    }

    #[test]
    fn a_padded_product_is_the_plain_sum_of_products() {
        let taps: Vec<f64> = (1..=11).map(f64::from).collect();
        let samples: Vec<f64> = (1..=16).map(|i| f64::from(i * i)).collect();
        // Sum of cubes to 11; the five samples after them meet zeros.
        assert_eq!(dot(&padded(taps), &samples), 4356.0);
    }
}
