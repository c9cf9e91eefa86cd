//! Ground truth of the simulation: which lug touched, which entered, and the class of every window.
//!
//! A *passage* is a lug's way through the lower half of the wheel. A lug *touched* on its passage
//! when it carried load at any time of it, and *entered* when its edge was in the soil while it
//! did. A passage counts in the window in which the lug was at the bottom.

use super::{AtLimit, ClassWindow, Contact, LugTally, Truth};
use crate::simulation::WheelState;
use crate::terrain::class::{LABELS, TerrainLabel, Wtic};
use crate::wheel::Wheel;

/// Time [s] a lug may leave the ground within one contact.
///
/// A rim at 20 mm/s drops its lugs at some 3 mm/s; under its load the wheel is back from such a
/// bounce in 0.6 ms. The next contact of the same lug is seconds away.
const BRIDGE: f64 = 1.0e-3;

/// Share of the passages that makes a class [-].
pub(crate) const MOST: f64 = 0.9;

/// Length \[s\] of a class window in the paper (Section 4.1).
pub const PAPER_WINDOW: f64 = 15.0;

/// Part of the lug angle [-] a wheel must turn back before a lug passes the bottom again.
const TURN_BACK: f64 = 0.25;

/// Writes down the ground truth while a simulation runs.
///
/// A state costs some nanoseconds unless a lug touches, lifts off or passes the bottom.
#[derive(Debug, Clone)]
pub struct TruthRecorder {
    contacts: Contacts,
    passages: Option<Passages>,
    windows: Windows,
    /// States, and those of them with the carriage, and with the motor, at its limit.
    states: u64,
    carriage_limited: u64,
    motor_limited: u64,
}

impl TruthRecorder {
    /// A recorder for `wheel` with class windows of `window` \[s\], see [`PAPER_WINDOW`].
    pub fn new(wheel: &Wheel, window: f64) -> Self {
        Self {
            contacts: Contacts::new(wheel.lug_count()),
            passages: wheel
                .lug_angle()
                .map(|alpha| Passages::new(wheel.lug_count(), alpha)),
            windows: Windows::new(window),
            states: 0,
            carriage_limited: 0,
            motor_limited: 0,
        }
    }

    /// Takes the next state, and what the ground under the axle is called.
    #[inline]
    pub fn push(&mut self, state: &WheelState, terrain: TerrainLabel) {
        self.windows.push(state.time, terrain);
        self.states += 1;
        self.carriage_limited += u64::from(state.at_limits.carriage);
        self.motor_limited += u64::from(state.at_limits.motor);
        let entered = state.lugs_touching & state.lugs_entered;
        if state.lugs_touching != self.contacts.touching
            || entered & !self.contacts.entered_now != 0
        {
            self.contacts.update(state, entered);
        }
        self.contacts.last_time = state.time;
        if let Some(passages) = &mut self.passages {
            passages.touched |= state.lugs_touching;
            passages.entered |= entered;
            if !(passages.low..passages.high).contains(&state.wheel_angle) {
                passages.turn(
                    state.wheel_angle,
                    self.windows.current,
                    &mut self.windows.tally,
                );
            }
        }
    }

    /// The contacts in the order in which they began, and the class windows.
    ///
    /// A window is LEIS when at least 90 % of the lugs that passed the bottom in it entered, else
    /// ALCT when at least 90 % touched, else SLCT. It is UWTIC when no lug passed the bottom (a
    /// smooth wheel, a wheel at rest) or none of those that did touched (a lifted wheel, a wheel
    /// on its rim): lugs then carry no information on the ground. The last window counts when at least
    /// half of it was recorded. Parameters and profile stay empty.
    pub fn finish(mut self) -> Truth {
        if let Some(passages) = &mut self.passages {
            passages.conclude(&mut self.windows.tally);
        }
        let share = |limited: u64| limited as f64 / self.states.max(1) as f64;
        Truth {
            at_limit: AtLimit {
                carriage: share(self.carriage_limited),
                motor: share(self.motor_limited),
            },
            class_windows: self.windows.classify(self.contacts.last_time),
            contacts: self.contacts.finish(),
            ..Truth::default()
        }
    }
}

