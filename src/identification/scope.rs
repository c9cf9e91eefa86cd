//! Range of validity of the identified parameters: the soil, or only this wheel and load.

use super::law::Law;
use super::row::SteadyLoad;
use crate::trace::wheel::Lugs;
use std::fmt;

/// Ratio of greatest to least load [-] below which all rows count as one load: at a ratio of 1.5 a wheel
/// sinks a fifth deeper on most soils (`z ∝ W^(2/(2 n + 1))`, n about 1), which is within the scatter.
const ONE_LOAD: f64 = 1.5;

/// Why parameters are effective ones, of the wheel and load of the rows, and not the soil's own.
///
/// Eq. (62)-(66) describe a smooth cylinder: under a lugged wheel the parameters absorb the load, thrust and
/// digging of the lugs. Under one load, pressure and sinkage vary together only along one curve over slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scope {
    /// The wheel's lugs, unless it is known to be smooth.
    pub lugs: Option<Lugs>,
    /// Least and greatest load \[N\], where the rows count as one load.
    pub one_load: Option<[f64; 2]>,
}

impl Scope {
    /// Whether rows count as one load.
    pub fn is_one_load(rows: &[SteadyLoad]) -> bool {
        one_load(rows).is_some()
    }

    /// Why the parameters of these rows are effective; `None` where they may be the soil's: several loads,
    /// and either a wheel known to be smooth or a law that includes the lugs.
    pub fn of(law: &Law, lugs: Lugs, rows: &[SteadyLoad]) -> Option<Self> {
        let scope = Self {
            lugs: (*law == Law::Paper && !lugs.are_none()).then_some(lugs),
            one_load: one_load(rows),
        };
        (scope.lugs.is_some() || scope.one_load.is_some()).then_some(scope)
    }
}

/// Least and greatest load [N] of rows that count as one load.
fn one_load(rows: &[SteadyLoad]) -> Option<[f64; 2]> {
    let loads = || rows.iter().map(|row| row.load);
    let least = loads().fold(f64::INFINITY, f64::min);
    let most = loads().fold(0.0, f64::max);
    (most < ONE_LOAD * least).then_some([least, most])
}

impl fmt::Display for Scope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("effective, for this wheel and load only: ")?;
        if let Some(lugs) = self.lugs {
            write!(f, "(62)-(66) describe a smooth wheel ({lugs})")?;
        }
        if self.lugs.is_some() && self.one_load.is_some() {
            f.write_str("; ")?;
        }
        match self.one_load {
            Some([least, most]) if most - least < 0.05 => {
                write!(f, "rows of one load ({least:.1} N)")
            }
            Some([least, most]) => write!(f, "rows of one load ({least:.1} to {most:.1} N)"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(loads: &[f64]) -> Vec<SteadyLoad> {
        let row = |load: &f64| SteadyLoad {
            load: *load,
            ..SteadyLoad::at(0.1, 0.01)
        };
        loads.iter().map(row).collect()
    }

    #[test]
    fn only_a_smooth_wheel_under_several_loads_may_have_the_soils_own_parameters() {
        let lugged = Lugs::stated(Some(28), 0.015);
        let unknown = Lugs::stated(None, f64::NAN);
        let [several, one] = [rows(&[60.0, 100.0]), rows(&[99.0, 101.0])];
        assert_eq!(Scope::of(&Law::Paper, Lugs::NONE, &several), None);
        assert!(
            Scope::of(&Law::Paper, Lugs::NONE, &one)
                .unwrap()
                .one_load
                .is_some()
        );
        assert!(
            Scope::of(&Law::Paper, lugged, &several)
                .unwrap()
                .one_load
                .is_none()
        );
        let words = Scope::of(&Law::Paper, unknown, &several)
            .unwrap()
            .to_string();
        assert!(words.contains("smooth wheel (lugs not given)"), "{words}");
    }
}
