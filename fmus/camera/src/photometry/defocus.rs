//! The defocus of [`crate::effects::defocus`] over a patch of pixels.

use crate::effects::defocus::Defocus;

/// Convolves a patch `width` pixels wide N times with the mask, replicating the border. `scratch` is working space.
///
/// Values within N pixels of a border of the patch that is not a border of the frame are not what whole-frame
/// processing gives; the caller leaves them out.
pub fn blur(patch: &mut Vec<f32>, width: usize, scratch: &mut Vec<f32>, defocus: &Defocus) {
    let weights = [defocus.centre as f32, defocus.edge as f32, defocus.corner as f32];
    for _ in 0..defocus.passes {
        scratch.clear();
        scratch.resize(patch.len(), 0.0);
        pass(patch, width, scratch, weights);
        core::mem::swap(patch, scratch);
    }
}

fn pass(from: &[f32], width: usize, to: &mut [f32], [f0, f1, f2]: [f32; 3]) {
    let height = from.len() / width;
    let row = |y: usize| &from[y * width..(y + 1) * width];
    for (y, out) in to.chunks_exact_mut(width).enumerate() {
        let (above, middle, below) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1)));
        // The same order of additions at every pixel, so that a patch gives the same bits as a whole frame.
        let at = |left: usize, x: usize, right: usize| {
            f0 * middle[x]
                + f1 * ((above[x] + below[x]) + (middle[left] + middle[right]))
                + f2 * ((above[left] + above[right]) + (below[left] + below[right]))
        };
        out[0] = at(0, 0, 1.min(width - 1));
        for x in 1..width.saturating_sub(1) {
            out[x] = at(x - 1, x, x + 1);
        }
        out[width - 1] = at(width.saturating_sub(2), width - 1, width - 1);
    }
}
