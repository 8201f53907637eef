//! Makes frames: keeps the cached background and the boxes of the last frame, and renders the next one's.

use super::coverage::{Area, Coverage};
use super::defocus::blur;
use super::noise::{Keys, gain};
use super::parts;
use super::plane::{Mask, Plane};
use super::quantise::{self, FrameNoise};
use super::recent::Recent;
use crate::effects::Effects;
use crate::geometry::{Outline, Projection, UnitCircle};
use crate::variables::{Scene, Sensor};
use crate::vision::estimator;
use fmi2_export::ModelError;

/// What one frame sees.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// Number of the frame: chooses the noise, and the field if interlaced.
    pub k: i64,
    /// Chooses the noise as well.
    pub seed: i32,
    /// Centres of the three circles in world units, one entry a sub-frame; all of equal weight.
    pub centres_world: &'a [[(f64, f64); 3]],
    /// Make every pixel of the picture, not only those that the vision system needs.
    pub whole: bool,
}

/// The parameters of which everything cached is worked out.
#[derive(Debug, Clone, PartialEq)]
struct Settings {
    scene: Scene,
    sensor: Sensor,
    effects: Effects,
}

/// Renders frames for one set of parameters. A pure cache: what it makes does not depend on what it made before.
#[derive(Debug, Clone)]
pub struct FrameMaker {
    settings: Settings,
    projection: Projection,
    circle: UnitCircle,
    /// Light that reaches each pixel (11); empty if it is the same everywhere.
    sensitivity: Vec<f32>,
    /// The base without circles.
    background: Plane<i16>,
    brightest_background: i16,
    base: Plane<i16>,
    picture: Plane<u8>,
    mask: Mask,
    /// Boxes of the last frame, whose base and picture are not the background.
    dirty: Vec<Area>,
    /// The picture outside the boxes is the background without noise.
    picture_is_clean: bool,
    /// Areas in which the mask of the last frame is meaningful.
    windows: Vec<Area>,
    outlines: [Outline; 3],
    coverage: Coverage,
    /// Bases that may be asked for again, under other noise.
    recent: Recent,
    patch: Vec<f32>,
    scratch: Vec<f32>,
}

impl FrameMaker {
    /// Prepares everything that does not change from frame to frame.
    ///
    /// # Errors
    /// An unusable lens, or grey levels that can't be.
    pub fn new(scene: &Scene, sensor: &Sensor, effects: &Effects) -> Result<Self, ModelError> {
        let projection = Projection::new(scene, sensor, effects)?;
        let (width, height) = (sensor.width as usize, sensor.height as usize);
        let larger = f64::from(sensor.width.max(sensor.height));
        let radius_px =
            projection.largest_magnification() * scene.circle_radius / scene.field_of_view * larger;
        let sensitivity = sensitivity(sensor, effects);
        let mut maker = Self {
            settings: Settings { scene: scene.clone(), sensor: sensor.clone(), effects: effects.clone() },
            projection,
            circle: UnitCircle::for_radius_px(radius_px),
            sensitivity,
            background: Plane { values: Vec::new(), stride: 0, width, height },
            brightest_background: 0,
            base: Plane::default(),
            picture: Plane::filled(width, height, 0, 0),
            mask: Mask::empty(width, height),
            dirty: Vec::new(),
            picture_is_clean: false,
            windows: Vec::new(),
            outlines: Default::default(),
            coverage: Coverage::default(),
            recent: Recent::default(),
            patch: Vec::new(),
            scratch: Vec::new(),
        };
        maker.prepare_background();
        Ok(maker)
    }

    /// Whether this maker was made for these parameters.
    pub fn is_for(&self, scene: &Scene, sensor: &Sensor, effects: &Effects) -> bool {
        // Of the sensor only what forms the picture counts: the rest may differ from run to run.
        let picture =
            |s: &Sensor| (s.width, s.height, s.focal_length, s.interlaced, s.threshold, s.estimator);
        let settings = &self.settings;
        picture(&settings.sensor) == picture(sensor)
            && settings.scene == *scene
            && settings.effects == *effects
    }

    /// Renders a frame.
    pub fn render(&mut self, shot: Shot<'_>) {
        let restored = core::mem::take(&mut self.dirty);
        for area in &restored {
            copy(&self.background, &mut self.base, *area);
        }
        let noise: FrameNoise = match gain(self.settings.effects.noise.deviation) {
            0 => None,
            gain => Some((Keys::new(shot.seed, shot.k), gain)),
        };
        let boxes = self.draw(shot.centres_world, noise.is_some());
        self.expose(shot, &boxes, &restored, noise);
        self.dirty = boxes;
    }

    /// Draws the circles over the background; answers the boxes in which they lie. Where frames are `noisy`, the same base may be asked for
    /// again.
    fn draw(&mut self, centres_world: &[[(f64, f64); 3]], noisy: bool) -> Vec<Area> {
        if let Some(boxes) = self.recent.draw(centres_world, &mut self.base) {
            return boxes;
        }
        self.trace(centres_world);
        let boxes = self.boxes();
        for area in &boxes {
            self.fill(*area, centres_world.len());
        }
        if noisy {
            self.recent.keep(centres_world, &boxes, &self.base);
        }
        boxes
    }

