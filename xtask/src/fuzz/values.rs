//! Random values of variables, and derivatives.

use super::calls::Sequence;
use super::random::Random;
use fmi2_export::abi::types::Text;
use std::ffi::CStr;
use std::ptr;

/// Discards what no variable gives.
pub(super) const GET_RATES: &str = "fmi2GetRealOutputDerivatives";

impl Sequence<'_> {
    /// Up to three references, mostly of the type, and whether a null pointer should stand for an array.
    fn references(&mut self, kind: char) -> (Vec<u32>, bool) {
        let of_kind: Vec<u32> = (0..self.unit.variables.len() as u32)
            .filter(|at| self.unit.variables[*at as usize].0 == kind)
            .collect();
        let count = self.random.below(4);
        let references = (0..count).map(|_| {
            if of_kind.is_empty() || self.random.per_cent(2) {
                self.random.pick(&[0, 1, self.unit.variables.len() as u32, u32::MAX])
            } else {
                self.random.pick(&of_kind)
            }
        });
        (references.collect(), self.random.per_cent(2))
    }

    pub(super) fn set(&mut self) -> Result<(), String> {
        let kind = self.random.pick(&['R', 'R', 'R', 'I', 'B', 'S']);
        let (references, null) = self.references(kind);
        let (vr, n) = (references.as_ptr(), references.len());
        let start = |at: &u32| self.unit.variables.get(*at as usize).map_or(0.0, |variable| variable.1);
        let usual: Vec<f64> = references.iter().map(start).collect();
        let c = self.c;
        // SAFETY: arrays of the length given, or null ones, which must be refused.
        let status = unsafe {
            match kind {
                'R' => {
                    let values: Vec<f64> = usual.iter().map(|usual| self.number(*usual)).collect();
                    self.tell(|| format!("set {references:?} to {values:?}"));
                    (self.api.set_real)(c, vr, n, if null { ptr::null() } else { values.as_ptr() })
                }
                'I' => {
                    let odd = [i32::MIN, i32::MAX, -1, 0, 1, 2, 3];
                    let near = |usual: &f64, random: &mut Random| *usual as i32 + random.below(5) as i32 - 2;
                    let values: Vec<i32> = usual
                        .iter()
                        .map(|usual| {
                            if self.random.per_cent(20) {
                                self.random.pick(&odd)
                            } else {
                                near(usual, &mut self.random)
                            }
                        })
                        .collect();
                    (self.api.set_integer)(c, vr, n, if null { ptr::null() } else { values.as_ptr() })
                }
                'B' => {
                    let values: Vec<i32> =
                        usual.iter().map(|_| self.random.pick(&[0, 1, 0, 1, 2, -1])).collect();
                    (self.api.set_boolean)(c, vr, n, if null { ptr::null() } else { values.as_ptr() })
                }
                _ => {
                    let texts = [c"", c"some", c"50 % #r1# %s%n", c"\xff\xfe", c"gr\xc3\xbc\xc3\x9f"];
                    let pick = |random: &mut Random| {
                        if random.per_cent(5) { ptr::null() } else { random.pick(&texts).as_ptr() }
                    };
                    let values: Vec<Text> = usual.iter().map(|_| pick(&mut self.random)).collect();
                    (self.api.set_string)(c, vr, n, if null { ptr::null() } else { values.as_ptr() })
                }
            }
        };
        self.note("fmi2Set…", status).map(drop)
    }

    pub(super) fn get(&mut self) -> Result<(), String> {
        let kind = self.random.pick(&['R', 'R', 'R', 'I', 'B', 'S']);
        let (references, null) = self.references(kind);
        let (vr, n, c) = (references.as_ptr(), references.len(), self.c);
        let (mut reals, mut integers, mut texts) = (vec![0.0; n], vec![0; n], vec![ptr::null(); n]);
        // SAFETY: arrays of the length given, or null ones, which must be refused.
        let status = unsafe {
            let out_integers = if null { ptr::null_mut() } else { integers.as_mut_ptr() };
            match kind {
                'R' => (self.api.get_real)(c, vr, n, if null { ptr::null_mut() } else { reals.as_mut_ptr() }),
                'I' => (self.api.get_integer)(c, vr, n, out_integers),
                'B' => (self.api.get_boolean)(c, vr, n, out_integers),
                _ => (self.api.get_string)(c, vr, n, if null { ptr::null_mut() } else { texts.as_mut_ptr() }),
            }
        };
        let ok = self.note("fmi2Get…", status)?;
        if ok && kind == 'S' {
            for text in texts {
                // SAFETY: the unit answered, so there are strings, until the next call.
                let text = unsafe { CStr::from_ptr(text) };
                text.to_str().map_err(|_| "fmi2GetString: not UTF-8".to_owned())?;
            }
        }
        if ok && self.sound && reals.iter().any(|value| !value.is_finite()) {
            return Err(format!("fmi2GetReal({references:?}) gave {reals:?}"));
        }
        Ok(())
    }

    pub(super) fn rates(&mut self) -> Result<(), String> {
        let (references, null) = self.references('R');
        let orders: Vec<i32> = references.iter().map(|_| self.random.pick(&[1, 1, 1, 1, 0, 2])).collect();
        let mut values: Vec<f64> = references.iter().map(|_| self.number(0.0)).collect();
        let (vr, n, order) = (references.as_ptr(), references.len(), orders.as_ptr());
        // SAFETY: arrays of the length given, or null ones, which must be refused.
        let (function, status) = unsafe {
            let out = if null { ptr::null_mut() } else { values.as_mut_ptr() };
            if self.random.per_cent(80) {
                ("fmi2SetRealInputDerivatives", (self.api.set_rates)(self.c, vr, n, order, out))
            } else {
                (GET_RATES, (self.api.get_rates)(self.c, vr, n, order, out))
            }
        };
        self.note(function, status).map(drop)
    }

    pub(super) fn derivative(&mut self) -> Result<(), String> {
        let ((unknowns, null), (knowns, _)) = (self.references('R'), self.references('R'));
        let seed: Vec<f64> = knowns.iter().map(|_| self.number(1.0)).collect();
        let mut out = vec![0.0; unknowns.len()];
        // SAFETY: arrays of the length given, or null ones, which must be refused.
        let status = unsafe {
            (self.api.derivative)(
                self.c,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                if null { ptr::null() } else { seed.as_ptr() },
                out.as_mut_ptr(),
            )
        };
        self.note("fmi2GetDirectionalDerivative", status).map(drop)
    }
}
