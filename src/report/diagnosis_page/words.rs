//! Names of a diagnosis for readers.

use crate::effects::{self, Effect};
use crate::gap::{Cell, Statistic};

/// A share as per cent, without pretending to know the last of them.
pub fn percent(share: f64) -> String {
    match share {
        share if share.is_nan() => "–".to_owned(),
        share if share > 0.0 && share < 0.001 => "less than 0.1 %".to_owned(),
        share if share < 1.0 && share > 0.999 => "more than 99.9 %".to_owned(),
        share if (0.0995..0.95).contains(&share) => format!("{:.0} %", 100.0 * share),
        share => format!("{:.1} %", 100.0 * share).replace('-', "−"),
    }
}

/// A p-value.
pub fn p_value(p: f64) -> String {
    if p < 0.001 {
        return "p < 0.001".to_owned();
    }
    format!("p = {p:.3}")
}

/// A unit as written; empty where there is none.
pub fn unit(unit: &str) -> &str {
    match unit {
        "-" | "1" => "",
        "N m" => "N·m",
        "m/s^2" => "m/s²",
        "deg" => "°",
        unit => unit,
    }
}

/// Names in one line: `a`, `a or b`, `a, b or c`.
pub fn listed(names: &[String], last: &str) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

/// The effect of a name with or without its channel.
pub fn effect(name: &str) -> Option<&'static Effect> {
    let stem = name.split('.').next().unwrap_or(name);
    effects::find(stem).ok()
}

/// A channel or a pair of them.
pub fn channel(name: &str) -> String {
    let words = |name: &str| match name {
        "acceleration_y" => "vertical acceleration".to_owned(),
        "terrain" => "identified terrain".to_owned(),
        name => name.replace('_', " "),
    };
    let channels: Vec<String> = name.split('~').map(words).collect();
    channels.join(" with ")
}

/// What is read from a channel.
pub fn statistic(statistic: Statistic) -> String {
    use Statistic::*;
    let short = statistic.to_string();
    let words = match statistic {
        Deviation => "standard deviation",
        Crest => "largest peak over the deviation",
        Drift => "drift over the run",
        Transient => "initial transient",
        Step => "smallest step between samples",
        Held => "share of samples that repeat",
        Rails => "share of saturated samples",
        LugAverage => "average over a lug's pass",
        LugResidue => "variation about the lug's average",
        SteadyMean => "steady mean",
        PerLoad => "steady mean over the load",
        PerMetre => "trend with distance",
        Growth => "growth of the deviation",
        OrderLevel(order) => return format!("amplitude at order {order} of the wheel's turn"),
        OrderCosine(order) => return format!("cosine part at order {order} of the wheel's turn"),
        OrderSine(order) => return format!("sine part at order {order} of the wheel's turn"),
        Band(_) => return third(&short, "band_", "level in the third octave at"),
        Line(_) => return third(&short, "line_", "strongest line about"),
        ClassShare(class) => return format!("share of windows recognised as {class}"),
        Identified(_) => return format!("identified {short}"),
        _ => return short.replace('_', " "),
    };
    words.to_owned()
}

fn third(short: &str, prefix: &str, words: &str) -> String {
    let hertz = short.trim_start_matches(prefix).trim_end_matches("hz");
    format!("{words} {hertz} Hz")
}

/// A cell: what is read from which channel.
pub fn cell(cell: &Cell) -> String {
    let what = statistic(cell.statistic);
    format!("{}: {what}", channel(&cell.channel))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_probability_is_shown_as_certain() {
        let described = [0.0, 1e-9, 0.034, 0.5, 0.957, 0.9999, 1.0].map(percent);
        let expected = [
            "0.0 %",
            "less than 0.1 %",
            "3.4 %",
            "50 %",
            "95.7 %",
            "more than 99.9 %",
            "100.0 %",
        ];
        assert_eq!(described, expected);
        assert_eq!(percent(f64::NAN), "–");
    }

    #[test]
    fn a_cell_reads_as_a_sentence_would_name_it() {
        let described = |channel: &str, statistic| cell(&Cell::new(channel, statistic));
        assert_eq!(
            described("acceleration_y", Statistic::OrderLevel(28)),
            "vertical acceleration: amplitude at order 28 of the wheel's turn"
        );
        assert_eq!(
            described("drawbar_pull~sinkage", Statistic::Coherence),
            "drawbar pull with sinkage: coherence"
        );
        assert_eq!(
            described("normal_force", Statistic::Band(18)),
            "normal force: level in the third octave at 63 Hz"
        );
    }

    #[test]
    fn names_are_listed_as_spoken() {
        let names = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(listed(&names, "or"), "a, b or c");
        assert_eq!(listed(&names[..1], "or"), "a");
        assert_eq!(listed(&[], "or"), "");
    }
}
