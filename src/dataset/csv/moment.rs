//! Times in a table, at a precision beyond that of a double.
//!
//! A stamp of today in nanoseconds has 19 digits, a double 16: as a double, 1 kHz is lost in steps of 256 ns.
//! A cell is therefore stored as an integer and a fraction ([`Tick`]), and the time since the first row is a
//! difference of the two parts. Several columns of one row (seconds and nanoseconds, date and time of day)
//! are added by their differences.
//!
//! The kind of a cell is determined by its text, once for a column: a number; a date with time of day (ISO
//! 8601, UTC where it has no zone; other notations need `format`); hours, minutes and seconds, which restart
//! at midnight; or days and such a time, as in a pandas `Timedelta`.

use super::description::ColumnTable;
use super::number::{Content, is_missing};
use super::sheet::{Header, Row, shown};
use super::source::{Source, column_of, factor, finite};
use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::fmt::strtime;
use jiff::tz::TimeZone;

/// Nanoseconds in a second.
const NANO: f64 = 1.0e9;

/// Nanoseconds in a day.
const DAY: i64 = 86_400_000_000_000;

/// Largest integer that a double represents exactly.
const EXACT: f64 = 9.0e15;

/// A count of a clock: a whole number and what is left, of the same sign.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Tick {
    whole: i64,
    fraction: f64,
}

/// A time since the zero of its clock.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Origin {
    nanoseconds: i128,
    /// Beside whole nanoseconds [s].
    rest: f64,
}

impl Origin {
    /// This time [s], to the digits of a double.
    pub(super) fn seconds(self) -> f64 {
        self.since(Self::default())
    }

    /// Time since another [s].
    pub(super) fn since(self, other: Self) -> f64 {
        self.nanoseconds.saturating_sub(other.nanoseconds) as f64 / NANO + (self.rest - other.rest)
    }

    /// As a date where it counts from 1970, else in seconds.
    pub(super) fn text(self, is_date: bool) -> String {
        let date = Timestamp::from_nanosecond(self.nanoseconds).ok();
        match date.filter(|_| is_date) {
            Some(date) => date.to_string(),
            None if self.rest == 0.0 => {
                let (sign, size) = (
                    if self.nanoseconds < 0 { "-" } else { "" },
                    self.nanoseconds.unsigned_abs(),
                );
                let digits = format!("{}.{:09}", size / NANO as u128, size % NANO as u128);
                let digits = digits.trim_end_matches('0').trim_end_matches('.');
                format!("{sign}{digits} s of its clock")
            }
            None => format!("{} s of its clock", self.seconds()),
        }
    }
}

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Date { has_zone: bool },
    TimeOfDay,
    Days,
}

/// The times of rows, in one column or added from several.
pub(super) struct Moments {
    parts: Vec<Part>,
}

struct Part {
    name: String,
    column: usize,
    /// Seconds of a count.
    scale: f64,
    subtract: Tick,
    format: Option<String>,
    wraps_at: Option<i64>,
    kind: Option<Kind>,
    first: Option<Tick>,
    last: Tick,
    /// Counts of the starts from 0.
    wrapped: i128,
    /// Whether no other column is added.
    is_alone: bool,
}

impl Moments {
    /// The columns that `time_s` of a campaign names.
    ///
    /// # Errors
    /// Columns that are not there, units that measure no time, in words.
    pub(super) fn of(source: Source<'_>, header: &Header) -> Result<Self, String> {
        let mut parts: Vec<Part> = Vec::new();
        let mut next = Some(source.column("time_s")?);
        while let Some(column) = next {
            parts.push(Part::of(&column, header)?);
            next = column.add.as_deref().map(column_of).transpose()?;
        }
        let is_alone = parts.len() == 1;
        parts.iter_mut().for_each(|part| part.is_alone = is_alone);
        Ok(Self { parts })
    }

    /// Time [s] since the first row; NaN where a cell is empty.
    ///
    /// # Errors
    /// A cell that is no time, or another kind of time than the first, in words.
    pub(super) fn read(&mut self, header: &Header, row: &Row) -> Result<f64, String> {
        let mut time = 0.0;
        for part in &mut self.parts {
            time += part.read(header, row)?;
        }
        Ok(time)
    }

