//! Effects of granular ground: slip-sinkage, lug action, bulldozing, repeated passes, dependence on rate, apparent
//! cohesion, thin soft layers.

use super::{
    Bound, Effect, EffectError, OtherForm, Prior, Seat, Seated, Setup, Signature, Source, Stage,
};
use crate::soil::Soil;
use crate::terrain::TerrainSpec;
use crate::wheel::Lugs;
use libm::pow;

/// The effects of granular ground.
pub(super) const EFFECTS: &[Effect] = &[
    SLIP_SINKAGE,
    LUG_ACTION,
    BULLDOZING,
    MULTIPASS,
    RATE_DEPENDENT_SOIL,
    APPARENT_COHESION,
    THIN_SOFT_LAYER,
];

/// Edits every soil of the ground.
fn on_soil(setup: &mut Setup, seated: Seated, edit: impl Fn(&mut Soil)) -> Result<(), EffectError> {
    let soils = soils(setup.terrain);
    if soils.is_empty() {
        return Err(EffectError::NotOn {
            effect: seated.effect,
            ground: setup.terrain.label().as_str(),
        });
    }
    soils.into_iter().for_each(edit);
    Ok(())
}

fn soils(terrain: &mut TerrainSpec) -> Vec<&mut Soil> {
    match terrain {
        TerrainSpec::Sand { soil, .. } | TerrainSpec::GravelInSand { soil, .. } => vec![soil],
        TerrainSpec::Sequence(sections) => sections
            .iter_mut()
            .flat_map(|section| soils(&mut section.ground))
            .collect(),
        TerrainSpec::Reference { .. }
        | TerrainSpec::Hard { .. }
        | TerrainSpec::Gravel { .. }
        | TerrainSpec::GravelOnHard { .. } => Vec::new(),
    }
}

const SLIP_SINKAGE: Effect = Effect {
    name: "slip_sinkage",
    title: "slip-sinkage in excess of the soil's n_1",
    edits: "soil.sinkage_exponent_slip, added",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 2.0],
        [0.3, 0.8, 1.3],
        Prior::log_normal(0.8, 1.65),
    )],
    signature: Signature {
        channels: &["sinkage", "driving_torque", "drawbar_pull"],
        bound: Bound::Condition,
        dependence: "grows with slip and is nothing at slip 0; by the same factor at every load; not with speed",
    },
    confusers: &[
        "lug_action",
        "bulldozing",
        "thin_soft_layer",
        "load_drift",
        "encoder_scale",
    ],
    source: Source::Cited(
        "Ding, Gao, Deng, Tao (2010), J. Cent. South Univ. Technol. 17:129-135: sinkage at slip 0.6 is 3 to 7 times that at 0; n_1 of measured wheels 0.38 to 1.30 (ding2011, cmu, Table 6)",
    ),
    law: |setup, added, seated| on_soil(setup, seated, |soil| soil.sinkage_exponent_slip += added),
    other_form: Some(OtherForm {
        not_on: &[],
        description: "sinkage times 1 + w (g(s) - 1), g = (1 + s)/(1 - s/2) (Lyasko 2010), w = 2.5 times the magnitude",
        law: |setup, added, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.slip_digging += 2.5 * added
            })
        },
    }),
};

/// Lugs put on a smooth wheel: how many, and their greatest thickness [m].
const NEW_LUGS: (u32, f64) = (30, 0.003);

const LUG_ACTION: Effect = Effect {
    name: "lug_action",
    title: "lugs higher than stated, or (smooth wheel) 30 unmodelled lugs",
    edits: "wheel.lugs.height, added",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m",
        [0.0, 0.03],
        [0.003, 0.006, 0.010],
        Prior::log_normal(0.006, 1.7),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "driving_torque", "normal_force"],
        bound: Bound::WheelAngle,
        dependence: "pull and torque grow with slip and load; a line at the lug count's order; not with speed",
    },
    confusers: &["apparent_cohesion", "slip_sinkage", "gain_error"],
    source: Source::Cited(
        "ding2011: lugs of 10 mm on a smooth wheel of 157 mm raise pull by 27 to 63 % and torque by 17 to 36 %",
    ),
    law: |setup, height, seated| {
        on_soil(setup, seated, |_| ())?;
        let (count, thickest) = NEW_LUGS;
        setup.wheel.lugs = match setup.wheel.lugs {
            Some(lugs) => Some(Lugs {
                height: lugs.height + height,
                ..lugs
            }),
            None => (height > 0.0).then_some(Lugs {
                count,
                height,
                thickness: height.min(thickest),
                edge_radius: None,
            }),
        };
        Ok(())
    },
    other_form: Some(OtherForm {
        not_on: &[],
        description: "no lugs: soil of that thickness clings to the wheel and shears at its outside, r_s = r + l",
        law: |setup, height, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.clinging_layer += height
            })
        },
    }),
};

const BULLDOZING: Effect = Effect {
    name: "bulldozing",
    title: "bulldozing resistance ahead of the wheel",
    edits: "soil.departures.front_pressure",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 5.0],
        [0.5, 1.0, 2.5],
        Prior::log_normal(1.0, 1.8),
    )],
    signature: Signature {
        channels: &["drawbar_pull"],
        bound: Bound::Condition,
        dependence: "pull falls with the square of sinkage, so with load and slip; torque and sinkage stay; not with speed",
    },
    confusers: &[
        "slope",
        "sensor_tilt",
        "slip_sinkage",
        "bias_drift",
        "gravel_embedding",
    ],
    source: Source::Cited(
        "cmu-single-wheel: a skidding smooth wheel drags 1 to 2.6 times the passive pressure on its sunken face; Hegedus (1960), Land Locomotion Res. Lab. Report 61",
    ),
    law: |setup, multiple, seated| {
        on_soil(setup, seated, |soil| {
            soil.departures.front_pressure += multiple
        })
    },
    other_form: Some(OtherForm {
        not_on: &[],
        description: "a heap that grows over some wheel widths from 0.028 B^1.6 of the soil in the way",
        law: |setup, multiple, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.heap += 0.028 * pow(multiple, 1.6);
            })
        },
    }),
};

