//! Regions of masks: every number of each, in windows of any place and in fields, as a flood fill finds them.

use crate::common::*;
use camera::photometry::{Area, Mask, Plane};
use camera::vision::{Component, Labeller, View, grey, select};

const WIDTH: usize = 150;
const HEIGHT: usize = 40;

/// Regions of one window whose rows go up by `step`, by flood fill, in reading order.
fn flooded(set: &[bool], window: &Area, step: usize) -> Vec<Component> {
    let mut left = set.to_vec();
    let mut found = Vec::new();
    for y in (window.y0..window.y1).step_by(step) {
        for x in window.x0..window.x1 {
            if !core::mem::replace(&mut left[y * WIDTH + x], false) {
                continue;
            }
            let bounds = Area { x0: x, y0: y, x1: x + 1, y1: y + 1 };
            let mut region = Component { area: 0, sum_x: 0, sum_y: 0, first: (y as u32, x as u32), bounds };
            let mut stack = vec![(x, y)];
            while let Some((x, y)) = stack.pop() {
                region.area += 1;
                (region.sum_x, region.sum_y) = (region.sum_x + x as u64, region.sum_y + y as u64);
                let b = &mut region.bounds;
                (b.x0, b.x1) = (b.x0.min(x), b.x1.max(x + 1));
                (b.y0, b.y1) = (b.y0.min(y), b.y1.max(y + 1));
                for (dx, dy) in [(0, 0), (1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)] {
                    // One to the left and to the right, a row of the field up and down.
                    let (Some(nx), Some(ny)) = ((x + dx).checked_sub(1), (y + dy * step).checked_sub(step))
                    else {
                        continue;
                    };
                    let within = nx >= window.x0 && nx < window.x1 && ny >= window.y0 && ny < window.y1;
                    if within && core::mem::replace(&mut left[ny * WIDTH + nx], false) {
                        stack.push((nx, ny));
                    }
                }
            }
            found.push(region);
        }
    }
    found
}

#[test]
fn every_region_in_windows_and_fields_is_as_a_flood_fill_finds_it() {
    let mut random = Random(15);
    let mut labeller = Labeller::default();
    let (mut found, mut most) = (Vec::new(), 0);
    for trial in 0..300 {
        let density = [0.03, 0.2, 0.4, 0.6, 0.95, 1.0][trial % 6];
        let mut mask = Mask::empty(WIDTH, HEIGHT);
        let set: Vec<bool> = (0..WIDTH * HEIGHT).map(|_| random.uniform() < density).collect();
        for (place, _) in set.iter().enumerate().filter(|(_, set)| **set) {
            mask.words[place / WIDTH * mask.stride + place % WIDTH / 32] |= 1 << (place % WIDTH % 32);
        }
        let step = 1 + trial / 6 % 2;
        // Side by side and one below the other, with a gap, at the borders of words and elsewhere; not in reading order.
        let split = [31, 32, 33, 63, 64, 65, 17, 100][trial % 8];
        let windows = [
            Area { x0: split + 1, y0: trial % 2, x1: WIDTH - trial % 3, y1: 30 },
            Area { x0: trial % 5, y0: 3, x1: split - 1, y1: 20 },
            Area { x0: 5, y0: 32, x1: 5 + split, y1: HEIGHT },
        ];
        labeller.label(&mask, &windows, step, &mut found);
        let mut expected: Vec<Component> =
            windows.iter().flat_map(|window| flooded(&set, window, step)).collect();
        expected.sort_by_key(|region| region.first);
        assert_eq!(found, expected, "trial {trial}");
        most = most.max(found.len());
    }
    assert!(most > 100, "{most}");
}

