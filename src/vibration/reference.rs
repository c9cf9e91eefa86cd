//! The reference vibration at an accelerometer: a train of velocity jumps.
//!
//! The smooth acceleration between lug changes, [`flat_ground::acceleration`], is below most
//! sensors' noise (7e-4 m/s² at 10 mm/s). At every lug change the wheel comes down on one support
//! and goes up on the next: the vertical velocity jumps, by 2.8 mm/s there, and this is what an
//! accelerometer feels. The paper's `a_y = ω² (C_y - y)` leaves it out.

use super::flat_ground;
use crate::wheel::Wheel;
use libm::floor;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// One change of support on flat hard ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LugChange {
    /// Time \[s\] from the first sample.
    pub time: f64,
    /// Jump of the vertical velocity [m/s], upward: the area under the acceleration's pulse.
    pub velocity_jump: f64,
}

/// Part of the lug angle [-] by which the wheel must pass a lug change before it counts, so that
/// a wheel at rest beside one whose reading trembles makes none.
const HOLD: f64 = 0.05;

/// Steps of the reading on either side of a lug change from which its time and speed are taken.
const STEPS: usize = 32;

/// They reach no farther than this part of the lug angle [-] ...
const REACH: f64 = 0.25;

/// ... and this time [s].
const LONGEST: f64 = 0.5;

/// No wheel angle is as large [rad].
const LARGEST: f64 = 1.0e9;

fn is_reading(angle: f64) -> bool {
    angle.abs() < LARGEST
}

/// The lug changes of a wheel that turned by `angles` \[rad\] on flat hard ground, in their order.
///
/// `angles` are equally spaced at `sample_rate` \[Hz\], grow when driving forward, and are 0 where a
/// lug points straight down, as the simulation's are: an encoder with another zero shifts all
/// changes alike. They may start again at 0 after a full turn: more than half a turn from one sample
/// to the next is the counter's doing, not the wheel's. Samples that are no numbers, or beyond 1e9
/// rad, are passed over. A smooth wheel has no lug changes.
///
/// A multi-lugged wheel's velocity jumps by `2 |ω| (r + l) sin(α/2)`, half-way between lugs. An
/// olig-lugged wheel comes down on its rim between lugs, and jumps twice for every lug, from rim to
/// lug and from lug to rim, by `|ω| (r + l) sin φ` with `cos φ = r / (r + l)`. Jumps are upward
/// whichever way the wheel turns.
///
/// Time and wheel speed `ω` come from a parabola through the readings around the change, by
/// least squares: as many as hold 32 steps of the encoder on either side, within a quarter of
/// the lug angle and half a second. So a 17-bit encoder, whose counts come slower than 2 kHz samples
/// at 10 mm/s, resolves the speed within 1 %, and a continuous angle needs some 30 ms. A turn of less
/// than a twentieth of the lug angle beyond a change and back counts as none.
///
/// # Reference
/// Eq. (5), (9) and their derivatives.
pub fn lug_changes(wheel: &Wheel, angles: &[f64], sample_rate: f64) -> Vec<LugChange> {
    let Some(supports) = Supports::of(wheel) else {
        return Vec::new();
    };
    let jump_per_speed = supports.jump(wheel);
    let record = Record {
        angles,
        sample_rate,
        reach: REACH * supports.lug_angle,
        jump_per_speed,
    };
    let is_number = |sample: &usize| is_reading(angles[*sample]);
    let (Some(first), Some(last)) = (
        (0..angles.len()).find(is_number),
        (0..angles.len()).rfind(is_number),
    ) else {
        return Vec::new();
    };
    let mut changes = Vec::new();
    let mut support = supports.at(angles[first]);
    let mut held = supports.held(support);
    let mut previous = angles[first];
    for sample in (first..=last).filter(is_number) {
        let angle = angles[sample];
        let turned = angle - std::mem::replace(&mut previous, angle);
        if turned.abs() > PI {
            support = supports.at(angle);
            held = supports.held(support);
            continue;
        }
        if angle >= held[0] && angle <= held[1] && sample != last {
            continue;
        }
        // Where the record ends, what was passed counts at once: the next record starts there.
        let hold = if sample == last { 0.0 } else { supports.hold() };
        while angle > supports.end(support) + hold {
            changes.push(record.change(supports.end(support), 1.0, sample));
            support += 1.0;
        }
        while angle < supports.end(support - 1.0) - hold {
            support -= 1.0;
            changes.push(record.change(supports.end(support), -1.0, sample));
        }
        held = supports.held(support);
    }
    changes
}

