//! How far a wheel has turned, by an angle that starts again.
//!
//! An encoder of one turn reads the angle modulo 2π, a counter modulo its range `R`: its register's, or
//! that at which a program sets it to zero. In a record that rolled over, readings fill `R` but
//! for a step, and each roll-over is a step of nearly `R` against the turning:
//!
//! ```text
//! jump = ordinary step − R·sign(turning),   |jump| > (largest reading − least reading) / 2
//! ```
//!
//! No wheel turns through half of all its readings within one sample and against its own motion, again
//! and again by the same amount. Where these jumps differ, or go both ways, the reading only loses whole
//! turns, as one that trembles about its zero does.

use std::f64::consts::{PI, TAU};

/// Share [-] of the span of all readings above which a step is a jump.
const JUMP: f64 = 0.5;

/// Ordinary steps [-] by which jumps of one counter may differ, and its range from whole turns.
const ALIKE: f64 = 4.0;

/// An angle without jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Turning {
    /// Angle \[rad\] since the first reading, plus that reading; what is no number stays so.
    pub angles: Vec<f64>,
    /// The counter's range, where it rolled over at another one than a turn.
    pub roll_over: Option<RollOver>,
    /// Whether the readings resolve the speed; where they lie within one turn and most of their steps do not
    /// resolve it, whole turns may be lost between two of them.
    pub is_resolved: bool,
}

/// A counter that starts again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollOver {
    /// Its range \[rad\].
    pub range: f64,
    /// How often it rolled over.
    pub times: usize,
}

impl Turning {
    /// The angle behind these `readings` \[rad\].
    pub fn of(readings: &[f64]) -> Self {
        let steps = Steps::of(readings);
        let counter = steps.roll_over();
        let resolves = steps.resolve_a_turn();
        let period = match counter {
            Some(counter) => counter.range,
            None if resolves => TAU,
            None => f64::INFINITY,
        };
        let roll_over = counter.filter(|counter| counter.range != TAU);
        Self {
            angles: continuous(readings, period),
            roll_over,
            is_resolved: counter.is_some() || resolves || steps.span > TAU,
        }
    }
}

/// Wheel angles \[rad\] without the jumps of an encoder that starts again after a turn, or of a counter that
/// rolls over at any other angle. What is no number stays so.
pub fn unwrapped(angles: &[f64]) -> Vec<f64> {
    Turning::of(angles).angles
}

/// `readings` less the whole periods in steps of more than half of one.
fn continuous(readings: &[f64], period: f64) -> Vec<f64> {
    let mut offset = 0.0;
    let mut before: Option<f64> = None;
    let mut unwrap = |reading: f64| {
        if !reading.is_finite() {
            return reading;
        }
        let jump = reading - before.replace(reading).unwrap_or(reading);
        if jump.abs() > 0.5 * period {
            offset -= period * (jump / period).round();
        }
        reading + offset
    };
    readings.iter().map(|&reading| unwrap(reading)).collect()
}

/// Steps [rad] between neighbouring samples; none across a gap.
struct Steps {
    steps: Vec<f64>,
    /// Largest less least reading [rad].
    span: f64,
}

impl Steps {
    fn of(readings: &[f64]) -> Self {
        let steps = readings.windows(2).map(|pair| pair[1] - pair[0]);
        let finite = || {
            readings
                .iter()
                .copied()
                .filter(|reading| reading.is_finite())
        };
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        Self {
            steps: steps.filter(|step| step.is_finite()).collect(),
            span: high - low,
        }
    }

    /// Whether most steps are below a quarter of a turn, whole turns left out where all readings lie within
    /// one: with larger steps a lost turn cannot be distinguished from a fast wheel.
    fn resolve_a_turn(&self) -> bool {
        let turns = |step: f64| {
            if self.span <= TAU {
                TAU * (step / TAU).round()
            } else {
                0.0
            }
        };
        let steps = self.steps.iter().map(|&step| step - turns(step));
        let small = steps.filter(|step| step.abs() < 0.5 * PI).count();
        2 * small >= self.steps.len()
    }

    fn is_jump(&self, step: f64) -> bool {
        step.abs() > JUMP * self.span
    }

