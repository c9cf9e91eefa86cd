//! Input of the identification: one row of loads per steady interval, and the wheel.

use super::IdentifyError;
use super::known::Known;
use super::law::Law;
use crate::quantity::RangeError;
use crate::soil::closed_form::Rim;
use crate::soil::wheel_load::{Rolling, WheelLoad};
use crate::terrain::class::Wtic;
use crate::trace::RunAttributes;
use serde::{Deserialize, Serialize};

/// Sinkage \[m\] assumed on ground that lugs do not enter (Section 5.3).
pub const RIGID_SINKAGE: f64 = 1.0e-5;

/// Slip ratio [-] at the outermost circle up to which a wheel on hard ground (ALCT) is held by static
/// friction: there pull and torque are below those of Eq. (68), and only the load of the row is used. A
/// lugged wheel rolls on its lug tips.
pub const STATIC_SLIP: f64 = 0.01;

/// Loads, slip and sinkage of one interval of steady rolling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteadyLoad {
    /// Slip ratio `s` [-] by the rim's radius.
    pub slip: f64,
    /// Sinkage `z` \[m\] of the rim; NaN where it was not measured, which is an error only for [`Wtic::Leis`].
    pub sinkage: f64,
    /// Drawbar pull `F_DP` \[N\].
    pub drawbar_pull: f64,
    /// Vertical load `W` \[N\].
    pub load: f64,
    /// Driving torque `T_D` [N·m]; NaN where it was not measured.
    pub driving_torque: f64,
    /// Standard uncertainties, where they are known.
    pub uncertainty: Option<Uncertainty>,
}

/// Standard uncertainties of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Of the slip ratio [-]; 0 where it is exact.
    pub slip: f64,
    /// Of the sinkage \[m\]; 0 where it is exact.
    pub sinkage: f64,
    /// Of the drawbar pull \[N\].
    pub drawbar_pull: f64,
    /// Of the load \[N\].
    pub load: f64,
    /// Of the driving torque [N·m]; ignored where the row has none.
    pub driving_torque: f64,
}

impl SteadyLoad {
    /// `loads` at a `slip` [-] and `sinkage` \[m\], without uncertainties.
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

    /// Mean of rows, without uncertainties; `None` of no rows. NaN if one of them lacks torque or sinkage.
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

    /// A slip and sinkage without loads.
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

/// The cylinder equivalent to the lugged wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cylinder {
    /// The rim, radius `r`, as in the paper.
    #[default]
    Rim,
    /// The circle through the lug tips, radius `r + l`: it is `l` deeper than the rim, and slip is taken at
    /// its radius.
    LugTips,
}

/// Wheel, conventions and law of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// The rim.
    pub rim: Rim,
    /// Lug height `l` \[m\].
    pub lug_height: f64,
    /// The cylinder whose radius the paper's equations use for sinkage, slip, torque and shear displacement.
    pub cylinder: Cylinder,
    /// Exit angle coefficient `c_3` [-], which the paper does not list: stated, not fitted; default 0.
    pub exit_angle: f64,
    /// Parameters given from other measurements, not fitted.
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

    /// As [`new`](Self::new), for the wheel of a run.
    pub fn of(run: &RunAttributes) -> Self {
        let rim = Rim {
            radius: run.wheel_radius,
            width: run.wheel_width,
        };
        Self {
            // The rim's equations do not need the lug height.
            lug_height: if run.lug_height.is_nan() {
                0.0
            } else {
                run.lug_height
            },
            ..Self::new(rim)
        }
    }

    /// The cylinder of the equations.
    pub fn surface(&self) -> Rim {
        Rim {
            radius: self.rim.radius + self.offset(),
            width: self.rim.width,
        }
    }

    /// Whether static friction holds a wheel at `slip` [-] by the rim's radius on ground of `class`, so that
    /// the shear law does not apply.
    pub fn is_held(&self, slip: f64, class: Wtic) -> bool {
        let outermost = self.rim.radius + self.lug_height;
        let slip = Rolling::new(self.rim.radius, slip).slip_at(outermost);
        class == Wtic::Alct && slip.abs() <= STATIC_SLIP
    }

    /// As [`is_held`](Self::is_held), for a row already converted to the cylinder.
    pub(super) fn holds_by_friction(&self, row: &SteadyLoad, class: Wtic) -> bool {
        let radius = self.surface().radius;
        let rim = Rolling::new(radius, row.slip).slip_at(self.rim.radius);
        self.is_held(rim, class)
    }

    /// Depth of the cylinder below the rim [m].
    pub(super) fn offset(&self) -> f64 {
        match (self.law, self.cylinder) {
            (Law::Paper, Cylinder::LugTips) => self.lug_height,
            _ => 0.0,
        }
    }

    /// Height [m] below the rim of the lowest part of the wheel.
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

    /// A `slip` [-] by the rim's radius, converted to the cylinder.
    pub(super) fn slip_on_cylinder(&self, slip: f64) -> f64 {
        if self.offset() == 0.0 {
            return slip;
        }
        Rolling::new(self.rim.radius, slip).slip_at(self.surface().radius)
    }

    /// `row` converted to the cylinder; the row has to be validated.
    pub(super) fn on_cylinder(&self, row: &SteadyLoad, class: Wtic) -> SteadyLoad {
        let slip = self.slip_on_cylinder(row.slip);
        let sinkage = match class {
            Wtic::Leis => row.sinkage + self.offset(),
            _ => RIGID_SINKAGE,
        };
        SteadyLoad {
            slip,
            sinkage,
            uncertainty: row
                .uncertainty
                .map(|u| self.uncertainty_on_cylinder(u, row.slip, class)),
            ..*row
        }
    }

    fn uncertainty_on_cylinder(
        &self,
        uncertainty: Uncertainty,
        slip: f64,
        class: Wtic,
    ) -> Uncertainty {
        const STEP: f64 = 1e-6;
        let steeper = (self.slip_on_cylinder(slip + STEP) - self.slip_on_cylinder(slip - STEP))
            / (2.0 * STEP);
        Uncertainty {
            slip: steeper.abs() * uncertainty.slip,
            ..uncertainty.of_class(class)
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
        let uncertainty = row.uncertainty.map(|u| u.of_class(class));
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
    /// Drops the uncertainty of a sinkage set by the class.
    fn of_class(self, class: Wtic) -> Self {
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
    Limit {
        text: "finite",
        least: -f64::MAX,
    }
    .checked(quantity, unit, value)
}

fn not_negative(quantity: &'static str, unit: &'static str, value: f64) -> Result<f64, RangeError> {
    Limit {
        text: "0 or above and finite",
        least: 0.0,
    }
    .checked(quantity, unit, value)
}

/// Lower limit of a finite number, with its description for errors.
struct Limit {
    text: &'static str,
    least: f64,
}

impl Limit {
    fn checked(
        &self,
        quantity: &'static str,
        unit: &'static str,
        value: f64,
    ) -> Result<f64, RangeError> {
        if value.is_finite() && value >= self.least {
            return Ok(value);
        }
        Err(RangeError {
            quantity,
            unit,
            range: self.text.to_owned(),
            value,
        })
    }
}

/// Validates rows and converts them to the cylinder, with the sinkage of the class.
///
/// # Errors
/// `Setting`, `Row` for the first number out of its range.
pub(super) fn on_cylinder(
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
        Ok(setting.on_cylinder(row, class))
    });
    seen.collect()
}
