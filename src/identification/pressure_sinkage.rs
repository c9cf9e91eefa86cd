//! Pressure-sinkage law of a soil from plates of one or several sizes.
//!
//! ```text
//! p = k_i zⁿ under plates of size i,    k_i = k_c/b_i + k_φ
//! ```
//!
//! All sizes share one exponent. Intervals are by the delete-one jackknife over plate tests, since points of
//! one test lie on one curve and carry no information on the scatter between places. With a single test of a
//! size an eighth of its points is deleted at a time, and the interval does not cover the scatter between
//! places.

use super::plates::{LogSums, PlateError, common_exponent, is_pressed};
use super::pressing::Pressing;
use crate::statistics::student_quantile;
use crate::trace::wheel::Plate;
use std::fmt;

/// Number of groups of points of a single test.
const PARTS: usize = 8;

/// A value and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The value.
    pub value: f64,
    /// Its 95 % interval; `None` where unbounded.
    pub ci95: Option<[f64; 2]>,
}

/// Plates of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateSize {
    /// The plate.
    pub plate: Plate,
    /// Tests.
    pub tests: usize,
    /// Number of points used.
    pub points: usize,
    /// `k = k_c/b + k_φ` [N·m⁻⁽ⁿ⁺²⁾] under it.
    pub modulus: Interval,
}

/// `k_c` and `k_φ` of `k = k_c/b + k_φ`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// Cohesive modulus `k_c` [N·m⁻⁽ⁿ⁺¹⁾].
    pub cohesive: Interval,
    /// Frictional modulus `k_φ` [N·m⁻⁽ⁿ⁺²⁾].
    pub frictional: Interval,
}

/// Resampling unit of the jackknife.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resampled {
    /// Whole tests.
    Tests,
    /// Groups of points of a test: the intervals do not cover the scatter between places.
    Parts,
}

impl fmt::Display for Resampled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tests => "tests",
            Self::Parts => "parts of a test",
        })
    }
}

/// Pressure-sinkage law from plate tests.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureSinkage {
    /// Sinkage exponent `n` [-].
    pub exponent: Interval,
    /// Each size, the smallest `b` first.
    pub sizes: Vec<PlateSize>,
    /// `k_c` and `k_φ`; `None` for one size, which cannot separate them.
    pub moduli: Option<Moduli>,
    /// Range of sinkage \[m\] of the fit: points are weighted by squared pressure, and those shallower than the
    /// first have a twentieth of the weight. The second is the deepest.
    pub sinkages: [f64; 2],
    /// Resampling unit of the intervals.
    pub resampled: Resampled,
    /// Degrees of freedom of the intervals.
    pub freedom: usize,
}

/// The sinkage [m] above which a twentieth of the weight lies, and the deepest.
fn weighed(pressings: &[Pressing]) -> [f64; 2] {
    const SHALLOW: f64 = 0.05;
    let points = pressings.iter().flat_map(|pressing| &pressing.points);
    let mut points: Vec<[f64; 2]> = points.copied().filter(is_pressed).collect();
    points.sort_by(|one, other| one[0].total_cmp(&other[0]));
    let weight = |point: &[f64; 2]| point[1] * point[1];
    let all: f64 = points.iter().map(weight).sum();
    let mut sum = 0.0;
    let first = points.iter().find(|point| {
        sum += weight(point);
        sum >= SHALLOW * all
    });
    let sinkage = |point: Option<&[f64; 2]>| point.map_or(f64::NAN, |point| point[0]);
    [sinkage(first), sinkage(points.last())]
}

/// Tests of plates of one size in jackknife units.
struct Size {
    plate: Plate,
    tests: usize,
    units: Vec<LogSums>,
}

/// Values of `n`, of `ln k_i`, and of `k_c` and `k_φ` where there are several sizes.
type Values = Vec<f64>;

