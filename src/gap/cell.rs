//! The cells of the gap map: one statistic of one channel, under a name that stays.

mod text;

pub use text::NoCell;

use crate::identification::Parameter;
use crate::terrain::class::Wtic;
use crate::trace::unit_of;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::sync::Arc;

/// Domain of a statistic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Domain {
    /// Samples, whatever their order in the turn of the wheel.
    Time,
    /// Locked to the wheel's turn.
    Order,
    /// Locked to the passing of lugs.
    Lug,
    /// Fixed in hertz.
    Frequency,
    /// Two channels together.
    Cross,
    /// Vibration features and the classes recognised from them.
    Feature,
    /// Steady loads.
    Load,
    /// Growing with the way.
    History,
    /// All runs of a campaign together.
    Curve,
}

impl Domain {
    /// All of them, in their order.
    pub const ALL: [Self; 9] = [
        Self::Time,
        Self::Order,
        Self::Lug,
        Self::Frequency,
        Self::Cross,
        Self::Feature,
        Self::Load,
        Self::History,
        Self::Curve,
    ];

    /// Its name in results.
    pub fn as_str(self) -> &'static str {
        [
            "time",
            "order",
            "lug",
            "frequency",
            "cross",
            "feature",
            "load",
            "history",
            "curve",
        ][self as usize]
    }
}

impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What changes from run to run of a campaign.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Covariate {
    /// Commanded slip ratio [-].
    Slip,
    /// Commanded load \[N\].
    Load,
    /// Size of the commanded speed [m/s].
    Speed,
    /// Place of the run in the campaign [-].
    Run,
    /// Forward or in reverse.
    Direction,
}

impl Covariate {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Slip,
        Self::Load,
        Self::Speed,
        Self::Run,
        Self::Direction,
    ];

    fn as_str(self) -> &'static str {
        ["slip", "load", "speed", "run", "direction"][self as usize]
    }
}

/// One of the four vibration features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kappa {
    /// Frequency.
    Frequency,
    /// Sum of amplitudes.
    Amplitude,
    /// Mean value.
    MeanValue,
    /// Mean square.
    MeanSquare,
}

impl Kappa {
    /// All of them, in the order of the feature vector.
    pub const ALL: [Self; 4] = [
        Self::Frequency,
        Self::Amplitude,
        Self::MeanValue,
        Self::MeanSquare,
    ];
}

/// What is read from a channel. "Own unit" is the channel's; a level is 20 lg of an amplitude in
/// it, or 10 lg of a share \[dB\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Statistic {
    /// Mean [own unit].
    Mean,
    /// Level of the standard deviation \[dB\].
    Deviation,
    /// Skewness [-].
    Skewness,
    /// Logarithm of the kurtosis [-].
    Kurtosis,
    /// Level of the largest departure from the mean over the standard deviation \[dB\].
    Crest,
    /// Mean of the last quarter less that of the first [own unit].
    Drift,
    /// Mean of the first tenth of the run minus that of the rest [own unit].
    Transient,
    /// Level of the small steps between samples: the 5 % quantile of those that are not zero \[dB\].
    Step,
    /// Level of the share of samples equal to the one before \[dB\].
    Held,
    /// Level of the share of samples within 1 % of the range from its ends \[dB\].
    Rails,
    /// Level of the amplitude at a wheel order \[dB\].
    OrderLevel(u32),
    /// Cosine part of the wave at a wheel order [own unit].
    OrderCosine(u32),
    /// Sine part of the wave at a wheel order [own unit].
    OrderSine(u32),
    /// Level of the average over the lug's pass \[dB\].
    LugAverage,
    /// Level of what varies about that average \[dB\].
    LugResidue,
    /// Level in a one-third octave about `10^(n/10)` Hz \[dB\].
    Band(i16),
    /// Highest line of that third over its median \[dB\].
    Line(i16),
    /// Inverse hyperbolic tangent of the correlation [-].
    Correlation,
    /// Inverse hyperbolic tangent of the root of the mean coherence [-].
    Coherence,
    /// Time by which the second channel follows the first \[s\].
    Lag,
    /// Level of force per acceleration over 1 kg \[dB\].
    ApparentMass,
    /// Mean of a feature's decimal logarithm over the windows [-].
    Feature(Kappa),
    /// Logit of the share of windows recognised as this class [-].
    ClassShare(Wtic),
    /// Steady mean [own unit].
    SteadyMean,
    /// Steady mean over the load, a torque also over the radius [-].
    PerLoad,
    /// Turning speed of the wheel [rad/s].
    TurningSpeed,
    /// Level of the deviation in the second half over the first's \[dB\].
    Growth,
    /// Slope along the way [own unit per metre].
    PerMetre,
    /// Change of the steady mean from the lowest to the highest value of a covariate, on a
    /// straight line [own unit].
    Slope(Covariate),
    /// Departure of a parabola from its chord half-way between them [own unit].
    Curvature(Covariate),
    /// An identified terrain parameter in the coordinate of its fit [-].
    Identified(Parameter),
    /// Level of the identification's squared residuals per degree of freedom \[dB\].
    Misfit,
}

