//! Getting and setting variables, and their derivatives. A call that is refused changes nothing.

use crate::description::derivative;
use crate::error::Error;
use crate::instance::Instance;
use crate::model::Model;
use crate::state_machine::{Mode, settable};
use crate::table::{Causality, Kind, Slot, SlotMut, Table, Variability, Variable};
use std::ffi::{CString, c_char};
use std::mem::MaybeUninit;

impl Kind {
    fn type_name(&self) -> &'static str {
        match self {
            Kind::Real(_) => "Real",
            Kind::Integer(_) => "Integer",
            Kind::Boolean(_) => "Boolean",
            Kind::String(_) => "String",
        }
    }
}

impl Variable {
    /// What it is, in words for a message.
    fn what(&self) -> &'static str {
        match (self.causality, self.variability) {
            (Causality::Input, _) => "an input",
            (Causality::Output, _) => "an output",
            (Causality::Local, _) => "a local variable",
            (Causality::Parameter, Variability::Fixed) => "a fixed parameter",
            (Causality::Parameter, _) => "a tunable parameter",
        }
    }
}

impl<M: Model> Instance<M> {
    fn variable(&self, reference: u32) -> Result<&Variable, Error> {
        // `ok_or` would make and drop an error for each value that is read or set.
        let wrong = || Error::Reference { reference, last: self.declared.len().saturating_sub(1) };
        self.declared.get(reference as usize).ok_or_else(wrong)
    }

    /// Before values are read: checks the references, computes what is stale.
    fn prepare(&mut self, references: &[u32], is_type: fn(&Kind) -> bool) -> Result<(), Error> {
        let mut computed = false;
        for &reference in references {
            let variable = self.variable(reference)?;
            if !is_type(&variable.kind) {
                return Err(Error::Type { name: variable.name, reference, is: variable.kind.type_name() });
            }
            computed |= matches!(variable.causality, Causality::Output | Causality::Local);
        }
        if computed { self.refresh() } else { Ok(()) }
    }

    /// `fmi2GetReal`.
    pub fn get_real(&mut self, references: &[u32], out: &mut [MaybeUninit<f64>]) -> Result<(), Error> {
        self.prepare(references, is_real)?;
        for (&reference, out) in references.iter().zip(out) {
            if let Some(Slot::Real(value)) = self.state.values.get(reference as usize) {
                out.write(*value);
            }
        }
        Ok(())
    }

