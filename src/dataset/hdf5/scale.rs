//! Dimension scales: coordinates by which netCDF, xarray and MATLAB know the axis of a dataset.
//!
//! A scale is a dataset with `CLASS = "DIMENSION_SCALE"`, and with a `REFERENCE_LIST` of the datasets along it;
//! each of these names its scale in `DIMENSION_LIST`.

use super::writing::{set, set_text, table};
use crate::trace::{Channel, by_clock};
use ::hdf5::types::{FixedAscii, VarLenArray};
use ::hdf5::{
    Dataset, Datatype, Group, H5Type, Location, ObjectReference, ObjectReference1, Result,
};
use hdf5_sys::h5t::{H5T_STR_NULLTERM, H5Tset_strpad};
use std::collections::HashSet;

/// Value of `CLASS` of a scale.
const SCALE: &[u8] = b"DIMENSION_SCALE";

/// Bytes of [`SCALE`] and the NUL behind it.
const SCALE_SIZE: usize = SCALE.len() + 1;

/// Numbers [-] that take less space than the index of chunks that compressed ones need.
const SHORT: usize = 512;

/// An entry of `REFERENCE_LIST`: a dataset, and which of its dimensions.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct Along {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Writes the times of `channels`, which are in the group: one scale for all that share rate, start and length.
///
/// The scale of most channels is `time`, any other has the name of its first channel behind: `time_sinkage`. It
/// has the numbers of the samples, which compress to a hundredth; by the conventions of netCDF, time \[s\] is
/// `number * scale_factor + add_offset`.
pub(super) fn write_times(group: &Group, channels: &[Channel]) -> Result<()> {
    let mut taken: HashSet<String> = channels
        .iter()
        .map(|channel| channel.name.clone())
        .collect();
    for (index, shared) in by_clock(channels).into_iter().enumerate() {
        let mut name = match index {
            0 => "time".to_owned(),
            _ => format!("time_{}", shared[0].name),
        };
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        write_time(group, shared[0], &name)?;
        attach(group, &name, shared.iter().map(|channel| &*channel.name))?;
    }
    Ok(())
}

/// Writes the times of the samples of `channel`. Readers that take the scale for a channel find its rate and start,
/// and numbers without unit. With a ninth attribute HDF5 would store them all in 2 kB and more.
fn write_time(group: &Group, channel: &Channel, name: &str) -> Result<()> {
    let numbers: Vec<u32> = (0..).take(channel.samples.len()).collect();
    let builder = if numbers.len() < SHORT {
        group.new_dataset_builder().obj_track_times(false)
    } else {
        table(group, numbers.len())
    };
    let time = builder.with_data(&numbers).create(name)?;
    set_text(&time, "unit", "1")?;
    set(&time, "sample_rate_hz", channel.sample_rate)?;
    set(&time, "start_s", channel.start)?;
    set_text(&time, "units", "s")?;
    set(&time, "scale_factor", channel.sample_rate.recip())?;
    set(&time, "add_offset", channel.start)
}

/// Makes dataset `scale` of `group` the scale of others in it, each of one dimension.
pub(super) fn attach<'a>(
    group: &Group,
    scale: &str,
    others: impl Iterator<Item = &'a str>,
) -> Result<()> {
    let dataset = group.dataset(scale)?;
    let class = FixedAscii::<SCALE_SIZE>::from_ascii(SCALE).map_err(|error| error.to_string())?;
    let builder = dataset.new_attr_builder().empty_as(terminated_text()?);
    builder.create("CLASS")?.write_scalar(&class)?;
    let reference = ObjectReference1::create(group, scale)?;
    let mut along = Vec::new();
    for name in others {
        let list = [VarLenArray::from_slice(&[reference])];
        let builder = group.dataset(name)?.new_attr_builder();
        builder.with_data(&list).create("DIMENSION_LIST")?;
        along.push(Along {
            dataset: ObjectReference1::create(group, name)?,
            dimension: 0,
        });
    }
    if along.is_empty() {
        return Ok(());
    }
    let builder = dataset.new_attr_builder().with_data(&along);
    builder.create("REFERENCE_LIST").map(drop)
}