impl PressureSinkage {
    /// Least-squares law of plate tests.
    ///
    /// # Errors
    /// `Point` for a number that is not finite; `TooFew` where no size has points at two sinkages, and of none.
    pub fn of(pressings: &[Pressing]) -> Result<Self, PlateError> {
        let by_size = sizes_of(pressings);
        let resampled = if by_size.iter().all(|(_, tests)| tests.len() > 1) {
            Resampled::Tests
        } else {
            Resampled::Parts
        };
        let mut sizes = Vec::new();
        for (plate, tests) in by_size {
            let units = match resampled {
                Resampled::Tests => tests.iter().map(|test| LogSums::of(&test.points)).collect(),
                Resampled::Parts => parts(&tests),
            };
            sizes.push(Size {
                plate,
                tests: tests.len(),
                units: pressed(units)?,
            });
        }
        sizes.retain(|size| !size.units.is_empty());
        let values = values(&sizes, None).ok_or(PlateError::TooFew)?;
        let freedom = sizes.iter().map(|size| size.units.len() - 1).sum();
        let halves = half_widths(&sizes, values.len(), freedom);
        let fitted = Fitted { values, halves };
        let several = sizes.len() > 1;
        Ok(Self {
            exponent: fitted.straight(0),
            sinkages: weighed(pressings),
            sizes: fitted.sizes(&sizes),
            moduli: several.then(|| Moduli {
                cohesive: fitted.straight(1 + sizes.len()),
                frictional: fitted.straight(2 + sizes.len()),
            }),
            resampled,
            freedom,
        })
    }

    /// `k_s` [N·m⁻⁽ⁿ⁺²⁾] under a wheel of `width` \[m\]: `k_c/b + k_φ`; `None` where one size cannot separate
    /// the two.
    pub fn modulus_under(&self, width: f64) -> Option<f64> {
        let Moduli {
            cohesive,
            frictional,
        } = self.moduli?;
        Some(cohesive.value / width + frictional.value).filter(|modulus| *modulus > 0.0)
    }
}

/// Values with the half-widths of their intervals, if any.
struct Fitted {
    values: Values,
    halves: Option<Vec<f64>>,
}

impl Fitted {
    /// A value whose interval is symmetric.
    fn straight(&self, index: usize) -> Interval {
        let value = self.values[index];
        let half = self.halves.as_ref().map(|halves| halves[index]);
        Interval {
            value,
            ci95: half
                .filter(|half| half.is_finite())
                .map(|half| [value - half, value + half]),
        }
    }

    /// A value whose interval is symmetric in its logarithm.
    fn positive(&self, index: usize) -> Interval {
        let Interval { value, ci95 } = self.straight(index);
        Interval {
            value: libm::exp(value),
            ci95: ci95.map(|ends| ends.map(libm::exp)),
        }
    }

    fn sizes(&self, sizes: &[Size]) -> Vec<PlateSize> {
        let size = |(index, size): (usize, &Size)| PlateSize {
            plate: size.plate,
            tests: size.tests,
            points: size.units.iter().map(|unit| unit.points).sum(),
            modulus: self.positive(1 + index),
        };
        sizes.iter().enumerate().map(size).collect()
    }
}

/// Tests by the size of their plates, the smallest `b` first.
fn sizes_of(pressings: &[Pressing]) -> Vec<(Plate, Vec<&Pressing>)> {
    let mut sizes: Vec<(Plate, Vec<&Pressing>)> = Vec::new();
    for pressing in pressings {
        match sizes.iter_mut().find(|(plate, _)| *plate == pressing.plate) {
            Some((_, tests)) => tests.push(pressing),
            None => sizes.push((pressing.plate, vec![pressing])),
        }
    }
    let b = |size: &(Plate, Vec<&Pressing>)| size.0.smaller_dimension();
    sizes.sort_by(|one, other| b(one).total_cmp(&b(other)));
    sizes
}

