//! Ground along the track: its specification in a scenario, and its realisation for one run.

pub mod class;
pub mod profile;
pub mod stones;

use crate::quantity::{RangeError, Seed};
use crate::soil::Soil;
use crate::soil::law::SoilLaw;
use class::TerrainLabel;
use profile::{Heights, Profile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// Hunt-Crossley contact of lug edge or rim with stone: `F = F_0 (δ/δ_0)ⁿ (1 + d δ̇)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HardContact {
    /// Load `F_0` \[N\] at the reference indentation.
    pub reference_load: f64,
    /// Indentation `δ_0` \[m\] at that load.
    pub reference_indentation: f64,
    /// Exponent `n` [-] of the contact force `F = F_0 (δ/δ_0)ⁿ (1 + d δ̇)`.
    pub exponent: f64,
    /// Dissipation `d` [s/m] of the contact force: factor `1 + d δ̇`, with the indentation rate `δ̇`.
    pub dissipation: f64,
    /// Thickness \[m\] of the dust on the stone; none if absent. It takes friction away; a cover that
    /// also bears is a soil over a hard base ([`crate::soil::hard_base`]).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub dust: f64,
}

/// Self-affine roughness: spectral density `∝ q^-(1+2H)` between two wavelengths, flat above the longest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Roughness {
    /// Root-mean-square height \[m\].
    pub rms: f64,
    /// Hurst exponent `H` [-].
    pub hurst: f64,
    /// Longest wavelength \[m\].
    pub longest: f64,
    /// Shortest wavelength \[m\].
    pub shortest: f64,
}

/// Joints between slates or bricks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joints {
    /// Mean length of a brick \[m\].
    pub spacing: f64,
    /// Width of a joint \[m\].
    pub width: f64,
    /// Depth of a joint \[m\].
    pub depth: f64,
    /// Standard deviation of the height of neighbouring bricks \[m\].
    pub step: f64,
    /// Radius \[m\] of the bricks' edges, at least the joint's depth; if absent, that of edges which meet the joint's
    /// bottom at 45°.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edge_radius: Option<f64>,
}

impl Joints {
    /// Those of level bricks.
    #[cfg(test)]
    pub(crate) const LEVEL: Self = Self {
        spacing: 0.2,
        width: 0.005,
        depth: 0.002,
        step: 0.0,
        edge_radius: None,
    };

    /// Radius \[m\] of the bricks' edges.
    ///
    /// A lug under load `W` leaves a flank of slope `m` only at a pull of `W (m + μ) / (1 - m μ)`, which grows without bound
    /// towards `m μ = 1`. With edges that end at 45° and the friction of metal on stone, 0.6, the lug needs `4 W`.
    pub fn edge_radius(&self) -> f64 {
        self.edge_radius
            .unwrap_or(self.depth / (1.0 - FRAC_1_SQRT_2))
    }
}

/// A step up, climbed by a face of 75°: no height over the track is vertical, and beyond 60° a wheel of the friction of
/// metal on stone finds no hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ledge {
    /// Where its face begins, from the start of the track \[m\].
    pub position: f64,
    /// Height \[m\].
    pub height: f64,
    /// Radius \[m\] of its upper edge; 5 mm if absent.
    #[serde(default = "Ledge::usual_edge")]
    pub edge_radius: f64,
}

/// What makes the height of fixed ground.
#[derive(Debug, Clone, Copy, Default)]
pub struct Relief {
    /// Roughness.
    pub roughness: Option<Roughness>,
    /// Joints between bricks.
    pub joints: Option<Joints>,
    /// A step up.
    pub ledge: Option<Ledge>,
}

impl From<Roughness> for Relief {
    fn from(roughness: Roughness) -> Self {
        Self {
            roughness: Some(roughness),
            ..Self::default()
        }
    }
}

impl From<Joints> for Relief {
    fn from(joints: Joints) -> Self {
        Self {
            joints: Some(joints),
            ..Self::default()
        }
    }
}

/// Free stones: clumps of spheres, see [`stones`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stones {
    /// Smallest and largest size \[m\] (mean diameter, log-uniform between them).
    pub size: SizeRange,
    /// Angularity [-]: 0 rounded, 1 sharp and irregular.
    pub angularity: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Friction coefficient [-] stone on stone.
    pub friction: f64,
    /// Effective modulus \[Pa\] of a contact, `E / (2 (1 - ν²))` of two equal stones.
    #[serde(default = "Stones::default_contact_modulus")]
    pub contact_modulus: f64,
    /// Coefficient of restitution [-] of two stones, or of a stone and the wheel.
    #[serde(default = "Stones::default_restitution")]
    pub restitution: f64,
    /// Drag [1/s] of fines between the stones on their motion and spin, per mass and inertia; none
    /// if absent.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub drag: f64,
}

