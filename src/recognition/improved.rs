//! Lug by lug: every lug pass in the window says for itself how the lug met the ground.
//!
//! The wheel angle tells when a lug should strike flat hard ground and how far the velocity would
//! jump ([`lug_passes`](crate::features::lug_passes)). A pass is
//!
//! - *struck*, if there is a pulse near that angle of about that height and quiet elsewhere,
//! - *quiet*, if nothing in it comes near that height,
//! - *irregular* otherwise.
//!
//! Most passes struck make ALCT, most quiet LEIS, any other mixture SLCT: on loose stones pulses come
//! at any angle, and lugs pass that strike nothing. What counts is the share behind the passes
//! seen: its posterior under Jeffreys' prior gives each class its probability, which is the
//! confidence. A window with few lug passes borrows from its neighbourhood until it has four, as far
//! as the record goes.
//!
//! The class is unknown where fewer than two lugs passed, where noise hides what a lug would do,
//! where no class is more likely than not, and where the wheel angle was not measured.

use super::Answer;
use crate::features::lug_passes::{LugPass, lug_passes};
use crate::features::record::Record;
use crate::terrain::class::Wtic;
use statrs::function::beta::beta_reg;
use std::ops::Range;

/// Strike and stray [-] below which a pass is quiet. Lugs in sand reach 0.1 of the pulse on hard
/// ground, which itself reads half as high on a rig as soft as the rover's leg.
const QUIET: f64 = 0.2;
/// Strike [-] from which a lug struck.
const STRUCK: f64 = 0.3;
/// Strike [-] beyond which a lug alone cannot have done it: it fell from another height.
const TOO_HARD: f64 = 4.0;
/// Stray over strike [-] up to which a pass is quiet elsewhere.
const ELSEWHERE: f64 = 0.5;
/// Share of struck passes that makes ALCT [-].
const MOST_STRUCK: f64 = 0.5;
/// Share of quiet passes that makes LEIS [-].
const MOST_QUIET: f64 = 0.6;
/// Lug passes a window should have.
const ENOUGH: usize = 4;
/// Lug passes it must have.
const FEWEST: usize = 2;

/// How the lugs of a window passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Tally {
    struck: usize,
    quiet: usize,
    irregular: usize,
}

/// The class of the samples `window` of a record.
pub fn class(record: &Record, window: Range<usize>) -> Answer {
    if !record.tells_lugs {
        return Answer::unknown("without wheel_angle nothing tells when a lug should strike");
    }
    if let Err(reason) = record.sound(window.clone()) {
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
    if let Some(noise) = median(passes.iter().map(|pass| pass.noise)).filter(|noise| *noise > QUIET)
    {
        return Answer::unknown(format!(
            "noise reaches {noise:.2} of the pulse of a lug on hard ground, above {QUIET}"
        ));
    }
    tally(&passes).class()
}

/// The lug passes of a window and, where they are few, of its neighbourhood.
fn evidence(record: &Record, window: Range<usize>) -> Result<Vec<LugPass>, String> {
    let mut reach = window.clone();
    loop {
        let wider = widened(record, &reach, window.len() / 4 + 1);
        let is_widest = wider == reach || record.sound(wider.clone()).is_err();
        // Where the wheel turned by less, there cannot be enough: nothing to measure yet.
        if is_widest || record.lug_passes(&reach) >= ENOUGH as f64 {
            let passes = lug_passes(record, reach);
            let enough = matches!(&passes, Ok(passes) if passes.len() >= ENOUGH);
            if enough || is_widest {
                return passes.map_err(|reason| reason.to_string());
            }
        }
        reach = wider;
    }
}

fn widened(record: &Record, window: &Range<usize>, by: usize) -> Range<usize> {
    window.start.saturating_sub(by)..(window.end + by).min(record.len())
}

fn tally(passes: &[LugPass]) -> Tally {
    let mut tally = Tally::default();
    for LugPass { strike, stray, .. } in passes {
        if *strike < QUIET && *stray < QUIET {
            tally.quiet += 1;
        } else if (STRUCK..TOO_HARD).contains(strike) && *stray < ELSEWHERE * strike {
            tally.struck += 1;
        } else {
            tally.irregular += 1;
        }
    }
    tally
}

impl Tally {
    fn class(self) -> Answer {
        let Self {
            struck,
            quiet,
            irregular,
        } = self;
        let passes = struck + quiet + irregular;
        let alct = more_than(MOST_STRUCK, struck, passes);
        let leis = more_than(MOST_QUIET, quiet, passes);
        let slct = (1.0 - alct - leis).max(0.0);
        let classes = [(Wtic::Alct, alct), (Wtic::Leis, leis), (Wtic::Slct, slct)];
        let best = classes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let (class, confidence) = best.expect("there are three classes");
        let reason = format!(
            "of {passes} lug passes {struck} struck as on hard ground, {quiet} were quiet, {irregular} irregular"
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
