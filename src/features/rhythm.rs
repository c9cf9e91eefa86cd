//! Pulse trains synchronous with the lugs, or with another count of them.
//!
//! On flat hard ground lug `k` strikes when the wheel has turned by
//!
//! ```text
//! θ_k = θ_0 + ω τ + (k + 1/2) α        (multi-lugged wheel)
//! ```
//!
//! with `θ_0` the reading where a lug points straight down and `τ` the delay of the acceleration relative to
//! the angle. At one speed only their sum, the offset `θ_0 + ω τ`, is observable. A train of period `ρ α` is
//! searched over all offsets: the rotation is divided into cells of one period, and a cell counts as *struck*
//! if it has a pulse at the expected phase, is quiet elsewhere, and the pulse is about as high as in the
//! other cells. The test is free of scale, so the train of a sensor with wrong gain or sign is found.
//!
//! In a train of any period the impacts are equally high, which can be tested without a period: [`unequal`].

use super::pulses::{BINS, Pulses};
use crate::statistics::{quantile_upper, sorted, upper_median};
use statrs::function::beta::beta_reg;

/// Tolerance [periods] of a strike about a lug change: ground that rises by a tenth of the lug pitch shifts
/// it by so much. Shared among the strikes of an olig-lugged wheel's lug.
const TOLERANCE: f64 = 0.2;
/// Stray over strike [-] up to which a cell is quiet elsewhere.
const ELSEWHERE: f64 = 0.5;
/// Strike over the median one [-], and its inverse, within which a train's pulses are alike.
const ALIKE: f64 = 2.5;
/// The same for trains that are not the lugs' and for trains of few cells: among many periods, or few
/// pulses, some fit by chance.
const STRICT_ELSEWHERE: f64 = 0.3;
const STRICT_ALIKE: f64 = 2.0;
/// Highest over lowest impact [-] of equal ones: 9 of 10 strikes of lugs on rough slate, 4 of 10 on stones.
const EQUAL: f64 = 1.5;
/// Impact over the upper quartile of all [-] below which the wheel wobbles between two strikes.
const WOBBLE: f64 = 0.1;
/// Cells up to which a train has few.
const FEW: usize = 4;
/// Share of cells that makes a train [-].
pub const MOST: f64 = 0.6;
/// Periods [lug passes] that other trains may have: half the lugs to twice as many.
const PERIODS: [f64; 2] = [0.45, 2.1];
/// Periods as near to 1 as this are the lugs' own.
const OWN: f64 = 0.03;
/// Bins between two offsets that are tried.
const STRIDE: usize = 2;

/// A way of cutting a window into cells.
#[derive(Debug, Clone, Copy)]
struct Trial {
    /// Period [lug passes].
    period: f64,
    upward: bool,
    /// Numbers fitted to the pulses: the offset, and the period where it is not the lugs'.
    fitted: usize,
}

/// What happened in a cell: its highest pulse where one should be, and elsewhere.
#[derive(Debug, Clone, Copy)]
struct Cell {
    strike: f64,
    stray: f64,
    /// Of the strike, from where it should be [lug passes].
    shift: f64,
}

/// The train of pulses that fits a window best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rhythm {
    /// Period [lug passes].
    pub period: f64,
    /// Whether pulses are upward, as those of lugs are.
    pub upward: bool,
    /// Cells of one period.
    pub cells: usize,
    /// Cells that were struck.
    pub struck: usize,
    /// Median height of the pulses, over the reference's [-].
    pub height: f64,
    /// Posterior probability that more than [`MOST`] of all cells are struck.
    pub probability: f64,
    /// Wheel angle \[rad\] at which a lug points straight down, its delay included; within half a
    /// lug angle of 0.
    pub offset: f64,
    /// Standard error of the offset \[rad\]: scatter of the pulses, and half a bin.
    pub offset_error: f64,
    /// By how much a pulse comes later than the one before it, less a period \[periods\], and its
    /// standard error.
    pub drift: [f64; 2],
}

