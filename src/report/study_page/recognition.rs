//! How well classes were recognised.

use super::{Drawing, Shown};
use crate::recognition::confusion::{CLASSES, Confusion};
use crate::report::figure::Layout;
use crate::report::page::{Cell, Figure, Section, Table};
use crate::report::sweep_figure::unit_behind_number;
use crate::report::{
    FeaturePoint, Group, MethodParts, SweptKey, confusion_figure, feature_planes, feature_values,
    sweep_figure,
};
use crate::statistics::Share;
use crate::study::score::features::{FeatureSpread, FeaturesOfScenario, Slope};
use crate::study::score::{Against, Counted, MethodScore, Part, RecognitionScore};

impl Shown for RecognitionScore {
    fn stem(&self) -> Option<&'static str> {
        Some("recognition")
    }

    /// How many answers were right, method by method, beside those published.
    fn answer(&self) -> String {
        let right = |name: &str, counted: &Counted| {
            counted
                .accuracy
                .map(|share| format!("{name} {}", right_answers(&counted.confusion, &share)))
        };
        let labelled = self.scores.iter().filter(|s| s.against == Against::Label);
        let methods = labelled.filter_map(|s| right(&s.method, &s.all));
        let published = self.published.iter();
        let published = published.filter_map(|counted| right("published", counted));
        let shares: Vec<String> = methods.chain(published).collect();
        if shares.is_empty() {
            return "No ground stands for one class.".to_owned();
        }
        format!(
            "Windows recognised as the class of their ground: {}.",
            shares.join("; ")
        )
    }

    /// Scores, their map, and the features behind them.
    fn sections(&self) -> Vec<Section> {
        let mut sections = vec![methods(self), map(self)];
        sections.extend(features(self));
        sections
    }

    /// The features by ground, their planes, and what each method answered.
    fn drawings(&self) -> Vec<Drawing> {
        let points = points(self);
        let mut drawings = Vec::new();
        if !points.is_empty() {
            drawings.push(Drawing::new("feature_values.svg", feature_values(&points)));
            let planes = self.lugs.map(|lugs| feature_planes(&points, lugs));
            drawings.extend(planes.map(|svg| Drawing::new("feature_planes.svg", svg)));
        }
        drawings.extend(of_label(self).map(|MethodScore { method, all, .. }| {
            let figure = answers_and_truth(method, &all.confusion);
            Drawing::new(format!("confusion_{method}.svg"), figure)
        }));
        drawings
    }
}

fn right_answers(confusion: &Confusion, share: &Share) -> String {
    let [value, low, high] = share.percent();
    format!(
        "{} of {}, {value:.1} % [{low:.1}, {high:.1}]",
        confusion.correct(),
        share.n
    )
}

fn methods(score: &RecognitionScore) -> Section {
    let section = Section::new("Accuracy of the recognition")
        .prose(
            "Answers are compared with the class of the ground, as in the paper; with the true class by the \
             contacts of lugs and ground; and on the windows in which both agree. Shares have Wilson's 95 % \
             interval, which assumes independent windows.",
        );
    let labelled: Vec<&MethodScore> = of_label(score).collect();
    let is_baseline = |score: &&MethodScore| score.method.starts_with("baseline");
    let section = if labelled.iter().any(is_baseline) {
        section.prose(
            "paper and improved need no training data. The baselines are support vector machines on band powers: \
             baseline_new is trained on the other values of the swept key, baseline_known on the other repeats of \
             the same values.",
        )
    } else {
        section
    };
    let section = section.table(totals(score));
    let section = section.table(confusions(score));
    let figures = labelled.iter().map(|score| {
        Figure::new(
            answers_and_truth(&score.method, &score.all.confusion),
            format!(
                "Confusion matrix of {} with respect to the class of the ground.",
                score.method
            ),
        )
    });
    figures.fold(section, Section::figure)
}

/// The confusion matrix of a method, drawn.
pub fn answers_and_truth(method: &str, confusion: &Confusion) -> String {
    confusion_figure(confusion, &format!("{method}: classes answered"))
}

