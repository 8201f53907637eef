//! Variables of a unit that move in one call a type, and those calls. Laid out by `wiring/layout.rs`, used by each step
//! of `system.rs`.

use crate::error::Error;
use crate::fmu::Instance;
use crate::system::Values;
use crate::text::Text;
use std::cell::Cell;

/// Variables of one type that are set or read in one call: their references, and where their values begin.
#[derive(Debug, Clone, Default)]
pub(crate) struct Block {
    pub(crate) references: Vec<u32>,
    pub(crate) at: usize,
    /// Where each value is copied from before it is set; its own place where no plain copy leads to it. Empty if there
    /// is none at all.
    sources: Vec<u32>,
}

impl Block {
    pub(crate) fn new(references: Vec<u32>, at: usize) -> Self {
        Self { references, at, sources: Vec::new() }
    }

    /// Has a value copied before it is set; both are places among all values of the type.
    pub(crate) fn copy(&mut self, from: u32, to: u32) {
        if self.sources.is_empty() {
            self.sources = (self.at as u32..).take(self.references.len()).collect();
        }
        self.sources[to as usize - self.at] = from;
    }

    /// The plain copies: where each value comes from, and where it goes.
    pub(crate) fn copies(&self) -> impl Iterator<Item = (usize, usize)> {
        let copies = (self.at..).zip(&self.sources).map(|(to, from)| (*from as usize, to));
        copies.filter(|(from, to)| from != to)
    }

    /// Its values among all of the type.
    #[inline(always)]
    pub(crate) fn of<'a, T>(&self, all: &'a [T]) -> &'a [T] {
        &all[self.at..][..self.references.len()]
    }

    /// The same, to be written.
    #[inline(always)]
    fn within<'a, T>(&self, all: &'a mut [T]) -> &'a mut [T] {
        &mut all[self.at..][..self.references.len()]
    }

    /// The same, once what is to be copied is.
    #[inline(always)]
    fn fetched<'a, T: Copy>(&self, all: &'a mut [T], convert: impl Fn(T) -> T) -> &'a [T] {
        let (at, length) = (self.at, self.references.len());
        let cells = Cell::from_mut(&mut *all).as_slice_of_cells();
        for (number, to) in cells[at..][..length].iter().enumerate() {
            // Shorter than a zip, which first finds out which of the two is the longer one.
            let Some(&from) = self.sources.get(number) else { break };
            to.set(convert(cells[from as usize].get()));
        }
        &all[at..][..length]
    }

    /// The same for texts.
    #[inline(always)]
    fn fetched_texts<'a>(&self, all: &'a mut [Text]) -> &'a [Text] {
        for (to, &from) in (self.at..).zip(&self.sources) {
            if !all[to].is(&all[from as usize]) {
                take_over(all, from as usize, to);
            }
        }
        self.of(all)
    }

    /// Never inlined, so that numbers keep their registers; the error is boxed, so that it comes back in one.
    #[inline(never)]
    fn set_texts<const FETCH: bool>(
        &self,
        instance: &mut Instance,
        all: &mut [Text],
    ) -> Result<(), Box<Error>> {
        let given = if FETCH { self.fetched_texts(all) } else { self.of(all) };
        Ok(instance.set_texts(&self.references, given)?)
    }

    /// Likewise.
    #[inline(never)]
    fn get_texts(&self, instance: &mut Instance, all: &mut [Text]) -> Result<(), Box<Error>> {
        Ok(instance.get_texts(&self.references, self.within(all))?)
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.references.is_empty()
    }
}

/// A block for each type.
#[derive(Debug, Clone, Default)]
pub(crate) struct Blocks {
    pub(crate) reals: Block,
    pub(crate) integers: Block,
    pub(crate) booleans: Block,
    pub(crate) strings: Block,
    /// There is something besides reals.
    pub(crate) mixed: bool,
    /// The first so many reals go to other units and must be finite.
    pub(crate) connected: usize,
}

impl Blocks {
    /// Makes the plain copies: values as they are, Booleans as 1 for whatever is not 0.
    #[inline(always)]
    pub(crate) fn fetch(&self, values: &mut Values) {
        self.reals.fetched(&mut values.reals, |value| value);
        if self.mixed {
            self.integers.fetched(&mut values.integers, |value| value);
            self.booleans.fetched(&mut values.integers, truth);
            self.strings.fetched_texts(&mut values.strings);
        }
    }

