//! Recognition lug by lug: first the kind of vibration, then a check of the sensors.
//!
//! The wheel angle's zero, a lag between the loggers, the accelerometer's sign and scale, and the number of
//! lugs are often wrong in a log, and each error changes the class by a method that takes them as given. So
//! the kind of vibration is found first, from properties invariant to all of them:
//!
//! ```text
//! kind           property, independent of the unit                                     where
//! in step        one equal pulse per lug pass at one phase of it, quiet otherwise       flat hard ground
//! continuous     most passes stay below 12 times the background                        soil; nothing touched; dead sensor
//! irregular      impacts of unequal heights in most passes                             loose stones
//! ```
//!
//! `background` is the standard deviation between impacts, 1.4826 times the median absolute deviation. The
//! maximum of a pass is 4 to 8 times that in sand, 28 times and more on hard ground and gravel. Then the
//! requirements of the kind on the sensors are checked against the data:
//!
//! - **ALCT**: in step with the lugs, upward, and of a height `h` in 0.2 to 2 reference pulses: a
//!   soft rig lowers `h`, a restitution `e` raises it to `1 + e < 2`, and a scale off by 9.81 takes all
//!   of that range out of it. The offset of the train is the zero of the wheel angle with the lag
//!   ([`crate::features::rhythm`]). Downward pulses, another height, another period, or one that
//!   drifts, are UWTIC with that reason.
//! - **LEIS**: continuous, most passes quieter than 0.2 pulses, and positive evidence of soil, which silence
//!   is not: ground carries the wheel, the rim is not at lug height above it ([`crate::features::support`]),
//!   and the accelerometer works, that is, shows more than twice its white noise and the bursts of lugs
//!   (kurtosis above 3.6; noise, white or not, stays below 3.5). Without any one of these the confidence is
//!   at most 0.6.
//! - **SLCT**: impacts that fit no train of any number of lugs. The fall of a lug on hard ground is set by
//!   the wheel: on rough slate 9 of 10 are equal within a factor of 1.5, independent of a wrong lug count,
//!   sign, scale or lag. Impacts on stones spread over a factor of thirty, and most passes have some; sand
//!   under pebbles has them in fewer. Without both the confidence is at most 0.6, as it is where a window has
//!   too few lug passes of its own: a rover's leg forced to slip by a tenth on rough slate is excited by its
//!   own friction and strikes as unequally as on stones (`output/reference/rover_on_slate.txt`), and nothing
//!   in the window separates the two.
//!
//! Two other designs were considered. A likelihood for every class and every sensor state needs the heights
//! of pulses on gravel and sand, which differ tenfold between simulators and rigs; the kinds need none, and
//! each rejection has one reason. SLCT as the remainder after trains and silence was tried: a few pulses that
//! fit no train of the stated lugs gave high confidence for hard ground.
//!
//! Decisions are on the proportion behind the sample: the probability that more than 0.6 of the passes are
//! struck, quiet, or loud, or of the impacts equal, is that of the posterior under Jeffreys' prior, without
//! the pass used to fit the offset. A window with few lug passes includes neighbouring windows until it has
//! six, at most two on either side.
//!
//! Limits were set on seeds 9001 and 9002; `output/reference/recognition_faults.txt` lists faults and grounds
//! on another (from `tests/recognition_faults.rs`).

use super::Answer;
use super::alignment::LugOffset;
use crate::features::Extractor;
use crate::features::pulses::Pulses;
use crate::features::record::Record;
use crate::features::rhythm::{MOST, Rhythm, more_than, unequal};
use crate::terrain::class::Wtic;
use std::ops::Range;

/// Loudest acceleration [reference pulses] of a quiet pass. Lugs in sand reach 0.1.
const QUIET: f64 = 0.2;
/// Height [reference pulses] of lugs on hard ground.
const HEIGHT: [f64; 2] = [0.2, 2.0];
/// Peak over background [-] above which a pulse counts as an impact.
const STANDS_OUT: f64 = 12.0;
/// Background over the sensor's noise [-] from which it is vibration.
const ABOVE_NOISE: f64 = 2.0;
/// Kurtosis [-] that noise stays below.
const BURSTS: f64 = 3.6;
/// Probability from which a train of another period is more than chance: four pulses that agree.
const SURE_TRAIN: f64 = 0.8;
/// Confidence without evidence that only this class has.
const DOUBTFUL: f64 = 0.6;
/// Drift of the pulses over its standard error, and shift of the last pulse against the first [periods],
/// above which they are not synchronous.
const DRIFTS: f64 = 4.0;
const OUT_OF_STEP: f64 = 0.12;
/// Lug passes a window should have.
const ENOUGH: usize = 6;
/// How far a window's neighbourhood reaches on either side, in windows.
const NEIGHBOURHOOD: usize = 2;
/// Lug passes it must have.
const FEWEST: usize = 2;

