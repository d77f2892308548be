//! Notes about skipped or changed parts of an MJCF, with one note for each kind.

use crate::read::skipped::Remark;

// Changes of the dynamics in MuJoCo (M, k, q, and the effect of an input) are warnings.
pub(super) const ACTUATOR: Remark = Remark::warning(
    "actuator-skipped",
    "actuators that do not act on a joint, a fixed tendon or a single named site were omitted",
);
pub(super) const ACTUATOR_RANGE: Remark = Remark::note(
    "actuator-range",
    "force and control ranges of actuators were omitted, because they are not symmetric about 0",
);
pub(super) const EFFORT_RANGE: Remark = Remark::note(
    "effort-range",
    "asymmetric force ranges of joints were replaced by ± their smaller bound, or omitted if they exclude 0",
);
pub(super) const ELASTIC: Remark =
    Remark::warning("elastic-skipped", "deformable bodies and forces of plugins were omitted");
pub(super) const EQUALITY: Remark = Remark::warning(
    "equality-skipped",
    "equality constraints between joints or tendons were omitted if they are nonlinear, or act on a follower or a joint with a quaternion",
);
pub(super) const FLAG: Remark =
    Remark::warning("flag-skipped", "flags of <option> that disable parts of the model were ignored");
pub(super) const GRAVITY_COMPENSATION: Remark =
    Remark::warning("gravity-compensation", "gravity compensation (`gravcomp`) was omitted");
pub(super) const LOOP: Remark = Remark::warning(
    "loop-opened",
    "equality constraints that close loops (connect, weld and similar) were omitted, so the robot moves without them",
);
pub(super) const MEDIUM: Remark = Remark::warning("medium-skipped", "fluid forces were omitted");
pub(super) const MESH_INERTIA: Remark = Remark::warning(
    "mesh-inertia",
    "meshes whose mass cannot be computed were omitted, so bodies without <inertial> lack their mass",
);
pub(super) const QUATERNION_FORCE: Remark = Remark::warning(
    "quaternion-joint",
    "armature, springs, limits and dry friction of ball and free joints were omitted",
);
pub(super) const RANGE: Remark =
    Remark::warning("limit-unusable", "joint ranges with equal or reversed ends were omitted");
pub(super) const SERVO: Remark =
    Remark::warning("servo-as-torque", "servos were read as force inputs. Their gains were omitted");
pub(super) const SPRING_DAMPER: Remark = Remark::warning(
    "spring-damper",
    "springs given by time constants (`springdamper`) and nonlinear springs were omitted",
);
pub(super) const START_POSE: Remark = Remark::note(
    "start-pose",
    "positions of free bodies are relative to the world, so their initial poses were omitted",
);
pub(super) const TENDON_BRANCHES: Remark = Remark::warning(
    "tendon-branches",
    "tendons with armature couple joints of different branches in M, but the M of MuJoCo lacks these entries",
);
pub(super) const TENDON_FORCE: Remark =
    Remark::warning("tendon-skipped", "springs, limits and spatial paths of tendons were omitted");