    /// Time of the first row.
    pub(super) fn origin(&self) -> Origin {
        self.parts.iter().fold(Origin::default(), |sum, part| {
            let Origin { nanoseconds, rest } = part.origin();
            Origin {
                nanoseconds: sum.nanoseconds.saturating_add(nanoseconds),
                rest: sum.rest + rest,
            }
        })
    }

    /// Whether the times are dates.
    pub(super) fn is_date(&self) -> bool {
        self.has(|kind| matches!(kind, Kind::Date { .. }))
    }

    /// Seconds of one count of the first column.
    pub(super) fn count(&self) -> f64 {
        self.parts[0].scale
    }

    /// What was taken for granted.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.has(|kind| kind == Kind::Date { has_zone: false }) {
            notes.push("times are dates without a zone, taken as UTC".to_owned());
        } else if self.is_date() {
            notes.push("times are dates".to_owned());
        }
        if self.has(|kind| kind == Kind::TimeOfDay) {
            notes.push("times are hours, minutes and seconds".to_owned());
        }
        if self.has(|kind| kind == Kind::Days) {
            notes.push("times are days, hours, minutes and seconds".to_owned());
        }
        for part in self.parts.iter().filter(|part| part.wrapped > 0) {
            notes.push(format!(
                "clock {:?} starts again from 0 and is continued",
                part.name
            ));
        }
        notes
    }

    fn has(&self, is: impl Fn(Kind) -> bool) -> bool {
        self.parts.iter().any(|part| part.kind.is_some_and(&is))
    }
}

impl Part {
    fn of(column: &ColumnTable, header: &Header) -> Result<Self, String> {
        let wraps_at = match column.wraps_at {
            Some(count) if !(count >= 2.0 && count.fract() == 0.0 && count < EXACT) => {
                return Err(format!(
                    "wraps_at must be a whole number above 1, got {count}"
                ));
            }
            count => count.map(|count| count as i64),
        };
        Ok(Self {
            name: column.column.clone(),
            column: header.column(&column.column)?,
            scale: factor(column, "time_s", Some("s"), header)?,
            subtract: Tick::of(finite("subtract", column.subtract.unwrap_or(0.0))?),
            format: column.format.clone(),
            wraps_at,
            kind: None,
            first: None,
            last: Tick::of(0.0),
            wrapped: 0,
            is_alone: true,
        })
    }

    fn read(&mut self, header: &Header, row: &Row) -> Result<f64, String> {
        let (text, content) = header.cell(row, self.column);
        if content == Content::Missing || is_missing(text) {
            return Ok(f64::NAN);
        }
        let read = match (content, &self.format) {
            (Content::Number(number), None) => Some((Tick::of_text(text, number), Kind::Number)),
            (_, Some(format)) => formatted(format, text),
            _ => date(text)
                .or_else(|| days(text))
                .or_else(|| time_of_day(text)),
        };
        let Some((tick, kind)) = read else {
            return Err(self.no_time(&header.place(row), text));
        };
        let first_kind = *self.kind.get_or_insert(kind);
        if first_kind != kind {
            return Err(format!(
                "{}: column {:?} holds {}, another kind of time than the rows before",
                header.place(row),
                self.name,
                shown(text)
            ));
        }
        if kind != Kind::Number && self.first.is_none() {
            self.scale = 1.0 / NANO;
            // A date beside it counts the days.
            let starts_again = kind == Kind::TimeOfDay && self.is_alone;
            let midnight = starts_again.then_some(DAY);
            self.wraps_at = self.wraps_at.or(midnight);
        }
        Ok(self.since_first(tick))
    }

    fn since_first(&mut self, tick: Tick) -> f64 {
        let first = *self.first.get_or_insert_with(|| {
            self.last = tick;
            tick
        });
        let fall = i128::from(self.last.whole) - i128::from(tick.whole);
        if let Some(count) = self.wraps_at
            && fall > i128::from(count / 2)
        {
            self.wrapped += i128::from(count);
        }
        self.last = tick;
        let whole = i128::from(tick.whole) - i128::from(first.whole) + self.wrapped;
        (whole as f64 + (tick.fraction - first.fraction)) * self.scale
    }

