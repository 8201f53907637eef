//! Loops of units: simple cycles, with the latest of several connections between two units.

use super::{Schedule, Way};
use std::collections::BTreeMap;

/// Loops after which, and ways walked after which no more are looked for: their number can grow exponentially.
const LOOPS: usize = 200;
const WALKED: usize = 100_000;

/// The ways of each loop; and whether there may be more.
pub(super) fn of(schedule: &Schedule) -> (Vec<Vec<Way>>, bool) {
    let mut latest: BTreeMap<(usize, usize), Way> = BTreeMap::new();
    for way in &schedule.ways {
        let later = |known: &Way| schedule.terms(way).total() > schedule.terms(known).total();
        let known = latest.entry((way.from, way.to)).or_insert(*way);
        if later(known) {
            *known = *way;
        }
    }
    let mut next: Vec<Vec<Way>> = vec![Vec::new(); schedule.units.len()];
    latest.into_values().for_each(|way| next[way.from].push(way));
    let mut search =
        Search { next: &next, inside: Vec::new(), path: Vec::new(), found: Vec::new(), walked: 0 };
    for component in crate::graph::ordered(&neighbours(&next)).iter().filter(|component| component.is_loop) {
        search.inside = vec![false; next.len()];
        component.nodes.iter().for_each(|&unit| search.inside[unit] = true);
        // Each loop is found from its first unit, which is then left out.
        for &root in &component.nodes {
            search.from(root);
            search.inside[root] = false;
        }
    }
    let cut = search.is_over();
    let mut found = search.found;
    found.sort_by_key(|ways| ways[0].from);
    (found, cut)
}

fn neighbours(next: &[Vec<Way>]) -> Vec<Vec<usize>> {
    next.iter().map(|ways| ways.iter().map(|way| way.to).collect()).collect()
}

struct Search<'a> {
    next: &'a [Vec<Way>],
    /// Units that a loop may still go through.
    inside: Vec<bool>,
    path: Vec<Way>,
    found: Vec<Vec<Way>>,
    walked: usize,
}

impl Search<'_> {
    fn is_over(&self) -> bool {
        self.found.len() >= LOOPS || self.walked >= WALKED
    }

    /// All loops through a unit; on the heap, since a chain of units may be long.
    fn from(&mut self, root: usize) {
        let mut places = vec![0];
        let mut on_path = vec![false; self.next.len()];
        while let Some(place) = places.last_mut() {
            let unit = self.path.last().map_or(root, |way| way.to);
            let way = self.next[unit].get(*place).copied();
            *place += 1;
            match way {
                None => {
                    places.pop();
                    on_path[unit] = false;
                    self.path.pop();
                }
                Some(_) if self.is_over() => {
                    self.path.clear();
                    return;
                }
                Some(way) if way.to == root => {
                    self.walked += 1;
                    self.found.push(self.path.iter().copied().chain([way]).collect());
                }
                Some(way) if self.inside[way.to] && !on_path[way.to] => {
                    self.walked += 1;
                    on_path[way.to] = true;
                    self.path.push(way);
                    places.push(0);
                }
                Some(_) => self.walked += 1,
            }
        }
    }
}
