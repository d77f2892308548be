//! The command `gelenk identify --online`, which replays logs through the friction estimator of the control
//! loop.

use std::path::PathBuf;
use std::process::ExitCode;

use gelenk_findings::Finding;
use gelenk_findings::digits::{plain, rounded};
use gelenk_identification::log::runs;
use gelenk_identification::robot::Robot;
use serde_json::{Value, json};

use super::super::arguments::{Format, Identify};
use super::super::failure::Failure;
use super::super::{print, report};
use super::logs::{command, settings};
use super::read::{read, say};
use crate::identify::{DescribedForces, InterpretedRobot, OnlineJoint, Replay, online_page, replay};
use crate::wording::list;

/// Replays logs through the friction estimator of the control loop. It prints the friction terms with
/// intervals, the trust in the learned law and the prediction errors, and writes the page.
pub(super) fn write(arguments: &Identify, format: Format) -> Result<ExitCode, Failure> {
    let (loaded, robot) = read(arguments)?;
    let forces = DescribedForces::new(&loaded.model, arguments.gravity_compensated)
        .map_err(|problems| Failure::Descriptions(vec![problems]))?;
    let recording = print::identified(runs(&arguments.logs, &robot, &settings(arguments)?.columns))?;
    say("replaying the log period by period");
    // If efforts are recorded later than positions, the time until an effort acts is negative.
    let delay = -arguments.delay.unwrap_or(0.0);
    let found = replay(&robot, &|y, v, a| forces.at(y, v, a), &recording.runs, delay);
    let found = print::after(found, &recording.findings)?;
    let (joints, unlearned) = (learned(&found, &robot), unlearned(&found, &robot));
    let files = match &arguments.report {
        Some(folder) => {
            let page = online_page(&loaded.model.name, &joints, &command(arguments));
            print::after(report::written(&page, folder, "--report"), &recording.findings)?
        }
        None => Vec::new(),
    };
    let findings = &recording.findings;
    print::result(
        format,
        || as_json(&found, &joints, &unlearned, findings, &files),
        || as_text(&joints, &unlearned, findings, &files),
    )
}

fn learned(found: &Replay, robot: &InterpretedRobot) -> Vec<OnlineJoint> {
    let named = robot.joint_names().into_iter().zip(robot.position_units()).zip(&found.joints);
    let learned = named.filter_map(|((name, unit), replay)| Some((name, unit, replay.clone()?)));
    learned.map(|(name, unit, replay)| OnlineJoint::new(name, unit, replay)).collect()
}

/// Returns the names of the joints whose friction is not learned.
fn unlearned(found: &Replay, robot: &InterpretedRobot) -> Vec<String> {
    let named = robot.joint_names().into_iter().zip(&found.joints);
    named.filter(|(_, replay)| replay.is_none()).map(|(name, _)| name).collect()
}

fn as_text(joints: &[OnlineJoint], unlearned: &[String], findings: &[Finding], files: &[PathBuf]) -> String {
    let mut text = print::lines(findings);
    let head = [
        "joint",
        "acts",
        "since s",
        "described",
        "learned",
        "by run",
        "batch",
        "hindsight",
        "learned/by run",
    ];
    let row = |joint: &OnlineJoint| {
        let [described, learned, _, by_run, batch, hindsight] = joint.errors();
        let state = [joint.name.clone(), joint.replay.state.trust.name().to_owned()];
        let since = plain(joint.replay.since(), 4);
        let errors = [described, learned, by_run, batch, hindsight, learned / by_run].map(|x| plain(x, 3));
        state.into_iter().chain([since]).chain(errors).collect::<Vec<_>>()
    };
    text.push_str("\nrms error of predictions in N m or N:\n");
    text.push_str(&table(&head, joints.iter().map(row)));
    let head = ["joint", "term", "learned", "±", "acting", "excited by the motion"];
    let rows = joints.iter().flat_map(|joint| {
        joint.replay.state.terms().map(|term| {
            let shown = if term.is_excited { "yes" } else { "no" };
            let values =
                [term.learned, term.half_width, term.acting].map(|x| rounded(x, Some(term.half_width)));
            let names = [joint.name.clone(), term.name.to_owned()];
            names.into_iter().chain(values).chain([shown.to_owned()]).collect::<Vec<_>>()
        })
    });
    if !unlearned.is_empty() {
        let names = list(unlearned.iter().map(String::as_str));
        text.extend([
            "\nfriction of these joints is not learned, because the input or some efforts are missing: ",
            &names,
            "\n",
        ]);
    }
    text.push_str("\nterms that are added to the described friction, with 90 % intervals:\n");
    text.push_str(&table(&head, rows));
    text.extend(files.iter().map(|file| format!("wrote {}\n", file.display())));
    text
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let head = head.iter().map(|word| (*word).to_owned()).collect();
    print::table(&std::iter::once(head).chain(rows).collect::<Vec<_>>())
}

fn as_json(
    found: &Replay,
    joints: &[OnlineJoint],
    unlearned: &[String],
    findings: &[Finding],
    files: &[PathBuf],
) -> Value {
    let one = |joint: &OnlineJoint| {
        let (replay, state) = (&joint.replay, &joint.replay.state);
        let terms = state.terms().map(|term| {
            json!({
                "name": term.name, "learned": term.learned, "half_width": term.half_width, "acting": term.acting,
                "shown": term.is_excited,
            })
        });
        let [described, learned, acting, by_run, batch, hindsight] = joint.errors();
        let last = replay.samples.last().map(|sample| sample.friction);
        json!({
            "name": joint.name,
            "trust": state.trust.name(),
            "since": replay.since(),
            "terms": terms.collect::<Value>(),
            "friction": json!({
                "speed": replay.speed, "described": replay.described, "learned": last.map(|[law, _]| law),
                "half_width": last.map(|[_, half]| half),
            }),
            "noise": state.noise,
            "samples": replay.samples.len(),
            "unexplained": joint.unexplained(),
            "errors": json!({
                "described": described, "learned": learned, "acting": acting, "by_run": by_run, "batch": batch, "hindsight": hindsight,
            }),
            "batch": joint.causal.as_ref().map(|law| json!({"terms": law.terms, "window": law.window})),
        })
    };
    json!({
        "files": files.iter().map(|file| file.display().to_string()).collect::<Value>(),
        "period": found.settings.period,
        "delay": found.settings.delay,
        "joints": joints.iter().map(one).collect::<Value>(),
        "unlearned": unlearned,
        "findings": print::findings(findings),
    })
}
