//! Effects of hard ground, of stones, and of how the track lies.

use super::{
    Bound, Effect, EffectError, OtherForm, Prior, Seat, Seated, Setup, Signature, Source, Stage,
};
use crate::terrain::{HardContact, Stones, TerrainSpec};

/// The effects of hard ground, of stones, and of how the track lies.
pub(super) const EFFECTS: &[Effect] = &[DUST_COVER, GRAVEL_EMBEDDING, SLOPE];

/// The stones and the hard surfaces of a ground.
#[derive(Default)]
struct Parts<'a> {
    stones: Vec<&'a mut Stones>,
    contacts: Vec<&'a mut HardContact>,
}

fn parts(terrain: &mut TerrainSpec) -> Parts<'_> {
    let mut parts = Parts::default();
    collect(terrain, &mut parts);
    parts
}

fn collect<'a>(terrain: &'a mut TerrainSpec, parts: &mut Parts<'a>) {
    match terrain {
        TerrainSpec::Reference { contact } | TerrainSpec::Hard { contact, .. } => {
            parts.contacts.push(contact);
        }
        TerrainSpec::Gravel { stones, .. } | TerrainSpec::GravelInSand { stones, .. } => {
            parts.stones.push(stones);
        }
        TerrainSpec::GravelOnHard {
            contact, stones, ..
        } => {
            parts.contacts.push(contact);
            parts.stones.push(stones);
        }
        TerrainSpec::Sand { .. } => {}
        TerrainSpec::Sequence(sections) => sections
            .iter_mut()
            .for_each(|section| collect(&mut section.ground, parts)),
    }
}

/// The parts of the ground that an effect edits, of which there must be one.
fn some<T>(parts: Vec<T>, seated: Seated, ground: &'static str) -> Result<Vec<T>, EffectError> {
    if parts.is_empty() {
        return Err(EffectError::NotOn {
            effect: seated.effect,
            ground,
        });
    }
    Ok(parts)
}

fn on_contacts(
    setup: &mut Setup,
    seated: Seated,
    edit: impl Fn(&mut HardContact),
) -> Result<(), EffectError> {
    let ground = setup.terrain.label().as_str();
    let contacts = some(parts(setup.terrain).contacts, seated, ground)?;
    contacts.into_iter().for_each(edit);
    Ok(())
}

fn on_stones(
    setup: &mut Setup,
    seated: Seated,
    edit: impl Fn(&mut Stones),
) -> Result<(), EffectError> {
    let ground = setup.terrain.label().as_str();
    let stones = some(parts(setup.terrain).stones, seated, ground)?;
    stones.into_iter().for_each(edit);
    Ok(())
}

const DUST_COVER: Effect = Effect {
    name: "dust_cover",
    title: "dust on hard ground",
    edits: "contact.dust",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "m",
        [0.0, 0.002],
        [1.0e-5, 5.0e-5, 3.0e-4],
        Prior::log_normal(5.0e-5, 3.0),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "driving_torque"],
        bound: Bound::Condition,
        dependence: "pull and torque fall in proportion at slips above 0.05, by up to 45 %; impacts and sinkage stay",
    },
    confusers: &["gain_error", "low_pass", "thin_soft_layer"],
    source: Source::Cited(
        "friction of sand on a smooth plate 18.4° (Sci. Rep. 2024, s41598-024-56621-1, Table 3), which dust of 0.3 mm reaches here; thicknesses are a guess",
    ),
    law: |setup, thickness, seated| on_contacts(setup, seated, |contact| contact.dust += thickness),
    other_form: Some(OtherForm {
        not_on: &[],
        description: "friction lower in proportion to the thickness until 45 % at 0.2 mm, and impacts lossier by up to twice",
        law: |setup, thickness, seated| {
            let cover = (thickness / 2.0e-4).min(1.0);
            on_contacts(setup, seated, |contact| contact.dissipation *= 1.0 + cover)?;
            setup.wheel.friction *= 1.0 - 0.45 * cover;
            Ok(())
        },
    }),
};

/// Drag of fines [1/s] that in the other form makes stones twice as heavy.
const DOUBLING: f64 = 150.0;

const GRAVEL_EMBEDDING: Effect = Effect {
    name: "gravel_embedding",
    title: "drag of fines on embedded stones",
    edits: "stones.drag",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "1/s",
        [0.0, 2000.0],
        [30.0, 150.0, 600.0],
        Prior::log_normal(150.0, 3.0),
    )],
    signature: Signature {
        channels: &["acceleration_y", "drawbar_pull", "driving_torque"],
        bound: Bound::Condition,
        dependence: "stones give way more slowly: less noise at low slip; pull and torque rise with slip and speed, at which they are pushed aside",
    },
    confusers: &["low_pass", "gain_error", "slope"],
    source: Source::Guess(
        "fines that hold a stone against its own weight at a speed of 330, 65 or 16 mm/s: g over it",
    ),
    law: |setup, drag, seated| on_stones(setup, seated, |stones| stones.drag += drag),
    other_form: Some(OtherForm {
        not_on: &[],
        description: "fines move along: stones heavier in proportion, twice at 150/s",
        law: |setup, drag, seated| {
            on_stones(setup, seated, |stones| {
                stones.density *= 1.0 + drag / DOUBLING;
            })
        },
    }),
};

const SLOPE: Effect = Effect {
    name: "slope",
    title: "uphill slope of the track",
    edits: "rig.slope_deg, added",
    stage: Stage::Physics,
    seats: &[Seat::new(
        "°",
        [-30.0, 30.0],
        [0.3, 1.5, 5.0],
        Prior::normal(1.5),
    )],
    signature: Signature {
        channels: &["drawbar_pull", "normal_force"],
        bound: Bound::Condition,
        dependence: "pull off by the wheel's weight times its sine, the same at every slip, speed and load; load less by its cosine",
    },
    confusers: &[
        "sensor_tilt",
        "gravel_embedding",
        "bias_drift",
        "bulldozing",
    ],
    source: Source::Guess("5 mm over a track of 1 m is 0.3°; rovers climb to 20°"),
    law: |setup, slope, _| {
        *setup.rig.slope_deg_mut() += slope;
        Ok(())
    },
    other_form: None,
};
