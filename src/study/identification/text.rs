//! Identification scores as text for reading.

use super::Published;
use super::score::{
    Accuracy, CarriedScore, Choice, DriftScore, FitOutcome, FitScore, FoundScore, GroundScore,
    GroupScore, IdentificationScore, ModelScore, ParameterScore, PredictionScore, RepeatScore,
};
use crate::identification::{Force, Parameter, Standing};
use crate::recognition::confusion::CLASSES;
use crate::statistics::Share;
use crate::table::{Cell, Table};
use crate::terrain::class::Wtic;
use std::fmt;

impl fmt::Display for IdentificationScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "Triples of numbers: pull, load, torque. Errors [%]: mean absolute error over mean absolute value of the\n\
             force, on the rows fitted, on the means of a condition's rows, and on rows left out of the fit.\n\
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

/// A table of texts.
fn table<'n>(names: impl IntoIterator<Item = &'n str>, rows: Vec<Vec<String>>) -> Table {
    let rows = rows.into_iter();
    let cells = rows.map(|row| row.into_iter().map(Cell::Text).collect());
    Table::of(names, cells)
}

fn write_ground(
    f: &mut fmt::Formatter<'_>,
    ground: &GroundScore,
    published: Option<&Published>,
) -> fmt::Result {
    let class = ground.label.class();
    writeln!(
        f,
        "\n{}: ground {}, nominal class {class}; recognized as this in {} of {} fits",
        ground.scenario, ground.label, ground.recognized, ground.groups
    )?;
    let mut rows: Vec<Vec<String>> = ground.models.iter().map(|it| model(it, class)).collect();
    if let Some(published) = published {
        let shown = Force::ALL.map(|force| published.error(class, force));
        rows.push(vec!["published".to_owned(), three(shown)]);
    }
    let errors = ["model", "fitted", "means", "left out", "scatter of rows"];
    let names = ["scatter of means", "covered", "and left out"];
    f.write_str(&table(errors.into_iter().chain(names), rows).to_text(2))
}

