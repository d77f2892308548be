//! Conversion of ROS 2 bags to tables of the messages `sensor_msgs/msg/JointState`. The headers are those of PlotJuggler's
//! exports.

mod bytes;
mod cdr;
mod topics;

mod mcap;
mod sqlite;

use topics::Bag;

/// Returns the text of the table of a bag; `None` if the bytes are not a bag.
pub(super) fn table(bytes: &[u8]) -> Option<Result<Vec<u8>, String>> {
    let mut bag = Bag::default();
    let read = if bytes.starts_with(sqlite::MAGIC) {
        sqlite::read(bytes, &mut bag)
    } else if bytes.starts_with(mcap::MAGIC) {
        mcap::read(bytes, &mut bag)
    } else {
        return None;
    };
    Some(read.and_then(|()| bag.text()))
}