/// The contacts of all lugs.
#[derive(Debug, Clone)]
struct Contacts {
    /// Lugs that touch now.
    touching: u64,
    /// Of these, the ones that entered since they touched.
    entered_now: u64,
    /// Time of the state before [s].
    last_time: f64,
    /// The contact of each lug that lasts, or ended so lately that it may go on.
    open: Vec<Option<Contact>>,
    done: Vec<Contact>,
}

impl Contacts {
    fn new(lugs: u32) -> Self {
        Self {
            touching: 0,
            entered_now: 0,
            last_time: 0.0,
            open: vec![None; lugs as usize],
            done: Vec::new(),
        }
    }

    #[cold]
    fn update(&mut self, state: &WheelState, entered: u64) {
        let changed = self.touching ^ state.lugs_touching;
        for lug in 0..self.open.len() as u32 {
            let bit = 1 << lug;
            if changed & bit != 0 {
                if state.lugs_touching & bit != 0 {
                    self.touch(lug, state.time);
                } else {
                    self.lift_off(lug);
                }
            }
            if entered & bit != 0
                && let Some(contact) = &mut self.open[lug as usize]
            {
                contact.entered = true;
            }
        }
        self.touching = state.lugs_touching;
        self.entered_now = (self.entered_now & self.touching) | entered;
    }

    fn touch(&mut self, lug: u32, time: f64) {
        let open = &mut self.open[lug as usize];
        match open {
            Some(contact) if time - contact.end <= BRIDGE => {}
            _ => {
                let new = Contact {
                    lug,
                    start: time,
                    end: time,
                    entered: false,
                };
                self.done.extend(open.replace(new));
            }
        }
    }

    fn lift_off(&mut self, lug: u32) {
        if let Some(contact) = &mut self.open[lug as usize] {
            contact.end = self.last_time;
        }
    }

    fn finish(mut self) -> Vec<Contact> {
        for lug in 0..self.open.len() as u32 {
            if self.touching & (1 << lug) != 0 {
                self.lift_off(lug);
            }
        }
        self.done.extend(self.open.into_iter().flatten());
        self.done
            .sort_by(|a, b| a.start.total_cmp(&b.start).then(a.lug.cmp(&b.lug)));
        self.done
    }
}

fn class(tally: LugTally) -> Wtic {
    let most = |n: u32| f64::from(n) >= MOST * f64::from(tally.passed);
    match tally {
        LugTally { passed: 0, .. } | LugTally { touched: 0, .. } => Wtic::Uwtic,
        LugTally { entered, .. } if most(entered) => Wtic::Leis,
        LugTally { touched, .. } if most(touched) => Wtic::Alct,
        _ => Wtic::Slct,
    }
}

/// The lugs on their way through the lower half of the wheel.
///
/// All lugs are at integer multiples of the lug angle when one of them is at the bottom, so one pair of
/// thresholds on the wheel angle determines when a lug enters, passes and leaves.
#[derive(Debug, Clone)]
struct Passages {
    lugs: i64,
    /// Lug angle [rad].
    alpha: f64,
    /// Lug angles from the bottom to where a passage begins and ends.
    reach: i64,
    /// Lug angles turned, rounded down; stays while the wheel turns back a little.
    turned: i64,
    /// The wheel angles [rad] between which no lug passes.
    low: f64,
    high: f64,
    /// Lugs that touched, or entered, since their passage began.
    touched: u64,
    entered: u64,
    /// The window in which each lug was at the bottom, until it has left the lower half.
    passed_in: Vec<Option<usize>>,
}

impl Passages {
    fn new(lugs: u32, alpha: f64) -> Self {
        Self {
            lugs: i64::from(lugs),
            alpha,
            reach: i64::from(lugs / 4).max(1),
            turned: 0,
            low: f64::INFINITY,
            high: f64::INFINITY,
            touched: 0,
            entered: 0,
            passed_in: vec![None; lugs as usize],
        }
    }

