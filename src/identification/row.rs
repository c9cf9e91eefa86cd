//! What the identification reads: one row of loads per steady interval, and on which wheel.

use super::IdentifyError;
use super::known::Known;
use super::law::Law;
use crate::quantity::RangeError;
use crate::soil::closed_form::Rim;
use crate::soil::wheel_load::{Rolling, WheelLoad};
use crate::terrain::class::Wtic;
use crate::trace::RunAttributes;
use serde::Deserialize;

/// Sinkage [m] that stands for ground that lugs do not enter (Section 5.3).
pub const RIGID_SINKAGE: f64 = 1.0e-5;

/// Slip ratio [-] of the outermost circle up to which a wheel on hard ground (ALCT) is held by
/// static friction: there pull and torque are below what Eq. (68) gives, and the row counts for
/// the load only. A lugged wheel rolls on its lugs' edges.
pub const STATIC_SLIP: f64 = 0.01;

/// Loads, slip and sinkage of one interval of steady rolling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyLoad {
    /// Slip ratio `s` [-] by the rim's radius.
    pub slip: f64,
    /// Sinkage `z` [m] of the rim; not a number where it was not measured, which only
    /// [`Wtic::Leis`] minds.
    pub sinkage: f64,
    /// Drawbar pull `F_DP` [N].
    pub drawbar_pull: f64,
    /// Vertical load `W` [N].
    pub load: f64,
    /// Driving torque `T_D` [N·m]; not a number where it was not measured.
    pub driving_torque: f64,
    /// Standard uncertainties, where they are known.
    pub uncertainty: Option<Uncertainty>,
}

/// Standard uncertainties of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Of the slip ratio [-]; 0 where it is exact.
    pub slip: f64,
    /// Of the sinkage [m]; 0 where it is exact.
    pub sinkage: f64,
    /// Of the drawbar pull [N].
    pub drawbar_pull: f64,
    /// Of the load [N].
    pub load: f64,
    /// Of the driving torque [N·m]; any where the row has none.
    pub driving_torque: f64,
}

impl SteadyLoad {
    /// `loads` at a `slip` [-] and `sinkage` [m], their uncertainties unknown.
    pub fn new(slip: f64, sinkage: f64, loads: WheelLoad) -> Self {
        Self {
            slip,
            sinkage,
            drawbar_pull: loads.drawbar_pull,
            load: loads.normal_force,
            driving_torque: loads.driving_torque,
            uncertainty: None,
        }
    }

    /// Mean of rows, their uncertainties unknown; none of none. A torque or sinkage that one lacks is unknown.
    pub fn mean<'a>(rows: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let rows: Vec<&Self> = rows.into_iter().collect();
        let mean = |of: fn(&Self) -> f64| {
            let values = rows.iter().map(|row| of(row));
            values.sum::<f64>() / rows.len() as f64
        };
        (!rows.is_empty()).then(|| Self {
            slip: mean(|row| row.slip),
            sinkage: mean(|row| row.sinkage),
            drawbar_pull: mean(|row| row.drawbar_pull),
            load: mean(|row| row.load),
            driving_torque: mean(|row| row.driving_torque),
            uncertainty: None,
        })
    }

    /// Where a wheel rolls, its loads unknown.
    pub(super) fn at(slip: f64, sinkage: f64) -> Self {
        let unknown = WheelLoad {
            normal_force: f64::NAN,
            drawbar_pull: f64::NAN,
            driving_torque: f64::NAN,
        };
        Self::new(slip, sinkage, unknown)
    }

    /// Whether the row has a torque.
    pub fn has_torque(&self) -> bool {
        !self.driving_torque.is_nan()
    }
}

/// Which cylinder stands for the lugged wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cylinder {
    /// The rim, radius `r`, as in the paper.
    #[default]
    Rim,
    /// The circle through the lugs' edges, radius `r + l`: it sinks `l` deeper than the rim, and
    /// slip is by its radius.
    LugTips,
}