fn of_label(score: &RecognitionScore) -> impl Iterator<Item = &MethodScore> {
    let scores = score.scores.iter();
    scores.filter(|score| score.against == Against::Label)
}

/// The methods by the class that they are compared with, and the published counts.
fn sides(score: &RecognitionScore) -> impl Iterator<Item = (&str, &'static str, &Counted)> {
    let methods = score.scores.iter().map(|score| {
        let reference = match score.against {
            Against::Label => OF_GROUND,
            Against::Truth => "class by the contacts",
            Against::Agreed => "both, where they agree",
        };
        (score.method.as_str(), reference, &score.all)
    });
    let published = score.published.iter();
    methods.chain(published.map(|counted| ("published", OF_GROUND, counted)))
}

const OF_GROUND: &str = "class of the ground";

fn totals(score: &RecognitionScore) -> Table {
    let rows = sides(score).map(|(method, reference, counted)| {
        vec![
            Cell::text(method),
            Cell::text(reference),
            Cell::Count(counted.confusion.total()),
            Cell::Count(counted.confusion.correct()),
            Cell::from(counted.accuracy.as_ref()),
            Cell::Count(counted.confused),
        ]
    });
    let names = ["method", "reference", "windows", "right", "share"];
    let names = names
        .into_iter()
        .chain(["confused with another known class"]);
    Table::of(names, rows).captioned("Accuracy of every method")
}

/// A row for every true class that occurs.
fn confusions(score: &RecognitionScore) -> Table {
    let rows = sides(score).flat_map(|(method, reference, counted)| {
        let classes = CLASSES.iter().zip(counted.confusion.counts);
        classes.filter_map(move |(class, counts)| {
            let recall = counted.recalls.get(class)?;
            let first = [method, reference, class.as_str()].map(Cell::text);
            let row = first.into_iter().chain(counts.map(Cell::Count));
            Some(row.chain([Cell::share(recall)]).collect())
        })
    });
    let names = ["method", "reference", "true class"].into_iter();
    let names = names.chain(CLASSES.map(|class| class.as_str()));
    Table::of(names.chain(["recall"]), rows)
        .captioned("Confusion matrices: windows by true class and answer")
}

fn map(score: &RecognitionScore) -> Section {
    let methods: Vec<&MethodScore> = of_label(score).collect();
    let rows = methods.first().map_or(&[][..], |first| &first.map);
    let row = |(number, part): (usize, &Part)| {
        let n = part.counted.accuracy.map_or(0, |share| share.n);
        let mut cells = vec![
            Cell::text(&part.by),
            Cell::toml(&part.value),
            Cell::Count(n),
        ];
        let shares = methods.iter().map(|method| &method.map[number].counted);
        cells.extend(shares.map(|counted| Cell::from(counted.accuracy.as_ref())));
        cells
    };
    let names = methods.iter().map(|score| score.method.as_str());
    let section = Section::new("Accuracy by scenario and swept key");
    let names = ["by", "value", "windows"].into_iter().chain(names);
    let table = Table::of(names, rows.iter().enumerate().map(row))
        .captioned("Accuracy by scenario and by swept key with respect to the class of the ground");
    let keys = swept_keys(&methods);
    let section = match range_over_keys(&methods, &keys) {
        Some(answer) => section.answer(answer),
        None => section,
    };
    let figures = keys.iter().map(|key| over_key(&methods, key));
    let tables = [table].into_iter().chain(recalls(&methods));
    tables.fold(figures.fold(section, Section::figure), Section::table)
}

