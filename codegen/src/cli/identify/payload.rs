//! The command `gelenk identify --payload`, which estimates the load in the robot's hand.

use std::path::Path;
use std::process::ExitCode;

use gelenk_findings::digits::{plain, rounded};
use gelenk_findings::{Severity, texts};
use gelenk_identification::estimation::Uncertain;
use gelenk_identification::payload::{CarriedLoad, Payload, PayloadSettings, identify_load};
use gelenk_identification::result::description::Identified;
use gelenk_identification::robot::Robot;
use serde_json::{Value, json};

use super::super::arguments::{Format, Identify};
use super::super::failure::Failure;
use super::super::print;
use super::logs::{command, output, settings, write_description};
use super::read::{read, say};
use crate::identify::{BodyValues, InterpretedRobot, rounded_load};
use crate::model::Model;
use crate::wording::list;

/// Name of the load's body in the written description.
const NAME: &str = "payload";

/// Identifies a load in the hand, and writes a description in which the load is a body.
pub(super) fn write(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (loaded, robot) = read(arguments)?;
    let output = output(arguments, &loaded, "payload")?;
    let carrier = carrier(arguments, &robot)?;
    let load = PayloadSettings { body: Some(carrier.body), ..PayloadSettings::default() };
    let settings = settings(arguments)?;
    let found = identify_load(&robot, &arguments.logs, &arguments.payload, &settings, &load, &mut say);
    let found = print::identified(found)?;
    let link = &carrier.link;
    describe(arguments, &loaded.model, &found, link, &output)?;
    print::result(
        format,
        || as_json(&found, link, &robot, &output),
        || as_text(&found, link, &robot, &output),
    )
}

/// The link that carries the identified load.
struct Carrier {
    body: usize,
    link: String,
}

/// Returns the link of `--payload-on`. The option may also name the joint that moves the link. By default, the
/// last moving link is used.
fn carrier(arguments: &Identify, robot: &InterpretedRobot) -> Result<Carrier, Failure> {
    let model = robot.model();
    let joints = model.carrying_joints();
    let link = |body: usize| model.links[joints[body].moving.link].name.as_str();
    let body = match &arguments.payload_on {
        None => joints.len().checked_sub(1),
        Some(name) => {
            let of_link = (0..joints.len()).position(|body| link(body) == name);
            of_link.or_else(|| joints.iter().position(|joint| joint.name == name))
        }
    };
    let found = body.map(|body| Carrier { body, link: link(body).to_owned() });
    found.ok_or_else(|| {
        let of = arguments.payload_on.as_deref().unwrap_or_default();
        let known = list((0..joints.len()).map(link));
        Failure::Usage(format!("--payload-on {of} does not name a moving link. The moving links are {known}"))
    })
}

fn describe(
    arguments: &Identify,
    model: &Model,
    found: &CarriedLoad,
    link: &str,
    output: &Path,
) -> Result<(), Failure> {
    let values = found.payload.parameters.map(|parameter| parameter.value);
    let name = free_name(model);
    let body = BodyValues::of_link(name, Some(link.to_owned()), &values);
    let body = rounded_load(&body, &found.payload).toml();
    let hashes = found.recordings.iter().zip(["without", "with"]).flat_map(|(recording, which)| {
        recording.hashes.iter().map(move |(path, hash)| {
            let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
            format!("{name}, {which} the load: sha256 {hash}")
        })
    });
    let said = texts(&found.findings, Severity::Warning);
    let provenance: Vec<String> = std::iter::once(command(arguments)).chain(hashes).chain(said).collect();
    let identified = Identified { provenance: &provenance, bodies: &[body], ..Identified::default() };
    write_description(arguments, identified, output)
}

/// Returns a name that no body of the description has, because a body with the same name would be replaced.
fn free_name(model: &Model) -> String {
    let is_taken =
        |name: &str| model.links.iter().flat_map(|link| &link.bodies).any(|body| body.name == name);
    let numbered = (2_usize..).map(|number| format!("{NAME}_{number}"));
    let mut names = std::iter::once(NAME.to_owned()).chain(numbered);
    names.find(|name| !is_taken(name)).unwrap_or_else(|| NAME.to_owned())
}

/// Returns the identified values of the load: name, unit and value.
fn values(payload: &Payload) -> Vec<(&'static str, &'static str, Uncertain)> {
    const CENTRE: [&str; 3] = ["centre of mass x", "centre of mass y", "centre of mass z"];
    const MOMENTS: [&str; 6] = ["Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];
    let centre = CENTRE.into_iter().zip(payload.centre_of_mass).map(|(name, value)| (name, "m", value));
    let moments = MOMENTS.into_iter().zip(payload.moments).map(|(name, value)| (name, "kg m²", value));
    std::iter::once(("mass", "kg", payload.mass)).chain(centre).chain(moments).collect()
}

fn as_text(found: &CarriedLoad, link: &str, robot: &InterpretedRobot, output: &Path) -> String {
    let mut text = print::lines(&found.findings);
    let payload = &found.payload;
    text.push_str(&format!("\nload on {link} (moments of inertia about the load's centre of mass):\n"));
    let head = ["", "value", "95 % interval", "excited by the motion"];
    let rows = values(payload).into_iter().enumerate().map(|(place, (name, unit, value))| {
        let [low, high] = value.interval;
        let shown = if payload.shown[place] { "yes" } else { "no" };
        let half = Some(0.5 * (high - low)).filter(|half| half.is_finite());
        let number = |x: f64| half.map_or_else(|| plain(x, 4), |half| rounded(x, Some(half)));
        let interval = format!("{} … {}", number(low), number(high));
        vec![name.to_owned(), format!("{} {unit}", number(value.value)), interval, shown.to_owned()]
    });
    text.push_str(&print::headed(&head, rows));
    let head = ["joint", "explained change", "residual"];
    let joints = robot.joint_names().into_iter().zip(&payload.explained).zip(&payload.residuals);
    let rows = joints.map(|((name, explained), residual)| {
        let known = |x: Option<String>| x.unwrap_or_else(|| "–".to_owned());
        let explained = explained.map(|share| format!("{share:.3}"));
        vec![name, known(explained), known(residual.map(|size| plain(size, 3)))]
    });
    text.push_str(&format!("\n{}", print::headed(&head, rows)));
    text.push_str(&format!("\nwrote {}\n", output.display()));
    text
}

fn as_json(found: &CarriedLoad, link: &str, robot: &InterpretedRobot, output: &Path) -> Value {
    let payload = &found.payload;
    let value = |of: &Uncertain| json!({"value": of.value, "interval": of.interval});
    let joints = robot.joint_names().into_iter().zip(&payload.explained).zip(&payload.residuals);
    json!({
        "description": output.display().to_string(),
        "files": [],
        "link": link,
        "mass": value(&payload.mass),
        "center_of_mass": payload.centre_of_mass.iter().map(value).collect::<Value>(),
        "moments": payload.moments.iter().map(value).collect::<Value>(),
        "parameters": payload.parameters.iter().map(value).collect::<Value>(),
        "shown": payload.shown,
        "joints": joints.map(|((name, explained), residual)| {
            json!({"name": name, "explained": explained, "residual": residual})
        }).collect::<Value>(),
        "findings": print::findings(&found.findings),
        "warnings": texts(&found.findings, Severity::Warning),
    })
}
