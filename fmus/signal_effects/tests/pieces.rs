//! The pieces that come out of the delay line and of the stages, one by one: nothing is lost between them, and rounding
//! of time stamps makes none of its own.

use fmi2_export::Step;
use signal_effects::delay::DelayLine;
use signal_effects::line::Line;

mod common;
use common::scattered;

/// Held values through a delay line by a master that sums up its time; the pieces of each step.
fn passed(start: f64, size: f64, steps: u32, delay: f64, mut each: impl FnMut(u32, Step<'_>, Vec<Line>)) {
    let mut delayed = DelayLine::new(start, scattered(0));
    let mut from = start;
    for k in 1..=steps {
        let step = Step { from, to: from + size, input_rates: &[] };
        let line = Line { span: step.size(), first: scattered(k), last: scattered(k) };
        let mut pieces = Vec::new();
        delayed.pass(&step, delay, line, |piece| pieces.push(piece));
        from = step.to;
        each(k, step, pieces);
    }
}

#[test]
fn law_a_delay_of_whole_steps_gives_whole_pieces() {
    // By 100 s sums of 0.1 s are 1.4e-12 s off. One piece a step is the value of so many steps before.
    for start in [0.0, 1e5] {
        for (size, of_steps) in [(0.1, 1), (0.1, 7), (0.1, 200), (0.3, 11), (0.01, 3), (1.0 / 600.0, 20)] {
            passed(start, size, 3000, size * f64::from(of_steps), |k, step, pieces| {
                let expected = scattered(k.saturating_sub(of_steps));
                let [piece] = pieces[..] else { panic!("{size}, {of_steps}, step {k}: {pieces:?}") };
                assert_eq!((piece.first, piece.last), (expected, expected), "{size}, {of_steps}, step {k}");
                // Stamps err by half an ulp each.
                let near = f64::EPSILON * step.to.abs() * f64::from(of_steps + 8);
                assert!(
                    (piece.span - step.size()).abs() <= near,
                    "{size}, {of_steps}, step {k}: {}",
                    piece.span
                );
            });
        }
    }
}

#[test]
fn law_pieces_of_any_delay_fill_the_step_and_nothing_else() {
    // A dead time of less than a step, of a part of one more, and one that isn't over yet.
    for delay in [0.004, 0.0125, 0.1037, 30.0] {
        passed(0.0, 0.01, 3000, delay, |k, step, pieces| {
            let whole: f64 = pieces.iter().map(|piece| piece.span).sum();
            assert!((whole - step.size()).abs() < 1e-11, "step {k}: {pieces:?}"); // rounding of stamps up to 30 s
            assert!(pieces.iter().all(|piece| piece.span > 1e-6), "step {k}: {pieces:?}");
            let (early, late) = ((step.from - delay) / 0.01, (step.to - delay) / 0.01);
            let value = |at: f64| scattered(at.ceil().max(0.0) as u32);
            assert_eq!(pieces.first().map(|piece| piece.first), Some(value(early + 1e-6)), "step {k}");
            assert_eq!(pieces.last().map(|piece| piece.last), Some(value(late - 1e-6)), "step {k}");
            assert!(pieces.len() <= 2, "step {k}: {pieces:?}");
        });
    }
}

#[test]
fn value_pieces_of_a_saturated_line() {
    let of = |first: f64, last: f64, limit: f64| {
        let mut pieces = Vec::new();
        Line { span: 2.0, first, last }
            .saturate(limit, |piece| pieces.push((piece.span, piece.first, piece.last)));
        pieces
    };
    // From -2 to 2 in 2 s a limit of 1 is left after 0.5 s and met after 1.5 s; and back.
    assert_eq!(of(-2.0, 2.0, 1.0), [(0.5, -1.0, -1.0), (1.0, -1.0, 1.0), (0.5, 1.0, 1.0)]);
    assert_eq!(of(2.0, -2.0, 1.0), [(0.5, 1.0, 1.0), (1.0, 1.0, -1.0), (0.5, -1.0, -1.0)]);
    // One end within.
    assert_eq!(of(0.0, 2.0, 1.0), [(1.0, 0.0, 1.0), (1.0, 1.0, 1.0)]);
    assert_eq!(of(-2.0, 0.0, 1.0), [(1.0, -1.0, -1.0), (1.0, -1.0, 0.0)]);
    // Beyond for the whole of it, standing or not, and untouched.
    assert_eq!(of(3.0, 3.0, 1.0), [(2.0, 1.0, 1.0)]);
    assert_eq!(of(2.0, 5.0, 1.0), [(2.0, 1.0, 1.0)]);
    assert_eq!(of(-1.0, 1.0, 1.0), [(2.0, -1.0, 1.0)]);
    assert_eq!(of(-2.0, 2.0, 0.0), [(2.0, -2.0, 2.0)]);
    // What begins at a limit is no piece of its own.
    assert_eq!(of(-1.0, 3.0, 1.0), [(1.0, -1.0, 1.0), (1.0, 1.0, 1.0)]);
}

#[test]
fn value_a_part_of_a_line_keeps_the_ends_that_it_has() {
    for k in 0..200 {
        let line = Line { span: 2.0, first: scattered(k), last: scattered(k + 1) };
        assert_eq!(line.part(0.0, 2.0), line);
        let part = line.part(0.5, 1.5);
        assert_eq!(part.span, 1.0);
        let at = |share: f64| line.first + share * (line.last - line.first);
        // Rounding of a sum of numbers up to 2.
        assert!((part.first - at(0.25)).abs() < 1e-15 && (part.last - at(0.75)).abs() < 1e-15);
        assert_eq!(line.part(0.7, 2.0).last.to_bits(), line.last.to_bits());
        assert_eq!(line.part(0.0, 0.7).first.to_bits(), line.first.to_bits());
    }
}

#[test]
fn value_a_rate_limit_that_never_catches_up_and_a_lag_of_no_time() {
    for side in [1.0, -1.0] {
        let (mut follower, mut pieces) = (0.0, Vec::new());
        let far = Line { span: 2.0, first: 10.0 * side, last: 10.0 * side };
        far.limit_rate(1.5, &mut follower, |piece| pieces.push(piece));
        assert_eq!(pieces, [Line { span: 2.0, first: 0.0, last: 3.0 * side }]);
        assert_eq!(follower, 3.0 * side);
    }
    // A piece of no length leaves a lag where it was.
    assert_eq!(Line { span: 0.0, first: 1.0, last: 2.0 }.lag(0.1, 0.5), 0.5);
}
