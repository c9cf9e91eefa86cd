//! Lug by lug: every lug pass in the window says for itself how the lug met the ground.
//!
//! The wheel angle tells when a lug should strike flat hard ground and how far the velocity would
//! jump ([`lug_passes`](crate::features::lug_passes)). A pass is
//!
//! - *struck*, if there is a pulse near that angle of about that height and quiet elsewhere,
//! - *quiet*, if nothing in it comes near that height,
//! - *irregular* otherwise; *hard*, if a pulse is several times as high.
//!
//! Most passes struck make ALCT, most quiet and none hard LEIS, any other mixture SLCT: on loose
//! stones pulses come at any angle and by any amount, and lugs pass that strike nothing; soil
//! cushions. What counts is the share behind the passes seen: that more than most of them were
//! struck, or quiet, has a probability by the share's posterior under Jeffreys' prior, and SLCT has
//! what these two leave. The largest of the three is the confidence. A window with few lug passes
//! borrows from its neighbourhood until it has six, at most two windows far on either side.
//!
//! The class is unknown where fewer than two lugs passed, where noise hides what a lug would do,
//! where no class is more likely than not, and where the wheel angle was not measured.
//!
//! All limits are shares of the reference's pulse, or of lug passes. They were set by hand, once for
//! all wheels, on runs of each ground with seeds of their own; `tests/feature_choices.rs` shows what
//! lugs do there.

use super::Answer;
use crate::features::lug_passes::{LugPass, lug_passes};
use crate::features::record::Record;
use crate::terrain::class::Wtic;
use statrs::function::beta::beta_reg;
use std::ops::Range;

/// Strike and stray [-] below which a pass is quiet. Lugs in sand reach 0.1 of the pulse on hard
/// ground, which itself reads half as high on a rig as soft as the rover's leg.
const QUIET: f64 = 0.2;
/// Strikes [-] that a lug alone does, on hard ground that rises and falls a little.
const STRUCK: [f64; 2] = [0.35, 2.0];
/// Strike or stray [-] from which a pass is hard: the wheel fell from another height.
const HARD: f64 = 4.0;
/// Stray over strike [-] up to which a pass is quiet elsewhere.
const ELSEWHERE: f64 = 0.5;
/// Share of passes that makes a class [-].
const MOST: f64 = 0.6;
/// Lug passes a window should have.
const ENOUGH: usize = 6;
/// How far a window's neighbourhood reaches on either side, in windows.
const NEIGHBOURHOOD: usize = 2;
/// Lug passes it must have.
const FEWEST: usize = 2;

/// How the lugs of a window passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Tally {
    passes: usize,
    struck: usize,
    quiet: usize,
    hard: usize,
}

/// The class of the samples `window` of a record.
pub fn class(record: &Record, window: Range<usize>) -> Answer {
    if !record.tells_lugs {
        return Answer::unknown("without wheel_angle nothing tells when a lug should strike");
    }
    if let Err(reason) = record.sound(window.clone()) {
        return Answer::unknown(reason);
    }
    if let Err(reason) = record.turns(&window) {
        return Answer::unknown(reason);
    }
    let passes = match evidence(record, window) {
        Ok(passes) => passes,
        Err(reason) => return Answer::unknown(reason),
    };
    if passes.len() < FEWEST {
        return Answer::unknown(format!(
            "{} whole lug passes in reach, fewer than {FEWEST}: record longer",
            passes.len()
        ));
    }
    match hidden(&passes) {
        Some(noise) => Answer::unknown(format!(
            "noise reaches {noise:.2} of the pulse of a lug on hard ground, and nothing stands out of it"
        )),
        None => tally(&passes).class(),
    }
}

/// Three standard deviations of the noise [-], where they pass for quiet and nothing is louder.
fn hidden(passes: &[LugPass]) -> Option<f64> {
    let noise = median(passes.iter().map(|pass| pass.noise))?;
    let loudest = median(passes.iter().map(|pass| pass.strike.max(pass.stray)))?;
    (noise > QUIET && loudest < 2.0 * noise).then_some(noise)
}

