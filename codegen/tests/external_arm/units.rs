//! Logs whose columns are in other units than their names say.

use super::{Arm, RIGHT, Recorded};
use std::f64::consts::PI;
use std::fs;

/// The arm with limits, as a stranger's description has them.
fn with_limits() -> Arm {
    let arm = Arm::new();
    let mut text = fs::read_to_string(arm.at("arm.toml")).unwrap();
    for (name, effort) in [("turn", 150.0), ("lift", 150.0), ("reach", 60.0)] {
        let limits = format!("limits = {{ position = [-3, 3], velocity = 4, effort = {effort:.1} }}");
        text = text.replacen(
            &format!("name = \"{name}\"\naxis"),
            &format!("name = \"{name}\"\n{limits}\naxis"),
            1,
        );
    }
    fs::write(arm.at("limited.toml"), text).unwrap();
    arm
}

const DEGREES: f64 = 180.0 / PI;
const RPM: f64 = 30.0 / PI;

#[test]
fn values_far_beyond_the_limits_are_refused_with_their_unit() {
    let arm = with_limits();
    let cases = [
        ([1.0, DEGREES, 1.0], "the positions seem to be in deg: use --columns 'position=q_{name}[deg]'"),
        ([1.0, 1e3, 1.0], "the positions seem to be in mrad: use --columns 'position=q_{name}[mrad]'"),
        ([1e-3, 1.0, 1.0], "times are in another unit (--columns 'time=t[UNIT]')"),
        ([1.0 / 60.0, 1.0, 1.0], "times are in min (--columns 'time=t[min]')"),
        ([1.0, 1.0, 1e3], "the efforts may be in mNm: use --columns 'torque=effort_{name}[mNm]'"),
        (
            [1.0, 1.0, 20.0],
            "for counts and percents, give a factor: --columns 'torque=effort_{name}[0.05 Nm]'",
        ),
        ([1.0, RPM, 1.0], "positions are in deg (--columns 'position=q_{name}[deg]')"),
    ];
    for (factors, remedy) in cases {
        arm.record_as("arm.toml", "log.csv", Recorded { factors, ..RIGHT });
        let said = arm.refuses(&["limited.toml", "log.csv", "--output", "refused.toml"]);
        let error = said.split("error[far-beyond-limits]: ").nth(1).unwrap();
        assert!(error.contains(remedy) && error.contains("the described limits are"), "{factors:?}: {said}");
        assert!(error.contains("(column `") || error.contains("(slopes of column `q_"), "{said}");
    }
    // The command that is named mends it.
    arm.record_as("arm.toml", "log.csv", Recorded { factors: [1.0, DEGREES, 1e3], ..RIGHT });
    let columns = "position=q_{name}[deg],torque=effort_{name}[mNm]";
    let done = arm.run(&["limited.toml", "log.csv", "--output", "found.toml", "--columns", columns]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// Without limits the weight of the robot tells.
#[test]
fn efforts_that_carry_another_robot_are_refused() {
    let arm = Arm::new();
    let refused = [
        ([1.0, 1.0, 1e3], "they may be in mNm (--columns 'torque=…[mNm]')"),
        ([1.0, 1.0, DEGREES], "for example --columns 'torque=…[0.05 Nm]'"),
        ([1.0, 1.0, 20.0], "for example --columns 'torque=…[0.05 Nm]'"),
        ([1.0, 1.0, 0.05], "--effort input"),
        ([1.0, 1.0, 1e-3], "--effort input"),
        ([1.0, DEGREES, 1.0], "check the unit of the positions"),
        ([1.0, 1e-3, 1.0], "check the unit of the positions"),
    ];
    for (factors, remedy) in refused {
        arm.record_as("arm.toml", "log.csv", Recorded { factors, ..RIGHT });
        let said = arm.refuses(&["arm.toml", "log.csv", "--effort", "joint", "--output", "refused.toml"]);
        assert!(said.contains(remedy), "{factors:?}: {said}");
    }
    // It is written where that is asked for, and says so.
    arm.record_as("arm.toml", "log.csv", Recorded { factors: [1.0, 1.0, 20.0], ..RIGHT });
    let arguments = ["arm.toml", "log.csv", "--effort", "joint", "--accept-poor", "--output", "found.toml"];
    let done = arm.run(&arguments);
    assert!(
        String::from_utf8(done.stdout)
            .unwrap()
            .contains("warning[other-unit-of-efforts]: the rigid-body forces in the efforts are")
    );
    // Moments say the same, where they are made and where they are merged.
    assert!(
        arm.run(&["arm.toml", "log.csv", "--effort", "joint", "--reduce", "--output", "log.moments"])
            .status
            .success()
    );
    let said = arm.refuses(&["arm.toml", "log.moments", "--merge", "--output", "refused.toml"]);
    assert!(said.contains("the rigid-body forces in the efforts are"), "{said}");
    // Right units pass.
    arm.record("arm.toml", "log.csv", None);
    let found = arm.identify(&["log.csv", "--output", "found.toml"]);
    assert!(!found["warnings"].to_string().contains("of the described bodies"), "{:#}", found["warnings"]);
}

/// A load is refused by the same values as a robot.
#[test]
fn loads_from_logs_in_other_units_are_refused() {
    let arm = with_limits();
    let record = |factors: [f64; 3], log: &str| {
        let description = if log == "with.csv" { "loaded.toml" } else { "arm.toml" };
        arm.record_as(description, log, Recorded { factors, ..RIGHT });
    };
    let load = |description: &str| {
        arm.refuses(&[description, "without.csv", "--payload", "with.csv", "--output", "refused.toml"])
    };
    record([1.0; 3], "without.csv");
    record([1.0, DEGREES, 1.0], "with.csv");
    assert!(
        load("limited.toml")
            .contains("the positions seem to be in deg: use --columns 'position=q_{name}[deg]'")
    );
    record([1.0, 1.0, 1e3], "with.csv");
    assert!(
        load("limited.toml").contains("the efforts may be in mNm: use --columns 'torque=effort_{name}[mNm]'")
    );
    // Without limits the weight of the robot shows it. No fit has tried a unit, so none is named.
    let said = load("arm.toml");
    assert!(said.contains("the rigid-body forces in the efforts are 1") && !said.contains("[mNm]"), "{said}");
    record([1.0, 1.0, 1e3], "without.csv");
    let said = load("arm.toml");
    assert!(
        said.contains("the rigid-body forces")
            && said.contains("are 1000 times the forces of the described bodies"),
        "{said}"
    );
    // It is written where that is asked for, and says so; a right load has no doubt.
    let arguments = ["arm.toml", "without.csv", "--payload", "with.csv", "--output", "found.toml"];
    let done = arm.run(&[&arguments[..], &["--accept-poor"]].concat());
    assert!(
        String::from_utf8(done.stdout)
            .unwrap()
            .contains("warning[other-unit-of-efforts]: the rigid-body forces in the efforts are")
    );
    record([1.0; 3], "without.csv");
    record([1.0; 3], "with.csv");
    let done = arm.run(&arguments);
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(done.status.success() && !text.contains("other-unit-of-efforts"), "{text}");
    assert!(
        text.starts_with("note[columns]: time: `t`\nnote[columns]: positions: `q_{name}`, in rad"),
        "{text}"
    );
}
