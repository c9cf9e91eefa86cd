//! `demo`: labelled data on several grounds, classes recognised, parameters identified, a gap
//! diagnosed, one report.

mod gap;
mod identification;
mod recognition;
mod small_study;
mod story;

use super::dataset::classes;
use super::diagnose::RESULTS;
use super::interrupt::Interrupted;
use super::output::{self, Output};
use super::progress::Progress;
use super::series::{Jobs, Outcome, Series, spreads, write_all};
use super::steady::{QUANTITIES, Spread};
use super::target::Claim;
use crate::dataset::hdf5::RunFile;
use crate::dataset::inspection::{Inspection, inspect};
use crate::learning::run_id;
use crate::quantity::Seed;
use crate::report::{page, trace_figure};
use crate::scenario::Scenario;
use crate::table::{Cell, Column, Table};
use crate::trace::Trace;
use clap::Args;
use recognition::Recognition;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use story::Results;

/// Demonstrate the main commands on small scenarios, in a report that opens in a browser
///
/// Simulates the paper's single wheel on several grounds, writes labelled run files, checks and draws
/// them, recognises the interaction class, identifies the parameters of the sand, diagnoses an effect of a
/// rig that its scenario lacks, and reports in one HTML page. It takes less than three minutes.
#[derive(Debug, Args)]
pub struct Demo {
    /// Folder for run files, scenarios, figures and the report
    #[arg(long, default_value = "output/demo", value_name = "DIR")]
    out: PathBuf,
    /// Seed of the random numbers; the same seed gives the same bytes
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,
    #[command(flatten)]
    jobs: Jobs,
}

/// A ground of the demo.
struct Ground {
    /// Name of its files, and of its scenario behind `single_wheel_`.
    key: &'static str,
    /// What it is called.
    name: &'static str,
}

/// The grounds, in the order of the report.
const GROUNDS: [Ground; 4] = [
    Ground {
        key: "ref",
        name: "flat hard ground",
    },
    Ground {
        key: "ht",
        name: "slate",
    },
    Ground {
        key: "gt",
        name: "gravel",
    },
    Ground {
        key: "st",
        name: "sand",
    },
];

/// What is changed in the scenarios: two windows at the paper's highest speed, after the start.
const EDITS: [&str; 4] = [
    "duration=16.0",
    "window=8.0",
    "lead_in=2.0",
    "rig.single_wheel.forward_speed=0.02",
];

/// Runs on each ground.
const RUNS: u64 = 3;

/// Shares of the progress bar that the stages fill, by their usual times on two cores.
const GROUND_RUNS: [f64; 2] = [0.0, 0.26];
const IDENTIFICATION: [f64; 2] = [0.27, 0.42];
const RIG: [f64; 2] = [0.42, 0.44];
const DIAGNOSIS: [f64; 2] = [0.44, 1.0];

/// What was found on one ground.
struct Finding {
    name: &'static str,
    scenario_file: PathBuf,
    run_file: PathBuf,
    scenario: Scenario,
    outcomes: Vec<Outcome>,
    inspection: Inspection,
    /// The first run: its id, trace and figure.
    first: (String, Trace, String),
}

/// What marks a folder as a demo's, whose files the next demo may make again.
const ORIGIN: &str = "lugwheel demo\n";

/// Names of the files that a demo writes, those of its studies aside.
fn results() -> Vec<String> {
    let own = [
        "origin.txt",
        "report.html",
        "sand.toml",
        "identification.toml",
        "known.toml",
        "rig.toml",
        "gap.toml",
    ];
    let mut names: Vec<String> = own.map(str::to_owned).into();
    for Ground { key, .. } in &GROUNDS {
        names.extend(["h5", "toml"].map(|ending| format!("{key}.{ending}")));
        names.extend((0..RUNS).map(|run| figure_name(key, &run_id(run))));
    }
    names.extend(RESULTS.map(|name| format!("diagnosis/{name}")));
    names
}

/// The figure of a run on a ground.
fn figure_name(ground: &str, run: &str) -> String {
    format!("figures/{ground}_{run}.svg")
}