/// The type of `CLASS`: a text that ends with NUL, which HDF5 demands of a scale.
fn terminated_text() -> Result<Datatype> {
    let kind = Datatype::from_type::<FixedAscii<SCALE_SIZE>>()?;
    // SAFETY: `kind` is an open type of fixed-length text of this function alone, and the lock is that of all calls.
    #[expect(
        unsafe_code,
        reason = "the safe interface has only texts padded with NUL"
    )]
    let status = ::hdf5::sync::sync(|| unsafe { H5Tset_strpad(kind.id(), H5T_STR_NULLTERM) });
    if status < 0 {
        return Err("HDF5 refused a text that ends with NUL".into());
    }
    Ok(kind)
}

/// Whether a dataset is a scale.
pub(super) fn is_scale(dataset: &Dataset) -> bool {
    class(dataset).is_ok_and(|class| class.as_bytes() == SCALE)
}

fn class(location: &Location) -> Result<FixedAscii<SCALE_SIZE>> {
    location.attr("CLASS")?.read_scalar()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::Provenance;
    use crate::dataset::hdf5::{RunFile, RunFileWriter};
    use crate::trace::Trace;

    fn channel(name: &str, sample_rate: f64, start: f64) -> Channel {
        Channel {
            name: name.to_owned(),
            unit: "N".to_owned(),
            sample_rate,
            start,
            samples: vec![1.0, 2.0, 4.0],
        }
    }

    /// A file of one run with these channels.
    fn written(channels: Vec<Channel>) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.h5");
        let trace = Trace {
            channels,
            ..Trace::default()
        };
        let mut writer = RunFileWriter::create(&path, &Provenance::measured()).unwrap();
        writer.add("run", &trace).unwrap();
        writer.finish().unwrap();
        (folder, path)
    }

    #[test]
    fn channels_of_one_rate_start_and_length_share_a_time_and_the_largest_group_has_the_short_name()
    {
        let channels = vec![
            channel("sinkage", 10.0, 0.0),
            channel("normal_force", 2000.0, 0.5),
            channel("drawbar_pull", 2000.0, 0.5),
            channel("late", 2000.0, 0.6),
        ];
        let (_folder, path) = written(channels);
        let group = ::hdf5::File::open(&path)
            .unwrap()
            .group("runs/run/channels")
            .unwrap();
        let number = |scale: &str, name: &str| {
            let attribute = group.dataset(scale).unwrap().attr(name).unwrap();
            attribute.read_scalar::<f64>().unwrap()
        };
        assert_eq!(number("time", "scale_factor"), 1.0 / 2000.0);
        assert_eq!(number("time", "add_offset"), 0.5);
        assert_eq!(number("time_sinkage", "scale_factor"), 0.1);
        assert_eq!(number("time_late", "add_offset"), 0.6);
        let along = group
            .dataset("time")
            .unwrap()
            .attr("REFERENCE_LIST")
            .unwrap();
        let names = along.read_raw::<Along>().unwrap();
        let names = names
            .iter()
            .map(|along| match along.dataset.dereference(&group) {
                Ok(::hdf5::ReferencedObject::Dataset(dataset)) => dataset.name(),
                other => panic!("{other:?}"),
            });
        let below = "/runs/run/channels";
        let expected = [
            format!("{below}/normal_force"),
            format!("{below}/drawbar_pull"),
        ];
        assert_eq!(names.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_time_is_no_channel_but_a_channel_of_its_name_is() {
        let channels = vec![channel("sinkage", 10.0, 0.0), channel("time", 10.0, 0.0)];
        let (_folder, path) = written(channels.clone());
        let read = RunFile::open(&path).unwrap().read("run").unwrap();
        assert_eq!(read.channels, channels);
    }
}
