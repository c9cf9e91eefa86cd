//! What was done in a run: wheel, load, command, label.

use super::Misplaced;
use super::description::Given;
use super::sheet::{Header, Row};
use super::source::{Measure, Source};
use crate::quantity::{RangeError, SlipRatio};
use crate::trace::RunAttributes;
use crate::trace::wheel::{Lugs, Plate};
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::Error as NameError;

/// Most lugs of a measured wheel [-].
const MOST_LUGS: f64 = 1000.0;

/// Slopes [°] of measured tracks: no dry soil lies steeper.
const STEEPEST: [f64; 2] = [-45.0, 45.0];

/// Diameters and sides [m] of plates.
const PLATES: [f64; 2] = [0.001, 10.0];

/// Id, where one is given, and attributes of a run of time series.
pub(super) fn of_run(source: Source<'_>) -> Result<(Option<String>, RunAttributes), Misplaced> {
    Condition { source, row: None }.read()
}

/// Id, where one is given, and attributes of the run in a row.
pub(super) fn of_row(
    source: Source<'_>,
    header: &Header,
    row: &Row,
) -> Result<(Option<String>, RunAttributes), Misplaced> {
    let row = Some((header, row));
    Condition { source, row }.read()
}

/// A part of a campaign, with the row of its file for values given by columns.
struct Condition<'a> {
    source: Source<'a>,
    row: Option<(&'a Header, &'a Row)>,
}

