//! Which column of a CSV file is which channel, in which unit.

use super::super::error::{IdentificationError, Result, require_setting};
use super::units::{conversion, known_units};
use super::vocabulary::{Kind, Origin, is_number, meaning, words};
use serde::Deserialize;

/// The quantity that a channel measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Time.
    Time,
    /// Joint position.
    Position,
    /// Joint velocity.
    Velocity,
    /// Joint acceleration.
    Acceleration,
    /// Torque or force.
    Torque,
    /// Motor current; `u = K_M i`.
    Current,
    /// A number that is constant within a run; times may restart where it changes.
    Segment,
    /// Anything else.
    Other,
}

/// One `[[channel]]` of the mapping.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelSchema {
    /// Name in expressions.
    pub name: String,
    /// Header of the column; the name if absent.
    pub column: Option<String>,
    /// The quantity that it measures; guessed from the name if absent.
    pub quantity: Option<Quantity>,
    /// Unit in the file; SI if absent.
    pub unit: Option<String>,
    /// Joint number.
    pub joint: Option<usize>,
    /// Factor before the unit is converted, e.g. radians per count.
    pub scale: Option<f64>,
    /// Number added after scaling, in the file's unit.
    pub offset: Option<f64>,
    /// K_M in N·m/A: the column is a motor current i, the channel becomes the torque u = K_M i.
    pub motor_constant: Option<f64>,
}

/// Mapping of columns to channels. Without one, columns are known by their names: `q1`, `dq1 [deg/s]`,
/// `tau2`, and those of the control loop's log (`control_loop::log_to_file`), `q_NAME`, `dq_NAME`, `u_NAME`,
/// whose joints are told apart by their names.
///
/// ```toml
/// [[channel]]
/// name = "beta"
/// column = "pos_2"
/// quantity = "position"
/// unit = "deg"
/// joint = 2
/// ```
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogSchema {
    /// Channels to read; empty: every column, named by its header (`q1` or `q1 [deg]`).
    #[serde(default, rename = "channel")]
    pub channels: Vec<ChannelSchema>,
    /// Field separator; a comma if absent.
    pub separator: Option<char>,
}

impl LogSchema {
    /// Reads the mapping from TOML.
    ///
    /// # Errors
    /// [`IdentificationError::File`] with line and column.
    pub fn from_toml(text: &str) -> Result<Self> {
        toml::from_str(text)
            .map_err(|e| IdentificationError::File { place: "column mapping".into(), message: e.to_string() })
    }

    /// The mapping for a file with these headers.
    pub(super) fn resolve(&self, headers: &[String]) -> Result<Vec<Column>> {
        if self.channels.is_empty() {
            let mut columns = headers
                .iter()
                .enumerate()
                .map(|(i, h)| Column::from_header(i, h))
                .collect::<Result<Vec<_>>>()?;
            number_joints(&mut columns);
            return Ok(columns);
        }
        self.channels.iter().map(|c| Column::from_schema(c, headers)).collect()
    }
}

/// A resolved column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub index: usize,
    pub name: String,
    pub quantity: Quantity,
    pub unit: String,
    pub joint: Option<usize>,
    pub factor: f64,
    pub offset: f64,
}

impl Column {
    fn from_header(index: usize, header: &str) -> Result<Self> {
        let (name, unit) = split_unit(header);
        let name = identifier(name, index);
        let quantity = guess(&name);
        Self::new(index, name, quantity, unit, None, 1.0, 0.0)
    }

    fn from_schema(schema: &ChannelSchema, headers: &[String]) -> Result<Self> {
        let header = schema.column.as_ref().unwrap_or(&schema.name);
        let index = headers.iter().position(|h| h == header);
        let index = index.ok_or_else(|| IdentificationError::UnknownChannel {
            name: header.clone(),
            known: headers.to_vec(),
        })?;
        if identifier(&schema.name, index) != schema.name {
            return Err(IdentificationError::Expression {
                text: schema.name.clone(),
                message: "a channel's name must be an identifier: letters, digits and _".into(),
            });
        }
        let quantity = schema.quantity.unwrap_or_else(|| guess(&schema.name));
        let unit = schema.unit.as_deref().unwrap_or("");
        let (scale, offset) = (schema.scale.unwrap_or(1.0), schema.offset.unwrap_or(0.0));
        let column = Self::new(index, schema.name.clone(), quantity, unit, schema.joint, scale, offset)?;
        match schema.motor_constant {
            Some(constant) => column.driven(constant),
            None => Ok(column),
        }
    }

