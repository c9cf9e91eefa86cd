//! Parameters of the recalibration: numbers of a scenario that are not known exactly.
//!
//! A parameter moves along a coordinate, the logarithm of its value or the value itself, by an
//! offset from the scenario's value. What an [effect](crate::effects) carries is none: the growth
//! of the sinkage exponent with slip, the slope, the lugs.

use crate::effects::Source;
use crate::scenario::Scenario;
use crate::simulation::rig::Rig;
use crate::soil::Soil;
use crate::terrain::{HardContact, Joints, Roughness, Stones, TerrainSpec};
use serde::Serialize;
use std::collections::BTreeMap;

/// Along what a parameter moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinate {
    /// The natural logarithm of the value.
    Logarithm,
    /// The value in its unit.
    Plain,
}

/// A number of a scenario that may be wrong.
#[derive(Debug, Serialize)]
pub struct Parameter {
    /// Its name in results.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// Unit of its value; `-` where it has none.
    pub unit: &'static str,
    /// Along what it moves.
    pub coordinate: Coordinate,
    /// Standard deviation, in the coordinate, before any measurement.
    pub sd: f64,
    /// Whence that comes.
    pub source: Source,
    /// Where it stands in a scenario: all places move together.
    #[serde(skip)]
    places: fn(&mut Scenario) -> Vec<&mut f64>,
}

