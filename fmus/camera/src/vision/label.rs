//! Labels the 8-connected regions of a thresholded frame: runs of set bits, joined by union-find.

use crate::photometry::Area;
use crate::photometry::plane::{BLOCK, Mask};

/// A connected region. The sums are whole numbers, so they do not depend on the order of its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Component {
    /// Number of pixels.
    pub area: u32,
    /// Sum of the columns of its pixels.
    pub sum_x: u64,
    /// Sum of the rows of its pixels.
    pub sum_y: u64,
    /// Row and column of its first pixel in reading order: orders regions, whatever found them.
    pub first: (u32, u32),
    /// Columns and rows that it spans.
    pub bounds: Area,
}

/// Runs of one row: label and columns, the end exclusive.
#[derive(Debug, Clone, Copy)]
struct Run {
    x0: u32,
    x1: u32,
    label: u32,
}

/// Finds regions; keeps its working space from frame to frame.
#[derive(Debug, Clone, Default)]
pub struct Labeller {
    parents: Vec<u32>,
    regions: Vec<Component>,
    above: Vec<Run>,
    row: Vec<Run>,
}

impl Labeller {
    /// Finds the regions of all windows, in the reading order of their first pixels. Rows go up by `row_step`: the
    /// rows of a field are neighbours. Windows must not touch one another.
    pub fn label(&mut self, mask: &Mask, windows: &[Area], row_step: usize, found: &mut Vec<Component>) {
        found.clear();
        self.parents.clear();
        self.regions.clear();
        for window in windows {
            self.above.clear();
            for y in (window.y0..window.y1).step_by(row_step) {
                self.row.clear();
                collect(mask.row(y), window, &mut self.row);
                self.join(y as u32);
                core::mem::swap(&mut self.above, &mut self.row);
            }
        }
        for (label, region) in self.regions.iter().enumerate() {
            if self.parents[label] == label as u32 {
                found.push(*region);
            }
        }
        found.sort_unstable_by_key(|region| region.first);
    }

    /// Gives the runs of row `y` their labels: those of the runs above that they touch, also across corners.
    fn join(&mut self, y: u32) {
        let mut from = 0;
        for i in 0..self.row.len() {
            let Run { x0, x1, .. } = self.row[i];
            while from < self.above.len() && self.above[from].x1 < x0 {
                from += 1;
            }
            let mut label = u32::MAX;
            let mut j = from;
            while j < self.above.len() && self.above[j].x0 <= x1 {
                let root = self.root(self.above[j].label);
                label = if label == u32::MAX { root } else { self.unite(label, root) };
                j += 1;
            }
            if label == u32::MAX {
                label = self.regions.len() as u32;
                self.parents.push(label);
                self.regions.push(region(x0, x1, y));
            } else {
                absorb(&mut self.regions[label as usize], &region(x0, x1, y));
            }
            self.row[i].label = label;
        }
    }

    fn root(&mut self, mut label: u32) -> u32 {
        while self.parents[label as usize] != label {
            let parent = self.parents[label as usize];
            self.parents[label as usize] = self.parents[parent as usize];
            label = parent;
        }
        label
    }

    /// Joins two roots under the smaller label.
    fn unite(&mut self, a: u32, b: u32) -> u32 {
        if a == b {
            return a;
        }
        let (kept, gone) = (a.min(b), a.max(b));
        self.parents[gone as usize] = kept;
        let absorbed = self.regions[gone as usize];
        absorb(&mut self.regions[kept as usize], &absorbed);
        kept
    }
}

fn region(x0: u32, x1: u32, y: u32) -> Component {
    let area = x1 - x0;
    Component {
        area,
        sum_x: (u64::from(x0) + u64::from(x1 - 1)) * u64::from(area) / 2,
        sum_y: u64::from(y) * u64::from(area),
        first: (y, x0),
        bounds: Area { x0: x0 as usize, y0: y as usize, x1: x1 as usize, y1: y as usize + 1 },
    }
}

fn absorb(into: &mut Component, other: &Component) {
    into.area += other.area;
    into.sum_x += other.sum_x;
    into.sum_y += other.sum_y;
    into.first = into.first.min(other.first);
    into.bounds = into.bounds.around(&other.bounds);
}

/// Runs of set bits of a row within a window.
fn collect(words: &[u32], window: &Area, runs: &mut Vec<Run>) {
    let (first, end) = (window.x0 / BLOCK, window.x1.div_ceil(BLOCK));
    for (index, word) in words[first..end].iter().enumerate().filter(|(_, word)| **word != 0) {
        let base = (first + index) * BLOCK;
        let mut bits = *word;
        if base < window.x0 {
            bits &= u32::MAX << (window.x0 - base);
        }
        if base + BLOCK > window.x1 {
            bits &= u32::MAX >> (base + BLOCK - window.x1);
        }
        while bits != 0 {
            let start = bits.trailing_zeros();
            let length = (!(bits >> start)).trailing_zeros().min(BLOCK as u32 - start);
            let (x0, x1) = (base as u32 + start, base as u32 + start + length);
            match runs.last_mut() {
                Some(last) if last.x1 == x0 => last.x1 = x1,
                _ => runs.push(Run { x0, x1, label: 0 }),
            }
            let taken = if start + length == 32 { u32::MAX } else { (1 << (start + length)) - 1 };
            bits &= !taken;
        }
    }
}
