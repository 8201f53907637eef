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
        let blend = |[a, b, c]: [f32; 3], [d, e, f]: [f32; 3], [g, h, i]: [f32; 3]| {
            f0 * e + f1 * ((b + h) + (d + f)) + f2 * ((a + c) + (g + i))
        };
        let at = |left: usize, x: usize, right: usize| {
            let three = |row: &[f32]| [row[left], row[x], row[right]];
            blend(three(above), three(middle), three(below))
        };
        let last = width - 1;
        out[0] = at(0, 0, 1.min(last));
        let inner = out.iter_mut().skip(1).zip(above.array_windows::<3>());
        for ((out, above), (middle, below)) in
            inner.zip(middle.array_windows::<3>().zip(below.array_windows::<3>()))
        {
            *out = blend(*above, *middle, *below);
        }
        out[last] = at(last.saturating_sub(1), last, last);
    }
}
