//! Definition of slip by a rig: by another radius than the rim's, or zero where the torque is.
//!
//! `s = 1 - v/(ω R)` depends on the radius `R` assigned to the wheel. Here `R` is the rim's; rigs also use
//! that of the lugs' tips, or define slip 0 where the torque vanishes. The motion is the same, so a slip by
//! another radius is converted to the rim's through the travel per turn, `v/ω`.
//!
//! Where slip is 0 at zero torque, `v/ω` was not measured there. It is assumed to be pure rolling of the
//! circle through the tips. For the lugged wheel of Ding et al. (2011), whose torque is 0 at slip 0, the
//! quadrature's torque vanishes at 0.003 by the tips and at -0.057 by the rim; one soil for its smooth and
//! its lugged wheel gives a sum of squares of 243 by the tips, of 420 by the shear radius and of 552 by the
//! rim (36 values).

use super::Misplaced;
use super::description::{SlipRadius, SlipZero, SourceTable};
use super::source::Source;
use crate::soil::lug_action::shear_radius;
use crate::soil::wheel_load::Rolling;
use crate::soil::{Soil, table_6};
use crate::trace::{Channel, Mean, Trace};
use crate::wheel::Wheel;

/// Friction angle [°] for which the shear radius is taken; by 20° more or less it moves by a tenth of
/// the lugs' height.
const FRICTION: f64 = 30.0;

/// Counts the slip of a run by the rim's radius, where its campaign counts it otherwise, and notes it.
///
/// # Errors
/// The key that is at fault, and why.
pub(super) fn count_by_rim(source: Source<'_>, trace: &mut Trace) -> Result<(), Misplaced> {
    let at = |key: &str, message: &str| source.fault(key, message);
    let origin = SlipOrigin::of(source.table).map_err(|(key, message)| at(key, message))?;
    let key = match origin.zero {
        SlipZero::Torque => "slip_zero",
        SlipZero::Speed => "slip_radius",
    };
    let note = origin
        .count_by_rim(trace)
        .map_err(|message| at(key, message))?;
    if let Some(note) = note {
        source.notes.of_run(note);
    }
    Ok(())
}

/// Where the slip of a file is counted from.
#[derive(Debug, Clone, Copy)]
struct SlipOrigin {
    radius: SlipRadius,
    zero: SlipZero,
}

impl SlipOrigin {
    /// The definition in a table of a campaign.
    ///
    /// # Errors
    /// The key that contradicts another, and why.
    fn of(table: &SourceTable) -> Result<Self, (&'static str, &'static str)> {
        let radius = table.slip_radius.unwrap_or_default();
        let zero = table.slip_zero.unwrap_or_default();
        if zero == SlipZero::Torque && table.slip_radius.is_some() {
            return Err((
                "slip_zero",
                "a slip that is 0 where the torque is has no radius; keep slip_radius or slip_zero",
            ));
        }
        let other = radius != SlipRadius::Rim || zero == SlipZero::Torque;
        if other && table.rim_speed_m_s.is_some() {
            return Err((
                "rim_speed_m_s",
                "the rim's speed gives the slip by the rim; leave slip_radius and slip_zero out, or give slip_ratio",
            ));
        }
        Ok(Self { radius, zero })
    }

