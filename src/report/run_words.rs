//! What a run is, in words: ground, wheel, condition, where it comes from.

use crate::table::four_digits;
use crate::terrain::class::TerrainLabel;
use crate::trace::RunAttributes;

/// A ground in words.
pub(super) fn terrain_name(terrain: TerrainLabel) -> &'static str {
    match terrain {
        TerrainLabel::Reference => "flat hard ground (REF)",
        TerrainLabel::Hard => "hard terrain (HT)",
        TerrainLabel::Gravel => "gravel (GT)",
        TerrainLabel::Sand => "sand (ST)",
        TerrainLabel::HardWithGravel => "hard terrain with gravel (HGT)",
        TerrainLabel::SandWithGravel => "sand with gravel (SGT)",
    }
}

/// The wheel and what was commanded, without unknown values.
pub(super) fn wheel_and_condition(run: &RunAttributes) -> String {
    let wheel = match run.lugs() {
        lugs if lugs.are_none() => "smooth wheel".to_owned(),
        lugs => lugs.to_string(),
    };
    let known = |value: f64, text: String| value.is_finite().then_some(text);
    let (radius, width) = (run.wheel_radius * 1e3, run.wheel_width * 1e3);
    let wheel = [
        Some(wheel),
        known(radius, format!("rim radius {radius:.0} mm")),
        known(width, format!("width {width:.0} mm")),
    ];
    let wheel: Vec<String> = wheel.into_iter().flatten().collect();
    let speed = run.speed * 1e3;
    let parts = [
        Some(wheel.join(", ")),
        known(run.load, format!("load {:.1} N", run.load)),
        known(speed, format!("speed {speed:.1} mm/s")),
        known(run.slip_ratio, format!("slip {:.2}", run.slip_ratio)),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    parts.join("   |   ")
}

/// Where the run comes from, and its label.
pub(super) fn origin(run: &RunAttributes) -> String {
    let source = match run.physics_rate {
        Some(rate) => format!("simulated at {} kHz", four_digits(rate / 1e3)),
        None => "measured".to_owned(),
    };
    let class = run.class.map(|class| format!("class {class}"));
    let day = (!run.day.is_empty()).then(|| format!("day {}", run.day));
    let notes = (!run.notes.is_empty()).then(|| run.notes.clone());
    let parts = [Some(source), class, Some(format!("repeat {}", run.repeat))];
    let parts: Vec<String> = parts.into_iter().chain([day, notes]).flatten().collect();
    parts.join("   |   ")
}
