//! Dependency graphs: an order in which everything comes after what it depends on, and the loops that have none.

use std::collections::HashMap;

/// Nodes that depend on each other (one node, or all of a loop).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Component {
    pub(crate) nodes: Vec<usize>,
    /// The nodes depend on each other, or the one on itself.
    pub(crate) is_loop: bool,
}

/// Strongly connected components in an order in which each comes after those it depends on (Tarjan 1972).
/// `dependencies[n]` lists what node n depends on. Inside a component the nodes are in rising order.
pub(crate) fn ordered(dependencies: &[Vec<usize>]) -> Vec<Component> {
    let mut search = Search {
        dependencies,
        index: vec![usize::MAX; dependencies.len()],
        low: vec![0; dependencies.len()],
        on_stack: vec![false; dependencies.len()],
        stack: Vec::new(),
        next: 0,
        components: Vec::new(),
    };
    for node in 0..dependencies.len() {
        if search.index[node] == usize::MAX {
            search.visit(node);
        }
    }
    search.components
}

struct Search<'a> {
    dependencies: &'a [Vec<usize>],
    index: Vec<usize>,
    low: Vec<usize>,
    on_stack: Vec<bool>,
    stack: Vec<usize>,
    next: usize,
    components: Vec<Component>,
}

impl Search<'_> {
    /// Depth first, with the recursion on the heap: a chain of units may be long.
    fn visit(&mut self, root: usize) {
        let mut path = vec![(root, 0)];
        self.enter(root);
        while let Some((node, at)) = path.last_mut() {
            let node = *node;
            match self.dependencies[node].get(*at) {
                Some(&next) => {
                    *at += 1;
                    if self.index[next] == usize::MAX {
                        self.enter(next);
                        path.push((next, 0));
                    } else if self.on_stack[next] {
                        self.low[node] = self.low[node].min(self.index[next]);
                    }
                }
                None => {
                    path.pop();
                    if let Some((parent, _)) = path.last() {
                        self.low[*parent] = self.low[*parent].min(self.low[node]);
                    }
                    self.leave(node);
                }
            }
        }
    }

    fn enter(&mut self, node: usize) {
        self.index[node] = self.next;
        self.low[node] = self.next;
        self.next += 1;
        self.stack.push(node);
        self.on_stack[node] = true;
    }

    fn leave(&mut self, node: usize) {
        if self.low[node] != self.index[node] {
            return;
        }
        let begin = self.stack.iter().rposition(|&other| other == node).unwrap_or(0);
        let mut nodes = self.stack.split_off(begin);
        for &member in &nodes {
            self.on_stack[member] = false;
        }
        nodes.sort_unstable();
        let is_loop = nodes.len() > 1 || self.dependencies[node].contains(&node);
        self.components.push(Component { nodes, is_loop });
    }
}

/// One loop through a component, each node depending on the one before it; the first node is repeated at the end.
pub(crate) fn loop_through(dependencies: &[Vec<usize>], component: &Component) -> Vec<usize> {
    let Some(&first) = component.nodes.first() else { return Vec::new() };
    let mut path = vec![first];
    let mut places = HashMap::from([(first, 0)]);
    // Every node of a component depends on another one of it, so the walk goes on until it meets itself.
    while let Some(&next) = path
        .last()
        .and_then(|&node| dependencies[node].iter().find(|next| component.nodes.binary_search(next).is_ok()))
    {
        let begin = places.insert(next, path.len());
        path.push(next);
        if let Some(begin) = begin {
            path.drain(..begin);
            break;
        }
    }
    path.reverse();
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_order_and_loops() {
        // 0 <- 1 <- 2, a loop 3 <-> 4 that needs 0, a node on itself.
        let dependencies = vec![vec![], vec![0], vec![1], vec![4, 0], vec![3], vec![5]];
        let components = ordered(&dependencies);
        let place =
            |node| components.iter().position(|c: &Component| c.nodes.contains(&node)).expect("listed");
        assert!(place(0) < place(1) && place(1) < place(2) && place(0) < place(3));
        assert_eq!(place(3), place(4));
        assert!(
            components[place(3)].is_loop && components[place(5)].is_loop && !components[place(2)].is_loop
        );
        assert_eq!(loop_through(&dependencies, &components[place(3)]), [3, 4, 3]);
        assert_eq!(loop_through(&dependencies, &components[place(5)]), [5, 5]);
    }

    #[test]
    fn value_a_node_comes_after_all_that_it_depends_on_in_whatever_order_they_are_named() {
        // 1 depends on 3 and 0, named out of order; 3 depends on 2, which nobody has visited by then.
        for first in [vec![3, 0], vec![0, 3]] {
            let dependencies = vec![vec![], first, vec![], vec![2]];
            let order: Vec<usize> = ordered(&dependencies).into_iter().flat_map(|c| c.nodes).collect();
            let place = |node| order.iter().position(|n| *n == node).expect("listed");
            assert!(place(0) < place(1) && place(3) < place(1) && place(2) < place(3), "{order:?}");
        }
    }

    #[test]
    fn law_a_long_chain_needs_no_stack() {
        let dependencies: Vec<Vec<usize>> = (0..200_000)
            .map(|node: usize| node.checked_add(1).filter(|next| *next < 200_000).into_iter().collect())
            .collect();
        let components = ordered(&dependencies);
        assert_eq!(components[0].nodes, [199_999]);
        assert_eq!(components.len(), 200_000);
    }
}