    /// The roll-over, if every jump is one.
    fn roll_over(&self) -> Option<RollOver> {
        let (jumps, ordinary): (Vec<usize>, Vec<usize>) =
            (0..self.steps.len()).partition(|&i| self.is_jump(self.steps[i]));
        let turning: f64 = ordinary.iter().map(|&i| self.steps[i]).sum();
        let largest = ordinary.iter().map(|&i| self.steps[i].abs());
        let largest = largest.fold(0.0, f64::max);
        let against = jumps.iter().all(|&i| self.steps[i] * turning < 0.0);
        if jumps.is_empty() || !against || ALIKE * largest > self.span {
            return None;
        }
        let mut ranges: Vec<f64> = jumps.iter().map(|&i| self.range_at(i)).collect();
        ranges.sort_by(f64::total_cmp);
        let spread = ranges[ranges.len() - 1] - ranges[0];
        let range = ranges[ranges.len() / 2];
        let turns = TAU * (range / TAU).round().max(1.0);
        let is_whole = (range - turns).abs() <= ALIKE * largest;
        (spread <= ALIKE * largest).then_some(RollOver {
            range: if is_whole { turns } else { range },
            times: jumps.len(),
        })
    }

    /// The range [rad] by the jump at `place`: its size and that of the ordinary steps beside it.
    fn range_at(&self, place: usize) -> f64 {
        let beside = [place.checked_sub(1), Some(place + 1)]
            .into_iter()
            .flatten();
        let steps = beside.filter_map(|i| self.steps.get(i).copied());
        let ordinary: Vec<f64> = steps.filter(|&step| !self.is_jump(step)).collect();
        let step = ordinary.iter().sum::<f64>() / ordinary.len().max(1) as f64;
        (self.steps[place] - step).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 0.03;

    /// A wheel that turns by [`STEP`] a sample, read modulo `range`, from `start` [rad].
    fn read(range: f64, start: f64, direction: f64, count: u32) -> Vec<f64> {
        let turned = |i: u32| start + direction * STEP * f64::from(i);
        (0..count).map(|i| turned(i).rem_euclid(range)).collect()
    }

    fn turned(angles: &[f64]) -> f64 {
        angles[angles.len() - 1] - angles[0]
    }

    #[test]
    fn an_encoder_that_starts_again_after_a_turn_is_made_continuous_over_gaps() {
        for direction in [1.0, -1.0] {
            let mut wrapped = read(TAU, 4.0, direction, 1000);
            wrapped[400..430].fill(f64::NAN);
            let Turning {
                angles, roll_over, ..
            } = Turning::of(&wrapped);
            assert_eq!(roll_over, None);
            for (i, angle) in angles.iter().enumerate().filter(|(_, a)| a.is_finite()) {
                let expected = direction * STEP * i as f64;
                assert!((angle - angles[0] - expected).abs() < 1e-9, "{i}");
            }
            assert!(angles[410].is_nan());
        }
    }

    #[test]
    fn an_encoder_that_trembles_about_its_zero_turns_nowhere() {
        let trembling = (0..100_u32).map(|i| f64::from((i * 7) % 3) * 0.01 - 0.01);
        let wrapped: Vec<f64> = trembling.map(|angle| angle.rem_euclid(TAU)).collect();
        let angles = unwrapped(&wrapped);
        assert!(angles.iter().all(|a| (a - angles[0]).abs() < 0.03));
    }

    #[test]
    fn steps_near_half_a_turn_are_left_as_they_are() {
        let fast: Vec<f64> = (0..50).map(|i| 3.5 * f64::from(i)).collect();
        assert_eq!(unwrapped(&fast), fast);
    }

    #[test]
    fn a_spike_is_no_roll_over() {
        let mut readings = read(100.0, 0.0, 1.0, 100);
        readings[50] = 9.0;
        assert_eq!(Turning::of(&readings).roll_over, None);
    }

    proptest! {
        #[test]
        fn a_counter_that_rolls_over_at_any_angle_is_made_continuous_and_its_range_found(
            range in 0.5..300.0_f64,
            start in 0.0..1.0_f64,
            forward in any::<bool>(),
        ) {
            let direction = if forward { 1.0 } else { -1.0 };
            let count = (2.5 * range / STEP) as u32;
            let Turning { angles, roll_over, .. } = Turning::of(&read(range, start * range, direction, count));
            let expected = direction * STEP * f64::from(count - 1);
            // A range within four steps of whole turns is taken for them.
            let turns = TAU * (range / TAU).round().max(1.0);
            let is_whole = (range - turns).abs() <= ALIKE * STEP * 1.001;
            let tolerance = if is_whole { 3.0 * ALIKE * STEP } else { 1e-6 };
            prop_assert!((turned(&angles) - expected).abs() < tolerance);
            if !is_whole {
                let found = roll_over.unwrap();
                prop_assert!((found.range - range).abs() < 1e-9 && found.times >= 2);
            }
        }

        #[test]
        fn an_angle_that_does_not_start_again_stays_as_it_is(step in -1.5..1.5_f64, count in 2..500_u32) {
            let angles: Vec<f64> = (0..count).map(|i| step * f64::from(i)).collect();
            prop_assert_eq!(unwrapped(&angles), angles);
        }
    }
}
