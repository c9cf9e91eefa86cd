//! Files that are no text tables, by their first bytes: each is named with what turns it into one.

/// A kind of file that is no text table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FileKind {
    /// What it is, with its article.
    pub(super) name: &'static str,
    /// What turns it into a text table.
    pub(super) way_out: &'static str,
}

const SHEET: &str = "save the sheet as CSV and name that file";
const UNPACK: &str = "unpack it and name the table inside; gzip alone is read as it is";
const MATLAB: &str = "write the table as CSV: writetable or writematrix in MATLAB, or \
                      scipy.io.loadmat and pandas' to_csv";
const PANDAS: &str = "write the table as CSV, for example with pandas' to_csv";
const BAG: &str = "export the topic as CSV: `ros2 topic echo --csv`, or rosbags and pandas";
const PAGE: &str = "download the raw file in place of the page that shows it";
const EXPORT: &str = "export the table as CSV with the program that wrote it";

/// First bytes of a file, and its kind.
const SIGNATURES: [(&[u8], FileKind); 27] = [
    (
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        kind("an old Excel workbook (.xls)", SHEET),
    ),
    (
        b"MATLAB 5.0 MAT-file",
        kind("a MATLAB 5 file (.mat)", MATLAB),
    ),
    (
        b"MATLAB 7.3 MAT-file",
        kind(
            "a MATLAB 7.3 file (.mat, HDF5 inside)",
            "write the table as CSV: writetable or writematrix in MATLAB, or h5py",
        ),
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        kind(
            "an HDF5 file",
            "write its table as CSV (h5py, pandas); a run file of this program needs no import",
        ),
    ),
    (b"PAR1", kind("a Parquet file", PANDAS)),
    (b"ARROW1", kind("an Arrow or Feather file", PANDAS)),
    (b"FEA1", kind("a Feather file", PANDAS)),
    (
        b"\x93NUMPY",
        kind("a NumPy array (.npy)", "write it with numpy.savetxt"),
    ),
    (b"\x80\x02", PICKLE),
    (b"\x80\x03", PICKLE),
    (b"\x80\x04", PICKLE),
    (b"\x80\x05", PICKLE),
    (
        b"SQLite format 3\0",
        kind(
            "an SQLite database",
            "export the table: sqlite3 -csv -header FILE 'select ...'",
        ),
    ),
    (b"#ROSBAG V", kind("a ROS bag", BAG)),
    (b"\x89MCAP", kind("an MCAP file", BAG)),
    (
        b"TDSm",
        kind(
            "a LabVIEW TDMS file",
            "export it as text from LabVIEW, or with npTDMS and pandas",
        ),
    ),
    (
        b"MDF     ",
        kind(
            "an MDF file of a data logger",
            "export it as CSV with the logger's program, or with asammdf",
        ),
    ),
    (b"BZh", kind("a bzip2 file", UNPACK)),
    (b"\xfd7zXZ\0", kind("an xz file", UNPACK)),
    (b"\x28\xb5\x2f\xfd", kind("a Zstandard file", UNPACK)),
    (b"7z\xbc\xaf\x27\x1c", kind("a 7z archive", UNPACK)),
    (b"Rar!", kind("a RAR archive", UNPACK)),
    (b"%PDF", kind("a PDF", EXPORT)),
    (b"{\\rtf", kind("a rich text document", EXPORT)),
    (b"\x89PNG", kind("a PNG image", EXPORT)),
    (
        b"version https://git-lfs",
        kind(
            "a pointer of Git LFS and not the data",
            "fetch the data with `git lfs pull`",
        ),
    ),
    (b"\xff\xfe\0\0", kind("UTF-32 text", "save it as UTF-8")),
];

const PICKLE: FileKind = kind("a Python pickle", PANDAS);
const ZIP: FileKind = kind("a zip archive", UNPACK);

/// What a zip archive names first, and what it then is.
const ZIPPED: [(&[u8], FileKind); 4] = [
    (
        b"opendocument.spreadsheet",
        kind("an OpenDocument sheet (.ods)", SHEET),
    ),
    (
        b"[Content_Types].xml",
        kind("an Excel workbook (.xlsx)", SHEET),
    ),
    (b"xl/", kind("an Excel workbook (.xlsx)", SHEET)),
    (
        b".npy",
        kind("NumPy arrays (.npz)", "write the array with numpy.savetxt"),
    ),
];

/// How texts of another kind begin, in small letters.
const MARKUP: [(&[u8], FileKind); 5] = [
    (b"<!doctype html", kind("an HTML page", PAGE)),
    (b"<html", kind("an HTML page", PAGE)),
    (b"<?xml", kind("an XML document", EXPORT)),
    (b"{", kind("JSON", PANDAS)),
    (b"[{", kind("JSON", PANDAS)),
];

const fn kind(name: &'static str, way_out: &'static str) -> FileKind {
    FileKind { name, way_out }
}

/// The kind of the file that begins with `head`; `None` where that may be a text table.
pub(super) fn of(head: &[u8]) -> Option<FileKind> {
    if head.starts_with(b"PK\x03\x04") {
        let named = ZIPPED.iter().find(|(name, _)| holds(head, name));
        return Some(named.map_or(ZIP, |(_, kind)| *kind));
    }
    if head.get(257..262) == Some(b"ustar") {
        return Some(kind("a tar archive", UNPACK));
    }
    let signed = SIGNATURES
        .iter()
        .find(|(signature, _)| head.starts_with(signature));
    if let Some((_, kind)) = signed {
        return Some(*kind);
    }
    let text = head.trim_ascii_start();
    let begins = |start: &[u8]| {
        let same = text.get(..start.len());
        same.is_some_and(|text| text.eq_ignore_ascii_case(start))
    };
    let markup = MARKUP.iter().find(|(start, _)| begins(start));
    markup.map(|(_, kind)| *kind)
}

fn holds(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_programs_are_named_by_their_first_bytes() {
        let mut tar = b"log.csv".to_vec();
        tar.resize(257, 0);
        tar.extend(b"ustar\0");
        let cases: [(&[u8], &str); 9] = [
            (
                b"PK\x03\x04\x14\0\x06\0\x08\0[Content_Types].xml",
                "an Excel workbook (.xlsx)",
            ),
            (
                b"PK\x03\x04\n\0\0\0mimetypeapplication/vnd.oasis.opendocument.spreadsheet",
                "an OpenDocument sheet (.ods)",
            ),
            (b"PK\x03\x04\x14\0arr_0.npy", "NumPy arrays (.npz)"),
            (b"PK\x03\x04\x14\0log.csv", "a zip archive"),
            (
                b"MATLAB 5.0 MAT-file, Platform: GLNXA64",
                "a MATLAB 5 file (.mat)",
            ),
            (
                b"MATLAB 7.3 MAT-file, Platform: GLNXA64",
                "a MATLAB 7.3 file (.mat, HDF5 inside)",
            ),
            (b"PAR1\x15\x04", "a Parquet file"),
            (b"\n <!DOCTYPE HTML>", "an HTML page"),
            (&tar, "a tar archive"),
        ];
        for (head, name) in cases {
            assert_eq!(of(head).map(|kind| kind.name), Some(name));
        }
    }

    #[test]
    fn a_table_of_text_is_of_no_other_kind() {
        for head in [
            "t,F\n0,1\n",
            "\u{feff}t;F\n",
            "# {rig}\nt,F\n",
            "%time,a\n",
            "",
            "[N],[m]\n",
        ] {
            assert_eq!(of(head.as_bytes()), None, "{head}");
        }
    }
}
