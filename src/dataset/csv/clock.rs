//! Whether the rows of a log are equally spaced, by their times.
//!
//! A channel has one rate, so the times `t_i` of rows must be put on a grid `t_0 + i T`. The permitted
//! treatment depends on the kind of deviations from it.
//!
//! **Even** (samples stay as they are). Departures from the least squares line of time on row
//! number lie within a fifth of a period, all of them. They do not add up: the rows are even and
//! their stamps rounded (300 Hz to the millisecond: 15 %) or read a little late. A missing row
//! moves all later times by a whole period, which leaves half a period at the gap whatever line is
//! drawn, so that one lost row among any number is found.
//!
//! **Wandering** (interpolated to the mean rate, with a note). Departures add up to more, but every
//! step lies within a fifth of the median (median) one. Stamps of even rows cannot do so: their
//! errors would have to grow from row to row. It is the sampling that wanders, as of a timer that
//! starts anew after each row's work, or of a quartz that warms up; the times are right and the
//! values between rows are interpolated. A lost row makes one step of twice the median.
//!
//! **Equal** stamps come from a clock too coarse for the rows, or from rows delivered together by a buffer
//! (FIFO). The times of single rows are then unknown; the rate follows from the slope of the line. Rejected,
//! with that rate as the remedy.
//!
//! **Uneven** is the rest: lost rows, or a host's clock that stamps rows on processing. Rejected, with
//! `resample_hz` as the remedy, or `sample_rate_hz` where the rows are in fact even.
//!
//! A clock whose second is constantly too long or too short cannot be detected here.
use crate::statistics::upper_median;

/// Tolerance [periods] of a time about an even grid, and of a step about the median one.
pub(super) const FIFTH: f64 = 0.2;

/// Departure [periods] below which nothing is noted: rounding of printed times.
const SILENT: f64 = 0.02;

/// How far [-] a rate from times may lie off one of fewer digits that it is taken for.
const NEAR: f64 = 1.0e-6;

/// Longest step [median steps] at which no row is missing.
pub(super) const LOST: f64 = 1.5;

/// Standard errors of a rate within which a rounder number is offered for it.
const SURE: f64 = 3.0;

/// The times of a file's rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Times<'a> {
    pub(super) file: &'a str,
    /// Time of the first row [s] by the file's clock.
    pub(super) origin: f64,
    /// Seconds of one count of the clock.
    pub(super) count: f64,
    pub(super) rows: &'a [Stamp],
}

/// The time of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stamp {
    /// Since the first row [s].
    pub(super) time: f64,
    /// In the file.
    pub(super) line: u64,
}

/// What may be done with the times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// Rows are even to within `off` [periods].
    Even {
        /// Rows a second [Hz].
        rate: f64,
        /// Largest departure [periods].
        off: f64,
    },
    /// Steps are alike to within a fifth, but departures add up.
    Wandering {
        /// Mean rate [Hz].
        rate: f64,
        /// Largest departure [s].
        off: f64,
        /// Largest relative difference of a step from the median [-].
        step: f64,
    },
}

/// A straight line through times over row numbers.
#[derive(Debug, Clone, Copy)]
struct Line {
    period: f64,
    /// Time of row 0.
    start: f64,
    /// Standard error of the period.
    error: f64,
}

impl Clock {
    /// # Errors
    /// Times that are no clock of equally spaced rows: file, line, criterion and way out.
    pub(super) fn of(times: Times<'_>) -> Result<Self, String> {
        times.check(0.0)?;
        let line = times.line();
        let median = times.median_step();
        let steps = times.steps();
        let step = steps.map(|step| (step.time / median - 1.0).abs());
        let step = step.fold(0.0, f64::max);
        let off = times.farthest_off(line).time;
        let rate = meant(1.0 / line.period, times.rows.len());
        let is_rate = rate.is_finite() && rate > 0.0;
        if is_rate && off <= FIFTH * line.period {
            return Ok(Self::Even {
                rate,
                off: off / line.period,
            });
        }
        if is_rate && step <= FIFTH {
            let mean = (times.rows.len() - 1) as f64 / times.span();
            return Ok(Self::Wandering {
                rate: meant(mean, times.rows.len()),
                off,
                step,
            });
        }
        Err(times.uneven(line, median))
    }