/// What a difference of a statistic is counted in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Measure {
    /// As a share of how large the value or its channel is.
    Own,
    /// In decibels.
    Level,
    /// In decibels of a share of samples.
    Share,
    /// As the logarithm of odds, of how many windows answer so.
    Odds,
    /// Without unit.
    Number,
}

impl Measure {
    /// Least difference of practical relevance for a value of this size: 1 % of it (another time step changes
    /// means by as much), 0.1 dB, 1 dB of a share (a sample more or less in a short record), 2 of log odds,
    /// 0.01. Odds are estimated from the one or two windows of a run: one window with another class changes
    /// them by 6, and if none of eighty replicates has it, its probability is still one in 160 (Jeffreys'
    /// estimate), about three standard deviations.
    pub fn resolution(self, size: f64) -> f64 {
        match self {
            Self::Own => 0.01 * size,
            Self::Level => 0.1,
            Self::Share => 1.0,
            Self::Odds => 2.0,
            Self::Number => 0.01,
        }
    }
}

impl Statistic {
    /// Its domain.
    pub fn domain(self) -> Domain {
        use Statistic::*;
        match self {
            Mean | Deviation | Skewness | Kurtosis | Crest | Drift | Transient | Step | Held
            | Rails => Domain::Time,
            OrderLevel(_) | OrderCosine(_) | OrderSine(_) => Domain::Order,
            LugAverage | LugResidue => Domain::Lug,
            Band(_) | Line(_) => Domain::Frequency,
            Correlation | Coherence | Lag | ApparentMass => Domain::Cross,
            Feature(_) | ClassShare(_) => Domain::Feature,
            SteadyMean | PerLoad | TurningSpeed => Domain::Load,
            Growth | PerMetre => Domain::History,
            Slope(_) | Curvature(_) | Identified(_) | Misfit => Domain::Curve,
        }
    }

    /// What its differences are counted in.
    pub fn measure(self) -> Measure {
        use Statistic::*;
        match self {
            Mean | Drift | Transient | OrderCosine(_) | OrderSine(_) | Lag | SteadyMean
            | PerLoad | TurningSpeed | PerMetre | Slope(_) | Curvature(_) => Measure::Own,
            Held | Rails => Measure::Share,
            Deviation | Crest | Step | OrderLevel(_) | LugAverage | LugResidue | Band(_)
            | Line(_) | ApparentMass | Growth | Misfit => Measure::Level,
            ClassShare(_) => Measure::Odds,
            Skewness | Kurtosis | Correlation | Coherence | Feature(_) | Identified(_) => {
                Measure::Number
            }
        }
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Statistic::*;
        let name = match self {
            Mean => "mean",
            Deviation => "sd",
            Skewness => "skewness",
            Kurtosis => "kurtosis",
            Crest => "crest",
            Drift => "drift",
            Transient => "transient",
            Step => "step",
            Held => "held",
            Rails => "rails",
            OrderLevel(order) => return write!(f, "{order}"),
            OrderCosine(order) => return write!(f, "{order}_cos"),
            OrderSine(order) => return write!(f, "{order}_sin"),
            LugAverage => "average",
            LugResidue => "residue",
            Band(third) => return write!(f, "band_{}hz", centre_text(*third)),
            Line(third) => return write!(f, "line_{}hz", centre_text(*third)),
            Correlation => "correlation",
            Coherence => "coherence",
            Lag => "lag",
            ApparentMass => "apparent_mass",
            Feature(kappa) => ["kappa_f", "kappa_A", "kappa_mv", "kappa_ms"][*kappa as usize],
            ClassShare(class) => class.as_str(),
            SteadyMean => "mean",
            PerLoad => "per_load",
            TurningSpeed => "turning_speed",
            Growth => "growth",
            PerMetre => "per_metre",
            Slope(covariate) => return write!(f, "{}_slope", covariate.as_str()),
            Curvature(covariate) => return write!(f, "{}_curvature", covariate.as_str()),
            Identified(parameter) => parameter.name(),
            Misfit => "misfit",
        };
        f.write_str(name)
    }
}