/// What a window shows, its neighbourhood included where its own lug passes are few.
struct Evidence<'r> {
    record: &'r Record,
    pulses: Pulses,
    /// Begin and end [s].
    span: [f64; 2],
    /// Loudest acceleration of each lug pass [reference pulses].
    loudest: Vec<f64>,
    /// Acceleration [reference pulses] above which a pulse counts as an impact.
    stands_out: f64,
    /// Probability that the impacts are of unequal height.
    unequal: f64,
    /// Whether it borrows from the window's neighbourhood.
    borrowed: bool,
}

/// The class of the samples `window` of a record.
pub fn class(extractor: &mut Extractor, record: &Record, window: Range<usize>) -> Answer {
    if let Err(reason) = record.sound(window.clone()) {
        return Answer::unknown(reason);
    }
    if let Err(reason) = record.turns(&window) {
        return Answer::unknown(reason);
    }
    match gathered(extractor, record, window.clone()) {
        Ok((pulses, reach)) => {
            let borrowed = reach != window;
            Evidence::of(record, pulses, reach, borrowed).class()
        }
        Err(reason) => Answer::unknown(reason),
    }
}

/// The impacts of a window and, where its lug passes are few, of its neighbourhood.
fn gathered(
    extractor: &mut Extractor,
    record: &Record,
    window: Range<usize>,
) -> Result<(Pulses, Range<usize>), String> {
    let mut reach = window.clone();
    loop {
        let wider = widened(record, &reach, &window);
        // Where the wheel turned by less, there cannot be enough: nothing to measure yet.
        if wider.is_none() || record.lug_passes(&reach) >= ENOUGH as f64 {
            let found = extractor
                .pulses(record, reach.clone())
                .map_err(|reason| reason.to_string())?;
            let enough = found
                .as_ref()
                .is_some_and(|found| found.passes() >= ENOUGH as f64);
            if enough || wider.is_none() {
                let none = || "the wheel turned too little".to_owned();
                return found.map(|found| (found, reach)).ok_or_else(none);
            }
        }
        reach = wider.unwrap_or(reach);
    }
}

/// A quarter of the window more on both sides, or on the one side that can be used.
fn widened(record: &Record, reach: &Range<usize>, window: &Range<usize>) -> Option<Range<usize>> {
    let by = window.len() / 4 + 1;
    let farthest = NEIGHBOURHOOD * window.len();
    let start = reach.start.saturating_sub(by);
    let start = start.max(window.start.saturating_sub(farthest));
    let end = (reach.end + by)
        .min(window.end + farthest)
        .min(record.len());
    let sides = [start..end, start..reach.end, reach.start..end];
    let usable = |wider: &Range<usize>| {
        wider != reach && record.sound(wider.clone()).is_ok() && record.turns(wider).is_ok()
    };
    sides.into_iter().find(usable)
}

impl<'r> Evidence<'r> {
    fn of(record: &'r Record, pulses: Pulses, reach: Range<usize>, borrowed: bool) -> Self {
        let stands_out = STANDS_OUT * pulses.background;
        Self {
            record,
            span: [record.time(reach.start), record.time(reach.end)],
            loudest: pulses.loudest(),
            stands_out,
            unequal: unequal(&pulses, stands_out),
            borrowed,
            pulses,
        }
    }

    fn class(&self) -> Answer {
        let passes = self.loudest.len();
        if passes < FEWEST {
            return Answer::unknown(format!(
                "{passes} whole lug passes in reach, fewer than {FEWEST}: record longer"
            ));
        }
        let own = Rhythm::own(&self.pulses);
        if let Some(rhythm) = own.filter(|train| self.has(train)) {
            return self.in_step(&rhythm);
        }
        if let Some(reversed) = Rhythm::reversed(&self.pulses).filter(|train| self.has(train)) {
            return Answer::unknown(format!(
                "of {} lug passes {} have a pulse in step with the lugs, but downward: is the sign of acceleration_y wrong?",
                reversed.cells, reversed.struck
            ));
        }
        if self.most_below(self.stands_out) > 0.5 {
            return self.continuous();
        }
        self.irregular(own.map_or(0.0, |own| own.probability))
    }

