//! Speed-independent vibration features of a window (Section 3): `κ_f`, `κ_A`, `κ_mv`, `κ_ms`.
//!
//! Each is a statistic of the vertical acceleration over the same statistic of the reference: the
//! acceleration of the same wheel on flat hard ground ([`mod@reference`]), turned by the same angle in
//! the same window and passed through the same filter. Unknown properties of the wheel's rig then cancel, and
//! so does the speed as far as the vibration consists of impacts of lugs.
//!
//! ```text
//! acceleration ─▶ cut out a window ─▶ less its mean, low-pass ─▶ statistics ─┐
//! wheel angle ──▶ the same window ──▶ lug changes, velocity jumps ─▶ the same ┴▶ ratios κ, p = lg κ
//! ```
//!
//! Choices not specified in the paper are listed below; each is a field of [`Settings`], and
//! `output/reference/feature_choices.txt` is the study behind the defaults, on seeds used nowhere else.
//!
//! - **Low-pass** (bandwidth): Gaussian, since it does not ring: an impact stays a pulse of one sign, so that
//!   the mean of the rectified reference is its velocity jumps per time, independent of the bandwidth. Sum of
//!   amplitudes and mean square depend on it, so it has to be stated.
//! - **Mean value** (53): of the rectified acceleration. The signed mean of an acceleration is zero
//!   up to bias on every ground.
//! - **Amplitudes** (52): of all lines of the window's spectrum under a Hann window, since the window does
//!   not contain a whole number of lug passes.
//! - **Frequency** (51): [`frequency`].

pub mod band_powers;
pub mod frequency;
pub mod pulses;
pub mod record;
pub mod reference;
pub mod rhythm;
mod spectrum;
pub mod support;

use crate::quantity::RangeError;
use record::{Record, Unusable};
use reference::Reference;
use serde::{Deserialize, Serialize};
use spectrum::Spectra;
use std::ops::Range;

/// Which mean Eq. (53) takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MeanValue {
    /// Of the rectified acceleration.
    Rectified,
    /// Of the acceleration as it is, its bias included.
    Signed,
}

/// How Eq. (51) takes the frequency of the vibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Frequency {
    /// The line of the lug pass where it stands out, else the contact rate, see
    /// [`frequency::lug_line`].
    LugLine,
    /// Contact events per lug pass, see [`frequency::contact_rate`].
    ContactRate,
    /// The strongest line of the order spectrum, see [`frequency::strongest_order`].
    StrongestOrder,
}

/// How windows are cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Window {
    /// Of this length \[s\].
    Seconds(f64),
    /// Of this many lug passes.
    LugPasses(f64),
}

/// Choices on windows and features that the paper does not specify.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How windows are cut.
    pub window: Window,
    /// Corner \[Hz\] of the Gaussian low-pass, 3 dB down.
    pub bandwidth: f64,
    /// Which mean Eq. (53) takes.
    pub mean: MeanValue,
    /// How Eq. (51) takes the frequency.
    pub frequency: Frequency,
}

impl Default for Settings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Settings {
    /// What the studies behind `output/reference/feature_choices.txt` chose.
    pub const DEFAULT: Self = Self {
        window: Window::Seconds(crate::trace::truth::PAPER_WINDOW),
        bandwidth: 100.0,
        mean: MeanValue::Rectified,
        frequency: Frequency::LugLine,
    };

    /// Whether windows can be cut and filtered so.
    ///
    /// # Errors
    /// `RangeError` for a window or bandwidth that is not positive.
    pub fn check(&self) -> Result<(), RangeError> {
        match self.window {
            Window::Seconds(length) => RangeError::positive("window", "s", length)?,
            Window::LugPasses(passes) => RangeError::positive("window", "lug passes", passes)?,
        };
        RangeError::positive("bandwidth", "Hz", self.bandwidth)?;
        Ok(())
    }
}

/// The four features of a window, each over the reference's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Features {
    /// Frequency ratio `κ_f` [-] (Eq. 51).
    pub kappa_f: f64,
    /// Ratio of the sums of amplitudes `κ_A` [-] (Eq. 52).
    pub kappa_a: f64,
    /// Ratio of the mean values `κ_mv` [-] (Eq. 53).
    pub kappa_mv: f64,
    /// Ratio of the mean squares `κ_ms` [-] (Eq. 54).
    pub kappa_ms: f64,
}

impl Features {
    /// The feature vector `P` (Section 3.2): `p_1 ... p_4`, the decimal logarithms of
    /// `κ_f, κ_A, κ_mv, κ_ms` [-].
    pub fn p(&self) -> [f64; 4] {
        [self.kappa_f, self.kappa_a, self.kappa_mv, self.kappa_ms].map(libm::log10)
    }
}

/// Statistics of one acceleration in a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Frequency over that of the lug pass [-].
    pub frequency: f64,
    /// Sum of the spectrum's amplitudes; its unit cancels in `κ_A`.
    pub amplitude_sum: f64,
    /// Mean value [m/s²], as [`MeanValue`] takes it.
    pub mean_value: f64,
    /// Mean square [m²/s⁴].
    pub mean_square: f64,
}