    fn no_time(&self, place: &str, text: &str) -> String {
        let way_out = match &self.format {
            Some(format) => format!("format = {format:?} does not read it"),
            None if text.contains("->") => {
                "a serial monitor's own time stands before ->; remove it".to_owned()
            }
            None if text.contains([':', '/', '-', '.']) => {
                "dates are read as 2024-05-03T10:00:00.5 with or without a zone; state another \
                 way of writing with format = \"%d.%m.%Y %H:%M:%S%.f\""
                    .to_owned()
            }
            None => "begin a line that is no data with #".to_owned(),
        };
        let cell = shown(text);
        format!(
            "{place}: column {:?} holds {cell}, which is no time; {way_out}",
            self.name
        )
    }

    fn origin(&self) -> Origin {
        let Some(first) = self.first else {
            return Origin::default();
        };
        let whole = i128::from(first.whole) - i128::from(self.subtract.whole);
        let fraction = first.fraction - self.subtract.fraction;
        let size = self.scale * NANO;
        if size >= 0.5 && (size - size.round()).abs() < 1.0e-9 * size {
            Origin {
                nanoseconds: whole.saturating_mul(size.round() as i128),
                rest: fraction * self.scale,
            }
        } else {
            Origin {
                nanoseconds: 0,
                rest: (whole as f64 + fraction) * self.scale,
            }
        }
    }
}

impl Tick {
    fn of(number: f64) -> Self {
        let whole = number.trunc();
        if whole.abs() < EXACT {
            Self {
                whole: whole as i64,
                fraction: number - whole,
            }
        } else {
            Self {
                whole: 0,
                fraction: number,
            }
        }
    }

    /// The number in `text`, which as a double is `number`.
    fn of_text(text: &str, number: f64) -> Self {
        let unsigned = text.trim_start_matches(['+', '-']);
        let (digits, fraction) = unsigned.split_once(['.', ',']).unwrap_or((unsigned, ""));
        let is_plain = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
        let whole: Option<i64> = digits.parse().ok();
        let Some(whole) = whole.filter(|_| is_plain(digits) && is_plain(fraction)) else {
            return Self::of(number);
        };
        let fraction = match fraction {
            "" => 0.0,
            digits => format!("0.{digits}").parse().unwrap_or(0.0),
        };
        if text.starts_with('-') {
            Self {
                whole: -whole,
                fraction: -fraction,
            }
        } else {
            Self { whole, fraction }
        }
    }

    fn nanoseconds(count: i128) -> Option<Self> {
        let whole = i64::try_from(count).ok()?;
        Some(Self {
            whole,
            fraction: 0.0,
        })
    }
}

/// A date with time of day, as ISO 8601 has it.
fn date(text: &str) -> Option<(Tick, Kind)> {
    if let Ok(stamp) = text.parse::<Timestamp>() {
        return dated(stamp, true);
    }
    let date = text.parse::<DateTime>().ok()?;
    dated(TimeZone::UTC.to_timestamp(date).ok()?, false)
}

/// A time written as `format` has it.
fn formatted(format: &str, text: &str) -> Option<(Tick, Kind)> {
    // A comma may be in place of the point of `%.f`.
    let parsed =
        strtime::parse(format, text).or_else(|_| strtime::parse(format, text.replace(',', ".")));
    let parsed = parsed.ok()?;
    if let Ok(stamp) = parsed.to_timestamp() {
        return dated(stamp, true);
    }
    let date = parsed
        .to_date()
        .map(|date| date.to_datetime(Time::midnight()));
    if let Ok(date) = parsed.to_datetime().or(date) {
        return dated(TimeZone::UTC.to_timestamp(date).ok()?, false);
    }
    let time = parsed.to_time().ok()?;
    let since_midnight = time.duration_since(Time::midnight());
    Some((
        Tick::nanoseconds(since_midnight.as_nanos())?,
        Kind::TimeOfDay,
    ))
}

fn dated(stamp: Timestamp, has_zone: bool) -> Option<(Tick, Kind)> {
    let tick = Tick::nanoseconds(stamp.as_nanosecond())?;
    Some((tick, Kind::Date { has_zone }))
}

/// Hours, minutes and seconds.
fn time_of_day(text: &str) -> Option<(Tick, Kind)> {
    let time = Tick::nanoseconds(clock_nanoseconds(text)?)?;
    Some((time, Kind::TimeOfDay))
}

