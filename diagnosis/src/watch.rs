//! What a diagnosis says while it works, and how long it may: the one thing that every stage is handed.

use std::time::Instant;

/// What is being done.
#[derive(Debug, Clone, PartialEq)]
pub struct Doing<'a> {
    /// The stage of the work.
    pub stage: &'a str,
    /// What is tried in it, if it tries one thing after the other.
    pub trying: &'a str,
    /// How many were tried, and of how many; both 0 where that isn't known.
    pub count: (usize, usize),
}

/// What a repeated search begins from.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Coordinates of all candidates.
    pub point: Vec<f64>,
    /// Those that are on.
    pub active: Vec<usize>,
    /// The plant was compared by the torques that it lacks, since it doesn't follow its logs.
    pub by_torques: bool,
}

/// Who hears of the work.
pub type Listener<'a> = &'a mut dyn FnMut(&Doing<'_>);

/// Tells a listener, and knows when time is up.
pub struct Watch<'a> {
    listener: Listener<'a>,
    stage: String,
    until: Option<Instant>,
    now: fn() -> Instant,
    known: Option<Known>,
    /// The stages that ended early since time was up, each once.
    ended: Vec<String>,
}

impl<'a> Watch<'a> {
    /// A watch that ends searches at `until`, if given.
    pub fn new(listener: Listener<'a>, until: Option<Instant>) -> Self {
        Self::by(Instant::now, listener, until)
    }

    /// The same by another clock.
    pub fn by(now: fn() -> Instant, listener: Listener<'a>, until: Option<Instant>) -> Self {
        Self { listener, stage: String::new(), until, now, known: None, ended: Vec::new() }
    }

    /// A new stage begins.
    pub fn stage(&mut self, stage: &str) {
        stage.clone_into(&mut self.stage);
        (self.listener)(&Doing { stage, trying: "", count: (0, 0) });
    }

    /// One of several things is tried in this stage.
    pub fn trying(&mut self, what: &str, done: usize, of: usize) {
        (self.listener)(&Doing { stage: &self.stage, trying: what, count: (done, of) });
    }

    /// Whether time is up. Who asks and hears yes ends with what it has; `what` it was is told in the end.
    pub fn is_over(&mut self, what: &str) -> bool {
        let over = self.until.is_some_and(|until| (self.now)() >= until);
        if over && !self.ended.iter().any(|known| known == what) {
            self.ended.push(what.to_owned());
        }
        over
    }

    /// When time is up, if ever.
    pub fn until(&self) -> Option<Instant> {
        self.until
    }

    /// Gives what follows a share of the time that is left. When all of it ends is returned, for [`Watch::end_at`].
    pub fn share(&mut self, of: f64) -> Option<Instant> {
        let (whole, now) = (self.until, (self.now)());
        self.until = whole.map(|until| now + until.saturating_duration_since(now).mul_f64(of));
        whole
    }

    /// Ends searches at a time.
    pub fn end_at(&mut self, until: impl Into<Option<Instant>>) {
        self.until = until.into();
    }

    /// From now on searches begin from what is known, and only what they find counts, not what looks like it.
    pub fn begin_from(&mut self, known: Option<Known>) {
        self.known = known;
    }

    /// What searches begin from, if they are repeated.
    pub fn known(&self) -> Option<&Known> {
        self.known.as_ref()
    }

    /// Whatever ended early behind the first so many is told as one.
    pub fn tell_as_one(&mut self, first: usize, what: &str) {
        if self.ended.len() > first {
            self.ended.truncate(first);
            self.ended.push(what.to_owned());
        }
    }

    /// What ended early, in the order in which it did.
    pub fn ended(&self) -> &[String] {
        &self.ended
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_is_told_with_its_count() {
        let mut heard = Vec::new();
        let mut listener = |doing: &Doing<'_>| {
            heard.push(format!("{}|{}|{:?}", doing.stage, doing.trying, doing.count));
        };
        let mut watch = Watch::new(&mut listener, None);
        watch.stage("plant");
        watch.trying("plant.k_tau", 2, 6);
        assert!(!watch.is_over("the search") && watch.ended().is_empty());
        assert_eq!(heard, ["plant||(0, 0)", "plant|plant.k_tau|(2, 6)"]);
    }

    #[test]
    fn law_a_share_of_time_is_counted_by_the_watchs_own_clock() {
        fn stands() -> Instant {
            static AT: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
            *AT.get_or_init(Instant::now)
        }
        let (mut nobody, second) = (|_: &Doing<'_>| {}, std::time::Duration::from_secs(1));
        let mut watch = Watch::by(stands, &mut nobody, Some(stands() + 2 * second));
        assert_eq!(watch.share(0.5), Some(stands() + 2 * second));
        assert_eq!(watch.until(), Some(stands() + second));
        assert!(!watch.is_over("the search"));
        watch.end_at(stands());
        assert!(watch.is_over("the search"));
    }

    #[test]
    fn every_stage_that_ends_early_is_known_once() {
        let mut nobody = |_: &Doing<'_>| {};
        let mut watch = Watch::new(&mut nobody, Some(Instant::now()));
        assert!(watch.is_over("the search") && watch.is_over("the search") && watch.is_over("classes"));
        assert_eq!(watch.ended(), ["the search", "classes"]);
        watch.tell_as_one(2, "nothing");
        assert_eq!(watch.ended(), ["the search", "classes"]);
        watch.tell_as_one(1, "all that followed");
        assert_eq!(watch.ended(), ["the search", "all that followed"]);
    }
}
