//! Result of `identify` for people.

use super::class::ClassSource;
use super::law::OtherStress;
use super::lines::{LINE, counted, write_item};
use super::summary::{
    Origin, ParameterReport, Report, RunReport, SettingReport, Summary, by_origin,
};
use super::unused::{LeftOut, StretchLeftOut, Unused};
use crate::identification::{Cylinder, Standing};
use crate::recognition::known::Source;
use crate::report::page::wrapped;
use crate::soil::StressConvention;
use crate::table::four_digits;
use crate::terrain::class::Wtic;
use crate::trace::behind_number;
use std::fmt;

/// Absolute correlation [-] from which two estimates are reported as strongly correlated.
const STRONG: f64 = 0.95;

/// Errors [%] of pull, load and torque in Table 7 of the paper, with its ground.
fn published(class: Wtic) -> Option<(&'static str, [f64; 3])> {
    match class {
        Wtic::Alct => Some(("HT", [15.2, 11.68, 15.52])),
        Wtic::Slct => Some(("GT", [11.85, 6.67, 8.46])),
        Wtic::Leis => Some(("ST", [8.11, 7.64, 7.75])),
        Wtic::Uwtic => None,
    }
}

/// What was not used: runs grouped by reason, and stretches.
pub fn reasons(unused: &Unused) -> String {
    let mut together: Vec<(&str, Vec<&str>)> = Vec::new();
    for LeftOut { run, reason } in &unused.runs {
        match together.iter_mut().find(|(known, _)| known == reason) {
            Some((_, runs)) => runs.push(run),
            None => together.push((reason, vec![run])),
        }
    }
    let runs = together
        .iter()
        .map(|(reason, runs)| format!("{}: {reason}", named(runs)));
    let stretches = unused.stretches.iter().map(|stretch| {
        let [from, to] = stretch.interval_s;
        let StretchLeftOut { run, reason, .. } = stretch;
        format!("run {run} from {from:.1} to {to:.1} s: {reason}")
    });
    runs.chain(stretches).collect::<Vec<_>>().join("\n")
}