impl Demo {
    /// Runs the demo.
    pub fn run(&self, output: &Output) -> anyhow::Result<()> {
        self.claim(output)?;
        let scenarios = GROUNDS
            .iter()
            .map(|ground| Scenario::ready(small_study::shipped(ground.key))?.with_all(&EDITS))
            .collect::<Result<Vec<_>, _>>()?;
        let loads = identification::loads(&self.out, self.seed)?;
        let rig = gap::rig(&self.out, self.seed)?;
        let begun = Instant::now();
        let progress = Progress::of_stages(output, "demo");
        let (findings, recognition) = self
            .recognized(scenarios, &progress)
            .map_err(|error| self.named(error))?;
        progress.begin("identification", IDENTIFICATION, loads.simulated());
        let identified = identification::identify(&loads, self.jobs, &progress)
            .map_err(|error| self.named(error))?;
        progress.begin("runs of a rig", RIG, rig.simulated());
        rig.execute(self.jobs, &progress)
            .map_err(|error| self.named(error))?;
        progress.begin("diagnosis", DIAGNOSIS, 0.0);
        let diagnosis = gap::diagnosis(&rig, &self.out, self.seed, self.jobs);
        let diagnosed = diagnosis
            .investigate(&progress)
            .map_err(|error| self.named(error))?;
        drop(progress);
        let computing_s = begun.elapsed().as_secs_f64();
        let report = self.out.join("report.html");
        let page_of_results = story::story(&Results {
            findings: &findings,
            recognition: &recognition,
            identified: &identified,
            loads: &loads,
            rig: (&rig, &diagnosis, &diagnosed),
            folder: &self.out,
            seed: self.seed,
            computing_s,
        });
        output::write_file(&report, page(&page_of_results))?;
        output.print(&Summary {
            seed: self.seed,
            runs_per_ground: RUNS,
            computing_s,
            grounds: findings.iter().map(GroundSummary::of).collect(),
            recognition: recognition.answer(),
            identification: identified.answer(),
            diagnosis: diagnosed.answer.clone(),
            report: report.display().to_string(),
        })
    }

    /// Claims the folder, which an earlier demo may have made, and marks it as a demo's.
    fn claim(&self, output: &Output) -> anyhow::Result<()> {
        let mark = self.out.join("origin.txt");
        let is_own = fs::read_to_string(&mark).is_ok_and(|origin| origin == ORIGIN);
        let claim = Claim {
            force: is_own || output.force,
            ..output.claim(&[])
        };
        claim.folder(&self.out)?;
        claim.files_in(&self.out, results())?;
        output::write_file(&mark, ORIGIN)?;
        output::make_folder(&self.out.join("figures"))
    }

    /// Simulates the runs on all grounds and recognises their classes.
    fn recognized(
        &self,
        scenarios: Vec<Scenario>,
        progress: &Progress,
    ) -> anyhow::Result<(Vec<Finding>, Recognition)> {
        let simulated = scenarios.iter().map(|it| it.driven() * RUNS as f64);
        progress.begin("runs on four grounds", GROUND_RUNS, simulated.sum());
        let findings = self.explore(scenarios, progress)?;
        let recognition = recognition::recognize(&findings)?;
        Ok((findings, recognition))
    }

    /// Simulates the runs on all grounds, reads them back, checks and draws them.
    fn explore(
        &self,
        scenarios: Vec<Scenario>,
        progress: &Progress,
    ) -> anyhow::Result<Vec<Finding>> {
        let series = scenarios.iter().map(|scenario| Series {
            scenario,
            seed: Seed(self.seed),
            runs: (0..RUNS).collect(),
            jobs: self.jobs,
        });
        let series: Vec<Series> = series.collect();
        let files = GROUNDS.iter().map(|ground| self.file(ground, "h5"));
        let files: Vec<PathBuf> = files.collect();
        let outcomes = write_all(&series, &files, self.jobs, progress)?;
        let grounds = GROUNDS.iter().zip(scenarios).zip(outcomes);
        grounds
            .map(|((ground, scenario), outcomes)| self.find(ground, scenario, outcomes))
            .collect()
    }

    /// A file of a ground.
    fn file(&self, ground: &Ground, ending: &str) -> PathBuf {
        self.out.join(format!("{}.{ending}", ground.key))
    }

