//! The outline of a circle as a polygon of pixels: distortion moves the outline, not only the centre.
//!
//! The polygon has the circle's area (its vertices lie slightly outside), and so many vertices that no pixel's
//! coverage is off by more than [`COVERAGE_ERROR`]. With n vertices on radius r (pixels) the boundary of an
//! equal-area polygon swings about the circle; one swing encloses at most 0.128 · (π² r / 2n²) · (2π r / n) =
//! 3.98 r² / n³ px², and swings of both signs alternate.

use super::Projection;

/// Largest error of a pixel's coverage, as a share of the pixel.
pub const COVERAGE_ERROR: f64 = 0.002;

/// Vertices of the equal-area polygon of a circle of radius 1.
#[derive(Debug, Clone)]
pub struct UnitCircle {
    vertices: Vec<(f64, f64)>,
}

impl UnitCircle {
    /// The polygon for circles of about this radius in the picture. The number of vertices is a multiple of four,
    /// so that the polygon has the symmetries of the pixel grid.
    pub fn for_radius_px(radius_px: f64) -> Self {
        let n = libm::cbrt(3.98 * radius_px * radius_px / COVERAGE_ERROR);
        let n = (libm::ceil(n / 4.0) as usize * 4).clamp(16, 4096);
        let angle = core::f64::consts::TAU / n as f64;
        let radius = libm::sqrt(core::f64::consts::TAU / (n as f64 * libm::sin(angle)));
        let vertex = |i: usize| {
            let phi = angle * (i as f64 + 0.5);
            (radius * libm::cos(phi), radius * libm::sin(phi))
        };
        Self { vertices: (0..n).map(vertex).collect() }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Never true: a polygon has at least 16 vertices.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }
}

/// Outlines in raster coordinates (x right from the left border, y *down* from the upper border, in pixels), one
/// after the other, and the box around all of them.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    /// Vertices; every `UnitCircle::len` of them are one closed polygon.
    pub vertices: Vec<(f32, f32)>,
    /// Smallest x and y, largest x and y.
    pub bounds: Option<[f32; 4]>,
}

impl Outline {
    /// Forgets all outlines.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.bounds = None;
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
        let start = self.vertices.len();
        let (half_width, half_height) = projection.half_size_px();
        // A circle far outside is cut off there; only its parts within the frame matter.
        let (limit_x, limit_y) = (8.0 * half_width, 8.0 * half_height);
        let mut bounds = self.bounds.unwrap_or([f32::MAX, f32::MAX, f32::MIN, f32::MIN]);
        let Some(centre) = projection.ideal_from_world(centre_world) else { return false };
        if !projection.images(centre) {
            return false;
        }
        for (x, y) in &circle.vertices {
            let world = (centre_world.0 + radius_world * x, centre_world.1 + radius_world * y);
            let Some(ideal) = projection.ideal_from_world(world) else {
                self.vertices.truncate(start);
                return false;
            };
            let (u, v) = projection.pixel_from_ideal(ideal);
            let x = (half_width + u).clamp(-limit_x, limit_x) as f32;
            let y = (half_height - v).clamp(-limit_y, limit_y) as f32;
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            self.vertices.push((x, y));
        }
        self.bounds = Some(bounds);
        true
    }
}
