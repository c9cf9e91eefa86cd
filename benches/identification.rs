//! Cost of identifying a sand: the stages, the joint fit, and the profiles of its parameters.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::identification::{Identification, Setting, SteadyLoad, identify};
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::table_6;
use lugwheel::terrain::class::Wtic;
use std::hint::black_box;

const RIM: Rim = Rim {
    radius: 0.155,
    width: 0.15,
};

/// Nine slips at each of these depths [m] at slip 0; every force a few per cent off, as measured
/// ones are.
fn rows(depths: &[f64]) -> Vec<SteadyLoad> {
    let slips = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6];
    let pairs = depths
        .iter()
        .flat_map(|&depth| slips.map(|slip| (depth, slip)));
    let row = |(index, (depth, slip)): (usize, (f64, f64))| {
        let sinkage = depth * (1.0 + 8.0 * slip);
        let loads = closed_form::loads(RIM, &table_6::sand(), sinkage, slip);
        let off = 1.0 + 0.02 * f64::sin(index as f64);
        SteadyLoad {
            slip,
            sinkage,
            drawbar_pull: loads.drawbar_pull * off,
            load: loads.normal_force / off,
            driving_torque: loads.driving_torque * off * off,
            uncertainty: None,
        }
    };
    pairs.enumerate().map(row).collect()
}

fn identification(criterion: &mut Criterion) {
    let setting = Setting::new(RIM);
    let mut group = criterion.benchmark_group("identification of sand");
    for (name, depths) in [
        ("9 rows", &[0.006][..]),
        ("27 rows", &[0.0035, 0.0055, 0.0087]),
    ] {
        let rows = rows(depths);
        let prepared = Identification::new(&rows, Wtic::Leis, &setting).expect("sound rows");
        group.bench_function(format!("three stages, {name}"), |bencher| {
            bencher.iter(|| black_box(prepared.staged()));
        });
        group.bench_function(format!("stages and joint fit, {name}"), |bencher| {
            bencher.iter(|| black_box(prepared.estimate()));
        });
        group.bench_function(format!("the same with profiles, {name}"), |bencher| {
            bencher.iter(|| black_box(identify(&rows, Wtic::Leis, &setting)));
        });
    }
    group.finish();
}

criterion_group!(benches, identification);
criterion_main!(benches);
