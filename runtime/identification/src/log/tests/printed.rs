//! Messages about the columns of a log.

use super::super::recording::guess_columns_of;
use super::super::{ColumnOptions, Recording, runs_of};
use super::styles::logs;
use super::testing::Fake;
use gelenk_findings::Severity;

fn read(header: &str, first: &str, columns: Option<&str>) -> Recording {
    let rows: String = (0..4).map(|i| format!("{}{first}\n", 10 * i)).collect();
    let options = ColumnOptions { columns: columns.map(str::to_owned), ..ColumnOptions::default() };
    let text = format!("{header}{rows}");
    runs_of(text.as_bytes(), "log.csv", &Fake::numbered(2), &options).unwrap()
}

fn warnings(recording: &Recording) -> Vec<String> {
    let warnings = recording.findings.iter().filter(|finding| finding.severity == Severity::Warning);
    warnings.map(ToString::to_string).collect()
}

fn said(header: &str, first: &str, columns: Option<&str>) -> Vec<String> {
    read(header, first, columns).columns_found().into_iter().map(|found| found.message).collect()
}

#[test]
fn each_quantity_has_a_line() {
    let header = "Time [ms],q1 [deg],q2 [deg],dq1,dq2,tau_1,tau_2,temp_1,temp_2\n";
    let expected = [
        "time: `Time [ms]`",
        "positions: `q{} [deg]` from `q1 [deg]` of joint_1 to `q2 [deg]` of joint_2, times 0.0174533 in rad",
        "velocities: `dq{}` from `dq1` of joint_1 to `dq2` of joint_2, in rad/s because the header has no \
         unit (only for a comparison: the derivatives of the positions are used)",
        "efforts, as forces at the joints: `tau_{}` from `tau_1` of joint_1 to `tau_2` of joint_2, in N*m \
         because the header has no unit",
        "not used: `temp_1`, `temp_2`",
    ];
    assert_eq!(said(header, ",1,2,3,4,5,6,7,8", None), expected);
}

/// A pattern with a number stands for columns in the order of their numbers. The columns are listed if the rows name the
/// joints in another order, or if the log has no headers.
#[test]
fn patterns_name_the_columns_that_were_taken() {
    let listed =
        said("t,name0,name1,position0,position1,effort0,effort1\n", ",joint_2,joint_1,1,2,3,4", None);
    assert!(listed[1].contains("`position1|position0` from `position1` of joint_1"), "{listed:?}");
    let bare = said("", ",1,2,3,4", Some("time=1,position=2..3,torque=4|5"));
    assert!(bare[1].contains("`2|3` from number 2 of joint_1 to number 3 of joint_2"), "{bare:?}");
    // The printed columns can be passed as an option.
    let again = said("", ",1,2,3,4", Some("time=1,position=2|3,torque=4|5"));
    assert_eq!(bare, again);
    let named = said("t,joint_1_pos,joint_2_pos,u1,u2\n", ",1,2,3,4", None);
    assert!(named[1].starts_with("positions: `{name}_pos`, in rad"), "{named:?}");
}

#[test]
fn what_is_commanded_is_doubted_where_nothing_is_measured() {
    let doubts = |header: &str, columns| warnings(&read(header, ",1,2,3,4", columns));
    let all = doubts("t,q_d1,q_d2,tau_cmd1,tau_cmd2\n", None);
    assert!(
        all[0].contains(
            "column-doubtful]: the columns of the positions (`q_d{}`) have names of commanded values"
        ),
        "{all:?}"
    );
    assert!(
        all[1].contains("the efforts (`tau_cmd{}`)") && all[1].ends_with("--columns 'torque=…'"),
        "{all:?}"
    );
    // If the user names the columns, there is no warning.
    assert!(doubts("t,q_d1,q_d2,tau_cmd1,tau_cmd2\n", Some("position=q_d{},torque=tau_cmd{}")).is_empty());
    assert!(doubts("t,q1,q2,tau1,tau2\n", None).is_empty());
    let both = read("t,q1,q2,tau1,tau2,q_d1,q_d2\n", ",1,2,3,4,5,6", None);
    assert_eq!(both.unused, ["q_d1", "q_d2"]);
    assert!(warnings(&both).is_empty());
}