impl Rhythm {
    /// The train of the lugs themselves: their period, pulses upward.
    pub fn own(pulses: &Pulses) -> Option<Self> {
        best(pulses, Trial::at(1.0, true))
    }

    /// The train of the lugs, pulses downward.
    pub fn reversed(pulses: &Pulses) -> Option<Self> {
        best(pulses, Trial::at(1.0, false))
    }

    /// The best train of another period, either way up.
    pub fn other(pulses: &Pulses) -> Option<Self> {
        // Over the window, a step of the period shifts the last cell by less than a pulse may.
        let step = (0.5 * TOLERANCE / pulses.passes()).clamp(0.005, OWN);
        let steps = ((PERIODS[1] - PERIODS[0]) / step) as usize;
        let periods = (0..=steps).map(|i| PERIODS[0] + i as f64 * step);
        let periods = periods.filter(|period| (period - 1.0).abs() > OWN);
        let trials = periods.flat_map(|period| [true, false].map(|up| Trial::at(period, up)));
        let trains = trials.filter_map(|trial| best(pulses, trial));
        trains.max_by(|a, b| a.probability.total_cmp(&b.probability))
    }

    /// The period [lug passes] of the pulses, drift included.
    pub fn kept_period(&self) -> f64 {
        self.period * (1.0 + self.drift[0])
    }
}

impl Trial {
    fn at(period: f64, upward: bool) -> Self {
        Self {
            period,
            upward,
            fitted: if period == 1.0 { 1 } else { 2 },
        }
    }

    /// Posterior probability that more than [`MOST`] of all cells are struck, without as many cells as
    /// degrees of freedom were used in the fit: one pulse is always in step with itself.
    fn probability(&self, struck: usize, cells: usize) -> f64 {
        let left = struck.saturating_sub(self.fitted);
        more_than(MOST, left, cells - self.fitted)
    }

    /// The cells whose first one begins at bin `offset`.
    fn cells(&self, pulses: &Pulses, offset: usize) -> Vec<Cell> {
        let length = self.period * BINS as f64;
        let (along, against) = if self.upward {
            (&pulses.upward, &pulses.downward)
        } else {
            (&pulses.downward, &pulses.upward)
        };
        let count = (along.len().saturating_sub(offset) as f64 / length) as usize;
        let begin = |cell: usize| offset + (cell as f64 * length).round() as usize;
        let reach = TOLERANCE / pulses.strikes.len().max(1) as f64;
        let cell = |cell: usize| {
            let mut seen = Cell {
                strike: 0.0,
                stray: 0.0,
                shift: 0.0,
            };
            for bin in begin(cell)..begin(cell + 1).min(along.len()) {
                let place = (bin as f64 + 0.5 - begin(cell) as f64) / length;
                let shifts = pulses.strikes.iter().map(|strike| place - strike);
                let shift = shifts.min_by(|a, b| a.abs().total_cmp(&b.abs()));
                match shift.filter(|shift| shift.abs() < reach) {
                    Some(shift) if along[bin] > seen.strike => {
                        seen.strike = along[bin];
                        seen.shift = shift;
                    }
                    Some(_) => {}
                    None => seen.stray = seen.stray.max(along[bin]),
                }
                // Downward near a strike, a pulse rings.
                if shift.is_some_and(|shift| shift.abs() >= reach) {
                    seen.stray = seen.stray.max(against[bin]);
                }
            }
            seen
        };
        (0..count).map(cell).collect()
    }
}

/// The best train of a trial over all offsets.
fn best(pulses: &Pulses, trial: Trial) -> Option<Rhythm> {
    let length = (trial.period * BINS as f64).round() as usize;
    let offsets = (0..length).step_by(STRIDE);
    let scored = offsets.filter_map(|offset| {
        let cells = trial.cells(pulses, offset);
        (cells.len() > trial.fitted).then(|| {
            let probability = trial.probability(struck(&cells, &trial).len(), cells.len());
            (probability, clearness(&cells), offset)
        })
    });
    let (_, _, offset) =
        scored.max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.total_cmp(&b.1)))?;
    Some(fitted(pulses, &trial, offset))
}

