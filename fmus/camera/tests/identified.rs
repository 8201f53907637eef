//! How far off circles may look and still be identified: each limit of the geometry, from features put beside it.

use crate::common::*;
use camera::Variables;
use camera::scene::Pose;
use camera::vision::{Feature, correspondence};

/// Features at places in world units; 25.6 px each.
fn at((x, y): (f64, f64)) -> Feature {
    Feature { centre_px: (25.6 * x, 25.6 * y), area_px: 75.0 }
}

fn identified(variables: &Variables, places: &[(f64, f64)]) -> Option<[Feature; 3]> {
    let candidates: Vec<Feature> = places.iter().copied().map(at).collect();
    correspondence::by_geometry(&candidates, &variables.scene, &variables.sensor)
}

/// A point at a distance from another, in the direction of an angle from the upright.
fn from(start: (f64, f64), distance: f64, angle: f64) -> (f64, f64) {
    (start.0 + distance * angle.sin(), start.1 + distance * angle.cos())
}

#[test]
fn every_order_of_three_circles_is_the_same_robot_and_others_far_away_do_no_harm() {
    let base = Variables::default();
    let circles = base.scene.centres_world(Pose { link1_angle: 0.1, link2_angle: -0.7 });
    let found = Some(circles.map(at));
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        assert_eq!(identified(&base, &order.map(|i| circles[i])), found, "{order:?}");
    }
    assert_eq!(identified(&base, &circles[..2]), None);
    // Nothing in the upper corners is a link away from the joint. Up to sixteen regions are tried.
    for others in 0..=15 {
        let corner = |i: i32| (9.5 * f64::from(i % 2 * 2 - 1), 9.0 - 0.1 * f64::from(i));
        let all: Vec<_> = (0..others).map(corner).chain(circles).collect();
        assert_eq!(identified(&base, &all), found.filter(|_| all.len() <= 16), "{others} others");
    }
}

#[test]
fn every_link_may_look_two_fifths_longer_or_shorter() {
    let base = Variables::default();
    let (l1, l2) = (6.19, 6.9);
    let drum = (0.0, -7.0);
    for (share, is_found) in [(0.61, true), (0.59, false), (1.0, true), (1.39, true), (1.41, false)] {
        // The first one alone, then the second one.
        let joint = from(drum, share * l1, 0.0);
        let first = identified(&base, &[drum, joint, from(joint, l2, 0.3)]);
        assert_eq!(first.is_some(), is_found, "link 1 at {share} of its length");
        let joint = from(drum, l1, 0.0);
        let second = identified(&base, &[drum, joint, from(joint, share * l2, 0.3)]);
        assert_eq!(second.is_some(), is_found, "link 2 at {share} of its length");
    }
}

#[test]
fn every_drum_is_at_its_height_and_nothing_below_the_ground_unless_the_robot_is_pinned() {
    let base = Variables::default();
    // An image unit is ten world units: three up or down.
    for (off, is_found) in [(2.9, true), (3.1, false), (-2.9, true), (-3.1, false)] {
        // As the drum goes up and down, link 1 is leant so that all stays above the ground and in reach.
        let drum = (0.0, -7.0 + off);
        let joint = from(drum, 6.19, 0.0);
        assert_eq!(identified(&base, &[drum, joint, from(joint, 6.9, 0.2)]).is_some(), is_found, "{off}");
    }
    // The ground is at -8; 1.5 below it is the lowest that a circle may look to be. The tip hangs beside the drum.
    for (y, is_found) in [(-9.4, true), (-9.6, false)] {
        let drum = (0.2, -6.5);
        let joint = from(drum, 6.19, 0.2);
        let down = joint.1 - y;
        assert!(down > 1.4 * 6.19 && down < 1.4 * 6.9, "link 2 may look {down} long, and link 1 may not");
        let found = identified(&base, &[drum, joint, (joint.0 + 0.3, y)]);
        assert_eq!(found.is_some(), is_found, "the tip at {y}");
        // As joint: the drum is as high as it may be, link 1 hangs down from it, and the tip stands beside the drum, where
        // it is no joint.
        let found = identified(&base, &[(3.1, -4.1), (3.2, y), (5.5, y + 6.5)]);
        assert_eq!(found.is_some(), is_found, "the joint at {y}");
    }
    let pinned = variables(|v| (v.scene.drum_radius, v.scene.ground_height) = (0.0, 0.0));
    let joint = from((0.0, 0.0), 6.19, 3.0);
    assert!(identified(&pinned, &[(0.0, 0.0), joint, from(joint, 6.9, 1.5)]).is_some(), "below the pin");
}

#[test]
fn law_a_second_tip_is_told_from_the_first_by_what_the_mounting_leaves_open() {
    // Drum and joint are right but for a camera that shows all `aside` to the right, in image units. A second tip, whose link
    // is off by a share e, costs e²; both cost 4 aside² more. It must cost 1.5 times as much and 1e-4; and without what is
    // aside, 5e-4 more.
    let base = Variables::default();
    for aside in [0.0, 0.02, -0.02, 0.05, -0.09, 0.15] {
        let [drum, joint, tip] = base
            .scene
            .centres_world(Pose { link1_angle: 0.0, link2_angle: 0.4 })
            .map(|c| (c.0 + 10.0 * aside, c.1));
        let limit = f64::max(2.0 * aside * aside + 1e-4, 5e-4).sqrt();
        for sign in [1.0, -1.0] {
            for (share, is_clear) in [(0.98, false), (1.02, true)] {
                let second = from(joint, 6.9 * (1.0 + sign * share * limit), -0.9);
                let found = identified(&base, &[second, drum, joint, tip]);
                assert_eq!(found, is_clear.then_some([drum, joint, tip].map(at)), "{aside}, {sign} {share}");
            }
        }
        // Were the first off as well: by a tenth, both tips short or one of them long.
        let first = 0.1_f64;
        let limit = f64::max(1.5 * first * first + 2.0 * aside * aside + 1e-4, first * first + 5e-4).sqrt();
        for (share, is_clear) in [(0.99, false), (1.01, true)] {
            let short = from(joint, 6.9 * (1.0 - first), 0.4);
            let second = from(joint, 6.9 * (1.0 + share * limit), -0.9);
            let found = identified(&base, &[second, drum, joint, short]);
            assert_eq!(found, is_clear.then_some([drum, joint, short].map(at)), "{aside}, {share}");
        }
    }
}

#[test]
fn law_a_mirrored_drum_is_told_from_the_right_one_once_no_mounting_explains_it() {
    // The joint could stand on a drum mirrored about it, which would have rolled the other way: it lies
    // 2 R q1 + 2 l1 sin q1 aside of that. A camera turned aside explains 0.105 image units and link lengths of 5e-4.
    let base = Variables::default();
    let limit = 0.105 + (5e-4_f64 / 4.0).sqrt();
    let (mut clear, mut open) = (0, 0);
    for i in 1..60 {
        let q1 = 0.002 * f64::from(i);
        let [drum, joint, tip] = base.scene.centres_world(Pose { link1_angle: q1, link2_angle: 0.3 });
        let mirrored = (2.0 * joint.0 - drum.0, drum.1);
        let aside = (2.0 * q1 + 2.0 * 6.19 * q1.sin()) / 10.0;
        let found = identified(&base, &[mirrored, drum, joint, tip]);
        let is_clear = aside > limit;
        *(if is_clear { &mut clear } else { &mut open }) += 1;
        assert_eq!(found, is_clear.then_some([drum, joint, tip].map(at)), "{q1}: {aside}, not {limit}");
    }
    assert!(clear > 10 && open > 10, "{clear} {open}");
}