    /// Counts the slip of a run by the rim's radius; what was done, where it was counted otherwise.
    ///
    /// # Errors
    /// What has to be known of the wheel.
    fn count_by_rim(self, trace: &mut Trace) -> Result<Option<String>, &'static str> {
        if self.radius == SlipRadius::Rim && self.zero == SlipZero::Speed {
            return Ok(None);
        }
        let rim = trace.attributes.wheel_radius;
        let counted = self.counted(trace)?;
        if counted == rim {
            return Ok(None);
        }
        // Unknown values stay unknown.
        let by_rim = |slip: f64| {
            if slip.is_nan() {
                slip
            } else {
                Rolling::new(counted, slip).slip_at(rim)
            }
        };
        trace.attributes.slip_ratio = by_rim(trace.attributes.slip_ratio);
        for Channel { name, samples, .. } in &mut trace.channels {
            if name == "slip_ratio" {
                samples.iter_mut().for_each(|slip| *slip = by_rim(*slip));
            }
        }
        for Mean {
            name, value, sd, ..
        } in &mut trace.means
        {
            if name == "slip_ratio" {
                const STEP: f64 = 1.0e-6;
                let slope = (by_rim(*value + STEP) - by_rim(*value - STEP)) / (2.0 * STEP);
                (*value, *sd) = (by_rim(*value), slope.abs() * *sd);
            }
        }
        let from = match (self.zero, self.radius) {
            (SlipZero::Torque, _) => "0 at no torque, taken for rolling on the lugs' tips",
            (_, SlipRadius::Shear) => "by the shear radius",
            _ => "by the lugs' tips",
        };
        Ok(Some(format!(
            "slip_ratio was counted {from} ({:.2} mm); it is by the rim ({:.2} mm)",
            1.0e3 * counted,
            1.0e3 * rim
        )))
    }

    /// The radius [m] by which the slip of a run is counted.
    fn counted(self, trace: &Trace) -> Result<f64, &'static str> {
        let run = &trace.attributes;
        let lugs = run.lugs();
        if run.wheel_radius.is_nan() {
            return Err("slip by another radius needs the rim's: give wheel.radius_m");
        }
        if lugs.are_none() {
            return Ok(run.wheel_radius);
        }
        if lugs.height.is_nan() {
            return Err(
                "slip by another radius needs the lugs: give wheel.lug_height_m, 0 of a smooth wheel",
            );
        }
        let tips = run.wheel_radius + lugs.height;
        match (self.radius, lugs.count) {
            (SlipRadius::Shear, None) => {
                Err("the shear radius needs the number of lugs: give wheel.lug_count")
            }
            (SlipRadius::Shear, Some(count)) => {
                let wheel = Wheel::of_outline(run.wheel_radius, 1.0, count, lugs.height);
                let soil = Soil {
                    friction_angle_deg: FRICTION,
                    ..table_6::sand()
                };
                Ok(shear_radius(&wheel, &soil))
            }
            _ => Ok(tips),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::RunAttributes;

    fn trace(slip: f64) -> Trace {
        Trace {
            attributes: RunAttributes {
                wheel_radius: 0.15735,
                lug_count: Some(30),
                lug_height: 0.010,
                slip_ratio: slip,
                ..RunAttributes::default()
            },
            ..Trace::default()
        }
    }

    fn by_rim(radius: SlipRadius, zero: SlipZero, slip: f64) -> f64 {
        let mut trace = trace(slip);
        SlipOrigin { radius, zero }
            .count_by_rim(&mut trace)
            .unwrap();
        trace.attributes.slip_ratio
    }

    #[test]
    fn a_wheel_that_rolls_on_its_tips_slips_backward_by_the_rim() {
        // v/ω = r + l, more than the rim's r: 1 - (r + l)/r braking is r/(r + l) - 1.
        let expected = 0.15735 / 0.16735 - 1.0;
        for [radius, zero] in [
            (SlipRadius::Tips, SlipZero::Speed),
            (SlipRadius::Rim, SlipZero::Torque),
        ]
        .map(|(radius, zero)| [by_rim(radius, zero, 0.0), expected])
        {
            assert!((radius - zero).abs() < 1e-12);
        }
        // The same travel per turn: (1 - 0.3)(r + l) = (1 - s) r.
        let slipping = by_rim(SlipRadius::Tips, SlipZero::Speed, 0.3);
        assert!((slipping - (1.0 - 0.7 * 0.16735 / 0.15735)).abs() < 1e-12);
        assert_eq!(by_rim(SlipRadius::Rim, SlipZero::Speed, 0.3), 0.3);
        assert!(by_rim(SlipRadius::Tips, SlipZero::Speed, f64::NAN).is_nan());
    }

    #[test]
    fn the_shear_radius_lies_between_rim_and_tips() {
        let [rim, shear, tips] = [SlipRadius::Rim, SlipRadius::Shear, SlipRadius::Tips]
            .map(|radius| by_rim(radius, SlipZero::Speed, 0.2));
        assert!(tips < shear && shear < rim);
    }

    #[test]
    fn lugs_of_unknown_height_have_no_tips() {
        let mut trace = trace(0.1);
        trace.attributes.lug_height = f64::NAN;
        let origin = SlipOrigin {
            radius: SlipRadius::Tips,
            zero: SlipZero::Speed,
        };
        assert!(
            origin
                .count_by_rim(&mut trace)
                .unwrap_err()
                .contains("lug_height_m")
        );
    }
}
