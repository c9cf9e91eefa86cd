//! What users know: a classifier trained on labelled windows. It takes the power of the vibration
//! in bands ([`band_powers`](crate::features::band_powers)), standardised, and has one linear
//! support vector machine for every class against the others; the machine that is surest answers.
//!
//! It needs labelled windows of every ground, and does not use the wheel's speed. How much
//! that costs shows when it is tested on a speed that it was not trained on, [`left_out`].

use crate::features::band_powers::{BANDS, BandPowers};
use crate::terrain::class::Wtic;
use linfa::DatasetBase;
use linfa::traits::Fit;
use linfa_svm::{Svm, SvmError};
use ndarray::{Array1, Array2, ArrayView1};
use std::collections::BTreeSet;

/// Penalty of a window on the wrong side of its margin [-].
const PENALTY: f64 = 1.0;

/// A labelled window.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its vibration.
    pub powers: BandPowers,
    /// Its class.
    pub class: Wtic,
}

/// Why there is no classifier.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BaselineError {
    /// All windows belong together.
    #[error(
        "all windows are of one group, so none is left to train on: the groups need two values or more"
    )]
    OneGroup,
    /// There is nothing to train on.
    #[error("there is no window to train on")]
    NoSample,
    /// The machine could not be trained.
    #[error("the support vector machine cannot be trained")]
    Machine(#[from] SvmError),
}

/// A trained classifier.
#[derive(Debug)]
pub struct Baseline {
    mean: BandPowers,
    sd: BandPowers,
    /// One for every class; a single class needs none.
    machines: Vec<(Wtic, Option<Svm<f64, bool>>)>,
}

impl Baseline {
    /// A classifier of the classes among `samples`.
    ///
    /// # Errors
    /// `NoSample` without samples; `Machine` where the solver refuses, as powers that are no
    /// numbers make it.
    pub fn train(samples: &[&Sample]) -> Result<Self, BaselineError> {
        let classes: BTreeSet<Wtic> = samples.iter().map(|sample| sample.class).collect();
        if classes.is_empty() {
            return Err(BaselineError::NoSample);
        }
        let (mean, sd) = mean_and_sd(samples);
        let rows: Vec<f64> = samples
            .iter()
            .flat_map(|sample| standardised(sample.powers, mean, sd))
            .collect();
        let rows = Array2::from_shape_vec((samples.len(), BANDS), rows)
            .expect("every sample has all bands");
        let single = classes.len() == 1;
        let machine = |class: Wtic| {
            let is_class: Array1<bool> = samples.iter().map(|s| s.class == class).collect();
            let parameters = Svm::<f64, bool>::params().pos_neg_weights(PENALTY, PENALTY);
            parameters
                .linear_kernel()
                .fit(&DatasetBase::new(rows.clone(), is_class))
        };
        let machines = classes.into_iter().map(|class| {
            let machine = if single { None } else { Some(machine(class)?) };
            Ok((class, machine))
        });
        Ok(Self {
            mean,
            sd,
            machines: machines.collect::<Result<_, SvmError>>()?,
        })
    }

    /// The class of a window.
    pub fn class(&self, powers: BandPowers) -> Wtic {
        let row = standardised(powers, self.mean, self.sd);
        let row = ArrayView1::from(&row);
        let sureness = |machine: &Option<Svm<f64, bool>>| {
            let decided = |machine: &Svm<f64, bool>| machine.weighted_sum(&row) - machine.rho;
            machine.as_ref().map_or(0.0, decided)
        };
        let judged = self
            .machines
            .iter()
            .map(|(class, machine)| (*class, sureness(machine)));
        let surest = judged.max_by(|a, b| a.1.total_cmp(&b.1));
        surest.expect("there is a class").0
    }
}

