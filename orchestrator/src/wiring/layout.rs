//! Where each value lies: per unit and type one contiguous range for what is set and one for what is read, so that
//! one call moves all of them.

use super::names::{Names, Variable};
use super::{Connection, Source};
use crate::blocks::{Block, Blocks};
use crate::fmu::{Causality, Instance, Variability};
use crate::recorder::Slot;
use crate::system::{Unit, Values};
use crate::text::Text;
use crate::value::Kind;
use std::collections::{BTreeSet, HashMap};

/// The layout of a system.
pub(super) struct Layout {
    pub(super) blocks: Vec<UnitBlocks>,
    pub(super) slots: HashMap<Variable, Slot>,
    pub(super) values: Values,
}

/// The blocks of one unit.
pub(super) struct UnitBlocks {
    name: String,
    inputs: Blocks,
    outputs: Blocks,
    fixed: Blocks,
}

impl Layout {
    pub(super) fn new(
        names: &Names,
        connections: &[Connection],
        sources: &[Source],
        recorded: &[Variable],
    ) -> Self {
        let mut layout = Self { blocks: Vec::new(), slots: HashMap::new(), values: Values::default() };
        let driven: BTreeSet<Variable> =
            connections.iter().map(|c| c.to).chain(sources.iter().map(|s| s.to)).collect();
        let connected: BTreeSet<Variable> = connections.iter().map(|c| c.from).collect();
        let recorded: BTreeSet<Variable> = recorded.iter().copied().collect();
        for unit in 0..names.units.len() {
            let of =
                |set: &BTreeSet<Variable>| set.range((unit, 0)..(unit + 1, 0)).copied().collect::<Vec<_>>();
            let changes = |variable: &Variable| {
                let description = names.variable(*variable);
                matches!(description.causality, Causality::Output | Causality::Local | Causality::Independent)
                    && matches!(description.variability, Variability::Discrete | Variability::Continuous)
            };
            // Outputs that go to other units come first.
            let mut outputs = of(&connected);
            let (moving, fixed): (Vec<_>, Vec<_>) = (of(&recorded).into_iter())
                .filter(|variable| !driven.contains(variable) && !connected.contains(variable))
                .partition(changes);
            outputs.extend(moving);
            let inputs = layout.blocks_of(names, &of(&driven));
            let mut outputs = layout.blocks_of(names, &outputs);
            let real = |variable: &&Variable| names.variable(**variable).kind == Kind::Real;
            outputs.connected = of(&connected).iter().filter(real).count();
            let fixed = layout.blocks_of(names, &fixed);
            let blocks = UnitBlocks { name: names.units[unit].0.clone(), inputs, outputs, fixed };
            layout.blocks.push(blocks);
        }
        layout
    }

    fn blocks_of(&mut self, names: &Names, variables: &[Variable]) -> Blocks {
        let mut block = |kind: Kind| self.block(names, variables, kind);
        let (reals, integers) = (block(Kind::Real), block(Kind::Integer));
        let (booleans, strings) = (block(Kind::Boolean), block(Kind::String));
        let mixed = [&integers, &booleans, &strings].iter().any(|block| !block.references.is_empty());
        Blocks { reals, integers, booleans, strings, mixed, connected: 0 }
    }

    fn block(&mut self, names: &Names, variables: &[Variable], kind: Kind) -> Block {
        let values = &mut self.values;
        let length = |values: &Values| match kind {
            Kind::Real => values.reals.len(),
            Kind::Integer | Kind::Boolean => values.integers.len(),
            Kind::String => values.strings.len(),
        };
        let begin = length(values);
        let mut references = Vec::new();
        for &variable in variables {
            let description = names.variable(variable);
            if description.kind != kind {
                continue;
            }
            let at = length(values) as u32; // a system of 2³² variables doesn't fit the memory
            let slot = match kind {
                Kind::Real => {
                    values.reals.push(0.0);
                    Slot::Real(at)
                }
                Kind::Integer => {
                    values.integers.push(0);
                    Slot::Integer(at)
                }
                Kind::Boolean => {
                    values.integers.push(0);
                    Slot::Boolean(at)
                }
                Kind::String => {
                    values.strings.push(Text::default());
                    Slot::String(at)
                }
            };
            references.push(description.reference);
            self.slots.insert(variable, slot);
        }
        Block::new(references, begin)
    }
}

impl UnitBlocks {
    pub(super) fn unit(
        self,
        instance: Instance,
        interval: i64,
        size: f64,
        ends: [Option<(i64, f64)>; 2],
    ) -> Unit {
        let Self { name, inputs, outputs, fixed } = self;
        let [first, last] = ends;
        Unit {
            name,
            instance,
            interval,
            reach: interval,
            step: interval,
            size,
            whole: size,
            first,
            last,
            begin: 0.0,
            links: Vec::new(),
            lines_in: Vec::new(),
            feeds: Vec::new(),
            lines_out: Vec::new(),
            inputs,
            outputs,
            fixed,
            not_finite: Vec::new(),
            rollback: crate::rollback::Rollback::default(),
            plain: false,
        }
    }
}
