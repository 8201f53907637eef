//! What a check looked at: what it found, and which rules had nothing to look at, or could not.

use crate::finding::Finding;

/// What all rules say of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Looked {
    /// In the order of the rules.
    pub findings: Vec<Finding>,
    /// Rules that were not looked at, in their order: that they found nothing says nothing of the unit.
    pub left_out: Vec<LeftOut>,
}

/// A rule that was not looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Its name.
    pub rule: &'static str,
    /// Why, as the end of a sentence: "not looked at, because …".
    pub why: String,
}

impl Looked {
    /// Rules that were looked at.
    pub fn rules(&self) -> Vec<&'static str> {
        let is_left_out = |rule: &str| self.left_out.iter().any(|left_out| left_out.rule == rule);
        crate::rules().into_iter().filter(|rule| !is_left_out(rule)).collect()
    }

    /// Rules that were not looked at, those of one reason together.
    pub fn reasons(&self) -> Vec<(&str, Vec<&'static str>)> {
        let mut reasons: Vec<(&str, Vec<&'static str>)> = Vec::new();
        for LeftOut { rule, why } in &self.left_out {
            match reasons.iter_mut().find(|(known, _)| known == why) {
                Some((_, rules)) => rules.push(rule),
                None => reasons.push((why, vec![rule])),
            }
        }
        reasons
    }
}
