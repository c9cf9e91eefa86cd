//! `runs.csv`: one row a run.
//!
//! | columns | content |
//! |---|---|
//! | `run`, `condition`, `repeat`, `stream` | numbers from 0 |
//! | `scenario`, every swept key | the condition |
//! | `label`, `class` | the ground; the true class, where all windows have one and the same |
//! | `windows_alct` ... `windows_uwtic` | windows of each true class |
//! | `duration_s` | length of the record |
//! | `normal_force_mean_n`, `normal_force_sd_n`, ... | over the steady part: the middle half |
//! | `acceleration_rms_2_20_hz_m_s2`, ... | vertical acceleration of the steady part in a [`BANDS`] |
//! | `acceleration_crest_2_20_hz`, ... | its largest magnitude over its rms |
//! | `acceleration_lug_pass_m_s2` | amplitude of the vertical acceleration at the order of the lug pass |
//! | `normal_force_steadiness`, ... | `steady`, `drifting` or `too_short`: whether the mean is that of a steady state |
//! | `normal_force_drift_n_s`, ... | rate of change where it drifts |
//! | `failure` | why there are no values; empty where there are |
//!
//! A cell is empty where a value does not exist. Numbers have the shortest representation that reads back
//! exactly.

use super::cells::{Number, lines, list};
use super::table::{Columns, NoRows, NoTable, Place, Stop, Table};
use super::{Run, Study};
use crate::dataset::records::Field;
use crate::recognition::confusion::CLASSES;
use crate::signal::Band;
use crate::terrain::class::{TerrainLabel, Wtic};
use crate::trace::steadiness::Steadiness;
use crate::trace::{Channel, Trace, unit_of};
use serde::{Deserialize, Serialize};

/// Bands in which the vertical acceleration is measured. Below them lies the wheel's path over its
/// lugs, above them the end of a record at 2 kHz.
pub const BANDS: [Band; 3] = [
    Band {
        low: 2.0,
        high: 20.0,
    },
    Band {
        low: 20.0,
        high: 200.0,
    },
    Band {
        low: 200.0,
        high: 800.0,
    },
];

/// Channels whose steady mean and standard deviation are in the table, and their unit in its names.
pub(super) const STEADY: [(&str, &str); 5] = [
    ("normal_force", "_n"),
    ("drawbar_pull", "_n"),
    ("driving_torque", "_n_m"),
    ("sinkage", "_m"),
    ("slip_ratio", ""),
];

/// The table of the runs of a study.
pub(super) struct Runs<'s> {
    pub(super) study: &'s Study,
}

/// A run: its values, or why there are none.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct RunRow {
    pub(super) run: u64,
    pub(super) condition: u64,
    repeat: u32,
    stream: u64,
    pub(super) scenario: String,
    /// Values of the swept keys.
    #[serde(deserialize_with = "list")]
    pub(super) values: Vec<String>,
    label: Option<TerrainLabel>,
    class: Option<Wtic>,
    /// Of each true class; none where the run failed.
    windows: [Option<u64>; 4],
    duration: Number,
    /// Mean and standard deviation of each of [`STEADY`].
    pub(super) steady: [[Number; 2]; STEADY.len()],
    /// Root mean square and crest factor of the acceleration in each of [`BANDS`].
    pub(super) bands: [[Number; 2]; BANDS.len()],
    lug_pass: Number,
    /// Of each of [`STEADY`].
    pub(super) steadiness: [Tested; STEADY.len()],
    pub(super) failure: String,
}

/// Whether a mean is that of a steady state: the name of the state, and how fast it drifts.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Tested {
    pub(super) state: String,
    pub(super) rate: Number,
}

impl Table for Runs<'_> {
    fn name(&self) -> &'static str {
        "runs"
    }

    fn columns(&self) -> Columns {
        columns(&self.study.keys().collect::<Vec<_>>())
    }

    fn rows(&self, run: &Run, trace: &Trace, _: &mut Stop) -> Result<String, NoRows> {
        Ok(lines([RunRow::at(self.study, run).with_values(trace)]))
    }

    fn rows_of_failed(&self, run: &Run, reason: &str) -> String {
        lines([RunRow {
            failure: reason.to_owned(),
            ..RunRow::at(self.study, run)
        }])
    }
}

/// The columns of the runs of a study with these swept keys.
pub(super) fn columns(keys: &[impl AsRef<str>]) -> Columns {
    let names = |fields: Vec<Field>| fields.into_iter().map(|field| field.name);
    Columns::default()
        .with(names(first_fields()))
        .list(keys.iter().map(|key| [key.as_ref()]))
        .with(names(value_fields()))
}

