//! Interpolation of a coarse encoder between its steps.
//!
//! An encoder of few counts per turn has the same reading for many samples while the wheel turns. The reading
//! equals the wheel's angle only where it changes; between two changes the speed is taken as constant. Only a
//! reading that stays several times as long as the median is that of a wheel at rest.
use super::knots::interpolated;

/// Median stay [samples] of a reading above which an encoder is coarse.
const COARSE: usize = 2;

/// Number of median stays [-] above which a constant reading is that of a wheel at rest.
const RESTS: usize = 4;

/// Least number of changes [-] for a median stay.
const FEWEST: usize = 4;

/// A reading that does not change from one sample on.
#[derive(Debug, Clone, Copy)]
struct Stay {
    /// Its first sample.
    from: usize,
    angle: f64,
}

/// Continuous `angles` \[rad\] with those between the steps of a coarse encoder interpolated; of a fine one as they are.
/// What is no number stays so.
pub fn between_steps(angles: &[f64]) -> Vec<f64> {
    let stays = stays(angles);
    let Some(median) = median(&stays).filter(|&median| median >= COARSE) else {
        return angles.to_vec();
    };
    let knots = knots(&stays, median, angles.len());
    let interpolated = |(index, &angle): (usize, &f64)| {
        if angle.is_finite() {
            interpolated(&knots, index as f64)
        } else {
            angle
        }
    };
    angles.iter().enumerate().map(interpolated).collect()
}

/// Whether a reading changes too seldom to resolve the wheel's speed.
pub fn is_too_coarse(angles: &[f64]) -> bool {
    let stays = stays(angles);
    stays.len() < FEWEST && stays.len() * COARSE * 2 < angles.len()
}

/// The stays of a reading.
fn stays(angles: &[f64]) -> Vec<Stay> {
    let mut stays: Vec<Stay> = Vec::new();
    for (from, &angle) in angles.iter().enumerate().filter(|(_, a)| a.is_finite()) {
        if stays.last().is_none_or(|stay| stay.angle != angle) {
            stays.push(Stay { from, angle });
        }
    }
    stays
}

/// Median length [samples] of the stays of which beginning and end are known.
fn median(stays: &[Stay]) -> Option<usize> {
    let whole = stays.get(1..)?.windows(2);
    let mut lengths: Vec<usize> = whole.map(|pair| pair[1].from - pair[0].from).collect();
    lengths.sort_unstable();
    (stays.len() >= FEWEST).then(|| lengths[lengths.len() / 2])
}

/// Samples and angles between which the speed is taken as constant; the first and last stay as long as
/// observed.
fn knots(stays: &[Stay], median: usize, count: usize) -> Vec<[f64; 2]> {
    let longest = RESTS * median;
    let mut knots: Vec<[f64; 2]> = Vec::new();
    for pair in stays.windows(2) {
        let [stay, next] = [pair[0], pair[1]];
        knots.push([stay.from as f64, stay.angle]);
        if next.from - stay.from > longest {
            knots.push([(next.from - median) as f64, stay.angle]);
        }
    }
    if let [.., before, last] = stays {
        knots.push([last.from as f64, last.angle]);
        let end = count.saturating_sub(1);
        let seen = end.saturating_sub(last.from);
        let share = if seen > longest {
            0.0
        } else {
            (seen as f64 / median as f64).min(1.0)
        };
        let on = share * (last.angle - before.angle);
        if seen > 0 {
            knots.push([end as f64, last.angle + on]);
        }
    }
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.22;
    const TURNING: f64 = 0.001;

    /// Counts of a wheel that has turned by `turned` [rad] at each sample.
    fn counted(turned: impl Fn(u32) -> f64, samples: u32) -> Vec<f64> {
        let counts = (0..samples).map(|i| (turned(i) / STEP).floor());
        counts.map(|count| count * STEP).collect()
    }

    #[test]
    fn a_wheel_turns_evenly_between_the_steps_of_its_encoder_forward_and_back() {
        for direction in [1.0, -1.0] {
            let turned = |i: u32| direction * (0.07 + TURNING * f64::from(i));
            let counts = counted(turned, 2000);
            for (i, angle) in between_steps(&counts).iter().enumerate() {
                let off = angle - turned(i as u32);
                // Backward an edge is seen at the lower end of its step.
                assert!(
                    (-0.01..=STEP + 0.01).contains(&-off) || off.abs() < STEP + 0.01,
                    "{i}: {off}"
                );
            }
            let smooth = between_steps(&counts);
            let speed = (smooth[1500] - smooth[500]) / 1000.0;
            assert!(
                (speed / (direction * TURNING) - 1.0).abs() < 0.01,
                "{speed}"
            );
        }
    }

    #[test]
    fn a_long_stay_is_a_rest_and_a_gap_stays_one() {
        let turned = |i: u32| TURNING * f64::from(i.min(1000) + i.saturating_sub(3000));
        let mut counts = counted(turned, 4000);
        counts[500..510].fill(f64::NAN);
        let angles = between_steps(&counts);
        assert!(angles[505].is_nan());
        assert_eq!(angles[1300], angles[2500], "{:?}", &angles[1300..2500]);
        assert!(angles[800] < angles[850] && angles[3500] < angles[3550]);
    }

    #[test]
    fn a_fine_encoder_and_one_that_hardly_changes_stay_as_they_are() {
        let fine: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
        assert_eq!(between_steps(&fine), fine);
        assert!(!is_too_coarse(&fine) && !is_too_coarse(&[0.0, 10.0, 20.0]));
        let seldom = counted(|i| TURNING * f64::from(i), 500);
        assert_eq!(between_steps(&seldom), seldom);
        assert!(is_too_coarse(&seldom));
        assert_eq!(between_steps(&[f64::NAN; 3]).len(), 3);
    }
}
