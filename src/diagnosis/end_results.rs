//! Effect of a gap on the results of the runs: forces, features, recognised class, terrain parameters.
//!
//! A gap of many spreads may leave all of them as they are, and a small one move them. Each step of the
//! simulator is held against the measured runs, condition by condition, fitted to all of them.

use super::arm::Arm;
use super::simulated_runs::SimulatedRuns;
use crate::gap::stages::{self, Stages};
use crate::gap::{Cell, Kappa, Run, Statistic, class_of};
use crate::identification::{Setting, SteadyLoad};
use crate::recognition::confusion::CLASSES;
use crate::statistics::mean;
use crate::trace::unit_of;
use serde::Serialize;

/// Channels whose means are predicted from the terrain parameters.
const MEANS: [&str; 4] = ["drawbar_pull", "driving_torque", "normal_force", "sinkage"];

/// Which simulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// The scenario as it came.
    AsShipped,
    /// With parameters recalibrated.
    Recalibrated,
    /// With the effect or effects of the answer too.
    WithEffect,
}

/// How far simulated end results lie from measured ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EndResults {
    /// Of which simulator.
    pub step: Step,
    /// Errors of steady means.
    pub means: Vec<MeanError>,
    /// Distance of the mean feature vectors \[decades\], a mean over conditions; none without features.
    pub features: Option<f64>,
    /// Share [-] of windows that are recognised as another class, as far as shares of classes show it: a mean
    /// over conditions; none without windows.
    pub class: Option<f64>,
    /// Distance of the identified terrains, and which measured quantity brings it; none where a side's
    /// conditions identify no terrain.
    pub terrain: Option<Stages>,
}

/// Error of a channel's steady mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeanError {
    /// Which channel.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Root mean square over conditions.
    pub error: f64,
    /// How many conditions have it on both sides.
    pub conditions: usize,
}

/// Runs of one condition.
struct Sides<'a> {
    measured: Vec<&'a Run>,
    made: Vec<&'a Run>,
}

impl EndResults {
    /// Of an arm, whose runs are among the answers.
    pub(super) fn of(
        step: Step,
        arm: &Arm,
        measured: &[Vec<Run>],
        simulated: &SimulatedRuns,
    ) -> Self {
        let sides = measured.iter().enumerate();
        let sides = sides.map(|(case, measured)| Sides {
            measured: measured.iter().collect(),
            made: simulated.of(arm, case).collect(),
        });
        let sides: Vec<Sides> = sides.collect();
        Self {
            step,
            means: MEANS.into_iter().filter_map(|c| error(c, &sides)).collect(),
            features: mean(sides.iter().filter_map(features_apart)),
            class: mean(sides.iter().filter_map(classes_apart)),
            terrain: terrain(&sides),
        }
    }
}

/// Mean of what runs read in a cell; none where none reads it.
fn read(runs: &[&Run], channel: &str, statistic: Statistic) -> Option<f64> {
    let cell = Cell::new(channel, statistic);
    let values = runs.iter().filter_map(|run| run.readings.get(&cell));
    mean(values.map(|reading| reading.value))
}

fn error(channel: &'static str, sides: &[Sides]) -> Option<MeanError> {
    let of = |runs: &[&Run]| read(runs, channel, Statistic::SteadyMean);
    let squares = sides.iter().filter_map(|side| {
        let difference = of(&side.made)? - of(&side.measured)?;
        Some(difference * difference)
    });
    let squares: Vec<f64> = squares.collect();
    Some(MeanError {
        channel,
        unit: unit_of(channel)?,
        conditions: squares.len(),
        error: libm::sqrt(mean(squares)?),
    })
}

/// Distance of the mean feature vectors [decades].
fn features_apart(side: &Sides) -> Option<f64> {
    let difference = |kappa| {
        let of = |runs: &[&Run]| read(runs, "acceleration_y", Statistic::Feature(kappa));
        Some(of(&side.made)? - of(&side.measured)?)
    };
    let differences: Option<Vec<f64>> = Kappa::ALL.into_iter().map(difference).collect();
    let square: f64 = differences?.iter().map(|d| d * d).sum();
    Some(libm::sqrt(square))
}

/// Half of what the shares of classes differ by, summed [-].
fn classes_apart(side: &Sides) -> Option<f64> {
    let difference = |class| {
        let of = |runs: &[&Run]| {
            let logit = read(runs, "acceleration_y", Statistic::ClassShare(class))?;
            // As the statistic adds a twentieth to both sides.
            Some(1.1 / (1.0 + libm::exp(-logit)) - 0.05)
        };
        Some((of(&side.made)? - of(&side.measured)?).abs())
    };
    let differences: Option<Vec<f64>> = CLASSES.into_iter().map(difference).collect();
    Some(0.5 * differences?.iter().sum::<f64>())
}

/// The identified terrains, a row a condition with the wheel on the ground.
fn terrain(sides: &[Sides]) -> Option<Stages> {
    let on_ground = |side: &&Sides| {
        let mut measured = side.measured.iter();
        measured.all(|run| !run.attributes.is_lifted())
    };
    let sides: Vec<&Sides> = sides.iter().filter(on_ground).collect();
    let rows = |of: fn(&Sides) -> Option<SteadyLoad>| sides.iter().map(|side| of(side)).collect();
    let measured: Option<Vec<SteadyLoad>> = rows(|side| row(&side.measured));
    let made: Option<Vec<SteadyLoad>> = rows(|side| row(&side.made));
    let first = sides.first()?.measured.first()?;
    let class = class_of(
        &sides
            .iter()
            .flat_map(|s| s.measured.iter().copied())
            .collect::<Vec<_>>(),
    );
    stages::loads(&measured?, &made?, class, &Setting::of(&first.attributes)).ok()
}

fn row(runs: &[&Run]) -> Option<SteadyLoad> {
    let rows = runs.iter().flat_map(|run| run.loads.iter());
    SteadyLoad::mean(rows)
}
