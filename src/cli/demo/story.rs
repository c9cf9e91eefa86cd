//! What the demo found, as questions and answers.

use super::identification::Identified;
use super::recognition::{Recognition, WINDOW};
use super::small_study::SmallStudy;
use super::{EDITS, Finding, RUNS, gap};
use crate::cli::dataset::classes;
use crate::cli::diagnose::Diagnose;
use crate::cli::diagnose::summary::Summary;
use crate::cli::provenance::{self, quoted};
use crate::cli::series::spreads;
use crate::cli::steady::{QUANTITIES, Quantity, Spread};
use crate::report::page::{self, Cell, Column, Figure, Page, Section, Table};
use crate::report::{RunView, side_by_side};
use std::path::Path;

/// Results of the demo.
pub struct Results<'a> {
    /// Every ground.
    pub findings: &'a [Finding],
    /// Classes recognised from vibration.
    pub recognition: &'a Recognition,
    /// Parameters found from loads.
    pub identified: &'a Identified,
    /// What they were found from.
    pub loads: &'a SmallStudy,
    /// A rig's runs, how they were diagnosed, and what came of it.
    pub rig: (&'a SmallStudy, &'a Diagnose, &'a Summary),
    /// The folder of the demo.
    pub folder: &'a Path,
    /// The seed of all runs.
    pub seed: u64,
    /// Seconds that it took.
    pub computing_s: f64,
}

/// The page of the demo: data, what is recognised and identified in them, how to go on.
pub fn story(results: &Results) -> Page {
    let Results {
        findings,
        recognition,
        identified,
        ..
    } = *results;
    let (_, _, diagnosed) = results.rig;
    let answers = std::iter::once(recognition.answer())
        .chain(identified.answer())
        .chain([diagnosed.answer.clone()]);
    Page {
        title: "A lugged wheel on four grounds".to_owned(),
        question:
            "Which ground does a rover's wheel roll on, what are its parameters, and what does a \
                   simulation of it lack?"
                .to_owned(),
        answer: answers.collect::<Vec<_>>().join(" "),
        intro: intro(findings),
        sections: vec![
            look(findings),
            motion(findings),
            loads(findings),
            lugs(findings),
            recognition.section(),
            identified.section(),
            gap::section(diagnosed),
            soundness(findings),
            records(findings),
            next_steps(findings),
        ],
        provenance: provenance(results),
    }
}

fn intro(findings: &[Finding]) -> String {
    let names: Vec<&str> = findings.iter().map(|finding| finding.name).collect();
    let run = &findings[0].first.1.attributes;
    format!(
        "A wheel of {:.0} mm radius with {} rolls at {:.0} mm/s and slip {} under \
         {:.0} N, on {}: {RUNS} simulated runs of {} s on each, measured as a test rig would. Runs \
         on a ground differ in what is random there, its unevenness or its stones; on flat hard \
         ground nothing is.",
        run.wheel_radius * 1e3,
        run.lugs(),
        run.speed * 1e3,
        run.slip_ratio,
        run.load,
        names.join(", "),
        findings[0].scenario.duration,
    )
}

fn look(findings: &[Finding]) -> Section {
    let runs: Vec<_> = findings
        .iter()
        .map(|finding| (finding.name, &finding.first.1))
        .collect();
    let scenario = &findings[0].scenario;
    let (driven, duration) = (scenario.driven(), scenario.duration);
    Section::new("Vibration by ground")
        .answer(spread_of(
            findings,
            "acceleration_y_rms",
            "Vertical acceleration of the axle, rms",
        ))
        .prose(
            "On hard ground every lug contact causes an impact, and the traces are periodic in the lug pass. \
             Loose stones move irregularly. Lugs enter sand: the rim is lower, and the impacts are weaker.",
        )
        .figure(Figure::new(
            side_by_side(&runs, [driven - duration, driven]),
            "The first run on each ground. The scale is the same along a row. Sinkage is the rim's depth \
             below the undisturbed surface, and below 0 where the wheel stands on its lugs.",
        ))
}

fn motion(findings: &[Finding]) -> Section {
    let section = Section::new("Motion of the wheel").prose(
        "The first run on each ground: press play, or move the slider. Coloured lugs carry load; the arrows are \
         the normal force of the ground, the drawbar pull and the driving torque.",
    );
    findings.iter().fold(section, |section, finding| {
        let (id, trace, _) = &finding.first;
        match RunView::new(trace, id) {
            Ok(view) => section
                .prose(format!("{id} on {}:", finding.name))
                .run(view),
            Err(_) => section,
        }
    })
}