/// The swept keys in a table of runs: its columns between scenario and label.
///
/// # Errors
/// One of these columns, where the table lacks it.
pub(super) fn keys_of(text: &str) -> Result<Vec<String>, NoTable> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let place = |column: &str| {
        let place = header.iter().position(|name| name == column);
        place.ok_or_else(|| NoTable::Column(column.to_owned()))
    };
    let [before, behind] = [place("scenario")?, place("label")?];
    let keys = header.iter().take(behind).skip(before + 1);
    Ok(keys.map(str::to_owned).collect())
}

/// The columns of a study's runs, with unit and meaning.
pub(super) fn fields(study: &Study) -> Vec<Field> {
    [first_fields(), swept_fields(study), value_fields()].concat()
}

fn first_fields() -> Vec<Field> {
    vec![
        Field::whole("run", "number from 0"),
        Field::whole("condition", "number of the scenario with its swept values"),
        Field::whole("repeat", "which repeat of its condition"),
        Field::whole("stream", "random numbers it draws from"),
        Field::text("scenario", "name of the scenario's file"),
    ]
}
/// The columns of a study's swept keys: numbers where all values are.
pub(super) fn swept_fields(study: &Study) -> Vec<Field> {
    let field = |key: &str| {
        let mut values = study.values_of(key).into_iter().flatten();
        let meaning = "swept key of the scenario";
        if values.all(|value| value.parse::<f64>().is_ok()) {
            Field::number(key, "", meaning)
        } else {
            Field::text(key, meaning)
        }
    };
    study.keys().map(field).collect()
}

fn value_fields() -> Vec<Field> {
    let mut fields = vec![
        Field::text("label", "the ground"),
        Field::text(
            "class",
            "true class, where all windows have one and the same",
        ),
    ];
    fields.extend(CLASSES.map(|class| {
        let name = format!("windows_{}", class.as_str().to_lowercase());
        Field::number(name, "1", "windows of this true class")
    }));
    fields.push(Field::number("duration_s", "s", "length of the record"));
    for (channel, ending) in STEADY {
        let unit = unit_of(channel).unwrap_or_default();
        let [mean, sd] = ["mean", "sd"].map(|what| format!("{channel}_{what}{ending}"));
        fields.push(Field::number(mean, unit, "mean over the middle half"));
        fields.push(Field::number(
            sd,
            unit,
            "standard deviation over the middle half",
        ));
    }
    for Band { low, high } in BANDS {
        let rms = format!("acceleration_rms_{low}_{high}_hz_m_s2");
        let crest = format!("acceleration_crest_{low}_{high}_hz");
        fields.push(Field::number(
            rms,
            "m/s^2",
            "vertical acceleration in a band, steady",
        ));
        fields.push(Field::number(
            crest,
            "1",
            "its largest magnitude over its rms",
        ));
    }
    let order = "amplitude of the vertical acceleration at the order of the lug pass";
    fields.push(Field::number("acceleration_lug_pass_m_s2", "m/s^2", order));
    let steady = STEADY.into_iter();
    fields.extend(steady.flat_map(|(channel, ending)| steadiness_fields(channel, ending)));
    let failure = "why there are no values; empty where there are";
    fields.push(Field::text("failure", failure));
    fields
}

fn steadiness_fields(channel: &str, ending: &str) -> [Field; 2] {
    let unit = match unit_of(channel) {
        Some("N") => "N/s",
        Some("N m") => "N m/s",
        Some("m") => "m/s",
        _ => "1/s",
    };
    let name = format!("{channel}_steadiness");
    let drift = format!("{channel}_drift{ending}_s");
    [
        Field::text(name, "steady, drifting or too_short, of the mean"),
        Field::number(drift, unit, "rate of change where it drifts"),
    ]
}

impl RunRow {
    /// A run without values.
    fn at(study: &Study, run: &Run) -> Self {
        let place = Place::of(study, run);
        Self {
            run: place.run,
            condition: place.condition,
            repeat: place.repeat,
            stream: run.stream,
            scenario: place.scenario,
            values: place.values,
            ..Self::default()
        }
    }