/// The classes of every swept value, where it has several.
fn recalls(methods: &[&MethodScore]) -> Option<Table> {
    let parts = methods.first()?.map.iter().enumerate();
    let swept = parts.filter(|(_, part)| part.by != "scenario" && part.counted.recalls.len() > 1);
    let rows = swept.flat_map(|(number, part)| {
        let recalls = part.counted.recalls.iter();
        recalls.map(move |(class, share)| {
            let mut cells = vec![
                Cell::text(&part.by),
                Cell::toml(&part.value),
                Cell::text(class.as_str()),
                Cell::Count(share.n),
            ];
            let shares = methods
                .iter()
                .map(|method| method.map[number].counted.recalls.get(class));
            cells.extend(shares.map(Cell::from));
            cells
        })
    });
    let rows: Vec<Vec<Cell>> = rows.collect();
    let names = methods.iter().map(|score| score.method.as_str());
    let names = ["by", "value", "true class", "windows"]
        .into_iter()
        .chain(names);
    (!rows.is_empty())
        .then(|| Table::of(names, rows).captioned("Recall of every class by swept key"))
}

/// From where to where the accuracy of each method goes over the swept keys.
fn range_over_keys(methods: &[&MethodScore], keys: &[&str]) -> Option<String> {
    let range = |score: &MethodScore, key: &str| {
        let parts = score.map.iter().filter(|part| part.by == key);
        let shares = parts.filter_map(|part| Some((part.counted.accuracy?.value, &part.value)));
        let mut shares: Vec<(f64, &String)> = shares.collect();
        shares.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, most) = (shares.first()?, shares.last()?);
        let unit = unit_behind_number(key);
        let at = |(share, value): &(f64, &String)| {
            let value = Cell::toml(value).written();
            format!("{:.1} % at {key} = {value}{unit}", 100.0 * share)
        };
        let method = &score.method;
        Some(if least.0 == most.0 {
            format!("{method} {:.1} % at every {key}", 100.0 * least.0)
        } else {
            format!("{method} from {} to {}", at(least), at(most))
        })
    };
    let ranges = keys
        .iter()
        .flat_map(|key| methods.iter().map(move |score| range(score, key)));
    let ranges: Vec<String> = ranges.flatten().collect();
    (!ranges.is_empty()).then(|| format!("Accuracy: {}.", ranges.join("; ")))
}

/// Keys swept over two values or more.
fn swept_keys<'s>(methods: &[&'s MethodScore]) -> Vec<&'s str> {
    let mut keys: Vec<&str> = Vec::new();
    let parts = methods.first().map_or(&[][..], |first| &first.map);
    for part in parts.iter().filter(|part| part.by != "scenario") {
        if !keys.contains(&part.by.as_str()) {
            keys.push(&part.by);
        }
    }
    let of_key =
        |score: &MethodScore, key: &str| score.map.iter().filter(|it| it.by == key).count();
    keys.retain(|key| methods.first().is_some_and(|first| of_key(first, key) > 1));
    keys
}

/// The figure of a swept key.
fn over_key(methods: &[&MethodScore], key: &str) -> Figure {
    let parts = methods.iter().map(|score| {
        let parts = score.map.iter().filter(|part| part.by == key);
        MethodParts {
            method: &score.method,
            parts: parts.collect(),
        }
    });
    let swept = SweptKey {
        key,
        keys: vec![key],
        conditions: &[],
        methods: parts.collect(),
    };
    let narrow = sweep_figure(&swept, Layout::TELEPHONE);
    Figure::new(
            sweep_figure(&swept, Layout::SCREEN),
            format!(
                "Accuracy at every value of {key} with respect to the class of the ground, with 95 % intervals."
            ),
        )
        .narrow(narrow)
}

fn features(score: &RecognitionScore) -> Option<Section> {
    let points = points(score);
    if points.is_empty() {
        return None;
    }
    let mut section =
        Section::new("Features and the paper's regions").table(spreads(&score.features));
    section = section.table(slopes(&score.features));
    section = section.figure(Figure::new(
        feature_values(&points),
        "The four features of every window by ground.",
    ));
    if let Some(lugs) = score.lugs {
        section = section.figure(Figure::new(
            feature_planes(&points, lugs),
            "Windows in the planes of two features, with the paper's regions.",
        ));
    }
    Some(section)
}

/// The features of every window.
fn points(score: &RecognitionScore) -> Vec<FeaturePoint> {
    let points = score.points.iter().map(|&(terrain, p)| FeaturePoint {
        group: Group::Terrain(terrain),
        p,
    });
    points.collect()
}

