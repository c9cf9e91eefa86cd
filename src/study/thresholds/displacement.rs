//! How a wheel would move on a run's ground if it rolled there without slipping.
//!
//! (55) and (56) are derived for the displacement of Section 2: the wheel is lowered at the run's axle
//! position at the start of the window and turned by the run's own wheel angle over the run's own ground,
//! without slip ([`rolling`]). The axle's position is the commanded one, since both rigs control its speed.

use super::row::DisplacementRow;
use crate::features::Extractor;
use crate::features::record::Record;
use crate::scenario::Scenario;
use crate::simulation::rig::Command;
use crate::statistics::sorted;
use crate::study::cells::Number;
use crate::terrain::class::TerrainLabel;
use crate::terrain::profile::Profile;
use crate::terrain::{Stretch, Terrain};
use crate::vibration::bounds;
use crate::vibration::flat_ground;
use crate::vibration::outline::Support;
use crate::vibration::rolling::{self, Pose, Stay};
use crate::vibration::simplified::Scaling;
use crate::wheel::Wheel;
use std::collections::BTreeSet;
use std::ops::Range;

/// Poses of a path in a lug angle: a stay loses the heights of a pose at either end, 0.8 % of the
/// reference's amplitude each.
const POSES: f64 = 256.0;

/// Time step [s] of the sum that makes a place of a speed.
const STEP: f64 = 1.0e-3;

/// The fixed ground of a run, and where its axle was.
pub(super) struct Ground {
    wheel: Wheel,
    command: Command,
    stretches: Vec<(Stretch, Profile)>,
}

impl Ground {
    /// The ground under `terrain`, where all of it is fixed and rigid.
    pub fn of(scenario: &Scenario, terrain: &Terrain) -> Option<Self> {
        let fixed = [TerrainLabel::Reference, TerrainLabel::Hard];
        let stretches = terrain.stretches();
        if !stretches
            .iter()
            .all(|stretch| fixed.contains(&stretch.label))
        {
            return None;
        }
        let profiled = |stretch: &Stretch| (stretch.clone(), terrain.profile(stretch));
        Some(Self {
            wheel: scenario.wheel,
            command: Command::new(scenario.rig.drive(), scenario.wheel.radius).ok()?,
            stretches: stretches.iter().map(profiled).collect(),
        })
    }

    /// The displacement in the samples `window`; `None` without lugs, at rest, or where no lug's
    /// stay is whole.
    pub fn displacement(
        &mut self,
        record: &Record,
        window: &Range<usize>,
        extractor: &mut Extractor,
    ) -> Option<DisplacementRow> {
        let wheel = self.wheel;
        let alpha = wheel.lug_angle()?;
        let [from, to] = [window.start, window.end - 1].map(|sample| record.angle[sample]);
        let poses = (POSES * (to - from).abs() / alpha).ceil();
        let angle = |pose: usize| from + (to - from) * pose as f64 / poses;
        let wheel_angles: Vec<f64> = (0..=poses as usize).map(angle).collect();
        let position = self.position(record.time(window.start));
        let path = rolling::path(&wheel, |x| self.height(x), position, &wheel_angles);
        let stays = rolling::stays(&path);
        let of_lugs = |stay: &&Stay| matches!(stay.support, Support::Lug(_));
        let whole = stays.get(1..stays.len().max(2) - 1)?.iter();
        let scalings: Vec<Scaling> = whole
            .filter(of_lugs)
            .filter_map(|stay| Scaling::of(stay, &wheel))
            .collect();
        let amplitudes = sorted(scalings.iter().map(|scaling| scaling.amplitude));
        let largest = *amplitudes.last()?;
        let reference: Vec<f64> = wheel_angles
            .iter()
            .map(|angle| flat_ground::displacement(&wheel, *angle))
            .collect();
        let steepest = self.steepest(&path);
        let on_slope = || bounds::amplitude_bound_on_slope(wheel.lug_count(), steepest);
        let longest = scalings.iter().map(|s| s.stretch).fold(0.0, f64::max);
        let ratios = extractor.displacement_ratios(&rolling::displacement(&path), &reference);
        Some(DisplacementRow {
            rolled_touched_share: touched_share(&path)?.into(),
            steepest: steepest.into(),
            bound_on_slope: wheel.is_multi_lugged().then(on_slope).into(),
            c_m: [amplitudes[amplitudes.len() / 2], largest].map(Number::from),
            c_f_largest: longest.into(),
            kappa: ratios.map(Number::from),
            relative: means_over_turn(&scalings).map(Number::from),
        })
    }

    /// Position of the axle at `time` [s] along the track [m].
    fn position(&self, time: f64) -> f64 {
        let steps = (time / STEP).round().max(0.0) as u32;
        let speed = |step: u32| {
            let middle = (f64::from(step) + 0.5) * STEP;
            self.command.at(middle).forward_speed
        };
        (0..steps).map(|step| speed(step) * STEP).sum()
    }

    fn height(&mut self, x: f64) -> f64 {
        let found = self
            .stretches
            .iter_mut()
            .find(|(stretch, _)| x < stretch.range[1]);
        let Some((_, profile)) = found else {
            return 0.0;
        };
        profile.extend(x, x);
        profile.at(x).height
    }

    /// Steepest line between contacts of lugs that follow each other [rad].
    fn steepest(&mut self, path: &[Pose]) -> f64 {
        let is_lug = |pose: &Pose| matches!(pose.support, Support::Lug(_));
        let slopes = path.windows(2).filter_map(|pair| {
            let changes = pair[0].support != pair[1].support;
            (changes && pair.iter().all(is_lug)).then(|| {
                let [a, b] = [pair[0].contact, pair[1].contact];
                let rise = self.height(b) - self.height(a);
                libm::atan2(rise.abs(), (b - a).abs())
            })
        });
        slopes.fold(0.0, f64::max)
    }
}

/// Share of the lugs passed that carried the wheel.
fn touched_share(path: &[Pose]) -> Option<f64> {
    let counts = path.iter().map(|pose| pose.lugs_counted);
    let passed = counts.clone().max()? - counts.min()? + 1;
    let carried = path
        .iter()
        .filter(|pose| matches!(pose.support, Support::Lug(_)));
    let carried: BTreeSet<i64> = carried.map(|pose| pose.lugs_counted).collect();
    Some(carried.len() as f64 / passed as f64)
}

/// Means of `C_f²` and `C_f⁴` over the turn.
fn means_over_turn(scalings: &[Scaling]) -> [f64; 2] {
    let turn: f64 = scalings.iter().map(|scaling| scaling.stretch).sum();
    let [square, fourth] = scalings
        .iter()
        .fold([0.0, 0.0], |[square, fourth], scaling| {
            let c_f = scaling.stretch;
            let squared = c_f * c_f;
            [square + c_f * squared, fourth + c_f * squared * squared]
        });
    [square / turn, fourth / turn]
}