/// The points of all tests of one size in groups by sinkage.
fn parts(tests: &[&Pressing]) -> Vec<Result<LogSums, PlateError>> {
    let points: Vec<[f64; 2]> = tests.iter().flat_map(|test| test.points.clone()).collect();
    let part = points.len().div_ceil(PARTS).max(1);
    points.chunks(part).map(LogSums::of).collect()
}

/// The units that contain usable points.
fn pressed(units: Vec<Result<LogSums, PlateError>>) -> Result<Vec<LogSums>, PlateError> {
    let mut units = units.into_iter().collect::<Result<Vec<_>, _>>()?;
    units.retain(|unit| unit.points > 0);
    Ok(units)
}

/// The least-squares values with one unit of a size deleted; `None` where they are not determined.
fn values(sizes: &[Size], without: Option<[usize; 2]>) -> Option<Values> {
    let sums = |(number, size): (usize, &Size)| {
        let units = size.units.iter().enumerate();
        let kept = units.filter(|(unit, _)| without != Some([number, *unit]));
        kept.fold(LogSums::default(), |sums, (_, unit)| sums.and(unit))
    };
    let sums: Vec<LogSums> = sizes.iter().enumerate().map(sums).collect();
    if sums.iter().any(|size| size.points == 0) {
        return None;
    }
    let exponent = common_exponent(&sums)?;
    let moduli: Vec<f64> = sums.iter().map(|size| size.modulus(exponent)).collect();
    let mut values = vec![exponent];
    values.extend(moduli.iter().map(|modulus| libm::log(*modulus)));
    if sizes.len() > 1 {
        let curvatures = sizes
            .iter()
            .map(|size| 1.0 / size.plate.smaller_dimension());
        values.extend(line(curvatures.zip(moduli)));
    }
    Some(values)
}

/// Slope and intercept of a line, with errors in proportion to the ordinates.
fn line(points: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    let points: Vec<(f64, f64)> = points.collect();
    let sum = |of: fn(f64, f64) -> f64| {
        points
            .iter()
            .map(|(x, y)| of(*x, *y) / (y * y))
            .sum::<f64>()
    };
    let weight = sum(|_, _| 1.0);
    let [x, y] = [sum(|x, _| x) / weight, sum(|_, y| y) / weight];
    let spread = sum(|x, _| x * x) - weight * x * x;
    let slope = (sum(|x, y| x * y) - weight * x * y) / spread;
    [slope, y - slope * x]
}

