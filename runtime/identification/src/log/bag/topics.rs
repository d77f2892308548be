//! Topics of a bag and the states of joints on them, as a table.

use super::super::packed::unpacked;
use super::cdr::JointState;
use std::collections::BTreeMap;

const TYPE: &str = "sensor_msgs/msg/JointState";

/// Topics of a bag and their states of joints.
#[derive(Debug, Default)]
pub(super) struct Bag {
    /// Names and types.
    topics: BTreeMap<i64, [String; 2]>,
    /// Topic, time of arrival in nanoseconds, and message.
    messages: Vec<(i64, i64, JointState)>,
}

impl Bag {
    pub(super) fn topic(&mut self, id: i64, name: &str, kind: &str, encoding: &str) {
        let kind = if encoding == "cdr" { kind.to_owned() } else { format!("{kind} in {encoding}") };
        self.topics.insert(id, [name.to_owned(), kind]);
    }

    pub(super) fn message(&mut self, topic: i64, time: i64, data: &[u8]) -> Result<(), String> {
        let Some([name, _]) = self.topics.get(&topic).filter(|[_, kind]| kind == TYPE) else { return Ok(()) };
        let state = JointState::decode(&unpacked(data)?);
        let state =
            state.ok_or_else(|| format!("a message of {name} is not a {TYPE}: record the bag again"))?;
        self.messages.push((topic, time, state));
        Ok(())
    }

    /// One row for each message. Columns of other joints and topics are empty.
    pub(super) fn text(&self) -> Result<Vec<u8>, String> {
        if self.messages.is_empty() {
            let topics: Vec<String> =
                self.topics.values().map(|[name, kind]| format!("{name} ({kind})")).collect();
            let topics = if topics.is_empty() { "none".to_owned() } else { topics.join(", ") };
            return Err(format!("the bag has no messages of {TYPE}; its topics: {topics}"));
        }
        let mut columns = BTreeMap::new();
        for (topic, _, state) in &self.messages {
            for name in &state.names {
                let next = columns.len();
                columns.entry((topic, name)).or_insert(next);
            }
        }
        let is_stamped = self.messages.iter().all(|(_, _, state)| state.stamp != (0, 0));
        let mut rows = vec![String::new(); 1 + 3 * columns.len()];
        rows[0] = if is_stamped { "header/stamp" } else { "bag/time" }.to_owned();
        for ((topic, name), place) in &columns {
            for (kind, quantity) in ["position", "velocity", "effort"].iter().enumerate() {
                rows[1 + 3 * place + kind] = format!("{}/{name}/{quantity}", self.topics[*topic][0]);
            }
        }
        let mut csv = csv::Writer::from_writer(Vec::new());
        csv.write_record(&rows).map_err(|error| error.to_string())?;
        for (topic, time, state) in &self.messages {
            rows.iter_mut().for_each(String::clear);
            let nanoseconds = i128::from(state.stamp.0) * 1_000_000_000 + i128::from(state.stamp.1);
            let time = if is_stamped { nanoseconds } else { i128::from(*time) };
            rows[0] = format!("{}.{:09}", time.div_euclid(1_000_000_000), time.rem_euclid(1_000_000_000));
            for (joint, name) in state.names.iter().enumerate() {
                let place = 1 + 3 * columns[&(topic, name)];
                for (kind, values) in state.values.iter().enumerate() {
                    rows[place + kind] = values.get(joint).map_or(String::new(), f64::to_string);
                }
            }
            csv.write_record(&rows).map_err(|error| error.to_string())?;
        }
        csv.into_inner().map_err(|error| error.to_string())
    }
}
