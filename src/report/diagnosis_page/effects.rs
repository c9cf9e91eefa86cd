//! Effects that may explain the gap, and which of them these runs can discriminate.

use super::DiagnosisReport;
use super::words;
use crate::diagnosis::{ALIKE, Diagnosis, Screened, Suspect};
use crate::effects::Bound;
use crate::report::page::{Cell, Column, Figure, Section, Table};
use crate::report::{isolability_map, probability_bars};

/// Effects listed by their probability.
const LISTED: usize = 12;

/// Probabilities, and what is known of the likeliest effects.
pub fn suspects(diagnosis: &Diagnosis) -> Section {
    let verdict = &diagnosis.verdict;
    let section = Section::new("Candidate effects").figure(Figure::new(
        probability_bars(&verdict.probabilities),
        "Posterior probability of every explanation. An effect may occur alone or with another.",
    ));
    let listed: Vec<&Suspect> = verdict.effects.iter().take(LISTED).collect();
    if listed.is_empty() {
        return section.prose("No effect was tried.");
    }
    let estimates = listed.iter().map(|suspect| estimate(suspect));
    let section = section
        .prose(
            "The probability of an effect is the sum over all explanations with it; its magnitude is conditional \
             on the most probable of them. Effects that the runs cannot discriminate are equally possible causes. \
             Absorbed is the fraction of the signature that recalibrated parameters can reproduce; the detection \
             limit is the magnitude of three standard deviations.",
        )
        .table(Table {
            caption: "Most probable effects with the 95 % intervals of their magnitudes".to_owned(),
            columns: vec![
                Column::new("effect", ""),
                Column::new("probability", "%"),
                Column::new("magnitude", ""),
                Column::new("unit", ""),
                Column::new("absorbed by parameters", "%"),
                Column::new("detection limit", ""),
                Column::new("cannot be distinguished from", ""),
            ],
            rows: estimates.collect(),
        });
    let meanings = listed.iter().filter_map(|suspect| meaning(suspect));
    section.table(Table {
        caption: "Descriptions and signatures".to_owned(),
        columns: Column::named([
            "effect",
            "what it is",
            "affected channels",
            "varies with",
            "depends",
        ]),
        rows: meanings.collect(),
    })
}

fn estimate(suspect: &Suspect) -> Vec<Cell> {
    vec![
        Cell::Code(suspect.name.clone()),
        percent(suspect.probability),
        Cell::Estimate(suspect.magnitude, suspect.ci95),
        Cell::text(words::unit(suspect.unit)),
        percent(suspect.absorbed),
        limit(suspect.detectable),
        Cell::text(suspect.equivalent_to.join(", ")),
    ]
}

fn percent(share: f64) -> Cell {
    let text = words::percent(share).trim_end_matches(" %").to_owned();
    Cell::Written(text, share)
}

fn limit(detectable: Option<f64>) -> Cell {
    detectable.map_or(Cell::text("undetectable"), Cell::Number)
}

fn meaning(suspect: &Suspect) -> Option<Vec<Cell>> {
    let effect = words::effect(&suspect.name)?;
    let bound = match effect.signature.bound {
        Bound::WheelAngle => "wheel angle",
        Bound::Frequency => "frequency",
        Bound::History => "time and distance since the start",
        Bound::Condition => "load, speed and slip",
    };
    let channels = effect.signature.channels.iter();
    let channels: Vec<String> = channels.map(|name| words::channel(name)).collect();
    Some(vec![
        Cell::Code(suspect.name.clone()),
        Cell::text(effect.title),
        Cell::text(channels.join(", ")),
        Cell::text(bound),
        Cell::text(effect.signature.dependence),
    ])
}

/// Cosines of all signatures, and the sets that cannot be distinguished; none without effects.
pub fn isolability(report: &DiagnosisReport) -> Option<Section> {
    let Diagnosis {
        screen,
        isolability,
        ..
    } = report.diagnosis;
    if screen.is_empty() {
        return None;
    }
    // What does not show is like nothing.
    let shown: Vec<usize> = (0..screen.len().min(isolability.len()))
        .filter(|&place| screen[place].detectable.is_some())
        .collect();
    let names: Vec<&str> = shown.iter().map(|&place| &*screen[place].name).collect();
    let row = |&place: &usize| -> Vec<f64> {
        let own = shown.iter();
        own.map(|&other| isolability[place].get(other).copied().unwrap_or(f64::NAN))
            .collect()
    };
    let cosines: Vec<Vec<f64>> = shown.iter().map(row).collect();
    let alike = ALIKE;
    let section = Section::new("Isolability of the effects")
        .answer(answer(screen, names.len()))
        .figure(Figure::new(
            isolability_map(&names, &cosines, alike),
            "Cosines of the signatures of effects at typical magnitudes in these conditions, after projection on \
             the complement of the parameters.",
        ));
    Some(section.table(sets(screen)).table(all(screen)))
}

fn answer(screen: &[Screened], shown: usize) -> String {
    let alone = screen
        .iter()
        .filter(|it| it.detectable.is_some() && it.equivalent.is_empty())
        .count();
    format!(
        "Of {} effects tried {shown} are detectable here, and {alone} of them can be distinguished from every \
         other.",
        screen.len()
    )
}

/// Every effect that shows like another.
fn sets(screen: &[Screened]) -> Table {
    let alike = screen.iter().filter(|it| !it.equivalent.is_empty());
    let rows = alike.map(|screened| {
        let others = screened.equivalent.iter().map(|(name, cosine)| {
            let cosine = format!("{cosine:.3}").replace('-', "−");
            format!("{name} ({cosine})")
        });
        let others: Vec<String> = others.collect();
        vec![
            Cell::Code(screened.name.clone()),
            Cell::text(others.join(", ")),
        ]
    });
    Table {
        caption:
            "Effects that these runs cannot discriminate, with the cosines of their signatures"
                .to_owned(),
        columns: Column::named(["effect", "cannot be distinguished from"]),
        rows: rows.collect(),
    }
}

fn all(screen: &[Screened]) -> Table {
    let rows = screen.iter().map(|screened| {
        vec![
            Cell::Code(screened.name.clone()),
            Cell::Number(screened.score),
            limit(screened.detectable),
            Cell::text(words::unit(screened.unit)),
            percent(screened.absorbed),
        ]
    });
    Table {
        caption: "All effects tried: χ² explained beyond the parameters, and detection limit"
            .to_owned(),
        columns: vec![
            Column::new("effect", ""),
            Column::new("χ² explained", ""),
            Column::new("detection limit", ""),
            Column::new("unit", ""),
            Column::new("absorbed by parameters", "%"),
        ],
        rows: rows.collect(),
    }
}