    /// The torque of a motor instead of its current.
    fn driven(self, motor_constant: f64) -> Result<Self> {
        require_setting(
            &format!("motor_constant of channel {}", self.name),
            motor_constant,
            motor_constant != 0.0,
            "it must be finite and not zero",
        )?;
        if self.quantity != Quantity::Current || self.unit != "A" {
            return Err(IdentificationError::Expression {
                text: self.name,
                message: format!(
                    "a channel with a motor_constant must be a current in A or mA, this is {:?} in {}",
                    self.quantity, self.unit
                ),
            });
        }
        Ok(Self {
            quantity: Quantity::Torque,
            unit: "N*m".into(),
            factor: self.factor * motor_constant,
            offset: self.offset * motor_constant,
            ..self
        })
    }

    fn new(
        index: usize,
        name: String,
        quantity: Quantity,
        unit: &str,
        joint: Option<usize>,
        scale: f64,
        offset: f64,
    ) -> Result<Self> {
        let digits: String = name.chars().rev().take_while(char::is_ascii_digit).collect();
        let joint = joint.or_else(|| digits.chars().rev().collect::<String>().parse().ok());
        let (factor, si) = match unit {
            "" => (1.0, default_unit(quantity)),
            _ => conversion(unit).ok_or_else(|| IdentificationError::Expression {
                text: unit.into(),
                message: format!("unknown unit of channel {name}; known are {}", known_units()),
            })?,
        };
        Ok(Self {
            index,
            name,
            quantity,
            unit: si.into(),
            joint,
            factor: factor * scale,
            offset: offset * factor,
        })
    }
}

/// Name and unit of `q1 [deg]` or `q1[deg]`. A bracket within a name, as in `q_arm[1]`, is none: what follows
/// a name without a space must be a unit that is known, and not a number.
fn split_unit(header: &str) -> (&str, &str) {
    let header = header.trim();
    let Some((name, unit)) = header.strip_suffix(']').and_then(|rest| rest.rsplit_once('[')) else {
        return (header, "");
    };
    let spaced = name.ends_with(char::is_whitespace);
    if spaced || (conversion(unit).is_some() && unit != "1") { (name.trim_end(), unit) } else { (header, "") }
}

/// Prefixes that the control loop's log writes before the name of a joint or input.
const PREFIXES: [(&str, Quantity); 6] = [
    ("measured_dq_", Quantity::Velocity),
    ("measured_tau_", Quantity::Torque),
    ("desired_", Quantity::Other),
    ("dq_", Quantity::Velocity),
    ("q_", Quantity::Position),
    ("u_", Quantity::Torque),
];

/// Quantity and joint of a column of the control loop's log.
fn of_loop(name: &str) -> Option<(Quantity, &str)> {
    let (prefix, quantity) = PREFIXES.iter().find(|(p, _)| name.starts_with(p))?;
    let joint = &name[prefix.len()..];
    (!joint.is_empty()).then_some((*quantity, joint))
}

/// Columns of the same named joint get the same number, in the order of the file; a digit at the end of a
/// joint's name is no number of a joint.
fn number_joints(columns: &mut [Column]) {
    let number = |column: &Column| of_loop(&column.name)?.1.parse::<usize>().ok();
    let taken = columns.iter().filter_map(number).max().unwrap_or(0);
    let mut joints: Vec<String> = Vec::new();
    for column in columns {
        if let Some(number) = number(column) {
            column.joint = Some(number);
            continue;
        }
        let Some((_, joint)) = of_loop(&column.name) else {
            continue;
        };
        let known = joints.iter().position(|j| j == joint);
        let index = known.unwrap_or_else(|| {
            joints.push(joint.to_owned());
            joints.len() - 1
        });
        // Behind those that are numbers already.
        column.joint = Some(taken.saturating_add(index + 1));
    }
}

/// A header as an identifier: other characters become `_`.
fn identifier(text: &str, index: usize) -> String {
    let mut name: String =
        text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' }).collect();
    if name.is_empty() {
        name = format!("column_{index}");
    }
    if name.starts_with(|c: char| c.is_ascii_digit()) {
        name.insert(0, '_');
    }
    name
}

/// What the loop's prefixes or the words of a name say; what was commanded is no measurement.
fn guess(name: &str) -> Quantity {
    if let Some((quantity, _)) = of_loop(name) {
        return quantity;
    }
    let spelled = words(name);
    let spelled: Vec<&str> = spelled.iter().map(String::as_str).filter(|w| !is_number(w)).collect();
    match meaning(&spelled).filter(|m| m.origin != Origin::Commanded).map(|m| m.kind) {
        Some(Kind::Time) => Quantity::Time,
        Some(Kind::Position) => Quantity::Position,
        Some(Kind::Velocity) => Quantity::Velocity,
        Some(Kind::Acceleration) => Quantity::Acceleration,
        Some(Kind::Torque | Kind::Input) => Quantity::Torque,
        Some(Kind::Current) => Quantity::Current,
        Some(Kind::Run) => Quantity::Segment,
        Some(Kind::Name) | None => Quantity::Other,
    }
}

