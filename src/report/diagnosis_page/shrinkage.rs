//! How far the gap closes.

use super::words::{listed, percent};
use crate::diagnosis::{Diagnosis, Gaps};
use crate::gap::Closed;
use crate::report::gap_waterfall;
use crate::report::page::{Cell, Column, Figure, Section, Table};

/// The waterfall and its numbers.
pub fn section(diagnosis: &Diagnosis) -> Section {
    let section = Section::new("Closed share of the difference");
    let Some(gaps) = &diagnosis.gap else {
        return section.prose("The variants of the scenario could not be simulated.");
    };
    let added = if diagnosis.closed_with.is_empty() {
        "no effect".to_owned()
    } else {
        listed(&diagnosis.closed_with, "and")
    };
    section
        .answer(answer(diagnosis.closed, gaps, &added))
        .figure(Figure::new(
            gap_waterfall(gaps, diagnosis.closed, &added),
            caption(gaps),
        ))
        .table(scores(gaps, &added))
}

fn caption(gaps: &Gaps) -> String {
    let line = if gaps.floor_with_discrepancy.is_some() {
        " The dashed line is what the true cause would leave with the discrepancy assumed for any simulator."
    } else {
        ""
    };
    format!(
        "The score is the energy score: mean distance of a measured run from simulated runs of the same condition, in \
         standard deviations per statistic, minus half the mean distance between these. Parameters and magnitudes are \
         fitted to all conditions.{line}"
    )
}

fn answer(closed: Option<Closed>, gaps: &Gaps, added: &str) -> String {
    let Some(closed) = closed else {
        return "No gap remains after recalibration.".to_owned();
    };
    let left = if gaps.is_within_discrepancy() {
        " The gap left is no larger than the discrepancy assumed for any simulator would leave."
    } else {
        ""
    };
    format!("{}.{left}", of_the_gap(&closed, added))
}

/// How much of the gap is closed by what is added. Where the interval has 0 in it, nothing is claimed.
pub fn of_the_gap(closed: &Closed, added: &str) -> String {
    let claimed = share(closed.value);
    if closed.clusters < 2 {
        return format!(
            "{added} closes {claimed} of the gap that remains after recalibration, from one condition and so without \
             an interval"
        );
    }
    let interval = interval(closed);
    if !closed.is_shown() {
        return format!(
            "{added} is not shown to close the gap that remains after recalibration (best estimate {claimed}, {interval})"
        );
    }
    format!("{added} closes {claimed} of the gap that remains after recalibration ({interval})")
}

fn interval(closed: &Closed) -> String {
    let [low, high] = closed.ci95.map(share);
    let clusters = closed.clusters;
    format!("95 % interval {low} to {high}, over {clusters} conditions and days")
}

/// A share of the gap. One above 1 is no more than all of it: the score is below the floor, which is an estimate; one below
/// -1 more than doubles the gap.
fn share(value: f64) -> String {
    if value < -1.0 {
        return "below −100 %".to_owned();
    }
    percent(value.min(1.0))
}

fn scores(gaps: &Gaps, added: &str) -> Table {
    let row = |name: &str, score: f64| vec![Cell::text(name), Cell::Number(score)];
    let mut rows = vec![
        row("nominal", gaps.as_shipped),
        row("recalibrated", gaps.recalibrated),
        row(&format!("with {added}"), gaps.with_effect),
        row("floor: scatter between runs", gaps.floor),
    ];
    if let Some(floor) = gaps.floor_with_discrepancy {
        rows.push(row(
            "floor with the discrepancy assumed for any simulator",
            floor,
        ));
    }
    Table {
        caption: "Mean energy scores of simulated runs, in standard deviations per statistic"
            .to_owned(),
        columns: Column::named(["simulator", "score"]),
        rows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stated(value: f64, ci95: [f64; 2], clusters: usize) -> String {
        let closed = Closed {
            value,
            ci95,
            clusters,
        };
        of_the_gap(&closed, "gain_error")
    }

    #[test]
    fn a_share_whose_interval_holds_0_is_not_claimed_and_none_is_above_all() {
        let vague = stated(6.567, [-0.423, 14.565], 3);
        assert_eq!(
            vague,
            "gain_error is not shown to close the gap that remains after recalibration (best estimate 100.0 %, \
             95 % interval −42.3 % to 100.0 %, over 3 conditions and days)"
        );
        assert!(stated(-3.0, [-7.0, 0.5], 3).contains("estimate below −100 %"));
        let sure = stated(0.8, [0.6, 1.1], 3);
        assert!(
            sure.starts_with("gain_error closes 80 % of the gap"),
            "{sure}"
        );
        assert!(
            sure.contains("(95 % interval 60 % to 100.0 %, over 3"),
            "{sure}"
        );
        assert!(
            stated(0.8, [0.8, 0.8], 1).ends_with("from one condition and so without an interval")
        );
    }
}