    /// Makes picture and mask where they are asked for.
    fn expose(&mut self, shot: Shot<'_>, boxes: &[Area], restored: &[Area], noise: FrameNoise) {
        let sensor = &self.settings.sensor;
        let level = libm::ceil(sensor.threshold.clamp(1.0, 255.0)) as u8;
        let all = Area { x0: 0, y0: 0, x1: self.base.width, y1: self.base.height };
        // A field has every other row, even ones first.
        let (first, step) = if sensor.interlaced { (shot.k.rem_euclid(2) as usize, 2) } else { (0, 1) };
        let seen = |area: Area| Area { y0: area.y0 + (area.y0 + first) % step, ..area };
        let false_blobs = quantise::reaches(self.brightest_background, noise, level);
        let (picture, mask, base) = (&mut self.picture, &mut self.mask, &self.base);
        if false_blobs || (shot.whole && (noise.is_some() || sensor.interlaced)) {
            quantise::quantise(base, seen(all), step, noise, level, picture, mask);
            self.picture_is_clean = false;
        } else {
            if shot.whole && !self.picture_is_clean {
                quantise::quantise(base, all, 1, None, level, picture, mask);
            } else if noise.is_none() {
                for area in restored {
                    quantise::quantise(base, seen(*area), step, None, level, picture, mask);
                }
            }
            for area in boxes {
                quantise::quantise(base, seen(*area), step, noise, level, picture, mask);
            }
            let whole = shot.whole || self.picture_is_clean;
            self.picture_is_clean = whole && noise.is_none() && !sensor.interlaced;
        }
        self.windows.clear();
        if false_blobs {
            self.windows.push(seen(all));
        } else {
            self.windows.extend(boxes.iter().map(|area| seen(*area)));
        }
    }

    /// The picture of the last frame: all of it if the shot asked for the whole, else only the boxes.
    pub fn picture(&self) -> &Plane<u8> {
        &self.picture
    }

    /// The base of the last frame, in parts of a grey level.
    pub fn base(&self) -> &Plane<i16> {
        &self.base
    }

    /// The thresholded last frame; no pixel outside [`FrameMaker::windows`] is a feature pixel.
    pub fn mask(&self) -> &Mask {
        &self.mask
    }

    /// Where feature pixels can be: areas that do not touch one another.
    pub fn windows(&self) -> &[Area] {
        &self.windows
    }

    /// The map from the world to pixels.
    pub fn projection(&self) -> &Projection {
        &self.projection
    }

    /// Outlines of all circles in all sub-frames.
    fn trace(&mut self, centres_world: &[[(f64, f64); 3]]) {
        let radius = self.settings.scene.circle_radius;
        for (circle, outline) in self.outlines.iter_mut().enumerate() {
            outline.clear();
            for centres in centres_world {
                outline.add(&self.circle, centres[circle], radius, &self.projection);
            }
        }
    }

    /// Boxes around the outlines with room for the defocus; boxes that touch are one.
    fn boxes(&self) -> Vec<Area> {
        let (width, height) = (self.base.width, self.base.height);
        let sensor = &self.settings.sensor;
        let margin = self.settings.effects.defocus.passes as usize + estimator::margin(sensor);
        let mut boxes: Vec<Area> = Vec::with_capacity(3);
        for outline in &self.outlines {
            let Some([left, top, right, bottom]) = outline.bounds else { continue };
            if right <= 0.0 || bottom <= 0.0 || left >= width as f32 || top >= height as f32 {
                continue;
            }
            let area = Area {
                x0: left.max(0.0) as usize,
                y0: top.max(0.0) as usize,
                x1: (right.ceil() as usize).min(width),
                y1: (bottom.ceil() as usize).min(height),
            };
            boxes.push(area.grown(margin + 1, width, height));
        }
        let touching = |boxes: &[Area]| {
            let pairs = (0..boxes.len()).flat_map(|i| (i + 1..boxes.len()).map(move |j| (i, j)));
            pairs.into_iter().find(|(i, j)| boxes[*i].grown(1, width, height).overlaps(&boxes[*j]))
        };
        while let Some((i, j)) = touching(&boxes) {
            let merged = boxes[i].around(&boxes[j]);
            boxes.swap_remove(j);
            boxes[i] = merged;
        }
        boxes
    }

