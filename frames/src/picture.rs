//! A file as the vision takes it: grey levels 0 to 255.

use crate::error::Error;
use image::{ColorType, DynamicImage, ImageDecoder as _, ImageReader};
use std::path::Path;

/// Largest value of a pixel of 16 bit.
const WHITE: u16 = u16::MAX;
/// The brightest pixel of a 16-bit recording lies at or below this share of the white level only if the camera counts to less:
/// sensors of 12 bit and fewer that are stored as they count reach a sixteenth.
const DIM: f64 = 1.0 / 16.0;

/// A frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Grey {
    /// Row by row from the upper left.
    pub pixels: Vec<u8>,
    /// The file had colours.
    pub colour: bool,
    /// The brightest pixel as it stands in a file of 16 bit.
    pub brightest: Option<u16>,
}

/// Reads a frame. Colours become luminance (Rec. 709); 16 bit are divided so that `white` is 255, and rounded as the
/// unit's own sensor does. `fits` is asked about columns and rows before anything is decoded: a file of kB may hold GB of pixels.
pub fn read(
    path: &Path,
    white: Option<u16>,
    fits: impl FnOnce((usize, usize)) -> Result<(), Error>,
) -> Result<Grey, Error> {
    let wrong = |what: String| Error::Image { path: path.to_owned(), what };
    let reader = ImageReader::open(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
    let reader =
        reader.with_guessed_format().map_err(|source| Error::File { path: path.to_owned(), source })?;
    let unreadable =
        |error| wrong(format!("{error}; expected a PNG, TIFF or JPEG image of 8 or 16 bit a channel"));
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (columns, rows) = decoder.dimensions();
    fits((columns as usize, rows as usize))?;
    let image = DynamicImage::from_decoder(decoder).map_err(unreadable)?;
    let colour = image.color().has_color();
    match image.color() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            Ok(Grey { pixels: image.into_luma8().into_raw(), colour, brightest: None })
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            Ok(sixteen(image, colour, white.unwrap_or(WHITE)))
        }
        other => Err(wrong(format!("pixels of the kind {other:?}; expected 8 or 16 bit a channel"))),
    }
}

fn sixteen(image: DynamicImage, colour: bool, white: u16) -> Grey {
    let values = image.into_luma16().into_raw();
    let white = u32::from(white.max(1));
    let level = |value: &u16| ((u32::from(*value) * 255 + white / 2) / white).min(255) as u8;
    Grey { pixels: values.iter().map(level).collect(), colour, brightest: values.iter().copied().max() }
}

/// What kinds of images a recording had.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Depth {
    colours: usize,
    brightest: Option<u16>,
}

impl Depth {
    /// Counts a frame.
    pub fn seen(&mut self, grey: &Grey) {
        self.colours += usize::from(grey.colour);
        self.brightest = self.brightest.max(grey.brightest);
    }

    /// What a user should know of the conversion.
    pub fn told(&self, folder: &Path, white: Option<u16>) -> Vec<String> {
        let mut told = Vec::new();
        if self.colours > 0 {
            told.push(format!(
                "{}: {} frames have colours; their luminance (Rec. 709) is what the vision sees",
                folder.display(),
                self.colours
            ));
        }
        if let Some(brightest) = self.brightest {
            let level = white.unwrap_or(WHITE);
            told.push(format!("{}: 16 bit a pixel; {level} counts as grey level 255", folder.display()));
            if f64::from(brightest) <= DIM * f64::from(level) {
                let counts = (u32::from(brightest) + 1).next_power_of_two() - 1;
                told.push(format!(
                    "{}: no pixel is brighter than {brightest}; if the camera counts to {counts}, add --white {counts}",
                    folder.display()
                ));
            }
        }
        told
    }
}

#[cfg(test)]
mod tests {
    use super::{DIM, Depth, Grey, WHITE};
    use std::path::Path;

    fn told(brightest: u16, white: Option<u16>) -> String {
        let mut depth = Depth::default();
        depth.seen(&Grey { pixels: vec![0], colour: false, brightest: Some(brightest) });
        depth.told(Path::new("f"), white).join("\n")
    }

    #[test]
    fn law_a_camera_that_counts_to_less_is_told_of_with_its_white() {
        assert!(told(4000, None).contains("--white 4095"), "twelve bit");
        assert!(told(900, None).contains("--white 1023"), "ten bit");
        let bright = (DIM * f64::from(WHITE)) as u16 + 1;
        assert!(!told(bright, None).contains("--white"), "brighter than a sensor of twelve bit counts");
        assert!(!told(4000, Some(4095)).contains("--white"), "said already");
    }
}
