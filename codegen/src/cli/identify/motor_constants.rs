//! Findings about motor constants. If the description has none, they are identified from logs of currents.

use gelenk_findings::digits::{plain, rounded};
use gelenk_identification::estimation::{JointEstimate, Uncertain};
use gelenk_identification::identify::Identification;

use gelenk_findings::{Finding, Rule};

/// Sees: motor constants that are estimated from logs of currents.
/// Matters: the estimated constants are only as accurate as the described masses.
/// Example: 0.12 N·m/A.
/// Fixture: `codegen/tests/external_arm/main.rs`.
const ESTIMATED: Rule = Rule::note("motor-constant");

/// Sees: a motor constant that is negative or outside the usual range.
/// Matters: the current is in another unit, or the described masses are wrong.
/// Example: 300 N·m/A.
/// Fixture: `codegen/tests/external_arm/said.rs`.
const DOUBTFUL_CONSTANT: Rule = Rule::warning("motor-constant-doubtful");

/// Smallest and largest usual motor constant of a revolute joint in N m/A, including gears that the
/// description lacks.
const USUAL: [f64; 2] = [1e-3, 100.0];

/// Returns the motor constants that are known within a factor of 2.
fn known(found: &Identification) -> impl Iterator<Item = (&JointEstimate, Uncertain)> {
    let constants = found.estimate.joints.iter().filter_map(|joint| Some((joint, joint.gain?)));
    constants.filter(|(_, constant)| constant.has_one_size())
}

/// Returns findings that state the identified motor constants with confidence intervals.
pub(super) fn findings(found: &Identification) -> Vec<Finding> {
    let level = 100.0 * found.estimate.confidence;
    let finding = |(joint, constant): (&JointEstimate, Uncertain)| {
        let Uncertain { value, interval: [low, high], .. } = constant;
        let [value, low, high] = [value, low, high].map(|x| rounded(x, Some(0.5 * (high - low))));
        let message = format!(
            "its motor constant is {value} N·m/A ({level:.0} % interval: {low} to {high}), if the described masses and centres of \
             mass are correct"
        );
        ESTIMATED.found(message).joint(&joint.name)
    };
    known(found).map(finding).collect()
}

/// Adds warnings about doubtful motor constants to the findings of an estimate.
pub(super) fn add_doubts(found: &mut Identification) {
    let doubts: Vec<Finding> = known(found).filter_map(|(joint, constant)| doubt(joint, constant)).collect();
    found.estimate.findings.extend(doubts);
}

fn doubt(joint: &JointEstimate, constant: Uncertain) -> Option<Finding> {
    let value = constant.value;
    let doubt = if value < 0.0 {
        "is negative, so current and position have opposite positive directions. Give a negative factor, as in --columns \
         'current=…[-1 A]'".to_owned()
    } else if joint.unit == "N·m" && !(USUAL[0]..=USUAL[1]).contains(&value) {
        format!(
            "is outside the usual range {} to {} N·m/A. Check the unit of the current, as in --columns 'current=…[mA]', and the \
             described gear and masses",
            USUAL[0], USUAL[1]
        )
    } else {
        return None;
    };
    let message = format!("its motor constant of {} N·m/A {doubt}", plain(value, 4));
    Some(DOUBTFUL_CONSTANT.found(message).joint(&joint.name).with("motor constant", value, "N·m/A"))
}
