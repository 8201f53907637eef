//! The order in which Gauss-Seidel is best stepped, from what depends on what.

use super::Connection;
use super::names::Names;
use crate::fmu::Causality;
use crate::graph;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet};

/// Each unit after those that it gets values from: first of all where it hands them on in the same instant.
pub(super) fn derived(names: &Names, connections: &[Connection]) -> Vec<usize> {
    let through = feedthrough(names);
    let units = names.units.len();
    let (mut all, mut hard) = (vec![Vec::new(); units], vec![Vec::new(); units]);
    for connection in connections.iter().filter(|connection| connection.direct) {
        let (from, to) = (connection.from.0, connection.to.0);
        if from != to {
            all[to].push(from);
            if through[to].contains(&connection.to.1) {
                hard[to].push(from);
            }
        }
    }
    let blocks = graph::ordered(&all).into_iter().map(|component| {
        let inside: HashSet<usize> = component.nodes.iter().copied().collect();
        let place: HashMap<usize, usize> =
            component.nodes.iter().enumerate().map(|(at, &n)| (n, at)).collect();
        // What is left of a loop when connections that may wait are cut.
        let within = |unit: &usize| {
            hard[*unit].iter().filter(|from| inside.contains(from)).map(|f| place[f]).collect()
        };
        let left: Vec<Vec<usize>> = component.nodes.iter().map(within).collect();
        // Units in a loop of direct feedthrough step in the order of the scenario.
        let parts = graph::ordered(&left).into_iter().map(|part| part.nodes);
        let ordered = first_come(parts.collect(), &left);
        ordered.into_iter().map(|at| component.nodes[at]).collect::<Vec<_>>()
    });
    first_come(blocks.collect(), &all)
}

/// Blocks of nodes, none before one that it depends on; of those that may come next, the one whose least node is first.
fn first_come(blocks: Vec<Vec<usize>>, dependencies: &[Vec<usize>]) -> Vec<usize> {
    let mut block_of = vec![0; dependencies.len()];
    for (block, nodes) in blocks.iter().enumerate() {
        nodes.iter().for_each(|&node| block_of[node] = block);
    }
    let (mut waits, mut wanted) = (vec![0usize; blocks.len()], vec![Vec::new(); blocks.len()]);
    for (node, on) in dependencies.iter().enumerate() {
        for &from in on.iter().filter(|from| block_of[**from] != block_of[node]) {
            waits[block_of[node]] += 1;
            wanted[block_of[from]].push(block_of[node]);
        }
    }
    let key = |block: usize| Reverse((blocks[block].iter().min().copied(), block));
    let mut ready: BinaryHeap<_> = (0..blocks.len()).filter(|&block| waits[block] == 0).map(key).collect();
    let mut order = Vec::with_capacity(dependencies.len());
    while let Some(Reverse((_, block))) = ready.pop() {
        order.extend(&blocks[block]);
        for &next in &wanted[block] {
            waits[next] -= 1;
            if waits[next] == 0 {
                ready.push(key(next));
            }
        }
    }
    order
}

/// The inputs of each unit on which an output depends directly, by their places.
fn feedthrough(names: &Names) -> Vec<HashSet<usize>> {
    let of = |(_, fmu): &(String, crate::Fmu)| {
        let description = fmu.description();
        let is = |place: &usize, causality| description.variables[*place].causality == causality;
        let places = 0..description.variables.len();
        let mut through = HashSet::new();
        for output in places.clone().filter(|place| is(place, Causality::Output)) {
            match description.step_dependencies(output) {
                Some(on) => through.extend(on.iter().filter(|place| is(place, Causality::Input))),
                // Of this one nothing is said: it depends on all of them.
                None => return places.filter(|place| is(place, Causality::Input)).collect(),
            }
        }
        through
    };
    names.units.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_the_least_that_may_come_next_does() {
        // 0 needs 2, 1 needs nothing, 2 needs 3; 4 and 5 are one block.
        let dependencies = [vec![2], vec![], vec![3], vec![], vec![0], vec![]];
        let blocks = vec![vec![3], vec![5, 4], vec![0], vec![1], vec![2]];
        assert_eq!(first_come(blocks, &dependencies), [1, 3, 2, 0, 5, 4]);
    }
}