/// The numbers of the cells that were struck.
fn struck(cells: &[Cell], trial: &Trial) -> Vec<usize> {
    let height = height(cells);
    let strict = trial.fitted > 1 || cells.len() <= FEW;
    let (elsewhere, alike) = if strict {
        (STRICT_ELSEWHERE, STRICT_ALIKE)
    } else {
        (ELSEWHERE, ALIKE)
    };
    let alike = height / alike..height * alike;
    let is_struck =
        |cell: &Cell| cell.stray < elsewhere * cell.strike && alike.contains(&cell.strike);
    let numbers = cells.iter().enumerate().filter(|(_, cell)| is_struck(cell));
    numbers.map(|(number, _)| number).collect()
}

fn height(cells: &[Cell]) -> f64 {
    upper_median(cells.iter().map(|cell| cell.strike)).unwrap_or(0.0)
}

/// Mean logarithm of strike over stray, each within a factor of 20, less how far the pulses lie from
/// where they should: of equal counts, the train in the middle of its pulses is the better.
fn clearness(cells: &[Cell]) -> f64 {
    const TINY: f64 = 1.0e-9;
    let of = |cell: &Cell| {
        let ratio = libm::log((cell.strike + TINY) / (cell.stray + TINY));
        ratio.clamp(-3.0, 3.0) - cell.shift.abs()
    };
    cells.iter().map(of).sum::<f64>() / cells.len() as f64
}

fn fitted(pulses: &Pulses, trial: &Trial, offset: usize) -> Rhythm {
    let cells = trial.cells(pulses, offset);
    let struck = struck(&cells, trial);
    let points: Vec<[f64; 2]> = struck
        .iter()
        .map(|&number| [number as f64, cells[number].shift])
        .collect();
    let line = Line::through(&points);
    // In periods from the begin of the first bin; a lug points straight down where a cell begins.
    let turned = pulses.begin + offset as f64 / BINS as f64 + trial.period * line.mean;
    let passes = turned - turned.round();
    Rhythm {
        period: trial.period,
        upward: trial.upward,
        cells: cells.len(),
        struck: struck.len(),
        height: height(&cells),
        probability: trial.probability(struck.len(), cells.len()),
        offset: pulses.direction * passes * pulses.lug_angle,
        offset_error: (line.mean_error + 0.5 / BINS as f64) * pulses.lug_angle,
        drift: [line.slope, line.slope_error],
    }
}

/// A straight line through shifts over the numbers of their cells, by least squares.
struct Line {
    mean: f64,
    mean_error: f64,
    slope: f64,
    slope_error: f64,
}

impl Line {
    /// Without three points it has no slope that could be judged.
    fn through(points: &[[f64; 2]]) -> Self {
        let count = points.len().max(1) as f64;
        let mean_of = |i: usize| points.iter().map(|point| point[i]).sum::<f64>() / count;
        let (number, mean) = (mean_of(0), mean_of(1));
        let spread: f64 = points.iter().map(|[x, _]| (x - number).powi(2)).sum();
        let product: f64 = points.iter().map(|[x, y]| (x - number) * (y - mean)).sum();
        let slope = if points.len() > 2 {
            product / spread
        } else {
            0.0
        };
        let square = |[x, y]: &[f64; 2]| (y - mean - slope * (x - number)).powi(2);
        let residual: f64 = points.iter().map(square).sum();
        let variance = residual / (count - 2.0).max(1.0);
        let (mean_error, slope_error) = if points.len() > 2 {
            (libm::sqrt(variance / count), libm::sqrt(variance / spread))
        } else {
            (TOLERANCE, f64::INFINITY)
        };
        Self {
            mean,
            mean_error,
            slope,
            slope_error,
        }
    }
}

