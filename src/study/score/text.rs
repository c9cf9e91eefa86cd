//! Scores as text for reading, and as CSV.

use super::{Against, Counted, MethodScore, Part, RecognitionScore};
use crate::recognition::confusion::{CLASSES, Share};
use crate::study::table::{cell, line};
use std::fmt;

impl RecognitionScore {
    /// One row for every true class in every part of the windows.
    pub fn to_csv(&self) -> String {
        let first = ["method", "against", "by", "value", "true_class"];
        let then = ["n", "correct", "share", "low", "high"];
        let names = first.into_iter().chain(then);
        let names = names.chain(CLASSES.map(|class| class.as_str()));
        let mut text = line(&names.map(str::to_owned).collect::<Vec<_>>());
        if let Some(published) = &self.published {
            add_rows(&mut text, ["published", "label", "all", ""], published);
        }
        for MethodScore {
            method,
            against,
            all,
            map,
        } in &self.scores
        {
            let against = against.as_str();
            add_rows(&mut text, [method, against, "all", ""], all);
            for Part { by, value, counted } in map {
                add_rows(&mut text, [method, against, by, value], counted);
            }
        }
        text
    }
}

impl Against {
    fn as_str(self) -> &'static str {
        match self {
            Self::Label => "label",
            Self::Truth => "truth",
            Self::Agreed => "agreed",
        }
    }
}

fn add_rows(text: &mut String, first: [&str; 4], counted: &Counted) {
    let counts = &counted.confusion.counts;
    for (row, class) in CLASSES.iter().enumerate() {
        let share = counted.recalls.get(class).copied();
        let answers = counts[row];
        add_row(text, &first, (class.as_str(), answers[row], share), answers);
    }
    let answers = std::array::from_fn(|column| counts.iter().map(|row| row[column]).sum());
    let correct = counted.confusion.correct();
    add_row(text, &first, ("all", correct, counted.accuracy), answers);
}

fn add_row(
    text: &mut String,
    first: &[&str; 4],
    (class, correct, share): (&str, u64, Option<Share>),
    answers: [u64; 4],
) {
    let Some(share) = share else {
        return;
    };
    let mut cells: Vec<String> = first.iter().map(|text| (*text).to_owned()).collect();
    cells.push(class.to_owned());
    cells.extend([share.n, correct].map(|count| count.to_string()));
    cells.extend([share.value, share.ci95[0], share.ci95[1]].map(|number| cell(Some(number))));
    cells.extend(answers.map(|count| count.to_string()));
    text.push_str(&line(&cells));
}

impl fmt::Display for RecognitionScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} windows. Shares have Wilson's 95 % interval, which takes windows for independent.",
            self.windows
        )?;
        for score in &self.scores {
            let published = self.published.as_ref();
            let published = published.filter(|_| score.against == Against::Label);
            write!(f, "\n{}: {}", score.method, what_is_true(score.against))?;
            confusion(f, &score.all, published)?;
        }
        let labelled = |score: &&MethodScore| score.against == Against::Label;
        for score in self.scores.iter().filter(labelled) {
            write!(
                f,
                "\n{}: right answers by part, and their number of windows; true is the class of the label\n",
                score.method
            )?;
            parts(f, &score.map)?;
        }
        super::features::write(f, &self.features)
    }
}

fn what_is_true(against: Against) -> &'static str {
    match against {
        Against::Label => "true is the class of the label\n",
        Against::Truth => "true is how lugs and ground met\n",
        Against::Agreed => "windows in which both are one\n",
    }
}

/// Width of a count, and of a share with its interval.
const COUNT: usize = 7;
const SHARE: usize = 24;
/// Width of a confusion matrix with its recalls.
const MATRIX: usize = 4 * COUNT + 3 + SHARE;

fn confusion(
    f: &mut fmt::Formatter<'_>,
    counted: &Counted,
    published: Option<&Counted>,
) -> fmt::Result {
    let sides: Vec<(&str, &Counted)> = std::iter::once(("simulated", counted))
        .chain(published.map(|published| ("published", published)))
        .collect();
    let titles = sides.iter().map(|(whose, _)| format!("{whose:<MATRIX$}"));
    line_of(f, "", titles)?;
    let columns = CLASSES.map(|class| format!("{:>COUNT$}", class.as_str()));
    let columns = format!("{}   {:<SHARE$}", columns.concat(), "recall");
    line_of(f, "true class", sides.iter().map(|_| columns.clone()))?;
    for (row, class) in CLASSES.iter().enumerate() {
        if sides
            .iter()
            .any(|(_, side)| side.recalls.contains_key(class))
        {
            line_of(
                f,
                class.as_str(),
                sides.iter().map(|(_, side)| matrix_row(side, row)),
            )?;
        }
    }
    for (whose, side) in sides {
        writeln!(
            f,
            "  {whose}: accuracy {} of {}; {} confused with another known class",
            share(side.accuracy.as_ref()),
            side.confusion.total(),
            side.confused
        )?;
    }
    Ok(())
}

/// Counts and recall of a true class.
fn matrix_row(counted: &Counted, row: usize) -> String {
    let counts = counted.confusion.counts[row].map(|count| format!("{count:>COUNT$}"));
    let recall = share(counted.recalls.get(&CLASSES[row]));
    format!("{}   {recall:<SHARE$}", counts.concat())
}

fn line_of(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    cells: impl Iterator<Item = String>,
) -> fmt::Result {
    let cells: String = cells.collect();
    writeln!(f, "{}", format!("  {name:10}{cells}").trim_end())
}

fn parts(f: &mut fmt::Formatter<'_>, map: &[Part]) -> fmt::Result {
    let named = map
        .iter()
        .flat_map(|part| [part.by.len(), part.value.len()]);
    let width = named.max().unwrap_or_default() + 2;
    let cell_width = SHARE + COUNT;
    for group in map.chunk_by(|a, b| a.by == b.by) {
        write!(f, "  {:width$}", group[0].by)?;
        for class in &CLASSES[..3] {
            write!(f, "{:<cell_width$}", class.as_str())?;
        }
        writeln!(f, "all")?;
        for Part { value, counted, .. } in group {
            write!(f, "  {value:width$}")?;
            for class in &CLASSES[..3] {
                write!(
                    f,
                    "{:<cell_width$}",
                    share_and_n(counted.recalls.get(class))
                )?;
            }
            writeln!(f, "{}", share_and_n(counted.accuracy.as_ref()))?;
        }
    }
    Ok(())
}

fn share(share: Option<&Share>) -> String {
    share.map_or_else(
        || "-".to_owned(),
        |Share {
             value,
             ci95: [low, high],
             ..
         }| format!("{value:.3} [{low:.3}, {high:.3}]"),
    )
}

fn share_and_n(found: Option<&Share>) -> String {
    let n = found.map(|share| format!(" {}", share.n));
    format!("{}{}", share(found), n.unwrap_or_default())
}