const MULTIPASS: Effect = Effect {
    name: "multipass",
    title: "soil compaction by previous passes",
    edits: "soil.departures.compaction; one wheel has passed, or more where the scenario states earlier ones",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 5.0],
        [0.15, 0.5, 1.5],
        Prior::log_normal(0.5, 2.0),
    )],
    signature: Signature {
        channels: &["sinkage", "drawbar_pull"],
        bound: Bound::History,
        dependence: "sinkage falls with every former pass, with the first most, and pull rises at high slip; gone after raking",
    },
    confusers: &["bias_drift", "apparent_cohesion"],
    source: Source::Guess(
        "Holm (1969), J. Terramechanics 6(3):47-71, and Tanaka et al. (2024), 16th ISTVS conference, measured the effect; its size on sand is a guess",
    ),
    law: |setup, gain, seated| on_soil(setup, seated, |soil| soil.departures.compaction += gain),
    other_form: Some(OtherForm {
        not_on: &[],
        description: "moduli unchanged, but soil pressed by 2.5 mm times the magnitude and sprung back",
        law: |setup, gain, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.precompression += 0.0025 * gain
            })
        },
    }),
};

const RATE_DEPENDENT_SOIL: Effect = Effect {
    name: "rate_dependent_soil",
    title: "rate-dependent penetration resistance",
    edits: "soil.departures.rate_exponent",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "-",
        [0.0, 0.5],
        [0.01, 0.03, 0.08],
        Prior::half_normal(0.04),
    )],
    signature: Signature {
        channels: &["sinkage", "drawbar_pull"],
        bound: Bound::Condition,
        dependence: "pressure as speed to the magnitude; nothing against slip at one speed",
    },
    confusers: &["encoder_scale", "servo_ripple"],
    source: Source::Guess(
        "form of Grahn (1991), J. Terramechanics 28(4):339-347; Roth, Han, Jaeger (2019), arXiv 1910.10358, find none on slow intrusion, so small",
    ),
    law: |setup, exponent, seated| {
        on_soil(setup, seated, |soil| {
            soil.departures.rate_exponent += exponent
        })
    },
    other_form: Some(OtherForm {
        not_on: &[],
        description: "pressure times 1 + κ ln(1 + rate/4 mm/s)",
        law: |setup, share, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.rate_logarithm += share
            })
        },
    }),
};

/// Cohesive modulus [N/m^(N+1)] per pascal of cohesion: a bearing-capacity factor `N_c` of 30° a
/// width.
const MODULUS_PER_COHESION: f64 = 30.0;

const APPARENT_COHESION: Effect = Effect {
    name: "apparent_cohesion",
    title: "apparent cohesion by moisture",
    edits: "soil.cohesion, added",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "Pa",
        [0.0, 1.0e4],
        [200.0, 700.0, 2000.0],
        Prior::log_normal(600.0, 2.2),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "driving_torque"],
        bound: Bound::Condition,
        dependence: "pull and torque higher by as much at every load, at slips above 0.1; sinkage hardly moves",
    },
    confusers: &["lug_action", "gain_error", "multipass"],
    source: Source::Cited(
        "dry sands measured or fitted from 250 Pa (ding2011) to 1000 Pa (cmu); moist sands of the order of 1 kPa: Lu, Wu, Tan (2007), J. Geotech. Geoenviron. Eng. 133(2):144-154",
    ),
    law: |setup, cohesion, seated| on_soil(setup, seated, |soil| soil.cohesion += cohesion),
    other_form: Some(OtherForm {
        not_on: &[],
        description: "bonds bear too: the cohesive modulus grows by 30 times as much",
        law: |setup, cohesion, seated| {
            on_soil(setup, seated, |soil| {
                soil.cohesion += cohesion;
                soil.cohesive_modulus += MODULUS_PER_COHESION * cohesion;
            })
        },
    }),
};

const THIN_SOFT_LAYER: Effect = Effect {
    name: "thin_soft_layer",
    title: "rigid base below a soft layer",
    edits: "soil.departures.base_nearness, one over the depth of the base",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "1/m",
        [0.0, 100.0],
        [10.0, 25.0, 50.0],
        Prior::log_normal(25.0, 1.8),
    )],
    signature: Signature {
        channels: &["sinkage", "acceleration_y"],
        bound: Bound::Condition,
        dependence: "sinkage saturates against slip and load; lug passes grow louder as edges near the base",
    },
    confusers: &["slip_sinkage", "dust_cover", "rail_friction"],
    source: Source::Cited(
        "Golombek et al. (2020), Nature Communications 11:1014: a centimetre of loose sand over duricrust. Levels are depths of 100, 40 and 20 mm, a guess: the base stays below the lugs",
    ),
    law: |setup, nearness, seated| {
        on_soil(setup, seated, |soil| {
            soil.departures.base_nearness += nearness
        })
    },
    other_form: Some(OtherForm {
        not_on: &[],
        description: "the base is felt later and more suddenly, as -ln(1 - z/H)",
        law: |setup, nearness, seated| {
            on_soil(setup, seated, |soil| {
                soil.departures.sudden_base_nearness += nearness;
            })
        },
    }),
};
