//! The outline of a circle as a polygon of pixels: distortion moves the outline, not only the centre.
//!
//! The polygon has the circle's area (its vertices lie slightly outside), and so many vertices that no pixel's
//! coverage is off by more than [`COVERAGE_ERROR`]. With n vertices on radius r (pixels) the boundary of an
//! equal-area polygon swings about the circle; one swing encloses at most 0.128 · (π² r / 2n²) · (2π r / n) =
//! 3.98 r² / n³ px², and swings of both signs alternate.
//!
//! Behind a lens or an oblique mounting the picture of a small circle is a smooth closed curve: eight of its points
//! are mapped exactly, and the harmonics 0 to 3 of the angle through them give the vertices. What they leave out is
//! of the fourth order of the circle's radius (1e-7 image units for the paper's circles).

use super::Projection;
use crate::photometry::simd;

/// Largest error of a pixel's coverage, as a share of the pixel.
pub const COVERAGE_ERROR: f64 = 0.002;
/// Circles up to this radius in image units are mapped by their harmonics; the fourth order is below 1e-5 px then.
const SMALL: f64 = 0.05;
const HARMONICS: usize = 3;
const SAMPLES: usize = 8;

/// Polygons are laid out in so many strips of equal length, vertex by vertex: vertex k of the list is followed along
/// the outline by vertex k + `STRIPS`. Edges that stand side by side in the list are then far apart in the picture, and
/// vector code that adds them to pixels one after the other need not wait for the pixel.
pub const STRIPS: usize = 8;

/// Vertices of the equal-area polygon of a circle of radius 1.
#[derive(Debug, Clone)]
pub struct UnitCircle {
    /// Distance of the vertices from the centre: slightly more than 1.
    radius: f64,
    /// cos(hφ) and sin(hφ) of the vertices, for h = 1, 2, 3. The first vertex of each strip is the last of another.
    waves: [(Vec<f32>, Vec<f32>); HARMONICS],
    /// cos φ, sin φ of the points that are mapped exactly.
    samples: [(f64, f64); SAMPLES],
}

impl UnitCircle {
    /// The polygon for circles of at most this radius in the picture. The number of vertices is a multiple of
    /// [`STRIPS`], so that the polygon has the symmetries of the pixel grid; no edge is longer than a pixel.
    pub fn for_radius_px(radius_px: f64) -> Self {
        let for_error = libm::cbrt(3.98 * radius_px * radius_px / COVERAGE_ERROR);
        let n = for_error.max(6.5 * radius_px);
        let strip = (libm::ceil(n / STRIPS as f64) as usize).clamp(2, 8192);
        let n = strip * STRIPS;
        let angle = core::f64::consts::TAU / n as f64;
        let wave = |h: usize| {
            let vertex = |k: usize| (k % STRIPS * strip + k / STRIPS) % n;
            let phi = |k: usize| (h + 1) as f64 * angle * (vertex(k) as f64 + 0.5);
            let cosines = (0..n + STRIPS).map(|k| libm::cos(phi(k)) as f32).collect();
            (cosines, (0..n + STRIPS).map(|k| libm::sin(phi(k)) as f32).collect())
        };
        let eighth = core::f64::consts::TAU / SAMPLES as f64;
        Self {
            radius: libm::sqrt(core::f64::consts::TAU / (n as f64 * libm::sin(angle))),
            waves: core::array::from_fn(wave),
            samples: core::array::from_fn(|i| (libm::cos(eighth * i as f64), libm::sin(eighth * i as f64))),
        }
    }

    /// Number of vertices, the repeated first ones of the strips included.
    pub fn len(&self) -> usize {
        self.waves[0].0.len()
    }

    /// Angle from one vertex to the next.
    fn angle(&self) -> f64 {
        core::f64::consts::TAU / (self.len() - STRIPS) as f64
    }

    /// Never true: a polygon has at least 16 vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Outlines in raster coordinates (x right from the left border, y *down* from the upper border, in pixels), one
/// after the other, and the box around all of them.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    /// Horizontal places of the vertices; every `UnitCircle::len` of them are one closed polygon.
    pub xs: Vec<f32>,
    /// Vertical places of the vertices.
    pub ys: Vec<f32>,
    /// Smallest x and y, largest x and y, or slightly beyond.
    pub bounds: Option<[f32; 4]>,
    /// No edge is longer than this horizontally or vertically, in pixels.
    pub longest_edge: f64,
}

/// One coordinate of a closed curve: mean, and the cosine and sine parts of its harmonics.
struct Curve {
    mean: f64,
    parts: [(f64, f64); HARMONICS],
}

impl Outline {
    /// Forgets all outlines.
    pub fn clear(&mut self) {
        self.xs.clear();
        self.ys.clear();
        self.bounds = None;
        self.longest_edge = 0.0;
    }