    /// What is to be noted of it.
    pub(super) fn note(self) -> Option<String> {
        match self {
            Self::Even { off, .. } if off < SILENT => None,
            Self::Even { rate, off } => Some(format!(
                "times lie up to {:.0} % of a period off {} Hz: rows taken as even",
                100.0 * off,
                short(rate)
            )),
            Self::Wandering { rate, off, step } => Some(format!(
                "the clock wanders: steps differ by up to {:.1} %, times run up to {} s off an \
                 even grid; values interpolated to {} Hz",
                100.0 * step,
                short(off),
                short(rate)
            )),
        }
    }
}

impl Times<'_> {
    /// Refuses what is no growing series of times; a share of `equal` [-] of the rows may have the
    /// time of the row before.
    pub(super) fn check(&self, equal: f64) -> Result<(), String> {
        let Self { file, rows, .. } = self;
        if rows.len() < 2 {
            let way_out = "give sample_rate_hz instead of time_s";
            return Err(format!(
                "one row of {file} does not determine a rate; {way_out}"
            ));
        }
        if let Some(Stamp { line, .. }) = rows.iter().find(|row| !row.time.is_finite()) {
            return Err(format!(
                "{file}:{line}: this row has no time; leave it out with # before it, or give \
                 sample_rate_hz instead of time_s"
            ));
        }
        let back = rows.windows(2).find(|pair| pair[1].time < pair[0].time);
        if let Some([before, after]) = back {
            return Err(self.backward(*before, *after));
        }
        match rows.windows(2).find(|pair| pair[1].time == pair[0].time) {
            Some([_, second]) if self.equal_rows() as f64 > equal * rows.len() as f64 => {
                Err(self.equal(*second))
            }
            _ => Ok(()),
        }
    }

    /// Number of rows that have the time of the row before.
    pub(super) fn equal_rows(&self) -> usize {
        self.steps().filter(|step| step.time == 0.0).count()
    }

    /// Times between rows [s], with the later row's line.
    pub(super) fn steps(&self) -> impl Iterator<Item = Stamp> {
        let pairs = self.rows.windows(2);
        pairs.map(|pair| Stamp {
            time: pair[1].time - pair[0].time,
            line: pair[1].line,
        })
    }

    /// Median step [s].
    pub(super) fn median_step(&self) -> f64 {
        upper_median(self.steps().map(|step| step.time)).unwrap_or(f64::NAN)
    }

    /// Time from the first row to the last [s].
    pub(super) fn span(&self) -> f64 {
        let end = |row: Option<&Stamp>| row.map_or(0.0, |row| row.time);
        end(self.rows.last()) - end(self.rows.first())
    }

    /// The least squares line of time on row number.
    fn line(&self) -> Line {
        let count = self.rows.len() as f64;
        let middle = 0.5 * (count - 1.0);
        let mean = self.rows.iter().map(|row| row.time).sum::<f64>() / count;
        let about = |(i, row): (usize, &Stamp)| (i as f64 - middle, row.time - mean);
        let rows = || self.rows.iter().enumerate().map(about);
        let spread = count * (count * count - 1.0) / 12.0;
        let period = rows().map(|(x, y)| x * y).sum::<f64>() / spread;
        let squares = rows().map(|(x, y)| (y - period * x).powi(2)).sum::<f64>();
        let variance = squares / (count - 2.0).max(1.0);
        Line {
            period,
            start: mean - period * middle,
            error: (variance / spread).sqrt(),
        }
    }

    /// Largest departure from `line` [s], and its line in the file.
    fn farthest_off(&self, line: Line) -> Stamp {
        let off = |(i, row): (usize, &Stamp)| Stamp {
            time: (row.time - line.start - i as f64 * line.period).abs(),
            line: row.line,
        };
        let rows = self.rows.iter().enumerate().map(off);
        let none = Stamp { time: 0.0, line: 0 };
        rows.fold(
            none,
            |most, row| if row.time > most.time { row } else { most },
        )
    }

    fn backward(&self, before: Stamp, after: Stamp) -> String {
        let (before, Stamp { time, line }) = (before.time, after);
        let Self { file, origin, .. } = self;
        let counts = (before - time) / self.count;
        let bits = [16, 24, 31, 32, 48].into_iter().find(|bits| {
            let size = f64::exp2(f64::from(*bits));
            counts <= size && counts > 0.9 * size
        });
        let counter = match bits {
            Some(bits) => format!(
                "; a counter of {bits} bits that starts again needs wraps_at = {} in time_s",
                1_u64 << bits
            ),
            None => String::new(),
        };
        format!(
            "{file}:{line}: time {} s follows {} s; times must grow. If the file holds several \
             runs, pick one with rows = {{ ... }}; if its rows are out of order, sort them{counter}",
            origin + time,
            origin + before
        )
    }

    /// Rows that share a stamp, in words.
    fn equal(&self, row: Stamp) -> String {
        let Stamp { time, line } = row;
        let Self {
            file, origin, rows, ..
        } = self;
        let shared = self.equal_rows();
        let finest = self
            .steps()
            .map(|step| step.time)
            .filter(|step| *step > 0.0)
            .fold(f64::INFINITY, f64::min);
        let stamps = rows.len() - shared;
        let fit = self.line();
        let rate = 1.0 / fit.period;
        if !(finest.is_finite() && rate.is_finite()) {
            return format!(
                "{file}:{line}: all rows have the time {} s; if another column holds the rest of it, \
                 join that: add = {{ column = \"...\", unit = \"...\" }} in time_s; else give \
                 sample_rate_hz instead of time_s",
                origin + time
            );
        }
        let batch = rows.len() as f64 / stamps as f64;
        let cause = if batch >= 4.0 {
            format!("rows come in batches of {batch:.1} on average, as out of a buffer")
        } else {
            format!("the clock counts in steps of {} s", short(finest))
        };
        let error = SURE * fit.error / fit.period * rate;
        let half = 0.5 * error.max(1.0e-9 * rate);
        format!(
            "{file}:{line}: {shared} of {} rows have the same time as the row before, first at \
             {} s: {cause}. Together the rows make {} Hz (within {}): give sample_rate_hz = {} \
             instead of time_s",
            rows.len(),
            origin + time,
            short(rate),
            short(error),
            roundest(rate, half),
        )
    }

    /// The row whose step differs most from the median, with the requirement in words.
    fn uneven(&self, line: Line, median: f64) -> String {
        let file = self.file;
        let off = |step: f64| (step - median).abs();
        let even = Stamp {
            time: median,
            line: 0,
        };
        let worst = self.steps().fold(even, |most, step| {
            if off(step.time) > off(most.time) {
                step
            } else {
                most
            }
        });
        let Stamp {
            time: worst,
            line: at,
        } = worst;
        let Stamp {
            time: most,
            line: where_most,
        } = self.farthest_off(line);
        let rate = roundest(1.0 / median, 0.01 / median);
        let lost = (worst / median - 1.0).round();
        let lost_rows = if worst <= LOST * median {
            String::new()
        } else if lost > 1.0 {
            format!(", as if {lost} rows were lost")
        } else {
            ", as if a row were lost".to_owned()
        };
        format!(
            "{file}:{at}: {worst:.6} s after the row before, {median:.6} s elsewhere{lost_rows}; \
             rows must be equally spaced: every step within a fifth of the median one (here {:.0} \
             % off), or every time within a fifth of a period of an even grid (here {:.2} periods \
             at line {where_most}). resample_hz = {rate} interpolates them to an even rate; where \
             the rows are even and only their times are not, give sample_rate_hz = {rate} instead \
             of time_s",
            100.0 * off(worst) / median,
            most / line.period,
        )
    }
}

