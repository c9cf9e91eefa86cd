//! The datasheet of a data set, by the questions of Gebru et al. (2021), *Datasheets for Datasets*,
//! Communications of the ACM 64(12).

use super::balance::OfPart;
use super::splits::{GROUPINGS, Part};
use super::{DataSet, FileFact, Kept, run_fields};
use crate::recognition::confusion::CLASSES;
use std::collections::{BTreeMap, BTreeSet};

impl DataSet {
    /// The datasheet as Markdown.
    pub(super) fn datasheet(&self, file: &FileFact) -> String {
        [
            self.title(file),
            self.composition(),
            self.balance(),
            self.split_text(),
            self.process(file),
        ]
        .concat()
    }

    fn title(&self, file: &FileFact) -> String {
        let FileFact {
            name,
            bytes,
            sha256,
        } = file;
        format!(
            "# Datasheet: {name}\n\n\
             After Gebru et al. (2021), Datasheets for Datasets. {bytes} bytes, SHA-256 {sha256}.\n\n\
             ## Motivation\n\n\
             **For what purpose?** To learn and to compare how the interaction class of a lugged wheel and \
             its terrain (all lugs touch, ALCT; some do, SLCT; lugs enter soil, LEIS) shows in vibration and \
             loads, with the truth of every window known.\n\n\
             **Who made it?** The simulator {}, by\n\n```sh\n{}\n```\n\n",
            self.facts.created_by, self.facts.command
        )
    }

    fn composition(&self) -> String {
        let conditions: BTreeSet<u64> = self.members.iter().map(|m| m.condition).collect();
        let streams: BTreeSet<u64> = self.members.iter().map(|m| m.stream).collect();
        let scenarios: BTreeSet<&str> = self.windows.column("scenario").collect();
        let scenarios = scenarios.into_iter().collect::<Vec<_>>().join(", ");
        let names = self.windows.fields.iter().map(|field| field.name.as_str());
        let from_swept = names.skip(run_fields(Vec::new()).len());
        let swept: Vec<&str> = from_swept.take_while(|name| *name != "start_s").collect();
        let swept = if swept.is_empty() {
            "nothing".to_owned()
        } else {
            swept.join(", ")
        };
        format!(
            "## Composition\n\n\
             **What is an instance?** A window of a run of a wheel; {} windows of {} runs under {} conditions \
             (scenarios {scenarios}; swept: {swept}), on {} grounds (streams of random numbers).\n\n\
             **What does it consist of?** {}\n\n\
             **Is there a label?** The class of every window, determined from the contacts of each lug \
             (`truth/class_windows`), and the label of its ground. The two may disagree: a stone may carry \
             all lugs for a while.\n\n\
             **Is anything missing?** {} runs failed and are left out. Features are empty where a window does \
             not reveal them.\n\n\
             **Are there errors, noise, redundancies?** Noise and errors are those of the scenarios' sensors. \
             Windows of a run, runs of a stream and runs of a condition are alike: see the splits.\n\n\
             **Is it self-contained? Confidential? About people?** Self-contained, nothing confidential, no \
             people.\n\n",
            self.windows.rows.len(),
            self.members.len(),
            conditions.len(),
            streams.len(),
            self.contents(),
            self.facts.failed,
        )
    }

    fn contents(&self) -> String {
        let features = "`windows.csv` has a row a window: the four features of the paper as logarithms \
                        (`p1` to `p4`) over the computed reference, and the power of the vertical \
                        acceleration in twelve bands.";
        if self.facts.kept == Kept::Features {
            return format!("Features only: {features} The `.h5` file is the same table, typed.");
        }
        let channels = self.facts.channels.iter().map(|channel| {
            format!(
                "`{}` [{}] at {} Hz",
                channel.name, channel.unit, channel.sample_rate
            )
        });
        let channels = channels.collect::<Vec<_>>().join(", ");
        format!("Channels {channels}; contacts of every lug, the ground's profile. {features}")
    }

