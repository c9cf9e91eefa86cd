//! Measured runs beside simulated replicates of their conditions.

use super::GapError;
use super::cell::Cell;
use super::condition::{Condition, conditions};
use super::curves;
use super::readings::Readings;
use super::run::Run;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Least number of replicates for an estimate of their spread.
pub const FEWEST_REPLICATES: usize = 3;

/// What a comparison rests on less than it should.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Caveat {
    /// There is one condition: the dependence on the condition is unknown.
    OneCondition,
    /// No condition was measured twice: the spread of measurements is taken for that of the
    /// replicates.
    NoRepeats,
    /// Measured, and not simulated often enough.
    NotSimulated(Vec<Condition>),
    /// Simulated, and not measured.
    NotMeasured(Vec<Condition>),
    /// Read from all measured runs of a condition and not from all replicates.
    OnlyMeasured(Vec<String>),
    /// Read from all replicates of a condition and not from all measured runs.
    OnlySimulated(Vec<String>),
}

impl fmt::Display for Caveat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneCondition => {
                f.write_str("one condition only: how the difference depends on the condition is unknown")
            }
            Self::NoRepeats => f.write_str(
                "no condition was measured twice: the measured scatter is assumed equal to that of simulated repeats",
            ),
            Self::NotSimulated(conditions) => write!(
                f,
                "measured, but with fewer than {FEWEST_REPLICATES} replicates: {}",
                listed(conditions)
            ),
            Self::NotMeasured(conditions) => {
                write!(f, "simulated, but not measured: {}", listed(conditions))
            }
            Self::OnlyMeasured(what) => {
                write!(f, "read from measured runs only: {}", what.join(", "))
            }
            Self::OnlySimulated(what) => {
                write!(f, "read from replicates only: {}", what.join(", "))
            }
        }
    }
}

pub(super) fn listed(conditions: &[Condition]) -> String {
    let texts: Vec<&str> = conditions.iter().map(Condition::as_str).collect();
    texts.join("; ")
}

/// The runs of one condition as rows of numbers, cell by cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Which condition.
    pub condition: Condition,
    /// Cells that every run of it has.
    pub cells: Vec<Cell>,
    /// Mean size of each cell over the replicates, in its unit.
    pub sizes: Vec<f64>,
    /// Measured runs, in the cells' units.
    pub measured: Vec<Vec<f64>>,
    /// Simulated replicates, in the cells' units.
    pub simulated: Vec<Vec<f64>>,
}

/// Measured runs and replicates, condition by condition, and all together as campaigns.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// One table a condition; the last is that of campaigns, where there are enough runs for it.
    pub tables: Vec<Table>,
    /// Caveats on its use.
    pub caveats: Vec<Caveat>,
}

impl Comparison {
    /// Matches measured runs with simulated ones of the same conditions.
    ///
    /// A property is part of the condition only if all runs state it, so that measured runs without terrain
    /// label match simulated ones with it.
    ///
    /// # Errors
    /// `NoOverlap` where no condition was both measured and simulated three times or more, or the
    /// runs of none share a cell: it lists what each side has.
    pub fn new(measured: &[Run], simulated: &[Run]) -> Result<Self, GapError> {
        let attributes: Vec<_> = measured
            .iter()
            .chain(simulated)
            .map(|run| &run.attributes)
            .collect();
        let all = conditions(&attributes);
        let (of_measured, of_simulated) = all.split_at(measured.len());
        let real = grouped(of_measured, measured);
        let made = grouped(of_simulated, simulated);
        let mut sides = Sides::default();
        let mut tables = Vec::new();
        for (condition, runs) in &real {
            match made.get(condition) {
                Some(replicates) if replicates.len() >= FEWEST_REPLICATES => {
                    let table = sides.table(condition, &read(runs), &read(replicates));
                    tables.extend((!table.cells.is_empty()).then_some(table));
                }
                _ => sides.not_simulated.push((*condition).clone()),
            }
        }
        if tables.is_empty() {
            return Err(GapError::NoOverlap {
                measured: describe(&real),
                simulated: describe(&made),
            });
        }
        let without_partner = made
            .keys()
            .filter(|condition| !real.contains_key(*condition));
        sides
            .not_measured
            .extend(without_partner.map(|c| (*c).clone()));
        let compared = tables.len();
        let repeated = tables.iter().any(|table| table.measured.len() > 1);
        tables.extend(
            campaigns(of_measured, measured, &made).and_then(|[real, made]| {
                let table = sides.table(&Condition::campaign(), &refs(&real), &refs(&made));
                (!table.cells.is_empty()).then_some(table)
            }),
        );
        let mut caveats = sides.caveats();
        caveats.extend((compared == 1).then_some(Caveat::OneCondition));
        caveats.extend((!repeated).then_some(Caveat::NoRepeats));
        Ok(Self { tables, caveats })
    }
}

fn refs(readings: &[Readings]) -> Vec<&Readings> {
    readings.iter().collect()
}

fn read<'r>(runs: &[&'r Run]) -> Vec<&'r Readings> {
    runs.iter().map(|run| &run.readings).collect()
}

