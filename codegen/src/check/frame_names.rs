//! Checks frames that have the name of a link. Forces, wrenches and inputs find frames and links by the same
//! names.

use super::tree::Tree;
use crate::description::{FrameDescription, RobotDescription};
use crate::diagnostic::Report;

/// Reports frames that have the name of a link but are not at its origin. Sites of an MJCF may have the names
/// of bodies. They are reported only if a force names them.
pub(super) fn check(robot: &RobotDescription, tree: &Tree, report: &mut Report) {
    for frame in robot.frames.iter().filter(|frame| !frame.is_site && is_ambiguous(frame, tree)) {
        let (name, link) = (&frame.name.value, &frame.link.value);
        let place = match link == name {
            true => format!("frame `{name}` is not at the origin of link `{name}`, which has the same name"),
            false => format!("frame `{name}` is on link `{link}`, but another link is called `{name}`"),
        };
        report.error(frame.name.span, "ambiguous-name", place);
        report.help("forces, inputs and wrenches find frames and links by the same names: rename the frame");
    }
}

/// Whether the name of a frame is also that of a link at another place.
pub(super) fn is_ambiguous(frame: &FrameDescription, tree: &Tree) -> bool {
    tree.index.contains_key(&frame.name.value)
        && !(frame.link.value == frame.name.value && frame.pose.is_identity())
}
