//! The lines before a table: those to skip, and comments that may contain its names.

use std::io::{BufRead, BufReader, Cursor, Read};

/// Longest line [bytes] of a table: a file without line ends must not fill the memory.
const LONGEST: u64 = 1 << 20;

/// A comment, without `#` and blanks.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Comment {
    pub(super) line: u64,
    pub(super) text: String,
}

/// The lines before the first row.
pub(super) struct Lead {
    /// Comments before it.
    pub(super) comments: Vec<Comment>,
    /// Lines passed.
    pub(super) lines: u64,
    /// From the first row on.
    pub(super) rest: Box<dyn Read>,
}

impl Lead {
    /// Skips `skip` lines, and then empty lines and comments.
    ///
    /// # Errors
    /// Where a line does not end within 1 MiB, or an error of the file system.
    pub(super) fn read(source: Box<dyn Read>, skip: u64) -> std::io::Result<Self> {
        let mut source = BufReader::with_capacity(1 << 16, source);
        let mut comments = Vec::new();
        let mut lines = 0;
        loop {
            let mut line = Vec::new();
            source.by_ref().take(LONGEST).read_until(b'\n', &mut line)?;
            if line.len() as u64 == LONGEST {
                let message = format!("line {} does not end within 1 MiB", lines + 1);
                return Err(std::io::Error::other(message));
            }
            let text = line.trim_ascii();
            let passed = lines < skip || text.is_empty() || text.starts_with(b"#");
            if !passed || line.is_empty() {
                let rest = Box::new(Cursor::new(line).chain(source));
                return Ok(Self {
                    comments,
                    lines,
                    rest,
                });
            }
            lines += 1;
            if lines > skip && !text.is_empty() {
                let text = String::from_utf8_lossy(text);
                let text = text.trim_start_matches('#').trim();
                comments.push(Comment {
                    line: lines,
                    text: text.to_owned(),
                });
            }
        }
    }
}

/// Text whose runs of blanks and tabs are one blank, with none at either end of a line: cells
/// parted by any number of blanks, as tables with aligned columns have them.
pub(super) struct Aligned<R> {
    source: R,
    ready: Vec<u8>,
    given: usize,
    blank: bool,
    line_start: bool,
}

impl<R: Read> Aligned<R> {
    pub(super) fn new(source: R) -> Self {
        Self {
            source,
            ready: Vec::new(),
            given: 0,
            blank: false,
            line_start: true,
        }
    }

    /// Reads until something is ready, or to the end.
    fn refill(&mut self) -> std::io::Result<()> {
        let mut chunk = [0; 1 << 14];
        self.ready.clear();
        self.given = 0;
        while self.ready.is_empty() {
            let read = self.source.read(&mut chunk)?;
            if read == 0 {
                break;
            }
            chunk[..read].iter().for_each(|&byte| self.take(byte));
        }
        Ok(())
    }

    fn take(&mut self, byte: u8) {
        match byte {
            b' ' | b'\t' => self.blank = !self.line_start,
            b'\n' | b'\r' => {
                (self.blank, self.line_start) = (false, true);
                self.ready.push(byte);
            }
            byte => {
                if std::mem::take(&mut self.blank) {
                    self.ready.push(b' ');
                }
                self.line_start = false;
                self.ready.push(byte);
            }
        }
    }
}

impl<R: Read> Read for Aligned<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.given == self.ready.len() {
            self.refill()?;
        }
        let ready = &self.ready[self.given..];
        let count = ready.len().min(buffer.len());
        buffer[..count].copy_from_slice(&ready[..count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lead(text: &'static str, skip: u64) -> (Vec<Comment>, u64, String) {
        let lead = Lead::read(Box::new(text.as_bytes()), skip).unwrap();
        let mut rest = String::new();
        let mut reader = lead.rest;
        reader.read_to_string(&mut rest).unwrap();
        (lead.comments, lead.lines, rest)
    }

    #[test]
    fn lines_before_a_table_are_skipped_and_comments_stored_with_their_lines() {
        let comment = |line, text: &str| Comment {
            line,
            text: text.to_owned(),
        };
        let (comments, lines, rest) = lead("# a\n\n ## t,F\r\n0,1\n#b\n", 0);
        assert_eq!(comments, [comment(1, "a"), comment(3, "t,F")]);
        assert_eq!((lines, rest.as_str()), (3, "0,1\n#b\n"));
        let (comments, lines, rest) = lead("logger;3\nday;1\n#x\nt;F\n", 2);
        assert_eq!(comments, [comment(3, "x")]);
        assert_eq!((lines, rest.as_str()), (3, "t;F\n"));
        assert_eq!(lead("#a", 0).2, "");
        let endless = std::io::repeat(b'7');
        assert!(Lead::read(Box::new(endless), 0).is_err());
    }

    #[test]
    fn aligned_columns_are_parted_by_one_blank_however_the_text_is_cut() {
        let text = "  t    F \n 0.0\t \t1.5\r\n   \n10.0 -2.5  \n";
        for length in [1, 2, 3, 7, 100] {
            let mut reader = Aligned::new(text.as_bytes());
            let mut read: Vec<u8> = Vec::new();
            let mut buffer = vec![0; length];
            loop {
                match reader.read(&mut buffer).unwrap() {
                    0 => break,
                    count => read.extend(&buffer[..count]),
                }
            }
            assert_eq!(read, b"t F\n0.0 1.5\r\n\n10.0 -2.5\n");
        }
    }
}
