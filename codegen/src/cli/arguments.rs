//! Arguments of the command line.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use gelenk_identification::friction::METHODS;

use gelenk_formula::Hold;

use super::choices::{BaseName, Choices, Modules, Reading, positive, share};

/// Generates robot dynamics as plain Rust or C from a kinematic description.
#[derive(Debug, Parser)]
#[command(name = "gelenk", version, max_term_width = 100, after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// Format of the printed results
    #[arg(long, value_enum, default_value_t = Format::Text, global = true)]
    pub(super) format: Format,
    #[command(subcommand)]
    pub(super) command: Command,
}

impl Arguments {
    /// Parses the arguments of the process. For `identify`, the joints of `--hold` are appended to
    /// `--columns`.
    pub(super) fn read() -> Self {
        let mut arguments = Self::parse();
        if let Command::Identify(what) = &mut arguments.command
            && !what.reading.hold.is_empty()
        {
            let hold: Vec<String> = what.reading.hold.drain(..).map(|hold| hold.text()).collect();
            let columns = what.columns.iter().cloned().chain([format!("hold={}", hold.join("|"))]);
            what.columns = Some(columns.collect::<Vec<_>>().join(","));
        }
        arguments
    }
}

const EXAMPLES: &str = "\
Examples:
  gelenk generate models/powercube.toml        writes generated/src/powercube.rs
  gelenk generate arm.urdf --output src/arm.rs
  gelenk generate                              all descriptions in models/; removes other modules of generated/src/
  gelenk check                                 compares generated/ with models/
  gelenk inspect counts models/ur5.toml        operation counts of all functions
  gelenk report models/ur5.toml                a page about the robot
  gelenk export arm.toml --mjcf                the robot for MuJoCo
  gelenk identify arm.toml log.csv             friction and inertias from a recorded motion
  gelenk new my_arm                            a small crate with a simulation
  gelenk schema                                the keys of a description, for editors

Exit codes: 0 success, 1 the description has errors or the output is out of date, 2 wrong command line, 3 internal error.";

const GENERATE_EXAMPLES: &str = "\
Examples:
  gelenk generate models/powercube.toml
  gelenk generate arm.urdf --output - --functions mass_matrix,bias_forces
  gelenk generate arm.urdf --snap-angles 1e-4 --scalar f32 --output firmware/src/arm.rs
  gelenk generate arm.urdf --hold 'finger_*=0.02'        holds the joints of the gripper
  gelenk generate arm.toml --control-model 50    writes a plant and a controller module
  gelenk generate arm.toml --language c --output firmware/    writes firmware/arm.h and firmware/arm.c
  gelenk generate arm.toml --language c --format json         also prints the signatures of the functions";

const EXPORT_EXAMPLES: &str = "\
Examples:
  gelenk export arm.toml --mjcf                  writes arm.xml, for MuJoCo
  gelenk export arm.toml --urdf --output robots/arm.urdf

Notes list the quantities that the format cannot hold. A file that gelenk did not write is not overwritten.

Exit codes: 0 success, 1 the description has errors or the file cannot be written, 2 wrong command line, 3 internal error.";

const INSPECT_EXAMPLES: &str = "\
Examples:
  gelenk inspect model arm.urdf
  gelenk inspect counts models/ur5.toml --format json
  gelenk inspect counts models/ur5.toml --bytes
  gelenk inspect program models/powercube.toml --functions mass_matrix --latex
  gelenk inspect --closed-form models/powercube.toml";

const NEW_EXAMPLES: &str = "\
Examples:
  gelenk new my_arm                              uses the source of this program
  gelenk new my_arm --urdf arm.urdf              the robot of a URDF, which is copied
  gelenk new my_arm --mjcf arm.xml               the robot of an MJCF, with its included files
  gelenk new my_arm --git https://example.org/gelenk.git
  gelenk new my_arm --c                          a project in C; --python: in Python
  gelenk new my_arm --ros2 --urdf arm.urdf       a ROS 2 package with controllers

Exit codes: 0 success, 1 the folder exists, cannot be created, or the file has errors, 2 wrong command line, 3 internal error.";

const REPORT_EXAMPLES: &str = "\
Examples:
  gelenk report models/powercube.toml            writes report/powercube/index.html
  gelenk report arm.urdf --output /tmp/arm

Exit codes: 0 success, 1 the description has errors or the self-check fails, 2 wrong command line, 3 internal error.";

