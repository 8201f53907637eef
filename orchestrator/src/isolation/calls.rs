//! The calls into a unit in another process, put together so that a step costs one exchange.
//!
//! While stepping, inputs are sent with the step that follows them, and a step brings the outputs that were read after the
//! one before. The unit sees the same calls in the same order.

use super::client::{Ask, DISCARD, ERROR, FATAL, Remote, answer_of};
use super::memory::Part;
use super::message::{Plain, Reader, Writer};
use crate::fmu::Function;
use std::ffi::{CString, c_char, c_int};

impl Remote {
    /// A call without arguments.
    pub(super) fn plain(&mut self, function: Function) -> c_int {
        let status = self.call(function, |_| ());
        match function {
            Function::ExitInitializationMode => self.stepping = status <= 1,
            Function::Terminate | Function::Reset => self.stepping = false,
            _ => {}
        }
        status
    }

    /// A call that answers nothing but its status.
    pub(super) fn call(&mut self, function: Function, arguments: impl FnOnce(&mut Writer<'_>)) -> c_int {
        self.ask(function, arguments, |_| Some(()))
    }

    /// A call with its answer, read where the status is good.
    pub(super) fn ask(
        &mut self,
        function: Function,
        arguments: impl FnOnce(&mut Writer<'_>),
        read: impl FnOnce(&mut Reader<'_>) -> Option<()>,
    ) -> c_int {
        if self.death.is_some() {
            return FATAL;
        }
        self.forget_asks();
        self.remember(function, 0, 0.0, 0.0);
        self.begin(function, arguments);
        let ahead = self.sent.len() - 1;
        if !self.exchange() {
            return FATAL;
        }
        match self.statuses(ahead) {
            Ok(status) => {
                let at = self.answer_at;
                let mut answer = self.answer();
                answer.at = at;
                if status <= 1 && read(&mut answer).is_none() {
                    return self.nonsense();
                }
                status
            }
            Err(status) => status,
        }
    }

    /// A write. While stepping it waits for what comes next.
    pub(super) fn set<T: Plain>(&mut self, function: Function, references: &[u32], values: &[T]) -> c_int {
        let arguments = |message: &mut Writer<'_>| {
            message.number(references.len() as u64);
            message.slice(references);
            message.slice(values);
        };
        if !self.stepping {
            return self.call(function, arguments);
        }
        if self.death.is_some() {
            return FATAL;
        }
        self.following = false;
        self.answered = 0;
        self.remember(function, references.len(), 0.0, 0.0);
        self.begin(function, arguments);
        0
    }

    /// A read. After a step it was most likely made already.
    pub(super) fn get<T: Plain>(
        &mut self,
        function: Function,
        references: &[u32],
        values: &mut [T],
    ) -> c_int {
        if self.death.is_some() {
            return FATAL;
        }
        self.remember(function, references.len(), 0.0, 0.0);
        if self.came_with_the_step(function, references) {
            return self.read_next(values);
        }
        self.answered = 0;
        self.begin(function, |message| {
            message.number(references.len() as u64);
            message.slice(references);
        });
        let ahead = self.sent.len() - 1;
        if !self.exchange() {
            return FATAL;
        }
        match self.statuses(ahead) {
            Ok(status) => {
                let mut answer = Reader::at(answer_of(&mut self.shared), self.answer_at);
                if status <= 1 && answer.slice(values).is_none() {
                    return self.nonsense();
                }
                status
            }
            Err(status) => status,
        }
    }

    /// Whether the last step brought the answer of this read. A read that follows a step is expected after the next one.
    #[inline]
    fn came_with_the_step(&mut self, function: Function, references: &[u32]) -> bool {
        let place = self.next;
        let known = self.following
            && self
                .asks
                .get(place)
                .is_some_and(|ask| ask.function == function && ask.references == references);
        if self.following && !known {
            self.asks.truncate(place);
            self.asks.push(Ask { function, references: references.to_vec() });
        }
        self.next += usize::from(self.following);
        known && place < self.answered
    }

    /// The next of the answers that came with the last step.
    #[inline]
    fn read_next<T: Plain>(&mut self, values: &mut [T]) -> c_int {
        let mut answer = Reader::at(answer_of(&mut self.shared), self.answer_at);
        let status = answer.number();
        let read = status.and_then(|status| match status {
            0 | 1 => answer.slice(values),
            _ => Some(()),
        });
        self.answer_at = answer.at;
        if status.is_none_or(|status| status > 1) {
            // The process made none of those after it.
            self.answered = 0;
        }
        match (status, read) {
            (Some(status), Some(())) => status as c_int,
            _ => self.nonsense(),
        }
    }

    /// Texts stay as they are until the next call.
    pub(super) fn get_strings(&mut self, references: &[u32], values: &mut [*const c_char]) -> c_int {
        let mut texts = Vec::with_capacity(values.len());
        let question = |message: &mut Writer<'_>| {
            message.number(references.len() as u64);
            message.slice(references);
        };
        let status = self.ask(Function::GetString, question, |answer| {
            for _ in references {
                texts.push(CString::new(answer.bytes()?).ok()?);
            }
            Some(())
        });
        self.texts = texts;
        for (value, text) in values.iter_mut().zip(&self.texts) {
            *value = text.as_ptr();
        }
        status
    }

    /// A step, with the inputs that wait for it and the reads that are expected after it.
    pub(super) fn do_step(&mut self, from: f64, size: f64, no_return: bool) -> c_int {
        if self.death.is_some() {
            return FATAL;
        }
        if self.following {
            self.asks.truncate(self.next);
        }
        self.remember(Function::DoStep, 0, from, size);
        self.begin(Function::DoStep, |message| {
            message.real(from);
            message.real(size);
            message.number(u64::from(no_return));
        });
        let ahead = self.sent.len() - 1;
        let asks = std::mem::take(&mut self.asks);
        for Ask { function, references } in &asks {
            self.begin(*function, |message| {
                message.number(references.len() as u64);
                message.slice(references);
            });
        }
        self.asks = asks;
        if !self.exchange() {
            return FATAL;
        }
        (self.following, self.next) = (true, 0);
        match self.statuses(ahead) {
            Ok(status) => {
                self.answered = if status <= 1 { self.asks.len() } else { 0 };
                status
            }
            Err(status) => status,
        }
    }

    /// Adds a call to the request.
    pub(super) fn begin(&mut self, function: Function, arguments: impl FnOnce(&mut Writer<'_>)) {
        let mut message = Writer::at(self.shared.part(Part::Request), self.at);
        message.number(function as u64);
        arguments(&mut message);
        match message.end() {
            Some(end) => self.at = end,
            None => self.at = usize::MAX,
        }
        self.sent.push(function);
    }

    /// Looks at the calls that were sent ahead; the status of the one that counts. An error is the status of another one.
    fn statuses(&mut self, ahead: usize) -> Result<c_int, c_int> {
        let mut answer = Reader::at(answer_of(&mut self.shared), 0);
        let mut worst = None;
        let mut warned = 0;
        for place in 0..=ahead {
            let Some(status) = answer.number() else { break };
            let status = status as c_int;
            warned += u64::from(status == 1 && place < ahead);
            if place == ahead || status > 1 {
                worst = Some((place, status));
                break;
            }
        }
        self.answer_at = answer.at;
        let Some((place, status)) = worst else { return Err(self.nonsense()) };
        let function = self.sent[place];
        self.sent.clear();
        if place < ahead {
            self.failed = Some((function, status));
            return Err(if status == DISCARD { ERROR } else { status });
        }
        if warned > 0 && status == 0 {
            self.warned = warned - 1;
            return Ok(1);
        }
        self.warned = warned;
        Ok(status)
    }

    fn forget_asks(&mut self) {
        self.following = false;
        self.answered = 0;
    }
}