/// The nominal rate behind rounded times of `rows` rows: of few digits, where one is so near that over all
/// rows the deviation adds up to no more than a twentieth of a period.
fn meant(rate: f64, rows: usize) -> f64 {
    let near = NEAR.min(0.05 / rows as f64);
    roundest(rate, near * rate.abs())
}

/// The number of fewest digits within `error` of `value`.
fn roundest(value: f64, error: f64) -> f64 {
    let size = value.abs().log10().floor() as i32;
    let rounded = |digits: i32| {
        let unit = digits - 1 - size;
        let text = if unit >= 0 {
            format!("{value:.*}", unit as usize)
        } else {
            let scale = 10_f64.powi(-unit);
            format!("{}", (value / scale).round() * scale)
        };
        text.parse().unwrap_or(value)
    };
    let fits = |number: &f64| (number - value).abs() <= error;
    (1..=12).map(rounded).find(fits).unwrap_or(value)
}

/// A number to three digits or more.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        value.to_string()
    } else {
        roundest(value, 5.0e-4 * value.abs()).to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(times: impl Iterator<Item = f64>) -> Vec<Stamp> {
        let rows = times.zip(2..);
        rows.map(|(time, line)| Stamp { time, line }).collect()
    }

    fn clock(rows: &[Stamp]) -> Result<Clock, String> {
        Clock::of(Times {
            file: "a.csv",
            origin: 0.0,
            count: 1.0e-6,
            rows,
        })
    }

    fn even_rate(rows: &[Stamp]) -> f64 {
        match clock(rows) {
            Ok(Clock::Even { rate, .. }) => rate,
            other => panic!("{other:?}"),
        }
    }

    /// Pseudorandom numbers evenly spread in [-1, 1].
    fn scattered(i: u32) -> f64 {
        let phase = f64::from(i) * 0.618_033_988_749_895;
        2.0 * (phase - phase.floor()) - 1.0
    }

    #[test]
    fn a_rate_is_read_from_rounded_times_and_is_whole_where_it_can_be() {
        let rounded = |rate: f64, digits: f64| {
            let times = (0..3_000).map(|i| (f64::from(i) / rate * digits).round() / digits);
            even_rate(&stamps(times))
        };
        assert_eq!(rounded(500.0, 1.0e3), 500.0);
        // 300 Hz to the millisecond: errors of up to 0.5 ms over 3000 rows of 10 s.
        let rate = rounded(300.0, 1.0e3);
        assert!((rate / 300.0 - 1.0).abs() < 1.0e-6, "{rate}");
        assert_eq!(
            even_rate(&stamps((0..100).map(|i| f64::from(i) * 0.05))),
            20.0
        );
    }

    #[test]
    fn one_row_missing_among_thousands_is_found_wherever_it_is() {
        for missing in [1, 700, 2_500, 4_998] {
            let times = (0..5_000).filter(|i| *i != missing);
            let error = clock(&stamps(times.map(|i| f64::from(i) * 0.002))).unwrap_err();
            let place = format!("a.csv:{}: 0.004000 s after", missing + 2);
            assert!(error.starts_with(&place), "{error}");
            assert!(error.contains("as if a row were lost"), "{error}");
        }
    }

    #[test]
    fn a_jitter_that_does_not_add_up_is_even_to_a_fifth_of_a_period() {
        let jittered = |share: f64| {
            let time = |i: u32| f64::from(i) + share * scattered(i);
            clock(&stamps((0..2_000).map(time)))
        };
        for share in [0.05, 0.19] {
            let Ok(Clock::Even { rate, off }) = jittered(share) else {
                panic!("{share}");
            };
            assert!(
                (rate - 1.0).abs() < 1e-5 && (off - share).abs() < 0.01,
                "{off}"
            );
        }
        let error = jittered(0.3).unwrap_err();
        assert!(error.contains("(here 0.30 periods"), "{error}");
    }

    #[test]
    fn a_clock_whose_steps_are_alike_and_whose_times_run_off_wanders() {
        // A period that drifts by 1 %, one that is drawn anew for each row, and one that slows by 15 %.
        let drifting = |i: u32| 0.005 * (1.0 + 0.01 * (f64::from(i) / 300.0).sin());
        let drawn = |i: u32| 0.03 * (1.0 + 0.1 * (scattered(i) + scattered(i / 50)));
        let slowing = |i: u32| 0.01 * (1.0 + 0.15 * f64::from(i) / 4_000.0);
        for step in [&drifting as &dyn Fn(u32) -> f64, &drawn, &slowing] {
            let mut time = 0.0;
            let times = (0..4_000).map(|i| {
                time += step(i);
                time
            });
            let rows = stamps(times);
            let Ok(Clock::Wandering { rate, step, .. }) = clock(&rows) else {
                panic!("{:?}", clock(&rows));
            };
            let mean = 3_999.0 / (rows[3_999].time - rows[0].time);
            assert!((rate / mean - 1.0).abs() < 1e-6 && step <= 0.2);
        }
    }

    #[test]
    fn equal_stamps_of_a_coarse_clock_and_of_a_buffer_make_the_rate_that_is_offered() {
        let coarse = stamps((0..400).map(|i| (f64::from(i) / 1.6).floor() * 1e-3));
        let error = clock(&coarse).unwrap_err();
        assert!(
            error.contains("the clock counts in steps of 0.001 s"),
            "{error}"
        );
        assert!(
            error.contains("give sample_rate_hz = 1600 instead"),
            "{error}"
        );
        let buffered = stamps((0..3_200).map(|i| f64::from(i / 32) * 0.02));
        let error = clock(&buffered).unwrap_err();
        assert!(error.contains("batches of 32.0"), "{error}");
        assert!(
            error.contains("give sample_rate_hz = 1600 instead"),
            "{error}"
        );
        let all = clock(&stamps((0..5).map(|_| 3.0))).unwrap_err();
        assert!(all.contains("all rows have the time 3 s"), "{all}");
    }

    #[test]
    fn times_that_fall_or_are_missing_are_refused_at_their_line() {
        let counter = |i: u32| f64::from((4_294_960_000_u32).wrapping_add(i * 1000)) * 1e-6;
        let cases = [
            (vec![0.0, 1.0, 0.5], "a.csv:4: time 0.5 s follows 1 s"),
            (vec![0.0, f64::NAN, 2.0], "a.csv:3: this row has no time"),
            (vec![0.0], "one row of a.csv does not determine a rate"),
            (vec![], "one row of a.csv"),
        ];
        for (times, message) in cases {
            let error = clock(&stamps(times.into_iter())).unwrap_err();
            assert!(error.starts_with(message), "{error}");
        }
        let error = clock(&stamps((0..20).map(counter))).unwrap_err();
        assert!(
            error.contains("needs wraps_at = 4294967296 in time_s"),
            "{error}"
        );
    }

    #[test]
    fn a_number_is_rounded_no_further_than_it_is_sure() {
        assert_eq!(roundest(1599.7, 1.0), 1600.0);
        assert_eq!(roundest(1599.7, 0.1), 1599.7);
        assert_eq!(roundest(33.172, 0.01), 33.17);
        assert_eq!(short(0.026_004), "0.026");
        assert_eq!(short(1.0e-7), "0.0000001");
        assert_eq!(short(0.0), "0");
    }
}
