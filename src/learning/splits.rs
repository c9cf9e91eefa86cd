//! Parts to train on, to choose by and to test on, which share nothing that they must not.
//!
//! Windows of one run are alike, runs on one ground are, and so are runs under one condition. A split
//! deals out *groups*, whole:
//!
//! - by **run**: no run is in two parts. What is learnt is tested on other stretches of the same.
//! - by **ground**: no stream of random numbers is in two parts. All that is random in a run comes from
//!   the seed and its stream ([`Seed::rng`]): roughness, stones, noise. Runs of one stream meet one
//!   ground, and on several terrains grounds of the same draws. In a `common` study every repeat is a
//!   stream; in an `independent` one and in a plain data set every run is.
//! - by **condition**: no scenario with its swept values is in two parts.
//! - by **both**: neither a stream nor a condition. Where streams run through all conditions this has
//!   its price: runs whose stream is in one part and whose condition is in another are in none.
//!
//! Every ground-and-class has its share of every part as far as groups allow, and is in all three
//! parts where it alone fills three groups. The parts depend on the seed and the runs only.

use crate::dataset::records::Records;
use crate::quantity::Seed;
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, BTreeSet};

/// A part of a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// To train on.
    Train,
    /// To choose models by.
    Validation,
    /// To test once.
    Test,
}

/// The parts and the shares [-] of the runs that they are to have.
pub const PARTS: [(Part, f64); 3] = [
    (Part::Train, 0.7),
    (Part::Validation, 0.15),
    (Part::Test, 0.15),
];

impl Part {
    /// Its name in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
            Self::Test => "test",
        }
    }
}

/// What is never in two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// A run.
    Run,
    /// A stream of random numbers, so a ground.
    Ground,
    /// A condition.
    Condition,
    /// Neither a stream nor a condition.
    Both,
}

/// Every grouping, in the order of the columns.
pub const GROUPINGS: [Grouping; 4] = [
    Grouping::Run,
    Grouping::Ground,
    Grouping::Condition,
    Grouping::Both,
];

impl Grouping {
    /// The column of its parts.
    pub fn column(self) -> &'static str {
        match self {
            Self::Run => "by_run",
            Self::Ground => "by_ground",
            Self::Condition => "by_condition",
            Self::Both => "by_both",
        }
    }

    /// What its parts do not share.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Run => "train, validation or test; no run in two parts",
            Self::Ground => "train, validation or test; no stream of random numbers in two parts",
            Self::Condition => "train, validation or test; no condition in two parts",
            Self::Both => {
                "train, validation or test; no stream and no condition in two parts; else none"
            }
        }
    }
}

/// A run, as a split has to know it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// Its id.
    pub id: String,
    /// Number of its condition.
    pub condition: u64,
    /// Its stream of random numbers.
    pub stream: u64,
    /// Its ground and class; `mixed` for that of which its windows have several.
    pub stratum: String,
}

/// The runs of a table of windows, see [`DataSet::new`](super::DataSet::new).
pub fn members(windows: &Records) -> Vec<Member> {
    let number = |cell: &str| cell.parse().unwrap_or_default();
    let (runs, conditions) = (windows.column("run"), windows.column("condition"));
    let names = windows.column("terrain").zip(windows.column("class"));
    let mut members: Vec<Member> = Vec::new();
    let mut grounds_and_classes: Vec<[&str; 2]> = Vec::new();
    let rows = runs
        .zip(conditions)
        .zip(windows.column("stream"))
        .zip(names);
    for (((id, condition), stream), (terrain, class)) in rows {
        if members.last().is_none_or(|last| last.id != id) {
            grounds_and_classes.push([terrain, class]);
            members.push(Member {
                id: id.to_owned(),
                condition: number(condition),
                stream: number(stream),
                stratum: String::new(),
            });
        }
        let known = grounds_and_classes.last_mut().into_iter().flatten();
        for (known, here) in known.zip([terrain, class]) {
            *known = if *known == here { here } else { "mixed" };
        }
    }
    for (member, stratum) in members.iter_mut().zip(grounds_and_classes) {
        member.stratum = stratum.join(" ");
    }
    members
}