/// The lug passes of a window and, where they are few, of its neighbourhood.
fn evidence(record: &Record, window: Range<usize>) -> Result<Vec<LugPass>, String> {
    let mut reach = window.clone();
    loop {
        let wider = widened(record, &reach, &window);
        // Where the wheel turned by less, there cannot be enough: nothing to measure yet.
        if wider.is_none() || record.lug_passes(&reach) >= ENOUGH as f64 {
            let passes = lug_passes(record, reach.clone());
            let enough = matches!(&passes, Ok(passes) if passes.len() >= ENOUGH);
            if enough || wider.is_none() {
                return passes.map_err(|reason| reason.to_string());
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

fn tally(passes: &[LugPass]) -> Tally {
    let mut tally = Tally {
        passes: passes.len(),
        ..Tally::default()
    };
    for LugPass { strike, stray, .. } in passes {
        let loudest = strike.max(*stray);
        let struck = (STRUCK[0]..STRUCK[1]).contains(strike) && *stray < ELSEWHERE * strike;
        tally.struck += usize::from(struck);
        tally.quiet += usize::from(loudest < QUIET);
        tally.hard += usize::from(loudest > HARD);
    }
    tally
}

impl Tally {
    fn class(self) -> Answer {
        let Self {
            passes,
            struck,
            quiet,
            hard,
        } = self;
        let alct = more_than(MOST, struck, passes);
        let leis = if hard == 0 {
            more_than(MOST, quiet, passes)
        } else {
            0.0
        };
        let slct = (1.0 - alct - leis).max(0.0);
        let classes = [(Wtic::Alct, alct), (Wtic::Leis, leis), (Wtic::Slct, slct)];
        let best = classes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let (class, confidence) = best.expect("there are three classes");
        let reason = format!(
            "of {passes} lug passes {struck} struck as on hard ground, {quiet} were quiet, {hard} hard"
        );
        Answer {
            class: if confidence > 0.5 { class } else { Wtic::Uwtic },
            confidence,
            reason,
        }
    }
}

/// Probability that a share exceeds `limit` after `hits` of `trials`, under Jeffreys' prior.
fn more_than(limit: f64, hits: usize, trials: usize) -> f64 {
    1.0 - beta_reg(hits as f64 + 0.5, (trials - hits) as f64 + 0.5, limit)
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
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
                lug_count: wheel.lug_count(),
                lug_height: wheel.lug_height(),
                ..RunAttributes::default()
            },
            channels: vec![
                channel("acceleration_y", "m/s^2", acceleration),
                channel("wheel_angle", "rad", angle),
            ],
            ..Trace::default()
        })
        .unwrap()
    }

    fn answer(jumps: &[(f64, f64)], noise: f64) -> Answer {
        let record = record(jumps, noise);
        class(&record, 0..record.len())
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
    fn quiet_lugs_are_leis_and_one_hard_pulse_rules_soil_out() {
        let mut jumps = every_lug(0.05, 0.0);
        assert_eq!(answer(&jumps, 1e-3).class, Wtic::Leis);
        jumps.push((5.2, 8.0));
        assert_eq!(answer(&jumps, 1e-3).class, Wtic::Slct);
    }

    #[test]
    fn strikes_out_of_time_too_hard_or_missing_are_slct() {
        assert_eq!(answer(&every_lug(1.0, 0.4), 1e-3).class, Wtic::Slct);
        assert_eq!(answer(&every_lug(3.0, 0.0), 1e-3).class, Wtic::Slct);
        let some: Vec<_> = every_lug(1.0, 0.0).into_iter().step_by(2).collect();
        assert_eq!(answer(&some, 1e-3).class, Wtic::Slct);
    }

    #[test]
    fn noise_that_hides_a_lug_s_strike_leaves_the_class_unknown() {
        let answer = answer(&every_lug(0.05, 0.0), 3.0);
        assert_eq!(answer.class, Wtic::Uwtic);
        assert!(
            answer.reason.starts_with("noise reaches"),
            "{}",
            answer.reason
        );
    }

    #[test]
    fn a_short_window_borrows_from_its_neighbourhood_and_a_short_record_stays_unknown() {
        let record = record(&every_lug(1.0, 0.0), 1e-3);
        let second = 2000;
        assert_eq!(class(&record, 9 * second..10 * second).class, Wtic::Alct);
        let mut short = record.clone();
        short.acceleration.truncate(2 * second);
        short.angle.truncate(2 * second);
        let answer = class(&short, 0..2 * second);
        assert_eq!(answer.class, Wtic::Uwtic);
        assert!(answer.reason.contains("record longer"), "{}", answer.reason);
    }

    #[test]
    fn a_window_at_rest_is_unknown_though_its_neighbours_drive() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        let rest = record.angle[20_000];
        for angle in &mut record.angle[20_000..] {
            *angle = rest;
        }
        let answer = class(&record, 24_000..28_000);
        assert_eq!(
            (answer.class, answer.reason.as_str()),
            (Wtic::Uwtic, "the wheel is at rest")
        );
    }

    #[test]
    fn a_gap_on_one_side_leaves_the_other_side_to_borrow_from() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        record.acceleration[17_000] = f64::NAN;
        assert_eq!(class(&record, 18_000..22_000).class, Wtic::Alct);
    }

    #[test]
    fn without_the_angle_of_the_lugs_the_class_is_unknown() {
        let mut record = record(&every_lug(1.0, 0.0), 1e-3);
        record.tells_lugs = false;
        assert_eq!(class(&record, 0..record.len()).class, Wtic::Uwtic);
    }
}
