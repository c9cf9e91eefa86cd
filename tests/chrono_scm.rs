//! Pull, torque and sinkage of another simulator's soil by the quadrature, on the soil that it was told and with
//! nothing fitted.
//!
//! Project Chrono's SCM (`tests/data/chrono-scm`) takes the same pressure-sinkage and shear laws point by point on
//! a grid of 4 mm in three dimensions, lugs as they are shaped. Two things differ:
//!
//! - A point of its ground counts the displacement that shears it; Wong and Reece follow a point of the wheel. Under
//!   slip `s` the point of the ground stays longer, and its displacement is larger by about `1/(1 - s)`.
//! - Beyond slip 0.4 the torque of its smooth wheel is above the strength of the soil that it was told:
//!   `T/r > tan φ ∫ σ dA + c A`, which no displacement explains and no law of this soil can meet.
//!
//! Both act on the smooth wheel most, whose shear is far from its strength at small slip.
//!
//! `cargo test --release --test all chrono_scm:: -- --nocapture` prints the table.

use lugwheel::scenario::Scenario;
use lugwheel::soil::Soil;
use lugwheel::soil::wheel_load::{loads, sinkage_at};
use lugwheel::terrain::TerrainSpec;
use lugwheel::wheel::{Lugs, Wheel};
use serde::Deserialize;
use std::path::Path;

/// Thickness of the lugs there [m].
const THICKNESS: f64 = 0.004;

#[derive(Debug, Deserialize)]
struct Row {
    lug_count: u32,
    lug_height_m: f64,
    vertical_load_n: f64,
    slip_ratio: f64,
    drawbar_pull_n: f64,
    driving_torque_nm: f64,
    sinkage_m: f64,
}

fn data(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/chrono-scm")
        .join(name)
}

fn stated() -> (Wheel, Soil) {
    let scenario = Scenario::load(data("smooth_wheel.toml")).unwrap();
    let TerrainSpec::Sand { soil, .. } = &scenario.terrain else {
        panic!("{:?}", scenario.terrain);
    };
    (scenario.wheel, *soil)
}

/// The rows of the wheel with this number of lugs.
fn rows(lug_count: u32) -> Vec<Row> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(data("means.csv"))
        .unwrap();
    let rows = reader.deserialize::<Row>().map(Result::unwrap);
    rows.filter(|row| row.lug_count == lug_count).collect()
}

/// Measured and predicted of one quantity.
#[derive(Default)]
struct Errors {
    missed: f64,
    size: f64,
}

impl Errors {
    fn add(&mut self, predicted: f64, there: f64) {
        self.missed += (predicted - there).abs();
        self.size += there.abs();
    }

    fn percent(&self) -> f64 {
        100.0 * self.missed / self.size
    }
}

/// Mean size of the error over mean size [%] of pull and torque of the wheel with this number of lugs.
fn errors(lug_count: u32) -> [f64; 2] {
    let (smooth, soil) = stated();
    let [mut pull, mut torque] = [Errors::default(), Errors::default()];
    println!(
        "{lug_count} lugs: slip, load [N]; pull [N], torque [N m] and sinkage [mm] there and here"
    );
    for row in rows(lug_count) {
        let wheel = Wheel {
            lugs: (lug_count > 0).then_some(Lugs {
                count: lug_count,
                height: row.lug_height_m,
                thickness: THICKNESS,
                edge_radius: None,
            }),
            ..smooth
        };
        let sinkage = sinkage_at(&wheel, &soil, row.vertical_load_n, row.slip_ratio).unwrap();
        let here = loads(&wheel, &soil, sinkage, row.slip_ratio);
        pull.add(here.drawbar_pull, row.drawbar_pull_n);
        torque.add(here.driving_torque, row.driving_torque_nm);
        println!(
            "  {:.1} {:5.0}   {:6.2} {:6.2}   {:6.2} {:6.2}   {:6.2} {:6.2}",
            row.slip_ratio,
            row.vertical_load_n,
            row.drawbar_pull_n,
            here.drawbar_pull,
            row.driving_torque_nm,
            here.driving_torque,
            1.0e3 * row.sinkage_m,
            1.0e3 * sinkage,
        );
    }
    let errors = [pull.percent(), torque.percent()];
    println!("  pull {:.1} %, torque {:.1} %", errors[0], errors[1]);
    errors
}

/// The smooth wheel at this sinkage [m] and slip [-] with the displacement of a point of the ground,
/// `dj = (r ω - v cos θ) dt` with `dθ = -v dt/(r cos θ)`: load [N], torque over radius [N], and the latter at full
/// strength. Sums of rectangles.
fn of_ground_points(wheel: &Wheel, soil: &Soil, sinkage: f64, slip: f64) -> [f64; 3] {
    const STEPS: u32 = 4000;
    let entry = (1.0 - sinkage / wheel.radius).acos();
    let step = entry / f64::from(STEPS);
    let (mut displacement, mut sums) = (0.0, [0.0; 3]);
    for i in (0..STEPS).rev() {
        let angle = (f64::from(i) + 0.5) * step;
        displacement += wheel.radius * (1.0 / (1.0 - slip) - angle.cos()) * angle.cos() * step;
        let depth = wheel.radius * (angle.cos() - entry.cos());
        let normal = soil.frictional_modulus * depth.powf(soil.sinkage_exponent);
        let strength = soil.cohesion + normal * soil.friction_angle_deg.to_radians().tan();
        let shear = strength * (1.0 - (-displacement / soil.shear_modulus).exp());
        let area = wheel.radius * wheel.width * step;
        sums[0] += area * (normal * angle.cos() + shear * angle.sin());
        sums[1] += area * shear;
        sums[2] += area * strength;
    }
    sums
}

#[test]
fn the_smooth_wheels_torque_is_that_of_ground_points_and_beyond_the_soils_strength_at_great_slip() {
    let (wheel, soil) = stated();
    println!("torque over radius [N] there, of ground points, at full strength");
    for row in rows(0) {
        // Its sinkage hardly depends on slip: 8.0 to 8.4 mm at 100 N.
        let carried = |sinkage| of_ground_points(&wheel, &soil, sinkage, row.slip_ratio);
        let mut ends = [1e-3, 0.05];
        for _ in 0..40 {
            let middle = 0.5 * (ends[0] + ends[1]);
            ends[usize::from(carried(middle)[0] > row.vertical_load_n)] = middle;
        }
        let [_, ground, strength] = carried(ends[0]);
        let there = row.driving_torque_nm / wheel.radius;
        println!(
            "  {:.1} {:5.0}   {there:6.1} {ground:6.1} {strength:6.1}",
            row.slip_ratio, row.vertical_load_n
        );
        if (0.05..0.35).contains(&row.slip_ratio) {
            assert!(
                (ground / there - 1.0).abs() < 0.1,
                "{row:?}: {ground}, not {there}"
            );
        }
        if row.slip_ratio > 0.5 {
            assert!(there > 1.1 * strength, "{row:?}: {strength}");
        }
    }
}

#[test]
fn the_lugged_wheel_pulls_and_turns_as_there_within_an_eighth() {
    let [pull, torque] = errors(28);
    assert!(pull < 12.5 && torque < 12.5, "{pull} %, {torque} %");
    // The smooth wheel's, for the reader.
    errors(0);
}
