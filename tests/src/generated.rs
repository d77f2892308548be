//! The robots of `generated/`, as compiled.

use crate::flat::{Robot, array, flat, number};

include!(concat!(env!("OUT_DIR"), "/table.rs"));