/// What the equations need besides the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The rim.
    pub rim: Rim,
    /// Lug height `l` [m].
    pub lug_height: f64,
    /// The cylinder in whose radius the paper's equations take sinkage, slip, torque and shear
    /// displacement.
    pub cylinder: Cylinder,
    /// Exit angle coefficient `c_3` [-], which the paper does not list: stated, not fitted. 0
    /// unless it is known better.
    pub exit_angle: f64,
    /// Parameters measured otherwise, which are not fitted.
    pub known: Known,
    /// The equations.
    pub law: Law,
}

impl Setting {
    /// The paper's equations and convention, the rim's radius throughout, and `c_3 = 0`.
    pub fn new(rim: Rim) -> Self {
        Self {
            rim,
            lug_height: 0.0,
            cylinder: Cylinder::Rim,
            exit_angle: 0.0,
            known: Known::default(),
            law: Law::Paper,
        }
    }

    /// The same for the wheel of a run.
    pub fn of(run: &RunAttributes) -> Self {
        let rim = Rim {
            radius: run.wheel_radius,
            width: run.wheel_width,
        };
        Self {
            // The rim's equations do not need a height that nobody knows.
            lug_height: if run.lug_height.is_nan() {
                0.0
            } else {
                run.lug_height
            },
            ..Self::new(rim)
        }
    }

    /// The cylinder the equations see.
    pub fn surface(&self) -> Rim {
        Rim {
            radius: self.rim.radius + self.offset(),
            width: self.rim.width,
        }
    }

    /// Whether static friction holds a wheel at `slip` [-] by the rim's radius on ground of
    /// `class`, so that the shear law does not describe its pull and torque.
    pub fn is_held(&self, slip: f64, class: Wtic) -> bool {
        let outermost = self.rim.radius + self.lug_height;
        let slip = Rolling::new(self.rim.radius, slip).slip_at(outermost);
        class == Wtic::Alct && slip.abs() <= STATIC_SLIP
    }

    /// The same of a row that the cylinder has seen.
    pub(super) fn holds(&self, seen: &SteadyLoad, class: Wtic) -> bool {
        let radius = self.surface().radius;
        let rim = Rolling::new(radius, seen.slip).slip_at(self.rim.radius);
        self.is_held(rim, class)
    }

    /// By how much the cylinder sinks deeper than the rim [m].
    pub(super) fn offset(&self) -> f64 {
        match (self.law, self.cylinder) {
            (Law::Paper, Cylinder::LugTips) => self.lug_height,
            _ => 0.0,
        }
    }

    /// Height [m] below the rim of what may be all that is in the soil.
    fn lowest(&self) -> f64 {
        match self.law {
            Law::Paper => self.offset(),
            Law::Own(own) => own.lug_height(),
        }
    }

    pub(super) fn checked(&self) -> Result<(), RangeError> {
        RangeError::positive("wheel radius", "m", self.rim.radius)?;
        if let Law::Own(own) = &self.law {
            own.checked(self.rim.radius)?;
        }
        RangeError::positive("wheel width", "m", self.rim.width)?;
        RangeError::check("lug height", "m", self.lug_height, [0.0, self.rim.radius])?;
        RangeError::check("exit angle coefficient", "-", self.exit_angle, [-1.0, 0.0])?;
        self.known.checked()
    }

    /// A `slip` [-] by the rim's radius as the cylinder sees it.
    pub(super) fn slip_seen(&self, slip: f64) -> f64 {
        if self.offset() == 0.0 {
            return slip;
        }
        Rolling::new(self.rim.radius, slip).slip_at(self.surface().radius)
    }

    /// `row` as the cylinder sees it, once it is known to be whole.
    pub(super) fn seen(&self, row: &SteadyLoad, class: Wtic) -> SteadyLoad {
        let slip = self.slip_seen(row.slip);
        let sinkage = match class {
            Wtic::Leis => row.sinkage + self.offset(),
            _ => RIGID_SINKAGE,
        };
        SteadyLoad {
            slip,
            sinkage,
            uncertainty: row
                .uncertainty
                .map(|u| self.seen_uncertainty(u, row.slip, class)),
            ..*row
        }
    }