/// Smallest and largest size \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SizeRange {
    /// Smallest \[m\].
    pub min: f64,
    /// Largest \[m\].
    pub max: f64,
}

/// Specification of the ground in a scenario.
///
/// Reading one from a file settles its shape; [`TerrainSpec::check`] its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[non_exhaustive]
pub enum TerrainSpec {
    /// REF: flat and hard.
    Reference {
        /// Contact with the wheel.
        contact: HardContact,
    },
    /// HT: slate or stone bricks.
    Hard {
        /// Contact with the wheel.
        contact: HardContact,
        /// Roughness of the bricks.
        roughness: Roughness,
        /// Joints between them.
        #[serde(skip_serializing_if = "Option::is_none")]
        joints: Option<Joints>,
        /// A step up.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        ledge: Option<Ledge>,
    },
    /// GT: a settled pile of free stones.
    Gravel {
        /// The stones.
        stones: Stones,
        /// Depth of the pile \[m\].
        depth: f64,
    },
    /// HGT: free stones scattered on slate.
    GravelOnHard {
        /// Contact with the wheel.
        contact: HardContact,
        /// Roughness of the slate.
        roughness: Roughness,
        /// The stones.
        stones: Stones,
        /// Stones per metre of track [1/m].
        stones_per_metre: f64,
    },
    /// ST: sand.
    Sand {
        /// The soil.
        soil: Soil,
        /// Roughness of its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
    },
    /// SGT: stones in and on sand.
    GravelInSand {
        /// The soil.
        soil: Soil,
        /// Roughness of its surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
        /// The stones.
        stones: Stones,
        /// Stones per metre of track [1/m].
        stones_per_metre: f64,
    },
    /// One after another along the track; the last one never ends.
    Sequence(Vec<Section>),
}

/// A stretch of a sequence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Length \[m\].
    pub length: f64,
    /// What the ground is there; no sequence.
    pub ground: TerrainSpec,
}

impl TerrainSpec {
    /// Size \[m\] of its largest stones; 0 without stones.
    pub fn largest_stone(&self) -> f64 {
        match self {
            Self::Reference { .. } | Self::Hard { .. } | Self::Sand { .. } => 0.0,
            Self::Gravel { stones, .. }
            | Self::GravelOnHard { stones, .. }
            | Self::GravelInSand { stones, .. } => stones.size.max,
            Self::Sequence(sections) => {
                let sizes = sections
                    .iter()
                    .map(|section| section.ground.largest_stone());
                sizes.fold(0.0, f64::max)
            }
        }
    }

    /// The label of this ground; of the first stretch of a sequence.
    pub fn label(&self) -> TerrainLabel {
        match self {
            Self::Reference { .. } => TerrainLabel::Reference,
            Self::Hard { .. } => TerrainLabel::Hard,
            Self::Gravel { .. } => TerrainLabel::Gravel,
            Self::GravelOnHard { .. } => TerrainLabel::HardWithGravel,
            Self::Sand { .. } => TerrainLabel::Sand,
            Self::GravelInSand { .. } => TerrainLabel::SandWithGravel,
            Self::Sequence(sections) => sections
                .first()
                .map_or(TerrainLabel::Reference, |s| s.ground.label()),
        }
    }

    /// What makes the height of the fixed surface.
    fn relief(&self) -> Relief {
        match *self {
            Self::Hard {
                roughness,
                joints,
                ledge,
                ..
            } => Relief {
                roughness: Some(roughness),
                joints,
                ledge,
            },
            Self::GravelOnHard { roughness, .. } => roughness.into(),
            Self::Sand { roughness, .. } | Self::GravelInSand { roughness, .. } => Relief {
                roughness,
                ..Relief::default()
            },
            Self::Reference { .. } | Self::Gravel { .. } | Self::Sequence(_) => Relief::default(),
        }
    }
}

