//! From the answers of a bank to the numbers that a verdict weighs.

use super::arm::Arm;
use super::bank::{Outcome, Request};
use super::condition::Case;
use super::plan::{Plan, Signature, Slope};
use super::responses::{Candidate, Level, Library, Measured, Moved, Responses};
use crate::effects::Stage;
use crate::gap::{Cell, Comparison, Run, Table};
use std::collections::{BTreeMap, BTreeSet};

/// What came of requests, by arm, case and stream.
#[derive(Debug, Default)]
pub(super) struct Answers {
    runs: BTreeMap<(String, usize, u64), Run>,
    /// Reasons by arm.
    failures: BTreeMap<String, BTreeSet<String>>,
}

/// Cells of two runs on the same ground with the same noise.
pub(super) struct Beside {
    pub with: Vec<f64>,
    pub without: Vec<f64>,
}

/// Cases with numbers on both sides, in the order of the cases.
pub(super) struct Gathered {
    pub library: Library,
    pub measured: Vec<Measured>,
    /// Conditions of cases without any cell that both sides have.
    pub without_cells: Vec<String>,
}

impl Answers {
    pub fn add(&mut self, requests: &[Request], outcomes: Vec<Outcome>) {
        for (request, outcome) in requests.iter().zip(outcomes) {
            let arm = request.arm.to_string();
            match outcome {
                Ok(run) => {
                    self.runs.insert((arm, request.case, request.stream), run);
                }
                Err(failure) => {
                    let own = self.failures.entry(arm).or_default();
                    own.insert(failure.to_string());
                }
            }
        }
    }

    /// Why arms have no run: one reason each, and how many others there are.
    pub fn failures(&self) -> impl Iterator<Item = String> {
        self.failures.iter().filter_map(|(arm, reasons)| {
            let first = reasons.first()?;
            Some(match reasons.len() - 1 {
                0 => format!("{arm}: {first}"),
                others => format!("{arm}: {first} ({others} more of the kind)"),
            })
        })
    }

    /// Runs of an arm in a case, by stream.
    pub fn of(&self, arm: &Arm, case: usize) -> impl Iterator<Item = (u64, &Run)> {
        let arm = arm.to_string();
        let from = (arm.clone(), case, 0);
        let runs = self.runs.range(from..=(arm, case, u64::MAX));
        runs.map(|((_, _, stream), run)| (*stream, run))
    }

    /// By stream, cells of a case with an arm and without. A cell that one of them leaves unread
    /// counts as unchanged: nothing tells by how much.
    pub fn beside(&self, arm: &Arm, case: usize, cells: &[Cell]) -> BTreeMap<u64, Beside> {
        let shipped = Arm::as_shipped();
        let runs = self.of(arm, case).filter_map(|(stream, run)| {
            let base = self.get(&shipped, case, stream)?;
            let both = |cell| {
                let [with, without] = [run, base].map(|run| Some(run.readings.get(cell)?.value));
                let known = with.or(without).unwrap_or(0.0);
                match (with, without) {
                    (Some(with), Some(without)) => (with, without),
                    _ => (known, known),
                }
            };
            let (with, without) = cells.iter().map(both).unzip();
            Some((stream, Beside { with, without }))
        });
        runs.collect()
    }

    fn get(&self, arm: &Arm, case: usize, stream: u64) -> Option<&Run> {
        self.runs.get(&(arm.to_string(), case, stream))
    }