const SCHEMA_EXAMPLES: &str = "\
Examples:
  gelenk schema > gelenk.schema.json

Taplo and the extension Even Better TOML of VS Code then check each description whose first line is
  #:schema ./gelenk.schema.json";

const IDENTIFY_EXAMPLES: &str = "\
Examples:
  gelenk identify --plan arm.toml                         a motion to record, plan.csv
  gelenk identify arm.toml log.csv                        writes arm_identified.toml
  gelenk identify ur10.urdf monday.csv tuesday.csv --report page
  gelenk identify ur10.urdf bag/*.mcap                    bags of ROS 2
  gelenk identify arm.toml log.csv --columns 'time=t,position=pos_{},torque=i_{} [N m]'
  gelenk identify drone.toml flight.csv --columns 'place=2..4,wxyz=5..8,input=9..12'
  gelenk identify arm.toml log.csv --columns '?'                       the columns as a line to edit and give back
  gelenk identify arm.toml log.csv --hold 'wrist_*' --hold gripper=0.02    joints at rest that are not in the log
  gelenk identify arm.toml --reduce log.csv --output log.moments       reduces a log of a fleet to moments
  gelenk identify arm.toml --merge *.moments --output arm_identified.toml
  gelenk identify arm.toml --merge *.moments --output all.moments      adds moments, for a later --merge

In --columns, {} is a joint's number and {name} its name. For a floating joint, place is x, y, z, and
wxyz or xyzw is the quaternion.

Exit codes: 0 success, 1 a file has errors or the results explain too little, 2 wrong command line, 3 internal error.";

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Generate the Rust or C module of a description, or the modules of all descriptions in models/
    #[command(after_help = GENERATE_EXAMPLES)]
    Generate(Generate),
    /// Check that the committed modules are up to date, without writing
    Check(Check),
    /// Export a description as MJCF (MuJoCo) or URDF
    #[command(after_help = EXPORT_EXAMPLES)]
    Export(Export),
    /// Print the model, frames, operation counts, straight-line programs, equations or Rust code of a robot
    #[command(after_help = INSPECT_EXAMPLES)]
    Inspect(Inspect),
    /// Create a small project with a robot and a simulation: a Rust crate, or a project in C, Python or ROS 2
    #[command(after_help = NEW_EXAMPLES)]
    New(New),
    /// Estimate friction, inertias and drive gains from logs and write them as a description; or plan the motion
    /// to record
    #[command(after_help = IDENTIFY_EXAMPLES)]
    Identify(Box<Identify>),
    /// Write a page about a robot: drawing, parameters, equations, operation counts, self-check
    #[command(after_help = REPORT_EXAMPLES)]
    Report(Report),
    /// Print the JSON Schema of robot descriptions, with which editors complete and check keys
    #[command(after_help = SCHEMA_EXAMPLES)]
    Schema,
}

#[derive(Debug, Args)]
pub(super) struct Generate {
    /// Robot description (TOML, URDF or MJCF); without it, the modules of all descriptions in models/ are written to
    /// generated/src/
    pub(super) description: Option<PathBuf>,
    /// Output file or folder; `-` is standard output. Default for Rust: generated/src/<NAME>.rs for a description in
    /// the workspace's models/, otherwise <NAME>.rs in the current folder. For C: a folder, or a file FILE.c; FILE.h is
    /// written next to it, and the names of the functions begin with FILE. Default for C: <NAME>.h and <NAME>.c in the
    /// current folder
    #[arg(long, short, value_name = "PATH", requires = "description")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) modules: Modules,
}

#[derive(Debug, Args)]
pub(super) struct Check {
    /// Robot description (TOML, URDF or MJCF); without it, all descriptions in models/ are checked
    pub(super) description: Option<PathBuf>,
    /// File to compare [default: the file that `generate` writes]
    #[arg(long, short, value_name = "PATH", requires = "description")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) modules: Modules,
}

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("to").required(true))]
pub(super) struct Export {
    /// Robot description (TOML, URDF or MJCF)
    pub(super) description: PathBuf,
    /// Write MJCF: bodies, joints, springs, friction, armature, actuators, equalities, sites
    #[arg(long, group = "to")]
    pub(super) mjcf: bool,
    /// Write a URDF: links, joints, limits, friction, mimic joints
    #[arg(long, group = "to")]
    pub(super) urdf: bool,
    /// Output file; `-` is standard output [default: <NAME>.xml or <NAME>.urdf in this folder]
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
}

#[derive(Debug, Args)]
#[command(allow_missing_positional = true)]
pub(super) struct Inspect {
    /// Stage to print [default: model]; not with --closed-form
    #[arg(value_enum)]
    pub(super) what: Option<Stage>,
    /// Robot description (TOML, URDF or MJCF)
    pub(super) description: PathBuf,
    /// Also print the size of the machine code at opt-level 3 in bytes (counts only)
    #[arg(long)]
    pub(super) bytes: bool,
    /// Print LaTeX (program and closed forms only)
    #[arg(long)]
    pub(super) latex: bool,
    /// Print closed forms of M, k, q and B with symbolic parameters, for up to three joints. This option
    /// needs a build with the feature `symbolica`, and a licence of Symbolica for commercial use
    #[arg(long, conflicts_with_all = ["what", "functions", "scalar"])]
    pub(super) closed_form: bool,
    /// Write the closed forms to this file instead of standard output
    #[arg(long, short, value_name = "FILE", requires = "closed_form")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) choices: Choices,
}

#[derive(Debug, Args)]
pub(super) struct New {
    /// Folder to create; its name is also the name of the crate or package
    #[arg(value_name = "NAME")]
    pub(super) folder: PathBuf,
    /// Create a project in C: a Makefile and a simulation
    #[arg(long, conflicts_with_all = ["python", "ros2", "checkout", "git", "version"])]
    pub(super) c: bool,
    /// Create a ROS 2 package with two controllers for ros2_control: gravity compensation and computed torque
    #[arg(long, conflicts_with_all = ["python", "base", "checkout", "git", "version"])]
    pub(super) ros2: bool,
    /// Create a project in Python: a simulation over NumPy arrays
    #[arg(long)]
    pub(super) python: bool,
    /// Estimate the friction of the robot online while it moves
    #[arg(long, conflicts_with_all = ["c", "python", "ros2", "base"])]
    pub(super) online_friction: bool,
    /// Use the robot of this URDF or MJCF [default: an arm with two joints]
    #[arg(long, visible_alias = "mjcf", value_name = "FILE")]
    pub(super) urdf: Option<PathBuf>,
    /// Kind of base; a floating base moves freely in all six directions [default: as described]. Without --urdf,
    /// `floating` gives a quadrotor
    #[arg(long, value_enum)]
    pub(super) base: Option<BaseName>,
    /// Hold joints at VALUE [rad or m, default: 0], by a name or a pattern with `*`. Joints that mimic them are held
    /// too. May be given several times
    #[arg(long, value_name = "PATTERN[=VALUE]", value_parser = Hold::parse, requires = "urdf")]
    pub(super) hold: Vec<Hold>,
    /// Read only the subtree of this body of an MJCF scene
    #[arg(long, value_name = "NAME", requires = "urdf")]
    pub(super) body: Option<String>,
    /// Depend on the crates of this checkout [default: the source of this program, a checkout or the registry]
    #[arg(long, value_name = "FOLDER")]
    pub(super) checkout: Option<PathBuf>,
    /// Depend on the crates of this repository
    #[arg(long, value_name = "URL", conflicts_with = "checkout")]
    pub(super) git: Option<String>,
    /// Depend on this version of the crates in the registry
    #[arg(long, value_name = "VERSION", conflicts_with_all = ["checkout", "git"])]
    pub(super) version: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct Report {
    /// Robot description (TOML, URDF or MJCF)
    pub(super) description: PathBuf,
    /// Folder for the page (index.html) and its numbers (report.json, CSV files) [default: report/<NAME>]
    #[arg(long, short, value_name = "FOLDER")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) reading: Reading,
    /// Largest number of operations of a derived function [default: 300000]
    #[arg(long, value_name = "COUNT")]
    pub(super) max_operations: Option<usize>,
}

#[derive(Debug, Args)]
pub(super) struct Identify {
    /// Robot description (TOML, URDF or MJCF)
    pub(super) description: PathBuf,
    /// Recorded motions: CSV with time, positions and efforts, or ROS 2 bags (*.db3, *.mcap); with --merge, files of moments
    #[arg(required_unless_present = "plan", value_name = "LOG.csv")]
    pub(super) logs: Vec<PathBuf>,
    /// Output file: the description with the results [default: <NAME>_identified.toml], the plan
    /// [default: plan.csv], or moments (*.moments)
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// Folder for a page with figures (index.html) and its numbers
    #[arg(long, value_name = "FOLDER", conflicts_with = "plan")]
    pub(super) report: Option<PathBuf>,
    /// Columns of the logs by quantity, e.g. 'position=joint{}_pos,torque={name}_tau'; '?' prints the columns of
    /// the first log as a line to edit [default: known patterns]
    #[arg(long, value_name = "PATTERNS", conflicts_with = "plan")]
    pub(super) columns: Option<String>,
    /// Character between the fields of the logs [default: from the data]
    #[arg(long, value_name = "CHARACTER", conflicts_with = "plan")]
    pub(super) separator: Option<char>,
    /// Quantity of the efforts in the logs [default: from the column names]
    #[arg(long, value_enum, conflicts_with = "plan")]
    pub(super) effort: Option<EffortName>,
    /// The recorded efforts exclude the gravity torques, because the robot's controller compensates them
    #[arg(long, conflicts_with = "plan")]
    pub(super) gravity_compensated: bool,
    /// Half-amplitude frequency of the low-pass filter for positions and efforts [default: from the data]
    #[arg(long, value_name = "HZ", conflicts_with = "plan", value_parser = positive)]
    pub(super) bandwidth: Option<f64>,
    /// Delay of the efforts relative to the positions; 0 for none [default: from the data]
    #[arg(long, value_name = "SECONDS", conflicts_with = "plan", allow_negative_numbers = true)]
    pub(super) delay: Option<f64>,
    /// Logs that validate the results and are not used for the estimate; may be given several times
    #[arg(long, value_name = "LOG.csv", conflicts_with = "plan")]
    pub(super) validate: Vec<PathBuf>,
    /// Logs of the robot with a load in its hand, in addition to logs without the load. Estimates the load, and writes a
    /// description that contains the load [default: <NAME>_payload.toml]; may be given several times
    #[arg(
        long,
        value_name = "LOG.csv",
        conflicts_with_all = [
            "plan", "reduce", "merge", "report", "validate", "gravity_compensated", "load_friction", "friction"
        ]
    )]
    pub(super) payload: Vec<PathBuf>,
    /// Link that carries the load [default: the last link]
    #[arg(long, value_name = "LINK", requires = "payload")]
    pub(super) payload_on: Option<String>,
    /// Also identify load-dependent friction |τ_l| s₁(v), with the load torque τ_l and the speed v of the joint, if it
    /// predicts held-out data better
    #[arg(long, conflicts_with_all = ["plan", "reduce", "merge"])]
    pub(super) load_friction: bool,
    /// Location of friction in robots with drives on several joints (`[[drives]]`): the shafts of these drives, or
    /// only joints
    #[arg(long, value_enum, value_name = "PLACE", default_value_t = FrictionPlace::Shafts)]
    pub(super) friction_on: FrictionPlace,
    /// Candidate terms of friction laws: viscous, coulomb, asymmetric, quadratic, and expressions in the speed v
    /// such as 'tanh(50*v)'; or only stribeck, the Stribeck law with its five parameters [default:
    /// viscous,coulomb,asymmetric, then stribeck if it predicts held-out data better]
    #[arg(long, value_name = "TERMS", conflicts_with_all = ["plan", "reduce", "merge"])]
    pub(super) friction: Option<String>,
    /// Method that chooses the terms of friction laws [default: subset, then the Stribeck law if it predicts held-out
    /// data better]
    #[arg(long, value_parser = methods(), value_name = "METHOD", conflicts_with_all = ["plan", "reduce", "payload"])]
    pub(super) method: Option<String>,
    /// Threshold of --method stls, in the units of the coefficients [default: 0.1]
    #[arg(long, value_name = "VALUE", requires = "method", value_parser = positive)]
    pub(super) threshold: Option<f64>,
    /// Method that differentiates the positions
    #[arg(long, value_enum, value_name = "METHOD", default_value_t = DerivativeName::Filter, conflicts_with_all = ["plan", "merge", "reduce"])]
    pub(super) derivative: DerivativeName,
    /// Write the results even if they explain little of the data
    #[arg(long, conflicts_with = "plan")]
    pub(super) accept_poor: bool,
    /// Reduce logs to moments (sums of products of the regression): a small file of a fixed size, for --merge
    #[arg(
        long,
        requires = "output",
        conflicts_with_all = ["plan", "merge", "report", "validate"]
    )]
    pub(super) reduce: bool,
    /// Identify from files of moments instead of logs. If --output is *.moments, write the sum of the moments instead of a
    /// description
    #[arg(
        long,
        conflicts_with_all = [
            "plan", "columns", "hold", "separator", "effort", "gravity_compensated", "bandwidth", "delay", "validate"
        ]
    )]
    pub(super) merge: bool,
    /// Replay logs through the online friction estimator of the control loop, and compare its laws with a batch fit. Writes no description.
    /// Inputs of a log act during the period after their row; --delay -SECONDS lets them act later
    #[arg(
        long,
        conflicts_with_all = [
            "plan", "reduce", "merge", "output", "bandwidth", "validate", "payload", "load_friction", "friction", "friction_on", "method", "derivative",
            "accept_poor"
        ]
    )]
    pub(super) online: bool,
    /// Plan a motion to record, within the limits of the description
    #[arg(long, conflicts_with_all = ["logs", "hold"])]
    pub(super) plan: bool,
    /// Period of the planned motion
    #[arg(long, value_name = "SECONDS", requires = "plan", value_parser = positive, default_value_t = 20.0)]
    pub(super) seconds: f64,
    /// Rows of the plan per second
    #[arg(long, value_name = "HZ", requires = "plan", value_parser = positive, default_value_t = 250.0)]
    pub(super) rate: f64,
    /// Largest acceleration of the plan [rad/s² or m/s²; default: reaches the largest speed in half a second]
    #[arg(long, value_name = "VALUE", requires = "plan", value_parser = positive)]
    pub(super) acceleration: Option<f64>,
    /// Fraction of the described position range that the plan uses, around the middle of the range
    #[arg(long, value_name = "SHARE", requires = "plan", value_parser = share, default_value_t = 0.9)]
    pub(super) position_share: f64,
    /// Largest rotation of spherical and floating joints from position 0, below π; --position-share scales this angle
    #[arg(long, value_name = "RAD", requires = "plan", value_parser = positive, default_value_t = 1.0)]
    pub(super) turn: f64,
    /// Fraction of the described speed limits that the plan uses
    #[arg(long, value_name = "SHARE", requires = "plan", value_parser = share, default_value_t = 0.7)]
    pub(super) speed_share: f64,
    /// Fraction of the described effort limits that the plan may need
    #[arg(long, value_name = "SHARE", requires = "plan", value_parser = share, default_value_t = 0.7)]
    pub(super) effort_share: f64,
    /// Number of harmonics (sine waves) in each joint's planned motion
    #[arg(long, value_name = "COUNT", requires = "plan", default_value_t = 8, value_parser = clap::value_parser!(u16).range(2..=50))]
    pub(super) harmonics: u16,
    /// Initial posture; the plan begins with a path from it to the motion, e.g. 'shoulder=0.3,elbow=-1.2' [rad or
    /// m; default: the start of the motion]
    #[arg(long, value_name = "JOINT=POSITION,…", requires = "plan")]
    pub(super) start: Option<String>,
    /// Seed of the search: another seed gives another motion
    #[arg(long, value_name = "NUMBER", requires = "plan", default_value_t = 1)]
    pub(super) seed: u64,
    #[command(flatten)]
    pub(super) reading: Reading,
}

/// Quantity measured by the efforts of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EffortName {
    /// Torques or forces at the joints, after the gears
    Joint,
    /// Inputs of the description, at the motors
    Input,
    /// Motor currents, whose torque constants are estimated
    Current,
}

/// Values of the option `--method`.
fn methods() -> PossibleValuesParser {
    METHODS.map(|(word, sentence, _)| PossibleValue::new(word).help(sentence)).into()
}

/// Methods of differentiating positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DerivativeName {
    /// Derivatives of the filter that is applied to positions and efforts
    Filter,
    /// TVDiff: total-variation regularization, whose weight follows from the noise of each position. The
    /// filter of the efforts is then applied to the derivatives
    Tvdiff,
}

/// Location of the identified friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum FrictionPlace {
    /// On the shafts of drives under `[[drives]]`, and on joints that have a `drive`
    Shafts,
    /// Only on joints; friction of shafts stays as described
    Joints,
}

/// Format of printed results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    Text,
    Json,
}

/// Stage that `inspect` shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Stage {
    /// Links, joints, drives and parameters
    Model,
    /// Frames and regrouped masses with which the derivation starts
    Mechanism,
    /// Operation counts of each function
    Counts,
    /// Straight-line programs of the functions, with intermediate values
    Program,
    /// M, k, q and B as expanded sums in a LaTeX document; for up to three coordinates
    Equations,
    /// Rust code of the module
    Source,
}
