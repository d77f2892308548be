//! How the values of keys are written, for messages about values that are not.

/// A key with an example of its value, in the order of models/README.md.
const EXAMPLES: [(&str, &str); 85] = [
    ("name", "`name = \"elbow\"`"),
    ("description", "`description = \"An arm with two joints\"`"),
    ("urdf", "`urdf = \"arm.urdf\"`: the file that this description extends"),
    ("extends", "`extends = \"arm.toml\"`: the file that this description extends"),
    ("gravity", "`gravity = [0, 0, -9.81]`"),
    ("coordinates", "`coordinates = [\"shoulder\", \"elbow\"]`"),
    ("base", "`base = \"trunk\"`, or `base = { link = \"trunk\", type = \"floating\" }`"),
    ("body", "`body = \"link0\"`: the robot of a scene is the tree of this body"),
    ("snap_angles", "`snap_angles = 1e-4`, in rad"),
    ("ignore_mimic", "`ignore_mimic = true`"),
    ("no_friction", "`no_friction = true`"),
    ("accept_unphysical", "`accept_unphysical = true`"),
    ("generate", "`generate = { functions = [\"inverse_dynamics\"] }`"),
    ("functions", "`functions = [\"inverse_dynamics\", \"linearize\"]`"),
    ("lanes", "`lanes = [\"inverse_dynamics\"]`"),
    ("smooth_sign", "`smooth_sign = 50`: sign(v) becomes tanh(50 v)"),
    ("substeps", "`substeps = 2`"),
    ("parameters", "`[parameters]`, and below it `m1 = 2.5`"),
    ("value", "`m1 = { value = 2.5, unit = \"kg\", description = \"payload\" }`"),
    ("free", "`mass = { free = 2.5, name = \"payload\" }`"),
    ("unit", "`unit = \"kg\"`"),
    ("joints", "`[[joints]]`, in two brackets, before the keys of each joint"),
    ("type", "`type = \"revolute\"` of a joint, `type = \"floating\"` of a base"),
    ("parent", "`parent = \"upper_arm\"`: the link that carries the joint"),
    ("child", "`child = \"forearm\"`: the link that the joint moves"),
    ("origin", "`origin = { xyz = [0, 0, 0.5], rpy = [0, 0, 0] }`"),
    ("xyz", "`xyz = [0, 0, 0.5]`, in m"),
    ("rpy", "`rpy = [0, \"pi/2\", 0]`, in rad"),
    ("quaternion", "`quaternion = { w = 1, x = 0, y = 0, z = 0 }`"),
    ("dh", DH),
    ("modified_dh", DH),
    ("axis", "`axis = [0, 1, 0]`"),
    ("pitch", "`pitch = \"0.02/(2*pi)\"`: metres for each radian, here 20 mm a turn"),
    ("held", "`held = 0.5` at a joint, `held = { \"finger_*\" = 0 }` for joints by their names"),
    ("motion", "`motion = \"driven\"`"),
    ("follows", "`follows = { shoulder = -0.5 }`: the joints that are followed, with their ratios"),
    ("offset", "`offset = 0.1`: the position where the joints that are followed are at 0"),
    ("limits", "`limits = { position = [-1.5, 1.5], velocity = 2, effort = 40 }`"),
    ("position", "`position = [-1.5, 1.5]`"),
    ("velocity", "`velocity = 2`, in rad/s or m/s"),
    ("effort", EFFORT),
    ("peak_effort", EFFORT),
    ("acceleration", "`acceleration = 5`, in rad/s² or m/s²"),
    ("jerk", "`jerk = 50`, in rad/s³ or m/s³"),
    ("stiffness", SPRING),
    ("rest", SPRING),
    ("damping", SPRING),
    ("spring", "`spring = { stiffness = 3, rest = 0.1 }` or `spring = \"-3*(y - 0.1)\"`"),
    ("friction", "`friction = { viscous = 0.4 }` or `friction = \"0.4*v + 0.2*sign(v)\"`"),
    ("viscous", "`viscous = 0.4`: friction for a unit of speed"),
    ("terms", "`terms = [[\"v\", 0.4], [\"tanh(5*v)\", 3.9]]`: functions of v with their weights"),
    (
        "law",
        "`law = \"0.4*v\"` of friction, `law = \"1200*(l - 0.3) + 40*dl\"` of a force between two frames",
    ),
    ("load", "`load = \"0.1*tanh(50*v)\"`: friction for a unit of load"),
    ("coulomb", "`coulomb = { value = 0.2, slope = 50 }`"),
    ("slope", "`coulomb = { value = 0.2, slope = 50 }`: sign(v) becomes tanh(50 v)"),
    ("stribeck", "`stribeck = { a1 = 0.4, a2 = 0.2, a3 = 50, a4 = 0.1, a5 = 20 }`"),
    ("drive", "`drive = { gear_ratio = 100, rotor_inertia = 2e-5 }` or `drive = \"ideal\"`"),
    ("drives", "`[[drives]]`, in two brackets, before the keys of each drive"),
    ("on", "`on = { pitch = 1, roll = -1 }`: the joints that the drive moves, with their weights"),
    ("gear_ratio", "`gear_ratio = 100`: motor angle over joint angle"),
    ("rotor_inertia", "`rotor_inertia = 2e-5`, in kg m² about its own axis"),
    ("motor_constant", "`motor_constant = 0.06`: newton metres at the motor for each ampere"),
    ("carrier", "`carrier = \"forearm\"`: the link that the motor sits on"),
    ("coupling", "`coupling = \"diagonal\"`"),
    ("torque", TORQUE),
    ("nominal", TORQUE),
    ("peak", TORQUE),
    ("speed", "`speed = 300`: rad/s of a motor's shaft, m/s of a force between two frames"),
    ("stall_torque", LINE),
    ("no_load_speed", LINE),
    ("bodies", "`[[bodies]]`, in two brackets, before the keys of each body"),
    ("link", "`link = \"forearm\"`"),
    ("mass", "`mass = 2.5` or `mass = \"payload\"`"),
    ("center_of_mass", "`center_of_mass = [0, 0, 0.1]`"),
    ("inertia", INERTIA),
    ("frames", "`[[frames]]`, in two brackets, before the keys of each frame"),
    ("frame", "`frame = \"tool\"`: the name of a frame or link"),
    ("wrench", "`wrench = [0, 0, 1, 0, 0, 0.02]`: the force of a unit input, then its moment"),
    ("between", "`between = [\"anchor\", \"hook\"]`: the names of two frames or links"),
    ("stroke", "`stroke = [0.8, 1.3]`: shortest and longest distance of the two frames, in m"),
    ("forces", "`[[forces]]`, in two brackets, before the keys of each force"),
    ("inputs", "`[[inputs]]`, in two brackets, before the keys of each input"),
    ("wrenches", "`[[wrenches]]`, in two brackets, before the keys of each wrench"),
    ("in", "`in = \"base\"`: the axes in which the wrench counts"),
    ("input", "`input = \"cylinder\"`: the name of the input"),
];

/// A row of Denavit and Hartenberg.
const DH: &str = "`{ a = 0.4, alpha = \"pi/2\", d = 0, theta = 0 }`";
const SPRING: &str = "`spring = { stiffness = 3, rest = 0.1, damping = 0.2 }`";
const EFFORT: &str = "`effort = 40`, in N m or N";
const TORQUE: &str = "`torque = { nominal = 0.4, peak = 0.9 }`, in newton metres at the motor";
const LINE: &str = "`stall_torque = 1.2` and `no_load_speed = 600`, in newton metres and rad/s at the motor";

/// The forms of an inertia.
const INERTIA: &str = "`0.1` for all axes, the principal moments `[0.1, 0.1, 0.02]`, or `{ xx = 0.1, yy = 0.1, zz = 0.02, xy = 0, xz = 0, yz = 0 }`";

/// How the value of a key may be written.
///
/// - `is_list`: whether a list is wanted, where a key has another meaning in another table
pub(super) fn example(key: &str, is_list: bool) -> Option<&'static str> {
    match key {
        "limits" if is_list => Some("`limits = [0, 8]`: lowest and highest value of the input"),
        _ => EXAMPLES.iter().find(|(known, _)| *known == key).map(|(_, example)| *example),
    }
}
