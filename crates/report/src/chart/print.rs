//! Figures for print: one or two columns wide, as SVG and PDF.
//!
//! A drawing is laid out at its own width and then scaled as a whole, so that its text has the same
//! size on paper in both widths: 10 to 13 px are 6 to 8 pt.

use kuva::render::render::Scene;

use crate::chart::canvas::svg;
use crate::folder::{FolderError, OutputFolder};

/// Width of a figure on paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    OneColumn,
    TwoColumns,
}

/// A drawing that is not written yet.
pub struct Drawing(pub(super) Scene);

/// Length on paper of a pixel of a drawing (mm).
const PIXEL_MM: f64 = 0.22;
/// An inch, and a point of PDF (mm).
#[cfg(feature = "pdf")]
const POINT_MM: f64 = 25.4 / 72.0;

impl Width {
    pub const ALL: [Width; 2] = [Width::OneColumn, Width::TwoColumns];

    /// Width on paper (mm).
    pub const fn mm(self) -> f64 {
        match self {
            Self::OneColumn => 88.0,
            Self::TwoColumns => 180.0,
        }
    }

    /// Width of the layout (px).
    pub fn px(self) -> f64 {
        (self.mm() / PIXEL_MM).round()
    }
}

impl Drawing {
    /// For a screen: a pixel is a pixel.
    pub fn svg(&self) -> String {
        svg(&self.0)
    }

    /// Width and height on paper (mm).
    fn size_mm(&self, width: Width) -> [f64; 2] {
        [width.mm(), width.mm() * self.0.height / self.0.width]
    }

    /// For print, with its size in millimetres.
    pub fn svg_for_print(&self, width: Width) -> String {
        let [width_mm, height_mm] = self.size_mm(width);
        let text = self.svg();
        let (before, rest) = text.split_once(" width=").expect("a drawing has a width");
        let (_, after) = rest.split_once(" font-family=").expect("a drawing has fonts");
        format!("{before} width=\"{width_mm}mm\" height=\"{height_mm:.2}mm\" font-family={after}")
    }

    /// For print as PDF, with its fonts.
    ///
    /// # Panics
    /// If the drawing is no valid SVG.
    #[cfg(feature = "pdf")]
    pub fn pdf(&self, width: Width) -> Vec<u8> {
        use kuva::{PageSize, PdfBackend};

        let [width, height] = self.size_mm(width).map(|length| length / POINT_MM);
        let page = PageSize::points(width, height);
        PdfBackend::new().with_page_size(page).render_scene(&self.0).expect("a drawing of this program is valid")
    }
}

/// Writes a figure in both widths, as `NAME-88mm.svg` and so on. `draw` lays it out.
///
/// # Errors
/// If the disk fails.
pub fn write_for_print(folder: &mut OutputFolder, name: &str, draw: impl Fn(Width) -> Drawing) -> Result<(), FolderError> {
    for width in Width::ALL {
        let (drawing, name) = (draw(width), format!("{name}-{}mm", width.mm()));
        folder.write(&format!("{name}.svg"), |out| out.write_all(drawing.svg_for_print(width).as_bytes()))?;
        #[cfg(feature = "pdf")]
        folder.write(&format!("{name}.pdf"), |out| out.write_all(&drawing.pdf(width)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing;
    use crate::chart::panel::{Curve, Panel, Scale, Shape, Style};

    fn drawn(width: Width) -> Drawing {
        let mut panel = Panel::new("load mass (kg)", "effect / tolerance (1)", Scale::LogLog);
        panel.curves.push(Curve::new(vec![[1e-3, 0.01], [1.0, 10.0]], Style::of_pair(0), Shape::Marked));
        drawing(&[panel], &[], 1, [width.px(), 260.0])
    }

    #[test]
    fn a_figure_has_its_width_on_paper_and_text_of_one_size() {
        for width in Width::ALL {
            let svg = drawn(width).svg_for_print(width);
            assert!(svg.contains(&format!("width=\"{}mm\"", width.mm())) && svg.contains("viewBox=\"0 0 "), "{width:?}: {svg:.200}");
            assert!((width.mm() / width.px() - PIXEL_MM).abs() < 1e-3 * PIXEL_MM);
            // One panel alone has no letter.
            assert!(!svg.contains(">a</text>"));
        }
    }

    /// The same drawing gives the same bytes, with text as text.
    #[cfg(feature = "pdf")]
    #[test]
    fn a_pdf_brings_its_fonts() {
        let pdf = drawn(Width::OneColumn).pdf(Width::OneColumn);
        let has = |word: &[u8]| pdf.windows(word.len()).any(|part| part == word);
        assert!(pdf.starts_with(b"%PDF-") && has(b"DejaVuSans") && has(b"/FontFile"), "{} bytes", pdf.len());
        assert_eq!(pdf, drawn(Width::OneColumn).pdf(Width::OneColumn));
    }
}
