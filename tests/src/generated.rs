//! The robots of `models/` with all their functions, as compiled.

use crate::flat::{Robot, array, flat, number};

include!(concat!(env!("OUT_DIR"), "/table.rs"));
