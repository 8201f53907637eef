//! Which frames there are, how many sub-frames an exposure has and where, and the queue of results.

use crate::common::*;
use camera::photometry::{FrameMaker, Shot};
use camera::scene::Pose;
use camera::shutter::clock::has_come;
use camera::shutter::exposure::{MOST, SPACING_PX, sub_frames};
use camera::shutter::history::{History, Motion, Segment};
use camera::shutter::{FrameClock, Queue};

#[test]
fn every_start_has_the_first_frame_that_ends_then_or_later() {
    let mut random = Random(33);
    for (rate, interlaced) in [(30.0, false), (30.0, true), (7.3, false), (1000.0, true), (0.02, false)] {
        let clock = FrameClock::new(
            &variables(|v| (v.sensor.frame_rate, v.sensor.interlaced) = (rate, interlaced)).sensor,
        );
        let rate = if interlaced { 2.0 * rate } else { rate };
        for _ in 0..200 {
            let start = random.between(-100.0, 100.0) / rate;
            let k = clock.first_frame(start);
            assert!(k as f64 / rate >= start && ((k - 1) as f64) / rate < start, "{k} at {start}, {rate}/s");
        }
        for k in [-40_i64, -1, 0, 1, 7, 100] {
            // A time that roundings put just before or behind the end of an exposure is that end.
            let end = k as f64 / rate;
            for off in [-1e-13, 0.0, 1e-13] {
                assert_eq!(clock.first_frame(end * (1.0 + off)), k, "{rate}/s");
            }
            // A hundredth of a period is none: 5e-6 s and more.
            assert_eq!(clock.first_frame(end + 0.01 / rate), k + 1);
            assert_eq!(clock.first_frame(end - 0.01 / rate), k);
        }
    }
}

#[test]
fn every_time_has_come_within_a_billionth_of_its_size_or_of_a_second() {
    for (now, room) in [(0.0, 1e-9), (0.5, 1e-9), (-0.3, 1e-9), (1.0, 1e-9), (1000.0, 1e-6), (-2000.0, 2e-6)]
    {
        assert!(has_come(now - 1.0, now) && has_come(now, now) && has_come(now + 0.99 * room, now), "{now}");
        assert!(!has_come(now + 1.01 * room, now), "{now}");
    }
}

#[test]
fn every_result_leaves_the_queue_in_its_turn() {
    let mut queue = Queue::default();
    assert!(queue.is_empty() && queue.receive(f64::MAX).is_none());
    // The third would overtake the second.
    for (due, result) in [(0.1, 'a'), (0.5, 'b'), (0.2, 'c'), (0.6, 'd')] {
        queue.send(due, result);
    }
    assert!(queue.len() == 4 && !queue.is_empty());
    let mut taken = |now: f64| std::iter::from_fn(|| queue.receive(now)).collect::<String>();
    assert_eq!([0.0, 0.1, 0.4, 0.5, 0.55, 0.6].map(&mut taken), ["", "a", "", "bc", "", "d"]);
    assert!(queue.is_empty());
}

/// A pose that turns evenly from the time 1 on.
fn turning(q1: f64, q2: f64, rates: (f64, f64)) -> History {
    let rates = Pose { link1_angle: rates.0, link2_angle: rates.1 };
    History::starting(Motion { time: 1.0, pose: Pose { link1_angle: q1, link2_angle: q2 }, rates })
}

