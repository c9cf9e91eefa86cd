//! Identification scores as text for reading.

use super::Published;
use super::score::{
    Accuracy, CarriedScore, Choice, DriftScore, FitOutcome, FitScore, FoundScore, GroundScore,
    GroupScore, IdentificationScore, ModelScore, ParameterScore, PredictionScore, RepeatScore,
};
use crate::identification::{Force, Parameter, Standing};
use crate::recognition::confusion::{CLASSES, Share};
use crate::terrain::class::Wtic;
use std::fmt;

/// Width of a parameter with its interval.
const PARAMETER: usize = 36;
/// Width of a way to choose a model.
const MODEL: usize = 28;
/// Width of the errors of three forces.
const ERRORS: usize = 23;
/// Width of a parameter alone.
const COLUMN: usize = 13;
/// Width of the shares of three forces.
const COVERED: usize = 18;

impl fmt::Display for IdentificationScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "All numbers by threes are of pull, load and torque. Errors [%]: mean size of the error over mean size of\n\
             the force, on the rows fitted, on the means of a condition's rows, and on rows left out of the fit.\n\
             Scatter: the errors [%] that the rows' own uncertainties would leave. Covered: share [%] of the forces\n\
             within their 95 % interval.\n",
        )?;
        for ground in &self.grounds {
            write_ground(f, ground, self.published.as_ref())?;
        }
        write_carried(f, &self.carried, self)?;
        write_predictions(f, self)?;
        write_overview(f, self)?;
        self.groups
            .iter()
            .try_for_each(|group| write_group(f, group))
    }
}

/// A line without trailing blanks.
fn put(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    writeln!(f, "{}", text.trim_end())
}

fn write_ground(
    f: &mut fmt::Formatter<'_>,
    ground: &GroundScore,
    published: Option<&Published>,
) -> fmt::Result {
    let class = ground.label.class();
    writeln!(
        f,
        "\n{}: ground {}, which stands for {class}; recognized as that in {} of {} fits",
        ground.scenario, ground.label, ground.recognized, ground.groups
    )?;
    let columns = [
        "fitted",
        "means",
        "left out",
        "scatter of rows",
        "scatter of means",
    ];
    let columns = columns.map(|column| format!("{column:<ERRORS$}"));
    let columns = format!("{}{:<COVERED$}and left out", columns.concat(), "covered");
    put(f, &format!("  {:MODEL$}{columns}", "model"))?;
    for model in &ground.models {
        let name = match model.choice {
            Choice::Recognized => "by class recognized".to_owned(),
            Choice::Always(of) => always(of, class),
        };
        let text = if model.groups == 0 {
            "could not be fitted".to_owned()
        } else {
            let ModelScore {
                fitted,
                means,
                left_out,
                ..
            } = model;
            let errors = [fitted, means, left_out].map(errors);
            let scatter = [fitted, means].map(scatter);
            let covered = [fitted, left_out].map(covered);
            [errors.concat(), scatter.concat(), covered.concat()].concat()
        };
        put(f, &format!("  {name:MODEL$}{text}"))?;
    }
    if let Some(published) = published {
        let shown = Force::ALL.map(|force| published.error(class, force));
        put(f, &format!("  {:MODEL$}{}", "published", three(shown)))?;
    }
    Ok(())
}

/// What it means to take the model of a class on ground of another.
fn always(of: Wtic, ground: Wtic) -> String {
    match of {
        Wtic::Leis if ground == of => format!("{of} (no switching)"),
        Wtic::Leis => format!("{of} (wrong, no switching)"),
        of if of == ground => of.to_string(),
        of => format!("{of} (wrong)"),
    }
}

fn errors(accuracy: &Accuracy) -> String {
    three(Force::ALL.map(|force| accuracy.error(force)))
}

fn scatter(accuracy: &Accuracy) -> String {
    three(Force::ALL.map(|force| accuracy.scatter_percent.get(force)))
}

/// Pull, load and torque [%], as wide as [`ERRORS`].
fn three(values: [Option<f64>; 3]) -> String {
    let shown = values.map(|value| value.map_or_else(|| "-".to_owned(), percent));
    let [pull, load, torque] = shown;
    let shown = format!("{pull:>6} {load:>6} {torque:>6}");
    format!("{shown:<ERRORS$}")
}

/// A percentage with one decimal; without any above a thousand.
fn percent(value: f64) -> String {
    if value >= 1.0e5 {
        format!("{value:.0e}")
    } else if value >= 1000.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.1}")
    }
}

/// Shares [%] of pull, load and torque within their intervals, as wide as [`COVERED`].
fn covered(accuracy: &Accuracy) -> String {
    let [pull, load, torque] = Force::ALL.map(|force| {
        let share = accuracy.covered.get(&force);
        share.map_or_else(
            || "-".to_owned(),
            |share| format!("{:.0}", 100.0 * share.value),
        )
    });
    let shown = format!("{pull:>3} {load:>3} {torque:>3}");
    format!("{shown:<COVERED$}")
}