    /// Follows the wheel to `angle` [rad] during `window`.
    #[cold]
    fn turn(&mut self, angle: f64, window: usize, tally: &mut [LugTally]) {
        if self.low == f64::INFINITY {
            self.turned = (angle / self.alpha).floor() as i64;
        }
        while angle >= (self.turned + 1) as f64 * self.alpha {
            self.turned += 1;
            self.pass(self.turned, 1, window, tally);
        }
        while angle < (self.turned as f64 - TURN_BACK) * self.alpha {
            self.pass(self.turned, -1, window, tally);
            self.turned -= 1;
        }
        self.low = (self.turned as f64 - TURN_BACK) * self.alpha;
        self.high = (self.turned + 1) as f64 * self.alpha;
    }

    /// Lug number `bottom` passes the bottom, one leaves the lower half and one enters it.
    fn pass(&mut self, bottom: i64, direction: i64, window: usize, tally: &mut [LugTally]) {
        self.leave(bottom - direction * self.reach, tally);
        let entering = self.lug(bottom + direction * self.reach);
        self.touched &= !(1 << entering);
        self.entered &= !(1 << entering);
        let bottom = self.lug(bottom);
        self.passed_in[bottom] = Some(window);
    }

    fn leave(&mut self, lug: i64, tally: &mut [LugTally]) {
        let lug = self.lug(lug);
        if let Some(window) = self.passed_in[lug].take() {
            let tally = &mut tally[window];
            tally.passed += 1;
            tally.touched += (self.touched >> lug & 1) as u32;
            tally.entered += (self.entered >> lug & 1) as u32;
        }
    }

    /// Counts the lugs that passed the bottom and are still in the lower half.
    fn conclude(&mut self, tally: &mut [LugTally]) {
        for lug in 0..self.lugs {
            self.leave(lug, tally);
        }
    }

    fn lug(&self, number: i64) -> usize {
        number.rem_euclid(self.lugs) as usize
    }
}

/// The class windows, one after another from the first state on.
#[derive(Debug, Clone)]
struct Windows {
    /// Length of a window [s].
    length: f64,
    /// Time of the first state [s].
    start: f64,
    /// Number of the window that runs.
    current: usize,
    /// When the next one starts [s].
    next: f64,
    /// States on each terrain in the window that runs.
    states: [u64; LABELS.len()],
    /// What most of each earlier window was on.
    terrain: Vec<TerrainLabel>,
    tally: Vec<LugTally>,
}

impl Windows {
    fn new(length: f64) -> Self {
        Self {
            length,
            start: 0.0,
            current: 0,
            next: f64::NEG_INFINITY,
            states: [0; LABELS.len()],
            terrain: Vec::new(),
            tally: Vec::new(),
        }
    }

    #[inline]
    fn push(&mut self, time: f64, terrain: TerrainLabel) {
        if time >= self.next {
            self.open(time);
        }
        self.states[terrain as usize] += 1;
    }

    #[cold]
    fn open(&mut self, time: f64) {
        if self.tally.is_empty() {
            self.start = time;
        } else {
            self.close();
        }
        self.current = self.tally.len();
        self.tally.push(LugTally::default());
        self.next = self.start + self.tally.len() as f64 * self.length;
    }

    fn close(&mut self) {
        let most = (0..LABELS.len()).rev().max_by_key(|&i| self.states[i]);
        self.terrain.extend(most.map(|i| LABELS[i]));
        self.states = [0; LABELS.len()];
    }

