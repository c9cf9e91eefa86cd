//! What a run or study is drawn as, and how wide on paper.

use crate::report::image;
use anyhow::{bail, ensure};
use clap::ValueEnum;
use std::path::Path;

/// Widths [mm] on paper that a layout fits.
const WIDTHS: [f64; 2] = [60.0, 400.0];

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Vectors, for pages and editors
    Svg,
    /// Pixels: 300 per inch with --width, else 2400 across
    Png,
    /// Vectors on a page of the figure's size
    Pdf,
    /// A page in which the run moves; the report of a study
    Html,
    /// Channels, wheel and ground for Foxglove and other viewers of robots
    Mcap,
}

impl Format {
    /// How names of such files end.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Html => "html",
            Self::Mcap => "mcap",
        }
    }

    /// A drawing as an image of this format.
    ///
    /// # Errors
    /// Where the drawing cannot be converted, or the format is none of an image.
    pub fn image(self, svg: String) -> anyhow::Result<Vec<u8>> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            Self::Png => Ok(image::png(&svg)?),
            Self::Pdf => Ok(image::pdf(&svg)?),
            Self::Html | Self::Mcap => bail!("{} is no format of an image", self.ending()),
        }
    }

    /// The format asked for, or else that by which the output's name ends.
    ///
    /// # Errors
    /// Where the two disagree, or the name promises a format that is not written.
    pub fn of(asked: Option<Self>, out: Option<&Path>) -> anyhow::Result<Self> {
        let Some(out) = out else {
            return Ok(asked.unwrap_or(Self::Svg));
        };
        let ending = out.extension().unwrap_or_default().to_string_lossy();
        let named = Self::value_variants().iter().copied();
        let mut named = named.filter(|format| ending.eq_ignore_ascii_case(format.ending()));
        let Some(named) = named.next() else {
            let format = asked.unwrap_or(Self::Svg);
            bail!(
                "plot writes svg, png, pdf, html and mcap; name {} instead of {}",
                out.with_extension(format.ending()).display(),
                out.display()
            );
        };
        ensure!(
            asked.is_none_or(|asked| asked == named),
            "--format {} and --out {} disagree",
            asked.unwrap_or(named).ending(),
            out.display()
        );
        Ok(named)
    }
}

/// A width with its unit, in mm.
pub fn width(text: &str) -> Result<f64, String> {
    let units = [("mm", 1.0), ("cm", 10.0), ("in", 25.4), ("pt", 25.4 / 72.0)];
    let split = |(unit, factor)| Some((text.strip_suffix(unit)?, factor));
    let (number, factor) = units
        .into_iter()
        .find_map(split)
        .ok_or("give a unit, as in 88mm, 8.8cm or 3.5in")?;
    let number = number.trim();
    let value: f64 = number
        .parse()
        .map_err(|_| format!("{number} is no number"))?;
    let [least, most] = WIDTHS;
    if !(least..=most).contains(&(value * factor)) {
        return Err(format!("it has to be from {least} mm to {most} mm"));
    }
    Ok(value * factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_of_the_output_decides_unless_it_contradicts() {
        let of = |asked, out: Option<&str>| Format::of(asked, out.map(Path::new));
        assert_eq!(of(None, None).unwrap(), Format::Svg);
        assert_eq!(of(Some(Format::Pdf), None).unwrap(), Format::Pdf);
        assert_eq!(of(None, Some("a.PNG")).unwrap(), Format::Png);
        assert_eq!(
            of(Some(Format::Html), Some("a.html")).unwrap(),
            Format::Html
        );
        let error = of(Some(Format::Svg), Some("a.png")).unwrap_err();
        assert_eq!(error.to_string(), "--format svg and --out a.png disagree");
        assert!(of(None, Some("a.jpg")).is_err() && of(None, Some("a")).is_err());
    }

    #[test]
    fn a_width_has_a_unit_and_fits_a_page() {
        assert_eq!(width("88mm"), Ok(88.0));
        assert_eq!(width("8.8 cm"), Ok(88.0));
        assert!((width("3.5in").unwrap() - 88.9).abs() < 1e-9);
        for wrong in ["88", "mm", "5mm", "-88mm", "NaNmm", "1e9in"] {
            assert!(width(wrong).is_err(), "{wrong}");
        }
    }
}
