//! Dependence of the steady means of a campaign on its conditions, and the terrain identified from it.
//!
//! One covariate at a time: runs of both sides have the same conditions, so the other covariates affect both
//! curves equally.

use super::cell::{Cell, Covariate, Statistic};
use super::readings::Readings;
use super::run::Run;
use crate::identification::{Identification, Parameter, Setting};
use crate::terrain::class::Wtic;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Values of a covariate that a parabola takes.
const FOR_CURVATURE: usize = 3;

/// Readings over all runs of a campaign with the wheel on the ground, in their order.
pub(super) fn read(runs: &[&Run]) -> Readings {
    let on_ground = runs.iter().filter(|run| !run.attributes.is_lifted());
    let runs = &on_ground.copied().collect::<Vec<&Run>>()[..];
    let mut readings = Readings::default();
    let steady: BTreeSet<&Cell> = runs
        .iter()
        .flat_map(|run| run.readings.iter().map(|(cell, _)| cell))
        .filter(|cell| cell.statistic == Statistic::SteadyMean)
        .collect();
    for cell in steady {
        let values: Option<Vec<f64>> = runs
            .iter()
            .map(|run| run.readings.get(cell).map(|reading| reading.value))
            .collect();
        for covariate in values.iter().flat_map(|_| Covariate::ALL) {
            let values = values.as_deref().unwrap_or(&[]);
            curve(&cell.channel, covariate, runs, values, &mut readings);
        }
    }
    identified(runs, &mut readings);
    readings
}

/// The value of a covariate in run `place` of a campaign.
fn value(covariate: Covariate, run: &Run, place: usize) -> f64 {
    let command = &run.attributes;
    match covariate {
        Covariate::Slip => command.slip_ratio,
        Covariate::Load => command.load,
        Covariate::Speed => command.speed.abs(),
        Covariate::Run => place as f64,
        Covariate::Direction => command.speed.signum(),
    }
}

fn curve(
    channel: &Arc<str>,
    covariate: Covariate,
    runs: &[&Run],
    values: &[f64],
    readings: &mut Readings,
) {
    let places = runs.iter().enumerate();
    let at: Vec<f64> = places.map(|(i, run)| value(covariate, run, i)).collect();
    let [low, high] = at
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(*x), high.max(*x)]
        });
    // Not finite where a run does not know it.
    if !at.iter().all(|x| x.is_finite()) || high - low <= 1.0e-9 * high.abs() {
        return;
    }
    // From -1 to 1.
    let scaled: Vec<f64> = at
        .iter()
        .map(|x| (2.0 * x - low - high) / (high - low))
        .collect();
    let size = values.iter().map(|y| y.abs()).sum::<f64>() / values.len() as f64;
    if let Some(line) = fitted(&scaled, values, 1) {
        let change = 2.0 * line[1];
        readings.note_of_size(channel, Statistic::Slope(covariate), change, size);
    }
    if distinct(&scaled) >= FOR_CURVATURE
        && let Some(parabola) = fitted(&scaled, values, 2)
    {
        let departure = -parabola[2];
        readings.note_of_size(channel, Statistic::Curvature(covariate), departure, size);
    }
}

fn distinct(values: &[f64]) -> usize {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|a, b| (*a - *b).abs() < 1.0e-6);
    sorted.len()
}

/// Coefficients of the polynomial of this degree nearest to the values.
fn fitted(at: &[f64], values: &[f64], degree: usize) -> Option<DVector<f64>> {
    let power = |row: usize, column: usize| at[row].powi(column as i32);
    let design = DMatrix::from_fn(at.len(), degree + 1, power);
    let svd = design.svd(true, true);
    svd.solve(&DVector::from_column_slice(values), 1.0e-9).ok()
}

/// Terrain parameters from all steady rows at once, as far as the rows allow.
fn identified(runs: &[&Run], readings: &mut Readings) {
    let rows: Vec<_> = runs
        .iter()
        .flat_map(|run| run.loads.iter().copied())
        .collect();
    let Some(first) = runs.first() else {
        return;
    };
    let class = class_of(runs);
    let setting = Setting::of(&first.attributes);
    let estimate = Identification::new(&rows, class, &setting)
        .and_then(|identification| identification.estimate());
    // Too few slips or channels to identify the terrain.
    let Ok(estimate) = estimate else {
        return;
    };
    let terrain: Arc<str> = Arc::from("terrain");
    for parameter in Parameter::ALL {
        let identified = estimate.of(parameter);
        if identified.is_identifiable() {
            let coordinate = parameter.coordinate(identified.value);
            readings.note(&terrain, Statistic::Identified(parameter), coordinate);
        }
    }
    if estimate.degrees_of_freedom > 0 {
        let misfit = estimate.chi_square / estimate.degrees_of_freedom as f64;
        readings.note(&terrain, Statistic::Misfit, 10.0 * libm::log10(misfit));
    }
}

/// The class given by the runs' labels, otherwise soil, where the sinkage decides.
pub(crate) fn class_of(runs: &[&Run]) -> Wtic {
    let labels: BTreeSet<_> = runs.iter().map(|run| run.attributes.terrain).collect();
    match labels.into_iter().collect::<Vec<_>>()[..] {
        [Some(label)] => label.class(),
        _ => Wtic::Leis,
    }
}
