//! The figures of a study, and its page.

use super::{Format, Plot};
use crate::cli::output::{self, Output};
use crate::report::{MethodParts, SweptKey, sweep_figure};
use crate::study::conditions::varied;
use crate::study::results::{Results, tables};
use anyhow::{Context, bail, ensure};
use serde::Serialize;
use std::fmt;
use std::fs;
use std::path::PathBuf;

/// Name of the page of a study in its folder.
const REPORT: &str = "report.html";

/// What was drawn.
#[derive(Debug, Serialize)]
struct DrawnStudy {
    folder: String,
    figures: Vec<DrawnKey>,
}

/// A figure, and the swept key that it belongs to; none for the page.
#[derive(Debug, Serialize)]
struct DrawnKey {
    #[serde(skip_serializing_if = "Option::is_none")]
    key: Option<String>,
    figure: String,
}

impl Plot {
    /// Draws the results of the study in the folder over its swept keys, or passes its page on.
    pub(super) fn draw_study(&self, format: Format, output: &Output) -> anyhow::Result<()> {
        ensure!(
            self.run.is_none(),
            "--run is for run files; a study is drawn over its swept keys (--over)"
        );
        let figures = match format {
            Format::Mcap => bail!(
                "MCAP files contain one run; draw a study as svg, png, pdf or html, or a run of its dataset.h5 as mcap"
            ),
            Format::Html => vec![self.page_of_study(output)?],
            _ => self.figures_of_study(format, output)?,
        };
        output.print(&DrawnStudy {
            folder: self.file.display().to_string(),
            figures,
        })
    }

    /// The page in the folder, copied to where it is asked for.
    fn page_of_study(&self, output: &Output) -> anyhow::Result<DrawnKey> {
        ensure!(
            self.over.is_none(),
            "--over is for figures; the page of a study shows every swept key"
        );
        Results::read(&self.file)?;
        let page = self.file.join(REPORT);
        let missing = || {
            let folder = self.file.display();
            format!(
                "{folder} has no {REPORT}; `lugwheel study ... --out {folder} --resume` writes it"
            )
        };
        ensure!(page.is_file(), missing());
        if let Some(out) = &self.out {
            output.claim(&[&page]).file(out)?;
            output::write_file(out, fs::read(&page).with_context(missing)?)?;
        }
        Ok(DrawnKey {
            key: None,
            figure: self.out.as_ref().unwrap_or(&page).display().to_string(),
        })
    }

    fn figures_of_study(&self, format: Format, output: &Output) -> anyhow::Result<Vec<DrawnKey>> {
        let results = Results::read(&self.file)?;
        let keys = self.keys(&results)?;
        let targets = keys.iter().map(|key| match &self.out {
            Some(out) => out.clone(),
            None => self.file.join(format!("over_{key}.{}", format.ending())),
        });
        let targets: Vec<PathBuf> = targets.collect();
        let tables = tables(&self.file);
        let tables = tables.each_ref().map(PathBuf::as_path);
        for target in &targets {
            output.claim(&tables).file(target)?;
        }
        let mut figures = Vec::new();
        for (key, target) in keys.iter().zip(targets) {
            let svg = sweep_figure(&swept(&results, key), self.layout());
            output::write_file(&target, format.image(svg)?)?;
            figures.push(DrawnKey {
                key: Some((*key).to_owned()),
                figure: target.display().to_string(),
            });
        }
        Ok(figures)
    }

    /// The swept keys to draw over.
    fn keys<'r>(&self, results: &'r Results) -> anyhow::Result<Vec<&'r str>> {
        let swept = varied(results.keys.iter().map(String::as_str), &results.conditions);
        let folder = self.file.display();
        ensure!(
            !swept.is_empty(),
            "the study in {folder} sweeps no key over two values or more; its results are in {}",
            self.file.join(REPORT).display()
        );
        let Some(asked) = &self.over else {
            ensure!(
                swept.len() == 1 || self.out.is_none(),
                "the study in {folder} sweeps {}; choose one of them with --over KEY, or leave --out away for a \
                 figure of each in the folder",
                swept.join(", ")
            );
            return Ok(swept);
        };
        let is_asked = |key: &&&str| **key == asked || key.ends_with(&format!(".{asked}"));
        let found: Vec<&str> = swept.iter().filter(is_asked).copied().collect();
        ensure!(
            found.len() == 1,
            "the study in {folder} sweeps {}; --over {asked} names {} of them",
            swept.join(", "),
            if found.is_empty() { "none" } else { "several" }
        );
        Ok(found)
    }
}

fn swept<'r>(results: &'r Results, key: &'r str) -> SweptKey<'r> {
    let methods = results.recognition.iter().map(|of| MethodParts {
        method: &of.method,
        parts: of.map.iter().filter(|part| part.by == key).collect(),
    });
    SweptKey {
        key,
        keys: results.keys.iter().map(String::as_str).collect(),
        conditions: &results.conditions,
        methods: methods.collect(),
    }
}

impl fmt::Display for DrawnStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for DrawnKey { figure, .. } in &self.figures {
            writeln!(f, "{figure}")?;
        }
        Ok(())
    }
}
