//! What a data set costs against its number of runs and the cores it has: a table, and as a figure
//! `output/reference/study_cost.svg`. The same runs of 15 s on slate are made anew every time, into a
//! folder that is thrown away.

use lugwheel::report::figure::{Anchor, Area, Axis, Canvas, Font, PALETTE, Panel, Stroke};
use lugwheel::study::{Options, Study};
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Runs of a data set.
const RUNS: [u32; 4] = [10, 20, 40, 80];
/// Size of the drawing [px].
const SIZE: [f64; 2] = [820.0, 460.0];

/// What one data set took.
struct Cost {
    cores: usize,
    runs: u32,
    seconds: f64,
}

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let most = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let mut cores = vec![1, most];
    cores.dedup();
    let mut costs = Vec::new();
    println!("runs  cores  seconds  s a run");
    for runs in RUNS {
        for &cores in &cores {
            let seconds = seconds(root, runs, cores);
            let each = seconds / f64::from(runs);
            println!("{runs:4}  {cores:5}  {seconds:7.1}  {each:7.3}");
            costs.push(Cost {
                cores,
                runs,
                seconds,
            });
        }
    }
    let slopes: Vec<(usize, f64)> = cores.iter().map(|&c| (c, slope(&costs, c))).collect();
    for (cores, slope) in &slopes {
        println!("{cores} cores: {slope:.3} s a run, a straight line through nothing");
    }
    println!(
        "ratio {:.2}",
        slopes[0].1 / slopes.last().map_or(1.0, |last| last.1)
    );
    let file = root.join("output/reference/study_cost.svg");
    std::fs::write(&file, figure(&costs, &slopes)).expect("the figure can be written");
}

/// Time [s] of a data set, from nothing to its files.
fn seconds(root: &Path, runs: u32, cores: usize) -> f64 {
    let folder = tempfile::tempdir().expect("a folder for a while");
    let file = folder.path().join("cost.toml");
    let scenario = root.join("scenarios/single_wheel_ht.toml");
    let text = format!(
        "version = 1\nscenarios = [{scenario:?}]\nseed = 31\nrepeats = {runs}\nrandom_numbers = \"independent\"\n\
         [set]\nduration = 15.0\nlead_in = 6.0\n[dataset]\nkeep = \"traces\"\n"
    );
    std::fs::write(&file, text).expect("the study can be written");
    let study = Study::load(&file).expect("the study is one");
    let options = Options {
        out: folder.path().join("out"),
        jobs: NonZeroUsize::new(cores),
        resume: false,
        shard: None,
    };
    let begun = Instant::now();
    let outcome = study.execute(&options, &|_| ControlFlow::Continue(()));
    let outcome = outcome.expect("the study runs");
    assert!(outcome.failures.is_empty(), "no run fails on slate");
    begun.elapsed().as_secs_f64()
}

/// Time a run [s] by the least squares of relative errors.
fn slope(costs: &[Cost], cores: usize) -> f64 {
    let own = costs.iter().filter(|cost| cost.cores == cores);
    let each: Vec<f64> = own
        .map(|cost| cost.seconds / f64::from(cost.runs))
        .collect();
    let sum: f64 = each.iter().map(|each| 1.0 / each).sum();
    let squares: f64 = each.iter().map(|each| 1.0 / (each * each)).sum();
    sum / squares
}

/// Time against runs, a colour for each number of cores, with the straight lines.
fn figure(costs: &[Cost], slopes: &[(usize, f64)]) -> String {
    let title = "Cost of a data set of 15 s runs on slate";
    let mut canvas = Canvas::new(SIZE, title);
    canvas.text([16.0, 30.0], Anchor::Start, Font::TITLE, title);
    let area = Area {
        left: 80.0,
        top: 84.0,
        width: SIZE[0] - 110.0,
        height: SIZE[1] - 84.0 - 60.0,
    };
    let most = f64::from(RUNS[RUNS.len() - 1]);
    let longest = costs.iter().map(|cost| cost.seconds).fold(0.0, f64::max);
    let panel = Panel {
        area,
        x: Axis::exact([0.0, 1.05 * most], [area.left, area.right()]),
        y: Axis::exact([0.0, 1.1 * longest], [area.bottom(), area.top]),
    };
    let header = "Time of the clock [s]";
    panel.draw_frame(&mut canvas, header);
    panel.draw_footer(&mut canvas, "runs of 15 s after 6 s of lead-in");
    let mut legend = Vec::new();
    for ((cores, slope), colour) in slopes.iter().zip(PALETTE) {
        let stroke = Stroke::solid(colour, 1.5);
        let ends = [[0.0, 0.0], [most, slope * most]].map(|end| panel.at(end));
        canvas.polyline(&ends, stroke);
        for cost in costs.iter().filter(|cost| cost.cores == *cores) {
            let at = panel.at([f64::from(cost.runs), cost.seconds]);
            canvas.circle(at, 4.5, colour, Stroke::solid("#ffffff", 1.0));
        }
        let noun = if *cores == 1 { "core" } else { "cores" };
        legend.push((format!("{cores} {noun}: {slope:.2} s a run"), stroke));
    }
    panel.draw_legend(&mut canvas, header, &legend);
    canvas.finish()
}
