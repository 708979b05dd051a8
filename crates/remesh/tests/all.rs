//! All tests of `nastic-remesh`.
