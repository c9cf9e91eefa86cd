//! The class and the ground a window is known to have, to score answers against.

use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::{ClassWindow, Trace};
use serde::Serialize;

/// Source of the reference class of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The simulation saw what its lugs did.
    GroundTruth,
    /// The run's file gives its class.
    RunClass,
    /// The terrain has this class in the paper.
    Terrain,
}

/// A known class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Known {
    /// The class.
    pub class: Wtic,
    /// Its source.
    pub source: Source,
}

/// Least share [-] of the labelled part of a window for its class.
const MOST: f64 = 0.9;
/// Share [-] of a window that truth has to cover.
const COVERED: f64 = 0.5;

/// The reference class from `start` to `end` \[s\] of a run, from its best source: ground truth, otherwise the
/// run's class, otherwise that of its terrain.
///
/// Ground truth has its own windows: it is used if it covers at least half of this window and one class has
/// at least 90 % of that. A window across a border has no reference class.
pub fn known_class(trace: &Trace, [start, end]: [f64; 2]) -> Option<Known> {
    let known = |source| move |class| Known { class, source };
    let truth = true_windows(trace);
    if !truth.is_empty() {
        let class = most(truth, [start, end], |window| window.class);
        return class.map(known(Source::GroundTruth));
    }
    let run = trace.attributes.class.map(known(Source::RunClass));
    let terrain = trace.attributes.terrain;
    run.or_else(|| terrain.map(TerrainLabel::class).map(known(Source::Terrain)))
}

/// The ground from `start` to `end` \[s\] of a run; none where it is not known or changes.
pub fn known_terrain(trace: &Trace, [start, end]: [f64; 2]) -> Option<TerrainLabel> {
    let truth = true_windows(trace);
    most(truth, [start, end], |window| window.terrain).or(trace.attributes.terrain)
}

fn true_windows(trace: &Trace) -> &[ClassWindow] {
    trace
        .truth
        .as_ref()
        .map_or(&[], |truth| &truth.class_windows)
}

/// What most of the time from `start` to `end` [s] was.
fn most<T: PartialEq>(
    windows: &[ClassWindow],
    [start, end]: [f64; 2],
    what: impl Fn(&ClassWindow) -> T,
) -> Option<T> {
    let overlap = |window: &ClassWindow| (window.end.min(end) - window.start.max(start)).max(0.0);
    let covered: f64 = windows.iter().map(overlap).sum();
    if covered < COVERED * (end - start) {
        return None;
    }
    let share = |value: &T| {
        let same = windows.iter().filter(|window| what(window) == *value);
        same.map(overlap).sum::<f64>() / covered
    };
    windows.iter().map(&what).find(|value| share(value) >= MOST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Truth;

    fn trace() -> Trace {
        let window = |start, class, terrain| ClassWindow {
            start,
            end: start + 15.0,
            class,
            terrain,
            lugs: None,
        };
        let class_windows = vec![
            window(0.0, Wtic::Leis, TerrainLabel::Sand),
            window(15.0, Wtic::Alct, TerrainLabel::Hard),
        ];
        Trace {
            truth: Some(Truth {
                class_windows,
                ..Truth::default()
            }),
            ..Trace::default()
        }
    }

    #[test]
    fn truth_counts_in_windows_of_other_lengths_but_not_across_a_border() {
        let class = |time| known_class(&trace(), time).map(|known| known.class);
        assert_eq!(class([5.0, 10.0]), Some(Wtic::Leis));
        assert_eq!(class([14.9, 29.9]), Some(Wtic::Alct));
        assert_eq!(class([10.0, 20.0]), None);
        assert_eq!(
            class([25.0, 40.0]),
            None,
            "truth covers a third of it: too little"
        );
        assert_eq!(
            known_terrain(&trace(), [16.0, 30.0]),
            Some(TerrainLabel::Hard)
        );
    }

    #[test]
    fn the_class_of_a_run_comes_before_that_of_its_terrain() {
        let mut trace = Trace::default();
        assert_eq!(known_class(&trace, [0.0, 1.0]), None);
        trace.attributes.terrain = Some(TerrainLabel::Gravel);
        let known = known_class(&trace, [0.0, 1.0]).unwrap();
        assert_eq!((known.class, known.source), (Wtic::Slct, Source::Terrain));
        trace.attributes.class = Some(Wtic::Alct);
        let known = known_class(&trace, [0.0, 1.0]).unwrap();
        assert_eq!((known.class, known.source), (Wtic::Alct, Source::RunClass));
    }
}
