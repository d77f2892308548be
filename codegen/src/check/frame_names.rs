//! Frames that are called as links are: where forces, wrenches and inputs act, a name stands for either.

use super::tree::Tree;
use crate::description::{FrameDescription, RobotDescription};
use crate::diagnostic::Report;

/// Reports frames with the name of a link that are not at its origin. Sites of an MJCF have names of their own:
/// they are reported if a force names them ([`is_ambiguous`]).
pub(super) fn check(robot: &RobotDescription, tree: &Tree, report: &mut Report) {
    for frame in robot.frames.iter().filter(|frame| !frame.is_site && is_ambiguous(frame, tree)) {
        let (name, link) = (&frame.name.value, &frame.link.value);
        let place = match link == name {
            true => format!("frame `{name}` is not at the origin of link `{name}`, which has the same name"),
            false => format!("frame `{name}` is on link `{link}`, and another link is called `{name}` too"),
        };
        report.error(frame.name.span, "ambiguous-name", place);
        report.help(
            "forces, inputs and wrenches name frames and links alike: give the frame a name of its own",
        );
    }
}

/// Whether the name of a frame stands for another place too: the origin of a link.
pub(super) fn is_ambiguous(frame: &FrameDescription, tree: &Tree) -> bool {
    tree.index.contains_key(&frame.name.value)
        && !(frame.link.value == frame.name.value && frame.pose.is_identity())
}