/// Every parameter, ground first, then rig. Noise beyond the sensors' own is an effect.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "soil_moduli",
        title: "k_c and k_phi together",
        unit: "N/m^(N+2)",
        coordinate: Coordinate::Logarithm,
        sd: 0.7,
        source: Source::Guess("a factor of 2 between preparations of one dry sand"),
        places: |scenario| each(soils(scenario), moduli),
    },
    Parameter {
        name: "soil_exponent",
        title: "sinkage exponent n_0",
        unit: "-",
        coordinate: Coordinate::Plain,
        sd: 0.15,
        source: Source::Guess("one sand reads 0.91 under a wheel and 1.10 under plates"),
        places: |scenario| each(soils(scenario), |soil| vec![&mut soil.sinkage_exponent]),
    },
    Parameter {
        name: "soil_cohesion",
        title: "cohesion c",
        unit: "Pa",
        coordinate: Coordinate::Logarithm,
        sd: 0.26,
        source: Source::Guess("30 %: more of it is moisture, which is an effect"),
        places: |scenario| each(soils(scenario), |soil| vec![&mut soil.cohesion]),
    },
    Parameter {
        name: "soil_friction_angle",
        title: "friction angle phi",
        unit: "deg",
        coordinate: Coordinate::Plain,
        sd: 2.0,
        source: Source::Guess("shear boxes agree on a dry sand to some degrees of density"),
        places: |scenario| each(soils(scenario), |soil| vec![&mut soil.friction_angle_deg]),
    },
    Parameter {
        name: "soil_shear_modulus",
        title: "shear deformation modulus K",
        unit: "m",
        coordinate: Coordinate::Logarithm,
        sd: 0.3,
        source: Source::Guess("twice the spread of 9.7 to 13.1 mm in one laboratory's sand"),
        places: |scenario| each(soils(scenario), |soil| vec![&mut soil.shear_modulus]),
    },
    Parameter {
        name: "soil_stress_angle",
        title: "maximum-stress angle coefficient c_1",
        unit: "-",
        coordinate: Coordinate::Plain,
        sd: 0.1,
        source: Source::Guess(
            "0.18 on loose and 0.43 on compact sand (Wong and Reece 1967), and this one is not measured",
        ),
        places: |scenario| each(soils(scenario), |soil| vec![&mut soil.stress_angle]),
    },
    Parameter {
        name: "surface_roughness",
        title: "height of the roughness",
        unit: "m",
        coordinate: Coordinate::Logarithm,
        sd: 0.5,
        source: Source::Guess("judged by eye"),
        places: |scenario| each(roughness(&mut scenario.terrain), |it| vec![&mut it.rms]),
    },
    Parameter {
        name: "joint_step",
        title: "height between neighbouring bricks",
        unit: "m",
        coordinate: Coordinate::Logarithm,
        sd: 0.5,
        source: Source::Guess("judged by eye, as the roughness"),
        places: |scenario| each(joints(&mut scenario.terrain), |it| vec![&mut it.step]),
    },
    Parameter {
        name: "wheel_friction",
        title: "friction of lug or rim on stone",
        unit: "-",
        coordinate: Coordinate::Logarithm,
        sd: 0.2,
        source: Source::Guess("0.5 to 0.75 of metal on dry stone"),
        places: |scenario| {
            if meets_stone(&mut scenario.terrain) {
                vec![&mut scenario.wheel.friction]
            } else {
                Vec::new()
            }
        },
    },
    Parameter {
        name: "contact_stiffness",
        title: "load at the reference indentation",
        unit: "N",
        coordinate: Coordinate::Logarithm,
        sd: 0.7,
        source: Source::Guess("a factor of 2: brick, its bed and the lug give way together"),
        places: |scenario| {
            each(contacts(&mut scenario.terrain), |it| {
                vec![&mut it.reference_load]
            })
        },
    },
    Parameter {
        name: "contact_dissipation",
        title: "dissipation of hard contact",
        unit: "s/m",
        coordinate: Coordinate::Logarithm,
        sd: 0.7,
        source: Source::Guess("a factor of 2: from a damping ratio that is a guess"),
        places: |scenario| {
            each(contacts(&mut scenario.terrain), |it| {
                vec![&mut it.dissipation]
            })
        },
    },
    Parameter {
        name: "stone_size",
        title: "smallest and largest stone together",
        unit: "m",
        coordinate: Coordinate::Logarithm,
        sd: 0.2,
        source: Source::Guess("a sieve's step is a factor of 1.4"),
        places: |scenario| {
            each(stones(&mut scenario.terrain), |it| {
                vec![&mut it.size.min, &mut it.size.max]
            })
        },
    },
    Parameter {
        name: "stone_friction",
        title: "friction of stone on stone",
        unit: "-",
        coordinate: Coordinate::Logarithm,
        sd: 0.2,
        source: Source::Guess("25 to 36 degrees between stones"),
        places: |scenario| each(stones(&mut scenario.terrain), |it| vec![&mut it.friction]),
    },
    Parameter {
        name: "moving_mass",
        title: "mass that moves vertically",
        unit: "kg",
        coordinate: Coordinate::Logarithm,
        sd: 0.2,
        source: Source::Guess("slide and motor are seldom weighed"),
        places: |scenario| match &mut scenario.rig {
            Rig::SingleWheel(rig) => vec![&mut rig.moving_mass],
            Rig::RoverLeg(_) => Vec::new(),
        },
    },
    Parameter {
        name: "leg_stiffness",
        title: "stiffness between body and axle",
        unit: "N/m",
        coordinate: Coordinate::Logarithm,
        sd: 0.7,
        source: Source::Guess("a factor of 2: bearings and brackets give way too"),
        places: |scenario| match &mut scenario.rig {
            Rig::RoverLeg(leg) => vec![&mut leg.stiffness],
            Rig::SingleWheel(_) => Vec::new(),
        },
    },
    Parameter {
        name: "leg_damping",
        title: "damping between body and axle",
        unit: "N·s/m",
        coordinate: Coordinate::Logarithm,
        sd: 0.7,
        source: Source::Guess("a factor of 2: from a damping ratio that is a guess"),
        places: |scenario| match &mut scenario.rig {
            Rig::RoverLeg(leg) => vec![&mut leg.damping],
            Rig::SingleWheel(_) => Vec::new(),
        },
    },
];

fn each<T>(things: Vec<&mut T>, numbers: fn(&mut T) -> Vec<&mut f64>) -> Vec<&mut f64> {
    things.into_iter().flat_map(numbers).collect()
}

fn soils(scenario: &mut Scenario) -> Vec<&mut Soil> {
    grounds(&mut scenario.terrain)
        .into_iter()
        .filter_map(|ground| match ground {
            TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => Some(soil),
            _ => None,
        })
        .collect()
}

