//! Cost of identifying a sand: the stages, the joint fit, and the profiles of its parameters.

use criterion::{Criterion, criterion_group, criterion_main};
use lugwheel::identification::{
    Identification, Law, Own, Setting, SteadyLoad, Uncertainty, identify,
};
use lugwheel::soil::closed_form::{self, Rim};
use lugwheel::soil::wheel_load::{self, sinkage_at};
use lugwheel::soil::{Soil, StressConvention, table_6};
use lugwheel::terrain::class::Wtic;
use lugwheel::wheel::Wheel;
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

/// 27 rows of the lugged wheel under three loads by the quadrature, and what it is told besides.
fn lugged() -> (Vec<SteadyLoad>, Setting) {
    let wheel = Wheel::rover();
    let soil = Soil {
        convention: StressConvention::WongReece,
        stress_angle: 0.35,
        stress_angle_slip: 0.25,
        exit_angle: -0.15,
        ..table_6::sand()
    };
    let slips = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6];
    let pairs = [60.0, 109.0, 200.0]
        .into_iter()
        .flat_map(|load| slips.map(|slip| [load, slip]));
    let row = |(index, [load, slip]): (usize, [f64; 2])| {
        let sinkage = sinkage_at(&wheel, &soil, load, slip).expect("the sand carries it");
        let loads = wheel_load::loads(&wheel, &soil, sinkage, slip);
        let off = 0.01 * f64::sin(index as f64);
        SteadyLoad {
            sinkage: sinkage + 0.0005 * f64::sin(1.7 * index as f64),
            drawbar_pull: loads.drawbar_pull + off * load,
            driving_torque: loads.driving_torque * (1.0 - off),
            uncertainty: Some(Uncertainty {
                slip: 0.005,
                sinkage: 0.0005,
                drawbar_pull: 0.01 * load,
                load: 0.01 * load,
                driving_torque: 0.0015 * load,
            }),
            ..SteadyLoad::new(slip, sinkage, loads)
        }
    };
    let law = Law::Own(Own {
        lugs: wheel.lugs,
        convention: soil.convention,
        bulk_density: soil.bulk_density,
    });
    let setting = Setting {
        law,
        exit_angle: soil.exit_angle,
        ..Setting::new(RIM)
    };
    (pairs.enumerate().map(row).collect(), setting)
}

fn quadrature(criterion: &mut Criterion) {
    let (rows, setting) = lugged();
    let prepared = Identification::new(&rows, Wtic::Leis, &setting).expect("sound rows");
    let mut group = criterion.benchmark_group("quadrature with lugs, 27 rows");
    group.bench_function("fit", |bencher| {
        bencher.iter(|| black_box(prepared.estimate()));
    });
    group.bench_function("fit with profiles", |bencher| {
        bencher.iter(|| black_box(identify(&rows, Wtic::Leis, &setting)));
    });
    group.finish();
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

criterion_group!(benches, identification, quadrature);
criterion_main!(benches);