impl HardContact {
    /// # Errors
    /// `RangeError` for a load or indentation that is not positive, an exponent outside [1, 3],
    /// a negative dissipation, or more than 2 mm of dust.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::positive("reference load", "N", self.reference_load)?;
        RangeError::positive("reference indentation", "m", self.reference_indentation)?;
        RangeError::check("contact exponent", "-", self.exponent, [1.0, 3.0])?;
        RangeError::check("contact dissipation", "s/m", self.dissipation, [0.0, 1.0e6])?;
        RangeError::check("dust thickness", "m", self.dust, [0.0, 0.002])?;
        Ok(())
    }
}

impl Roughness {
    /// # Errors
    /// `RangeError` for a height above 0.5 m, a Hurst exponent outside [0, 1], or a shortest
    /// wavelength that is not below the longest.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::check("roughness rms", "m", self.rms, [0.0, 0.5])?;
        RangeError::check("Hurst exponent (hurst)", "-", self.hurst, [0.0, 1.0])?;
        RangeError::positive("longest wavelength", "m", self.longest)?;
        RangeError::check(
            "shortest wavelength",
            "m",
            self.shortest,
            [4.0 * NODE, f64::INFINITY],
        )?;
        below(
            "shortest wavelength",
            self.shortest,
            "longest",
            self.longest,
        )
    }
}

impl Joints {
    /// # Errors
    /// `RangeError` for a spacing or width that is not positive, a joint wider than a brick, a depth or step outside
    /// [0, 0.1] m, or edges with a radius below the depth.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::positive("joint spacing", "m", self.spacing)?;
        RangeError::positive("joint width", "m", self.width)?;
        below("joint width", self.width, "spacing", self.spacing)?;
        RangeError::check("joint depth", "m", self.depth, [0.0, 0.1])?;
        RangeError::check("step between bricks", "m", self.step, [0.0, 0.1])?;
        let edges = [self.depth, 1.0];
        RangeError::check("edge radius of a brick", "m", self.edge_radius(), edges)?;
        Ok(())
    }
}

impl Ledge {
    fn usual_edge() -> f64 {
        0.005
    }

    /// # Errors
    /// `RangeError` for a height outside [0, 0.5] m or an edge radius outside [1 mm, 0.5 m].
    pub fn check(&self) -> Result<(), RangeError> {
        let anywhere = [f64::MIN, f64::MAX];
        RangeError::check("ledge position", "m", self.position, anywhere)?;
        RangeError::check("ledge height", "m", self.height, [0.0, 0.5])?;
        RangeError::check(
            "edge radius of a ledge",
            "m",
            self.edge_radius,
            [0.001, 0.5],
        )?;
        Ok(())
    }
}

impl Stones {
    /// Rock has 20 to 40 GPa; asperities of its rough surface yield at the loads of a wheel, and a modulus of 1 GPa is
    /// common in simulations of ballast. 20-200 Hz rises by 1.7 from 1 to 10 GPa.
    fn default_contact_modulus() -> f64 {
        1.0e9
    }

    /// A guess between 0.1 and 0.5.
    fn default_restitution() -> f64 {
        0.3
    }

    /// Crushed rock of these sizes.
    #[cfg(test)]
    pub(crate) fn crushed(size: SizeRange) -> Self {
        Self {
            size,
            angularity: 0.5,
            density: 2650.0,
            friction: 0.6,
            contact_modulus: Self::default_contact_modulus(),
            restitution: Self::default_restitution(),
            drag: 0.0,
        }
    }

    /// # Errors
    /// `RangeError` for sizes that do not grow from above 0 to 1 m, an angularity outside [0, 1], a density that is not
    /// positive, a friction outside [0, 2], a modulus outside [10⁷, 10¹¹] Pa, a restitution outside [0.05, 1], or a
    /// negative drag.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::check("min stone size", "m", self.size.min, [SMALLEST_STONE, 1.0])?;
        RangeError::check("max stone size", "m", self.size.max, [0.0, 1.0])?;
        below("min stone size", self.size.min, "max", self.size.max)?;
        RangeError::check("stone angularity", "-", self.angularity, [0.0, 1.0])?;
        RangeError::positive("stone density", "kg/m³", self.density)?;
        RangeError::check("stone friction", "-", self.friction, [0.0, 2.0])?;
        RangeError::check(
            "contact modulus",
            "Pa",
            self.contact_modulus,
            [1.0e7, 1.0e11],
        )?;
        RangeError::check("stone restitution", "-", self.restitution, [0.05, 1.0])?;
        RangeError::check("drag of fines", "1/s", self.drag, [0.0, 1.0e4])?;
        Ok(())
    }
}

