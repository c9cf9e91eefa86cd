//! A measured run beside what each arm makes of its condition, to be looked at.

use super::arm::Arm;
use super::condition::Case;
use super::end_results::Step;
use super::validation::Variants;
use crate::features::Settings;
use crate::features::reference::Reference;
use crate::gap::Condition;
use crate::gap::stages::{self, VibrationStages};
use crate::quantity::Seed;
use crate::trace::Trace;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Run of the seed that is simulated: the first replicate's ground.
const RUN: u64 = 0;

/// One measured run of a condition, and one simulated run of each arm on one and the same ground,
/// all of the same channels, rates and length.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmTraces {
    /// Which condition.
    pub condition: Condition,
    /// Its first measured run.
    pub measured: Trace,
    /// The scenario as it came; none where it could not be simulated.
    pub as_shipped: Option<Trace>,
    /// With parameters recalibrated; none where that could not be simulated.
    pub recalibrated: Option<Trace>,
    /// With the effect or effects of the answer; none where it names none or they could not be
    /// simulated.
    pub with_effect: Option<Trace>,
}

impl ArmTraces {
    /// Which part of the vibration brings the gap into features and class: between the measured run and that of
    /// each arm, where both have features.
    pub fn stages(&self) -> Vec<(Step, VibrationStages)> {
        let settings = Settings::default();
        let reference = Reference::computed();
        let arms = [
            (Step::AsShipped, &self.as_shipped),
            (Step::Recalibrated, &self.recalibrated),
            (Step::WithEffect, &self.with_effect),
        ];
        let stages = arms.into_iter().filter_map(|(step, made)| {
            let made = made.as_ref()?;
            let stages = stages::vibration(&self.measured, made, settings, &reference).ok()?;
            Some((step, stages))
        });
        stages.collect()
    }

    /// Simulates every arm of a case once; none where the case has no run among those measured.
    pub fn of(case: &Case, measured: &[Trace], variants: &Variants, seed: Seed) -> Option<Self> {
        let first = case.runs.iter().find_map(|run| measured.get(*run))?;
        let shipped = Arm::as_shipped();
        let arms = [
            Some(&shipped),
            Some(&variants.recalibrated),
            variants.with_effect.as_ref(),
        ];
        let mut traces: Vec<Option<Trace>> = arms
            .par_iter()
            .map(|arm| simulated((*arm)?, case, seed))
            .collect();
        Some(Self {
            condition: case.condition.clone(),
            measured: case.cut(first),
            with_effect: traces.pop()?,
            recalibrated: traces.pop()?,
            as_shipped: traces.pop()?,
        })
    }
}

fn simulated(arm: &Arm, case: &Case, seed: Seed) -> Option<Trace> {
    let scenario = arm.scenario(case).ok()?;
    let go_on = &mut |_| ControlFlow::Continue(());
    let trace = scenario.run(seed, RUN, go_on).ok()?;
    Some(case.imitate(&trace))
}
