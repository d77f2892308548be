//! Exceptions to catalogue rows, by kind of robot.

use crate::dynamics::load_friction;
use crate::functions::function::Function;
use crate::model::Model;

/// Robots of which something is said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::functions) enum Robots {
    /// Those with driven joints.
    Driven,
    /// Those whose friction grows with the load.
    LoadFriction,
    /// Those with springs, inputs or wrenches at frames.
    ForcesAtFrames,
    /// Those whose B depends on the positions, because inputs act at frames.
    InputsAtFrames,
    /// Those with spherical or floating joints.
    Quaternions,
}

impl Robots {
    fn include(self, model: &Model) -> bool {
        match self {
            Self::Driven => !model.driven.is_empty(),
            Self::LoadFriction => load_friction::is_there(model),
            Self::ForcesAtFrames => {
                let has_forces = !model.point_forces.is_empty() || !model.wrenches.is_empty();
                has_forces || model.inputs_depend_on_position()
            }
            Self::InputsAtFrames => model.inputs_depend_on_position(),
            Self::Quaternions => !model.quaternion_joints.is_empty(),
        }
    }
}

/// The documentation of a function of these robots, if it is not that of the row.
#[derive(Debug, Clone, Copy)]
pub(in crate::functions) struct Otherwise {
    pub(in crate::functions) robots: Robots,
    /// The equation in place of the row's.
    pub(in crate::functions) equation: Option<&'static str>,
    /// In place of the meaning of the first result.
    pub(in crate::functions) first_result: Option<&'static str>,
    /// In place of all notes that there are.
    pub(in crate::functions) only_note: Option<&'static str>,
    /// Additional notes.
    pub(in crate::functions) notes: &'static [&'static str],
}

impl Otherwise {
    /// Nothing else is said of these robots.
    pub(in crate::functions) const fn of(robots: Robots) -> Self {
        Self { robots, equation: None, first_result: None, only_note: None, notes: &[] }
    }

    /// Says it, if it is about the robot.
    pub(in crate::functions) fn say(&self, model: &Model, function: &mut Function) {
        if !self.robots.include(model) {
            return;
        }
        if let Some(equation) = self.equation {
            equation.clone_into(&mut function.equation);
        }
        if let (Some(meaning), Some(first)) = (self.first_result, function.results.first_mut()) {
            meaning.clone_into(first);
        }
        if let Some(note) = self.only_note {
            function.notes = vec![note.to_owned()];
        }
        function.notes.extend(self.notes.iter().map(|&note| note.to_owned()));
    }
}