/// Name and errors of a way to choose a model.
fn model(model: &ModelScore, ground: Wtic) -> Vec<String> {
    let ModelScore {
        fitted,
        means,
        left_out,
        ..
    } = model;
    let mut cells = vec![match model.choice {
        Choice::Recognized => "by class recognized".to_owned(),
        Choice::Always(of) => always(of, ground),
    }];
    if model.groups == 0 {
        cells.push("could not be fitted".to_owned());
        return cells;
    }
    cells.extend([fitted, means, left_out].map(errors));
    cells.extend([fitted, means].map(scatter));
    cells.extend([fitted, left_out].map(covered));
    cells
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

/// Pull, load and torque [%].
fn three(values: [Option<f64>; 3]) -> String {
    let shown = values.map(|value| value.map_or_else(|| "-".to_owned(), percent));
    let [pull, load, torque] = shown;
    format!("{pull:>6} {load:>6} {torque:>6}")
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

/// Shares [%] of pull, load and torque within their intervals.
fn covered(accuracy: &Accuracy) -> String {
    let [pull, load, torque] = Force::ALL.map(|force| {
        let share = accuracy.covered.get(&force);
        share.map_or_else(
            || "-".to_owned(),
            |share| format!("{:.0}", 100.0 * share.value),
        )
    });
    format!("{pull:>3} {load:>3} {torque:>3}")
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
    let row = |from: &str| {
        let on = |to: &str| {
            let found = carried.iter().find(|c| c.from == from && c.to == to);
            found.map_or_else(String::new, |found| errors(&found.accuracy))
        };
        std::iter::once(from.to_owned())
            .chain(names().map(on))
            .collect()
    };
    let head: Vec<String> = names().map(|name| format!("on {name}")).collect();
    let head = std::iter::once("of").chain(head.iter().map(String::as_str));
    f.write_str(&table(head, names().map(row).collect()).to_text(2))
}

fn write_predictions(f: &mut fmt::Formatter<'_>, score: &IdentificationScore) -> fmt::Result {
    if score.predictions.is_empty() {
        return Ok(());
    }
    f.write_str(
        "\npredicted by the parameters from the reference condition; `stops` where an error is above twice \
         the published one;\nby ALCT and SLCT pull and torque are predicted at the load measured, the load as it was fitted\n",
    )?;
    let row = |prediction: &PredictionScore| {
        let beyond: Vec<&str> = prediction.beyond.iter().map(|force| force.name()).collect();
        vec![
            place(&prediction.scenario, &prediction.shared),
            prediction.class.to_string(),
            errors(&prediction.accuracy),
            covered(&prediction.accuracy),
            beyond.join(", "),
        ]
    };
    let rows = score.predictions.iter().map(row).collect();
    f.write_str(&table(["", "model", "error", "covered", "stops"], rows).to_text(2))
}

/// The parameters of all groups side by side.
fn write_overview(f: &mut fmt::Formatter<'_>, score: &IdentificationScore) -> fmt::Result {
    f.write_str(
        "\nparameters by the class recognized, or the label's where none was; (..) where the loads do not fix them\n",
    )?;
    if score.groups.iter().any(|group| group.not_steady > 0) {
        f.write_str("~ where some rows of a group are not steady\n")?;
    }
    let names = Parameter::ALL.map(Parameter::name);
    let names = ["", "model"].into_iter().chain(names);
    let rows = score.groups.iter().map(overview).collect();
    f.write_str(&table(names, rows).to_text(2))
}

/// Name, model and parameters of a group.
fn overview(group: &GroupScore) -> Vec<String> {
    let text = |parameter: &ParameterScore| {
        let value = number(parameter.value);
        match (parameter.identifiable, parameter.identified.standing) {
            (false, Standing::NotIdentifiable) => format!("({value})"),
            (false, _) => "set".to_owned(),
            (true, _) => value,
        }
    };
    let (class, values) = group.parameters().map_or_else(
        || ("-".to_owned(), Vec::new()),
        |(class, found)| (class.to_string(), found.iter().map(text).collect()),
    );
    let mark = if group.not_steady > 0 { "~" } else { "" };
    let place = format!("{}{mark}", place(&group.scenario, &group.shared));
    [place, class].into_iter().chain(values).collect()
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
        ", which is not the nominal class of the ground"
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
    f.write_str(&parameters(group).to_text(2))?;
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

/// Own and fitted value of every parameter, a column a fit.
fn parameters(group: &GroupScore) -> Table {
    let fits = group.fits.iter();
    let fits: Vec<(&FitScore, &FoundScore)> =
        fits.filter_map(|fit| Some((fit, fit.found()?))).collect();
    let row = |(place, parameter): (usize, Parameter)| {
        let found = fits.iter().map(|(_, found)| &found.parameters[place]);
        let own = found.clone().find_map(|parameter| parameter.own);
        let name = format!("{} [{}]", parameter.name(), parameter.unit());
        let own = own.map_or_else(|| "-".to_owned(), number);
        [name, own].into_iter().chain(found.map(value)).collect()
    };
    let classes = fits
        .iter()
        .map(|(fit, _)| always(fit.class, group.label.class()));
    let classes: Vec<String> = classes.collect();
    let names = ["parameter", "own value"].into_iter();
    let rows = Parameter::ALL.into_iter().enumerate().map(row).collect();
    table(names.chain(classes.iter().map(String::as_str)), rows)
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
            writeln!(
                f,
                "  {class}: reduced chi square {}; errors fitted{}; left out{}",
                number(*reduced_chi_square),
                errors(fitted),
                errors(left_out)
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
    writeln!(
        f,
        "  {} repeats fitted alone, in ln k_s, ln c, ln K and phi [rad]",
        first.fits
    )?;
    let shown = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number);
    let share = |share: Option<Share>| {
        let of = |share: Share| {
            let held = (share.value * share.n as f64).round();
            format!("{held} of {}", share.n)
        };
        share.map_or_else(|| "-".to_owned(), of)
    };
    let row = |repeat: &RepeatScore| {
        vec![
            repeat.parameter.name().to_owned(),
            repeat.identified.to_string(),
            shown(repeat.deviation),
            shown(repeat.half_width),
            share(repeat.holds_mean),
            share(repeat.holds_own),
        ]
    };
    let names = ["parameter", "identified", "deviation", "half-width"];
    let names = names.into_iter().chain(["holds mean", "holds own value"]);
    f.write_str(&table(names, repeats.iter().map(row).collect()).to_text(4))
}

/// Four digits, with an exponent where the number is far from 1.
fn number(value: f64) -> String {
    Cell::Number(value).in_ascii()
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
