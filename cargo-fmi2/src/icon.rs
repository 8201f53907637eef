//! A small picture of a unit: a block with a stub for each input (left) and output (right).

use crate::Result;

/// Side of the picture in pixels.
const SIDE: usize = 128;
const MARGIN: usize = 20;
const CORNER: f64 = 14.0;
/// Where the stubs of outputs begin and end.
const RIGHT_EDGE: usize = SIDE - MARGIN;
const RIGHT_END: usize = SIDE - 4;

/// The picture as PNG. The colour comes from the identifier, so that units can be told apart at a glance.
pub fn icon(identifier: &str, inputs: usize, outputs: usize) -> Result<Vec<u8>> {
    // FNV-1a, 32 bits
    let hash = identifier
        .bytes()
        .fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    let colour = [0, 8, 16].map(|shift| 70 + ((hash >> shift) & 0x7f) as u8);
    let mut pixels = vec![0_u8; SIDE * SIDE * 4];
    for y in 0..SIDE {
        for x in 0..SIDE {
            let paint = if in_block(x, y, CORNER - 4.0, MARGIN + 4) {
                Some(colour)
            } else if in_block(x, y, CORNER, MARGIN) || in_stub(x, y, inputs, outputs) {
                Some([40, 44, 52])
            } else {
                None
            };
            if let Some([red, green, blue]) = paint {
                pixels[(y * SIDE + x) * 4..][..4].copy_from_slice(&[red, green, blue, 255]);
            }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// A square with round corners around the middle.
fn in_block(x: usize, y: usize, corner: f64, margin: usize) -> bool {
    let reach = SIDE as f64 / 2.0 - margin as f64;
    let beyond = |at: usize| ((at as f64 + 0.5 - SIDE as f64 / 2.0).abs() - (reach - corner)).max(0.0);
    beyond(x).hypot(beyond(y)) <= corner
}

fn in_stub(x: usize, y: usize, inputs: usize, outputs: usize) -> bool {
    let count = match x {
        4..MARGIN => inputs,
        RIGHT_EDGE..RIGHT_END => outputs,
        _ => return false,
    };
    let count = count.min(14); // more can't be told apart
    let space = (SIDE - 2 * MARGIN) as f64 / (count + 1) as f64;
    (1..=count).any(|at| (y as f64 + 0.5 - MARGIN as f64 - at as f64 * space).abs() <= 1.5)
}
