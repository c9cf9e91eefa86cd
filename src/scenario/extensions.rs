//! Parts of an experiment that no scenario file describes: those that a user brings.

use crate::sensors::Sensor;
use crate::simulation::rig::DriveProfile;
use crate::soil::law::SoilLaw;
use crate::terrain::profile::Heights;
use crate::wheel::lug_outline::LugOutline;
use std::sync::Arc;

/// The user's own parts of an experiment; by default there are none.
#[derive(Default)]
pub struct Extensions {
    pub(super) heights: Option<Arc<dyn Heights>>,
    pub(super) soil_law: Option<Arc<dyn SoilLaw>>,
    pub(super) lugs: Option<Arc<dyn LugOutline>>,
    pub(super) drive: Option<Arc<dyn DriveProfile>>,
    pub(super) sensors: Vec<Box<dyn Sensor>>,
}

impl Extensions {
    /// Adds these heights to the ground's: see [`Terrain::with_heights`](crate::terrain::Terrain::with_heights).
    pub fn heights(mut self, heights: impl Heights + 'static) -> Self {
        self.heights = Some(Arc::new(heights));
        self
    }

    /// Lets soil bear by this law: see [`Terrain::with_soil_law`](crate::terrain::Terrain::with_soil_law).
    pub fn soil_law(mut self, law: impl SoilLaw + 'static) -> Self {
        self.soil_law = Some(Arc::new(law));
        self
    }

    /// Gives the wheel lugs of this form, as many and as high as the scenario's; effects that shorten lugs sink them into
    /// the rim: see [`Simulation::with_lugs`](crate::simulation::Simulation::with_lugs).
    pub fn lugs(mut self, outline: impl LugOutline + 'static) -> Self {
        self.lugs = Some(Arc::new(outline));
        self
    }

    /// Drives the wheel by this profile in place of the rig's constant speeds: see
    /// [`Simulation::following`](crate::simulation::Simulation::following).
    pub fn drive(mut self, profile: impl DriveProfile + 'static) -> Self {
        self.drive = Some(Arc::new(profile));
        self
    }

    /// Measures with this sensor too; its channel comes after those of the scenario's sensors.
    pub fn sensor(mut self, sensor: impl Sensor + 'static) -> Self {
        self.sensors.push(Box::new(sensor));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use crate::scenario::Scenario;
    use crate::simulation::WheelState;
    use crate::simulation::rig::{Command, Speeds};
    use crate::soil::Soil;
    use crate::terrain::TerrainSpec;
    use crate::trace::{Channel, Trace};
    use std::ops::ControlFlow;

    fn short(name: &str) -> Scenario {
        let file = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let scenario = Scenario::load(file).unwrap();
        scenario
            .with_all(&["duration=0.5", "lead_in=0.0", "physics_rate=8000"])
            .unwrap()
    }

    fn run(scenario: &Scenario, extensions: Extensions) -> Trace {
        let go_on = &mut |_| ControlFlow::Continue(());
        scenario.run_with(extensions, Seed(5), 2, go_on).unwrap()
    }

    #[derive(Debug)]
    struct Waves;

    impl Heights for Waves {
        fn height(&self, x: f64) -> f64 {
            0.004 * libm::sin(40.0 * x)
        }
    }

    #[test]
    fn heights_of_the_users_own_are_the_ground_under_the_wheel() {
        let trace = run(
            &short("single_wheel_ref"),
            Extensions::default().heights(Waves),
        );
        let profile = trace.truth.unwrap().profile;
        assert!(profile.len() > 250);
        for [x, height] in profile {
            // Cubics over 0.25 mm leave a millionth of a wave of 157 mm.
            assert!((height - Waves.height(x)).abs() < 1e-8, "{x} {height}");
        }
    }

    /// What sand states itself, as a law.
    #[derive(Debug)]
    struct AsItIs(Soil);

    impl SoilLaw for AsItIs {
        fn pressure(&self, sinkage: f64, width: f64, slip: f64) -> f64 {
            self.0.pressure_sinkage(width, slip).pressure(sinkage)
        }

        fn mobilised(&self, displacement: f64) -> f64 {
            self.0.shear().mobilised(displacement)
        }
    }

    #[test]
    fn a_law_that_states_the_soils_own_pressure_and_shear_gives_the_soils_own_loads() {
        let scenario = short("quick");
        let TerrainSpec::Sand { soil, .. } = scenario.terrain else {
            panic!("the quick scenario is on sand");
        };
        let soil = soil.under_wheel_of(2.0 * scenario.wheel.radius);
        let own = run(&scenario, Extensions::default());
        let stated = run(&scenario, Extensions::default().soil_law(AsItIs(soil)));
        let [own, stated] = [&own, &stated].map(|trace| trace.steady_mean("sinkage").unwrap());
        // The soil's own power is one of 1e-12, and its stiffness no difference.
        assert!((stated / own - 1.0).abs() < 1e-6, "{stated} {own}");
        let firm = Soil {
            frictional_modulus: 4.0 * soil.frictional_modulus,
            ..soil
        };
        let firm = run(&scenario, Extensions::default().soil_law(AsItIs(firm)));
        assert!(firm.steady_mean("sinkage").unwrap() < 0.7 * own);
    }

    /// A plate with the round edges of the scenario's own lugs.
    #[derive(Debug)]
    struct Plate {
        height: f64,
        half_thickness: f64,
        edge_radius: f64,
    }

    impl LugOutline for Plate {
        fn distance(&self, height: f64, across: f64) -> f64 {
            let aside = across.abs() - (self.half_thickness - self.edge_radius);
            let above = height - (self.height - self.edge_radius);
            let outside = libm::hypot(aside.max(0.0), above.max(0.0));
            outside + aside.max(above).min(0.0) - self.edge_radius
        }

        fn height(&self) -> f64 {
            self.height
        }

        fn half_width(&self) -> f64 {
            self.half_thickness
        }
    }

    #[test]
    fn a_plate_as_an_outline_of_ones_own_rolls_as_the_plates_of_the_scenario() {
        for scenario in ["single_wheel_ref", "single_wheel_gt"].map(short) {
            let lugs = scenario.wheel.lugs.unwrap();
            let plate = Plate {
                height: lugs.height,
                half_thickness: 0.5 * lugs.thickness,
                edge_radius: lugs.edge_radius(),
            };
            let [own, stated] = [Extensions::default(), Extensions::default().lugs(plate)]
                .map(|it| run(&scenario, it));
            let [own, stated] =
                [own, stated].map(|trace| trace.channel("normal_force").unwrap().samples.clone());
            // Directions by differences have errors of some 1e-9, which grow while stones roll.
            let early = own.iter().zip(&stated).take(400);
            let apart = early.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 0.01, "{apart}");
        }
    }

