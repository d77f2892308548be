//! Frames of a description that extends another description.

use crate::description::{FrameDescription, RobotDescription};
use crate::function_names::FrameKind;
use crate::model::name::identifier;

/// Replaces the frames of the extended description by the frames of the extension. A frame of the extended
/// description is kept if a force, an input, a wrench or a requested function names it.
///
/// - `whole`: extended description with the extension, except the frames of the extension
pub(super) fn replace(whole: &mut RobotDescription, frames: Vec<FrameDescription>) {
    if frames.is_empty() {
        return;
    }
    let before = std::mem::take(&mut whole.frames);
    let is_new = |frame: &FrameDescription| frames.iter().any(|new| new.name.value == frame.name.value);
    let kept = before
        .into_iter()
        .filter(|frame| !is_new(frame) && (is_needed(frame, whole) || is_asked_for(frame, whole)));
    whole.frames = kept.collect::<Vec<_>>().into_iter().chain(frames).collect();
}

/// Whether a force, an input or a wrench names the frame and does not mean a link by this name.
fn is_needed(frame: &FrameDescription, whole: &RobotDescription) -> bool {
    let is_own = frame.link.value == frame.name.value && frame.pose.is_identity();
    !is_own && whole.names_at_frames().any(|name| name.value == frame.name.value)
}

/// Whether a function of the frame is requested by name.
fn is_asked_for(frame: &FrameDescription, whole: &RobotDescription) -> bool {
    let functions = whole.options.iter().flat_map(|options| &options.functions);
    let own = FrameKind::ALL.map(|kind| kind.function(&identifier(&frame.name.value)));
    functions.into_iter().any(|function| own.contains(function))
}
