//! Units of measured columns, and what turns them into a channel's own.

use crate::quantity::GRAVITY;
use std::f64::consts::{PI, TAU};

/// Units by the unit they are converted to, each with its size in that unit.
const UNITS: [(&str, &[(&str, f64)]); 11] = [
    (
        "m/s^2",
        &[
            ("m/s^2", 1.0),
            ("cm/s^2", 1.0e-2),
            ("mm/s^2", 1.0e-3),
            ("g", GRAVITY),
            ("mg", 1.0e-3 * GRAVITY),
        ],
    ),
    (
        "N",
        &[
            ("N", 1.0),
            ("mN", 1.0e-3),
            ("kN", 1.0e3),
            ("kgf", GRAVITY),
            ("lbf", 4.448_221_615_260_5),
        ],
    ),
    (
        "N m",
        &[
            ("N m", 1.0),
            ("N mm", 1.0e-3),
            ("N cm", 1.0e-2),
            ("mN m", 1.0e-3),
            ("kN m", 1.0e3),
            ("kgf m", GRAVITY),
            ("lbf ft", 1.355_817_948_331_400_4),
        ],
    ),
    (
        "m",
        &[
            ("m", 1.0),
            ("cm", 1.0e-2),
            ("mm", 1.0e-3),
            ("um", 1.0e-6),
            ("in", 0.0254),
        ],
    ),
    ("1", &[("1", 1.0), ("%", 1.0e-2)]),
    ("kg", &[("kg", 1.0), ("g", 1.0e-3)]),
    ("deg", &[("deg", 1.0), ("rad", 180.0 / PI)]),
    ("rad", &[("rad", 1.0), ("deg", PI / 180.0), ("rev", TAU)]),
    (
        "m/s",
        &[
            ("m/s", 1.0),
            ("cm/s", 1.0e-2),
            ("mm/s", 1.0e-3),
            ("m/min", 1.0 / 60.0),
            ("km/h", 1.0 / 3.6),
        ],
    ),
    (
        "s",
        &[
            ("s", 1.0),
            ("ms", 1.0e-3),
            ("us", 1.0e-6),
            ("ns", 1.0e-9),
            ("min", 60.0),
            ("h", 3600.0),
            ("d", 86_400.0),
        ],
    ),
    (
        "rad/s",
        &[
            ("rad/s", 1.0),
            ("deg/s", PI / 180.0),
            ("rpm", TAU / 60.0),
            ("rev/min", TAU / 60.0),
            ("rev/s", TAU),
        ],
    ),
];

/// Units that can be converted to `target`, each with its size in it.
fn units_of(target: &str) -> &'static [(&'static str, f64)] {
    let found = UNITS.iter().find(|(unit, _)| *unit == target);
    found.map_or(&[], |(_, units)| *units)
}

/// Size of `unit` in units of `target`; spelling of products, powers and micro does not matter.
///
/// # Errors
/// The units that can be converted, where `unit` is none of them.
pub(super) fn factor(unit: &str, target: &str) -> Result<f64, String> {
    let units = units_of(target);
    let same = |known: &&(&str, f64)| normal(known.0) == normal(unit);
    match units.iter().find(same) {
        Some((_, factor)) => Ok(*factor),
        None => {
            let known: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
            Err(known.join(", "))
        }
    }
}

/// The unit that the header of a column states, where it is a unit of `target` of another size.
///
/// A header states its unit in brackets (`Fz [kN]`) or at its end (`sinkage_mm`, `speed_mm_s`).
pub(super) fn stated_otherwise(header: &str, target: &str) -> Option<&'static str> {
    let stated = candidates(header);
    let units = units_of(target);
    let known = stated.iter().find_map(|stated| {
        let same = |unit: &&(&str, f64)| normal(unit.0).eq_ignore_ascii_case(&normal(stated));
        units.iter().find(same)
    });
    known
        .filter(|(_, factor)| *factor != 1.0)
        .map(|(unit, _)| *unit)
}

