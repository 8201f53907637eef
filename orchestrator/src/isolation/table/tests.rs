//! Which functions a unit may lack.

use super::{of, optional};
use crate::fmu::Function;

#[test]
fn every_function_that_a_unit_lacks_is_lacking_elsewhere() {
    let all = optional(&of(u64::MAX));
    assert_eq!(
        all.count_ones(),
        19,
        "those of the standard that a unit may leave out, without fmi2GetVersion"
    );
    for function in (0..64).filter_map(Function::of) {
        let bit = 1 << function as u8;
        assert_eq!(optional(&of(all & bit)), all & bit, "{} alone", function.name());
        assert_eq!(optional(&of(all & !bit)), all & !bit, "all but {}", function.name());
    }
}
