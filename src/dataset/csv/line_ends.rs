//! Lines of every system as one.

use std::io::Read;

/// Text whose lines all end in `\n`, the last one too: those of Windows (`\r\n`) and of some instruments (`\r`) among them,
/// so that lines are counted as an editor counts them.
pub(super) struct LineEnds<R> {
    source: R,
    /// The last byte read; that of an empty line before the first.
    last: u8,
}

impl<R: Read> LineEnds<R> {
    pub(super) fn new(source: R) -> Self {
        Self {
            source,
            last: b'\n',
        }
    }

    /// Makes the line ends in `bytes` alike, and returns how many are left.
    fn unify(&mut self, bytes: &mut [u8]) -> usize {
        let mut kept = 0;
        for place in 0..bytes.len() {
            let byte = bytes[place];
            if !(byte == b'\n' && self.last == b'\r') {
                bytes[kept] = if byte == b'\r' { b'\n' } else { byte };
                kept += 1;
            }
            self.last = byte;
        }
        kept
    }
}

impl<R: Read> Read for LineEnds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        while !buffer.is_empty() {
            let count = self.source.read(buffer)?;
            if count == 0 && ![b'\n', b'\r'].contains(&self.last) {
                (self.last, buffer[0]) = (b'\n', b'\n');
                return Ok(1);
            }
            let kept = self.unify(&mut buffer[..count]);
            if kept > 0 || count == 0 {
                return Ok(kept);
            }
        }
        Ok(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_ends_alike_however_the_text_is_cut() {
        for (text, expected) in [
            ("a\r\nb\r\n\r\nc", "a\nb\n\nc\n"),
            ("a\rb\r\rc\r", "a\nb\n\nc\n"),
            ("a\nb\n", "a\nb\n"),
            ("\r\n", "\n"),
            ("", ""),
        ] {
            for length in [1, 2, 3, 64] {
                let mut reader = LineEnds::new(text.as_bytes());
                let (mut read, mut buffer) = (Vec::new(), vec![0; length]);
                loop {
                    match reader.read(&mut buffer).unwrap() {
                        0 => break,
                        count => read.extend(&buffer[..count]),
                    }
                }
                assert_eq!(String::from_utf8(read).unwrap(), expected, "{text:?}");
            }
        }
    }
}