/// Days and a time, such as `-1 days +23:59:59.5`.
fn days(text: &str) -> Option<(Tick, Kind)> {
    let (days, rest) = text.split_once(" day")?;
    let days: i64 = days.trim().parse().ok()?;
    let rest = rest.trim_start_matches('s').trim().trim_start_matches('+');
    let time = match rest {
        "" => 0,
        time => clock_nanoseconds(time)?,
    };
    let whole = i128::from(days) * i128::from(DAY) + time;
    Some((Tick::nanoseconds(whole)?, Kind::Days))
}

/// Nanoseconds of `hours:minutes:seconds.fraction`.
fn clock_nanoseconds(text: &str) -> Option<i128> {
    let mut parts = text.splitn(3, ':');
    let mut count = || {
        let part = parts.next()?;
        let is_count = !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        part.parse::<u32>().ok().filter(|_| is_count)
    };
    let (hours, minutes) = (count()?, count()?);
    let seconds = parts.next()?.replace(',', ".");
    let starts_with_digit = seconds.starts_with(|c: char| c.is_ascii_digit());
    let number: f64 = seconds.parse().ok().filter(|_| starts_with_digit)?;
    let Tick { whole, fraction } = Tick::of_text(&seconds, number);
    if minutes >= 60 || whole >= 60 {
        return None;
    }
    let whole = (i128::from(hours) * 60 + i128::from(minutes)) * 60 + i128::from(whole);
    Some(whole * NANO as i128 + (fraction * NANO).round() as i128)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nanoseconds(read: Option<(Tick, Kind)>) -> Option<i64> {
        read.map(|(tick, _)| tick.whole)
    }

    #[test]
    fn a_stamp_in_nanoseconds_keeps_all_its_digits() {
        let tick = |text: &str| Tick::of_text(text, text.parse().unwrap());
        assert_eq!(tick("1714730400123456789").whole, 1_714_730_400_123_456_789);
        let [whole, fraction] = [1_614_701_841.0, 0.43639];
        let stamp = tick("1614701841.43639");
        assert_eq!((stamp.whole as f64, stamp.fraction), (whole, fraction));
        let negative = tick("-2.25");
        assert_eq!((negative.whole, negative.fraction), (-2, -0.25));
        assert_eq!(
            tick("5.0e-03"),
            Tick {
                whole: 0,
                fraction: 0.005
            }
        );
        assert_eq!(tick("2.5e3").whole, 2500);
    }

    #[test]
    fn dates_are_read_with_and_without_zone_and_in_stated_formats() {
        let expected = Some(1_714_730_400_010_000_000);
        for text in [
            "2024-05-03 10:00:00.010",
            "2024-05-03T10:00:00.010Z",
            "2024-05-03 12:00:00.010+02:00",
            "2024-05-03T10:00:00,010",
        ] {
            assert_eq!(nanoseconds(date(text)), expected, "{text}");
        }
        let cases = [
            ("%d.%m.%Y %H:%M:%S%.f", "03.05.2024 10:00:00.010"),
            ("%m/%d/%Y %I:%M:%S%.f %p", "05/03/2024 10:00:00.010 AM"),
        ];
        for (format, text) in cases {
            assert_eq!(nanoseconds(formatted(format, text)), expected, "{text}");
        }
        assert_eq!(date("03.05.2024 10:00:00"), None);
        assert_eq!(date("10:00:00"), None);
    }

    #[test]
    fn durations_of_pandas_and_times_of_day_are_counted_in_nanoseconds() {
        assert_eq!(
            nanoseconds(days("0 days 00:00:00.010000")),
            Some(10_000_000)
        );
        assert_eq!(nanoseconds(days("1 days")), Some(DAY));
        assert_eq!(
            nanoseconds(days("-1 days +23:59:59.990000")),
            Some(-10_000_000)
        );
        assert_eq!(
            nanoseconds(time_of_day("23:59:59.5")),
            Some(DAY - 500_000_000)
        );
        assert_eq!(
            nanoseconds(time_of_day("123:10:00")),
            Some(443_400_000_000_000)
        );
        for text in [
            "12:30", "1:2:3:4", "a:b:c", "00:61:00", "::", "1:2:-3", "1:2:nan",
        ] {
            assert_eq!(time_of_day(text), None, "{text}");
        }
    }
}