impl TerrainSpec {
    /// # Errors
    /// `RangeError` for the first value outside its physical range, a sequence without sections,
    /// and a sequence inside a sequence.
    pub fn check(&self) -> Result<(), RangeError> {
        match self {
            Self::Reference { contact } => contact.check(),
            Self::Hard {
                contact,
                roughness,
                joints,
                ledge,
            } => {
                contact.check()?;
                roughness.check()?;
                joints.as_ref().map_or(Ok(()), Joints::check)?;
                ledge.as_ref().map_or(Ok(()), Ledge::check)
            }
            Self::Gravel { stones, depth } => {
                stones.check()?;
                RangeError::positive("gravel depth", "m", *depth)?;
                RangeError::check("gravel depth", "m", *depth, [stones.size.max, 10.0])?;
                Ok(())
            }
            Self::GravelOnHard {
                contact,
                roughness,
                stones,
                stones_per_metre,
            } => {
                contact.check()?;
                roughness.check()?;
                check_scattered(stones, *stones_per_metre)
            }
            Self::Sand { soil, roughness } => check_sand(soil, roughness.as_ref()),
            Self::GravelInSand {
                soil,
                roughness,
                stones,
                stones_per_metre,
            } => {
                check_sand(soil, roughness.as_ref())?;
                check_scattered(stones, *stones_per_metre)
            }
            Self::Sequence(sections) => {
                RangeError::check(
                    "number of sections",
                    "-",
                    sections.len() as f64,
                    [1.0, 10_000.0],
                )?;
                sections.iter().try_for_each(Section::check)
            }
        }
    }
}

/// One ground between two places of the track.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// From and to \[m\].
    pub range: [f64; 2],
    /// What the ground is; no sequence.
    pub ground: TerrainSpec,
    /// Its label.
    pub label: TerrainLabel,
}

/// The ground of one run.
#[derive(Debug, Clone)]
pub struct Terrain {
    stretches: Vec<Stretch>,
    heights: Option<Arc<dyn Heights>>,
    soil_law: Option<Arc<dyn SoilLaw>>,
    seed: Seed,
    run: u64,
}

/// Every number of a ground under its dotted name.
fn collect_numbers(prefix: &str, ground: &TerrainSpec, into: &mut BTreeMap<String, f64>) {
    fn walk(name: &str, value: &serde_json::Value, into: &mut BTreeMap<String, f64>) {
        match value {
            serde_json::Value::Number(number) => {
                into.extend(number.as_f64().map(|number| (name.to_owned(), number)));
            }
            serde_json::Value::Object(table) => table
                .iter()
                .for_each(|(key, value)| walk(&format!("{name}.{key}"), value, into)),
            _ => {}
        }
    }
    if let Ok(serde_json::Value::Object(kinds)) = serde_json::to_value(ground) {
        for (kind, value) in &kinds {
            walk(&format!("{prefix}{kind}"), value, into);
        }
    }
}

fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

/// Smallest stone [m]: what is finer is sand, and more than the engine can carry.
const SMALLEST_STONE: f64 = 0.003;

/// Distance between nodes of hard ground [m]: an eighth of the shortest roughness in use.
const NODE: f64 = 2.5e-4;

impl Terrain {
    /// The ground of `run`. The run starts at 0; the first stretch reaches back without end and
    /// the last one forward.
    pub fn generate(spec: &TerrainSpec, seed: Seed, run: u64) -> Self {
        let whole = [Section {
            length: f64::INFINITY,
            ground: spec.clone(),
        }];
        let sections = match spec {
            TerrainSpec::Sequence(sections) => sections.as_slice(),
            _ => whole.as_slice(),
        };
        let mut end = 0.0;
        let mut stretches: Vec<Stretch> = sections
            .iter()
            .map(|section| {
                let start = end;
                end += section.length;
                let ground = section.ground.clone();
                Stretch {
                    range: [start, end],
                    label: ground.label(),
                    ground,
                }
            })
            .collect();
        if let Some(first) = stretches.first_mut() {
            first.range[0] = f64::NEG_INFINITY;
        }
        if let Some(last) = stretches.last_mut() {
            last.range[1] = f64::INFINITY;
        }
        Self {
            stretches,
            heights: None,
            soil_law: None,
            seed,
            run,
        }
    }