    /// A round bar on the rim, half sunk into it.
    #[derive(Debug)]
    struct Bar(f64);

    impl LugOutline for Bar {
        fn distance(&self, height: f64, across: f64) -> f64 {
            libm::hypot(height, across) - self.0
        }

        fn height(&self) -> f64 {
            self.0
        }

        fn half_width(&self) -> f64 {
            self.0
        }
    }

    #[test]
    fn a_wheel_of_round_bars_rises_and_falls_as_circles_about_the_rim_roll() {
        let scenario = short("single_wheel_ref");
        let scenario = scenario
            .with_all(&[
                "wheel.lugs.count=16",
                "wheel.lugs.height=0.01",
                "duration=3.0",
            ])
            .unwrap();
        // Over flat ground a bar's centre stays a bar's radius above it: r cos(θ) + R, θ to half the pitch.
        let [radius, bar] = [scenario.wheel.radius, 0.01];
        let fall = radius * (1.0 - libm::cos(std::f64::consts::PI / 16.0));
        let heave = Extensions::default()
            .lugs(Bar(bar))
            .sensor(Heave::default());
        let trace = run(&scenario, heave);
        let samples = &trace.channel("axle_height").unwrap().samples;
        let [low, high] =
            [f64::min, f64::max].map(|of| samples.iter().copied().reduce(of).unwrap());
        assert!(
            (high - low - fall).abs() < 0.05 * fall,
            "{high} {low} {fall}"
        );
    }

    #[test]
    fn worn_lugs_of_ones_own_lower_the_axle_and_lower_ones_than_the_scenarios_are_refused() {
        let scenario = short("single_wheel_ref");
        let scenario = scenario.with("wheel.lugs.count=16").unwrap();
        let bars = |radius| {
            Extensions::default()
                .lugs(Bar(radius))
                .sensor(Heave::default())
        };
        let height = |scenario: &Scenario| {
            let trace = run(scenario, bars(0.015));
            trace.channel("axle_height").unwrap().samples[0]
        };
        let worn = scenario
            .with_effect(&"lug_wear=0.2".parse().unwrap())
            .unwrap();
        let lowered = height(&scenario) - height(&worn);
        assert!((lowered - 0.003).abs() < 1.0e-5, "{lowered}");
        let refused =
            scenario.run_with(bars(0.008), Seed(5), 2, &mut |_| ControlFlow::Continue(()));
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("height of a lug outline"), "{refused}");
    }

    /// The speeds that a rig commands itself.
    #[derive(Debug)]
    struct AsCommanded(Command);

    impl DriveProfile for AsCommanded {
        fn speeds(&self, time: f64) -> Speeds {
            let commanded = self.0.at(time);
            Speeds {
                forward: commanded.forward_speed,
                wheel: commanded.wheel_speed,
            }
        }
    }

    #[test]
    fn a_profile_of_the_rigs_own_speeds_gives_its_own_motion_bit_by_bit() {
        let scenario = short("single_wheel_ref");
        let command = Command::new(scenario.rig.drive(), scenario.wheel.radius).unwrap();
        let profile = Extensions::default().drive(AsCommanded(command));
        let [own, followed] = [Extensions::default(), profile].map(|it| run(&scenario, it));
        assert_eq!(own.channels, followed.channels);
    }

    #[derive(Default)]
    struct Heave(Vec<f64>);

    impl Sensor for Heave {
        fn push(&mut self, state: &WheelState) {
            self.0.push(state.height);
        }

        fn finish(self: Box<Self>) -> Channel {
            Channel {
                name: "axle_height".to_owned(),
                unit: "m".to_owned(),
                sample_rate: 8000.0,
                start: 0.0,
                samples: self.0,
            }
        }
    }

    #[test]
    fn a_sensor_of_the_users_own_sees_every_step_and_leaves_the_others_as_they_are() {
        let scenario = short("single_wheel_ref");
        let own = run(&scenario, Extensions::default());
        let mut measured = run(&scenario, Extensions::default().sensor(Heave::default()));
        let heave = measured.channels.pop().unwrap();
        assert_eq!(
            (heave.name.as_str(), heave.samples.len()),
            ("axle_height", 4000)
        );
        let radius = scenario.wheel.radius;
        assert!(
            heave
                .samples
                .iter()
                .all(|height| (height / radius - 1.0).abs() < 0.2)
        );
        assert_eq!(own.channels, measured.channels);
    }
}
