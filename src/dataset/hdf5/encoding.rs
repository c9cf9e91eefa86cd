//! How samples are stored, where this program's HDF5 cannot read it.

use ::hdf5::filters::Filter;
use ::hdf5::{Container, Dataset};

/// A form of samples that cannot be read, and what to do.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unreadable {
    pub(super) found: String,
    pub(super) way_out: &'static str,
}

/// The filter of a dataset that this HDF5 lacks, if there is one.
pub(super) fn missing_filter(dataset: &Dataset) -> Option<Unreadable> {
    let filters = dataset.filters();
    let missing = filters.iter().find(|filter| !filter.is_available())?;
    Some(Unreadable {
        found: format!(
            "compressed by {}, a filter that this HDF5 lacks",
            name(missing)
        ),
        way_out: "write it with gzip (in h5py compression=\"gzip\"), or where that filter is installed \
                  run `h5repack -f GZIP=1 OLD.h5 NEW.h5`",
    })
}

/// Name of a filter, as the HDF Group registers it.
fn name(filter: &Filter) -> String {
    const REGISTERED: [(i32, &str); 10] = [
        (4, "szip"),
        (307, "bzip2"),
        (32000, "lzf"),
        (32001, "blosc"),
        (32004, "lz4"),
        (32008, "bitshuffle"),
        (32013, "zfp"),
        (32015, "zstd"),
        (32017, "sz"),
        (32026, "blosc2"),
    ];
    let id = filter.id();
    let known = REGISTERED.iter().find(|(number, _)| *number == id);
    known.map_or_else(|| format!("filter {id}"), |(_, name)| (*name).to_owned())
}

/// A size of floating point numbers that is not read, if `container` has it.
pub(super) fn odd_float(container: &Container) -> Option<Unreadable> {
    let kind = container.dtype().ok()?;
    let bits = 8 * kind.size();
    let is_float = kind.is::<f32>() || kind.is::<f64>();
    let is_described = kind.to_descriptor().is_ok();
    (!is_float && !is_described && [16, 80, 96, 128].contains(&bits)).then(|| Unreadable {
        found: format!("floating point numbers of {bits} bits"),
        way_out: "write them as 32 or 64 bits (in numpy .astype(\"float32\"))",
    })
}
