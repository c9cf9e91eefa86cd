//! probe
mod common;
use common::*;
use lugwheel::quantity::Seed;
use lugwheel::scenario::Scenario;
#[test]
fn probe() {
    for name in std::env::var("NAMES").unwrap_or("gt hgt sgt st ht ref".into()).split(' ') {
        let path = format!("scenarios/single_wheel_{name}.toml");
        let s = Scenario::load(&path).unwrap().with("duration=6").unwrap();
        for run in 0..2 {
            let t = std::time::Instant::now();
            let trace = match s.run(Seed(1), run, &mut |_| std::ops::ControlFlow::Continue(())) { Ok(t) => t, Err(e) => { println!("{name} {run}: {e}"); continue } };
            let el = t.elapsed().as_secs_f64();
            let m = |n: &str| { let c = &trace.channel(n).unwrap().samples; mean(c[c.len() / 6..].iter().copied()) };
            println!("{name} {run}: {:.2}x real time, F_N {:.3} F_DP {:.3} T {:.3} z {:.5} slip {:.3} a_rms {:.4} class {:?} contacts {}", 6.0 / el, m("normal_force"), m("drawbar_pull"), m("driving_torque"), m("sinkage"), m("slip_ratio"), rms(trace.channel("acceleration_y").unwrap().samples[2000..].iter().copied()), trace.truth.as_ref().unwrap().class_windows.iter().map(|w| w.class).collect::<Vec<_>>(), trace.truth.as_ref().unwrap().contacts.len());
        }
    }
}
