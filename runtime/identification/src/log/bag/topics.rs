//! Conversion of the joint states of a bag to a table.

use super::super::packed::{LARGEST, unpacked};
use super::cdr::JointState;
use std::collections::{BTreeMap, BTreeSet};

const TYPE: &str = "sensor_msgs/msg/JointState";
/// Quantities of a joint state, in the order of the message.
const QUANTITIES: [&str; 3] = ["position", "velocity", "effort"];
/// Nanoseconds in a second.
const NANOSECONDS: i128 = 1_000_000_000;

/// Content of a bag: topics and messages.
#[derive(Debug, Default)]
pub(super) struct Bag {
    /// Name and type of each topic, by its number.
    topics: BTreeMap<i64, [String; 2]>,
    /// Topic, time of arrival in ns, and content of each message.
    messages: Vec<(i64, i64, JointState)>,
    /// Total number of bytes of all messages.
    size: u64,
}

impl Bag {
    pub(super) fn topic(&mut self, id: i64, name: &str, kind: &str, encoding: &str) {
        let kind = if encoding == "cdr" { kind.to_owned() } else { format!("{kind} in {encoding}") };
        self.topics.insert(id, [name.to_owned(), kind]);
    }

    pub(super) fn message(&mut self, topic: i64, time: i64, data: &[u8]) -> Result<(), String> {
        let Some([name, _]) = self.topics.get(&topic).filter(|[_, kind]| kind == TYPE) else { return Ok(()) };
        let data = unpacked(data, LARGEST - self.size)?;
        self.size = (self.size + data.len() as u64).min(LARGEST);
        let state = JointState::decode(&data);
        let state = state.ok_or_else(|| {
            format!("a message of topic {name} cannot be decoded as {TYPE}: record the bag again")
        })?;
        self.messages.push((topic, time, state));
        Ok(())
    }

    /// Returns whether the time stamps of a topic are times. Some publishers leave the stamps zero, or never change them.
    fn is_stamped(&self, topic: i64) -> bool {
        let stamps = self.messages.iter().filter(|(of, ..)| *of == topic).map(|(.., state)| state.stamp);
        let (zeros, others): (Vec<_>, Vec<_>) = stamps.partition(|stamp| *stamp == (0, 0));
        zeros.len() < others.len() && others.iter().any(|stamp| *stamp != others[0])
    }

    /// Returns the text of a table with one row for each message. Columns of other joints and topics are empty in this row.
    pub(super) fn text(&self) -> Result<Vec<u8>, String> {
        if self.messages.is_empty() {
            let topics: Vec<String> =
                self.topics.values().map(|[name, kind]| format!("{name} ({kind})")).collect();
            let topics = if topics.is_empty() { "none".to_owned() } else { topics.join(", ") };
            return Err(format!(
                "the bag has no messages of type {TYPE}. Record a topic of this type. The topics of the bag are: {topics}"
            ));
        }
        let mut columns = BTreeMap::new();
        for (topic, _, state) in &self.messages {
            let kinds = (0..QUANTITIES.len()).filter(|kind| !state.values[*kind].is_empty());
            for (kind, name) in kinds.flat_map(|kind| state.names.iter().map(move |name| (kind, name))) {
                let next = columns.len() + 1;
                columns.entry((*topic, name, kind)).or_insert(next);
            }
        }
        let stamped: BTreeSet<i64> =
            self.topics.keys().copied().filter(|topic| self.is_stamped(*topic)).collect();
        let mut rows = vec![String::new(); 1 + columns.len()];
        rows[0] = if stamped.is_empty() { "bag/time" } else { "header/stamp" }.to_owned();
        for ((topic, name, kind), place) in &columns {
            rows[*place] = format!("{}/{name}/{}", self.topics[topic][0], QUANTITIES[*kind]);
        }
        let mut csv = csv::Writer::from_writer(Vec::new());
        csv.write_record(&rows).map_err(|error| error.to_string())?;
        for (topic, time, state) in &self.messages {
            rows.iter_mut().for_each(String::clear);
            let [whole, rest] = [i128::from(state.stamp.0), i128::from(state.stamp.1)];
            rows[0] = match stamped.contains(topic) {
                true => seconds(whole * NANOSECONDS + rest),
                false => seconds(i128::from(*time)),
            };
            for (kind, values) in state.values.iter().enumerate() {
                for (name, value) in state.names.iter().zip(values) {
                    rows[columns[&(*topic, name, kind)]] = value.to_string();
                }
            }
            csv.write_record(&rows).map_err(|error| error.to_string())?;
        }
        csv.into_inner().map_err(|error| error.to_string())
    }
}

fn seconds(nanoseconds: i128) -> String {
    let size = nanoseconds.unsigned_abs();
    let (whole, rest) = (size / NANOSECONDS.unsigned_abs(), size % NANOSECONDS.unsigned_abs());
    format!("{}{whole}.{rest:09}", if nanoseconds < 0 { "-" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(messages: Vec<(i64, i64, JointState)>) -> String {
        let mut bag = Bag::default();
        bag.topic(1, "/states", TYPE, "cdr");
        bag.topic(2, "/commands", TYPE, "cdr");
        bag.messages = messages;
        String::from_utf8(bag.text().unwrap()).unwrap()
    }

    fn joint(stamp: (i32, u32), values: [Vec<f64>; 3]) -> JointState {
        JointState { stamp, names: vec!["a".to_owned()], values }
    }

    /// Simulated time begins at 0, commands have no time stamps, and no message has velocities.
    #[test]
    fn each_topic_has_its_own_times_and_columns_only_if_there_are_values() {
        let state = |k: i32| {
            let stamp = (k, 500_000_000 * u32::from(k > 0));
            (1, 5_000_000_000, joint(stamp, [vec![1.0], vec![], vec![2.0]]))
        };
        let command = (2, 7_250_000_000, joint((0, 0), [vec![3.0], vec![], vec![]]));
        let text = table(vec![state(0), state(1), command, state(2)]);
        assert_eq!(
            text,
            "header/stamp,/states/a/position,/states/a/effort,/commands/a/position\n\
             0.000000000,1,2,\n1.500000000,1,2,\n7.250000000,,,3\n2.500000000,1,2,\n"
        );
        let before = table(vec![(1, -500_000_000, joint((0, 0), [vec![1.0], vec![], vec![]]))]);
        assert_eq!(before, "bag/time,/states/a/position\n-0.500000000,1\n");
    }
}