/// Names of runs; the first and last of many.
fn named(runs: &[&str]) -> String {
    match runs {
        [run] => format!("run {run}"),
        [first, .., last] if runs.len() > 6 => {
            format!("{} runs from {first} to {last}", runs.len())
        }
        runs => format!("runs {}", runs.join(", ")),
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.files)?;
        let Unused { runs, stretches } = &self.unused;
        let counts = [(runs.len(), "run"), (stretches.len(), "stretch")];
        let some = counts.into_iter().filter(|(count, _)| *count > 0);
        let counts: Vec<String> = some.map(|(count, what)| counted(count, what)).collect();
        if !counts.is_empty() {
            let counts = counts.join(" and ");
            writeln!(f, "\nWARNING, {counts} left out\n{}", reasons(&self.unused))?;
        }
        for report in &self.reports {
            writeln!(f, "\n{report}")?;
        }
        for report in &self.plates {
            writeln!(f, "\n{report}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_what(f)?;
        self.write_warnings(f)?;
        self.write_parameters(f)?;
        self.write_correlation(f)?;
        self.write_errors(f)?;
        match &self.figure {
            Some(figure) => writeln!(f, "drawn: {figure}"),
            None => Ok(()),
        }
    }
}

impl Report {
    fn write_what(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Class {}", self.class)?;
        for (origin, runs) in by_origin(&self.runs) {
            write_item(f, "  ", &class_source(&origin, &runs))?;
        }
        writeln!(f, "  wheel: {}", self.wheel)?;
        write_item(f, "  ", &self.law())?;
        writeln!(
            f,
            "  {} of {}, slip {}, load {} N",
            counted(self.rows.len(), "row"),
            counted(self.runs.len(), "run"),
            range(self.rows.iter().map(|row| row.slip), 2),
            range(self.rows.iter().map(|row| row.measured.load), 1),
        )
    }

    /// The equations and their assumptions.
    fn law(&self) -> String {
        let SettingReport {
            cylinder,
            exit_angle,
            law,
        } = &self.setting;
        let c_3 = format!("c3 = {}", four_digits(*exit_angle));
        if law.law == "paper" {
            let cylinder = match *cylinder {
                Cylinder::Rim => "the rim's radius",
                Cylinder::LugTips => "the radius of the lugs' tips",
            };
            return format!("law: paper, (62)-(66) on a cylinder of {cylinder}, {c_3}");
        }
        let stress = stress_name(law.stress);
        let of_lugs = law.lug_thickness_m.zip(law.bulk_density_kg_m3);
        let lugs = of_lugs.map_or(String::new(), |(thickness, density)| {
            format!(
                ", lugs {} mm thick, {} kg/m³",
                four_digits(1.0e3 * thickness),
                four_digits(density)
            )
        });
        format!(
            "law: own, quadrature over rim and lugs, {stress}, {c_3}{lugs}; all of these assumed"
        )
    }

    fn write_warnings(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.warnings.is_empty() {
            return Ok(());
        }
        writeln!(f, "\nWARNINGS")?;
        for warning in &self.warnings {
            let text = format!("{}: {}", warning.message, warning.meaning);
            write_item(f, "  ! ", &text)?;
        }
        Ok(())
    }

    fn write_parameters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\n{:<10}{:>12}  {:<26}{:<12}status",
            "parameter", "value", "95 % interval", "unit"
        )?;
        for (parameter, report) in &self.parameters {
            let (name, value) = (parameter.name(), four_digits(report.value));
            let unit = shown_unit(report.unit);
            let interval = interval(report);
            let standing = match &report.reason {
                _ if report.effective => "effective (this wheel and load only)".to_owned(),
                Some(reason) => format!("not identifiable: {reason}"),
                None => report.standing.to_string(),
            };
            writeln!(
                f,
                "{name:<10}{value:>12}  {interval:<26}{unit:<12}{standing}"
            )?;
        }
        if let Some(effective) = &self.effective {
            write_item(f, "", effective)?;
        }
        if let Some(other) = &self.other_stress {
            write_item(f, "", &self.by_other_stress(other))?;
        }
        for combination in &self.combinations {
            let value = four_digits(combination.value);
            let [low, high] = combination.interval.map(four_digits);
            let unit = behind_number(shown_unit(combination.unit));
            let place = match combination.place.as_str() {
                "" => String::new(),
                place => format!(" at {place}"),
            };
            writeln!(
                f,
                "identifiable combination: {} = {value} [{low}, {high}]{unit}{place}",
                combination.name
            )?;
        }
        Ok(())
    }

    /// The identified parameters under the alternative stress distribution.
    fn by_other_stress(&self, other: &OtherStress) -> String {
        let identified = self
            .parameters
            .iter()
            .filter(|(_, report)| report.identifiable);
        let moved: Vec<String> = identified
            .map(|(parameter, report)| {
                let unit = behind_number(shown_unit(report.unit));
                let value = four_digits(other.parameters.get(*parameter));
                format!("{} = {value}{unit}", parameter.name())
            })
            .collect();
        let moved = if moved.is_empty() {
            "no parameter is identified either".to_owned()
        } else {
            moved.join(", ")
        };
        let here = self.chi_square / self.degrees_of_freedom as f64;
        format!(
            "with {} instead: {moved} (reduced chi square {}, here {})",
            stress_name(other.stress),
            four_digits(other.reduced_chi_square),
            four_digits(here)
        )
    }

    fn write_correlation(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pairs = self.correlation.above(STRONG);
        let shown: Vec<String> = pairs
            .iter()
            .take(5)
            .map(|(one, other, value)| {
                let way = if *value > 0.0 { "with" } else { "against" };
                format!("{one} {way} {other} ({})", value_of(*value))
            })
            .collect();
        if shown.is_empty() {
            return Ok(());
        }
        let text = format!(
            "strongly correlated: {}; each can compensate a change of the other",
            shown.join(", ")
        );
        for line in wrapped(&text, LINE) {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }

    fn write_errors(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (given, predicted) = (&self.force_error_percent, &self.prediction_error_percent);
        let by_paper = published(self.class).filter(|_| self.setting.law.law == "paper");
        let (ground, table_7) = match by_paper {
            Some((ground, errors)) => (format!("   Table 7, {ground}"), errors.map(Some)),
            None => (String::new(), [None; 3]),
        };
        writeln!(
            f,
            "\n{:<28}{:>9}{ground}",
            "error at measured sinkage", "here"
        )?;
        write_error(f, "drawbar pull F_DP", given.drawbar_pull, table_7[0])?;
        write_error(f, "load W", given.load, table_7[1])?;
        write_error(f, "driving torque T_D", given.driving_torque, table_7[2])?;
        writeln!(f, "error at predicted sinkage (given load)")?;
        if predicted.drawbar_pull.is_none() {
            writeln!(f, "  none: the parameters give no prediction for some rows")?;
        }
        if self.class == Wtic::Leis {
            write_error(f, "sinkage z", predicted.sinkage, None)?;
        }
        write_error(f, "drawbar pull F_DP", predicted.drawbar_pull, None)?;
        write_error(f, "driving torque T_D", predicted.driving_torque, None)?;
        let note = "Mean absolute error over mean absolute value, of the rows fitted. At the measured sinkage, as \
                    in Table 7 of Lv et al. 2023 (another rig and ground), the exponent amplifies the errors \
                    of the measured sinkage; the predicted sinkage is the one at which the soil supports the \
                    given load.";
        for line in wrapped(note, LINE) {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

fn stress_name(stress: StressConvention) -> &'static str {
    match stress {
        StressConvention::WongReece => "Wong and Reece's stresses",
        StressConvention::Triangular => "triangular stress",
    }
}

/// A line of the errors [%].
fn write_error(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    here: Option<f64>,
    published: Option<f64>,
) -> fmt::Result {
    let here = here.map_or("-".to_owned(), |error| format!("{error:.2} %"));
    let published = published.map_or(String::new(), |error| format!("{error:>11.2} %"));
    writeln!(f, "  {name:<26}{here:>9}{published}")
}

fn class_source(origin: &Origin, runs: &[&RunReport]) -> String {
    let by = match origin {
        Origin::Recognized => {
            let windows = |run: &&RunReport| match run.class_by {
                ClassSource::Recognized {
                    windows,
                    of_windows,
                } => [windows, of_windows],
                _ => [0; 2],
            };
            let sum = |i: usize| -> usize { runs.iter().map(|run| windows(run)[i]).sum() };
            format!("recognised in {} of {}", sum(0), counted(sum(1), "window"))
        }
        Origin::Other(ClassSource::Known { source, because }) => {
            let source = match source {
                Source::GroundTruth => "simulated lug contacts",
                Source::RunClass => "the class in the run file",
                Source::Terrain => "the class of the terrain in the paper",
            };
            format!("by {source}, since recognition failed ({because})")
        }
        Origin::Other(_) => "given with --class".to_owned(),
    };
    format!("{}: {by}", counted(runs.len(), "run"))
}

/// Least and greatest of `values`, or the one they are.
fn range(values: impl Iterator<Item = f64> + Clone, decimals: usize) -> String {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let most = values.fold(f64::NEG_INFINITY, f64::max);
    let zero = format!("{:.decimals$}", 0.0);
    let shown = [least, most].map(|value| {
        let text = format!("{value:.decimals$}");
        if text.trim_start_matches('-') == zero {
            zero.clone()
        } else {
            text.replace('-', "−")
        }
    });
    match shown {
        [least, most] if least == most => least,
        [least, most] => format!("{least} to {most}"),
    }
}

fn interval(report: &ParameterReport) -> String {
    match report.standing {
        Standing::SetByClass | Standing::Given => "-".to_owned(),
        _ => match report.ci95 {
            [None, None] => "unbounded".to_owned(),
            ends => {
                let [low, high] = ends.map(|end| end.map_or("unbounded".to_owned(), four_digits));
                format!("[{low}, {high}]")
            }
        },
    }
}

/// A unit as printed.
fn shown_unit(unit: &'static str) -> &'static str {
    match unit {
        "1" => "-",
        "deg" => "°",
        unit => unit,
    }
}

/// A correlation with its sign.
fn value_of(correlation: f64) -> String {
    format!("{correlation:+.3}").replace('-', "−")
}