#[test]
fn units_of_times_are_known_or_doubted() {
    let minutes = read("Time [min],q1,q2,u1,u2\n", ",1,2,3,4", None);
    assert_eq!((minutes.runs[0].times[1], warnings(&minutes).len()), (600.0, 0));
    let ticks = read("Time [ticks],q1,q2,u1,u2\n", ",1,2,3,4", None);
    let said = warnings(&ticks);
    assert!(said[0].contains("`ticks`, which is not a known unit"), "{said:?}");
    assert!(said[0].ends_with("--columns 'time=Time [ticks][0.001 s]'"), "{said:?}");
    let told = read("Time [ticks],q1,q2,u1,u2\n", ",1,2,3,4", Some("time=Time [ticks][0.001 s]"));
    assert_eq!((told.runs[0].times[1], warnings(&told).len()), (0.01, 0));
}

/// The line from `--columns '?'`, passed as an option, gives the same columns and units.
#[test]
fn guesses_are_read_as_the_log_is() {
    let robot = Fake::numbered(2);
    for (style, text, options) in logs() {
        let guess = guess_columns_of(&text, "log.csv", &robot, &options).unwrap();
        assert_eq!(guess.faults, [], "{style}: {}", guess.line);
        let again = ColumnOptions { columns: Some(guess.line.clone()), ..ColumnOptions::default() };
        let read = |options| runs_of(&text, "log.csv", &robot, options).unwrap();
        let (first, second) = (read(&options), read(&again));
        assert_eq!((&first.runs, first.effort), (&second.runs, second.effort), "{style}: {}", guess.line);
        assert_eq!(
            (&first.labels, &first.unused),
            (&second.labels, &second.unused),
            "{style}: {}",
            guess.line
        );
        let twice = guess_columns_of(&text, "log.csv", &robot, &again).unwrap();
        assert_eq!(guess, twice, "{style}");
    }
}

/// Poses may have all names that the tests of floating robots use.
#[test]
fn guesses_of_poses_are_read_as_the_log_is() {
    let inputs = "u_front_right,u_rear_left,u_front_left,u_rear_right";
    let pose = "pose.position.x,pose.position.y,pose.position.z,pose.orientation.w,pose.orientation.x,pose.orientation.y,pose.orientation.z";
    let cases = [
        (format!("time,q_base_x,q_base_y,q_base_z,q_base_qw,q_base_qx,q_base_qy,q_base_qz,{inputs}"), ""),
        (format!("time,{pose},{inputs}"), ""),
        ("t,x [mm],y [mm],z [mm],qw,qx,qy,qz,u0,u1,u2,u3".into(), ""),
        ("t [s],a,b,c,d,e,f,g,h,i,j,k".into(), "place=2..4[mm],wxyz=5..8,input=9..12"),
    ];
    let robot = Fake::floating();
    for (header, columns) in cases {
        let rows: String = (0..4).map(|i| format!("{i},1,2,3,0.5,0.5,0.5,0.5,5,6,7,8\n")).collect();
        let text = format!("{header}\n{rows}").into_bytes();
        let options = ColumnOptions { columns: Some(columns.into()), ..ColumnOptions::default() };
        let guess = guess_columns_of(&text, "log.csv", &robot, &options).unwrap();
        assert_eq!(guess.faults, [], "{}", guess.line);
        let again = ColumnOptions { columns: Some(guess.line.clone()), ..ColumnOptions::default() };
        let read = |options| runs_of(&text, "log.csv", &robot, options).unwrap();
        assert_eq!(read(&options).runs, read(&again).runs, "{}", guess.line);
    }
}

