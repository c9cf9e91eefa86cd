//! What runs of one wheel contradict together.

use super::doubts::Doubts;
use super::{Finding, Severity, number};
use crate::terrain::class::TerrainLabel;
use crate::trace::{RunAttributes, Trace};

/// Runs from which on they show a trend [-].
const LEAST_RUNS: usize = 3;

/// Least range of slip [-] for a trend of the sinkage.
const LEAST_SLIP: f64 = 0.1;

/// Fall of the sinkage [m] over the slips that is a trend.
const LEAST_FALL: f64 = 1.0e-3;

/// Correlation of sinkage and slip [-] from which it falls with slip: below one in a thousand by chance for
/// five runs.
const FALLS: f64 = -0.9;

/// Steady sinkages of a campaign, as its runs are read.
#[derive(Debug, Default)]
pub struct Sinkages {
    points: Vec<Point>,
}

/// A run's slip and sinkage, and what other runs must share with it to be compared.
#[derive(Debug)]
struct Point {
    run: String,
    condition: Condition,
    slip: f64,
    sinkage: f64,
}

/// Wheel, load and ground.
#[derive(Debug, Clone, PartialEq)]
struct Condition {
    wheel: [f64; 3],
    lugs: Option<u32>,
    load: i64,
    terrain: Option<TerrainLabel>,
}

impl Sinkages {
    /// Adds a measured run; a simulated one has the right sign.
    pub fn add(&mut self, run: &str, trace: &Trace) {
        let RunAttributes {
            wheel_radius,
            wheel_width,
            lug_height,
            lug_count,
            load,
            terrain,
            ..
        } = trace.attributes;
        let known = |x: f64| if x.is_finite() { x } else { -1.0 };
        let slip = trace.slip();
        let Some(sinkage) = trace.steady_mean("sinkage") else {
            return;
        };
        if trace.is_simulated() || !slip.is_finite() || !sinkage.is_finite() {
            return;
        }
        self.points.push(Point {
            run: run.to_owned(),
            condition: Condition {
                wheel: [wheel_radius, wheel_width, lug_height].map(known),
                lugs: lug_count,
                load: known(load).round() as i64,
                terrain,
            },
            slip,
            sinkage,
        });
    }

    /// A finding for each wheel, load and ground on which the sinkage lies below 0 and falls with slip.
    ///
    /// A slipping wheel digs itself in: its sinkage grows. On hard ground it stays where the lugs carry the rim.
    pub fn findings(&self) -> Vec<Finding> {
        let mut conditions: Vec<&Condition> = Vec::new();
        for point in &self.points {
            if !conditions.contains(&&point.condition) {
                conditions.push(&point.condition);
            }
        }
        let of_condition = |condition: &Condition| {
            let points = self
                .points
                .iter()
                .filter(|point| point.condition == *condition);
            trend(&points.collect::<Vec<_>>())
        };
        conditions.into_iter().flat_map(of_condition).collect()
    }
}

/// Doubts the sign of sinkages below 0 that fall with slip.
fn trend(points: &[&Point]) -> Vec<Finding> {
    let Some(first) = points.first().filter(|_| points.len() >= LEAST_RUNS) else {
        return Vec::new();
    };
    let by_slip = |a: &&&Point, b: &&&Point| a.slip.abs().total_cmp(&b.slip.abs());
    let (Some(least), Some(most)) = (points.iter().min_by(by_slip), points.iter().max_by(by_slip))
    else {
        return Vec::new();
    };
    let falls = most.slip.abs() - least.slip.abs() >= LEAST_SLIP
        && least.sinkage - most.sinkage >= LEAST_FALL
        && points.iter().all(|point| point.sinkage < 0.0)
        && correlation(points) <= FALLS;
    if !falls {
        return Vec::new();
    }
    let millimetres = |point: &Point| number(1.0e3 * point.sinkage);
    let seen = format!(
        "of {} runs of this wheel and load lies below 0 and falls from {} to {} mm as slip grows from {} to {}",
        points.len(),
        millimetres(least),
        millimetres(most),
        number(least.slip),
        number(most.slip)
    );
    let mut doubts = Doubts::of(&first.run);
    let guess = "counted upward? Sinkage is above 0 below the surface; change its sign";
    doubts.channel("sinkage", Severity::Warning, &seen, guess);
    doubts.into_findings()
}

/// Correlation [-] of sinkage with the size of slip.
fn correlation(points: &[&Point]) -> f64 {
    let count = points.len() as f64;
    let mean = |of: fn(&Point) -> f64| points.iter().map(|point| of(point)).sum::<f64>() / count;
    let (slip, sinkage) = (mean(|p| p.slip.abs()), mean(|p| p.sinkage));
    let product = |of: &dyn Fn(&Point) -> f64| points.iter().map(|point| of(point)).sum::<f64>();
    let both = product(&|p| (p.slip.abs() - slip) * (p.sinkage - sinkage));
    let slips = product(&|p| (p.slip.abs() - slip).powi(2));
    let sinkages = product(&|p| (p.sinkage - sinkage).powi(2));
    both / (slips * sinkages).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Mean;

    fn campaign(sinkages_mm: &[f64]) -> Sinkages {
        let mut sinkages = Sinkages::default();
        for (i, sinkage) in sinkages_mm.iter().enumerate() {
            let mut trace = Trace::default();
            trace.attributes.slip_ratio = 0.1 * i as f64;
            trace.means.push(Mean {
                name: "sinkage".to_owned(),
                unit: "m".to_owned(),
                value: 1.0e-3 * sinkage,
                sd: f64::NAN,
                n: 0,
            });
            sinkages.add(&format!("run_{i}"), &trace);
        }
        sinkages
    }

    #[test]
    fn a_sinkage_below_zero_that_falls_with_slip_has_a_wrong_sign() {
        let [finding] = &campaign(&[-4.8, -5.6, -7.4, -9.4]).findings()[..] else {
            panic!("one finding")
        };
        let part = "falls from -4.8 to -9.4 mm as slip grows from 0 to 0.3";
        assert!(finding.message.contains(part), "{finding}");
    }

    #[test]
    fn lugs_on_hard_ground_and_a_rim_that_sinks_below_its_lugs_are_sound() {
        for sound in [
            &[-15.0, -15.01, -14.99, -15.02][..],
            &[-9.0, -7.0, -4.0, -1.0],
            &[4.8, 5.6, 7.4],
            &[1.0, -1.0, -2.0, -3.0],
            &[-4.0, -6.0],
        ] {
            assert_eq!(campaign(sound).findings(), [], "{sound:?}");
        }
    }
}