fn loads(findings: &[Finding]) -> Section {
    let quantities = || QUANTITIES.iter().filter(|quantity| is_shown(quantity));
    let columns = quantities().map(|quantity| Column::new(quantity.name, quantity.shown_unit));
    let row = |finding: &Finding| {
        let cells = quantities().map(|quantity| {
            let spread = spread(finding, quantity.key);
            Cell::text(spread.map_or("–".to_owned(), |(quantity, spread)| {
                range(quantity, &spread)
            }))
        });
        std::iter::once(Cell::text(finding.name))
            .chain(cells)
            .collect()
    };
    Section::new("Drawbar pull and sinkage")
        .answer(spread_of(findings, "drawbar_pull", "Drawbar pull"))
        .table(Table {
            caption: format!(
                "Steady values, from the middle half of each run: mean of {RUNS} runs [least, greatest]. Sinkage below \
                 0: the rim is above the surface, the wheel stands on its lugs"
            ),
            columns: std::iter::once(Column::new("ground", ""))
                .chain(columns)
                .collect(),
            rows: findings.iter().map(row).collect(),
        })
}

/// Whether a quantity is an outcome here: load and slip are commanded.
fn is_shown(quantity: &Quantity) -> bool {
    !matches!(quantity.key, "normal_force" | "slip_ratio")
}

fn lugs(findings: &[Finding]) -> Section {
    const CLASSES: [&str; 5] = ["ALCT", "SLCT", "LEIS", "UWTIC", "mixed"];
    let row = |finding: &Finding| {
        let counts = classes(&finding.outcomes);
        let cells = CLASSES
            .iter()
            .map(|class| Cell::Count(counts.get(class).copied().unwrap_or(0) as u64));
        std::iter::once(Cell::text(finding.name))
            .chain(cells)
            .collect()
    };
    let classes = findings.iter().map(|finding| {
        let counts = classes(&finding.outcomes);
        let counts: Vec<String> = counts.iter().map(|(c, n)| format!("{n} {c}")).collect();
        format!("{} on {}", counts.join(" and "), finding.name)
    });
    let columns = CLASSES.iter().map(|class| Column::new(*class, ""));
    Section::new("Contacts of the lugs")
        .answer(format!(
            "Runs of each class: {}.",
            classes.collect::<Vec<_>>().join(", ")
        ))
        .prose(
            "The true classes by the simulated contacts, against which a recognition is scored. LEIS: at least \
             90 % of the lugs that passed the bottom entered the soil by more than 1 mm. ALCT: otherwise at \
             least 90 % touched. SLCT: fewer touched. UWTIC: none touched, or none passed.",
        )
        .table(Table {
            caption: "Number of runs of each true class".to_owned(),
            columns: std::iter::once(Column::new("ground", ""))
                .chain(columns)
                .collect(),
            rows: findings.iter().map(row).collect(),
        })
}

fn soundness(findings: &[Finding]) -> Section {
    let rows: Vec<Vec<Cell>> = findings
        .iter()
        .flat_map(|finding| {
            finding.inspection.findings.iter().map(|doubt| {
                let place = doubt.channel.clone().unwrap_or_default();
                vec![
                    Cell::text(finding.name),
                    Cell::text(&doubt.run),
                    Cell::text(place),
                    Cell::text(&doubt.message),
                ]
            })
        })
        .collect();
    let runs: usize = findings.iter().map(|f| f.inspection.runs.len()).sum();
    let answer = match rows.len() {
        0 => format!("No faults were found in the {runs} runs."),
        1 => format!("One fault was found in the {runs} runs."),
        count => format!("{count} faults were found in the {runs} runs."),
    };
    let columns = ["ground", "run", "channel", "what was seen"].map(|name| Column::new(name, ""));
    let table = Table {
        caption: "Findings of the inspection".to_owned(),
        columns: columns.to_vec(),
        rows,
    };
    Section::new("Inspection of the files")
        .answer(answer)
        .prose(
            "Each file was read and checked for gaps, clipped and constant channels, units, signs, and labels \
             that contradict the channels.",
        )
        .table(table)
}

fn records(findings: &[Finding]) -> Section {
    let figure = |finding: &Finding| {
        let (id, _, svg) = &finding.first;
        let file = finding.run_file.display();
        Figure::new(svg.clone(), format!("{id} of {file}, on {}.", finding.name))
    };
    let section = Section::new("Channels of a run").prose(
        "The first run on each ground; the drawings of all runs are in the folder figures beside this page.",
    );
    findings.iter().map(figure).fold(section, Section::figure)
}