    /// Whether a train is more likely than not, of impacts that are not unequal.
    fn has(&self, train: &Rhythm) -> bool {
        train.probability > 0.5 && train.height > self.stands_out && self.unequal < DOUBTFUL
    }

    fn passes_below(&self, limit: f64) -> usize {
        self.loudest.iter().filter(|a| **a < limit).count()
    }

    /// Probability that most lug passes stay below `limit` [reference pulses].
    fn most_below(&self, limit: f64) -> f64 {
        more_than(MOST, self.passes_below(limit), self.loudest.len())
    }

    /// Pulses in step with the lugs: hard ground, if they drive the sensor as hard ground does.
    fn in_step(&self, rhythm: &Rhythm) -> Answer {
        let Rhythm {
            cells,
            struck,
            height,
            ..
        } = *rhythm;
        let seen =
            format!("of {cells} lug passes {struck} had an impact synchronous with the lugs");
        let [drift, error] = rhythm.drift;
        let shifted = drift.abs() * cells as f64;
        if drift.abs() > DRIFTS * error && shifted > OUT_OF_STEP {
            return self.other_period(rhythm);
        }
        if !(HEIGHT[0]..=HEIGHT[1]).contains(&height) {
            return Answer::unknown(format!(
                "{seen}, but {height:.2} times as high as on hard ground: is the unit or scale of acceleration_y wrong?"
            ));
        }
        let most = if cells > FEWEST { 1.0 } else { DOUBTFUL };
        let lugs_known = self.record.lugs_known;
        Answer {
            class: Wtic::Alct,
            confidence: rhythm.probability.min(most),
            reason: format!("{seen}, {height:.2} times as high as on rigid ground"),
            offset: lugs_known.then(|| LugOffset::of(rhythm, &self.pulses)),
        }
    }

    /// A train that is not the lugs'.
    fn other_period(&self, train: &Rhythm) -> Answer {
        let period = train.kept_period();
        let lugs = f64::from(self.record.wheel.lug_count()) / period;
        Answer::unknown(format!(
            "pulses come every {period:.3} lug passes, as of {lugs:.1} lugs: is lug_count wrong, or a clock off?"
        ))
    }

    /// No impacts: soil, if the evidence suffices.
    fn continuous(&self) -> Answer {
        let limit = QUIET.min(self.stands_out);
        let leis = self.most_below(limit);
        let seen = format!(
            "of {} lug passes {} had no impact",
            self.loudest.len(),
            self.passes_below(limit)
        );
        if self.record.support.carries(self.span) == Some(false) {
            return Answer::unknown(format!(
                "{seen}, but no force carries the wheel: it is off the ground"
            ));
        }
        if leis <= 0.5 {
            return Answer::unknown(format!(
                "{seen}: noise masks the lugs, or the unit or scale of acceleration_y is wrong"
            ));
        }
        let doubt = self.doubt_of_soil();
        Answer {
            class: Wtic::Leis,
            confidence: doubt.map_or(leis, |_| leis.min(DOUBTFUL)),
            reason: doubt.map_or(seen.clone(), |doubt| format!("{seen}; {doubt}")),
            offset: None,
        }
    }