    /// The same run with the values of what it recorded.
    fn with_values(self, trace: &Trace) -> Self {
        let windows = trace.truth.iter().flat_map(|truth| &truth.class_windows);
        let count = |class| {
            let of_class = windows.clone().filter(|window| window.class == class);
            Some(of_class.count() as u64)
        };
        let acceleration = trace.channel("acceleration_y");
        Self {
            label: trace.attributes.terrain,
            class: trace.attributes.class,
            windows: CLASSES.map(count),
            duration: trace.duration().into(),
            steady: STEADY.map(|(name, _)| {
                let channel = trace.channel(name);
                Number::of_all(channel.and_then(|channel| mean_and_sd(channel.steady())))
            }),
            bands: BANDS.map(|band| {
                Number::of_all(acceleration.and_then(|channel| rms_and_crest(channel, band)))
            }),
            lug_pass: lug_pass_amplitude(trace).into(),
            steadiness: STEADY.map(|(name, _)| {
                let steadiness = trace.steadiness(name);
                Tested {
                    state: steadiness.map_or("", Steadiness::name).to_owned(),
                    rate: steadiness.and_then(Steadiness::rate).into(),
                }
            }),
            ..self
        }
    }
}

/// Mean and standard deviation of those samples that are numbers.
fn mean_and_sd(samples: &[f64]) -> Option<[f64; 2]> {
    let finite = || samples.iter().copied().filter(|x| x.is_finite());
    let n = finite().count() as f64;
    let mean = finite().sum::<f64>() / n;
    let variance = finite().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
    (n > 0.0).then(|| [mean, variance.sqrt()])
}

/// Amplitude of the vertical acceleration at the order of the lug pass [m/s²], over the whole lug
/// passes of the steady part: `2/Θ |∫ a exp(-i n_l θ) dθ|`. `None` where there are none.
fn lug_pass_amplitude(trace: &Trace) -> Option<f64> {
    let (acceleration, angle) = (
        trace.channel("acceleration_y")?,
        trace.channel("wheel_angle")?,
    );
    let (acceleration, angle) = (acceleration.steady(), angle.steady());
    let count = f64::from(trace.attributes.lug_count?);
    let pass = std::f64::consts::TAU / count;
    let passes = ((angle.last()? - angle.first()?).abs() / pass).floor();
    if acceleration.len() != angle.len() || count == 0.0 || passes < 1.0 {
        return None;
    }
    let within = |pair: &&[f64]| (pair[0] - angle[0]).abs() <= passes * pass;
    let steps = angle.windows(2).zip(acceleration);
    let [cosine, sine] =
        steps
            .filter(|(pair, _)| within(pair))
            .fold([0.0, 0.0], |[c, s], (pair, a)| {
                let (step, phase) = (pair[1] - pair[0], count * pair[0]);
                [
                    c + a * step * libm::cos(phase),
                    s + a * step * libm::sin(phase),
                ]
            });
    Some(2.0 / (passes * pass) * libm::hypot(cosine, sine))
}

/// Root mean square of the steady part of a channel in a band, and its crest factor [-].
fn rms_and_crest(channel: &Channel, band: Band) -> Option<[f64; 2]> {
    let filtered = Channel {
        samples: band.of(&channel.samples, channel.sample_rate)?,
        ..channel.clone()
    };
    let steady = filtered.steady();
    let square: f64 = steady.iter().map(|x| x * x).sum();
    let rms = (square / steady.len() as f64).sqrt();
    let peak = steady.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    Some([rms, peak / rms])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{SQRT_2, TAU};

    fn channel(samples: Vec<f64>) -> Channel {
        Channel {
            name: "acceleration_y".to_owned(),
            unit: "m/s^2".to_owned(),
            sample_rate: 2000.0,
            start: 0.0,
            samples,
        }
    }

    #[test]
    fn a_tone_has_rms_and_crest_of_a_sine_in_its_band_and_next_to_nothing_in_the_others() {
        let tone = |i| 3.0 * libm::sin(TAU * 63.0 * f64::from(i) / 2000.0);
        let channel = channel((0..16_000).map(tone).collect());
        let [rms, crest] = rms_and_crest(&channel, BANDS[1]).unwrap();
        // 1e-3: the corners' share of the amplitude at the middle of the band.
        assert!((rms * SQRT_2 / 3.0 - 1.0).abs() < 1e-3, "{rms}");
        assert!((crest / SQRT_2 - 1.0).abs() < 2e-3, "{crest}");
        for band in [BANDS[0], BANDS[2]] {
            let [rms, _] = rms_and_crest(&channel, band).unwrap();
            // 63 Hz lies 1.66 octaves above 20 Hz and below 200 Hz: 40 dB at fourth order.
            assert!(rms < 0.011 * 3.0 / SQRT_2, "{rms}");
        }
    }

    #[test]
    fn means_leave_gaps_out_and_nothing_has_no_mean() {
        let [mean, sd] = mean_and_sd(&[1.0, f64::NAN, 3.0]).unwrap();
        assert_eq!([mean, sd], [2.0, 1.0]);
        assert_eq!(mean_and_sd(&[f64::NAN]), None);
    }
}
