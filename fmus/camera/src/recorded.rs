//! The unit's vision on frames that it did not render: those of a real camera.

use crate::photometry::plane::BLOCK;
use crate::photometry::{Area, Mask, Plane};
use crate::unit::check;
use crate::variables::Variables;
use crate::vision::{Component, Estimate, Finder, Tracker, View, select};
use fmi2_export::ModelError;

/// Looks at one recorded frame after the other.
#[derive(Debug, Clone)]
pub struct Recorded {
    variables: Variables,
    picture: Plane<u8>,
    mask: Mask,
    finder: Finder,
    tracker: Tracker,
}

impl Recorded {
    /// The vision with these parameters; of the effects only what an estimator reckons with counts.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(variables: Variables) -> Result<Self, ModelError> {
        check(&variables)?;
        let (width, height) = (variables.sensor.width as usize, variables.sensor.height as usize);
        Ok(Self {
            picture: Plane::filled(width, height, 0, 0),
            mask: Mask::empty(width, height),
            finder: Finder::default(),
            tracker: Tracker::default(),
            variables,
        })
    }

    /// Columns and rows that frame `k` must have: an interlaced one is a field, every other row.
    pub fn size(&self, k: i64) -> (usize, usize) {
        let (first, step) = self.field(k);
        (self.picture.width, (self.picture.height - first).div_ceil(step))
    }

    /// First row of frame `k`, and from one row to the next.
    fn field(&self, k: i64) -> (usize, usize) {
        if self.variables.sensor.interlaced { (k.rem_euclid(2) as usize, 2) } else { (0, 1) }
    }

    /// Estimates the state from frame `k`, whose grey levels stand row by row from the upper left. A frame of another
    /// size than [`Recorded::size`] says shows nothing.
    pub fn look(&mut self, k: i64, mid_exposure: f64, grey: &[u8]) -> Estimate {
        let (width, rows) = self.size(k);
        let (first, row_step) = self.field(k);
        let Variables { scene, sensor, effects, .. } = &self.variables;
        let level = libm::ceil(sensor.threshold.clamp(1.0, 255.0)) as u8;
        self.mask.words.fill(0);
        let whole = grey.len() == width * rows;
        for (row, pixels) in grey.chunks_exact(width).enumerate().filter(|_| whole) {
            let y = first + row * row_step;
            self.picture.row_mut(y).copy_from_slice(pixels);
            let words = &mut self.mask.words[y * self.mask.stride..(y + 1) * self.mask.stride];
            for (word, block) in words.iter_mut().zip(pixels.chunks(BLOCK)) {
                let bit = |(place, pixel): (usize, &u8)| u32::from(*pixel >= level) << place;
                *word = block.iter().enumerate().map(bit).fold(0, |word, bit| word | bit);
            }
        }
        let windows = [Area { x0: 0, y0: first, x1: width, y1: self.picture.height }];
        let view = View { picture: &self.picture, mask: &self.mask, windows: &windows, row_step };
        let features = self.finder.find(&view, scene, sensor, effects);
        let estimate = self.tracker.follow(features, mid_exposure, scene, sensor);
        Estimate { number: k, ..estimate }
    }

    /// Areas in px of all regions of the last frame at or above the threshold, whatever their size.
    pub fn areas(&self) -> Vec<u32> {
        let area = |region: &Component| select::area_px(region, &self.variables.sensor);
        self.finder.regions().iter().map(area).collect()
    }
}
