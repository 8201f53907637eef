//! Nothing here: the cross-check is a test.
