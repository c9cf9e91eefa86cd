//! What the features of the windows were: where they lie against their region, and whether they
//! depend on speed.

use crate::recognition::paper::regions;
use crate::statistics::{quantile_linear, sorted, student_quantile};
use crate::study::Study;
use crate::study::cells::Number;
use crate::study::windows::WindowRow;
use serde::Serialize;

/// The features of the windows of one scenario.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeaturesOfScenario {
    /// Which scenario.
    pub scenario: String,
    /// Windows with features.
    pub n: usize,
    /// `p1` to `p4`.
    pub features: [FeatureSpread; 4],
}

/// How one feature spreads over windows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FeatureSpread {
    /// Tenth, fiftieth and ninetieth percentile [-].
    pub percentiles: [f64; 3],
    /// Windows in which it lies within the paper's limits for the ground's class.
    pub within: usize,
    /// How it changes with the logarithm of the speed, where speed was swept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<Slope>,
}

/// A regression line's slope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slope {
    /// Decades of the feature per decade of speed.
    pub value: f64,
    /// Student's 95 % interval.
    pub ci95: [f64; 2],
}

/// The features, scenario by scenario, in the order in which they occur.
pub(super) fn by_scenario(
    study: &Study,
    rows: &[WindowRow],
    keys: &[&str],
) -> Vec<FeaturesOfScenario> {
    let speed = keys.iter().position(|key| key.ends_with(".forward_speed"));
    let lugs: Vec<u32> = (0..study.condition_count())
        .map(|condition| study.scenario_of(condition).wheel.lug_count())
        .collect();
    let mut scenarios: Vec<&str> = Vec::new();
    for row in rows {
        if !scenarios.contains(&row.part(0)) {
            scenarios.push(row.part(0));
        }
    }
    scenarios
        .into_iter()
        .map(|scenario| {
            let of_scenario = rows.iter().filter(|row| row.part(0) == scenario);
            let windows: Vec<Window> = of_scenario
                .filter_map(|row| Window::of(row, lugs[row.place.condition as usize], speed))
                .collect();
            FeaturesOfScenario {
                scenario: scenario.to_owned(),
                n: windows.len(),
                features: std::array::from_fn(|feature| spread(&windows, feature)),
            }
        })
        .collect()
}

/// What counts of a window.
struct Window {
    p: [f64; 4],
    within: [bool; 4],
    log_speed: Option<f64>,
}

impl Window {
    fn of(row: &WindowRow, lugs: u32, speed: Option<usize>) -> Option<Self> {
        let p = Number::all(row.p)?;
        let region = regions(lugs)
            .into_iter()
            .find(|region| Some(region.class) == row.label_class)?;
        let within = std::array::from_fn(|i| {
            let [low, high] = region.limits[i];
            (low..=high).contains(&p[i])
        });
        let speed = speed.and_then(|key| row.part(1 + key).parse::<f64>().ok());
        Some(Self {
            p,
            within,
            log_speed: speed.map(|speed| libm::log10(speed.abs())),
        })
    }
}

fn spread(windows: &[Window], feature: usize) -> FeatureSpread {
    let sorted = sorted(windows.iter().map(|window| window.p[feature]));
    let points: Vec<[f64; 2]> = windows
        .iter()
        .filter_map(|window| Some([window.log_speed?, window.p[feature]]))
        .filter(|point| point[1].is_finite())
        .collect();
    FeatureSpread {
        percentiles: [0.1, 0.5, 0.9].map(|share| quantile_linear(&sorted, share)),
        within: windows
            .iter()
            .filter(|window| window.within[feature])
            .count(),
        slope: slope(&points),
    }
}

/// Slope of the line through `points` by least squares; none without three points at two places.
fn slope(points: &[[f64; 2]]) -> Option<Slope> {
    let n = points.len() as f64;
    let mean = |i: usize| points.iter().map(|point| point[i]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| -> f64 { points.iter().map(|[u, v]| f(u - x, v - y)).sum() };
    let (xx, xy, yy) = (sum(&|u, _| u * u), sum(&|u, v| u * v), sum(&|_, v| v * v));
    if points.len() < 3 || xx < 1.0e-12 {
        return None;
    }
    let value = xy / xx;
    let residual = ((yy - value * xy) / (n - 2.0)).max(0.0);
    let quantile = student_quantile(0.975, n - 2.0);
    let half = quantile * libm::sqrt(residual / xx);
    Some(Slope {
        value,
        ci95: [value - half, value + half],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feature_that_follows_speed_has_its_power_as_slope_and_one_that_does_not_has_none() {
        let noise = [0.01, -0.02, 0.0, 0.02, -0.01, 0.0];
        let points = |power: f64| -> Vec<[f64; 2]> {
            let speeds = [-2.5, -2.0, -1.5, -2.5, -2.0, -1.5];
            let pairs = speeds.iter().zip(noise);
            pairs.map(|(x, noise)| [*x, power * x + noise]).collect()
        };
        let Slope {
            value,
            ci95: [low, high],
        } = slope(&points(-0.8)).unwrap();
        assert!(
            (value + 0.8).abs() < 0.03 && low < -0.8 && high > -0.8,
            "{value}"
        );
        let Slope {
            ci95: [low, high], ..
        } = slope(&points(0.0)).unwrap();
        assert!(low < 0.0 && high > 0.0);
        assert_eq!(slope(&points(1.0)[..2]), None);
        assert_eq!(slope(&[[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]]), None);
    }
}
