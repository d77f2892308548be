//! Verdicts of the short form, each with the cause that flips it.
