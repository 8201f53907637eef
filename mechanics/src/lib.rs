//! The acrobot's equations as pure functions of theta.