fn next_steps(findings: &[Finding]) -> Section {
    let last = &findings[findings.len() - 1];
    let scenario = quoted(&last.scenario_file);
    let file = quoted(&last.run_file);
    let row = |what: &str, command: String| vec![Cell::text(what), Cell::Code(command)];
    let columns = ["to", "command"].map(|name| Column::new(name, ""));
    Section::new("Next steps")
        .answer("Change a scenario and simulate again.")
        .prose(
            "A scenario is a text file with units in its comments; every key can also be set on the \
             command line. The run files are HDF5, which Python and MATLAB read.",
        )
        .table(Table {
            caption: "Commands to begin with".to_owned(),
            columns: columns.to_vec(),
            rows: vec![
                row(
                    "see more slip",
                    format!("lugwheel simulate {scenario} --set rig.single_wheel.slip=0.3"),
                ),
                row(
                    "have more data",
                    format!("lugwheel dataset {scenario} --runs 50 --out more.h5"),
                ),
                row("know what is in a file", format!("lugwheel inspect {file}")),
                row(
                    "see another run",
                    format!("lugwheel plot {file} --run run_000001"),
                ),
                row("recognise classes", format!("lugwheel recognize {file}")),
                row(
                    "sweep a key",
                    "lugwheel study sweep_slip".to_owned(),
                ),
                row(
                    "draw a sweep for a paper",
                    "lugwheel plot output/sweep_slip --format pdf --width 88mm".to_owned(),
                ),
                row("know all commands", "lugwheel --help".to_owned()),
            ],
        })
}

fn provenance(results: &Results) -> page::Provenance {
    let Results {
        findings,
        loads,
        seed,
        ..
    } = *results;
    let files = findings.iter().map(|finding| {
        let scenario = quoted(&finding.scenario_file);
        let runs = quoted(&finding.run_file);
        format!("lugwheel dataset {scenario} --runs {RUNS} --seed {seed} --out {runs}")
    });
    let again = format!(
        "lugwheel demo --seed {seed} --out {}",
        quoted(results.folder)
    );
    let reference = quoted(&findings[0].run_file);
    let recognize = findings[1..].iter().map(|finding| {
        let runs = quoted(&finding.run_file);
        format!("lugwheel recognize {runs} --reference {reference} --window {WINDOW}")
    });
    let (rig, diagnosis, _) = results.rig;
    let studies = [loads, rig].map(|study| {
        let [file, folder] = [&study.file, &study.folder].map(|path| quoted(path));
        format!("lugwheel study {file} --out {folder} --resume")
    });
    let rate = |finding: &Finding| {
        let rate = finding.scenario.physics_rate().hertz() / 1e3;
        format!("{} {rate} kHz", finding.name)
    };
    let rates: Vec<String> = findings.iter().map(rate).collect();
    let ours = [
        ("seed", seed.to_string()),
        (
            "scenarios",
            format!(
                "the ready ones of the single wheel, with {}",
                EDITS.join(" and ")
            ),
        ),
        ("integration rate", rates.join(", ")),
        ("computing", format!("{:.0} s", results.computing_s)),
    ];
    let ours = ours.map(|(name, value)| (name.to_owned(), value));
    page::Provenance {
        facts: provenance::facts().into_iter().chain(ours).collect(),
        commands: std::iter::once(again)
            .chain(files)
            .chain(recognize)
            .chain(studies)
            .chain([diagnosis.command(diagnosis.budget)])
            .collect(),
        ..page::Provenance::default()
    }
}

/// A quantity on each ground, in a sentence that begins with `what`.
fn spread_of(findings: &[Finding], key: &str, what: &str) -> String {
    let values = findings.iter().filter_map(|finding| {
        let (quantity, spread) = spread(finding, key)?;
        let (mean, unit) = (quantity.shown(spread.mean), quantity.shown_unit);
        Some(format!("{mean} {unit} on {}", finding.name))
    });
    format!("{what}: {}.", values.collect::<Vec<_>>().join(", "))
}

fn spread(finding: &Finding, key: &str) -> Option<(&'static Quantity, Spread)> {
    spreads(&finding.outcomes).find(|(quantity, _)| quantity.key == key)
}

fn range(quantity: &Quantity, spread: &Spread) -> String {
    let [mean, min, max] = [spread.mean, spread.min, spread.max].map(|value| quantity.shown(value));
    format!("{mean} [{min}, {max}]")
}