fn default_unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "s",
        Quantity::Position => "rad",
        Quantity::Velocity => "rad/s",
        Quantity::Acceleration => "rad/s^2",
        Quantity::Torque => "N*m",
        Quantity::Current => "A",
        Quantity::Segment | Quantity::Other => "1",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_become_channels() {
        let headers = ["run", "t [ms]", "q1 [deg]", "dq1", "motor load"].map(String::from);
        let columns = LogSchema::default().resolve(&headers).unwrap();
        assert_eq!(
            columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
            ["run", "t", "q1", "dq1", "motor_load"]
        );
        assert_eq!((columns[1].quantity, columns[1].factor), (Quantity::Time, 1e-3));
        assert_eq!(
            (columns[2].quantity, columns[2].joint, columns[2].unit.as_str()),
            (Quantity::Position, Some(1), "rad")
        );
        assert!((columns[2].factor - 0.017_453_292_519_943_295).abs() < 1e-18);
        assert_eq!(columns[4].quantity, Quantity::Other);
    }

    /// As the control loop writes them, for joints with every kind of name.
    #[test]
    fn columns_of_a_loop_belong_to_their_joints() {
        let headers = [
            "time",
            "q_wrist_2",
            "q_elbow_2",
            "q_arm[1]",
            "dq_elbow_2",
            "dq_wrist_2",
            "dq_arm[1]",
            "measured_dq_elbow_2",
            "desired_elbow_2",
            "u_elbow_2",
            "q_7",
            "dq_7",
            "q_left arm, up",
        ]
        .map(String::from);
        let columns = LogSchema::default().resolve(&headers).unwrap();
        let joint = |header: &str| {
            let index = headers.iter().position(|h| h == header).unwrap();
            columns[index].joint
        };
        assert_eq!(joint("q_wrist_2"), Some(8));
        for elbow in ["q_elbow_2", "dq_elbow_2", "measured_dq_elbow_2", "u_elbow_2"] {
            assert_eq!(joint(elbow), Some(9), "{elbow}");
        }
        assert_eq!((joint("q_arm[1]"), joint("dq_arm[1]")), (Some(10), Some(10)));
        assert_eq!((joint("q_7"), joint("dq_7")), (Some(7), Some(7)));
        assert_eq!(joint("time"), None);
        let quantities: Vec<Quantity> = columns.iter().map(|c| c.quantity).collect();
        assert_eq!(quantities[3], Quantity::Position);
        assert_eq!(columns[3].name, "q_arm_1_");
        assert_eq!(
            quantities[6..10],
            [Quantity::Velocity, Quantity::Velocity, Quantity::Other, Quantity::Torque]
        );
        assert_eq!(columns[12].name, "q_left_arm__up");
    }

    #[test]
    fn units_stand_in_brackets_at_the_end() {
        assert_eq!(split_unit("q1 [deg]"), ("q1", "deg"));
        assert_eq!(split_unit("q1[deg] "), ("q1", "deg"));
        assert_eq!(split_unit("q1 [grad]"), ("q1", "grad"));
        assert_eq!(split_unit("q_arm[1]"), ("q_arm[1]", ""));
        assert_eq!(split_unit("q_arm[1] [deg]"), ("q_arm[1]", "deg"));
        assert_eq!(split_unit("q_arm[left]x"), ("q_arm[left]x", ""));
    }

    #[test]
    fn faults_in_the_mapping_are_explained() {
        let schema =
            LogSchema::from_toml("[[channel]]\nname = \"beta\"\ncolumn = \"pos\"\nunit = \"grad\"\n")
                .unwrap();
        let message = schema.resolve(&["pos".to_string()]).unwrap_err().to_string();
        assert!(message.starts_with("expression `grad`: unknown unit of channel beta; known are s, ms"));
        let message = schema.resolve(&["time".to_string()]).unwrap_err().to_string();
        assert_eq!(message, "there is no channel `pos`; known are time");
        let message = LogSchema::from_toml("[[channel]]\nname = \"b\"\nunti = 1\n").unwrap_err().to_string();
        assert!(message.contains("line 3") && message.contains("unti"), "{message}");
    }

    #[test]
    fn currents_become_torques_by_the_motor_constant() {
        let schema = |more: &str| {
            let text = format!("[[channel]]\nname = \"u1\"\ncolumn = \"i1\"\n{more}");
            LogSchema::from_toml(&text).unwrap().resolve(&["i1".into()])
        };
        let current = "quantity = \"current\"\nunit = \"mA\"\n";
        let column = &schema(&format!("{current}motor_constant = 0.12")).unwrap()[0];
        assert_eq!((column.quantity, column.unit.as_str()), (Quantity::Torque, "N*m"));
        assert!((column.factor - 1.2e-4).abs() < 1e-18);
        let message = |more: &str| schema(more).unwrap_err().to_string();
        assert!(
            message(&format!("{current}motor_constant = 0.0"))
                .starts_with("motor_constant of channel u1 = 0")
        );
        assert!(message("motor_constant = 0.12").contains("must be a current in A or mA, this is Torque"));
    }
}
