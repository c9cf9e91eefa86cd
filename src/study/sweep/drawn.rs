//! Values of several keys drawn together, from a distribution each.

use super::Rows;
use super::distribution::{Distribution, NAMES};
use crate::quantity::{RangeError, Seed};
use crate::study::Wrong;
use rand::RngExt;
use rand::seq::SliceRandom;
use rand_distr::Open01;
use serde::Deserialize;

/// How the draws of a key are spread over its distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Sampling {
    /// Independent draws: more draws do not change the earlier ones.
    Random,
    /// The distribution of every key is divided into as many strata of equal probability as draws, with one
    /// draw in each; strata of different keys are combined at random (McKay et al. 1979).
    LatinHypercube,
}

/// Keys with their distributions, and how many draws.
pub(super) struct Draws {
    pub(super) count: u32,
    pub(super) sampling: Sampling,
    pub(super) distributions: toml::Table,
}

impl Draws {
    /// The keys in the order of their letters, and a row of values for every draw.
    ///
    /// A key's values depend on the seed, the key and the number of the draw only (and, of a Latin
    /// hypercube, on the number of draws): other keys and sweeps change none of them.
    pub(super) fn rows(&self, seed: Seed) -> Result<(Vec<String>, Rows), Wrong> {
        let count = f64::from(self.count);
        RangeError::check("number of draws", "-", count, [1.0, 1.0e5])
            .map_err(|error| ("count".to_owned(), error.to_string()))?;
        let mut distributions = Vec::new();
        collect("", &self.distributions, &mut distributions)
            .map_err(|(key, message)| (format!("distributions.{key}"), message))?;
        if distributions.is_empty() {
            let message = "a drawn sweep needs a key with its distribution".to_owned();
            return Err(("distributions".to_owned(), message));
        }
        let columns = distributions.iter().map(|(key, distribution)| {
            let shares = self.sampling.shares(seed, key, self.count);
            let values = shares.into_iter().map(|u| distribution.value(u));
            values.collect::<Vec<String>>()
        });
        let columns: Vec<Vec<String>> = columns.collect();
        let row = |draw: usize| columns.iter().map(|column| column[draw].clone()).collect();
        let rows = (0..self.count as usize).map(row).collect();
        Ok((
            distributions.into_iter().map(|(key, _)| key).collect(),
            rows,
        ))
    }
}

impl Sampling {
    /// Shares in (0, 1) of a key's distribution, one a draw.
    fn shares(self, seed: Seed, key: &str, count: u32) -> Vec<f64> {
        let share = |draw: u32| -> f64 {
            let mut rng = seed.rng(&format!("study.draw/{key}"), u64::from(draw));
            rng.sample(Open01)
        };
        match self {
            Self::Random => (0..count).map(share).collect(),
            Self::LatinHypercube => {
                let mut strata: Vec<u32> = (0..count).collect();
                strata.shuffle(&mut seed.rng(&format!("study.strata/{key}"), u64::from(count)));
                let within = strata.into_iter().zip((0..count).map(share));
                within
                    .map(|(stratum, share)| (f64::from(stratum) + share) / f64::from(count))
                    .collect()
            }
        }
    }
}

/// Every key below a table that has a distribution.
fn collect(
    prefix: &str,
    table: &toml::Table,
    into: &mut Vec<(String, Distribution)>,
) -> Result<(), Wrong> {
    for (key, value) in table {
        let path = match prefix {
            "" => key.clone(),
            prefix => format!("{prefix}.{key}"),
        };
        let toml::Value::Table(inner) = value else {
            let names = NAMES.join("`, `");
            let message = format!("`{path}` is no distribution; there are `{names}`");
            return Err((path, message));
        };
        if inner.len() == 1 && inner.keys().all(|name| NAMES.contains(&name.as_str())) {
            let distribution = read(&path, inner)?;
            into.push((path, distribution));
        } else {
            collect(&path, inner, into)?;
        }
    }
    Ok(())
}

fn read(path: &str, table: &toml::Table) -> Result<Distribution, Wrong> {
    let distribution: Distribution = table
        .clone()
        .try_into()
        .map_err(|error: toml::de::Error| (path.to_owned(), error.message().to_owned()))?;
    let name = table.keys().next().map_or("", String::as_str);
    distribution.check().map_err(|(key, error)| {
        let place = format!("{path}.{name}.{key}");
        (place.trim_end_matches('.').to_owned(), error.to_string())
    })?;
    Ok(distribution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn draws(sampling: Sampling, count: u32) -> Vec<[f64; 2]> {
        let text = "rig.load = { uniform = { from = 0.0, to = 1.0 } }\n\
                    \"wheel.mass\" = { uniform = { from = 0.0, to = 1.0 } }";
        let draws = Draws {
            count,
            sampling,
            distributions: toml::from_str(text).unwrap(),
        };
        let (keys, rows) = draws.rows(Seed(9)).unwrap();
        assert_eq!(keys, ["rig.load", "wheel.mass"]);
        let number = |value: &String| value.parse().unwrap();
        rows.iter()
            .map(|row| [number(&row[0]), number(&row[1])])
            .collect()
    }

    proptest! {
        #[test]
        fn every_stratum_of_a_latin_hypercube_is_hit_once(seed in 0..u64::MAX, count in 1..300u32) {
            let shares = Sampling::LatinHypercube.shares(Seed(seed), "a.b", count);
            let mut hits: Vec<u32> = shares.iter().map(|u| (u * f64::from(count)) as u32).collect();
            hits.sort_unstable();
            prop_assert_eq!(hits, (0..count).collect::<Vec<u32>>());
        }
    }

    #[test]
    fn keys_are_drawn_without_regard_to_each_other() {
        for sampling in [Sampling::Random, Sampling::LatinHypercube] {
            let rows = draws(sampling, 2000);
            let product: f64 = rows.iter().map(|[a, b]| (a - 0.5) * (b - 0.5)).sum();
            // Twelve times the covariance of independent uniform numbers scatters by 1/sqrt(2000);
            // four of those.
            assert!(
                (12.0 * product / 2000.0).abs() < 4.0 / 2000.0_f64.sqrt(),
                "{sampling:?}"
            );
        }
    }

    #[test]
    fn a_latin_hypercube_has_a_mean_a_hundred_times_surer_than_single_draws() {
        let error = |sampling| {
            let rows = draws(sampling, 1000);
            (rows.iter().map(|[a, _]| a).sum::<f64>() / 1000.0 - 0.5).abs()
        };
        // With strata, 1/n of a uniform number's scatter remains: 1/sqrt(12 n^3), and four of those.
        assert!(error(Sampling::LatinHypercube) < 4.0 / (12.0e9_f64).sqrt());
        assert!(error(Sampling::Random) < 4.0 / (12.0e3_f64).sqrt());
    }

    #[test]
    fn more_random_draws_leave_those_before_as_they_were() {
        assert_eq!(
            draws(Sampling::Random, 50)[..20],
            draws(Sampling::Random, 20)
        );
    }
}
