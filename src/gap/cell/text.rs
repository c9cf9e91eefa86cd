//! A cell from its text.

use super::{Cell, Covariate, Kappa, Statistic};
use crate::identification::Parameter;
use crate::terrain::class::Wtic;
use std::str::FromStr;

/// A text that is no cell.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no cell; one reads channel/domain/statistic, as acceleration_y/order/28")]
pub struct NoCell(String);

impl FromStr for Cell {
    type Err = NoCell;

    /// Reads what a cell writes, and no other spelling of it.
    fn from_str(text: &str) -> Result<Self, NoCell> {
        let mut parts = text.rsplitn(3, '/');
        let cell = match [parts.next(), parts.next(), parts.next()] {
            [Some(name), Some(domain), Some(channel)] => {
                statistic(domain, name).map(|statistic| Self::new(channel, statistic))
            }
            _ => None,
        };
        cell.filter(|cell| cell.to_string() == text)
            .ok_or_else(|| NoCell(text.to_owned()))
    }
}

fn statistic(domain: &str, name: &str) -> Option<Statistic> {
    use Statistic::*;
    Some(match (domain, name) {
        ("time", "mean") => Mean,
        ("time", "sd") => Deviation,
        ("time", "skewness") => Skewness,
        ("time", "kurtosis") => Kurtosis,
        ("time", "crest") => Crest,
        ("time", "drift") => Drift,
        ("time", "transient") => Transient,
        ("time", "step") => Step,
        ("time", "held") => Held,
        ("time", "rails") => Rails,
        ("order", wave) => order(wave)?,
        ("lug", "average") => LugAverage,
        ("lug", "residue") => LugResidue,
        ("frequency", third) => frequency(third)?,
        ("cross", "correlation") => Correlation,
        ("cross", "coherence") => Coherence,
        ("cross", "lag") => Lag,
        ("cross", "apparent_mass") => ApparentMass,
        ("feature", feature) => kappa_or_class(feature)?,
        ("load", "mean") => SteadyMean,
        ("load", "per_load") => PerLoad,
        ("load", "turning_speed") => TurningSpeed,
        ("history", "growth") => Growth,
        ("history", "per_metre") => PerMetre,
        ("curve", "misfit") => Misfit,
        ("curve", curve) => over_runs(curve)?,
        _ => return None,
    })
}

fn order(name: &str) -> Option<Statistic> {
    let (number, part): (_, fn(u32) -> Statistic) = match name.split_once('_') {
        None => (name, Statistic::OrderLevel),
        Some((number, "cos")) => (number, Statistic::OrderCosine),
        Some((number, "sin")) => (number, Statistic::OrderSine),
        Some(_) => return None,
    };
    number.parse().ok().map(part)
}

fn frequency(name: &str) -> Option<Statistic> {
    let (kind, centre) = name.strip_suffix("hz")?.split_once('_')?;
    let centre: f64 = centre.parse().ok()?;
    // The nominal centres lie within a tenth of a third of the exact ones.
    let third = libm::round(10.0 * libm::log10(centre)) as i16;
    match kind {
        "band" => Some(Statistic::Band(third)),
        "line" => Some(Statistic::Line(third)),
        _ => None,
    }
}

fn kappa_or_class(name: &str) -> Option<Statistic> {
    let kappas = Kappa::ALL.map(Statistic::Feature);
    let classes = [Wtic::Alct, Wtic::Slct, Wtic::Leis, Wtic::Uwtic].map(Statistic::ClassShare);
    let mut all = kappas.into_iter().chain(classes);
    all.find(|statistic| statistic.to_string() == name)
}

/// A slope or curvature over a covariate, or an identified parameter.
fn over_runs(name: &str) -> Option<Statistic> {
    if let Some(parameter) = Parameter::ALL.into_iter().find(|p| p.name() == name) {
        return Some(Statistic::Identified(parameter));
    }
    let (covariate, shape) = name.split_once('_')?;
    let mut covariates = Covariate::ALL.into_iter();
    let covariate = covariates.find(|known| known.as_str() == covariate)?;
    match shape {
        "slope" => Some(Statistic::Slope(covariate)),
        "curvature" => Some(Statistic::Curvature(covariate)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::sample::select;

    fn any_statistic() -> impl Strategy<Value = Statistic> {
        use Statistic::*;
        let plain = vec![
            Mean,
            Deviation,
            Skewness,
            Kurtosis,
            Crest,
            Drift,
            Transient,
            Step,
            Held,
            Rails,
            LugAverage,
            LugResidue,
            Correlation,
            Coherence,
            Lag,
            ApparentMass,
            SteadyMean,
            PerLoad,
            TurningSpeed,
            Growth,
            PerMetre,
            Misfit,
        ];
        let classes = vec![Wtic::Alct, Wtic::Slct, Wtic::Leis, Wtic::Uwtic];
        prop_oneof![
            select(plain),
            any::<u32>().prop_map(OrderLevel),
            any::<u32>().prop_map(OrderCosine),
            any::<u32>().prop_map(OrderSine),
            // From 1 mHz to 1 MHz.
            (-30_i16..=60).prop_map(Band),
            (-30_i16..=60).prop_map(Line),
            select(Kappa::ALL.to_vec()).prop_map(Feature),
            select(classes).prop_map(ClassShare),
            select(Covariate::ALL.to_vec()).prop_map(Slope),
            select(Covariate::ALL.to_vec()).prop_map(Curvature),
            select(Parameter::ALL.to_vec()).prop_map(Identified),
        ]
    }

    proptest! {
        #[test]
        fn every_cell_comes_back_from_its_own_words(
            channel in "[a-z_~/ ]{1,20}",
            statistic in any_statistic(),
        ) {
            let cell = Cell::new(channel, statistic);
            prop_assert_eq!(cell.to_string().parse(), Ok(cell));
        }
    }

    #[test]
    fn a_text_that_no_cell_writes_is_refused() {
        for text in [
            "acceleration_y/order",
            "acceleration_y/order/028",
            "acceleration_y/frequency/band_64hz",
            "acceleration_y/load/sd",
            "sinkage/curve/slip_bend",
        ] {
            let error = text.parse::<Cell>().unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("`{text}` is no cell")),
                "{error}"
            );
        }
    }
}