#[test]
fn law_an_exposure_has_a_sub_frame_each_quarter_pixel_of_its_longest_path() {
    // Pinned, so that the circles run on circles: the joint's radius is l1, the tip moves with it where q2 stands.
    let scene =
        variables(|v| (v.scene.drum_radius, v.scene.link1_length, v.scene.link2_length) = (0.0, 4.0, 3.0))
            .scene;
    let mut centres = vec![[(9.0, 9.0); 3]; 7];
    for (rates, radius, turn) in
        [((0.8, 0.0), 4.0, 0.8), ((-0.8, 0.0), 4.0, 0.8), ((0.0, 2.0), 3.0, 2.0), ((0.0, 0.0), 4.0, 0.0)]
    {
        let history = turning(0.3, -0.2, rates);
        for (pixels, exposure) in [(25.6, 0.1), (25.6, 0.25), (7.0, 1.0), (25.6, 1e-6), (500.0, 1.0)] {
            sub_frames(&history, &scene, pixels, 1.0, 1.0 + exposure, &mut centres);
            // Four chords of the arc, as the path is measured.
            let path = 8.0 * radius * (turn * exposure / 8.0).sin() * pixels;
            let n = ((path / SPACING_PX).ceil() as usize).clamp(1, MOST);
            assert_eq!(centres.len(), n, "{rates:?}, {exposure} s at {pixels} px");
            for (i, found) in centres.iter().enumerate() {
                // In the middle of equal parts of the exposure.
                let after = exposure * (i as f64 + 0.5) / n as f64;
                let pose = Pose { link1_angle: 0.3 + rates.0 * after, link2_angle: -0.2 + rates.1 * after };
                let expected = scene.centres_world(pose);
                let apart = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1);
                assert!((0..3).all(|c| apart(found[c], expected[c]) < 1e-12), "{i} of {n}"); // rounding
            }
        }
    }
    // No time at all is a single look.
    sub_frames(&turning(0.3, -0.2, (0.8, 0.0)), &scene, 25.6, 1.0, 1.0, &mut centres);
    assert_eq!(centres, [scene.centres_world(Pose { link1_angle: 0.3, link2_angle: -0.2 })]);
}

#[test]
fn law_where_a_pose_jumps_the_later_one_holds_from_then_on() {
    let at = |time: f64, q: f64| Motion {
        time,
        pose: Pose { link1_angle: q, link2_angle: -q },
        rates: Pose::default(),
    };
    let mut history = History::starting(at(0.0, 1.0));
    history.push(Segment { from: at(0.0, 1.0), to: at(1.0, 1.0) });
    history.push(Segment { from: at(1.0, 3.0), to: at(2.0, 3.0) });
    for (time, q) in [(0.5, 1.0), (1.0 - 1e-9, 1.0), (1.0, 3.0), (1.5, 3.0), (2.0, 3.0)] {
        assert_eq!(history.pose(time), Pose { link1_angle: q, link2_angle: -q }, "{time}");
    }
    assert_eq!(history.newest(), at(2.0, 3.0));
    // What ended before is forgotten; what is left begins at 1, and stands before it.
    history.forget_before(1.5);
    assert_eq!(history.pose(0.5).link1_angle, 3.0);
}

#[test]
fn cross_a_frame_of_the_unit_is_the_makers_with_a_sub_frame_each_quarter_pixel() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut unit = variables(|v| {
        v.sensor.frames_dir = folder.path().display().to_string();
        (v.sensor.width, v.sensor.height) = (300, 400);
        (v.sensor.exposure_factor, v.effects.placement.scale) = (1.0, 0.9);
        [v.inputs.link1_angle, v.inputs.link2_angle, v.inputs.link1_rate, v.inputs.link2_rate] =
            [0.1, -0.2, 0.9, -1.7];
    });
    started(&mut unit);
    let path = folder.path().join("frame_000000.png");
    let file = std::fs::File::open(path).expect("it was written");
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG");
    let mut found = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut found).expect("whole");
    // Before the start the robot has moved evenly; 400 px are 20 world units, looked at 0.9 as large.
    let rates = Pose { link1_angle: 0.9, link2_angle: -1.7 };
    let history =
        History::starting(Motion { time: 0.0, pose: Pose { link1_angle: 0.1, link2_angle: -0.2 }, rates });
    let mut centres = Vec::new();
    sub_frames(&history, &unit.scene, 18.0, -1.0 / 30.0, 0.0, &mut centres);
    assert!(centres.len() > 10, "{}", centres.len());
    let mut maker = FrameMaker::new(&unit.scene, &unit.sensor, &unit.effects).expect("legal parameters");
    maker.render(Shot { k: 0, seed: 0, centres_world: &centres, whole: true });
    let expected: Vec<u8> = (0..400).flat_map(|y| maker.picture().row(y).to_vec()).collect();
    assert!(found == expected, "another picture");
}