/// The subset of every run; none for a run excluded by a split by both. `None` where there are fewer groups
/// than subsets.
pub fn split(members: &[Member], grouping: Grouping, seed: Seed) -> Option<Vec<Option<Part>>> {
    let by = |key: &dyn Fn(usize) -> u64, grouping: Grouping| {
        let groups = groups(members, key);
        deal(members, &groups, seed, grouping.column())
    };
    let by_ground = || by(&|run| members[run].stream, Grouping::Ground);
    let by_condition = || by(&|run| members[run].condition, Grouping::Condition);
    let parts = match grouping {
        Grouping::Run => by(&|run| run as u64, Grouping::Run)?,
        Grouping::Ground => by_ground()?,
        Grouping::Condition => by_condition()?,
        Grouping::Both if streams_cross_conditions(members) => {
            let pairs = by_ground()?.into_iter().zip(by_condition()?);
            return Some(pairs.map(|(a, b)| (a == b).then_some(a)).collect());
        }
        Grouping::Both => by_condition()?,
    };
    Some(parts.into_iter().map(Some).collect())
}

/// Whether some stream is drawn from under two conditions.
fn streams_cross_conditions(members: &[Member]) -> bool {
    let pairs: BTreeSet<(u64, u64)> = members.iter().map(|m| (m.stream, m.condition)).collect();
    let streams: BTreeSet<u64> = members.iter().map(|m| m.stream).collect();
    pairs.len() > streams.len()
}

/// The runs of every group, groups in the order of their keys.
fn groups(members: &[Member], key: &dyn Fn(usize) -> u64) -> Vec<Vec<usize>> {
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for run in 0..members.len() {
        groups.entry(key(run)).or_default().push(run);
    }
    groups.into_values().collect()
}

/// Deals groups in random order, each to the part that lacks its strata most; where several do, to
/// that which lacks runs most.
fn deal(members: &[Member], groups: &[Vec<usize>], seed: Seed, stage: &str) -> Option<Vec<Part>> {
    if groups.len() < PARTS.len() {
        return None;
    }
    let mut order: Vec<&Vec<usize>> = groups.iter().collect();
    order.shuffle(&mut seed.rng(&format!("learning.{stage}"), 0));
    let mut hands = PARTS.map(|(_, share)| Hand::of(members, share));
    let mut parts = vec![Part::Train; members.len()];
    for group in order {
        let strata: Vec<&str> = group
            .iter()
            .map(|&run| members[run].stratum.as_str())
            .collect();
        let lacks = hands.each_ref().map(|hand| hand.lack(&strata));
        let more = |a: [f64; 2], b: [f64; 2]| {
            let alike = (a[0] - b[0]).abs() < ALIKE;
            if alike { a[1] > b[1] } else { a[0] > b[0] }
        };
        let most = (1..PARTS.len()).fold(0, |most, part| {
            if more(lacks[part], lacks[most]) {
                part
            } else {
                most
            }
        });
        hands[most].take(&strata);
        for &run in group {
            parts[run] = PARTS[most].0;
        }
    }
    Some(parts)
}

/// Lacks that differ by less are the same up to rounding.
const ALIKE: f64 = 1.0e-9;

/// What a part was dealt, and what it is to have: runs of each stratum.
struct Hand<'m> {
    wanted: BTreeMap<&'m str, f64>,
    held: BTreeMap<&'m str, f64>,
}

impl<'m> Hand<'m> {
    fn of(members: &'m [Member], share: f64) -> Self {
        let mut wanted: BTreeMap<&str, f64> = BTreeMap::new();
        for member in members {
            *wanted.entry(&member.stratum).or_default() += share;
        }
        let held = wanted.keys().map(|&stratum| (stratum, 0.0)).collect();
        Self { wanted, held }
    }

