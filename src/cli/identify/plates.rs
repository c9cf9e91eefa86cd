//! Plate tests: pressure-sinkage modulus and exponent.

use super::lines::{counted, write_item};
use super::unused::LeftOut;
use crate::identification::{
    Interval, Moduli, Parameter, PlateSize, Pressing, PressureSinkage, Resampled,
};
use crate::table::four_digits;
use crate::terrain::class::TerrainLabel;
use crate::trace::Trace;
use crate::trace::wheel::Plate;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Runs of plates by their ground.
#[derive(Debug, Default)]
pub struct PlateTests {
    grounds: Vec<(Option<TerrainLabel>, Vec<Test>)>,
}

/// Hint for a run without a plate that may be a plate test: it has sinkage and force, and neither pull nor
/// torque.
pub fn way_out(trace: &Trace) -> &'static str {
    let has = |name: &str| trace.steady_mean(name).is_some();
    let [is_pressed, is_driven] = [
        has("sinkage") && has("normal_force"),
        has("drawbar_pull") || has("driving_torque"),
    ];
    if is_pressed && !is_driven {
        "; if this is a plate test, state plate_diameter_m, or plate_length_m and plate_width_m, in the campaign and \
         import it again"
    } else {
        ""
    }
}

/// A plate test and its run.
#[derive(Debug)]
struct Test {
    run: String,
    pressing: Pressing,
}

impl PlateTests {
    /// Adds a plate test.
    ///
    /// # Errors
    /// Why it gives no points.
    pub fn add(&mut self, run: &str, trace: &Trace) -> Result<(), String> {
        let pressing = Pressing::of(trace).map_err(|error| error.to_string())?;
        let terrain = trace.attributes.terrain;
        let test = Test {
            run: run.to_owned(),
            pressing,
        };
        match self.grounds.iter_mut().find(|(of, _)| *of == terrain) {
            Some((_, tests)) => tests.push(test),
            None => self.grounds.push((terrain, vec![test])),
        }
        Ok(())
    }

    /// Fits every ground; `widths` [m] are those of wheels of the same files.
    pub fn fit(self, widths: &[f64], left_out: &mut Vec<LeftOut>) -> Vec<PlateReport> {
        let mut reports = Vec::new();
        for (terrain, tests) in self.grounds {
            let (runs, pressings): (Vec<String>, Vec<Pressing>) = tests
                .into_iter()
                .map(|test| (test.run, test.pressing))
                .unzip();
            match PressureSinkage::of(&pressings) {
                Ok(law) => reports.push(PlateReport::of(terrain, runs, &law, widths)),
                Err(error) => left_out.extend(runs.into_iter().map(|run| LeftOut {
                    run,
                    reason: error.to_string(),
                })),
            }
        }
        reports
    }
}

/// Result of the plate tests on one ground.
#[derive(Debug, Serialize)]
pub struct PlateReport {
    /// None: plates have no lugs.
    class: Option<&'static str>,
    terrain: Option<TerrainLabel>,
    runs: Vec<String>,
    plates: Vec<SizeReport>,
    /// Range of sinkage [m] of the fit.
    sinkage_m: [f64; 2],
    /// `n0`, and `k_c` and `k_phi` of several sizes.
    parameters: BTreeMap<&'static str, ValueReport>,
    /// Values to use in fits of wheels on this ground.
    known: Vec<KnownReport>,
    /// Resampling unit of the intervals: `tests`, or `parts` of a test.
    intervals_from: &'static str,
    degrees_of_freedom: usize,
    /// Runs that were not used.
    pub left_out: Vec<LeftOut>,
}

/// Plates of one size.
#[derive(Debug, Serialize)]
struct SizeReport {
    plate: String,
    diameter_m: Option<f64>,
    length_m: Option<f64>,
    width_m: Option<f64>,
    /// `b` of `k_c/b + k_phi` [m].
    b_m: f64,
    tests: usize,
    points: usize,
    k: ValueReport,
}

/// A value with its interval.
#[derive(Debug, Serialize)]
struct ValueReport {
    value: f64,
    ci95: [Option<f64>; 2],
    unit: &'static str,
    identifiable: bool,
}

/// Argument of `--known`.
#[derive(Debug, Serialize)]
struct KnownReport {
    /// `NAME=VALUE`.
    option: String,
    /// Width [m] of the wheel that it applies to; none where it applies to any.
    wheel_width_m: Option<f64>,
}

impl PlateReport {
    fn of(
        terrain: Option<TerrainLabel>,
        runs: Vec<String>,
        law: &PressureSinkage,
        widths: &[f64],
    ) -> Self {
        let exponent = ValueReport::bounded(&law.exponent, Parameter::SinkageExponent);
        let mut parameters = BTreeMap::from([("n0", exponent)]);
        if let Some(Moduli {
            cohesive,
            frictional,
        }) = &law.moduli
        {
            parameters.insert("k_c", ValueReport::signed(cohesive, "N/m^(n+1)"));
            parameters.insert("k_phi", ValueReport::signed(frictional, "N/m^(n+2)"));
        }
        Self {
            class: None,
            terrain,
            runs,
            plates: law.sizes.iter().map(SizeReport::of).collect(),
            sinkage_m: law.sinkages,
            parameters,
            known: known(law, widths),
            intervals_from: match law.resampled {
                Resampled::Tests => "tests",
                Resampled::Parts => "parts",
            },
            degrees_of_freedom: law.freedom,
            left_out: Vec::new(),
        }
    }
}

