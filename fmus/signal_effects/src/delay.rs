//! The delay line: straight pieces of the signal, end to end, each with the time where it ends.
//!
//! Nothing is rounded to steps: what comes out over a step is the signal over the stretch of the same length that
//! lies the dead time before it, piece by piece, whatever steps it came in. Before the start the signal stood at its
//! start value. A corner that lies by rounding beside the end of that stretch is taken to lie at it: its left value
//! comes out, and no sliver of what follows.

use crate::line::Line;
use fmi2_export::{Step, serde};
use std::collections::VecDeque;

/// A straight piece; it begins where the one before it ends.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
struct Piece {
    /// s
    to: f64,
    first: f64,
    last: f64,
}

/// The signal as far back as it may still be asked for.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct DelayLine {
    pieces: VecDeque<Piece>,
    /// Where the first piece begins, s.
    from: f64,
    /// The value before it.
    before: f64,
}

impl DelayLine {
    /// A signal that stood at `value` until the time `from`.
    pub fn new(from: f64, value: f64) -> Self {
        Self { pieces: VecDeque::new(), from, before: value }
    }

    /// Takes in what the signal does over a step, and hands what comes out over it to `next`.
    pub fn pass(&mut self, step: &Step<'_>, time: f64, line: Line, mut next: impl FnMut(Line)) {
        self.push(step.to, line);
        // Time stamps that a master sums up err by half an ulp each.
        let stamps = time / step.size() + 8.0;
        let near = stamps * f64::EPSILON * step.to.abs().max(time);
        let end = step.to - time;
        let mut now = step.from - time;
        let mut begin = self.from;
        if now < begin - near {
            let to = if begin >= end - near { end } else { begin };
            next(Line { span: to - now, first: self.before, last: self.before });
            now = to;
        }
        for &Piece { to, first, last } in &self.pieces {
            if begin >= end - near {
                break;
            }
            if to > now + near {
                let whole = Line { span: to - begin, first, last };
                let from = now.max(begin);
                let is_last = to >= end - near;
                let out = whole.part(from - begin, if to <= end + near { whole.span } else { end - begin });
                next(Line { span: if is_last { end - from } else { to - from }, ..out });
                now = to;
            }
            begin = to;
        }
        self.forget(end - near);
    }

    /// Appends a piece; a signal that stands still takes one place.
    fn push(&mut self, to: f64, Line { first, last, .. }: Line) {
        match self.pieces.back_mut() {
            Some(piece) if [piece.first, piece.last, first].iter().all(|value| *value == last) => {
                piece.to = to
            }
            _ => self.pieces.push_back(Piece { to, first, last }),
        }
    }

    /// Drops what ends before `time`.
    fn forget(&mut self, time: f64) {
        while let Some(piece) = self.pieces.front().filter(|piece| piece.to < time) {
            (self.from, self.before) = (piece.to, piece.last);
            self.pieces.pop_front();
        }
    }
}