    /// `fmi2GetRealOutputDerivatives`: the values of the variables that are declared as derivatives of these outputs.
    pub fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        out: &mut [MaybeUninit<f64>],
    ) -> Result<(), Error> {
        let mut places = Vec::with_capacity(references.len());
        for (&reference, &order) in references.iter().zip(orders) {
            let variable = self.variable(reference)?;
            let name = variable.name;
            if variable.causality != Causality::Output {
                return Err(Error::NotOutput { name, what: variable.what() });
            }
            let steps = usize::try_from(order).ok().filter(|&order| order > 0);
            let place = steps.and_then(|order| derivative(&self.declared, name, order));
            places.push(place.ok_or(Error::NoOutputDerivative { name, order })? as u32);
        }
        self.get_real(&places, out)
    }

    /// `fmi2GetInteger`.
    pub fn get_integer(&mut self, references: &[u32], out: &mut [MaybeUninit<i32>]) -> Result<(), Error> {
        self.prepare(references, is_integer)?;
        for (&reference, out) in references.iter().zip(out) {
            if let Some(Slot::Integer(value)) = self.state.values.get(reference as usize) {
                out.write(*value);
            }
        }
        Ok(())
    }

    /// `fmi2GetBoolean`.
    pub fn get_boolean(&mut self, references: &[u32], out: &mut [MaybeUninit<i32>]) -> Result<(), Error> {
        self.prepare(references, is_boolean)?;
        for (&reference, out) in references.iter().zip(out) {
            if let Some(Slot::Boolean(value)) = self.state.values.get(reference as usize) {
                out.write(i32::from(*value));
            }
        }
        Ok(())
    }

    /// `fmi2GetString`: the strings stay valid until the next call.
    pub fn get_string(
        &mut self,
        references: &[u32],
        out: &mut [MaybeUninit<*const c_char>],
    ) -> Result<(), Error> {
        self.prepare(references, is_string)?;
        let mut lent = Vec::with_capacity(references.len());
        for &reference in references {
            if let Some(Slot::String(value)) = self.state.values.get(reference as usize) {
                let name = self.variable(reference)?.name;
                lent.push(CString::new(value).map_err(|_| Error::ZeroByte { name })?);
            }
        }
        self.lent = lent;
        for (string, out) in self.lent.iter().zip(out) {
            out.write(string.as_ptr());
        }
        Ok(())
    }

    /// Checks that a variable of this type may be set now.
    fn check_set(&self, reference: u32, is_type: fn(&Kind) -> bool) -> Result<&Variable, Error> {
        let variable = self.variable(reference)?;
        if !is_type(&variable.kind) {
            return Err(Error::Type { name: variable.name, reference, is: variable.kind.type_name() });
        }
        if !settable(variable, self.state.mode) {
            let mode = self.state.mode.name();
            return Err(Error::NotSettable { name: variable.name, what: variable.what(), mode });
        }
        Ok(variable)
    }

    /// Writes values that were checked.
    fn write(&mut self, references: &[u32], mut put: impl FnMut(usize, SlotMut<'_>)) {
        for (at, &reference) in references.iter().enumerate() {
            if let Some(slot) = self.state.values.get_mut(reference as usize) {
                put(at, slot);
            }
        }
        if self.state.mode == Mode::Initialization && !references.is_empty() {
            self.state.stale = true;
        }
    }

    /// `fmi2SetReal`.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), Error> {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.check_set(reference, is_real)?;
            if !value.is_finite() {
                return Err(Error::NotFinite { name: variable.name, value });
            }
            check_range(variable, value)?;
        }
        self.write(references, |at, slot| {
            if let SlotMut::Real(slot) = slot {
                *slot = values[at];
            }
        });
        Ok(())
    }

    /// `fmi2SetInteger`.
    pub fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), Error> {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.check_set(reference, is_integer)?;
            check_range(variable, f64::from(value))?;
        }
        self.write(references, |at, slot| {
            if let SlotMut::Integer(slot) = slot {
                *slot = values[at];
            }
        });
        Ok(())
    }

    /// `fmi2SetBoolean`.
    pub fn set_boolean(&mut self, references: &[u32], values: &[i32]) -> Result<(), Error> {
        for (&reference, &value) in references.iter().zip(values) {
            let variable = self.check_set(reference, is_boolean)?;
            if value != 0 && value != 1 {
                return Err(Error::NotBoolean { name: variable.name, value });
            }
        }
        self.write(references, |at, slot| {
            if let SlotMut::Boolean(slot) = slot {
                *slot = values[at] != 0;
            }
        });
        Ok(())
    }

    /// `fmi2SetString`. The bytes of each string, or `None` for a null pointer.
    pub fn set_string(&mut self, references: &[u32], values: &[Option<&[u8]>]) -> Result<(), Error> {
        let mut texts = Vec::with_capacity(values.len());
        for (&reference, value) in references.iter().zip(values) {
            let name = self.check_set(reference, is_string)?.name;
            let bytes = value.ok_or(Error::NullString { name })?;
            texts.push(std::str::from_utf8(bytes).map_err(|_| Error::NotUtf8 { name })?);
        }
        self.write(references, |at, slot| {
            if let SlotMut::String(slot) = slot {
                texts[at].clone_into(slot);
            }
        });
        Ok(())
    }

    /// `fmi2SetRealInputDerivatives`: kept for the next step.
    pub fn set_input_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Error> {
        for ((&reference, &order), &value) in references.iter().zip(orders).zip(values) {
            let variable = self.variable(reference)?;
            let name = variable.name;
            if variable.causality != Causality::Input {
                return Err(Error::NotInput { name, what: variable.what() });
            }
            if !matches!(variable.kind, Kind::Real(_)) {
                return Err(Error::Type { name, reference, is: variable.kind.type_name() });
            }
            if order != 1 {
                return Err(Error::Order { name, order });
            }
            if !value.is_finite() {
                return Err(Error::NotFinite { name, value });
            }
        }
        let rates = &mut self.state.input_rates;
        for (&reference, &value) in references.iter().zip(values) {
            match rates.iter_mut().find(|(known, _)| *known == reference) {
                Some((_, rate)) => *rate = value,
                None => rates.push((reference, value)),
            }
        }
        Ok(())
    }

    /// `fmi2GetDirectionalDerivative`: Δunknown = Σ ∂unknown/∂known · Δknown.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        out: &mut [MaybeUninit<f64>],
    ) -> Result<(), Error> {
        for &reference in unknowns.iter().chain(knowns) {
            let variable = self.variable(reference)?;
            if !matches!(variable.kind, Kind::Real(_)) {
                return Err(Error::Type { name: variable.name, reference, is: variable.kind.type_name() });
            }
        }
        self.refresh()?;
        let mut answers = Vec::with_capacity(unknowns.len());
        for &unknown in unknowns {
            let unknown = self.variable(unknown)?.name;
            let mut sum = 0.0;
            for (&known, &change) in knowns.iter().zip(seed) {
                let known = self.variable(known)?.name;
                if !change.is_finite() {
                    return Err(Error::NotFinite { name: known, value: change });
                }
                let answer = self.state.model.derivative(&self.state.values, unknown, known);
                let provided = answer.filter(|_| self.description.provides_derivatives);
                sum += provided.ok_or(Error::NoDerivative { unknown, known })? * change;
            }
            if !sum.is_finite() {
                return Err(Error::NotFinite { name: unknown, value: sum });
            }
            answers.push(sum);
        }
        for (answer, out) in answers.into_iter().zip(out) {
            out.write(answer);
        }
        Ok(())
    }
}

fn check_range(variable: &Variable, value: f64) -> Result<(), Error> {
    let min = variable.min.unwrap_or(f64::NEG_INFINITY);
    let max = variable.max.unwrap_or(f64::INFINITY);
    if value < min || value > max {
        return Err(Error::Range { name: variable.name, value, min, max });
    }
    Ok(())
}

fn is_real(kind: &Kind) -> bool {
    matches!(kind, Kind::Real(_))
}

fn is_integer(kind: &Kind) -> bool {
    matches!(kind, Kind::Integer(_))
}

fn is_boolean(kind: &Kind) -> bool {
    matches!(kind, Kind::Boolean(_))
}

fn is_string(kind: &Kind) -> bool {
    matches!(kind, Kind::String(_))
}