type Grouped<'r> = BTreeMap<&'r Condition, Vec<&'r Run>>;

fn grouped<'r>(conditions: &'r [Condition], runs: &'r [Run]) -> Grouped<'r> {
    let mut groups = Grouped::new();
    for (condition, run) in conditions.iter().zip(runs) {
        groups.entry(condition).or_default().push(run);
    }
    groups
}

/// Conditions with their numbers of runs, and the channels read, as one side has them.
fn describe(groups: &Grouped) -> String {
    if groups.is_empty() {
        return "no runs".to_owned();
    }
    let runs = groups.values().flatten();
    let channels: BTreeSet<&str> = runs
        .flat_map(|run| run.readings.iter().map(|(cell, _)| &*cell.channel))
        .collect();
    let conditions: Vec<String> = groups
        .iter()
        .map(|(condition, runs)| format!("{condition} ({} runs)", runs.len()))
        .collect();
    let channels: Vec<&str> = channels.into_iter().collect();
    format!("{}, with {}", conditions.join("; "), channels.join(", "))
}

/// Readings over the measured campaign, and over as many simulated ones as the replicates make
/// without using any twice; none where they make too few.
fn campaigns(
    conditions: &[Condition],
    measured: &[Run],
    made: &Grouped,
) -> Option<[Vec<Readings>; 2]> {
    let repeats = |condition: &Condition| conditions.iter().filter(|c| *c == condition).count();
    let usable = |condition: &&Condition| {
        made.get(condition)
            .is_some_and(|runs| runs.len() >= FEWEST_REPLICATES * repeats(condition))
    };
    let places: Vec<usize> = (0..measured.len())
        .filter(|&place| usable(&&conditions[place]))
        .collect();
    let most = places
        .iter()
        .map(|&place| made[&conditions[place]].len() / repeats(&conditions[place]))
        .min()?;
    let real: Vec<&Run> = places.iter().map(|&place| &measured[place]).collect();
    let campaign = |number: usize| {
        let mut used = BTreeMap::<&Condition, usize>::new();
        let runs: Vec<&Run> = places
            .iter()
            .map(|&place| {
                let condition = &conditions[place];
                let next = used.entry(condition).or_insert(number * repeats(condition));
                *next += 1;
                made[condition][*next - 1]
            })
            .collect();
        curves::read(&runs)
    };
    Some([vec![curves::read(&real)], (0..most).map(campaign).collect()])
}

/// What only one side has, gathered on the way.
#[derive(Default)]
struct Sides {
    not_simulated: Vec<Condition>,
    not_measured: Vec<Condition>,
    only_measured: BTreeSet<String>,
    only_simulated: BTreeSet<String>,
}

impl Sides {
    fn table(
        &mut self,
        condition: &Condition,
        measured: &[&Readings],
        simulated: &[&Readings],
    ) -> Table {
        let [real, made] = [measured, simulated].map(shared);
        let named = |cell: &&Cell| format!("{}/{}", cell.channel, cell.domain());
        self.only_measured.extend(real.difference(&made).map(named));
        self.only_simulated
            .extend(made.difference(&real).map(named));
        let cells: Vec<Cell> = real
            .intersection(&made)
            .map(|cell| (*cell).clone())
            .collect();
        let rows = |runs: &[&Readings]| -> Vec<Vec<f64>> {
            runs.iter().map(|run| values(run, &cells)).collect()
        };
        let size = |cell: &Cell| {
            let sizes = simulated.iter().filter_map(|run| run.get(cell));
            sizes.map(|reading| reading.size).sum::<f64>() / simulated.len() as f64
        };
        Table {
            condition: condition.clone(),
            sizes: cells.iter().map(size).collect(),
            measured: rows(measured),
            simulated: rows(simulated),
            cells,
        }
    }

    fn caveats(self) -> Vec<Caveat> {
        let conditions = [
            (self.not_simulated, Caveat::NotSimulated as fn(_) -> _),
            (self.not_measured, Caveat::NotMeasured as fn(_) -> _),
        ];
        let cells = [
            (self.only_measured, Caveat::OnlyMeasured as fn(_) -> _),
            (self.only_simulated, Caveat::OnlySimulated as fn(_) -> _),
        ];
        let mut caveats: Vec<Caveat> = Vec::new();
        for (which, caveat) in conditions {
            caveats.extend((!which.is_empty()).then(|| caveat(which)));
        }
        for (which, caveat) in cells {
            caveats.extend((!which.is_empty()).then(|| caveat(which.into_iter().collect())));
        }
        caveats
    }
}

/// Cells that every one of these runs has.
fn shared<'r>(runs: &[&'r Readings]) -> BTreeSet<&'r Cell> {
    let Some((first, others)) = runs.split_first() else {
        return BTreeSet::new();
    };
    let everywhere = |cell: &&Cell| others.iter().all(|run| run.get(cell).is_some());
    first
        .iter()
        .map(|(cell, _)| cell)
        .filter(everywhere)
        .collect()
}

fn values(run: &Readings, cells: &[Cell]) -> Vec<f64> {
    let readings = cells.iter().filter_map(|cell| run.get(cell));
    readings.map(|reading| reading.value).collect()
}
