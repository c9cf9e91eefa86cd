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
