//! Torque–speed lines of motors as limits on inputs and velocities.

use super::{Drive, Input, Model};

/// A limit `|u + C ẏ| ≤ limit` on an input u and the velocities ẏ, with constant factors C. All terms have
/// the unit of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitedInput {
    /// Index of the limited input.
    pub input: usize,
    /// Factors C of the velocities in `|u + C ẏ| ≤ limit`, one for each coordinate.
    pub slopes: Vec<f64>,
    /// Limit of the input's magnitude at zero velocity, in the unit of the input.
    pub limit: f64,
}

impl Model {
    /// Limits of the inputs whose motors have a torque–speed line: `|K u + c i wᵀ ẏ| ≤ τ₀` with c = τ₀/ω₀,
    /// divided by K.
    ///
    /// - K: torque per unit of the input
    /// - i: gear ratio
    /// - w: ratios of the coordinates
    /// - τ₀: stall torque
    /// - ω₀: no-load speed
    ///
    /// If a ratio depends on parameters without a given value, the line is left out. Valid descriptions contain
    /// no such line.
    ///
    /// - `parameters`: values of the free parameters
    #[must_use]
    pub fn limited_inputs(&self, parameters: &[f64]) -> Vec<LimitedInput> {
        let drives = self.input_drives().enumerate();
        drives.filter_map(|(input, drive)| self.limited_input(input, drive, parameters)).collect()
    }

    fn limited_input(&self, input: usize, drive: &Drive, parameters: &[f64]) -> Option<LimitedInput> {
        let line = drive.line?;
        let torque = match &drive.input {
            Input::Torque | Input::None => 1.0,
            Input::Current(constant) => constant.value(parameters)?,
        };
        let slope = line.stall_torque / line.no_load_speed * drive.gear_ratio.value(parameters)? / torque;
        let mut slopes = vec![0.0; self.coordinates.len()];
        for moved in &drive.acts_on {
            // The motor of a driven joint has no torque–speed line.
            *slopes.get_mut(moved.coordinate)? += slope * moved.ratio.value(parameters)?;
        }
        Some(LimitedInput { input, slopes, limit: line.stall_torque / torque.abs() })
    }
}