const NAMES: [&str; 4] = ["p1 frequency", "p2 amplitudes", "p3 mean", "p4 mean square"];

/// A row a feature: side by side the four are wider than a page.
fn spreads(scenarios: &[FeaturesOfScenario]) -> Table {
    let rows = |of: &FeaturesOfScenario| -> Vec<Vec<Cell>> {
        let row = |(name, spread): (&&str, &FeatureSpread)| {
            let [low, middle, high] = spread.percentiles.map(hundredths);
            let text = format!("{middle} ({low} to {high})").replace('-', "−");
            vec![
                Cell::text(&of.scenario),
                Cell::text(*name),
                Cell::Written(text, spread.percentiles[1]),
                Cell::Count(spread.within as u64),
                Cell::Count(of.n as u64),
            ]
        };
        NAMES.iter().zip(&of.features).map(row).collect()
    };
    let columns = [
        "scenario",
        "feature",
        "median (10 % to 90 %)",
        "in the region",
        "windows",
    ];
    Table::of(columns, scenarios.iter().flat_map(rows)).captioned(
        "Each feature over all windows, and windows within the paper's limits for the class of the ground",
    )
}

/// A feature with two places, and a zero that has no sign.
fn hundredths(value: f64) -> String {
    match libm::round(100.0 * value) / 100.0 {
        0.0 => "0.00".to_owned(),
        rounded => format!("{rounded:.2}"),
    }
}

/// Empty where speed was not swept.
fn slopes(scenarios: &[FeaturesOfScenario]) -> Table {
    let has = |of: &&FeaturesOfScenario| of.features.iter().any(|spread| spread.slope.is_some());
    let row = |of: &FeaturesOfScenario| {
        let slopes = of.features.iter().map(|spread| {
            let cell = |Slope {
                            value,
                            ci95: [low, high],
                        }: Slope| {
                let text = format!("{value:+.2} [{low:+.2}, {high:+.2}]");
                Cell::Written(text.replace('-', "−"), value)
            };
            spread.slope.map_or(Cell::Missing, cell)
        });
        std::iter::once(Cell::text(&of.scenario))
            .chain(slopes)
            .collect()
    };
    let names = ["scenario"].into_iter().chain(NAMES);
    Table::of(names, scenarios.iter().filter(has).map(row))
        .captioned("Decades of a feature per decade of speed, with Student's 95 % interval")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::study_page::texts;
    use crate::study::Scores;

    #[test]
    fn the_text_has_the_published_counts_below_the_simulated_ones_in_the_same_columns() {
        let mut confusion = Confusion::default();
        confusion.counts[0] = [58, 0, 0, 2];
        let counted = Counted::from(confusion);
        let score = RecognitionScore {
            windows: 60,
            points: Vec::new(),
            lugs: None,
            features: Vec::new(),
            published: Some(counted.clone()),
            scores: vec![MethodScore {
                method: "paper".to_owned(),
                against: Against::Label,
                all: counted,
                map: Vec::new(),
            }],
        };
        let scores = Scores {
            recognition: Some(score),
            ..Scores::default()
        };
        let text = &texts(&scores)[0].text;
        let line = |of: [&str; 3]| {
            let mut lines = text.lines();
            lines.find(|line| {
                line.split("  ")
                    .filter(|it| !it.is_empty())
                    .map(str::trim)
                    .take(3)
                    .eq(of)
            })
        };
        let column = text
            .lines()
            .find_map(|line| Some(line.find("ALCT")? + 4))
            .unwrap();
        for method in ["paper", "published"] {
            let row = line([method, OF_GROUND, "ALCT"]).unwrap();
            assert_eq!(&row[column - 2..column], "58", "{row}");
        }
        assert_eq!(
            text.replace('\n', " ")
                .matches("96.7 % [88.6, 99.1]")
                .count(),
            2 * 3
        );
        assert!(
            line(["paper", OF_GROUND, "SLCT"]).is_none(),
            "it did not occur"
        );
    }
}