impl Statistics {
    /// These statistics over those of the reference.
    pub fn over(&self, reference: &Self) -> Features {
        Features {
            kappa_f: self.frequency / reference.frequency,
            kappa_a: self.amplitude_sum / reference.amplitude_sum,
            kappa_mv: self.mean_value / reference.mean_value,
            kappa_ms: self.mean_square / reference.mean_square,
        }
    }
}

/// Extracts features; reuses its plans of the Fourier transform.
pub struct Extractor {
    settings: Settings,
    spectra: Spectra,
}

impl Extractor {
    /// # Errors
    /// Those of [`Settings::check`].
    pub fn new(settings: Settings) -> Result<Self, RangeError> {
        settings.check()?;
        Ok(Self {
            settings,
            spectra: Spectra::default(),
        })
    }

    /// What windows and features are taken with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Features of the samples `window` of a record.
    ///
    /// # Errors
    /// [`Unusable`] with the reason: samples that are no numbers, a constant or
    /// clipped channel, a wheel at rest, less than one lug pass or lug change, a rate too low for
    /// the bandwidth.
    pub fn features(
        &mut self,
        record: &Record,
        window: Range<usize>,
        reference: &Reference,
    ) -> Result<Features, Unusable> {
        let passes = record.usable(window.clone(), self.settings.bandwidth)?;
        let measured = self.measured(record, window.clone())?;
        let computed = self.computed(record, window.clone())?;
        let lug_pass = passes / record.seconds(&window);
        Ok(measured.over(&reference.correct(computed, lug_pass)))
    }

    /// The impacts within the samples `window`; `None` where the wheel turned by less than a bin.
    ///
    /// # Errors
    /// [`Unusable`] where samples are no numbers, constant or clipped, or the rate is too low.
    pub fn pulses(
        &mut self,
        record: &Record,
        window: Range<usize>,
    ) -> Result<Option<pulses::Pulses>, Unusable> {
        pulses::pulses(record, window, &mut self.spectra)
    }

    /// Logarithms of the acceleration's power in bands, see [`band_powers`]; independent of reference, wheel
    /// angle and bandwidth.
    ///
    /// # Errors
    /// [`Unusable`] for samples that are no numbers, and a constant or clipped channel.
    pub fn band_powers(
        &mut self,
        record: &Record,
        window: Range<usize>,
    ) -> Result<band_powers::BandPowers, Unusable> {
        record.sound(window.clone())?;
        let powers = self.spectra.powers(&record.acceleration[window]);
        Ok(band_powers::of_lines(&powers, record.sample_rate))
    }

    /// `κ_A` and `κ_ms` [-] of a displacement \[m\] over the `reference`'s \[m\], both sampled at the same
    /// equally spaced wheel angles: Eq. (52) and (54) with displacements for accelerations. Means
    /// are taken off and nothing is filtered. Not finite where the reference does not move.
    pub fn displacement_ratios(&mut self, displacement: &[f64], reference: &[f64]) -> [f64; 2] {
        let [of, over] = [displacement, reference].map(|samples| {
            let filtered = self.spectra.as_they_are(samples);
            [filtered.amplitude_sum, filtered.mean_square()]
        });
        [of[0] / over[0], of[1] / over[1]]
    }

    /// Statistics of the measured acceleration.
    pub(crate) fn measured(
        &mut self,
        record: &Record,
        window: Range<usize>,
    ) -> Result<Statistics, Unusable> {
        let samples = &record.acceleration[window.clone()];
        let filtered = self
            .spectra
            .low_passed(samples, self.settings.bandwidth / record.sample_rate);
        let mean_value = match self.settings.mean {
            MeanValue::Rectified => filtered.rectified_mean(),
            MeanValue::Signed => samples.iter().sum::<f64>() / samples.len() as f64,
        };
        let increments = frequency::VelocityIncrements::of(record, window)?;
        Ok(Statistics {
            frequency: self.frequency(&increments),
            amplitude_sum: filtered.amplitude_sum,
            mean_value,
            mean_square: filtered.mean_square(),
        })
    }

    /// Statistics of the computed reference.
    pub(crate) fn computed(
        &mut self,
        record: &Record,
        window: Range<usize>,
    ) -> Result<Statistics, Unusable> {
        let train = reference::train(record, window.clone())?;
        let samples = train.low_passed(self.settings.bandwidth);
        let increments = frequency::VelocityIncrements::from_samples(&samples, record, window)?;
        let signed = samples.iter().sum::<f64>() / samples.len() as f64;
        let filtered = self.spectra.as_they_are(&samples);
        let mean_value = match self.settings.mean {
            MeanValue::Rectified => filtered.rectified_mean(),
            MeanValue::Signed => signed,
        };
        Ok(Statistics {
            frequency: self.frequency(&increments),
            amplitude_sum: filtered.amplitude_sum,
            mean_value,
            mean_square: filtered.mean_square(),
        })
    }

    fn frequency(&self, increments: &frequency::VelocityIncrements) -> f64 {
        match self.settings.frequency {
            Frequency::LugLine => frequency::lug_line(increments),
            Frequency::ContactRate => frequency::contact_rate(increments),
            Frequency::StrongestOrder => frequency::strongest_order(increments),
        }
    }
}