    /// Sets all of them, with `FETCH` once the plain copies are made: type by type, so that each is looked up once.
    #[inline(always)]
    pub(crate) fn set<const FETCH: bool>(
        &self,
        instance: &mut Instance,
        values: &mut Values,
    ) -> Result<(), Box<Error>> {
        let Self { reals, integers, booleans, strings, mixed, .. } = self;
        if !reals.is_empty() {
            let all = values.reals.as_mut_slice();
            let given = if FETCH { reals.fetched(all, |value| value) } else { reals.of(all) };
            instance.write_real(&reals.references, given)?;
        }
        if *mixed {
            let all = values.integers.as_mut_slice();
            if !integers.is_empty() {
                let given = if FETCH { integers.fetched(all, |value| value) } else { integers.of(all) };
                instance.write_integer(&integers.references, given)?;
            }
            if !booleans.is_empty() {
                let given = if FETCH { booleans.fetched(all, truth) } else { booleans.of(all) };
                instance.write_boolean(&booleans.references, given)?;
            }
            if !strings.is_empty() {
                strings.set_texts::<FETCH>(instance, &mut values.strings)?;
            }
        }
        Ok(())
    }

    /// As [`Blocks::get`], where the unit was not entered: outside the loop of steps.
    #[cold]
    pub(crate) fn read(&self, instance: &mut Instance, values: &mut Values) -> Result<bool, Box<Error>> {
        crate::guard::within(instance.label(), || self.get(instance, values))
    }

    /// Reads all of them; false if a real is not finite. Of a unit that was entered.
    #[inline(always)]
    pub(crate) fn get(&self, instance: &mut Instance, values: &mut Values) -> Result<bool, Box<Error>> {
        let Self { reals, integers, booleans, strings, mixed, .. } = self;
        let mut finite = true;
        if !reals.is_empty() {
            let read = reals.within(&mut values.reals);
            instance.read_real(&reals.references, read)?;
            // Zero times what is not finite is NaN, which stays in the sum: one comparison for all of them.
            finite = !read.iter().fold(0.0, |sum, value| sum + value * 0.0).is_nan();
        }
        if *mixed {
            let all = values.integers.as_mut_slice();
            if !integers.is_empty() {
                instance.read_integer(&integers.references, integers.within(all))?;
            }
            if !booleans.is_empty() {
                instance.read_boolean(&booleans.references, booleans.within(all))?;
            }
            if !strings.is_empty() {
                strings.get_texts(instance, &mut values.strings)?;
            }
        }
        Ok(finite)
    }
}

/// The values of some blocks by themselves.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    pub(crate) values: Values,
}

impl Desk {
    /// A desk for some blocks, and these as they lie there.
    pub(crate) fn of<const N: usize>(blocks: [&Blocks; N]) -> (Self, [Blocks; N]) {
        let mut values = Values::default();
        let laid = blocks.map(|blocks| {
            let mut laid = blocks.clone();
            let lay = |block: &mut Block, begin: &mut usize| {
                // Copies are made where all values are.
                block.sources.clear();
                block.at = *begin;
                *begin += block.references.len();
            };
            let (mut reals, mut integers) = (values.reals.len(), values.integers.len());
            let mut strings = values.strings.len();
            lay(&mut laid.reals, &mut reals);
            lay(&mut laid.integers, &mut integers);
            lay(&mut laid.booleans, &mut integers);
            lay(&mut laid.strings, &mut strings);
            values.reals.resize(reals, 0.0);
            values.integers.resize(integers, 0);
            values.strings.resize(strings, Text::default());
            laid
        });
        (Self { values }, laid)
    }

    /// Brings the values of blocks, which lie as `here`, from where they lie among all.
    pub(crate) fn bring(&mut self, here: &Blocks, there: &Blocks, all: &Values) {
        hand_over((there, all), (here, &mut self.values));
    }

    /// Takes them back there.
    pub(crate) fn take(&self, here: &Blocks, there: &Blocks, all: &mut Values) {
        hand_over((here, &self.values), (there, all));
    }
}

fn hand_over((blocks, from): (&Blocks, &Values), (others, to): (&Blocks, &mut Values)) {
    others.reals.within(&mut to.reals).copy_from_slice(blocks.reals.of(&from.reals));
    if blocks.mixed {
        others.integers.within(&mut to.integers).copy_from_slice(blocks.integers.of(&from.integers));
        others.booleans.within(&mut to.integers).copy_from_slice(blocks.booleans.of(&from.integers));
        others.strings.within(&mut to.strings).clone_from_slice(blocks.strings.of(&from.strings));
    }
}

/// Texts change rarely.
#[cold]
#[inline(never)]
fn take_over(all: &mut [Text], from: usize, to: usize) {
    all[to] = all[from].clone();
}

fn truth(value: i32) -> i32 {
    i32::from(value != 0)
}