/// Leave-one-group-out prediction: the class of every sample by a classifier trained on all other groups.
/// `groups` is the group of each sample.
///
/// # Errors
/// `OneGroup` where there are not two groups; those of [`Baseline::train`].
pub fn left_out<G: Ord>(samples: &[Sample], groups: &[G]) -> Result<Vec<Wtic>, BaselineError> {
    let distinct: BTreeSet<&G> = groups.iter().collect();
    if distinct.len() < 2 {
        return Err(BaselineError::OneGroup);
    }
    let mut classes = vec![Wtic::Uwtic; samples.len()];
    for left_out in distinct {
        let grouped = || samples.iter().zip(groups);
        let others = grouped().filter(|(_, group)| *group != left_out);
        let others: Vec<&Sample> = others.map(|(sample, _)| sample).collect();
        let baseline = Baseline::train(&others)?;
        for (class, (sample, _)) in classes
            .iter_mut()
            .zip(grouped())
            .filter(|(_, (_, group))| *group == left_out)
        {
            *class = baseline.class(sample.powers);
        }
    }
    Ok(classes)
}

fn mean_and_sd(samples: &[&Sample]) -> (BandPowers, BandPowers) {
    let n = samples.len() as f64;
    let average = |value: &dyn Fn(BandPowers, usize) -> f64| -> BandPowers {
        std::array::from_fn(|band| samples.iter().map(|s| value(s.powers, band)).sum::<f64>() / n)
    };
    let mean = average(&|powers, band| powers[band]);
    let variance = average(&|powers, band| (powers[band] - mean[band]).powi(2));
    (mean, variance.map(libm::sqrt))
}

/// Zero mean and unit standard deviation; a constant band is set to 0.
fn standardised(powers: BandPowers, mean: BandPowers, sd: BandPowers) -> BandPowers {
    std::array::from_fn(|band| match sd[band] {
        sd if sd > 0.0 => (powers[band] - mean[band]) / sd,
        _ => 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand::RngExt;

    /// Windows whose power is noise, and more by two decades in a band of their class's.
    fn samples(stage: &str) -> Vec<Sample> {
        let mut rng = Seed(1).rng(stage, 0);
        let classes = [(Wtic::Alct, 3), (Wtic::Slct, 6), (Wtic::Leis, 9)];
        let each = classes.iter().cycle().take(60);
        each.map(|&(class, loud)| {
            let mut powers: BandPowers = std::array::from_fn(|_| rng.random_range(-0.3..0.3));
            powers[loud] += 2.0;
            Sample { powers, class }
        })
        .collect()
    }

    fn correct(samples: &[Sample], classes: &[Wtic]) -> usize {
        let pairs = samples.iter().zip(classes);
        pairs
            .filter(|(sample, class)| sample.class == **class)
            .count()
    }

    #[test]
    fn classes_with_power_in_different_bands_are_separated_in_a_held_out_group() {
        let samples = samples("loud");
        let groups: Vec<usize> = (0..samples.len()).map(|i| i / 3 % 4).collect();
        let classes = left_out(&samples, &groups).unwrap();
        assert_eq!(correct(&samples, &classes), 60);
    }

    #[test]
    fn classes_that_differ_only_in_level_are_confused_at_an_untrained_level() {
        let (mut samples, mut speeds) = (Vec::new(), Vec::new());
        for (speed, shift) in [(1, 0.0), (2, 10.0)] {
            for (class, level) in [(Wtic::Leis, 0.0), (Wtic::Alct, 2.0)].repeat(10) {
                let powers = [shift + level; BANDS];
                samples.push(Sample { powers, class });
                speeds.push(speed);
            }
        }
        let classes = left_out(&samples, &speeds).unwrap();
        // At the louder speed all is ALCT, at the quieter one all LEIS: half is right.
        assert_eq!(correct(&samples, &classes), 20);
    }

    #[test]
    fn a_single_group_leaves_nothing_to_train_on() {
        let samples = samples("single");
        let error = left_out(&samples, &[0.014; 60].map(f64::to_bits)).unwrap_err();
        assert!(matches!(error, BaselineError::OneGroup));
        assert!(matches!(
            left_out::<u8>(&[], &[]),
            Err(BaselineError::OneGroup)
        ));
    }

    #[test]
    fn one_class_is_the_only_answer_of_who_saw_one_class() {
        let mut samples = samples("one");
        samples.retain(|sample| sample.class == Wtic::Leis);
        let seen: Vec<&Sample> = samples.iter().collect();
        let baseline = Baseline::train(&seen).unwrap();
        assert_eq!(baseline.class([7.0; BANDS]), Wtic::Leis);
    }
}
