//! Elements of MJCF, and attributes of the elements that are read. Both are from current and earlier schemas
//! of MuJoCo.

/// Enclosing element or section in which an element may occur.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Model,
    Compiler,
    Options,
    Defaults,
    Body,
    Equalities,
    Tendons,
    Tendon,
    Actuators,
}

/// Tag and attributes of an element. If no attributes are listed, the element is not read and its attributes
/// are not checked.
type Entry = (&'static str, &'static [&'static str]);

/// Attributes that give an orientation. An element may have one of them.
pub(super) const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

const POSE: &str = "pos quat axisangle euler xyaxes zaxis";

const MODEL: [Entry; 16] = [
    (
        "compiler",
        &["alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict convexhull \
           coordinate discardvisual eulerseq exactmeshinertia fitaabb fusestatic inertiafromgeom \
           inertiagrouprange meshdir passthrough savecanonical savecompiled saveinertial settotalmass \
           strippath texturedir usethread"],
    ),
    (
        "option",
        &[
            "actuatorgroupdisable apirate ccd_iterations ccd_tolerance collision cone density gravity impratio \
           integrator iterations jacobian ls_iterations ls_tolerance magnetic mpr_iterations mpr_tolerance \
           noslip_iterations noslip_tolerance o_friction o_margin o_solimp o_solref sdf_initpoints \
           sdf_iterations sleep_tolerance solver timestep tolerance viscosity wind",
        ],
    ),
    ("default", &["class"]),
    ("worldbody", &["name childclass gravcomp mocap user fuse simple sleep", POSE]),
    ("equality", &[""]),
    ("tendon", &[""]),
    ("actuator", &[""]),
    ("size", &[]),
    ("visual", &[]),
    ("statistic", &[]),
    ("asset", &[]),
    ("contact", &[]),
    ("sensor", &[]),
    ("keyframe", &[]),
    ("custom", &[]),
    ("extension", &[]),
];

/// The section `deformable`, which has no elements that are read.
const DEFORMABLE: Entry = ("deformable", &[]);

const COMPILER: [Entry; 1] = [("lengthrange", &[])];

const OPTIONS: [Entry; 1] = [(
    "flag",
    &[
        "actuation autoreset clampctrl collision constraint contact damper diagexact energy equality eulerdamp \
       filterparent frictionloss fwdinv gravity invdiscrete ipc island limit midphase multiccd nativeccd \
       override passive refsafe sensor sleep speculative spring warmstart",
    ],
)];

const JOINT: &str = "name class type pos axis range ref limited margin armature damping frictionloss \
    stiffness springref springdamper springyield group user actuatorfrclimited actuatorfrcrange \
    actuatorgravcomp solreflimit solimplimit solreffriction solimpfriction solref solimp";

const GEOM: &str = "name class type size fromto mass density shellinertia group mesh hfield fitscale material \
    rgba friction condim contype conaffinity priority margin gap solmix solref solimp fluidshape fluidcoef \
    user adhesion castshadow surfacevel";

const SITE: &str = "name class type size fromto group material mesh rgba user";

const BODY: [Entry; 14] = [
    ("body", &["name childclass gravcomp mocap user fuse simple sleep", POSE]),
    ("frame", &["name childclass", POSE]),
    ("inertial", &["mass diaginertia fullinertia", POSE]),
    ("joint", &[JOINT]),
    ("freejoint", &["name group align user class"]),
    ("geom", &[GEOM, POSE]),
    ("site", &[SITE, POSE]),
    ("camera", &[]),
    ("light", &[]),
    ("plugin", &[]),
    ("replicate", &["count sep offset euler"]),
    ("composite", &[]),
    ("flexcomp", &[]),
    ("attach", &["model body prefix"]),
];

/// Elements that may have defaults in classes, except elements of bodies and actuators.
const DEFAULTS: [Entry; 8] = [
    ("default", &["class"]),
    ("equality", &["active solref solimp polycoef"]),
    ("tendon", &[TENDON]),
    ("mesh", &[]),
    ("texture", &[]),
    ("material", &[]),
    ("pair", &[]),
    ("skin", &[]),
];

/// Tags of elements of bodies that may have defaults in classes.
const IN_CLASSES: [&str; 6] = ["joint", "geom", "site", "camera", "light", "plugin"];

const EQUALITIES: [Entry; 8] = [
    ("joint", &["name class active joint1 joint2 polycoef solref solimp"]),
    ("connect", &[]),
    ("weld", &[]),
    ("tendon", &[]),
    ("flex", &[]),
    ("flexvert", &[]),
    ("flexstrain", &[]),
    ("distance", &[]),
];

const TENDON: &str = "name class group limited range margin springlength springyield stiffness damping \
    frictionloss armature width material rgba user actuatorfrclimited actuatorfrcrange solreflimit \
    solimplimit solreffriction solimpfriction";

const TENDONS: [Entry; 2] = [("fixed", &[TENDON]), ("spatial", &[TENDON])];

const OF_TENDONS: [Entry; 4] = [("joint", &["joint coef"]), ("site", &[]), ("geom", &[]), ("pulley", &[])];

const ACTUATOR: &str = "name class group user joint jointinparent tendon site refsite body cranksite \
    slidersite cranklength gear ctrllimited ctrlrange forcelimited forcerange lengthrange actlimited \
    actrange actdim actearly armature damping delay interp nsample input inheritrange";

const SERVO: &str = "kp kv ki kd dampratio timeconst imax posrange slewmax velrange ffrange";

const ACTUATORS: [Entry; 13] = [
    ("motor", &[ACTUATOR]),
    ("general", &[ACTUATOR, "dyntype gaintype biastype dynprm gainprm biasprm ffrange velrange"]),
    ("position", &[ACTUATOR, SERVO]),
    ("velocity", &[ACTUATOR, SERVO]),
    ("intvelocity", &[ACTUATOR, SERVO]),
    ("orientation", &[ACTUATOR, SERVO]),
    ("pid", &[ACTUATOR, SERVO]),
    ("damper", &[ACTUATOR, "kv"]),
    ("cylinder", &[ACTUATOR, "timeconst area diameter bias"]),
    ("muscle", &[ACTUATOR, "timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax"]),
    ("adhesion", &[ACTUATOR, "gain"]),
    (
        "dcmotor",
        &[ACTUATOR, "cogging controller inductance lugre motorconst nominal resistance saturation thermal"],
    ),
    ("plugin", &[]),
];

/// The elements that may occur in this section, with their attributes.
fn entries(place: Place) -> Vec<Entry> {
    match place {
        Place::Model => MODEL.iter().chain([&DEFORMABLE]).copied().collect(),
        Place::Compiler => COMPILER.to_vec(),
        Place::Options => OPTIONS.to_vec(),
        Place::Body => BODY.to_vec(),
        Place::Equalities => EQUALITIES.to_vec(),
        Place::Tendons => TENDONS.to_vec(),
        Place::Tendon => OF_TENDONS.to_vec(),
        Place::Actuators => ACTUATORS.to_vec(),
        Place::Defaults => {
            let of_bodies = BODY.iter().filter(|(tag, _)| IN_CLASSES.contains(tag));
            of_bodies.chain(&DEFAULTS).chain(&ACTUATORS).copied().collect()
        }
    }
}

/// Tags of the elements that may occur in this section.
pub(super) fn tags(place: Place) -> Vec<&'static str> {
    entries(place).into_iter().map(|(tag, _)| tag).collect()
}

/// Attributes that an element in this section may have; `None` if the element is not read.
pub(super) fn attributes(place: Place, tag: &str) -> Option<Vec<&'static str>> {
    let (_, groups) = entries(place).into_iter().find(|(known, _)| *known == tag)?;
    let words = groups.iter().flat_map(|group| group.split_whitespace());
    (!groups.is_empty()).then(|| words.collect())
}

/// Section that the content of an element belongs to; `None` if this content is not read.
pub(super) fn inside(place: Place, tag: &str) -> Option<Place> {
    match (place, tag) {
        (Place::Model, "compiler") => Some(Place::Compiler),
        (Place::Model, "option") => Some(Place::Options),
        (Place::Model | Place::Defaults, "default") => Some(Place::Defaults),
        (Place::Model, "worldbody") | (Place::Body, "body" | "frame" | "replicate") => Some(Place::Body),
        (Place::Model, "equality") => Some(Place::Equalities),
        (Place::Model, "tendon") => Some(Place::Tendons),
        (Place::Model, "actuator") => Some(Place::Actuators),
        (Place::Tendons, "fixed" | "spatial") => Some(Place::Tendon),
        _ => None,
    }
}