/// Half-widths of 95 % intervals by the stratified jackknife:
///
/// ```text
/// var = Σ_i (g_i - 1)/g_i Σ_u (v_(iu) - v̄_i)²,    t of Σ_i (g_i - 1) degrees of freedom
/// ```
///
/// `None` where a size has a single unit.
fn half_widths(sizes: &[Size], count: usize, freedom: usize) -> Option<Vec<f64>> {
    let mut variances = vec![0.0; count];
    for (number, size) in sizes.iter().enumerate() {
        let units = size.units.len();
        let left: Option<Vec<Values>> = (0..units)
            .map(|unit| values(sizes, Some([number, unit])))
            .collect();
        let left = left.filter(|_| units > 1)?;
        for (index, variance) in variances.iter_mut().enumerate() {
            let mean = left.iter().map(|values| values[index]).sum::<f64>() / units as f64;
            let squares = left
                .iter()
                .map(|values| (values[index] - mean) * (values[index] - mean));
            *variance += squares.sum::<f64>() * (units - 1) as f64 / units as f64;
        }
    }
    let quantile = student_quantile(0.975, freedom as f64);
    Some(
        variances
            .iter()
            .map(|variance| quantile * libm::sqrt(*variance))
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;
    use rand_distr::{Distribution, Normal};

    const COHESIVE: f64 = 2.0e4;
    const FRICTIONAL: f64 = 1.5e6;
    const EXPONENT: f64 = 1.1;

    fn disc(diameter: f64) -> Plate {
        Plate::Disc { diameter }
    }

    /// A test at a place that is `loose` times as soft as the mean.
    fn pressing(plate: Plate, loose: f64) -> Pressing {
        let modulus = loose * (COHESIVE / plate.smaller_dimension() + FRICTIONAL);
        let point = |i: i32| {
            let sinkage = 5.0e-4 * f64::from(i);
            [sinkage, modulus * libm::pow(sinkage, EXPONENT)]
        };
        Pressing {
            plate,
            points: (1..60).map(point).collect(),
        }
    }

    #[test]
    fn two_sizes_part_the_cohesive_from_the_frictional_modulus() {
        let tests = [0.06, 0.1]
            .map(|diameter| [pressing(disc(diameter), 1.0), pressing(disc(diameter), 1.0)]);
        let found = PressureSinkage::of(&tests.concat()).unwrap();
        let moduli = found.moduli.unwrap();
        assert!((found.exponent.value - EXPONENT).abs() < 1e-9);
        assert!(
            (moduli.cohesive.value / COHESIVE - 1.0).abs() < 1e-6,
            "{moduli:?}"
        );
        assert!((moduli.frictional.value / FRICTIONAL - 1.0).abs() < 1e-6);
        let under = found.modulus_under(0.15).unwrap();
        assert!((under / (COHESIVE / 0.15 + FRICTIONAL) - 1.0).abs() < 1e-6);
        assert_eq!((found.resampled, found.freedom), (Resampled::Tests, 2));
    }

    #[test]
    fn one_size_gives_its_modulus_and_parts_nothing() {
        let plate = Plate::rectangle([0.2, 0.05]);
        let found = PressureSinkage::of(&[pressing(plate, 1.0), pressing(plate, 1.2)]).unwrap();
        let [shallow, deep] = found.sinkages;
        assert!(0.0 < shallow && shallow < deep, "{shallow}, {deep}");
        assert_eq!((found.moduli, found.modulus_under(0.1)), (None, None));
        let [one] = &found.sizes[..] else { panic!() };
        let between = COHESIVE / 0.05 + FRICTIONAL;
        assert!(
            (1.0..1.2).contains(&(one.modulus.value / between)),
            "{one:?}"
        );
    }

    #[test]
    fn intervals_of_several_tests_cover_the_scatter_between_places_in_19_of_20_campaigns() {
        let mut rng = Seed(3).rng("plates", 0);
        let scatter = Normal::new(0.0, 0.1).unwrap();
        let plate = disc(0.08);
        let truth = COHESIVE / 0.04 + FRICTIONAL;
        let campaigns = 400;
        let held = (0..campaigns).filter(|_| {
            let tests: Vec<Pressing> = (0..4)
                .map(|_| pressing(plate, libm::exp(scatter.sample(&mut rng))))
                .collect();
            let found = PressureSinkage::of(&tests).unwrap();
            let [low, high] = found.sizes[0].modulus.ci95.unwrap();
            (low..high).contains(&truth)
        });
        let share = held.count() as f64 / f64::from(campaigns);
        // Three standard errors of 95 % in 400 campaigns are 3.3 %.
        assert!((0.917..0.983).contains(&share), "{share}");
    }

    #[test]
    fn a_single_test_has_intervals_of_its_parts_only() {
        let found = PressureSinkage::of(&[pressing(disc(0.06), 1.0)]).unwrap();
        assert_eq!((found.resampled, found.freedom), (Resampled::Parts, 7));
        let [low, high] = found.exponent.ci95.unwrap();
        assert!(high - low < 1e-6 && (low - EXPONENT).abs() < 1e-6);
        let one_point = Pressing {
            plate: disc(0.06),
            points: vec![[0.01, 1.0e4]],
        };
        assert_eq!(PressureSinkage::of(&[one_point]), Err(PlateError::TooFew));
        assert_eq!(PressureSinkage::of(&[]), Err(PlateError::TooFew));
    }
}
