//! Which physics rate each ground needs: statistics at cheaper rates over those at 128 kHz, on the
//! same grounds. The default rates follow from the table, `output/reference/convergence.csv`.
//!
//! `cargo test --release --test all convergence:: -- --ignored --nocapture` makes it anew, in half an
//! hour on two cores; it goes on with what `output/convergence_*` hold.

use lugwheel::study::{Options, Study};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// What is compared; the rest of the table follows from it.
const METRICS: [&str; 9] = [
    "normal_force_sd_n",
    "drawbar_pull_mean_n",
    "driving_torque_mean_n_m",
    "sinkage_mean_m",
    "sinkage_sd_m",
    "acceleration_rms_2_20_hz_m_s2",
    "acceleration_rms_20_200_hz_m_s2",
    "acceleration_rms_200_800_hz_m_s2",
    "acceleration_lug_pass_m_s2",
];

const REFERENCE: &str = "128000";

/// Ratio of a metric to its reference: geometric mean with its 95 % interval; where a value may
/// change its sign, the mean difference in units of the reference's standard deviation.
struct Change {
    runs: usize,
    kind: &'static str,
    value: f64,
    interval: [f64; 2],
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Rows of a study's table, each a map from column to cell.
fn table(name: &str) -> Vec<BTreeMap<String, String>> {
    let study = Study::load(root().join(format!("scenarios/studies/{name}.toml"))).unwrap();
    let out = root().join("output").join(name);
    fs::create_dir_all(&out).unwrap();
    let options = Options {
        out: out.clone(),
        jobs: None,
        resume: true,
        shard: None,
    };
    let outcome = study
        .execute(&options, &|_| ControlFlow::Continue(()))
        .unwrap();
    assert!(outcome.failed.is_empty(), "{:?}", outcome.failed);
    let mut reader = csv::Reader::from_path(out.join("runs.csv")).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// Values of a metric by repeat.
fn values(
    rows: &[BTreeMap<String, String>],
    scenario: &str,
    rate: &str,
    metric: &str,
) -> BTreeMap<String, f64> {
    rows.iter()
        .filter(|row| {
            row["scenario"] == scenario
                && row["physics_rate"].parse::<f64>().ok() == rate.parse().ok()
        })
        .filter_map(|row| Some((row["repeat"].clone(), row[metric].parse().ok()?)))
        .collect()
}

fn change(cheap: &BTreeMap<String, f64>, reference: &BTreeMap<String, f64>) -> Option<Change> {
    let pairs: Vec<[f64; 2]> = cheap
        .iter()
        .filter_map(|(repeat, value)| Some([*value, *reference.get(repeat)?]))
        .collect();
    if pairs.len() < 2 {
        return None;
    }
    if pairs.iter().all(|[a, b]| a * b > 0.0) {
        let (mean, half) = interval(pairs.iter().map(|[a, b]| (a / b).ln()));
        let interval = [(mean - half).exp(), (mean + half).exp()];
        return Some(Change {
            runs: pairs.len(),
            kind: "ratio",
            value: mean.exp(),
            interval,
        });
    }
    let (_, half) = interval(pairs.iter().map(|[_, b]| *b));
    let sd = half / 1.96 * (pairs.len() as f64).sqrt();
    let (mean, half) = interval(pairs.iter().map(|[a, b]| (a - b) / sd));
    Some(Change {
        runs: pairs.len(),
        kind: "difference_in_sd",
        value: mean,
        interval: [mean - half, mean + half],
    })
}

/// Mean and half width of its 95 % interval.
fn interval(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / (n - 1.0);
    (mean, 1.96 * (variance / n).sqrt())
}

#[test]
#[ignore = "half an hour: 240 runs on fixed ground, 300 on gravel"]
fn default_rates_change_no_statistic_by_more_than_the_stated_bounds() {
    let mut out = String::from(
        "# cargo test --release --test all convergence:: -- --ignored; seeds 101 and 102; ratio to 128 kHz with 95 % interval\n\
         scenario,physics_rate_hz,metric,runs,kind,value,low,high\n",
    );
    let mut faults = Vec::new();
    for (study, scenarios, rates) in [
        (
            "convergence_fixed",
            &["single_wheel_ref", "single_wheel_ht", "single_wheel_st"][..],
            &["8000", "16000", "32000"][..],
        ),
        (
            "convergence_gravel",
            &["single_wheel_gt"][..],
            &["8000", "32000"][..],
        ),
    ] {
        let rows = table(study);
        for scenario in scenarios {
            for (rate, metric) in rates
                .iter()
                .flat_map(|rate| METRICS.map(|metric| (rate, metric)))
            {
                let reference = values(&rows, scenario, REFERENCE, metric);
                let Some(change) = change(&values(&rows, scenario, rate, metric), &reference)
                else {
                    continue;
                };
                let Change {
                    runs,
                    kind,
                    value,
                    interval: [low, high],
                } = change;
                writeln!(
                    out,
                    "{scenario},{rate},{metric},{runs},{kind},{value:.4},{low:.4},{high:.4}"
                )
                .unwrap();
                // Fixed ground at its default of 16 kHz: 2 %.
                if study == "convergence_fixed"
                    && *rate == "16000"
                    && !(0.975..1.025).contains(&value)
                {
                    faults.push(format!("{scenario} {metric} {value}"));
                }
            }
        }
    }
    print!("{out}");
    fs::write(root().join("output/reference/convergence.csv"), out).unwrap();
    assert!(faults.is_empty(), "{faults:?}");
}