    /// Reads the runs on one ground back, checks and draws them.
    fn find(
        &self,
        ground: &Ground,
        scenario: Scenario,
        outcomes: Vec<Outcome>,
    ) -> anyhow::Result<Finding> {
        let [scenario_file, run_file] = ["toml", "h5"].map(|ending| self.file(ground, ending));
        output::write_file(&scenario_file, scenario.text())?;
        let file = RunFile::open(&run_file)?;
        let first = self.draw(ground, &file)?;
        Ok(Finding {
            name: ground.name,
            inspection: inspect(&file),
            scenario_file,
            run_file,
            scenario,
            outcomes,
            first,
        })
    }

    /// Draws every run into the folder of figures; the first one with its id and its drawing.
    fn draw(&self, ground: &Ground, file: &RunFile) -> anyhow::Result<(String, Trace, String)> {
        let mut first = None;
        for id in file.runs() {
            let trace = file.read(id)?;
            let svg = trace_figure(&trace, id)?;
            let name = figure_name(ground.key, id);
            output::write_file(&self.out.join(name), &svg)?;
            first.get_or_insert((id.clone(), trace, svg));
        }
        first.ok_or_else(|| anyhow::anyhow!("{} has no runs", file.path().display()))
    }

    /// An interruption, with what it leaves behind here.
    fn named(&self, error: anyhow::Error) -> anyhow::Error {
        if !error.is::<Interrupted>() {
            return error;
        }
        let folder = self.out.display();
        Interrupted(format!(
            "no report was written, the run files in {folder} are whole"
        ))
        .into()
    }
}

/// What the demo found, for machines.
#[derive(Debug, Serialize)]
struct Summary {
    seed: u64,
    runs_per_ground: u64,
    computing_s: f64,
    grounds: Vec<GroundSummary>,
    recognition: String,
    identification: Option<String>,
    diagnosis: String,
    report: String,
}

#[derive(Debug, Serialize)]
struct GroundSummary {
    ground: &'static str,
    scenario: String,
    file: String,
    classes: BTreeMap<&'static str, usize>,
    findings: usize,
    steady: BTreeMap<&'static str, Spread>,
}

impl GroundSummary {
    fn of(finding: &Finding) -> Self {
        let shown = |path: &Path| path.display().to_string();
        let steady = spreads(&finding.outcomes);
        Self {
            ground: finding.name,
            scenario: shown(&finding.scenario_file),
            file: shown(&finding.run_file),
            classes: classes(&finding.outcomes),
            findings: finding.inspection.findings.len(),
            steady: steady
                .map(|(quantity, spread)| (quantity.key, spread))
                .collect(),
        }
    }
}

impl Summary {
    /// A column a ground.
    fn table(&self) -> Table {
        let row = |name: &str, unit: &str, of: &dyn Fn(&GroundSummary) -> String| {
            let values = self.grounds.iter().map(|ground| Cell::Text(of(ground)));
            let first = [name, unit].map(Cell::text).into_iter();
            first.chain(values).collect::<Vec<_>>()
        };
        let classes = row("true class of the runs", "", &|ground| {
            let counts = ground.classes.iter().map(|(c, n)| format!("{n} {c}"));
            counts.collect::<Vec<_>>().join(", ")
        });
        let quantities = QUANTITIES.iter().map(|quantity| {
            row(quantity.name, quantity.shown_unit, &|ground| {
                let spread = ground.steady.get(quantity.key);
                spread.map_or("-".to_owned(), |s| quantity.shown(s.mean))
            })
        });
        let findings = row("findings of inspect", "", &|it| it.findings.to_string());
        let names = self.grounds.iter().map(|ground| ground.ground);
        Table {
            columns: Column::named(["", ""].into_iter().chain(names)),
            rows: [classes]
                .into_iter()
                .chain(quantities)
                .chain([findings])
                .collect(),
            ..Table::default()
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} runs on each ground, seed {}, in {:.0} s; means of the steady state\n",
            self.runs_per_ground, self.seed, self.computing_s
        )?;
        f.write_str(&self.table().to_text(0))?;
        writeln!(
            f,
            "sinkage below 0: the rim is above the surface, the wheel stands on its lugs"
        )?;
        write!(f, "\n{}", self.recognition)?;
        if let Some(identification) = &self.identification {
            write!(f, "\n{identification}")?;
        }
        write!(f, "\n{}", self.diagnosis)?;
        write!(f, "\n\n{}", self.report)
    }
}