    /// Renders one box into the base.
    fn fill(&mut self, area: Area, sub_frames: usize) {
        let Self { settings, outlines, coverage, patch, scratch, base, sensitivity, .. } = self;
        let passes = settings.effects.defocus.passes as usize;
        let outer = area.grown(passes, base.width, base.height);
        coverage.begin(outer.width(), outer.height());
        let origin = (outer.x0 as f32, outer.y0 as f32);
        let (right, bottom) = (outer.x1 as f32, outer.y1 as f32);
        for outline in outlines.iter() {
            let Some([x0, y0, x1, y1]) = outline.bounds else { continue };
            if x1 <= origin.0 || y1 <= origin.1 || x0 >= right || y0 >= bottom {
                continue;
            }
            let inside = x0 >= origin.0 && y0 >= origin.1 && x1 < right && y1 < bottom;
            let n = self.circle.len();
            for (xs, ys) in outline.xs.chunks_exact(n).zip(outline.ys.chunks_exact(n)) {
                coverage.add(xs, ys, origin, inside && outline.longest_edge < 1.0);
            }
        }
        coverage.finish(1.0 / sub_frames as f32);
        let (dark, contrast) = levels(&settings.scene);
        patch.clear();
        for row in 0..outer.height() {
            let covered = coverage.row(row);
            if sensitivity.is_empty() {
                patch.extend(covered.iter().map(|share| dark + contrast * share));
            } else {
                let start = (outer.y0 + row) * base.width + outer.x0;
                let light = &sensitivity[start..start + outer.width()];
                patch.extend(
                    covered.iter().zip(light).map(|(share, light)| (dark + contrast * share) * light),
                );
            }
        }
        blur(patch, outer.width(), scratch, &settings.effects.defocus);
        for y in area.y0..area.y1 {
            let start = (y - outer.y0) * outer.width() + area.x0 - outer.x0;
            let row = &mut base.row_mut(y)[area.x0..area.x1];
            for (to, grey) in row.iter_mut().zip(&patch[start..start + area.width()]) {
                *to = parts(*grey);
            }
        }
    }

    fn prepare_background(&mut self) {
        let (width, height) = (self.background.width, self.background.height);
        let (dark, _) = levels(&self.settings.scene);
        let defocus = &self.settings.effects.defocus;
        if self.sensitivity.is_empty() {
            // The same everywhere; a pixel of a small patch goes through the same operations as one of the frame.
            self.patch = vec![dark; 9];
            blur(&mut self.patch, 3, &mut self.scratch, defocus);
            self.background = Plane::filled(width, height, parts(self.patch[4]), i16::MIN);
        } else {
            self.patch.clear();
            self.patch.extend(self.sensitivity.iter().map(|light| dark * light));
            blur(&mut self.patch, width, &mut self.scratch, defocus);
            self.background = Plane::filled(width, height, 0, i16::MIN);
            for (y, row) in self.patch.chunks_exact(width).enumerate() {
                for (to, grey) in self.background.row_mut(y).iter_mut().zip(row) {
                    *to = parts(*grey);
                }
            }
        }
        self.brightest_background = self.background.values.iter().copied().max().unwrap_or(0);
        self.base = self.background.clone();
    }
}

/// Grey level of the background, and how much brighter the circles are.
fn levels(scene: &Scene) -> (f32, f32) {
    (scene.background as f32, (scene.foreground - scene.background) as f32)
}

/// (11) at the centre of each pixel, or nothing at the neutral value.
fn sensitivity(sensor: &Sensor, effects: &Effects) -> Vec<f32> {
    if effects.sensitivity.exponent == 0.0 {
        return Vec::new();
    }
    let half = (f64::from(sensor.width) / 2.0, f64::from(sensor.height) / 2.0);
    let placement = &effects.placement;
    let columns: Vec<f64> =
        (0..sensor.width).map(|x| (f64::from(x) + 0.5) / half.0 - 1.0 - placement.centre_u).collect();
    let rows: Vec<f64> =
        (0..sensor.height).map(|y| 1.0 - (f64::from(y) + 0.5) / half.1 - placement.centre_v).collect();
    // (11) is smooth in r²: a table with straight lines between is good to 1e-6 for any β that leaves light.
    let square = |places: &[f64]| places.iter().fold(0.0, |largest: f64, place| largest.max(place * place));
    let per_entry = SENSITIVITY_ENTRIES as f64 / (square(&columns) + square(&rows));
    let table: Vec<f64> = (0..=SENSITIVITY_ENTRIES + 1)
        .map(|entry| effects.sensitivity.gain(entry as f64 / per_entry, sensor.focal_length))
        .collect();
    let mut light = Vec::with_capacity(columns.len() * rows.len());
    for v in &rows {
        light.extend(columns.iter().map(|u| {
            let place = (u * u + v * v) * per_entry;
            let entry = (place as usize).min(SENSITIVITY_ENTRIES);
            (table[entry] + (place - entry as f64) * (table[entry + 1] - table[entry])) as f32
        }));
    }
    light
}

/// Entries of the table of (11) over r².
const SENSITIVITY_ENTRIES: usize = 4096;

fn copy(from: &Plane<i16>, to: &mut Plane<i16>, area: Area) {
    for y in area.y0..area.y1 {
        to.row_mut(y)[area.x0..area.x1].copy_from_slice(&from.row(y)[area.x0..area.x1]);
    }
}
