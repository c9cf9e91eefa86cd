//! Parameters given from other measurements.

use super::parameter::{Coordinates, Parameter};
use crate::quantity::RangeError;

/// Given values of parameters that are not fitted: from plate tests, a shear box, or another wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known([Option<f64>; Parameter::ALL.len()]);

impl Known {
    /// Adds `parameter` at `value`, in its [`unit`](Parameter::unit).
    #[must_use]
    pub fn with(mut self, parameter: Parameter, value: f64) -> Self {
        self.0[parameter as usize] = Some(value);
        self
    }

    /// The value of `parameter`, in its [`unit`](Parameter::unit), if given.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        self.0[parameter as usize]
    }

    /// # Errors
    /// `RangeError` for the first value outside the [range](Parameter::range) of its parameter.
    pub(super) fn checked(&self) -> Result<(), RangeError> {
        for parameter in Parameter::ALL {
            let Some(value) = self.get(parameter) else {
                continue;
            };
            parameter.checked(value)?;
        }
        Ok(())
    }

    /// Sets the given values among the coordinates.
    pub(super) fn put(&self, at: &mut Coordinates) {
        for parameter in Parameter::ALL {
            if let Some(value) = self.get(parameter) {
                at[parameter as usize] = parameter.coordinate(value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_out_of_its_range_is_refused_by_name() {
        let known = Known::default().with(Parameter::ShearModulus, 11.4);
        let message = known.checked().unwrap_err().to_string();
        assert!(message.starts_with("K [m] must be in"), "{message}");
    }
}
