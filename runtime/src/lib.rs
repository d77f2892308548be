//! Control and identification of generated robots.
