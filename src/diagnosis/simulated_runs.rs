//! Runs of scenario variants, by variant, condition and realisation.

use super::arm::Arm;
use super::bank::{Bank, BankError, Outcome, Progress, Request};
use crate::gap::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

/// What came of requests.
#[derive(Debug, Default)]
pub struct SimulatedRuns {
    runs: BTreeMap<(String, usize, u64), Run>,
    /// Reasons by variant.
    failures: BTreeMap<String, BTreeSet<String>>,
}

impl SimulatedRuns {
    /// Simulates these variants in every condition of a cache, each with so many realisations of ground and noise.
    ///
    /// # Errors
    /// Those of [`Bank::readings`].
    pub fn simulate(
        &mut self,
        bank: &Bank,
        arms: &[&Arm],
        realisations: u64,
        progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
    ) -> Result<(), BankError> {
        let conditions = 0..bank.cases().len();
        let of_arm = |arm: &Arm| -> Vec<Request> {
            let requests = conditions.clone().flat_map(|case| {
                (0..realisations).map(move |stream| Request {
                    arm: arm.clone(),
                    case,
                    stream,
                })
            });
            requests.collect()
        };
        let requests: Vec<Request> = arms.iter().flat_map(|arm| of_arm(arm)).collect();
        let outcomes = bank.readings(&requests, progress)?;
        for (request, outcome) in requests.iter().zip(outcomes) {
            self.add(request, outcome);
        }
        Ok(())
    }

    fn add(&mut self, request: &Request, outcome: Outcome) {
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

    /// Why variants have no run: one reason each, and how many others there are.
    pub fn failures(&self) -> impl Iterator<Item = String> {
        self.failures.iter().filter_map(|(arm, reasons)| {
            let first = reasons.first()?;
            Some(match reasons.len() - 1 {
                0 => format!("{arm}: {first}"),
                others => format!("{arm}: {first} ({others} more of the kind)"),
            })
        })
    }

    /// Runs of a variant in a condition, by realisation.
    pub fn of(&self, arm: &Arm, case: usize) -> impl Iterator<Item = &Run> {
        let arm = arm.to_string();
        let from = (arm.clone(), case, 0);
        let runs = self.runs.range(from..=(arm, case, u64::MAX));
        runs.map(|(_, run)| run)
    }
}
