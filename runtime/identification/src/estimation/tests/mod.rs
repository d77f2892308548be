//! Whole estimates: simulated robots with known parameters, and measured ones.

mod chain;
mod coverage;
mod currents;
mod data;
mod delays;
mod generated;
mod levels;
mod load;
mod measured;
mod pendulum;
mod rest;
mod simulated;
mod tilt;
