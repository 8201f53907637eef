//! All tests of the crate in one program: each file linked on its own takes seconds.

mod alone_calls;
mod alone_states;
mod alone_times;
mod common;
mod every_order;
mod readme;
mod value_declarations;
mod value_description;