fn write_carried(
    f: &mut fmt::Formatter<'_>,
    carried: &[CarriedScore],
    score: &IdentificationScore,
) -> fmt::Result {
    if carried.is_empty() {
        return Ok(());
    }
    f.write_str("\nparameters of one ground kept on another: errors of pull, load, torque\n")?;
    let names = || score.grounds.iter().map(|ground| ground.scenario.as_str());
    let width = names().map(str::len).max().unwrap_or_default() + 2;
    let head: String = names().map(|name| format!("on {name:<ERRORS$}")).collect();
    put(f, &format!("  {:width$}{head}", "of"))?;
    for from in names() {
        let on = |to: &str| {
            let found = carried.iter().find(|c| c.from == from && c.to == to);
            let shown = found.map(|found| errors(&found.accuracy));
            format!("{:<w$}", shown.unwrap_or_default(), w = ERRORS + 3)
        };
        let row: String = names().map(on).collect();
        put(f, &format!("  {from:width$}{row}"))?;
    }
    Ok(())
}

fn write_predictions(f: &mut fmt::Formatter<'_>, score: &IdentificationScore) -> fmt::Result {
    if score.predictions.is_empty() {
        return Ok(());
    }
    f.write_str(
        "\npredicted by the parameters from the reference condition; `stops` where an error is above twice \
         the published one;\nby ALCT and SLCT pull and torque are predicted at the load measured, the load as it was fitted\n",
    )?;
    let places = score
        .predictions
        .iter()
        .map(|p| place(&p.scenario, &p.shared));
    let width = places.map(|place| place.len()).max().unwrap_or_default() + 2;
    put(
        f,
        &format!(
            "  {:width$}model {:<ERRORS$}{:<ERRORS$}stops",
            "", "error", "covered"
        ),
    )?;
    for prediction in &score.predictions {
        let PredictionScore {
            scenario,
            shared,
            class,
            accuracy,
            beyond,
        } = prediction;
        let beyond: Vec<&str> = beyond.iter().map(|force| force.name()).collect();
        put(
            f,
            &format!(
                "  {:width$}{class:6}{}{}  {}",
                place(scenario, shared),
                errors(accuracy),
                covered(accuracy),
                beyond.join(", ")
            ),
        )?;
    }
    Ok(())
}

/// The parameters of all groups side by side.
fn write_overview(f: &mut fmt::Formatter<'_>, score: &IdentificationScore) -> fmt::Result {
    f.write_str(
        "\nparameters by the class recognized, or the label's where none was; (..) where the loads do not fix them\n",
    )?;
    if score.groups.iter().any(|group| group.not_steady > 0) {
        f.write_str("~ where some rows of a group are not steady\n")?;
    }
    let places = score.groups.iter().map(|g| place(&g.scenario, &g.shared));
    let width = places.map(|place| place.len()).max().unwrap_or_default() + 2;
    let names = Parameter::ALL.map(|parameter| format!("{:>COLUMN$}", parameter.name()));
    put(f, &format!("  {:width$}model {}", "", names.concat()))?;
    for group in &score.groups {
        let text = |parameter: &ParameterScore| {
            let value = number(parameter.value);
            let value = match (parameter.identifiable, parameter.identified.standing) {
                (false, Standing::NotIdentifiable) => format!("({value})"),
                (false, _) => "set".to_owned(),
                (true, _) => value,
            };
            format!("{value:>COLUMN$}")
        };
        let (class, values) = group.parameters().map_or_else(
            || ("-".to_owned(), String::new()),
            |(class, found)| (class.to_string(), found.iter().map(text).collect()),
        );
        let mark = if group.not_steady > 0 { "~" } else { "" };
        let place = format!("{}{mark}", place(&group.scenario, &group.shared));
        put(f, &format!("  {place:width$}{class:6}{values}"))?;
    }
    Ok(())
}

fn place(scenario: &str, shared: &[(String, String)]) -> String {
    let values = shared
        .iter()
        .map(|(key, value)| format!(", {key} = {value}"));
    format!("{scenario}{}", values.collect::<String>())
}

fn write_group(f: &mut fmt::Formatter<'_>, group: &GroupScore) -> fmt::Result {
    let answers = CLASSES.iter().zip(group.answers);
    let answers = answers.map(|(class, count)| format!("{class} {count}"));
    let differs = if group.recognized == group.label.class() {
        ""
    } else {
        ", which is not what the ground stands for"
    };
    writeln!(
        f,
        "\n{}\n  {} rows on {}; windows answered {}: {}{differs}",
        place(&group.scenario, &group.shared),
        group.rows,
        group.label,
        answers.collect::<Vec<_>>().join(", "),
        group.recognized,
    )?;
    if group.above_ground > 0 {
        writeln!(
            f,
            "  {} rows with the rim above the ground, on its lugs",
            group.above_ground
        )?;
    }
    if group.not_steady > 0 {
        writeln!(f, "  {}", not_steady(group))?;
    }
    for (run, reason) in &group.without {
        writeln!(f, "  run {run} has no row: {reason}")?;
    }
    write_parameters(f, group)?;
    for fit in &group.fits {
        write_remarks(f, fit)?;
    }
    write_repeats(f, &group.repeats)
}

