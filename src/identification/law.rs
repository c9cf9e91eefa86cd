//! The equations fitted to the loads.

use crate::quantity::RangeError;
use crate::soil::StressConvention;
use crate::wheel::Lugs;
use std::f64::consts::TAU;

/// Equations of soil that lugs enter; on ground that lugs do not enter, Eq. (62)-(69) apply.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Law {
    /// Eq. (62)-(66): triangular stress on a smooth cylinder.
    #[default]
    Paper,
    /// The simulator's quadrature of stress over rim and lugs ([`crate::soil::wheel_load`]).
    Own(Own),
}

/// Inputs of the quadrature besides the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Own {
    /// The wheel's lugs.
    pub lugs: Option<Lugs>,
    /// Distribution of stress over the contact.
    pub convention: StressConvention,
    /// Bulk density [kg/m³] of the soil that pushes lugs.
    pub bulk_density: f64,
}

impl Own {
    /// Depth of the lug tips below the rim [m].
    pub(super) fn lug_height(&self) -> f64 {
        self.lugs.map_or(0.0, |lugs| lugs.height)
    }

    /// # Errors
    /// `RangeError` for lugs or a density outside their ranges, and for lugs that do not fit on a rim of
    /// `radius` [m].
    pub(super) fn checked(&self, radius: f64) -> Result<(), RangeError> {
        RangeError::positive("bulk density", "kg/m³", self.bulk_density)?;
        let Some(lugs) = self.lugs else {
            return Ok(());
        };
        RangeError::positive("lug height", "m", lugs.height)?;
        let pitch = TAU * radius / f64::from(lugs.count);
        RangeError::check("lug thickness", "m", lugs.thickness, [0.0, pitch])?;
        Ok(())
    }
}
