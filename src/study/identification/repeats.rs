//! Every repeat of a group identified alone: how estimates scatter against their intervals.

use super::fit::GroupRows;
use super::own::{holds, own_value};
use super::score::RepeatScore;
use crate::identification::{Estimate, Identified, Parameter, identify};
use crate::statistics::{Share, mean, standard_deviation};
use crate::terrain::class::Wtic;

/// Scores of each free parameter of a class over the repeats; none for fewer than two fits.
pub(super) fn scores(rows: &GroupRows, class: Wtic) -> Vec<RepeatScore> {
    let alone = |repeat: &u32| {
        let loads = rows.loads(class, |row| row.repeat == *repeat);
        identify(&loads, class, &rows.setting).ok()
    };
    let fits: Vec<Estimate> = rows.repeats().iter().filter_map(alone).collect();
    if fits.len() < 2 {
        return Vec::new();
    }
    let free = Parameter::ALL.into_iter().filter(|p| p.is_free(class));
    free.map(|parameter| score(parameter, &fits, own_value(&rows.scenario, parameter)))
        .collect()
}

fn score(parameter: Parameter, fits: &[Estimate], own: Option<f64>) -> RepeatScore {
    let identified: Vec<&Identified> = fits
        .iter()
        .map(|estimate| estimate.of(parameter))
        .filter(|identified| identified.is_identifiable())
        .collect();
    let at: Vec<f64> = identified
        .iter()
        .map(|identified| parameter.coordinate(identified.value))
        .collect();
    let centre = mean(at.iter().copied());
    let share = |value: f64| {
        let covering = identified
            .iter()
            .filter(|identified| holds(identified, value));
        Share::of(covering.count() as u64, identified.len() as u64)
    };
    let halves: Vec<f64> = identified.iter().filter_map(|i| half_width(i)).collect();
    RepeatScore {
        parameter,
        fits: fits.len(),
        identified: identified.len(),
        deviation: standard_deviation(&at),
        half_width: mean(halves),
        holds_mean: centre.and_then(|mean| share(parameter.value(mean))),
        holds_own: own.and_then(share),
    }
}

/// Half of the interval, in the coordinate of the fit.
fn half_width(identified: &Identified) -> Option<f64> {
    let [low, high] = identified.ci95();
    let coordinate = |value: f64| identified.parameter.coordinate(value);
    Some(0.5 * (coordinate(high?) - coordinate(low?)))
}