    fn classify(mut self, end: f64) -> Vec<ClassWindow> {
        if !self.tally.is_empty() {
            self.close();
        }
        let windows = self.tally.iter().zip(&self.terrain).enumerate();
        windows
            .map(|(i, (&tally, &terrain))| ClassWindow {
                start: self.start + i as f64 * self.length,
                end: (self.start + (i + 1) as f64 * self.length).min(end),
                class: class(tally),
                terrain,
                lugs: Some(tally),
            })
            .filter(|window| window.end - window.start >= 0.5 * self.length)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rolls `wheel` forward by `turns` in 100 s and records `bits` of lug and position [rad]: (touching,
    /// entered).
    fn roll(wheel: &Wheel, turns: f64, bits: impl Fn(u32, f64) -> (bool, bool)) -> Truth {
        let mut recorder = TruthRecorder::new(wheel, PAPER_WINDOW);
        let steps = 100_000;
        for step in 0..=steps {
            let time = 100.0 * f64::from(step) / f64::from(steps);
            let wheel_angle = turns * std::f64::consts::TAU * time / 100.0 + 0.01;
            let mut state = WheelState {
                time,
                wheel_angle,
                ..WheelState::default()
            };
            for lug in 0..wheel.lug_count() {
                let (touching, entered) = bits(lug, wheel.lug_position(lug, wheel_angle));
                state.lugs_touching |= u64::from(touching) << lug;
                state.lugs_entered |= u64::from(entered) << lug;
            }
            recorder.push(&state, TerrainLabel::Sand);
        }
        recorder.finish()
    }

    fn classes(truth: &Truth) -> Vec<Wtic> {
        truth.class_windows.iter().map(|w| w.class).collect()
    }

    #[test]
    fn ground_that_meets_every_lug_is_alct_some_lugs_slct_soil_that_lets_them_in_leis() {
        let wheel = Wheel::single_wheel();
        let touches = |position: f64| position.abs() < 0.12;
        let all = roll(&wheel, 2.0, |_, p| (touches(p), false));
        assert_eq!(classes(&all), [Wtic::Alct; 7]);
        let some = roll(&wheel, 2.0, |lug, p| (touches(p) && lug % 3 != 0, false));
        assert_eq!(classes(&some), [Wtic::Slct; 7]);
        let soil = roll(&wheel, 2.0, |_, p| (touches(p), p > 0.0 && p < 0.05));
        assert_eq!(classes(&soil), [Wtic::Leis; 7]);
        let reverse = roll(&wheel, -2.0, |_, p| (touches(p), p > 0.0 && p < 0.05));
        assert_eq!(classes(&reverse), [Wtic::Leis; 7]);
    }

    #[test]
    fn a_lug_counts_where_it_was_at_the_bottom_even_if_it_touched_elsewhere() {
        let wheel = Wheel::single_wheel();
        let ahead = roll(&wheel, 2.0, |_, p| (p > 1.0 && p < 1.2, false));
        let behind = roll(&wheel, 2.0, |_, p| (p < -0.5 && p > -0.7, false));
        assert_eq!(classes(&ahead)[3..], [Wtic::Alct; 4]);
        assert_eq!(classes(&behind)[..6], [Wtic::Alct; 6]);
        let above = roll(&wheel, 2.0, |_, p| (p.abs() > 2.0, false));
        assert_eq!(classes(&above)[3..], [Wtic::Uwtic; 4]);
    }

    #[test]
    fn one_lug_in_ten_may_miss_two_may_not() {
        let lugs = crate::wheel::Lugs {
            count: 10,
            height: 0.01,
            thickness: 0.003,
            edge_radius: None,
        };
        let wheel = Wheel {
            lugs: Some(lugs),
            ..Wheel::single_wheel()
        };
        // 100/15 turns in 100 s: each window sees every lug once.
        let turns = 100.0 / 15.0;
        let touches = |p: f64| p.abs() < 0.3;
        let one = roll(&wheel, turns, |lug, p| (touches(p) && lug > 0, false));
        let two = roll(&wheel, turns, |lug, p| (touches(p) && lug > 1, false));
        assert_eq!(classes(&one)[..6], [Wtic::Alct; 6]);
        assert_eq!(classes(&two)[..6], [Wtic::Slct; 6]);
    }

    #[test]
    fn without_a_lug_at_the_bottom_the_class_is_unknown() {
        let smooth = Wheel {
            lugs: None,
            ..Wheel::single_wheel()
        };
        assert_eq!(
            classes(&roll(&smooth, 2.0, |_, _| (true, true))),
            [Wtic::Uwtic; 7]
        );
        let at_rest = roll(&Wheel::single_wheel(), 0.0, |lug, _| (lug == 0, false));
        assert_eq!(classes(&at_rest), [Wtic::Uwtic; 7]);
        let lifted = roll(&Wheel::single_wheel(), 2.0, |_, _| (false, false));
        assert_eq!(classes(&lifted), [Wtic::Uwtic; 7]);
    }

    #[test]
    fn a_wheel_that_trembles_over_a_lug_passes_it_once() {
        let wheel = Wheel::single_wheel();
        let alpha = wheel.lug_angle().unwrap();
        let mut passages = Passages::new(28, alpha);
        let mut tally = [LugTally::default()];
        passages.turn(0.9 * alpha, 0, &mut tally);
        for angle in [1.0, 0.99, 1.001, 0.8, 1.1] {
            passages.turn(angle * alpha, 0, &mut tally);
        }
        passages.conclude(&mut tally);
        assert_eq!(tally[0].passed, 1);
    }

    #[test]
    fn the_last_window_counts_when_half_of_it_was_seen() {
        // 100 s are 6 windows of 15 s and 10 s, two thirds of a seventh.
        let truth = roll(&Wheel::single_wheel(), 1.0, |_, p| (p.abs() < 0.12, false));
        let last = truth.class_windows.last().unwrap();
        assert_eq!((last.start, last.end), (90.0, 100.0));
        let mut recorder = TruthRecorder::new(&Wheel::single_wheel(), 15.0);
        for time in [0.0, 14.0, 15.0, 22.4] {
            let state = WheelState {
                time,
                ..WheelState::default()
            };
            recorder.push(&state, TerrainLabel::Hard);
        }
        assert_eq!(recorder.finish().class_windows.len(), 1);
    }

    #[test]
    fn chatter_below_a_millisecond_is_one_contact_and_entering_is_kept() {
        let mut recorder = TruthRecorder::new(&Wheel::single_wheel(), 15.0);
        let rate = 128_000.0;
        for step in 0..12_800_u32 {
            // Lug 3 touches, off for 0.5 ms, on, off for 5 ms, on to the end.
            let touching = !matches!(step, 0..1_280 | 2_560..2_624 | 6_400..7_040);
            let state = WheelState {
                time: f64::from(step) / rate,
                lugs_touching: u64::from(touching) << 3,
                lugs_entered: u64::from((1_500..1_501).contains(&step)) << 3,
                ..WheelState::default()
            };
            recorder.push(&state, TerrainLabel::Hard);
        }
        let contact = |start: u32, end: u32, entered| Contact {
            lug: 3,
            start: f64::from(start) / rate,
            end: f64::from(end) / rate,
            entered,
        };
        assert_eq!(
            recorder.finish().contacts,
            [contact(1_280, 6_399, true), contact(7_040, 12_799, false)]
        );
    }

    #[test]
    fn a_window_bears_the_terrain_of_most_of_its_time() {
        let mut recorder = TruthRecorder::new(&Wheel::single_wheel(), 10.0);
        for step in 0..300 {
            let state = WheelState {
                time: f64::from(step) * 0.1,
                ..WheelState::default()
            };
            let terrain = match step {
                0..140 => TerrainLabel::Sand,
                140..260 => TerrainLabel::Gravel,
                _ => TerrainLabel::Hard,
            };
            recorder.push(&state, terrain);
        }
        let windows = recorder.finish().class_windows;
        let labels: Vec<_> = windows.iter().map(|w| w.terrain).collect();
        assert_eq!(
            labels,
            [
                TerrainLabel::Sand,
                TerrainLabel::Gravel,
                TerrainLabel::Gravel
            ]
        );
    }
}
