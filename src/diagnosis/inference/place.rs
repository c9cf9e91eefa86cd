//! Layout of statistics and of the coefficients of effects.

/// Coefficients of an effect.
pub const CURVE: usize = 3;

/// Where a column belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Its condition.
    pub condition: usize,
    /// Its statistic of its channel, the same number in all conditions.
    pub cell: usize,
    /// Its channel.
    pub channel: usize,
}
