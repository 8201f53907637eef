//! A picture from a camera with marks on it, and each mark's surroundings enlarged pixel by pixel.

use base64::Engine as _;
use std::fmt::Write as _;

/// A picture with marks.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The picture as a PNG file.
    pub png: Vec<u8>,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Marks: name, and place in pixels from the left and from the top edge.
    pub marks: Vec<(String, f64, f64)>,
}

/// Side of an enlarged piece, in pixels of the picture.
const PIECE: f64 = 20.0;
/// How many times larger it is shown.
const ZOOM: f64 = 8.0;

impl Picture {
    /// Draws the picture, the marks and the enlarged pieces side by side as SVG.
    pub fn to_svg(&self) -> String {
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let data = base64::engine::general_purpose::STANDARD.encode(&self.png);
        let side = PIECE * ZOOM;
        let full_width = width + if self.marks.is_empty() { 0.0 } else { side + 16.0 };
        let full_height = height.max(self.marks.len() as f64 * (side + 8.0));
        let mut svg = format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {full_width} {full_height}" width="{full_width}" height="{full_height}" font-family="sans-serif" font-size="13"><defs><image id="frame" href="data:image/png;base64,{data}" width="{width}" height="{height}" style="image-rendering:pixelated"/></defs><use href="#frame"/>"##
        );
        for (index, mark) in self.marks.iter().enumerate() {
            self.draw_mark(&mut svg, mark, width + 16.0, index as f64 * (side + 8.0));
        }
        svg.push_str("</svg>");
        svg
    }

    fn draw_mark(&self, svg: &mut String, (name, x, y): &(String, f64, f64), left: f64, top: f64) {
        let side = PIECE * ZOOM;
        let (x0, y0) = (x - PIECE / 2.0, y - PIECE / 2.0);
        let name = maud::html! { (name) }.into_string();
        // Writing into a String can't fail.
        let _ = write!(
            svg,
            r##"<rect x="{x0:.2}" y="{y0:.2}" width="{PIECE}" height="{PIECE}" fill="none" stroke="#e69f00"/><text x="{:.2}" y="{:.2}" fill="#e69f00">{name}</text>"##,
            x0 + PIECE + 3.0,
            y0 + 11.0,
        );
        let _ = write!(
            svg,
            r##"<svg x="{left}" y="{top}" width="{side}" height="{side}" viewBox="{x0:.4} {y0:.4} {PIECE} {PIECE}"><use href="#frame"/><path d="M{:.4} {y:.4}H{:.4}M{x:.4} {:.4}V{:.4}" stroke="#d55e00" stroke-width="0.15"/></svg><rect x="{left}" y="{top}" width="{side}" height="{side}" fill="none" stroke="#e69f00"/><text x="{}" y="{}" fill="#e69f00">{name}</text>"##,
            x - 2.0,
            x + 2.0,
            y - 2.0,
            y + 2.0,
            left + 4.0,
            top + 14.0,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::Picture;

    #[test]
    fn law_every_mark_is_enlarged_around_its_place() {
        let marks = vec![("1".to_owned(), 100.25, 50.0), ("<2>".to_owned(), 30.0, 40.0)];
        let svg = Picture { png: vec![1, 2, 3], size: (512, 512), marks }.to_svg();
        assert_eq!(svg.matches("<use").count(), 3, "the picture once, and once for each mark");
        assert!(svg.contains(r#"viewBox="90.2500 40.0000 20 20""#) && svg.contains("&lt;2&gt;"));
    }
}