/// Probability that impacts above `threshold` do not form a train of lugs, for any number of lugs, sign and
/// scale: the posterior probability that at most [`MOST`] of all impacts are equally high.
///
/// The fall of a lug on hard ground is set by the wheel alone. Impacts on stones spread over a factor of
/// thirty; those below a tenth of the strong ones are ignored. A wheel of few lugs has as many heights as
/// strikes in a lug pass.
pub fn unequal(pulses: &Pulses, threshold: f64) -> f64 {
    let mut heights = sorted(pulses.impacts(threshold));
    let strong = quantile_upper(&heights, 0.75);
    heights.retain(|height| strong.is_some_and(|strong| *height >= WOBBLE * strong));
    let count = heights.len();
    let kinds = pulses.strikes.len().max(1);
    let equal: usize = (0..kinds).map(|_| take_equal(&mut heights)).sum();
    1.0 - more_than(MOST, equal, count)
}

/// Takes as many heights as possible within a factor of [`EQUAL`] out of sorted ones, and counts them.
fn take_equal(sorted: &mut Vec<f64>) -> usize {
    let end = |start: usize| sorted.partition_point(|height| *height <= EQUAL * sorted[start]);
    let ranges = (0..sorted.len()).map(|start| start..end(start));
    let most = ranges.max_by_key(ExactSizeIterator::len).unwrap_or(0..0);
    sorted.drain(most).count()
}

/// Probability that a share exceeds `limit` after `hits` of `trials`, under Jeffreys' prior.
pub fn more_than(limit: f64, hits: usize, trials: usize) -> f64 {
    1.0 - beta_reg(hits as f64 + 0.5, (trials - hits) as f64 + 0.5, limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pulses of these (lug pass, height), on a wheel that strikes once in a pass.
    fn pulses(passes: usize, impacts: &[(f64, f64)]) -> Pulses {
        let mut upward = vec![0.0; passes * BINS];
        for (place, height) in impacts {
            upward[(place * BINS as f64) as usize] = *height;
        }
        Pulses {
            downward: vec![0.0; upward.len()],
            upward,
            begin: 0.0,
            direction: 1.0,
            lug_angle: 0.2,
            strikes: vec![0.5],
            wheel_speed: 0.1,
            background: 0.01,
            noise: 0.001,
            kurtosis: 10.0,
        }
    }

    fn train(passes: u32, period: f64, height: impl Fn(u32) -> f64) -> Pulses {
        let count = (f64::from(passes) / period) as u32;
        let impact = |i: u32| (period * (f64::from(i) + 0.5), height(i));
        pulses(passes as usize, &(0..count).map(impact).collect::<Vec<_>>())
    }

    #[test]
    fn a_train_of_any_lug_count_is_of_equal_height_and_its_period_is_found() {
        for period in [0.5, 0.8, 1.2, 2.0] {
            let train = train(16, period, |i| 1.0 + 0.1 * f64::from(i % 3));
            assert!(unequal(&train, 0.12) < 0.1, "{period}");
            let found = Rhythm::other(&train).unwrap();
            assert!(found.probability > 0.8, "{period}: {found:?}");
            assert!((found.kept_period() - period).abs() < 0.02, "{found:?}");
        }
    }

    #[test]
    fn an_echo_of_each_impact_does_not_change_their_equality() {
        let impacts = (0..10).flat_map(|i| [(f64::from(i) + 0.5, 1.0), (f64::from(i) + 0.6, 0.3)]);
        let train = pulses(10, &impacts.collect::<Vec<_>>());
        assert!(unequal(&train, 0.12) < 0.1);
    }

    #[test]
    fn impacts_over_a_decade_are_unequal_and_three_of_them_too_few_to_say() {
        let height = |i: u32| libm::pow(10.0, f64::from(i * 7 % 10) / 10.0);
        assert!(unequal(&train(12, 1.0, height), 0.12) > 0.95);
        let few = unequal(&train(3, 1.0, height), 0.12);
        assert!(few < 0.9, "{few}");
    }
}
