//! Drawings as PNG and PDF.
//!
//! Texts are set in the first font of the drawing's list that the system has, or else in any; an SVG
//! leaves that choice to its reader. So the same drawing gives the same bytes with the same fonts.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::{Family, Query};
use resvg::usvg::{Options, Tree};
use std::sync::LazyLock;
use svg2pdf::{ConversionOptions, PageOptions};

/// Pixels per inch of an SVG (CSS 2.2, section 4.3.2).
const DRAWN: f32 = 96.0;
/// Pixels per inch of a PNG for paper, and of one for a screen of high resolution.
const PRINTED: f32 = 300.0;
const SHOWN: f32 = 192.0;
/// Families, in the order in which drawings ask for them.
const FAMILIES: [&str; 5] = [
    "Helvetica Neue",
    "Helvetica",
    "Arial",
    "Liberation Sans",
    "DejaVu Sans",
];

/// Why a drawing has no image.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The system has no font.
    #[error(
        "this system has no font to set texts in; install one (apt-get install fonts-liberation), or write SVG"
    )]
    NoFont,
    /// The drawing cannot be converted.
    #[error("the drawing cannot be converted: {0}")]
    Unfit(String),
}

/// The drawing as PNG: 300 pixels per inch where it is for paper, else two pixels for each of its own.
///
/// # Errors
/// `NoFont`; `Unfit` where there is no memory for so large a picture.
pub fn png(svg: &str) -> Result<Vec<u8>, ImageError> {
    let tree = tree(svg)?;
    let is_for_paper = svg
        .lines()
        .next()
        .is_some_and(|head| head.contains("mm\" height"));
    let scale = if is_for_paper { PRINTED } else { SHOWN } / DRAWN;
    let [width, height] =
        [tree.size().width(), tree.size().height()].map(|it| (scale * it).round() as u32);
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| ImageError::Unfit(format!("{width} by {height} pixels are too many")))?;
    resvg::render(
        &tree,
        Transform::from_scale(scale, scale),
        &mut pixels.as_mut(),
    );
    pixels
        .encode_png()
        .map_err(|error| ImageError::Unfit(error.to_string()))
}

/// The drawing as a page of PDF of its size, its lines as lines and its texts as texts.
///
/// # Errors
/// `NoFont`; `Unfit` where a font cannot be embedded.
pub fn pdf(svg: &str) -> Result<Vec<u8>, ImageError> {
    let page = PageOptions { dpi: DRAWN };
    svg2pdf::to_pdf(&tree(svg)?, ConversionOptions::default(), page)
        .map_err(|error| ImageError::Unfit(error.to_string()))
}

fn tree(svg: &str) -> Result<Tree, ImageError> {
    if OPTIONS.fontdb.is_empty() {
        return Err(ImageError::NoFont);
    }
    Tree::from_str(svg, &OPTIONS).map_err(|error| ImageError::Unfit(error.to_string()))
}

/// The system's fonts, which take a moment to find.
static OPTIONS: LazyLock<Options<'static>> = LazyLock::new(|| {
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_system_fonts();
    let has = |name: &&&str| {
        let families = &[Family::Name(name)];
        let asked = Query {
            families,
            ..Query::default()
        };
        fonts.query(&asked).is_some()
    };
    let known = FAMILIES.iter().find(has).map(|name| (*name).to_owned());
    let any = || Some(fonts.faces().next()?.families.first()?.0.clone());
    if let Some(family) = known.or_else(any) {
        fonts.set_sans_serif_family(family);
    }
    options
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::{Anchor, Canvas, Font, Layout};

    fn drawing(layout: Layout) -> String {
        let mut canvas = Canvas::laid_out(layout, "A word");
        canvas.set_height(100.0);
        canvas.text([10.0, 50.0], Anchor::Start, Font::HEADER, "pull F_{DP}");
        canvas.finish()
    }

    #[test]
    fn a_png_for_paper_has_300_pixels_per_inch_and_ink() {
        let bytes = png(&drawing(Layout::on_paper(88.0, true))).unwrap();
        let picture = Pixmap::decode_png(&bytes).unwrap();
        assert_eq!(picture.width(), (88.0_f64 / 25.4 * 300.0).round() as u32);
        let inked = picture.pixels().iter().filter(|it| it.red() < 128).count();
        assert!(inked > 100, "{inked}");
        let shown = Pixmap::decode_png(&png(&drawing(Layout::SCREEN)).unwrap()).unwrap();
        assert_eq!(shown.width(), 2400);
    }

    #[test]
    fn a_page_of_pdf_is_as_wide_as_the_drawing() {
        let bytes = pdf(&drawing(Layout::on_paper(88.0, true))).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        let sizes = text.split("/MediaBox [").nth(1).unwrap();
        let width: f64 = sizes.split(' ').nth(2).unwrap().parse().unwrap();
        assert!((width / 72.0 * 25.4 - 88.0).abs() < 0.01, "{width}");
    }
}
