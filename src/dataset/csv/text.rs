//! The text of a table, whatever it is packed and encoded in.
//!
//! A file is read as a stream: what is in memory does not grow with it. By its first bytes, gzip
//! is unpacked; a byte order mark decides between UTF-8, UTF-16 of either order; without one, text
//! whose every other byte is 0 is UTF-16. Everything else is UTF-8 unless the campaign names its
//! `encoding`. What is no text is refused by its kind ([`file_kind`]).

use super::file_kind;
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE};
use encoding_rs_io::DecodeReaderBytesBuilder;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{BufReader, Cursor, ErrorKind, Read};
use std::path::Path;

/// First bytes that decide what a file is.
const HEAD: usize = 8 * 1024;

/// Share of NUL bytes at one parity [-] from which text is UTF-16: that of Latin letters is 1.
const WIDE: f64 = 0.8;

/// A table's text, and what was found about its file.
pub(super) struct Text {
    /// UTF-8, except for bytes that are none of it.
    pub(super) reader: Box<dyn Read>,
    /// How it was unpacked and decoded, where not as plain UTF-8.
    pub(super) notes: Vec<String>,
}

/// Opens `path` as text in `encoding`, a label of the [Encoding Standard](https://encoding.spec.whatwg.org).
///
/// # Errors
/// A file that cannot be read or is no text, in words, with the way out.
pub(super) fn open(path: &Path, encoding: Option<&str>) -> Result<Text, String> {
    let name = path.display().to_string();
    let file = File::open(path).and_then(|file| {
        if file.metadata()?.is_dir() {
            Err(ErrorKind::IsADirectory.into())
        } else {
            Ok(file)
        }
    });
    let file = file.map_err(|error| format!("cannot read {name}: {error}"))?;
    from(file, &name, encoding)
}

/// As [`open`], of the bytes of a file of this `name`.
pub(super) fn from(
    source: impl Read + 'static,
    name: &str,
    encoding: Option<&str>,
) -> Result<Text, String> {
    let mut notes = Vec::new();
    let (mut head, mut reader) = peeked(Box::new(source), name)?;
    if head.starts_with(b"\x1f\x8b") {
        let unpacked = MultiGzDecoder::new(BufReader::with_capacity(1 << 16, reader));
        (head, reader) = peeked(Box::new(unpacked), name)?;
        notes.push("unpacked from gzip".to_owned());
    }
    if let Some(kind) = file_kind::of(&head) {
        return Err(format!("{name} is {}; {}", kind.name, kind.way_out));
    }
    let encoding = match encoding {
        Some(label) => Some(known_encoding(label)?),
        None => wide(&head),
    };
    let by_mark = Encoding::for_bom(&head).map(|(encoding, _)| encoding);
    let decoded = by_mark.or(encoding);
    if decoded.is_none_or(|encoding| encoding == encoding_rs::UTF_8) {
        refuse_binary(&head, name)?;
    } else if let Some(encoding) = decoded {
        notes.push(format!("decoded from {}", encoding.name()));
    }
    let reader = DecodeReaderBytesBuilder::new()
        .encoding(encoding)
        .bom_override(true)
        .strip_bom(true)
        .utf8_passthru(true)
        .build(reader);
    let reader = Box::new(reader);
    Ok(Text { reader, notes })
}

fn peeked(mut reader: Box<dyn Read>, name: &str) -> Result<(Vec<u8>, Box<dyn Read>), String> {
    let mut head = Vec::new();
    let read = reader.by_ref().take(HEAD as u64).read_to_end(&mut head);
    read.map_err(|error| unreadable(name, &error))?;
    let whole = Cursor::new(head.clone()).chain(reader);
    Ok((head, Box::new(whole)))
}

/// Why the bytes of a file end or cannot be unpacked.
pub(super) fn unreadable(name: &str, error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::UnexpectedEof => {
            format!("{name} is packed and breaks off ({error}); copy it again")
        }
        ErrorKind::InvalidInput | ErrorKind::InvalidData => {
            format!("{name} is packed and damaged ({error}); copy it again")
        }
        _ => format!("cannot read {name}: {error}"),
    }
}