#[test]
fn incomplete_guesses_have_marks() {
    let text = b"clock_in,q1,q2,tau_1 [Nm],x\n0,1,2,3,4\n1,1,2,3,4\n";
    let options = ColumnOptions { columns: Some("time=clock_in[0.5 s]".into()), ..ColumnOptions::default() };
    let guess = guess_columns_of(text, "log.csv", &Fake::numbered(2), &options).unwrap();
    assert_eq!(guess.line, "time=clock_in[0.5 s],position=q{}[rad],torque=?");
    assert_eq!(guess.columns, ["clock_in", "q1", "q2", "tau_1 [Nm]", "x"]);
    assert!(guess.faults[0].message.contains("no column for the effort of `joint_2`"), "{:?}", guess.faults);
    let bare = guess_columns_of(b"0,1,2\n1,1,2\n", "log.csv", &Fake::numbered(1), &ColumnOptions::default());
    let bare = bare.unwrap();
    assert_eq!(
        (bare.line.as_str(), bare.columns.len(), bare.faults.len()),
        ("time=?,position=?,torque=?", 3, 1)
    );
    // Errors name the command that prints the line.
    let fault = runs_of(text, "log.csv", &Fake::numbered(2), &options).unwrap_err().to_string();
    assert!(fault.contains("--columns '?' prints all columns as a line that you can edit"), "{fault}");
}

/// The line contains numbers instead of headers that it cannot contain.
#[test]
fn guesses_survive_odd_headers() {
    let header = "t,\"a|q1,x=\",\"a|q2,x=\",joint_1_tau_ncm,joint_2_tau";
    let text = format!("{header}\n0,1,2,3,4\n1,1,2,3,4\n");
    let options = ColumnOptions { columns: Some("time=t,position=2..3".into()), ..ColumnOptions::default() };
    let guess = guess_columns_of(text.as_bytes(), "log.csv", &Fake::numbered(2), &options).unwrap();
    assert_eq!(guess.line, "time=t,position=2|3[rad],torque=joint_1_tau_ncm[Ncm]|joint_2_tau[Nm]");
    let again = ColumnOptions { columns: Some(guess.line), ..ColumnOptions::default() };
    let read = |options| runs_of(text.as_bytes(), "log.csv", &Fake::numbered(2), options).unwrap().runs;
    assert_eq!(read(&options), read(&again));
}

/// A log without the columns of a held joint equals the log of the other joints for all styles of names. The efforts of a
/// held joint are unknown.
#[test]
fn held_joints_have_no_columns() {
    let read = |header: &str, columns: &str| {
        let text = format!("{header}\n0,1,3,10,30\n1,2,4,20,40\n");
        let options = ColumnOptions { columns: Some(columns.into()), ..ColumnOptions::default() };
        runs_of(text.as_bytes(), "log.csv", &Fake::numbered(3), &options)
            .map(|mut recording| recording.runs.remove(0))
    };
    let cases = [
        ("t,q1,q3,tau1,tau3", "hold=joint_2=0.5"),
        ("t,q1,q2,tau1,tau2", "hold=joint_2=0.5"),
        (
            "t,joint_3_effort,joint_3_pos,joint_1_effort,joint_1_pos",
            "hold=*2=0.5,position=5|3,torque={name}_effort",
        ),
        ("t,q1,q3,u1,u3", "position=q{},input=u{},hold=joint_2=0.5"),
        ("t,q1,q3,tau1,tau3", "torque=2..3,position=4..5,hold=joint_2=0.5"),
    ];
    for (header, columns) in cases {
        let run = read(header, columns).unwrap();
        let known: Vec<f64> =
            [0, 2].iter().flat_map(|j| [&run.positions[*j], &run.efforts[*j]]).flatten().copied().collect();
        let mut sorted = known.clone();
        sorted.sort_by(f64::total_cmp);
        assert_eq!(sorted, [1.0, 2.0, 3.0, 4.0, 10.0, 20.0, 30.0, 40.0], "{header}");
        assert_eq!(run.positions[1], [0.5, 0.5], "{header}");
        assert!(run.velocities[1].is_none() && run.efforts[1].iter().all(|u| u.is_nan()), "{header}");
    }
    for header in ["t,q1,q2,q3,tau1", "t,joint_1_pos,joint_2_pos,joint_3_pos,joint_2_effort"] {
        let fault = read(header, "hold=joint_2").unwrap_err().to_string();
        assert!(
            fault.contains("joint `joint_2` is held by an option, but the log has its column"),
            "{header}: {fault}"
        );
    }
    let fault = read("t,joint_1_pos,joint_3_pos,u1,u2", "").unwrap_err().to_string();
    assert!(fault.contains("at rest, give its position: --hold joint_2=0"), "{fault}");
}