/// What carries the wheel at which wheel angle. Supports are numbered by whole numbers: lug after
/// lug, or lug, rim, lug on an olig-lugged wheel.
struct Supports {
    lug_angle: f64,
    /// Angle from straight down within which a lug carries the wheel [rad].
    lug_reach: f64,
    rim_between: bool,
}

impl Supports {
    fn of(wheel: &Wheel) -> Option<Self> {
        Some(Self {
            lug_angle: wheel.lug_angle()?,
            lug_reach: flat_ground::support_angle(wheel),
            rim_between: !wheel.is_multi_lugged(),
        })
    }

    /// Velocity jump [m/s] per wheel speed [rad/s].
    fn jump(&self, wheel: &Wheel) -> f64 {
        let sides = if self.rim_between { 1.0 } else { 2.0 };
        sides * flat_ground::takeover_speed(wheel)
    }

    /// The support at a wheel angle [rad].
    fn at(&self, angle: f64) -> f64 {
        let lug = floor(angle / self.lug_angle + 0.5);
        let past = angle - lug * self.lug_angle;
        if !self.rim_between {
            lug
        } else if past > self.lug_reach {
            2.0 * lug + 1.0
        } else if past < -self.lug_reach {
            2.0 * lug - 1.0
        } else {
            2.0 * lug
        }
    }

    /// Wheel angle [rad] at which a support gives the wheel to the next.
    fn end(&self, support: f64) -> f64 {
        if !self.rim_between {
            return (support + 0.5) * self.lug_angle;
        }
        let lug = floor(0.5 * support);
        if support == 2.0 * lug {
            lug * self.lug_angle + self.lug_reach
        } else {
            (lug + 1.0) * self.lug_angle - self.lug_reach
        }
    }

    /// How far [rad] the wheel must pass a change before it counts.
    fn hold(&self) -> f64 {
        let hold = HOLD * self.lug_angle;
        if self.rim_between {
            let rim = self.lug_angle - 2.0 * self.lug_reach;
            hold.min(0.25 * rim).min(0.5 * self.lug_reach)
        } else {
            hold
        }
    }

    /// Range of wheel angle [rad] of a support.
    fn held(&self, support: f64) -> [f64; 2] {
        [
            self.end(support - 1.0) - self.hold(),
            self.end(support) + self.hold(),
        ]
    }
}

/// The recorded wheel angle.
struct Record<'a> {
    angles: &'a [f64],
    sample_rate: f64,
    reach: f64,
    jump_per_speed: f64,
}

impl Record<'_> {
    /// The change at wheel angle `level` [rad], turning in `direction`, passed at `sample`.
    fn change(&self, level: f64, direction: f64, sample: usize) -> LugChange {
        let (place, speed) = self.crossing(level, direction, sample);
        LugChange {
            time: place / self.sample_rate,
            velocity_jump: self.jump_per_speed * speed * self.sample_rate,
        }
    }

    /// Where the angle last reached `level` before `sample`, in samples, and how fast it went [rad
    /// per sample].
    fn crossing(&self, level: f64, direction: f64, sample: usize) -> (f64, f64) {
        let angle = |i: usize| self.angles[i];
        let is_before = |i: &usize| is_reading(angle(*i)) && direction * (angle(*i) - level) <= 0.0;
        let before = (0..sample).rev().find(is_before).unwrap_or(sample);
        let after = (before + 1..sample)
            .find(|i| is_reading(angle(*i)))
            .unwrap_or(sample);
        if before == after {
            return (sample as f64, 0.0);
        }
        let step = (angle(after) - angle(before)) / (after - before) as f64;
        let place = before as f64 + (level - angle(before)) / step;
        let [first, last] = self.nearby(level, before, after);
        let span = (last - first) as f64;
        fit(&self.angles[first..=last], place - first as f64, level)
            .filter(|(shift, speed)| direction * speed > 0.0 && shift.abs() <= span)
            .map_or_else(
                || (place, ((angle(last) - angle(first)) / span).abs()),
                |(shift, speed)| (place + shift, speed.abs()),
            )
    }

    /// First and last sample from which time and speed of a change are taken.
    fn nearby(&self, level: f64, before: usize, after: usize) -> [usize; 2] {
        let longest = (LONGEST * self.sample_rate) as usize;
        let first = self.farthest(level, (before.saturating_sub(longest)..=before).rev());
        let last = self.farthest(level, after..self.angles.len().min(after + longest + 1));
        [first.unwrap_or(before), last.unwrap_or(after)]
    }

    /// The last of these samples up to which the reading made its steps within reach of `level`.
    fn farthest(&self, level: f64, samples: impl Iterator<Item = usize>) -> Option<usize> {
        let mut stepped = None;
        let mut reading = f64::NAN;
        let mut steps = 0;
        for sample in samples {
            let angle = self.angles[sample];
            if is_reading(angle) && (angle - level).abs() > self.reach || steps > STEPS {
                break;
            }
            if angle != reading && is_reading(angle) {
                (reading, stepped) = (angle, Some(sample));
                steps += 1;
            }
        }
        stepped
    }
}

