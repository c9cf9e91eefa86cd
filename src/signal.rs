//! Signals: transforms, spectra over frequency and order, interpolation, bands, clipping.

mod band;
mod clipping;
mod density;
mod fourier;
mod interpolation;
mod order;

pub use band::Band;
pub use clipping::clipped_levels;
pub use density::{DensitySpectrum, SpectrumError, density_spectrum};
pub use fourier::{Backward, Forward, Plans, hann_lines, hann_powers, smooth_above, smooth_below};
pub use interpolation::{band_limited, cubic, linear, nearest, sinc};
pub use order::{OrderSpectrum, order_spectrum};

/// A channel of `value` over time \[s\].
#[cfg(test)]
fn sampled(
    name: &str,
    rate: f64,
    seconds: f64,
    value: impl Fn(f64) -> f64,
) -> crate::trace::Channel {
    crate::trace::Channel {
        name: name.to_owned(),
        unit: String::new(),
        sample_rate: rate,
        start: 0.0,
        samples: (0..(rate * seconds) as usize)
            .map(|i| value(i as f64 / rate))
            .collect(),
    }
}