impl SizeReport {
    fn of(size: &PlateSize) -> Self {
        let [diameter, length, width] = match size.plate {
            Plate::Disc { diameter } => [Some(diameter), None, None],
            Plate::Rectangle { length, width } => [None, Some(length), Some(width)],
        };
        Self {
            plate: size.plate.to_string(),
            diameter_m: diameter,
            length_m: length,
            width_m: width,
            b_m: size.plate.smaller_dimension(),
            tests: size.tests,
            points: size.points,
            k: ValueReport {
                unit: "N/m^(n+2)",
                ..ValueReport::bounded(&size.modulus, Parameter::SinkageModulus)
            },
        }
    }
}

impl ValueReport {
    /// Identified if its interval is informative by the limit for a parameter.
    fn bounded(interval: &Interval, as_parameter: Parameter) -> Self {
        let ends = interval
            .ci95
            .map(|ends| ends.map(|end| as_parameter.coordinate(end)));
        let widest = 2.0 * as_parameter.uninformative();
        let identifiable = ends.is_some_and(|[low, high]| high - low <= widest);
        Self::new(interval, as_parameter.unit(), identifiable)
    }

    /// Identified if its sign is.
    fn signed(interval: &Interval, unit: &'static str) -> Self {
        let identifiable = interval.ci95.is_some_and(|[low, high]| low * high > 0.0);
        Self::new(interval, unit, identifiable)
    }

    fn new(interval: &Interval, unit: &'static str, identifiable: bool) -> Self {
        Self {
            value: interval.value,
            ci95: interval.ci95.map_or([None; 2], |ends| ends.map(Some)),
            unit,
            identifiable,
        }
    }
}

/// `n0`, and `k_s` under the wheels of the same files or, for plates of one size, under a wheel as wide as
/// its `b`.
fn known(law: &PressureSinkage, widths: &[f64]) -> Vec<KnownReport> {
    let exponent = format!("n0={}", four_digits(law.exponent.value).replace('−', "-"));
    let mut known = vec![KnownReport {
        option: exponent,
        wheel_width_m: None,
    }];
    let mut modulus = |width: f64, modulus: f64| {
        known.push(KnownReport {
            option: format!("k_s={modulus:.3e}"),
            wheel_width_m: Some(width),
        });
    };
    match &law.sizes[..] {
        [one] => modulus(one.plate.smaller_dimension(), one.modulus.value),
        _ => {
            let mut widths = widths.to_vec();
            widths.retain(|width| *width > 0.0);
            widths.sort_by(f64::total_cmp);
            widths.dedup();
            for width in widths {
                if let Some(under) = law.modulus_under(width) {
                    modulus(width, under);
                }
            }
        }
    }
    known
}

impl fmt::Display for PlateReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ground = self
            .terrain
            .map_or(String::new(), |terrain| format!(" on {terrain}"));
        writeln!(f, "Plates{ground}: p = k z^n")?;
        let points = self.plates.iter().map(|size| size.points).sum();
        let counts = [
            counted(self.runs.len(), "test"),
            counted(self.plates.len(), "size"),
            counted(points, "point"),
        ];
        writeln!(f, "  {}", counts.join(", "))?;
        let from = match self.intervals_from {
            "tests" => "the scatter between tests".to_owned(),
            _ => "parts of single tests: they do not cover the scatter between places".to_owned(),
        };
        let freedom = self.degrees_of_freedom;
        let from = format!("intervals from {from} ({freedom} degrees of freedom)");
        write_item(f, "  ", &from)?;
        let [shallow, deep] = self.sinkage_m.map(|sinkage| four_digits(1.0e3 * sinkage));
        let fitted = format!(
            "fitted from {shallow} mm (shallower points have 5 % of the weight) to {deep} mm: under a wheel that sinks \
             less, p is extrapolated"
        );
        write_item(f, "  ", &fitted)?;
        writeln!(
            f,
            "\n{:<30}{:>12}  {:<26}{:<12}standing",
            "", "value", "95 % interval", "unit"
        )?;
        for (name, value) in &self.parameters {
            let name = if *name == "n0" {
                "n (n0 of a wheel)"
            } else {
                name
            };
            value.write(f, name)?;
        }
        for size in &self.plates {
            size.k.write(f, &format!("k, {}", size.plate))?;
        }
        writeln!(f, "\nto fit wheels on this ground:")?;
        for KnownReport {
            option,
            wheel_width_m,
        } in &self.known
        {
            let of = wheel_width_m.map_or(String::new(), |width| {
                format!("   for a wheel {} mm wide", four_digits(1.0e3 * width))
            });
            writeln!(f, "  --known {option}{of}")?;
        }
        if self.plates.len() > 1 {
            writeln!(f, "k_s of a wheel of width b is k_c/b + k_phi")?;
        }
        Ok(())
    }
}

impl ValueReport {
    fn write(&self, f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
        let interval = match self.ci95 {
            [Some(low), Some(high)] => format!("[{}, {}]", four_digits(low), four_digits(high)),
            _ => "unbounded".to_owned(),
        };
        let value = four_digits(self.value);
        let unit = if self.unit == "1" { "-" } else { self.unit };
        let standing = if self.identifiable {
            "identified"
        } else {
            "not identifiable"
        };
        writeln!(
            f,
            "{name:<30}{value:>12}  {interval:<26}{unit:<12}{standing}"
        )
    }
}