    /// What evidence of soil is missing, beside silence.
    fn doubt_of_soil(&self) -> Option<&'static str> {
        let Pulses {
            background,
            noise,
            kurtosis,
            ..
        } = self.pulses;
        let support = &self.record.support;
        if background <= ABOVE_NOISE * noise || kurtosis <= BURSTS {
            Some("nothing but noise: is the accelerometer connected?")
        } else if support.carries(self.span).is_none() {
            Some("no normal force over a known load shows that ground carries the wheel")
        } else if support.lugs_are_in_the_ground(self.span) == Some(false) {
            Some("sinkage has the rim above the ground by more than half a lug")
        } else {
            None
        }
    }

    /// Impacts out of step with the lugs, whose train has the probability `in_step`: stones, if they are
    /// unequal and most passes have some.
    fn irregular(&self, in_step: f64) -> Answer {
        let passes = self.loudest.len();
        let loud = passes - self.passes_below(self.stands_out);
        let other = Rhythm::other(&self.pulses);
        let sure = |train: &Rhythm| train.probability > SURE_TRAIN && self.unequal < DOUBTFUL;
        if let Some(train) = other.filter(sure) {
            return self.other_period(&train);
        }
        if self.record.support.carries(self.span) == Some(false) {
            return Answer::unknown(
                "impacts, but no force carries the wheel: it is off the ground",
            );
        }
        let most = if self.borrowed { DOUBTFUL } else { 1.0 };
        let shown = self.unequal.min(more_than(MOST, loud, passes)).min(most);
        let left = 1.0 - in_step.max(self.most_below(self.stands_out));
        let slct = shown.max(left.min(DOUBTFUL));
        Answer {
            class: if slct > 0.5 { Wtic::Slct } else { Wtic::Uwtic },
            confidence: slct,
            reason: format!(
                "impacts in {loud} of {passes} lug passes, without lug period; unequal with probability {:.2}",
                self.unequal
            ),
            offset: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::Settings;
    use crate::features::support::Support;
    use crate::trace::{Channel, RunAttributes, Trace};
    use crate::wheel::Wheel;

    const RATE: f64 = 2000.0;

    /// 20 s of the paper's single wheel at 0.2 rad/s, its velocity jumping at these
    /// (lug pass, multiples of the reference's jump), on ground that else is quiet but for `noise`.
    fn record(jumps: &[(f64, f64)], noise: f64) -> Record {
        let wheel = Wheel::single_wheel();
        let alpha = wheel.lug_angle().unwrap();
        let jump = 0.4 * wheel.tip_radius() * libm::sin(0.5 * alpha);
        let samples = 40_000;
        let mut trembling = 1_u64;
        let mut acceleration: Vec<f64> = (0..samples)
            .map(|_| {
                trembling = trembling
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                noise * ((trembling >> 40) as f64 / f64::from(1 << 23) - 1.0)
            })
            .collect();
        for (place, size) in jumps {
            let sample = (place * alpha / 0.2 * RATE).round() as usize;
            acceleration[sample.min(samples - 1)] += size * jump * RATE;
        }
        let channel = |name: &str, unit: &str, samples| Channel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            sample_rate: RATE,
            start: 0.0,
            samples,
        };
        let angle = (0..samples).map(|i| 0.2 * i as f64 / RATE).collect();
        Record::of(&Trace {
            attributes: RunAttributes {
                wheel_radius: wheel.radius,
                wheel_width: wheel.width,
                lug_count: Some(wheel.lug_count()),
                lug_height: wheel.lug_height(),
                load: 100.0,
                ..RunAttributes::default()
            },
            channels: vec![
                channel("normal_force", "N", vec![100.0; samples]),
                channel("acceleration_y", "m/s^2", acceleration),
                channel("wheel_angle", "rad", angle),
            ],
            ..Trace::default()
        })
        .unwrap()
    }

    fn class_of(record: &Record, window: Range<usize>) -> Answer {
        let mut extractor = Extractor::new(Settings::default()).unwrap();
        class(&mut extractor, record, window)
    }

    fn answer(jumps: &[(f64, f64)], noise: f64) -> Answer {
        let record = record(jumps, noise);
        class_of(&record, 0..record.len())
    }

    /// A jump of `size` at every lug change, shifted by a part of the lug angle.
    fn every_lug(size: f64, shift: f64) -> Vec<(f64, f64)> {
        (0..17)
            .map(|lug| (f64::from(lug) + 0.5 + shift, size))
            .collect()
    }

    #[test]
    fn lugs_that_strike_in_time_and_by_their_height_are_alct_soft_or_hard_rig() {
        for size in [0.5, 1.0, 1.5] {
            let answer = answer(&every_lug(size, 0.05), 1e-3);
            assert_eq!(answer.class, Wtic::Alct, "{size}: {}", answer.reason);
            assert!(answer.confidence > 0.99);
        }
    }

    #[test]
    fn lugs_that_strike_anywhere_in_the_pitch_are_alct_and_their_place_is_the_zero() {
        let alpha = Wheel::single_wheel().lug_angle().unwrap();
        for shift in [-0.45, -0.3, -0.1, 0.2, 0.4] {
            let answer = answer(&every_lug(1.0, shift), 1e-3);
            assert_eq!(answer.class, Wtic::Alct, "{shift}: {}", answer.reason);
            let offset = answer.offset.unwrap();
            let missed = offset.offset_rad - shift * alpha;
            let missed = missed - alpha * (missed / alpha).round();
            assert!(missed.abs() < 0.03 * alpha, "{shift}: {offset:?}");
        }
    }

    #[test]
    fn silence_is_soil_at_most_perhaps_and_not_at_all_where_nothing_carries_the_wheel() {
        let mut record = record(&[], 1e-3);
        let whole = 0..record.len();
        let silent = class_of(&record, whole.clone());
        assert_eq!(silent.class, Wtic::Leis, "{}", silent.reason);
        assert!(silent.confidence <= DOUBTFUL, "{}", silent.confidence);
        record.support = Support::of(&Trace::default());
        let hanging = class_of(&record, whole);
        assert_eq!(hanging.class, Wtic::Uwtic);
        assert!(
            hanging.reason.contains("off the ground"),
            "{}",
            hanging.reason
        );
    }

    #[test]
    fn a_train_of_another_sign_scale_or_period_is_unknown_with_the_reason() {
        let half: Vec<_> = every_lug(1.0, 0.0).into_iter().step_by(2).collect();
        let cases = [
            (every_lug(-1.0, 0.0), "sign"),
            (every_lug(9.81, 0.0), "scale"),
            (every_lug(1.0 / 9.81, 0.0), "scale"),
            (half, "lug_count"),
        ];
        for (jumps, reason) in cases {
            let answer = answer(&jumps, 1e-3);
            assert_eq!(answer.class, Wtic::Uwtic, "{}", answer.reason);
            assert!(answer.reason.contains(reason), "{}", answer.reason);
        }
    }

    #[test]
    fn impacts_at_any_angle_of_any_size_and_sign_are_slct_in_any_unit() {
        let stones: Vec<(f64, f64)> = (0..60_u32)
            .map(|i| {
                let place = f64::from(i * i * 37 % 1700) / 100.0;
                let size = f64::from(i * 13 % 41) / 10.0 - 2.0;
                (place, size)
            })
            .collect();
        for scale in [1.0, -1.0, 9.81, 1.0 / 9.81] {
            let jumps: Vec<_> = stones
                .iter()
                .map(|(at, size)| (*at, scale * size))
                .collect();
            let answer = answer(&jumps, 1e-4);
            assert_eq!(answer.class, Wtic::Slct, "{scale}: {}", answer.reason);
        }
    }

    #[test]
    fn noise_that_masks_a_lug_s_strike_makes_the_class_unknown() {
        let answer = answer(&every_lug(0.05, 0.0), 3.0);
        assert_eq!(answer.class, Wtic::Uwtic);
        assert!(answer.reason.contains("noise masks"), "{}", answer.reason);
    }

    #[test]
    fn a_short_window_borrows_from_its_neighbourhood_and_a_short_record_stays_unknown() {
        let record = record(&every_lug(1.0, 0.0), 1e-3);
        let second = 2000;
        assert_eq!(class_of(&record, 9 * second..10 * second).class, Wtic::Alct);
        let mut short = record.clone();
        short.acceleration.truncate(2 * second);
        short.angle.truncate(2 * second);
        let answer = class_of(&short, 0..2 * second);
        assert_eq!(answer.class, Wtic::Uwtic);
        assert!(answer.reason.contains("record longer"), "{}", answer.reason);
    }

    #[test]
    fn impacts_borrowed_from_the_neighbourhood_are_never_surely_those_of_stones() {
        let stone = |i: u32| (f64::from(i) * 0.37, [0.1, 1.0, 3.0][i as usize % 3]);
        let record = record(&(0..45).map(stone).collect::<Vec<_>>(), 1e-4);
        let whole = class_of(&record, 0..40_000);
        assert_eq!(whole.class, Wtic::Slct, "{}", whole.reason);
        assert!(whole.confidence > 0.8, "{}", whole.confidence);
        let second = 2000;
        let short = class_of(&record, 9 * second..10 * second);
        assert!(short.confidence <= DOUBTFUL, "{}", short.confidence);
    }

    #[test]
    fn a_window_at_rest_is_unknown_though_its_neighbours_drive() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        let rest = record.angle[20_000];
        for angle in &mut record.angle[20_000..] {
            *angle = rest;
        }
        let answer = class_of(&record, 24_000..28_000);
        assert_eq!(
            (answer.class, answer.reason.as_str()),
            (Wtic::Uwtic, "the wheel is at rest")
        );
    }

    #[test]
    fn a_gap_on_one_side_restricts_borrowing_to_the_other_side() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        record.acceleration[17_000] = f64::NAN;
        assert_eq!(class_of(&record, 18_000..22_000).class, Wtic::Alct);
    }

    #[test]
    fn turning_without_a_zero_gives_the_class_and_no_offset() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        record.lugs_known = false;
        let answer = class_of(&record, 0..record.len());
        assert_eq!((answer.class, answer.offset), (Wtic::Alct, None));
    }
}
