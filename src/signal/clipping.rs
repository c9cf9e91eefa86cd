//! Detection of clipped samples.
//!
//! A clipped signal stays at its extreme value, and has it far more often than the neighbouring value. A
//! quantised one stays at its extreme too, but no longer than at other values: the cause is the step, not the
//! range.

/// Number of consecutive samples at an extreme value that count as a stay [-].
const STAY: usize = 3;

/// Times as many samples at the extreme value as at the next one, from which it is clipped [-].
///
/// A sine that is only quantised has at most 1 / (√2 - 1) = 2.4 times as many at its crest.
const CROWD: usize = 5;

/// Times as long as 9 of 10 stays elsewhere that a stay at the extreme lasts on average, from which it is
/// clipped [-]: of exponentially distributed stays, as a quantised random signal makes them, 9 of 10 last
/// less than 2.3 times their mean, so that this is 4.6 times the mean.
const LONGER: f64 = 2.0;

/// The levels at which `samples` are clipped: none, one or both ends of a sensor's range.
pub fn clipped_levels(samples: &[f64]) -> Vec<f64> {
    let Some([low, above_low, below_high, high]) = levels(samples) else {
        return Vec::new();
    };
    if low == high {
        return Vec::new();
    }
    let ends = [[low, above_low], [high, below_high]].into_iter();
    ends.filter(|&levels| is_clipped(samples, levels))
        .map(|[extreme, _]| extreme)
        .collect()
}

/// The lowest, next to lowest, next to highest and highest of the numbers among `samples`.
fn levels(samples: &[f64]) -> Option<[f64; 4]> {
    let finite = || samples.iter().copied().filter(|x| x.is_finite());
    let low = finite().reduce(f64::min)?;
    let high = finite().reduce(f64::max)?;
    let above_low = finite().filter(|&x| x > low).fold(high, f64::min);
    let below_high = finite().filter(|&x| x < high).fold(low, f64::max);
    Some([low, above_low, below_high, high])
}

/// Whether samples stay at the `extreme` value, longer than elsewhere, and the `next` one is far rarer.
/// Zero is where a force ends by nature.
fn is_clipped(samples: &[f64], [extreme, next]: [f64; 2]) -> bool {
    let count = |level: f64| samples.iter().filter(|&&x| x == level).count();
    if extreme == 0.0 || count(extreme) < CROWD * count(next) {
        return false;
    }
    let stays = samples
        .chunk_by(|a, b| a == b)
        .filter(|stay| stay[0].is_finite());
    let (at_end, elsewhere): (Vec<&[f64]>, Vec<&[f64]>) =
        stays.partition(|stay| stay[0] == extreme);
    let longest = at_end.iter().map(|stay| stay.len()).max().unwrap_or(0);
    let mean = count(extreme) as f64 / at_end.len().max(1) as f64;
    longest >= STAY && mean >= LONGER * nine_of_ten(&elsewhere)
}

/// Length [samples] below which 9 of 10 `stays` last.
fn nine_of_ten(stays: &[&[f64]]) -> f64 {
    let mut lengths: Vec<usize> = stays.iter().map(|stay| stay.len()).collect();
    lengths.sort_unstable();
    let place = lengths.len() * 9 / 10;
    lengths.get(place).map_or(1.0, |&length| length as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(i: u32) -> f64 {
        100.0 + 20.0 * libm::sin(f64::from(i) * 0.011)
    }

    fn quantised(x: f64, step: f64) -> f64 {
        (x / step).round() * step
    }

    fn levels_of(sample: impl Fn(u32) -> f64) -> Vec<f64> {
        clipped_levels(&(0..5000).map(sample).collect::<Vec<f64>>())
    }

    #[test]
    fn a_clipped_signal_is_found_at_its_end_and_though_it_is_quantised() {
        assert_eq!(levels_of(|i| wave(i).min(115.0)), [115.0]);
        assert_eq!(levels_of(|i| wave(i).clamp(85.0, 115.0)), [85.0, 115.0]);
        let bits = |i| quantised(wave(i), 0.1).min(115.0);
        assert_eq!(levels_of(bits), [115.0]);
    }

    #[test]
    fn a_quantised_or_resting_signal_is_not_clipped() {
        for step in [0.5, 2.0, 5.0, 13.0] {
            assert_eq!(levels_of(|i| quantised(wave(i), step)), [0.0; 0], "{step}");
        }
        // Off the ground half of the time.
        assert_eq!(levels_of(|i| (wave(i) - 100.0).max(0.0)), [0.0; 0]);
        assert_eq!(levels_of(|_| 3.0), [0.0; 0]);
    }

    #[test]
    fn a_coarse_signal_that_is_held_here_and_there_is_not_clipped() {
        // Each value held for four samples, the lowest for one stay only, its neighbour for one sample.
        let held = |i: u32| match i {
            0..6 => -6.0,
            6 => -5.0,
            i => f64::from((i / 4 * 7) % 5),
        };
        assert_eq!(levels_of(held), [0.0; 0]);
    }
}