/// How many rows still change and by how much.
fn not_steady(group: &GroupScore) -> String {
    let drifts: Vec<String> = group.drifts.iter().map(DriftScore::to_string).collect();
    format!(
        "{} of {} rows are not steady: {}; the change over each interval is in its uncertainty",
        group.not_steady,
        group.rows,
        drifts.join(", ")
    )
}

impl fmt::Display for DriftScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            channel,
            rows,
            rates: [least, greatest],
            unit,
            ..
        } = self;
        write!(f, "{channel} changes in {rows} by {} ", number(*least))?;
        if least < greatest {
            write!(f, "to {} ", number(*greatest))?;
        }
        f.write_str(unit)
    }
}

fn write_parameters(f: &mut fmt::Formatter<'_>, group: &GroupScore) -> fmt::Result {
    let found: Vec<&FitScore> = group
        .fits
        .iter()
        .filter(|fit| fit.found().is_some())
        .collect();
    let named = |fit: &&FitScore| {
        let name = always(fit.class, group.label.class());
        format!("{name:<PARAMETER$}")
    };
    let names: String = found.iter().map(named).collect();
    put(f, &format!("  {:18}{:12}{names}", "parameter", "own value"))?;
    for (place, parameter) in Parameter::ALL.into_iter().enumerate() {
        let of = |fit: &&FitScore| fit.found().map(|found| found.parameters[place]);
        let parameters: Vec<ParameterScore> = found.iter().filter_map(of).collect();
        let own = parameters.iter().find_map(|parameter| parameter.own);
        let own = own.map_or_else(|| "-".to_owned(), number);
        let values: String = parameters
            .iter()
            .map(|parameter| format!("{:<PARAMETER$}", value(parameter)))
            .collect();
        let name = format!("{} [{}]", parameter.name(), parameter.unit());
        put(f, &format!("  {name:18}{own:12}{values}"))?;
    }
    Ok(())
}

/// A value with its interval; `*` where the interval covers the scenario's true value.
fn value(parameter: &ParameterScore) -> String {
    let value = number(parameter.value);
    let [low, high] = parameter.ci95;
    match (low, high) {
        (Some(low), Some(high)) if low == high => format!("{value} (set)"),
        _ if !parameter.identifiable => format!("{value} (not identifiable)"),
        (Some(low), Some(high)) => {
            let holds = if parameter.holds_own == Some(true) {
                " *"
            } else {
                ""
            };
            format!("{value} [{}, {}]{holds}", number(low), number(high))
        }
        _ => format!("{value} (unbounded)"),
    }
}

fn write_remarks(f: &mut fmt::Formatter<'_>, fit: &FitScore) -> fmt::Result {
    let class = fit.class;
    match &fit.outcome {
        FitOutcome::Refused(reason) => writeln!(f, "  {class}: could not be fitted: {reason}"),
        FitOutcome::Found(found) => {
            let FoundScore {
                reduced_chi_square,
                combinations,
                warnings,
                fitted,
                left_out,
                ..
            } = &**found;
            put(
                f,
                &format!(
                    "  {class}: reduced chi square {}; errors fitted{}; left out{}",
                    number(*reduced_chi_square),
                    errors(fitted).trim_end(),
                    errors(left_out).trim_end()
                ),
            )?;
            let mut remarks = combinations.iter().chain(warnings);
            remarks.try_for_each(|remark| writeln!(f, "    {remark}"))
        }
    }
}

fn write_repeats(f: &mut fmt::Formatter<'_>, repeats: &[RepeatScore]) -> fmt::Result {
    let Some(first) = repeats.first() else {
        return Ok(());
    };
    put(
        f,
        &format!(
            "  {} repeats fitted alone, in ln k_s, ln c, ln K and phi [rad]",
            first.fits
        ),
    )?;
    put(
        f,
        "    parameter  identified  deviation  half-width  holds mean  holds own value",
    )?;
    for repeat in repeats {
        let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
        let share = |share: Option<Share>| {
            let of = |share: Share| {
                let held = (share.value * share.n as f64).round();
                format!("{held} of {}", share.n)
            };
            share.map_or_else(|| "-".to_owned(), of)
        };
        put(
            f,
            &format!(
                "    {:11}{:>10}  {:>9}  {:>10}  {:>10}  {:>15}",
                repeat.parameter.name(),
                repeat.identified,
                shown(repeat.deviation),
                shown(repeat.half_width),
                share(repeat.holds_mean),
                share(repeat.holds_own)
            ),
        )?;
    }
    Ok(())
}

/// Four digits, with an exponent where the number is far from 1.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (0.001..1.0e5).contains(&size) {
        let before = libm::floor(libm::log10(size)) as i32;
        let decimals = (3 - before).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_whatever_their_size() {
        let shown = [0.0, 31.894, -0.5771, 2.5114e6, 4.2e-5, 250.0].map(number);
        let expected = ["0", "31.89", "-0.5771", "2.511e6", "4.200e-5", "250.0"];
        assert_eq!(shown, expected);
        assert_eq!([12.34, 5678.9].map(percent), ["12.3", "5679"]);
    }
}