impl Condition<'_> {
    fn read(&self) -> Result<(Option<String>, RunAttributes), Misplaced> {
        let id = self.text("id", self.source.table.id.as_ref())?;
        let id = Some(id).filter(|id| !id.is_empty());
        Ok((id, self.attributes()?))
    }

    fn attributes(&self) -> Result<RunAttributes, Misplaced> {
        let table = self.source.table;
        let wheel = &table.wheel;
        let positive = |quantity| move |x| RangeError::positive(quantity, "m", x);
        let within = |quantity, unit, range| move |x| RangeError::check(quantity, unit, x, range);
        let radius = within("wheel radius", "m", [0.01, 2.0]);
        let wheel_radius = self.number("wheel.radius_m", "m", &wheel.radius_m, radius)?;
        let load = within("load", "N", [0.0, f64::INFINITY]);
        let mass = within("wheel mass", "kg", [0.0, 1.0e4]);
        let slope = within("slope", "°", STEEPEST);
        let lugs = self.lugs(wheel_radius)?;
        Ok(RunAttributes {
            wheel_radius: known(wheel_radius),
            wheel_width: known(self.number(
                "wheel.width_m",
                "m",
                &wheel.width_m,
                positive("wheel width"),
            )?),
            lug_count: lugs.count,
            lug_height: lugs.height,
            lug_thickness: self.number(
                "wheel.lug_thickness_m",
                "m",
                &wheel.lug_thickness_m,
                within("lug thickness", "m", [0.0, 0.5]),
            )?,
            wheel_mass: self.number("wheel.mass_kg", "kg", &wheel.mass_kg, mass)?,
            plate: self.plate()?,
            slope_deg: self
                .number("slope_deg", "deg", &table.slope_deg, slope)?
                .unwrap_or(0.0),
            load: known(self.number("load_n", "N", &table.load_n, load)?),
            speed: known(self.speed("speed_m_s", &table.speed_m_s)?),
            slip_ratio: known(self.slip()?),
            terrain: self.name("terrain", &table.terrain)?,
            class: self.name("class", &table.class)?,
            repeat: self
                .count("repeat", &table.repeat, f64::from(u32::MAX))?
                .unwrap_or(0),
            day: self.text("day", table.day.as_ref())?,
            notes: self.text("notes", table.notes.as_ref())?,
            ..RunAttributes::default()
        })
    }

    /// The lugs of a wheel of this radius [m], as far as they are given.
    fn lugs(&self, wheel_radius: Option<f64>) -> Result<Lugs, Misplaced> {
        let wheel = &self.source.table.wheel;
        let highest = wheel_radius.unwrap_or(2.0);
        let within = |x| RangeError::check("lug height", "m", x, [0.0, highest]);
        let height = self.number("wheel.lug_height_m", "m", &wheel.lug_height_m, within)?;
        let count = self.count("wheel.lug_count", &wheel.lug_count, MOST_LUGS)?;
        Ok(Lugs::stated(count, known(height)))
    }

    /// The plate, by its diameter or by both sides.
    fn plate(&self) -> Result<Option<Plate>, Misplaced> {
        let table = self.source.table;
        let length = |key, given| {
            let within = |x| RangeError::check("plate", "m", x, PLATES);
            self.number(key, "m", given, within)
        };
        let diameter = length("plate_diameter_m", &table.plate_diameter_m)?;
        let sides = [
            length("plate_length_m", &table.plate_length_m)?,
            length("plate_width_m", &table.plate_width_m)?,
        ];
        let at = |key, message: &str| Err(self.source.fault(key, message));
        match (diameter, sides) {
            (None, [None, None]) => Ok(None),
            (Some(diameter), [None, None]) => Ok(Some(Plate::Disc { diameter })),
            (None, [Some(length), Some(width)]) => Ok(Some(Plate::rectangle([length, width]))),
            (Some(_), _) => at(
                "plate_diameter_m",
                "a plate is round or has two sides; keep the diameter or the sides",
            ),
            (None, [Some(_), None]) => at("plate_length_m", "give plate_width_m as well"),
            (None, [None, Some(_)]) => at("plate_width_m", "give plate_length_m as well"),
        }
    }

    /// The commanded slip, given or by the rim's speed.
    fn slip(&self) -> Result<Option<f64>, Misplaced> {
        let table = self.source.table;
        let range = |x| SlipRatio::new(x).map(SlipRatio::get);
        let slip = self.number("slip_ratio", "1", &table.slip_ratio, range)?;
        if table.rim_speed_m_s.is_none() {
            return Ok(slip);
        }
        let misfit = match (&table.slip_ratio, &table.speed_m_s) {
            (Some(_), _) => {
                Some("slip_ratio already determines the rim's speed; give one of the two")
            }
            (None, None) => Some(
                "the rim's speed determines the slip only together with speed_m_s; give that too",
            ),
            (None, Some(_)) => None,
        };
        if let Some(misfit) = misfit {
            return Err(self.source.fault("rim_speed_m_s", misfit));
        }
        let rim_speed = self.speed("rim_speed_m_s", &table.rim_speed_m_s)?;
        let forward = self.speed("speed_m_s", &table.speed_m_s)?;
        let slip = |(rim, forward)| SlipRatio::from_motion(1.0, rim, forward).get();
        Ok(rim_speed.zip(forward).map(slip))
    }

    fn speed(&self, key: &str, given: &Option<Given>) -> Result<Option<f64>, Misplaced> {
        let range = [-100.0, 100.0];
        let check = |x| RangeError::check("speed", "m/s", x, range);
        self.number(key, "m/s", given, check)
    }

    fn count(&self, key: &str, given: &Option<Given>, most: f64) -> Result<Option<u32>, Misplaced> {
        let whole = |x: f64| {
            if x.fract() == 0.0 && (0.0..=most).contains(&x) {
                Ok(x)
            } else {
                Err(RangeError {
                    quantity: "count",
                    unit: "-",
                    range: format!("a whole number from 0 to {most}"),
                    value: x,
                })
            }
        };
        let count = self.number(key, "1", given, whole)?;
        Ok(count.map(|count| count as u32))
    }

    /// A number that keeps `check`; `None` where it is not known.
    fn number(
        &self,
        key: &str,
        unit: &'static str,
        given: &Option<Given>,
        check: impl Fn(f64) -> Result<f64, RangeError>,
    ) -> Result<Option<f64>, Misplaced> {
        let at = |message: String| self.source.fault(key, message);
        let (value, place) = match given {
            None => return Ok(None),
            Some(Given::Number(value)) => (*value, String::new()),
            Some(Given::Text(text)) => {
                let message = format!(
                    "a number is needed, or the column that holds it: {{ column = {text:?} }}"
                );
                return Err(at(message));
            }
            Some(Given::Column(column)) => {
                let (header, row) = self.row(key)?;
                let name = key.rsplit('.').next().unwrap_or(key);
                let measure = Measure::attribute(name, unit, column, header).map_err(at)?;
                let value = measure.value(header, row).map_err(at)?;
                (value, format!("{}: ", header.place(row)))
            }
        };
        if value.is_nan() {
            return Ok(None);
        }
        let checked = check(value).map(Some);
        checked.map_err(|error| at(format!("{place}{error}")))
    }

    /// A text; empty where it is not known.
    fn text(&self, key: &str, given: Option<&Given>) -> Result<String, Misplaced> {
        let text = match given {
            None => String::new(),
            Some(Given::Text(text)) => text.clone(),
            Some(Given::Number(number)) => {
                let message = format!("a text is needed; write it in quotes: \"{number}\"");
                return Err(self.source.fault(key, message));
            }
            Some(Given::Column(column)) => {
                let (header, row) = self.row(key)?;
                let place = header.column(&column.column);
                let place = place.map_err(|message| self.source.fault(key, message))?;
                header.text(row, place)
            }
        };
        if text.contains('\0') {
            Err(self
                .source
                .fault(key, "a text must not hold a NUL character"))
        } else {
            Ok(text)
        }
    }

    /// A label or class; `None` where it is not known.
    fn name<T: for<'de> Deserialize<'de>>(
        &self,
        key: &str,
        given: &Option<Given>,
    ) -> Result<Option<T>, Misplaced> {
        let text = self.text(key, given.as_ref())?;
        if text.is_empty() {
            return Ok(None);
        }
        let name = T::deserialize(text.as_str().into_deserializer());
        name.map(Some).map_err(|error: NameError| {
            let choice = error.to_string();
            let choice = choice
                .split_once("expected ")
                .map_or("", |(_, choice)| choice);
            let message = format!("{key} must be {choice}, or left out, got {text:?}");
            self.source.fault(key, message)
        })
    }

    /// The row for values given by columns.
    fn row(&self, key: &str) -> Result<(&Header, &Row), Misplaced> {
        let message = "a [[run]] has one value here; columns of values belong to a [table]";
        self.row.ok_or_else(|| self.source.fault(key, message))
    }
}

/// A number, or `unknown`.
fn known(number: Option<f64>) -> f64 {
    number.unwrap_or(f64::NAN)
}