fn moduli(soil: &mut Soil) -> Vec<&mut f64> {
    vec![&mut soil.cohesive_modulus, &mut soil.frictional_modulus]
}

/// The ground, or each stretch of a sequence.
fn grounds(terrain: &mut TerrainSpec) -> Vec<&mut TerrainSpec> {
    match terrain {
        TerrainSpec::Sequence(sections) => sections
            .iter_mut()
            .map(|section| &mut section.ground)
            .collect(),
        ground => vec![ground],
    }
}

fn roughness(terrain: &mut TerrainSpec) -> Vec<&mut Roughness> {
    let grounds = grounds(terrain).into_iter();
    grounds
        .filter_map(|ground| match ground {
            TerrainSpec::Hard { roughness, .. } | TerrainSpec::GravelOnHard { roughness, .. } => {
                Some(roughness)
            }
            TerrainSpec::Sand { roughness, .. } | TerrainSpec::GravelInSand { roughness, .. } => {
                roughness.as_mut()
            }
            _ => None,
        })
        .collect()
}

fn joints(terrain: &mut TerrainSpec) -> Vec<&mut Joints> {
    let grounds = grounds(terrain).into_iter();
    grounds
        .filter_map(|ground| match ground {
            TerrainSpec::Hard { joints, .. } => joints.as_mut(),
            _ => None,
        })
        // What is level stays level by any factor.
        .filter(|joints| joints.step > 0.0)
        .collect()
}

fn contacts(terrain: &mut TerrainSpec) -> Vec<&mut HardContact> {
    let grounds = grounds(terrain).into_iter();
    grounds
        .filter_map(|ground| match ground {
            TerrainSpec::Reference { contact }
            | TerrainSpec::Hard { contact, .. }
            | TerrainSpec::GravelOnHard { contact, .. } => Some(contact),
            _ => None,
        })
        .collect()
}

fn stones(terrain: &mut TerrainSpec) -> Vec<&mut Stones> {
    let grounds = grounds(terrain).into_iter();
    grounds
        .filter_map(|ground| match ground {
            TerrainSpec::Gravel { stones, .. }
            | TerrainSpec::GravelOnHard { stones, .. }
            | TerrainSpec::GravelInSand { stones, .. } => Some(stones),
            _ => None,
        })
        .collect()
}

fn meets_stone(terrain: &mut TerrainSpec) -> bool {
    !contacts(terrain).is_empty() || !stones(terrain).is_empty()
}

impl Parameter {
    /// The parameter of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        PARAMETERS.iter().find(|parameter| parameter.name == name)
    }

    /// Its values in a scenario, in their unit: one a place; none where the scenario has it not.
    pub fn values(&self, scenario: &Scenario) -> Vec<f64> {
        let mut scenario = scenario.clone();
        let places = (self.places)(&mut scenario);
        places.into_iter().map(|place| *place).collect()
    }

    /// Whether a scenario has it, at a value that moves: a factor of nothing is nothing.
    pub fn moves(&self, scenario: &Scenario) -> bool {
        let values = self.values(scenario);
        match self.coordinate {
            Coordinate::Logarithm => values.iter().any(|value| *value > 0.0),
            Coordinate::Plain => !values.is_empty(),
        }
    }

    /// Moves it by `offset`, in the coordinate.
    fn shift(&self, scenario: &mut Scenario, offset: f64) {
        for place in (self.places)(scenario) {
            match self.coordinate {
                Coordinate::Logarithm => *place *= libm::exp(offset),
                Coordinate::Plain => *place += offset,
            }
        }
    }
}

/// The parameters that a scenario has.
pub fn parameters(scenario: &Scenario) -> impl Iterator<Item = &'static Parameter> {
    PARAMETERS
        .iter()
        .filter(|parameter| parameter.moves(scenario))
}

/// Parameters off the scenario's values, each in its coordinate; those at 0 are left out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Offsets(BTreeMap<&'static str, f64>);