    /// Windows of every class and part, and the weight that would make classes equal.
    fn balance(&self) -> String {
        let mut text = "**How are classes balanced?** Windows by class; the weight makes every class count alike.\n\n\
                        | class | windows | share | weight |\n|---|---|---|---|\n"
            .to_owned();
        let counts = self.by_class();
        let all: usize = counts.iter().sum();
        let classes = counts.iter().filter(|count| **count > 0).count();
        for (class, &count) in CLASSES.iter().zip(&counts).filter(|(_, count)| **count > 0) {
            let class = class.as_str();
            let share = 100.0 * count as f64 / all as f64;
            let weight = all as f64 / (classes * count) as f64;
            text.push_str(&format!(
                "| {class} | {count} | {share:.1} % | {weight:.2} |\n"
            ));
        }
        text.push_str("\n| ground | windows |\n|---|---|\n");
        for (terrain, count) in self.count("terrain") {
            text.push_str(&format!("| {terrain} | {count} |\n"));
        }
        text + "\n"
    }

    fn split_text(&self) -> String {
        let mut text = "**Are there recommended splits?** Four, in `splits.csv` and in columns of \
                        `windows.csv`; none of them has what it groups by in two parts. Ask \
                        of a model what its split requires: other stretches (`by_run`), new ground and noise \
                        (`by_ground`), new conditions (`by_condition`), both at once (`by_both`). \
                        Windows by class in each part:\n\n\
                        | split | part | runs | ALCT | SLCT | LEIS | UWTIC |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
        let parts = self.by_part();
        for split in GROUPINGS {
            let own = parts.iter().filter(|of| of.split == split);
            let rows: String = own.map(part_row).collect();
            text.push_str(&if rows.is_empty() {
                format!("| {} | too few groups | | | | | |\n", split.column())
            } else {
                rows
            });
        }
        text + "\n"
    }

    /// Windows by the cell of a column.
    fn count(&self, column: &str) -> BTreeMap<&str, usize> {
        let mut counts = BTreeMap::new();
        for cell in self.windows.column(column).filter(|cell| !cell.is_empty()) {
            *counts.entry(cell).or_default() += 1;
        }
        counts
    }

    fn process(&self, file: &FileFact) -> String {
        let seed = self.facts.seed.0;
        let name = &file.name;
        format!(
            "## Collection process\n\n\
             **How was it acquired?** Simulated: rigid bodies, Bekker-Wong soil, loose stones; sampled at \
             128 kHz and down-sampled as a test rig would. All random numbers come from seed {seed}, the \
             run's stream and the name of their stage; a run is the same bits alone. A data set of the same \
             seed shares its streams: it is no test set for this one.\n\n\
             **Over what time, by whom, with whose consent?** A simulation has none of these.\n\n\
             ## Preprocessing, cleaning, labelling\n\n\
             **Was any done?** Anti-alias filters and sensors as the scenarios state; labels as above; windows \
             and features by the program's defaults. Nothing was selected by its outcome.\n\n\
             **Is the raw data saved?** Where the scenario has `sensors.raw = true` (`--raw`), as channels \
             `<name>_raw`.\n\n\
             ## Uses\n\n\
             **For what could it be used?** Classes of interaction, terrain parameters, slip and sinkage, \
             transfer from simulation to a rig.\n\n\
             **What should it not be used for?** To claim how a recogniser does on a real rover: grounds are \
             planar but for their stones, contacts of stones are guesses, and many rig values are guesses marked in the \
             scenarios.\n\n\
             ## Distribution and maintenance\n\n\
             **Under what licence?** That of the program, MIT, unless published under another. \
             Fill in `url` and `datePublished` of the Croissant file when you do.\n\n\
             **Who maintains it?** Whoever keeps `{name}`; the command above makes it again, byte by byte with \
             the same program and libraries.\n"
        )
    }
}

fn part_row(of: &OfPart) -> String {
    let part = of.part.map_or("in none", Part::as_str);
    let windows = of.windows.map(|count| count.to_string()).join(" | ");
    format!(
        "| {} | {part} | {} | {windows} |\n",
        of.split.column(),
        of.runs
    )
}
