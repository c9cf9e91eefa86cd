//! Scores as text for reading.

use super::features;
use super::{Against, Counted, MethodScore, Part, RecognitionScore};
use crate::recognition::confusion::CLASSES;
use crate::statistics::Share;
use crate::table::{Cell, Table};
use std::fmt;

impl fmt::Display for RecognitionScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} windows. Shares have Wilson's 95 % interval, which assumes independent windows.",
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
                "\n{}: correct answers by part, and their number of windows; reference: class of the label\n",
                score.method
            )?;
            f.write_str(&parts(&score.map))?;
        }
        f.write_str(&features::text(&self.features))
    }
}

fn what_is_true(against: Against) -> &'static str {
    match against {
        Against::Label => "reference: class of the label\n",
        Against::Truth => "reference: lug contacts\n",
        Against::Agreed => "windows in which label and lug contacts agree\n",
    }
}

/// Counts of answers and recall by true class, of the simulated windows and of those published.
fn confusion(
    f: &mut fmt::Formatter<'_>,
    counted: &Counted,
    published: Option<&Counted>,
) -> fmt::Result {
    let published = published.map(|published| ("published", published));
    let sides = [("simulated", counted)].into_iter().chain(published);
    let rows = sides.clone().flat_map(|(whose, side)| {
        let occurs = CLASSES
            .iter()
            .filter(|class| side.recalls.contains_key(class));
        occurs.map(move |class| {
            let counts = side.confusion.counts[*class as usize].map(Cell::Count);
            let mut cells = vec![Cell::text(whose), Cell::text(class.as_str())];
            cells.extend(counts);
            cells.push(Cell::Text(share(side.recalls.get(class))));
            cells
        })
    });
    let classes = CLASSES.map(|class| class.as_str());
    let columns = ["", "true class"].into_iter().chain(classes);
    let table = Table::of(columns.chain(["recall"]), rows);
    f.write_str(&table.to_text(2))?;
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

/// Share of right answers by part and true class.
fn parts(map: &[Part]) -> String {
    let row = |Part { by, value, counted }: &Part| {
        let recalls = CLASSES[..3].iter().map(|class| counted.recalls.get(class));
        let shares = recalls.chain([counted.accuracy.as_ref()]).map(share_and_n);
        let first = [by, value].map(Cell::text).into_iter();
        first.chain(shares.map(Cell::Text)).collect()
    };
    let classes = CLASSES[..3].iter().map(|class| class.as_str());
    let columns = ["by", ""].into_iter().chain(classes);
    Table::of(columns.chain(["all"]), map.iter().map(row)).to_text(2)
}

fn share(share: Option<&Share>) -> String {
    share.map_or_else(|| "-".to_owned(), Share::to_string)
}

fn share_and_n(found: Option<&Share>) -> String {
    let n = found.map(|share| format!(" {}", share.n));
    format!("{}{}", share(found), n.unwrap_or_default())
}
