//! Resampling of uneven rows to an even rate by linear interpolation.
//!
//! Errors of linear interpolation: half way between rows a step `d` apart, an oscillation of frequency `f`
//! retains `cos(π f d)` of its amplitude: 5 % is lost at `f = 0.1/d`, 29 % at `0.25/d`. There is no
//! anti-aliasing filter: an oscillation faster than half the new rate is aliased. Between rows further apart
//! than the longest gap to bridge, three median steps unless the campaign has `longest_gap_s`, values are
//! NaN, as they are beside a row without a number. Of rows with equal times, up to a tenth of all, the last
//! is used. A wheel angle is unwrapped first: half way from 359° to 1° is 0° and not 180°.

use super::clock::{Times, short};

/// Longest gap that is bridged [median steps].
const BRIDGED: f64 = 3.0;

/// Loss of amplitude [-] at the frequency that is stated for it.
const LOSS: f64 = 0.05;

/// Largest number of values that come out of a channel for each row.
const MOST_PER_ROW: f64 = 100.0;

/// Largest share of rows that may have the time of the row before [-].
const EQUAL: f64 = 0.1;

/// Share of a step within which a time is that of a row.
const AT_ROW: f64 = 1.0e-6;

/// Even times, each between two rows.
#[derive(Debug)]
pub(super) struct Resampling {
    /// Values a second [Hz].
    pub(super) rate: f64,
    places: Vec<Place>,
    cost: Cost,
}

/// Where an even time lies among rows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// At a row.
    At(u32),
    /// After this row, by a share of the step to the next.
    After(u32, f32),
    /// In a gap.
    Gap,
}

/// What interpolation costs.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cost {
    interpolated: usize,
    missing: usize,
    /// Longest step bridged [s].
    bridged: f64,
    /// Longest step of all [s].
    longest: f64,
    /// Rows that have the time of the row before.
    equal: usize,
    /// Median step [s].
    median: f64,
}

impl Resampling {
    /// `rate` [Hz] from the first row on; steps above `longest_gap` [s] are gaps.
    ///
    /// # Errors
    /// Times that do not grow, or a rate at which a file would grow beyond measure, in words.
    pub(super) fn new(
        times: Times<'_>,
        rate: f64,
        longest_gap: Option<f64>,
    ) -> Result<Self, String> {
        times.check(EQUAL)?;
        let median = times.median_step();
        let longest_gap = longest_gap.unwrap_or(BRIDGED * median);
        // The last row is within reach in spite of rounding.
        let count = (times.span() * rate + AT_ROW).floor() + 1.0;
        let most = MOST_PER_ROW * times.rows.len() as f64;
        if count > most {
            return Err(format!(
                "{rate} Hz over {} s are {count} values for {} rows; a rate up to {} Hz makes sense",
                short(times.span()),
                times.rows.len(),
                short(most / times.span())
            ));
        }
        let mut cost = Cost {
            interpolated: 0,
            missing: 0,
            bridged: 0.0,
            longest: times.steps().fold(0.0, |most, step| most.max(step.time)),
            equal: times.equal_rows(),
            median,
        };
        let mut row = 0;
        let places = (0..count as usize).map(|i| {
            let place = place(times, &mut row, i as f64 / rate, longest_gap);
            cost.add(place, times);
            place
        });
        let places = places.collect();
        Ok(Self { rate, places, cost })
    }

    /// `samples` of the rows at the even times.
    pub(super) fn apply(&self, samples: &[f64]) -> Vec<f64> {
        let value = |place: &Place| match *place {
            Place::At(row) => samples[row as usize],
            Place::After(row, share) => {
                let (from, to) = (samples[row as usize], samples[row as usize + 1]);
                from + f64::from(share) * (to - from)
            }
            Place::Gap => f64::NAN,
        };
        self.places.iter().map(value).collect()
    }

    /// What it cost, in words.
    pub(super) fn note(&self) -> String {
        let Cost {
            interpolated,
            missing,
            bridged,
            longest,
            equal,
            median,
        } = self.cost;
        let share = |count: usize| 100.0 * count as f64 / self.places.len() as f64;
        let loses = (1.0 - LOSS).acos() / (std::f64::consts::PI * median);
        let gaps = match missing {
            0 => String::new(),
            _ => format!(
                "; {:.1} % left empty in gaps, the longest of {} s",
                share(missing),
                short(longest)
            ),
        };
        let equal = match equal {
            0 => String::new(),
            rows => format!("; {rows} rows left out, whose time the next row has too"),
        };
        format!(
            "resampled to {} Hz: {:.1} % of values interpolated over at most {} s{gaps}{equal}; \
             amplitudes lose up to {:.0} % at {} Hz and more above, and what oscillates faster \
             than {} Hz appears at a lower frequency",
            short(self.rate),
            share(interpolated),
            short(bridged),
            100.0 * LOSS,
            short(loses),
            short(0.5 * self.rate)
        )
    }
}