impl Offsets {
    /// Parameters off by so many prior standard deviations each.
    pub fn of_deviations(parameters: &[&'static Parameter], deviations: &[f64]) -> Self {
        let pairs = parameters.iter().zip(deviations);
        pairs.fold(Self::default(), |offsets, (parameter, by)| {
            offsets.with(parameter, by * parameter.sd)
        })
    }

    /// These and one more, or another offset of one of them, in its coordinate.
    pub fn with(mut self, parameter: &Parameter, offset: f64) -> Self {
        if offset == 0.0 {
            self.0.remove(parameter.name);
        } else {
            self.0.insert(parameter.name, offset);
        }
        self
    }

    /// The offset of a parameter, in its coordinate.
    pub fn get(&self, parameter: &Parameter) -> f64 {
        self.0.get(parameter.name).copied().unwrap_or(0.0)
    }

    /// Names and offsets, in the order of names.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.iter().map(|(name, offset)| (*name, *offset))
    }

    /// Names and offsets in prior standard deviations, in the order of names.
    pub fn deviations(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let known = self.iter();
        let known = known.filter_map(|(name, offset)| Some((Parameter::find(name)?, offset)));
        known.map(|(parameter, offset)| (parameter.name, offset / parameter.sd))
    }

    /// Whether all parameters are at the scenario's values.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Moves the parameters of a scenario, in memory. What it has not stays away.
    pub fn apply(&self, scenario: &mut Scenario) {
        for (name, offset) in &self.0 {
            if let Some(parameter) = Parameter::find(name) {
                parameter.shift(scenario, *offset);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(name: &str) -> Scenario {
        let folder = env!("CARGO_MANIFEST_DIR");
        Scenario::load(format!("{folder}/scenarios/{name}.toml")).unwrap()
    }

    fn names(name: &str) -> Vec<&'static str> {
        parameters(&scenario(name)).map(|p| p.name).collect()
    }

    #[test]
    fn a_ground_and_a_rig_have_their_parameters_and_no_others() {
        let sand = [
            "soil_moduli",
            "soil_exponent",
            "soil_cohesion",
            "soil_friction_angle",
            "soil_shear_modulus",
            "soil_stress_angle",
            "surface_roughness",
            "moving_mass",
        ];
        assert_eq!(names("single_wheel_st"), sand);
        let gravel = [
            "wheel_friction",
            "stone_size",
            "stone_friction",
            "leg_stiffness",
            "leg_damping",
        ];
        assert_eq!(names("rover_gt"), gravel);
        let flat = [
            "wheel_friction",
            "contact_stiffness",
            "contact_dissipation",
            "moving_mass",
        ];
        assert_eq!(names("single_wheel_ref"), flat);
        assert!(names("rover_ht").contains(&"joint_step"));
    }

    #[test]
    fn two_standard_deviations_either_way_still_make_a_scenario() {
        for name in [
            "single_wheel_st",
            "single_wheel_ht",
            "rover_gt",
            "single_wheel_sgt",
        ] {
            let base = scenario(name);
            for parameter in parameters(&base) {
                for side in [-2.0, 2.0] {
                    let mut moved = base.clone();
                    let offsets = Offsets::default().with(parameter, side * parameter.sd);
                    offsets.apply(&mut moved);
                    moved
                        .check()
                        .unwrap_or_else(|e| panic!("{name}, {}: {e}", parameter.name));
                    assert_ne!(parameter.values(&moved), parameter.values(&base));
                }
            }
        }
    }

    #[test]
    fn the_moduli_move_together_and_by_a_factor() {
        let (base, mut moved) = (scenario("single_wheel_st"), scenario("single_wheel_st"));
        let moduli = Parameter::find("soil_moduli").unwrap();
        Offsets::default().with(moduli, 0.5).apply(&mut moved);
        for (after, before) in moduli.values(&moved).iter().zip(moduli.values(&base)) {
            assert!((after / before - libm::exp(0.5)).abs() < 1e-12);
        }
    }

    #[test]
    fn an_offset_of_nothing_is_no_offset() {
        let cohesion = Parameter::find("soil_cohesion").unwrap();
        let offsets = Offsets::default().with(cohesion, 0.1).with(cohesion, 0.0);
        assert!(offsets.is_empty());
        assert_eq!(offsets.get(cohesion), 0.0);
    }
}
