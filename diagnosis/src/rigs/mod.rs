//! What only one machine has: its candidates, its cuts of the loop, its experiments. A folder a machine.

pub mod acrobot;
