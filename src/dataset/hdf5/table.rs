//! Tables as HDF5, a dataset for every column.
//!
//! ```text
//! /                  format = "lugwheel-table", format_version = 1, created_by, seed where simulated;
//!                    columns = their names in order
//! /columns/<name>    the first is the dimension scale of the others; whole numbers, numbers (NaN where there is none) or texts; unit, meaning
//! ```
//!
//! In Python: `xarray.open_dataset("table.h5", group="columns").to_dataframe()`.

use super::scale;
use super::writing::{begin, complete, group, set_text, table};
use super::{Outcome, RunFileError, reason};
use crate::dataset::Provenance;
use crate::dataset::records::{Field, Kind, Records};
use ::hdf5::types::VarLenUnicode;
use ::hdf5::{Dataset, File, Group, Result};
use std::path::Path;
use std::str::FromStr;

/// Value of `format` in a table's file.
pub(super) const FORMAT: &str = "lugwheel-table";

/// Writes a table to `path`; the file appears under that name when complete.
///
/// # Errors
/// `Write` where the folder does not exist, the disk is full, or a cell of a numeric column is no number.
pub fn write_table(
    path: impl AsRef<Path>,
    records: &Records,
    provenance: &Provenance,
) -> Outcome<()> {
    let target = path.as_ref();
    let (part, file) = begin(target, FORMAT, provenance)?;
    write_columns(&file, records).map_err(|error| RunFileError::write(target, reason(&error)))?;
    complete(file, part, target)
}

fn write_columns(file: &File, records: &Records) -> Result<()> {
    let names = records.fields.iter().map(|field| text(&field.name));
    let names = names.collect::<Result<Vec<VarLenUnicode>>>()?;
    let builder = file.new_attr_builder().with_data(&names);
    builder.create("columns")?;
    let columns = group(file, "columns")?;
    for (index, field) in records.fields.iter().enumerate() {
        let cells: Vec<&str> = records.rows.iter().map(|row| row[index].as_str()).collect();
        let dataset = write_column(&columns, field, &cells)?;
        set_text(&dataset, "unit", field.unit)?;
        set_text(&dataset, "meaning", field.meaning)?;
    }
    let mut names = records.fields.iter().map(|field| &*field.name);
    match names.next() {
        Some(first) => scale::attach(&columns, first, names),
        None => Ok(()),
    }
}

fn write_column(columns: &Group, field: &Field, cells: &[&str]) -> Result<Dataset> {
    let name = field.name.as_str();
    match field.kind {
        Kind::Whole => {
            let numbers = cells.iter().map(|cell| cell.parse::<i64>());
            let numbers = numbers.collect::<std::result::Result<Vec<i64>, _>>();
            let numbers = numbers.map_err(|error| format!("column {name}: {error}"))?;
            table(columns, cells.len()).with_data(&numbers).create(name)
        }
        Kind::Number => {
            let number = |cell: &&str| match *cell {
                "" => Ok(f64::NAN),
                cell => cell.parse::<f64>(),
            };
            let numbers = cells.iter().map(number);
            let numbers = numbers.collect::<std::result::Result<Vec<f64>, _>>();
            let numbers = numbers.map_err(|error| format!("column {name}: {error}"))?;
            table(columns, cells.len()).with_data(&numbers).create(name)
        }
        Kind::Text => {
            let texts = cells.iter().map(|cell| text(cell));
            let texts = texts.collect::<Result<Vec<VarLenUnicode>>>()?;
            // Texts of any length lie beside their dataset, where no filter reaches.
            let builder = columns.new_dataset_builder().obj_track_times(false);
            builder.with_data(&texts).create(name)
        }
    }
}

fn text(text: &str) -> Result<VarLenUnicode> {
    VarLenUnicode::from_str(text).map_err(|error| error.to_string().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    fn records() -> Records {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        Records {
            fields: vec![
                Field::whole("run", "number"),
                Field::number("rig.single_wheel.load", "N", "load"),
                Field::text("failure", "why"),
            ],
            rows: vec![row(["0", "100.5", ""]), row(["1", "", "left the track, µ"])],
        }
    }

    #[test]
    fn columns_have_types_units_and_order_and_the_same_table_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two] = ["one.h5", "two.h5"].map(|name| folder.path().join(name));
        let provenance = Provenance {
            seed: Some(Seed(5)),
            ..Provenance::measured()
        };
        write_table(&one, &records(), &provenance).unwrap();
        write_table(&two, &records(), &provenance).unwrap();
        assert_eq!(std::fs::read(&one).unwrap(), std::fs::read(&two).unwrap());
        let file = File::open(&one).unwrap();
        let names = file.attr("columns").unwrap().read_raw::<VarLenUnicode>();
        let names: Vec<String> = names.unwrap().iter().map(|name| name.to_string()).collect();
        assert_eq!(names, ["run", "rig.single_wheel.load", "failure"]);
        let column = |name: &str| file.dataset(&format!("columns/{name}")).unwrap();
        assert_eq!(column("run").read_raw::<i64>().unwrap(), [0, 1]);
        let loads = column("rig.single_wheel.load").read_raw::<f64>().unwrap();
        assert!(loads[0] == 100.5 && loads[1].is_nan());
        let failure = column("failure").read_raw::<VarLenUnicode>().unwrap();
        assert_eq!(failure[1].as_str(), "left the track, µ");
    }

    #[test]
    fn a_cell_that_is_no_number_is_refused_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.h5");
        let mut records = records();
        records.rows[0][1] = "heavy".to_owned();
        let error = write_table(&path, &records, &Provenance::measured()).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("column rig.single_wheel.load: invalid float"),
            "{message}"
        );
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