/// Where a time [s] lies among the rows from `row` on; steps above a longest one [s] are gaps.
fn place(times: Times<'_>, row: &mut usize, time: f64, longest: f64) -> Place {
    let rows = times.rows;
    let start = rows[0].time;
    while *row + 2 < rows.len() && rows[*row + 1].time - start <= time {
        *row += 1;
    }
    let step = rows[*row + 1].time - rows[*row].time;
    let share = (time - (rows[*row].time - start)) / step;
    match share {
        _ if step <= 0.0 => Place::At(*row as u32 + 1),
        share if share.abs() <= AT_ROW => Place::At(*row as u32),
        share if (share - 1.0).abs() <= AT_ROW || share > 1.0 => Place::At(*row as u32 + 1),
        _ if step > longest => Place::Gap,
        share => Place::After(*row as u32, share as f32),
    }
}

impl Cost {
    fn add(&mut self, place: Place, times: Times<'_>) {
        match place {
            Place::At(_) => {}
            Place::Gap => self.missing += 1,
            Place::After(row, _) => {
                let row = row as usize;
                self.interpolated += 1;
                let step = times.rows[row + 1].time - times.rows[row].time;
                self.bridged = self.bridged.max(step);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::clock::Stamp;
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn resampling(times: &[f64], rate: f64, gap: Option<f64>) -> Result<Resampling, String> {
        let rows = times.iter().copied().zip(2..);
        let rows: Vec<Stamp> = rows.map(|(time, line)| Stamp { time, line }).collect();
        let times = Times {
            file: "a.csv",
            origin: 0.0,
            count: 1.0,
            rows: &rows,
        };
        Resampling::new(times, rate, gap)
    }

    fn uneven(rows: u32) -> Vec<f64> {
        let time = |i: u32| f64::from(i) + 0.4 * (f64::from(i) * 2.4).sin();
        (0..rows).map(|i| time(i) - time(0)).collect()
    }

    #[test]
    fn a_straight_line_is_interpolated_exactly_and_rows_are_met() {
        let times = uneven(500);
        let line: Vec<f64> = times.iter().map(|time| 3.0 - 0.5 * time).collect();
        for rate in [0.3, 1.0, 7.0] {
            let even = resampling(&times, rate, None).unwrap();
            let values = even.apply(&line);
            assert_eq!(values.len(), (times[499] * rate).floor() as usize + 1);
            for (i, value) in values.iter().enumerate() {
                let expected = 3.0 - 0.5 * i as f64 / rate;
                assert!((value - expected).abs() < 1e-5, "{i}: {value}");
            }
        }
        let rows: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.01).collect();
        let same = resampling(&rows, 100.0, None).unwrap();
        assert_eq!(same.apply(&rows), rows);
        assert!(
            same.note().contains(" 0.0 % of values interpolated"),
            "{}",
            same.note()
        );
    }

    #[test]
    fn half_way_between_rows_an_oscillation_keeps_the_cosine_of_its_phase_step() {
        let times: Vec<f64> = (0..400).map(f64::from).collect();
        let frequency = 0.1;
        let wave: Vec<f64> = times.iter().map(|t| (TAU * frequency * t).sin()).collect();
        let halves = resampling(&times, 2.0, None).unwrap().apply(&wave);
        let between = halves
            .iter()
            .skip(1)
            .step_by(2)
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!((between - (PI * frequency).cos()).abs() < 1e-3, "{between}");
    }

    #[test]
    fn gaps_and_rows_without_a_number_stay_empty_and_are_counted() {
        let mut times: Vec<f64> = (0..100).map(f64::from).collect();
        times[50..].iter_mut().for_each(|time| *time += 10.0);
        let mut samples = times.clone();
        samples[20] = f64::NAN;
        let even = resampling(&times, 1.0, None).unwrap();
        let values = even.apply(&samples);
        let missing: Vec<usize> = (0..110).filter(|&i| values[i].is_nan()).collect();
        let expected: Vec<usize> = std::iter::once(20).chain(50..60).collect();
        assert_eq!(missing, expected);
        let note = even.note();
        assert!(
            note.contains("9.1 % left empty in gaps, the longest of 11 s"),
            "{note}"
        );
        let bridged = resampling(&times, 1.0, Some(12.0)).unwrap();
        assert!(bridged.apply(&times).iter().all(|value| value.is_finite()));
    }

    #[test]
    fn few_equal_stamps_are_passed_over_and_many_are_refused_as_is_a_rate_without_sense() {
        let mut times: Vec<f64> = (0..100).map(f64::from).collect();
        times[51] = times[50];
        times[99] = times[98];
        let even = resampling(&times, 1.0, None).unwrap();
        assert!(even.apply(&times).iter().all(|value| value.is_finite()));
        assert!(even.note().contains("2 rows left out"), "{}", even.note());
        let coarse: Vec<f64> = (0..100).map(|i| f64::from(i / 2)).collect();
        assert!(
            resampling(&coarse, 1.0, None)
                .unwrap_err()
                .contains("sample_rate_hz")
        );
        assert!(
            resampling(&times, 1.0e9, None)
                .unwrap_err()
                .contains("makes sense")
        );
    }
}