    fn seen_uncertainty(&self, uncertainty: Uncertainty, slip: f64, class: Wtic) -> Uncertainty {
        const STEP: f64 = 1e-6;
        let steeper = (self.slip_seen(slip + STEP) - self.slip_seen(slip - STEP)) / (2.0 * STEP);
        Uncertainty {
            slip: steeper.abs() * uncertainty.slip,
            ..uncertainty.of_seen(class)
        }
    }

    fn check_row(&self, row: &SteadyLoad, class: Wtic) -> Result<(), RangeError> {
        RangeError::check("slip ratio", "-", row.slip, [-1.0, 1.0])?;
        if class == Wtic::Leis {
            self.check_sinkage(row.sinkage)?;
        }
        finite("drawbar pull", "N", row.drawbar_pull)?;
        RangeError::positive("load", "N", row.load)?;
        if row.has_torque() {
            finite("driving torque", "N·m", row.driving_torque)?;
        }
        let uncertainty = row.uncertainty.map(|u| u.of_seen(class));
        uncertainty.map_or(Ok(()), |uncertainty| uncertainty.checked(row.has_torque()))
    }

    fn check_sinkage(&self, sinkage: f64) -> Result<(), RangeError> {
        let [least, most] = [-self.lowest(), self.rim.radius];
        if sinkage > least && sinkage <= most {
            return Ok(());
        }
        Err(RangeError {
            quantity: "sinkage",
            unit: "m",
            range: format!("above {} and not above the radius {most}", least + 0.0),
            value: sinkage,
        })
    }
}

impl Uncertainty {
    /// Without the sinkage's where the class sets the sinkage.
    fn of_seen(self, class: Wtic) -> Self {
        let sinkage = if class == Wtic::Leis {
            self.sinkage
        } else {
            0.0
        };
        Self { sinkage, ..self }
    }

    fn checked(&self, torque: bool) -> Result<(), RangeError> {
        not_negative("uncertainty of the slip ratio", "-", self.slip)?;
        not_negative("uncertainty of the sinkage", "m", self.sinkage)?;
        RangeError::positive("uncertainty of the drawbar pull", "N", self.drawbar_pull)?;
        RangeError::positive("uncertainty of the load", "N", self.load)?;
        if torque {
            let sd = self.driving_torque;
            RangeError::positive("uncertainty of the driving torque", "N·m", sd)?;
        }
        Ok(())
    }
}

fn finite(quantity: &'static str, unit: &'static str, value: f64) -> Result<f64, RangeError> {
    within(quantity, unit, value, ("finite", -f64::MAX))
}

fn not_negative(quantity: &'static str, unit: &'static str, value: f64) -> Result<f64, RangeError> {
    within(quantity, unit, value, ("0 or above and finite", 0.0))
}

/// Passes a finite `value` from `least` on, which `range` tells.
fn within(
    quantity: &'static str,
    unit: &'static str,
    value: f64,
    (range, least): (&str, f64),
) -> Result<f64, RangeError> {
    if value.is_finite() && value >= least {
        return Ok(value);
    }
    Err(RangeError {
        quantity,
        unit,
        range: range.to_owned(),
        value,
    })
}

/// Rows as the cylinder sees them, sinkage set where the class sets it.
///
/// # Errors
/// `Setting`, `Row` for the first number out of its range.
pub(super) fn seen(
    rows: &[SteadyLoad],
    class: Wtic,
    setting: &Setting,
) -> Result<Vec<SteadyLoad>, IdentifyError> {
    setting.checked().map_err(IdentifyError::Setting)?;
    let seen = rows.iter().enumerate().map(|(index, row)| {
        let checked = setting.check_row(row, class);
        checked.map_err(|reason| IdentifyError::Row {
            row: index + 1,
            reason,
        })?;
        Ok(setting.seen(row, class))
    });
    seen.collect()
}