    /// How much is lacking of what these runs are of, and of all runs, over what is wanted [-].
    fn lack(&self, strata: &[&'m str]) -> [f64; 2] {
        let of = |stratum: &&str| 1.0 - self.held[stratum] / self.wanted[stratum];
        let [held, wanted]: [f64; 2] = [&self.held, &self.wanted].map(|runs| runs.values().sum());
        [strata.iter().map(of).sum(), 1.0 - held / wanted]
    }

    fn take(&mut self, strata: &[&'m str]) {
        for stratum in strata {
            *self.held.entry(stratum).or_default() += 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `conditions` x `repeats` runs in the order of a study, on as many grounds as there are strata.
    fn study(conditions: u64, repeats: u64, strata: u64, common: bool) -> Vec<Member> {
        let member = |run: u64| Member {
            id: run.to_string(),
            condition: run / repeats,
            stream: if common { run % repeats } else { run },
            stratum: (run / repeats % strata).to_string(),
        };
        (0..conditions * repeats).map(member).collect()
    }

    /// How many parts have each key.
    fn parts_of(parts: &[Option<Part>], key: impl Fn(usize) -> u64) -> Vec<usize> {
        let mut of: BTreeMap<u64, BTreeSet<Part>> = BTreeMap::new();
        for (run, part) in parts.iter().enumerate() {
            of.entry(key(run)).or_default().extend(*part);
        }
        of.values().map(BTreeSet::len).collect()
    }

    proptest! {
        #[test]
        fn what_a_split_groups_by_is_never_in_two_parts(
            conditions in 3..30u64, repeats in 3..12u64, strata in 1..6u64, common: bool, seed: u64,
        ) {
            let members = study(conditions, repeats, strata, common);
            let split = |grouping| split(&members, grouping, Seed(seed)).unwrap();
            let (ground, condition) = (|run: usize| members[run].stream, |run: usize| members[run].condition);
            prop_assert!(split(Grouping::Run).iter().all(Option::is_some));
            prop_assert!(parts_of(&split(Grouping::Ground), ground).iter().all(|&n| n == 1));
            prop_assert!(parts_of(&split(Grouping::Condition), condition).iter().all(|&n| n == 1));
            let both = split(Grouping::Both);
            prop_assert!(parts_of(&both, ground).iter().all(|&n| n <= 1));
            prop_assert!(parts_of(&both, condition).iter().all(|&n| n <= 1));
            // Every exclusion has a reason.
            prop_assert!(common || both.iter().all(Option::is_some));
        }

        #[test]
        fn every_stratum_of_three_groups_is_in_every_part_and_shares_come_out_right(
            repeats in 3..60u64, strata in 1..6u64, seed: u64,
        ) {
            let members = study(strata, repeats, strata, false);
            let parts = split(&members, Grouping::Run, Seed(seed)).unwrap();
            for stratum in 0..strata {
                let of = |part| (0..members.len())
                    .filter(|&run| members[run].condition == stratum && parts[run] == Some(part))
                    .count() as f64;
                for (part, share) in PARTS {
                    prop_assert!(of(part) >= 1.0);
                    // Dealt one by one to whom lacks most, a part is within a run or so of its share.
                    prop_assert!((of(part) - share * repeats as f64).abs() <= 1.5);
                }
            }
        }
    }

    #[test]
    fn a_crossed_study_pays_for_a_split_by_both_with_runs_in_no_part() {
        let members = study(40, 20, 5, true);
        let both = split(&members, Grouping::Both, Seed(1)).unwrap();
        let kept = both.iter().flatten().count() as f64 / both.len() as f64;
        // 0.7² + 0.15² + 0.15²
        assert!((kept - 0.535).abs() < 0.05, "{kept}");
    }

    #[test]
    fn runs_that_are_alone_of_their_kind_are_dealt_to_all_parts() {
        let members = study(20, 1, 20, false);
        let parts = split(&members, Grouping::Run, Seed(1)).unwrap();
        let count = |part| parts.iter().filter(|&&of| of == Some(part)).count();
        assert_eq!(PARTS.map(|(part, _)| count(part)), [14, 3, 3]);
    }

    #[test]
    fn two_groups_are_no_three_parts() {
        let members = study(2, 10, 1, false);
        assert_eq!(split(&members, Grouping::Condition, Seed(1)), None);
        assert_eq!(split(&members, Grouping::Both, Seed(1)), None);
        assert!(split(&members, Grouping::Run, Seed(1)).is_some());
    }

    #[test]
    fn parts_depend_on_the_seed_and_repeat() {
        let members = study(4, 20, 2, false);
        let of = |seed| split(&members, Grouping::Run, Seed(seed));
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }
}