#[test]
fn value_the_grey_centroid_is_that_of_what_lies_within_two_pixels() {
    let mut random = Random(21);
    let scene = variables(|v| v.scene.background = 20.0).scene;
    let mut labeller = Labeller::default();
    let (mut regions, mut at_borders) = (Vec::new(), 0);
    for trial in 0..400 {
        let step = 1 + trial % 2;
        let first = trial / 2 % 2;
        // One region, now and then at the border of its window, of pixels of all sorts of grey.
        let (x, y) = (random.between(1.0, 110.0) as usize, random.between(2.0, 24.0) as usize);
        let window = Area {
            x0: x.saturating_sub(trial % 5),
            y0: (y - trial % 3) / 2 * 2 + first % step,
            x1: (x + 30 + trial % 4).min(WIDTH),
            y1: (y + 13 + trial % 3).min(HEIGHT),
        };
        let mut mask = Mask::empty(WIDTH, HEIGHT);
        let mut picture = Plane::filled(WIDTH, HEIGHT, 0u8, 0);
        let mut set = vec![false; WIDTH * HEIGHT];
        for row in 0..HEIGHT {
            for column in 0..WIDTH {
                picture.row_mut(row)[column] = random.between(0.0, 256.0) as u8;
                let near = (x..x + 30).contains(&column) && (y..y + 12).contains(&row);
                if near && random.uniform() < 0.4 {
                    set[row * WIDTH + column] = true;
                    mask.words[row * mask.stride + column / 32] |= 1 << (column % 32);
                }
            }
        }
        let windows = [window];
        let view = View { picture: &picture, mask: &mask, windows: &windows, row_step: step };
        labeller.label(&mask, &windows, step, &mut regions);
        for region in &regions {
            let b = region.bounds;
            let (mut sum, mut sum_x, mut sum_y) = (0.0, 0.0, 0.0);
            for row in (window.y0..window.y1).step_by(step) {
                for column in window.x0..window.x1 {
                    let mut pixels =
                        (b.y0..b.y1).step_by(step).flat_map(|y| (b.x0..b.x1).map(move |x| (x, y)));
                    let near =
                        |(x, y): (usize, usize)| column.abs_diff(x) <= 2 && row.abs_diff(y) <= 2 * step;
                    if pixels.any(|(x, y)| set[y * WIDTH + x] && near((x, y))) {
                        let weight = f64::from(picture.row(row)[column]) - 20.0;
                        sum += weight;
                        sum_x += weight * (column as f64 + 0.5);
                        sum_y += weight * (row as f64 + 0.5);
                    }
                }
            }
            at_borders += usize::from(b.x0 < window.x0 + 2 || b.y0 < window.y0 + 2 * step);
            let found = grey::centroid(region, &view, &window, &scene).expect("not all of it is background");
            // The same sums in the same order.
            assert_eq!(found, (sum_x / sum, sum_y / sum), "trial {trial}: {region:?} in {window:?}");
        }
    }
    assert!(at_borders > 100, "{at_borders}");
    // Where nothing differs from the background there is no centre.
    let mask = Mask { words: vec![u32::MAX; 5 * HEIGHT], stride: 5 };
    let (picture, windows) =
        (Plane::filled(WIDTH, HEIGHT, 20u8, 20), [Area { x0: 8, y0: 8, x1: 20, y1: 20 }]);
    let view = View { picture: &picture, mask: &mask, windows: &windows, row_step: 1 };
    labeller.label(&mask, &windows, 1, &mut regions);
    assert_eq!(regions.iter().map(|region| region.area).collect::<Vec<_>>(), [144]);
    assert_eq!(grey::centroid(&regions[0], &view, &windows[0], &scene), None);
}

#[test]
fn every_region_at_the_edge_may_be_cut_and_areas_are_limited_to_the_pixel() {
    for (interlaced, step, share) in [(false, 1, 1), (true, 2, 2)] {
        let sensor = variables(|v| {
            (v.sensor.width, v.sensor.height, v.sensor.interlaced) = (60, 40, interlaced);
            (v.sensor.smallest_area, v.sensor.largest_area) = (40, 44);
        })
        .sensor;
        let may = |area: u32, [x0, y0, x1, y1]: [usize; 4]| {
            let bounds = Area { x0, y0, x1, y1 };
            let region = Component { area, sum_x: 0, sum_y: 0, first: (y0 as u32, x0 as u32), bounds };
            assert_eq!(select::area_px(&region, &sensor), area * share);
            select::may_be_circle(&region, &sensor)
        };
        // A pixel of a field stands for two.
        for area in 30..50 {
            assert_eq!(
                may(area / share, [20, 20, 27, 27]),
                (40..=44).contains(&(area / share * share)),
                "{area}"
            );
        }
        // Next to the edge nothing of it can be missing; a row of the other field lies between, if there are fields.
        let (whole, inner) = (42 / share, [1, step, 59, 40 - step]);
        assert!(may(whole, inner));
        for (side, at) in [(0, 0), (1, step - 1), (2, 60), (3, 41 - step)] {
            let mut cut = inner;
            cut[side] = at;
            assert!(!may(whole, cut), "{cut:?}");
        }
    }
}
