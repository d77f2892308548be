//! The robots of `models/` as generated Rust.