/// Centre [Hz] of the one-third octave `third`: `10^(third/10)`.
pub(super) fn centre(third: i16) -> f64 {
    libm::pow(10.0, 0.1 * f64::from(third))
}

/// The centre as standards round it: 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8 times a power of ten.
fn centre_text(third: i16) -> String {
    const NOMINAL: [f64; 10] = [1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0];
    let decade = libm::pow(10.0, f64::from(third.div_euclid(10)));
    let hertz = NOMINAL[usize::from(third.rem_euclid(10) as u16)] * decade;
    // Rounded to suppress the floating-point error of the power.
    format!("{}", (hertz * 1.0e4).round() / 1.0e4)
}

/// One statistic of one channel, or of a pair `first~second`. Cells order by channel, domain and
/// statistic; `acceleration_y/order/28` is one as text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// Channel, pair of channels, or `terrain` for identified parameters.
    pub channel: Arc<str>,
    /// What is read from it.
    pub statistic: Statistic,
}

impl Cell {
    /// A cell of this channel.
    pub fn new(channel: impl Into<Arc<str>>, statistic: Statistic) -> Self {
        Self {
            channel: channel.into(),
            statistic,
        }
    }

    /// Its domain.
    pub fn domain(&self) -> Domain {
        self.statistic.domain()
    }

    /// The unit of its values; empty where the channel's is not known.
    pub fn unit(&self) -> String {
        let own = unit_of(&self.channel).unwrap_or("");
        match (self.statistic.measure(), self.statistic) {
            (Measure::Level | Measure::Share, _) => "dB".to_owned(),
            (Measure::Odds | Measure::Number, _) => "1".to_owned(),
            (Measure::Own, Statistic::Lag) => "s".to_owned(),
            (Measure::Own, Statistic::PerLoad) => "1".to_owned(),
            (Measure::Own, Statistic::TurningSpeed) => "rad/s".to_owned(),
            (Measure::Own, Statistic::PerMetre) => format!("{own}/m"),
            (Measure::Own, _) => own.to_owned(),
        }
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.channel, self.domain(), self.statistic)
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Cell {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_window_that_answers_otherwise_is_three_deviations_where_no_replicate_does() {
        let logit = |share: f64| libm::log((share + 0.05) / (1.05 - share));
        let measure = Statistic::ClassShare(Wtic::Alct).measure();
        let deviations = (logit(1.0) - logit(0.0)) / measure.resolution(1.0);
        assert!((2.5..3.5).contains(&deviations), "{deviations}");
    }

    #[test]
    fn a_cell_reads_channel_domain_statistic_and_has_its_unit() {
        let text = |channel: &str, statistic| {
            let cell = Cell::new(channel, statistic);
            format!("{cell} [{}]", cell.unit())
        };
        let order = text("acceleration_y", Statistic::OrderLevel(28));
        assert_eq!(order, "acceleration_y/order/28 [dB]");
        let band = text("normal_force", Statistic::Band(18));
        assert_eq!(band, "normal_force/frequency/band_63hz [dB]");
        let low = text("normal_force", Statistic::Line(-9));
        assert_eq!(low, "normal_force/frequency/line_0.125hz [dB]");
        let slope = text("sinkage", Statistic::Slope(Covariate::Slip));
        assert_eq!(slope, "sinkage/curve/slip_slope [m]");
        assert_eq!(
            text("sinkage", Statistic::PerMetre),
            "sinkage/history/per_metre [m/m]"
        );
    }

    #[test]
    fn cells_of_a_channel_stand_together_by_domain() {
        let domains: Vec<Domain> = [
            Statistic::Rails,
            Statistic::OrderSine(84),
            Statistic::LugAverage,
            Statistic::Band(30),
            Statistic::Lag,
            Statistic::ClassShare(Wtic::Alct),
            Statistic::SteadyMean,
            Statistic::Growth,
            Statistic::Misfit,
        ]
        .map(Statistic::domain)
        .to_vec();
        assert_eq!(domains, Domain::ALL);
        assert!(domains.is_sorted());
        assert!(Statistic::Rails < Statistic::OrderLevel(1));
        assert!(Statistic::Line(-20) < Statistic::Correlation);
    }
}
