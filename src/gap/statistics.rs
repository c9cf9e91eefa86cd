//! Statistics of a trace.
//!
//! Statistics are taken over the steady part of a run, without its first and last tenth, and of its finite
//! samples: gaps are excluded, or interpolated linearly where the order of samples matters and at most a
//! fifth of them is missing. The wheel angle enters as its deviation from uniform rotation. A statistic that
//! cannot be computed for a run (too short, constant, no lugs) has no cell.
//!
//! | domain | statistics |
//! |---|---|
//! | time | moments, crest, drift, start, steps, rails |
//! | order | level, cosine and sine part at the wheel orders 1, 2, 3, `n_l`, `2 n_l`, `3 n_l` and `n_l ± 1` |
//! | lug | the average over the lug pass, and the residual about it |
//! | frequency | one-third octaves, and the highest line in each |
//! | cross | correlation, coherence and lag of pairs, apparent mass |
//! | feature | `lg κ` and the shares of the classes |
//! | load | steady means, pull and torque per load |
//! | history | growth of the deviation, slope along the way |
//!
//! A phase is given as the cosine and sine parts of its wave: an angle would jump at a full turn and be
//! undefined for zero amplitude. A level 120 dB or more below the channel's size is set to that: it is
//! rounding.

mod cross;
mod loads;
mod moments;
mod orders;
mod signal;
mod spectra;
mod vibration;

use super::cell::Domain;
use super::readings::Readings;
use crate::features::Settings;
use crate::features::reference::Reference;
use crate::quantity::RangeError;
use crate::recognition::{Method, Recognizer};
use crate::trace::{Channel, Trace, unwrapped};
use orders::Turning;
use signal::Signal;
use spectra::{Spectra, Spectrum};

/// Computes the statistics of runs; reuses its plans of the Fourier transform.
pub struct Statistician {
    recognizer: Recognizer,
    spectra: Spectra,
}

impl Statistician {
    /// A reader whose features are taken with `settings` over `reference`.
    ///
    /// # Errors
    /// Those of [`Settings::check`].
    pub fn new(settings: Settings, reference: Reference) -> Result<Self, RangeError> {
        Ok(Self {
            recognizer: Recognizer::new(settings, reference, &[Method::Improved])?,
            spectra: Spectra::default(),
        })
    }

    /// All that can be read from a run. A run of means has the load domain only.
    pub fn read(&mut self, trace: &Trace) -> Readings {
        self.read_changed(trace, &|_| false, &Readings::default())
    }

    /// [`read`](Self::read) of a trace by other sensors of the same motion, given the `readings` of the trace
    /// `base`: statistics of channels with identical samples are copied.
    pub fn read_again(&mut self, trace: &Trace, base: &Trace, readings: &Readings) -> Readings {
        let is_kept = |name: &str| trace.channel(name) == base.channel(name);
        // These enter the statistics of every channel.
        let share = |name: &str| trace.channel(name).is_some() && is_kept(name);
        if !["wheel_angle", "forward_speed"].into_iter().all(share) {
            return self.read(trace);
        }
        self.read_changed(trace, &is_kept, readings)
    }

    /// Computes the statistics that involve changed channels; copies all others from `known`.
    fn read_changed(
        &mut self,
        trace: &Trace,
        is_kept: &dyn Fn(&str) -> bool,
        known: &Readings,
    ) -> Readings {
        let mut readings = Readings::default();
        let angle = angle(trace);
        loads::read(trace, angle.as_ref(), &mut readings);
        let channels = trace.channels.iter().filter(|channel| {
            !is_kept(&channel.name) || cross::partners(&channel.name).any(|it| !is_kept(it))
        });
        let channels = channels.map(|channel| match &angle {
            Some(angle) if channel.name == angle.name => angle,
            _ => channel,
        });
        let signals: Vec<Signal> = channels.filter_map(Signal::of).collect();
        let mut turning = Turning::of(trace, angle);
        for signal in signals.iter().filter(|signal| !is_kept(&signal.name)) {
            moments::read(signal, trace, &mut readings);
            if let Some(turning) = &mut turning {
                turning.read(signal, &mut readings);
            }
        }
        let spectra: Vec<Option<Spectrum>> = signals
            .iter()
            .map(|signal| self.spectra.of(signal))
            .collect();
        for (signal, spectrum) in signals.iter().zip(&spectra) {
            if let (Some(spectrum), false) = (spectrum, is_kept(&signal.name)) {
                spectrum.read(signal, &mut readings);
            }
        }
        cross::read(&signals, &spectra, &mut self.spectra, &mut readings);
        let keeps_windows = vibration::CHANNELS.into_iter().all(is_kept);
        if !keeps_windows {
            vibration::read(&mut self.recognizer, trace, &mut readings);
        }
        readings.copy(known, |cell| match cell.domain() {
            Domain::Load => false,
            Domain::Feature => keeps_windows,
            _ => cell.channel.split('~').all(is_kept),
        });
        readings
    }
}

/// The wheel angle without jumps, where it was measured.
fn angle(trace: &Trace) -> Option<Channel> {
    let channel = trace.channel("wheel_angle")?;
    Some(Channel {
        samples: unwrapped(&channel.samples),
        ..channel.clone()
    })
}