/// How many samples from `place` a parabola through `angles` passes `level`, and its slope there
/// [rad per sample]; `None` for too few samples.
fn fit(angles: &[f64], place: f64, level: f64) -> Option<(f64, f64)> {
    let half = 0.5 * (angles.len() - 1) as f64;
    let mut moments = [0.0; 5];
    let mut sums = Vector3::zeros();
    let mut count = 0;
    for (i, angle) in angles.iter().enumerate().filter(|(_, a)| is_reading(**a)) {
        let u = (i as f64 - place) / half;
        let powers = [1.0, u, u * u, u * u * u, u * u * u * u];
        for (moment, power) in moments.iter_mut().zip(powers) {
            *moment += power;
        }
        sums += (angle - level) * Vector3::new(powers[0], powers[1], powers[2]);
        count += 1;
    }
    if count < 4 {
        return None;
    }
    let [m0, m1, m2, m3, m4] = moments;
    let normal = Matrix3::new(m0, m1, m2, m1, m2, m3, m2, m3, m4);
    let parabola = normal.cholesky()?.solve(&sums);
    let (offset, slope, bend) = (parabola[0], parabola[1], parabola[2]);
    let mut shift = 0.0;
    for _ in 0..3 {
        shift -= (offset + shift * (slope + shift * bend)) / (slope + 2.0 * shift * bend);
    }
    Some((shift * half, (slope + 2.0 * shift * bend) / half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wheel::Lugs;
    use proptest::prelude::*;

    const RATE: f64 = 2000.0;

    fn olig() -> Wheel {
        let lugs = Some(Lugs {
            count: 6,
            height: 0.005,
            thickness: 0.003,
            edge_radius: None,
        });
        Wheel {
            lugs,
            ..Wheel::single_wheel()
        }
    }

    fn sampled(seconds: f64, angle: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..(seconds * RATE) as usize)
            .map(|i| angle(i as f64 / RATE))
            .collect()
    }

    fn counted(angles: &[f64], bits: i32) -> Vec<f64> {
        let step = std::f64::consts::TAU / 2.0_f64.powi(bits);
        angles.iter().map(|a| (a / step).round() * step).collect()
    }

    #[test]
    fn a_multi_lugged_wheel_jumps_half_way_between_lugs_forward_and_in_reverse() {
        let wheel = Wheel::single_wheel();
        let alpha = wheel.lug_angle().unwrap();
        for speed in [0.07, -0.07] {
            let changes = lug_changes(&wheel, &sampled(15.0, |t| speed * t), RATE);
            assert_eq!(changes.len(), 5);
            for (k, change) in changes.iter().enumerate() {
                let time = (k as f64 + 0.5) * alpha / 0.07;
                let jump = 2.0 * 0.07 * 0.155 * (0.5 * alpha).sin();
                assert!((change.time - time).abs() < 1e-9, "{change:?} {time}");
                assert!((change.velocity_jump / jump - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn jumps_sum_to_the_velocity_that_the_smooth_acceleration_takes_away() {
        // Over whole lug passes the vertical velocity comes back to its value.
        for wheel in [Wheel::rover(), olig()] {
            let (alpha, speed) = (wheel.lug_angle().unwrap(), 0.3);
            let seconds = 3.0 * alpha / speed;
            let angle = |t: f64| 0.25 * alpha + speed * t;
            let steps = 60_000;
            let dt = seconds / f64::from(steps);
            let smooth: f64 = (0..steps)
                .map(|i| angle((f64::from(i) + 0.5) * dt))
                .map(|angle| flat_ground::acceleration(&wheel, angle, speed, 0.0) * dt)
                .sum();
            let angles = sampled(seconds, angle);
            let jumps: f64 = lug_changes(&wheel, &angles, RATE)
                .iter()
                .map(|change| change.velocity_jump)
                .sum();
            // The sum over half-steps misses the edges of the supports by up to one step.
            assert!((smooth + jumps).abs() < 1e-3 * jumps, "{smooth} {jumps}");
        }
    }

    #[test]
    fn an_olig_lugged_wheel_jumps_from_rim_to_lug_and_from_lug_to_rim() {
        let wheel = olig();
        let (alpha, speed) = (wheel.lug_angle().unwrap(), 0.2);
        let phi = (0.14_f64 / 0.145).acos();
        let angles = sampled(2.4 * alpha / speed, |t| speed * t);
        let changes = lug_changes(&wheel, &angles, RATE);
        let expected = [
            phi,
            alpha - phi,
            alpha + phi,
            2.0 * alpha - phi,
            2.0 * alpha + phi,
        ];
        assert_eq!(changes.len(), expected.len());
        for (change, angle) in changes.iter().zip(expected) {
            assert!((change.time - angle / speed).abs() < 1e-9);
            let jump = speed * 0.145 * phi.sin();
            assert!((change.velocity_jump / jump - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_wheel_that_speeds_up_is_timed_where_it_passes_not_where_it_would_on_average() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        let changes = lug_changes(&wheel, &sampled(4.0, |t| 0.05 * t * t), RATE);
        for (k, change) in changes.iter().enumerate() {
            let time = ((k as f64 + 0.5) * alpha / 0.05).sqrt();
            assert!((change.time - time).abs() < 1e-9, "{change:?} {time}");
            let jump = 2.0 * 0.1 * time * 0.165 * (0.5 * alpha).sin();
            assert!((change.velocity_jump / jump - 1.0).abs() < 1e-9);
        }
    }

    /// At 3 mm/s a 17-bit encoder steps every 2.5 ms, five samples; speed and time stay
    /// finer than that, where neighbouring samples would give nothing or the fivefold.
    #[test]
    fn a_counting_encoder_gives_speed_within_a_percent_and_time_within_half_a_step() {
        let wheel = Wheel::rover();
        let alpha = wheel.lug_angle().unwrap();
        for (speed, bits, tolerance) in [(0.019, 17, 0.01), (0.07, 17, 0.01), (0.07, 13, 0.03)] {
            let step = std::f64::consts::TAU / 2.0_f64.powi(bits);
            let exact = sampled(60.0, |t| 0.012_345 + speed * t);
            let changes = lug_changes(&wheel, &counted(&exact, bits), RATE);
            assert_eq!(changes.len(), lug_changes(&wheel, &exact, RATE).len());
            for (k, change) in changes.iter().enumerate() {
                let time = ((k as f64 + 0.5) * alpha - 0.012_345) / speed;
                let jump = 2.0 * speed * 0.165 * (0.5 * alpha).sin();
                assert!((change.time - time).abs() < 0.5 * step / speed);
                assert!(
                    (change.velocity_jump / jump - 1.0).abs() < tolerance,
                    "{} bits at {speed}: {}",
                    bits,
                    change.velocity_jump / jump
                );
            }
        }
    }

    #[test]
    fn a_wheel_at_rest_on_a_lug_change_whose_reading_trembles_makes_none() {
        let wheel = Wheel::single_wheel();
        let beside = 0.5 * wheel.lug_angle().unwrap();
        let mut trembling = sampled(2.0, |t| beside + 1e-3 * (900.0 * t).sin());
        trembling.push(beside + 1e-4);
        assert_eq!(lug_changes(&wheel, &trembling, RATE), []);
    }

    #[test]
    fn a_wheel_that_stops_and_goes_back_jumps_at_the_same_angle_twice() {
        let wheel = Wheel::single_wheel();
        let alpha = wheel.lug_angle().unwrap();
        // Passes α/2 at 1 s, turns round at 2 s where it stands at 3/4 α.
        let angle = |t: f64| 0.75 * alpha - 0.25 * alpha * (t - 2.0) * (t - 2.0);
        let changes = lug_changes(&wheel, &sampled(3.5, angle), RATE);
        let times: Vec<f64> = changes.iter().map(|change| change.time).collect();
        assert_eq!(times.len(), 2, "{times:?}");
        assert!((times[0] - 1.0).abs() < 1e-9 && (times[1] - 3.0).abs() < 1e-9);
        assert!(changes.iter().all(|change| change.velocity_jump > 0.0));
    }

    /// Windows of one record together hold the changes of the whole, each once.
    #[test]
    fn a_record_cut_anywhere_has_the_same_changes() {
        let wheel = Wheel::rover();
        let angles = sampled(20.0, |t| 0.11 * t + 0.01 * (3.0 * t).sin());
        let whole = lug_changes(&wheel, &angles, RATE);
        for cut in (1..angles.len()).step_by(61) {
            let (early, late) = angles.split_at(cut);
            let parts =
                lug_changes(&wheel, early, RATE).len() + lug_changes(&wheel, late, RATE).len();
            // A change between the last sample before the cut and the first after it is in neither.
            let lost = whole
                .iter()
                .filter(|change| {
                    change.time * RATE > cut as f64 - 1.0 && change.time * RATE < cut as f64
                })
                .count();
            assert_eq!(parts + lost, whole.len(), "cut at {cut}");
        }
    }

    #[test]
    fn samples_that_are_no_numbers_are_passed_over_and_a_smooth_wheel_has_no_changes() {
        let wheel = Wheel::single_wheel();
        let whole = sampled(4.0, |t| 0.07 * t);
        let mut angles = whole.clone();
        angles[3205..3210].fill(f64::NAN);
        angles[0] = f64::INFINITY;
        let (seen, expected) = (
            lug_changes(&wheel, &angles, RATE),
            lug_changes(&wheel, &whole, RATE),
        );
        assert_eq!(seen.len(), expected.len());
        assert!((seen[0].time - expected[0].time).abs() < 1e-9);
        let smooth = Wheel {
            lugs: None,
            ..wheel
        };
        assert_eq!(lug_changes(&smooth, &whole, RATE), []);
        assert_eq!(lug_changes(&wheel, &[f64::NAN; 4], RATE), []);
        assert_eq!(lug_changes(&wheel, &[], RATE), []);
    }

    #[test]
    fn an_encoder_that_wraps_at_a_full_turn_gives_the_same_changes() {
        let wheel = Wheel::rover();
        let whole = sampled(30.0, |t| 0.5 * t);
        let wrapped: Vec<f64> = whole.iter().map(|a| a.rem_euclid(2.0 * PI)).collect();
        let (seen, expected) = (
            lug_changes(&wheel, &wrapped, RATE),
            lug_changes(&wheel, &whole, RATE),
        );
        assert_eq!(seen.len(), expected.len());
        for (a, b) in seen.iter().zip(&expected) {
            assert!((a.time - b.time).abs() < 1e-9);
            assert!((a.velocity_jump / b.velocity_jump - 1.0).abs() < 1e-6);
        }
    }

    proptest! {
        /// Whatever an encoder writes, changes lie within the record and are numbers.
        #[test]
        fn any_record_ends_in_numbers(
            angles in prop::collection::vec(prop::num::f64::ANY, 0..50),
            scale in 0.0..4.0_f64,
        ) {
            let walk: Vec<f64> = angles.iter().map(|a| scale * (a % 1.0)).collect();
            for wheel in [Wheel::rover(), olig()] {
                for record in [&angles, &walk] {
                    let changes = lug_changes(&wheel, record, RATE);
                    for change in &changes {
                        prop_assert!((0.0..=record.len() as f64 / RATE).contains(&change.time));
                        prop_assert!(change.velocity_jump.is_finite() && change.velocity_jump >= 0.0);
                    }
                }
            }
        }
    }
}