    /// The numbers of every case; `measured` are its runs, by case.
    pub fn gather(&self, plan: &Plan, cases: &[Case], measured: &[Vec<Run>]) -> Gathered {
        let mut gathered = Gathered {
            library: Library {
                parameters: plan.slopes.iter().map(name_of_parameter).collect(),
                candidates: plan.signatures.iter().map(candidate).collect(),
                conditions: Vec::new(),
            },
            measured: Vec::new(),
            without_cells: Vec::new(),
        };
        for (number, (case, runs)) in cases.iter().zip(measured).enumerate() {
            let shipped = Arm::as_shipped();
            let replicates = self.of(&shipped, number);
            let replicates: Vec<Run> = replicates.map(|(_, run)| run.clone()).collect();
            let Some(table) = table(runs, &replicates) else {
                gathered.without_cells.push(case.condition.to_string());
                continue;
            };
            let rows = Rows {
                answers: self,
                case: number,
                table: &table,
            };
            gathered
                .library
                .conditions
                .push(rows.responses(plan, case, &table));
            gathered.measured.push(Measured {
                runs: table.measured.clone(),
                days: runs.iter().map(|run| run.attributes.day.clone()).collect(),
            });
        }
        gathered
    }
}

/// Both sides of one condition; none where they have no cell in common.
fn table(measured: &[Run], replicates: &[Run]) -> Option<Table> {
    let comparison = Comparison::new(measured, replicates).ok()?;
    comparison.tables.into_iter().next()
}

fn name_of_parameter(slope: &Slope) -> String {
    slope.parameter.name.to_owned()
}

fn candidate(signature: &Signature) -> Candidate {
    Candidate {
        name: signature.name(),
        seat: *signature.seat,
        of_sensors: signature.effect.stage == Stage::Sensors,
    }
}

/// Rows of numbers of one case.
struct Rows<'a> {
    answers: &'a Answers,
    case: usize,
    table: &'a Table,
}

impl Rows<'_> {
    fn responses(&self, plan: &Plan, case: &Case, table: &Table) -> Responses {
        let attributes = &case.attributes;
        Responses {
            condition: case.condition.clone(),
            covariates: [attributes.slip_ratio, attributes.load, attributes.speed],
            cells: table.cells.clone(),
            sizes: table.sizes.clone(),
            base: table.simulated.clone(),
            parameters: plan.slopes.iter().map(|slope| self.slope(slope)).collect(),
            effects: plan.signatures.iter().map(|it| self.levels(it)).collect(),
        }
    }

    /// Half the way from down to up, and half of what is between it and the middle; or the one way
    /// that could be simulated. A parameter that no stream tells changes nothing.
    fn slope(&self, slope: &Slope) -> Moved {
        let [down, up] = [0, 1].map(|way| self.changes(&slope.arms[way]));
        let streams: BTreeSet<u64> = down.keys().chain(up.keys()).copied().collect();
        let of_stream = |stream: u64| match (down.get(&stream), up.get(&stream)) {
            (Some(down), Some(up)) => {
                let ways = down.iter().zip(up);
                ways.map(|(down, up)| 0.5 * (up - down)).collect()
            }
            (Some(down), None) => down.iter().map(|change| -change).collect(),
            (None, Some(up)) => up.clone(),
            (None, None) => vec![0.0; self.table.cells.len()],
        };
        let bend = |stream: &u64| {
            let ways = down.get(stream)?.iter().zip(up.get(stream)?);
            Some(ways.map(|(down, up)| 0.5 * (up + down)).collect())
        };
        Moved {
            bend: streams.iter().filter_map(bend).collect(),
            slope: match streams.is_empty() {
                true => vec![vec![0.0; self.table.cells.len()]],
                false => streams.iter().copied().map(of_stream).collect(),
            },
        }
    }

    fn levels(&self, signature: &Signature) -> Vec<Level> {
        let levels = signature.magnitudes.iter().zip(&signature.arms);
        let levels = levels.map(|(magnitude, arm)| Level {
            magnitude: *magnitude,
            changes: self.changes(arm).into_values().collect(),
        });
        levels.filter(|level| !level.changes.is_empty()).collect()
    }

    fn changes(&self, arm: &Arm) -> BTreeMap<u64, Vec<f64>> {
        let runs = self.answers.beside(arm, self.case, &self.table.cells);
        let change = |Beside { with, without }: Beside| {
            let cells = with.iter().zip(&without);
            cells.map(|(with, without)| with - without).collect()
        };
        let changes = runs.into_iter();
        changes
            .map(|(stream, runs)| (stream, change(runs)))
            .collect()
    }
}
