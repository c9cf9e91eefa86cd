//! Columns against the quadrature of [`crate::soil::wheel_load`]: one law of sand, whichever works it out.
//!
//! A wheel is led at the sinkage at which the quadrature carries a load, so that it does not heave from lug to lug, and its loads
//! are averaged over whole lug passes.

use super::tests::sand;
use super::*;
use crate::quantity::Seed;
use crate::soil::shear::speed_ratio;
use crate::soil::wheel_load::{WheelLoad, loads, sinkage_at};
use crate::terrain::Relief;
use crate::wheel::Lugs;

const DT: f64 = 1.0 / FULL_RATE;
/// Forward speed [m/s].
const SPEED: f64 = 0.05;
/// Way [m] before loads are averaged, and over which they are, at least.
const WAY: [f64; 2] = [0.25, 0.3];
/// Greatest difference of a force over the load, and of the torque over load and radius [-].
const ALLOWED: f64 = 7.0e-3;
/// The same over light loads too: a wheel of 48 lugs at 30 N.
const ALLOWED_LIGHT: f64 = 2.0e-2;

/// A wheel at a load and slip, on soil of one stress convention.
struct Case {
    soil: Soil,
    wheel: Wheel,
    load: f64,
    slip: f64,
}

impl Case {
    fn all(loads: &[f64]) -> Vec<Self> {
        let mut cases = Vec::new();
        for convention in [StressConvention::WongReece, StressConvention::Triangular] {
            for count in [0, 6, 12, 28, 48] {
                for slip in [-0.2, 0.0, 0.2, 0.4, 0.6] {
                    cases.extend(loads.iter().map(|load| Self {
                        soil: Soil {
                            convention,
                            ..sand()
                        },
                        wheel: wheel(count),
                        load: *load,
                        slip,
                    }));
                }
            }
        }
        cases
    }

    /// Mean loads of the columns on the wheel led at this sinkage [m].
    fn led(&self, sinkage: f64) -> WheelLoad {
        let flat = Profile::new(&Relief::default(), 1.0e-3, Seed(0), 0);
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let mut track = SoilTrack::new(flat, self.soil, &self.wheel, everywhere);
        let geometry = WheelGeometry::new(&self.wheel, self.load);
        let omega = SPEED / (self.wheel.radius * speed_ratio(self.slip));
        let pass = self.wheel.lug_angle().unwrap_or(0.1);
        let way_of_pass = pass / omega * SPEED;
        let steps = ((WAY[1] / way_of_pass).ceil() * pass / omega / DT).round() as u32;
        let opening = (WAY[0] / SPEED / DT) as u32;
        let mut sum = WheelLoad::default();
        for step in 0..opening + steps {
            let time = f64::from(step) * DT;
            let (sin, cos) = libm::sincos(omega * time);
            let motion = WheelMotion {
                x: SPEED * time,
                y: self.wheel.radius - sinkage,
                vx: SPEED,
                omega,
                angle: omega * time,
                sin,
                cos,
                ..WheelMotion::default()
            };
            let wrench = track.push(&geometry, &motion, DT).wrench;
            if step >= opening {
                sum = sum
                    + WheelLoad {
                        normal_force: wrench.fy,
                        drawbar_pull: wrench.fx,
                        driving_torque: -wrench.torque,
                    };
            }
        }
        sum * (1.0 / f64::from(steps))
    }

    /// A row of the table: the loads by both ways, and their greatest difference over the load [-].
    fn row(&self) -> (String, f64) {
        let Self {
            soil,
            wheel,
            load,
            slip,
        } = self;
        let sinkage = sinkage_at(wheel, soil, *load, *slip).unwrap();
        let (integrated, led) = (loads(wheel, soil, sinkage, *slip), self.led(sinkage));
        let differences = [
            (led.normal_force - load) / load,
            (led.drawbar_pull - integrated.drawbar_pull) / load,
            (led.driving_torque - integrated.driving_torque) / (load * wheel.radius),
        ];
        let [force, pull, torque] = differences.map(|part| 100.0 * part);
        let row = format!(
            "{:10}  {:4}  {slip:5.1}  {load:5.0}  {:8.2}  {:7.2} {:7.2}  {:7.3} {:7.3}  {force:7.3} {pull:7.3} {torque:7.3}",
            format!("{:?}", soil.convention),
            wheel.lug_count(),
            1e3 * sinkage,
            integrated.drawbar_pull,
            led.drawbar_pull,
            integrated.driving_torque,
            led.driving_torque,
        );
        (
            row,
            differences.iter().fold(0.0, |most, x| x.abs().max(most)),
        )
    }
}

fn wheel(count: u32) -> Wheel {
    let lugs = Lugs {
        count,
        height: 0.015,
        thickness: 0.003,
        edge_radius: None,
    };
    Wheel {
        lugs: (count > 0).then_some(lugs),
        ..Wheel::single_wheel()
    }
}

#[test]
fn columns_bear_push_and_resist_as_the_quadrature_does_with_and_without_lugs() {
    for case in Case::all(&[100.0]) {
        let (row, difference) = case.row();
        assert!(difference < ALLOWED, "{row}");
    }
}

/// `cargo test --lib against_quadrature -- --ignored --nocapture` prints
/// `output/reference/columns_and_quadrature.txt`.
#[test]
#[ignore = "a minute"]
fn table_of_columns_against_the_quadrature() {
    println!(
        "convention  lugs   slip   load   sinkage  pull/N          torque/(N m)     columns less quadrature, % of load (and radius)"
    );
    println!(
        "                          /N     /mm       quadr. columns   quadr. columns    force    pull  torque"
    );
    let mut most = 0.0_f64;
    for case in Case::all(&[30.0, 100.0, 300.0]) {
        let (row, difference) = case.row();
        println!("{row}");
        most = most.max(difference);
    }
    println!("greatest difference {:.3} % of the load", 100.0 * most);
    assert!(most < ALLOWED_LIGHT);
}
