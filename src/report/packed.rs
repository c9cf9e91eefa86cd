//! Numbers as text in a page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// The values in single precision, little-endian: first the lowest byte of every value, then the next
/// (neighbours differ little, so that planes compress), as a zlib stream in Base64.
pub(super) fn packed(values: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<[u8; 4]> = values.map(|value| (value as f32).to_le_bytes()).collect();
    let planes: Vec<u8> = (0..4)
        .flat_map(|plane| bytes.iter().map(move |value| value[plane]))
        .collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    let written = encoder.write_all(&planes);
    written.expect("memory takes any number of bytes");
    STANDARD.encode(encoder.finish().expect("memory needs no flushing"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn what_is_packed_comes_back_in_single_precision() {
        let values = [0.1, -3.0e7, f64::NAN, 0.0];
        let bytes = STANDARD.decode(packed(values.into_iter())).unwrap();
        let mut planes = Vec::new();
        ZlibDecoder::new(&bytes[..])
            .read_to_end(&mut planes)
            .unwrap();
        for (i, value) in values.into_iter().enumerate() {
            let bytes = [planes[i], planes[4 + i], planes[8 + i], planes[12 + i]];
            let back = f32::from_le_bytes(bytes);
            assert!(back == value as f32 || back.is_nan() && value.is_nan());
        }
    }
}