    /// The ground with these heights added to its hard surfaces and to its undisturbed soil; those of a pile of gravel
    /// are made by its stones.
    pub fn with_heights(self, heights: Arc<dyn Heights>) -> Self {
        Self {
            heights: Some(heights),
            ..self
        }
    }

    /// The ground whose soil bears and shears by this law.
    pub fn with_soil_law(self, law: Arc<dyn SoilLaw>) -> Self {
        Self {
            soil_law: Some(law),
            ..self
        }
    }

    /// The law of its soil, where it is not the soil's own.
    pub fn soil_law(&self) -> Option<&Arc<dyn SoilLaw>> {
        self.soil_law.as_ref()
    }

    /// The stretches in their order along the track.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Parameters of the ground by name, for the truth of a run: of the only stretch, or of each
    /// with its number before.
    pub fn parameters(&self) -> BTreeMap<String, f64> {
        let mut parameters = BTreeMap::new();
        for (number, stretch) in self.stretches.iter().enumerate() {
            let prefix = if self.stretches.len() > 1 {
                format!("{number}.")
            } else {
                String::new()
            };
            collect_numbers(&prefix, &stretch.ground, &mut parameters);
        }
        parameters
    }

    /// Height of the fixed surface of `stretch`.
    pub fn profile(&self, stretch: &Stretch) -> Profile {
        let relief = stretch.ground.relief();
        let profile = Profile::new(&relief, NODE, self.seed, self.run);
        match &self.heights {
            Some(heights) => profile.with_heights(Arc::clone(heights)),
            None => profile,
        }
    }

    /// Where the run's draws come from.
    pub fn seed(&self) -> (Seed, u64) {
        (self.seed, self.run)
    }
}

impl Section {
    /// # Errors
    /// `RangeError` for a length that is not positive, a sequence as its ground, or a value of
    /// its ground.
    pub fn check(&self) -> Result<(), RangeError> {
        RangeError::positive("section length", "m", self.length)?;
        if let TerrainSpec::Sequence(inner) = &self.ground {
            return Err(RangeError {
                quantity: "number of sections inside a section",
                unit: "-",
                range:
                    "0, as a sequence holds no other sequence; put the sections one after another"
                        .to_owned(),
                value: inner.len() as f64,
            });
        }
        self.ground.check()
    }
}

fn check_sand(soil: &Soil, roughness: Option<&Roughness>) -> Result<(), RangeError> {
    soil.checked()?;
    RangeError::positive("shear modulus", "m", soil.shear_modulus)?;
    roughness.map_or(Ok(()), Roughness::check)
}

fn check_scattered(stones: &Stones, stones_per_metre: f64) -> Result<(), RangeError> {
    stones.check()?;
    RangeError::check("stones per metre", "1/m", stones_per_metre, [0.0, 1000.0])?;
    Ok(())
}

/// Refuses a length [m] that is not below another.
fn below(
    quantity: &'static str,
    length: f64,
    bound: &'static str,
    limit: f64,
) -> Result<(), RangeError> {
    if length < limit {
        return Ok(());
    }
    Err(RangeError {
        quantity,
        unit: "m",
        range: format!("below `{bound}`, which is {limit} m"),
        value: length,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_section() -> TerrainSpec {
        let contact = HardContact {
            reference_load: 94.0,
            reference_indentation: 1.0e-5,
            exponent: 1.11,
            dissipation: 100.0,
            dust: 0.0,
        };
        TerrainSpec::Sequence(vec![Section {
            length: 1.0,
            ground: TerrainSpec::Reference { contact },
        }])
    }

    #[test]
    fn a_sequence_holds_one_section_or_more_and_no_sequence() {
        assert_eq!(one_section().check(), Ok(()));
        assert!(TerrainSpec::Sequence(Vec::new()).check().is_err());
        let nested = TerrainSpec::Sequence(vec![Section {
            length: 1.0,
            ground: one_section(),
        }]);
        assert!(
            nested
                .check()
                .unwrap_err()
                .range
                .starts_with("0, as a sequence")
        );
    }

    #[test]
    fn the_smallest_stone_is_smaller_than_the_largest() {
        let stones = |min| Stones::crushed(SizeRange { min, max: 0.05 });
        assert_eq!(stones(0.02).check(), Ok(()));
        assert_eq!(
            stones(0.06).check().unwrap_err().to_string(),
            "min stone size [m] must be below `max`, which is 0.05 m, got 0.06"
        );
        assert!(stones(f64::NAN).check().is_err());
    }
}