    /// Adds the outline of a circle in the scene. One that the lens doesn't image (behind the camera, beyond the
    /// fold) is left out; the answer says whether it was added.
    pub fn add(
        &mut self,
        circle: &UnitCircle,
        centre_world: (f64, f64),
        radius_world: f64,
        projection: &Projection,
    ) -> bool {
        let radius = radius_world * circle.radius;
        let Some(ideal) = projection.ideal_from_world(centre_world) else { return false };
        if !projection.images(ideal) {
            return false;
        }
        if let Some((scale_x, scale_y)) = projection.plain_scale() {
            let centre = projection.raster_from_ideal(ideal);
            self.add_disc(circle, centre, (scale_x * radius_world, scale_y * radius_world));
            return true;
        }
        let mut points = [(0.0, 0.0); SAMPLES];
        for (point, (cos, sin)) in points.iter_mut().zip(circle.samples) {
            let world = (centre_world.0 + radius * cos, centre_world.1 + radius * sin);
            let Some(raster) = projection.raster_from_world(world) else { return false };
            *point = raster;
        }
        if radius * projection.image_per_world() > SMALL {
            return self.add_exactly(circle, centre_world, radius, projection);
        }
        let x = curve(circle, |i| points[i].0);
        let y = curve(circle, |i| points[i].1);
        self.append(circle, &x, &y);
        true
    }

    /// Adds an upright ellipse, given in raster coordinates.
    pub fn add_disc(&mut self, circle: &UnitCircle, centre: (f64, f64), radii: (f64, f64)) {
        let (a, b) = (radii.0 * circle.radius, -radii.1 * circle.radius);
        let (cosines, sines) = &circle.waves[0];
        let along = |mean: f64, reach: f64| move |wave: &f32| mean as f32 + reach as f32 * wave;
        self.xs.extend(cosines.iter().map(along(centre.0, a)));
        self.ys.extend(sines.iter().map(along(centre.1, b)));
        let ((left, right), (top, bottom)) = (range(centre.0, a.abs()), range(centre.1, b.abs()));
        self.widen([left, top, right, bottom]);
        self.longest_edge = self.longest_edge.max(circle.angle() * a.abs().max(b.abs()));
    }

    /// Every vertex mapped for itself.
    fn add_exactly(
        &mut self,
        circle: &UnitCircle,
        (x0, y0): (f64, f64),
        radius: f64,
        projection: &Projection,
    ) -> bool {
        let start = self.xs.len();
        let (cosines, sines) = &circle.waves[0];
        let mut bounds = [f32::MAX, f32::MAX, f32::MIN, f32::MIN];
        for (cos, sin) in cosines.iter().zip(sines) {
            let world = (x0 + radius * f64::from(*cos), y0 + radius * f64::from(*sin));
            let Some(raster) = projection.raster_from_world(world) else {
                self.xs.truncate(start);
                self.ys.truncate(start);
                return false;
            };
            let (x, y) = (raster.0 as f32, raster.1 as f32);
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            self.xs.push(x);
            self.ys.push(y);
        }
        self.longest_edge = f64::INFINITY; // not known; the general way takes any length
        self.widen(bounds);
        true
    }

    fn append(&mut self, circle: &UnitCircle, x: &Curve, y: &Curve) {
        x.extend(&circle.waves, &mut self.xs);
        y.extend(&circle.waves, &mut self.ys);
        let ((left, right), (top, bottom)) = (range(x.mean, x.reach()), range(y.mean, y.reach()));
        self.widen([left, top, right, bottom]);
        self.longest_edge = self.longest_edge.max(circle.angle() * x.speed().max(y.speed()));
    }

    fn widen(&mut self, with: [f32; 4]) {
        let old = self.bounds.unwrap_or([f32::MAX, f32::MAX, f32::MIN, f32::MIN]);
        self.bounds =
            Some([old[0].min(with[0]), old[1].min(with[1]), old[2].max(with[2]), old[3].max(with[3])]);
    }
}

/// The harmonics through the exactly mapped points.
fn curve(circle: &UnitCircle, value: impl Fn(usize) -> f64) -> Curve {
    let mean = (0..SAMPLES).map(&value).sum::<f64>() / SAMPLES as f64;
    let part = |h: usize| {
        let (mut a, mut b) = (0.0, 0.0);
        for i in 0..SAMPLES {
            let (cos, sin) = circle.samples[(h + 1) * i % SAMPLES];
            let offset = value(i) - mean;
            a += offset * cos;
            b += offset * sin;
        }
        (2.0 * a / SAMPLES as f64, 2.0 * b / SAMPLES as f64)
    };
    Curve { mean, parts: core::array::from_fn(part) }
}

impl Curve {
    fn extend(&self, waves: &[(Vec<f32>, Vec<f32>)], into: &mut Vec<f32>) {
        let start = into.len();
        into.resize(start + waves[0].0.len(), self.mean as f32);
        for ((cosines, sines), (a, b)) in waves.iter().zip(self.parts) {
            simd::add_wave(&mut into[start..], cosines, sines, (a as f32, b as f32));
        }
    }

    /// Largest derivative with respect to the angle, or more.
    fn speed(&self) -> f64 {
        self.parts.iter().enumerate().map(|(h, (a, b))| (h + 1) as f64 * (a * a + b * b).sqrt()).sum()
    }

    /// The curve stays within the sum of the amplitudes of its mean.
    fn reach(&self) -> f64 {
        self.parts.iter().map(|(a, b)| (a * a + b * b).sqrt()).sum::<f64>()
    }
}

fn range(mean: f64, reach: f64) -> (f32, f32) {
    let slack = 1e-3; // single precision, and the box must never cut the outline
    ((mean - reach - slack) as f32, (mean + reach + slack) as f32)
}