fn known_encoding(label: &str) -> Result<&'static Encoding, String> {
    Encoding::for_label(label.as_bytes()).ok_or_else(|| {
        format!(
            "no encoding is named {label:?}; use one of the Encoding Standard, for example \
             \"utf-8\", \"utf-16le\", \"windows-1252\", \"shift_jis\" or \"gb18030\""
        )
    })
}

/// UTF-16 without its mark: every other byte is 0 where letters are Latin.
fn wide(head: &[u8]) -> Option<&'static Encoding> {
    let share = |parity: usize| {
        let bytes = head.iter().skip(parity).step_by(2);
        let zeros = bytes.clone().filter(|&&byte| byte == 0).count();
        zeros as f64 / bytes.count().max(1) as f64
    };
    match [share(0), share(1)] {
        [even, odd] if odd >= WIDE && even < 1.0 - WIDE => Some(UTF_16LE),
        [even, odd] if even >= WIDE && odd < 1.0 - WIDE => Some(UTF_16BE),
        _ => None,
    }
}

fn refuse_binary(head: &[u8], name: &str) -> Result<(), String> {
    let control = |&byte: &u8| byte < 0x20 && !b"\t\n\r\x0b\x0c\x1a\x1b".contains(&byte);
    match head.iter().position(control) {
        None => Ok(()),
        Some(place) => Err(format!(
            "{name} is no text: byte {place} is 0x{:02x}; export the table as CSV",
            head[place]
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    const TABLE: &str = "t,F [N]\n0,1.5\n1,-2\n";

    fn read(bytes: &[u8], encoding: Option<&str>) -> Result<(String, Vec<String>), String> {
        let mut text = from(Cursor::new(bytes.to_vec()), "a.csv", encoding)?;
        let mut read = String::new();
        let outcome = text.reader.read_to_string(&mut read);
        outcome.map_err(|error| unreadable("a.csv", &error))?;
        Ok((read, text.notes))
    }

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn utf_16(text: &str, bytes: impl Fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn the_same_table_comes_out_of_every_packing_and_encoding_with_a_note_of_it() {
        let marked = format!("\u{feff}{TABLE}");
        let cases = [
            (TABLE.as_bytes().to_vec(), ""),
            (marked.as_bytes().to_vec(), ""),
            (packed(TABLE.as_bytes()), "unpacked from gzip"),
            (packed(&packed(TABLE.as_bytes())[..0]), "unpacked from gzip"),
            (utf_16(&marked, u16::to_le_bytes), "decoded from UTF-16LE"),
            (utf_16(&marked, u16::to_be_bytes), "decoded from UTF-16BE"),
            (utf_16(TABLE, u16::to_le_bytes), "decoded from UTF-16LE"),
            (utf_16(TABLE, u16::to_be_bytes), "decoded from UTF-16BE"),
            (
                packed(&utf_16(&marked, u16::to_le_bytes)),
                "unpacked from gzip; decoded from UTF-16LE",
            ),
        ];
        for (bytes, note) in cases {
            let (text, notes) = read(&bytes, None).unwrap();
            assert!(text == TABLE || text.is_empty(), "{text:?}");
            assert_eq!(notes.join("; "), note);
        }
        let latin = b"t,Winkel [\xb0]\n0,1\n";
        let (text, notes) = read(latin, Some("windows-1252")).unwrap();
        assert!(text.contains("[°]"), "{text}");
        assert_eq!(notes, ["decoded from windows-1252"]);
    }

    #[test]
    fn what_is_no_text_is_refused_without_showing_its_bytes() {
        let cases = [
            (b"\0\x01\x02\x03".to_vec(), "byte 0 is 0x00"),
            (b"t,F\n0,\x07\n".to_vec(), "byte 6 is 0x07"),
            (packed(b"PAR1\x15\x04"), "is a Parquet file"),
            (packed(TABLE.as_bytes())[..20].to_vec(), "breaks off"),
            (b"\x1f\x8b\x08 no gzip at all".to_vec(), "is packed and"),
        ];
        for (bytes, message) in cases {
            let error = read(&bytes, None).unwrap_err();
            assert!(error.contains(message), "{error}");
            let plain = |c: char| !c.is_control();
            assert!(error.chars().all(plain), "{error:?}");
        }
        let error = read(TABLE.as_bytes(), Some("klingon")).unwrap_err();
        assert!(error.contains("windows-1252"), "{error}");
    }
}