/// The unit that a cell below the header states, where it is one of `target` of another size.
pub(super) fn stated_below(cell: &str, target: &str) -> Option<&'static str> {
    let cell = cell.trim().trim_matches(['[', ']', '(', ')']);
    let same = |unit: &&(&str, f64)| normal(unit.0).eq_ignore_ascii_case(&normal(cell));
    let known = units_of(target).iter().find(same);
    known
        .filter(|(_, factor)| *factor != 1.0)
        .map(|(unit, _)| *unit)
}

/// Candidates for the unit in a header, the most specific first.
fn candidates(header: &str) -> Vec<String> {
    let header = header.trim();
    if let Some(open) = header.rfind(['[', '('])
        && let Some(inner) = header[open + 1..].strip_suffix([']', ')'])
    {
        return vec![inner.to_owned()];
    }
    let mut words = header.rsplit('_');
    let last = words.next().unwrap_or_default();
    match words.next() {
        Some(before) => vec![
            format!("{before}/{last}"),
            format!("{before} {last}"),
            last.to_owned(),
        ],
        None => Vec::new(),
    }
}

/// A unit without what is only spelling.
fn normal(unit: &str) -> String {
    let mut normal = String::new();
    for c in unit.chars() {
        match c {
            ' ' | '*' | '^' | '·' | '⋅' => {}
            '²' => normal.push('2'),
            'µ' | 'μ' => normal.push('u'),
            '°' => normal.push_str("deg"),
            c => normal.push(c),
        }
    }
    match normal.as_str() {
        "-" | "" => "1".to_owned(),
        "percent" => "%".to_owned(),
        _ => normal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::CHANNELS;

    #[test]
    fn every_channel_has_its_own_unit_among_those_it_can_be_measured_in() {
        for (channel, unit) in CHANNELS {
            assert_eq!(factor(unit, unit), Ok(1.0), "{channel}");
        }
    }

    #[test]
    fn units_are_known_in_every_spelling() {
        for spelling in ["N m", "N·m", "Nm", "N*m", "N ⋅ m"] {
            assert_eq!(factor(spelling, "N m"), Ok(1.0), "{spelling}");
        }
        for spelling in ["m/s^2", "m/s²", "m/s2"] {
            assert_eq!(factor(spelling, "m/s^2"), Ok(1.0), "{spelling}");
        }
        assert_eq!(factor("µm", "m"), factor("um", "m"));
        assert_eq!(factor("°", "rad"), Ok(PI / 180.0));
        assert_eq!(factor("percent", "1"), Ok(0.01));
        assert_eq!(factor("-", "1"), Ok(1.0));
    }

    #[test]
    fn mega_and_milli_are_not_mixed_up_and_a_foreign_unit_is_answered_with_those_known() {
        assert!(factor("MN", "N").is_err());
        assert_eq!(factor("kg", "N").unwrap_err(), "N, mN, kN, kgf, lbf");
        assert!(factor("mm", "N").is_err());
    }

    #[test]
    fn a_header_has_its_unit_at_its_end_or_in_brackets() {
        let cases = [
            ("sinkage_mm", "m", Some("mm")),
            ("sinkage_m", "m", None),
            ("Fz [kN]", "N", Some("kN")),
            ("Fz (N)", "N", None),
            ("rim_speed_mm_s", "m/s", Some("mm/s")),
            ("az_g", "m/s^2", Some("g")),
            ("torque_nmm", "N m", Some("N mm")),
            ("driving_torque_nm", "N m", None),
            ("drawbar_pull_n", "N", None),
            ("slip [%]", "1", Some("%")),
            ("mm", "m", None),
            ("", "m", None),
        ];
        for (header, target, stated) in cases {
            assert_eq!(stated_otherwise(header, target), stated, "{header}");
        }
    }
}
