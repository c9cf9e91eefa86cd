//! What happened lug by lug, where the wheel angle tells when a lug should strike.
//!
//! A lug pass is the turn from one lug straight down to the next. On hard ground the vertical
//! velocity jumps once within it, near a known angle, by a known amount, and nothing else happens;
//! in soil nothing jumps; on loose stones velocity jumps anywhere and by any amount.

use super::record::{Record, Unusable};
use super::spectrum::Spectra;
use crate::vibration::reference::{LugChange, lug_changes};
use std::f64::consts::{LN_2, PI};
use std::ops::Range;

/// Corner [Hz] of the low-pass behind which impacts are measured: below the resonances of rigs,
/// above the lug-pass frequency of rovers.
const CORNER: f64 = 30.0;

/// Turn [lug angles] around a lug change within which a lug may strike: ground that rises by a
/// tenth of the lug's pitch shifts it so far.
const AROUND: f64 = 0.2;

/// The vibration of one lug pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LugPass {
    /// Highest pulse where a lug should strike, over that of the reference [-].
    pub strike: f64,
    /// Largest acceleration elsewhere in the pass, over the same [-].
    pub stray: f64,
    /// Three standard deviations of the sensor's noise, over the same [-].
    pub noise: f64,
}

/// The whole lug passes within the samples `window`.
///
/// # Errors
/// [`Unusable`] where samples are no numbers, constant or clipped, or the rate is too low.
pub fn lug_passes(record: &Record, window: Range<usize>) -> Result<Vec<LugPass>, Unusable> {
    record.usable(window.clone(), CORNER)?;
    let acceleration = &record.acceleration[window.clone()];
    let mut spectra = Spectra::default();
    let filtered = spectra.low_passed(acceleration, CORNER / record.sample_rate);
    let view = View {
        record,
        angle: &record.angle[window.clone()],
        filtered: filtered.samples(),
        noise: 3.0 * low_passed_noise(acceleration, record.sample_rate),
        changes: lug_changes(&record.wheel, &record.angle[window], record.sample_rate),
    };
    Ok(view
        .whole_passes()
        .filter_map(|pass| view.measure(pass))
        .collect())
}

/// One window, low-passed.
struct View<'a> {
    record: &'a Record,
    angle: &'a [f64],
    filtered: &'a [f64],
    noise: f64,
    changes: Vec<LugChange>,
}

impl View<'_> {
    /// Samples of the passes that begin and end within the window.
    fn whole_passes(&self) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let turned = |sample: usize| self.angle[sample] / self.record.lug_angle;
        let forward = self.angle[self.angle.len() - 1] >= self.angle[0];
        let upright = move |sample: usize| {
            if forward {
                turned(sample).floor()
            } else {
                turned(sample).ceil()
            }
        };
        let mut uprights: Vec<usize> = Vec::new();
        let mut furthest = upright(0);
        for sample in 1..self.angle.len() {
            let now = upright(sample);
            if (forward && now > furthest) || (!forward && now < furthest) {
                uprights.push(sample);
                furthest = now;
            }
        }
        let pairs: Vec<_> = uprights.windows(2).map(|pair| pair[0]..pair[1]).collect();
        pairs.into_iter()
    }

    /// Strike and stray of a pass; `None` where no lug changes in it.
    fn measure(&self, pass: Range<usize>) -> Option<LugPass> {
        let rate = self.record.sample_rate;
        let expected: Vec<&LugChange> = self
            .changes
            .iter()
            .filter(|change| pass.contains(&((change.time * rate) as usize)))
            .collect();
        let jump = expected
            .iter()
            .map(|change| change.velocity_jump)
            .reduce(f64::max)?;
        let pulse = jump * CORNER * libm::sqrt(2.0 * PI / LN_2);
        let near: Vec<f64> = expected
            .iter()
            .map(|change| self.angle_at(change.time))
            .collect();
        let is_near = |angle: f64| {
            let reach = AROUND * self.record.lug_angle;
            near.iter().any(|place| (angle - place).abs() < reach)
        };
        let (mut strike, mut stray) = (0.0_f64, 0.0_f64);
        for (angle, a) in self.angle[pass.clone()]
            .iter()
            .zip(&self.filtered[pass.clone()])
        {
            if is_near(*angle) {
                strike = strike.max(*a);
            } else {
                stray = stray.max(a.abs());
            }
        }
        Some(LugPass {
            strike: strike / pulse,
            stray: stray / pulse,
            noise: self.noise / pulse,
        })
    }

    fn angle_at(&self, time: f64) -> f64 {
        let sample = (time * self.record.sample_rate) as usize;
        self.angle[sample.min(self.angle.len() - 1)]
    }
}

/// Length [s] of the blocks among which the quietest tell the sensor's noise.
const BLOCK: f64 = 0.05;

/// Standard deviation [m/s²] of the sensor's noise behind the low-pass, were it white.
///
/// Second differences leave little but noise, six times its variance; a tenth of the blocks is
/// quieter than the one that counts, in which nothing struck.
fn low_passed_noise(acceleration: &[f64], rate: f64) -> f64 {
    let block = ((BLOCK * rate) as usize).max(3);
    let variance = |samples: &[f64]| {
        let differences = samples.windows(3).map(|x| x[0] - 2.0 * x[1] + x[2]);
        differences.map(|d| d * d).sum::<f64>() / (6 * (samples.len() - 2)) as f64
    };
    let mut blocks: Vec<f64> = acceleration.chunks_exact(block).map(variance).collect();
    if blocks.is_empty() {
        return 0.0;
    }
    let tenth = blocks.len() / 10;
    let (_, quiet, _) = blocks.select_nth_unstable_by(tenth, f64::total_cmp);
    // A Gaussian low-pass lets through as much as a rectangular one 1.064 times as wide.
    let share = libm::sqrt(PI / LN_2) / 2.0 * CORNER / (0.5 * rate);
    libm::sqrt(*quiet * share)
}
