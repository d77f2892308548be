//! What the columns of a log were taken for, in one line for each quantity.

use super::super::run::Effort;
use super::families::Targets;
use super::finder::Finder;
use super::finding::COLUMN_DOUBTFUL;
use super::scale::factor;
use super::search::{Found, Source};
use super::time::TimeColumn;
use super::vocabulary::Kind;
use super::wording::{key, plural};
use gelenk_findings::Finding;

/// The columns of a mapping.
pub(super) struct Taken<'a> {
    pub time: &'a TimeColumn,
    pub run: Option<usize>,
    pub position: &'a Found,
    pub velocity: Option<&'a Found>,
    /// With what they are, and whom they belong to.
    pub efforts: (&'a Found, Kind, &'a Targets),
    pub desired: Option<&'a [Source]>,
    pub poses: &'a [Source],
}

impl Finder<'_> {
    /// A line for each quantity.
    pub(super) fn brief(&self, taken: &Taken, effort: Effort) -> Vec<String> {
        let joints = &self.robot.joints;
        let time: Vec<String> = match taken.time.columns().as_slice() {
            [] => vec!["the numbers of the rows".to_owned()],
            columns => columns.iter().map(|column| self.label(*column)).collect(),
        };
        let columns = |sources: &[Source]| sources.iter().map(|source| source.column).collect::<Vec<_>>();
        let (efforts, kind, targets) = taken.efforts;
        let forces = match effort {
            _ if self.robot.direct && effort != Effort::Current => "forces at the joints",
            Effort::Joint => "forces at the joints",
            Effort::Input => "inputs, before the gears",
            Effort::Current => "motor currents",
        };
        let lines = [
            Some(format!("time: {}", time.join(" and "))),
            taken.run.map(|run| format!("number of the run: {}", self.label(run))),
            self.ends("poses", &columns(taken.poses)),
            self.line("positions", taken.position, Kind::Position, joints),
            taken.velocity.and_then(|found| {
                let line = self.line("velocities", found, Kind::Velocity, joints)?;
                Some(format!("{line} (compared with the positions' derivatives, which are used)"))
            }),
            self.line(&format!("efforts, as {forces}"), efforts, kind, targets),
            taken
                .desired
                .and_then(|desired| self.pattern_line("commanded positions", &columns(desired), joints)),
        ];
        lines.into_iter().flatten().collect()
    }

    /// Warnings of positions and efforts that are commanded.
    pub(super) fn commanded_said(
        &self,
        (position, effort): (&Found, &Found),
        (kind, targets): (Kind, &Targets),
    ) -> Vec<Finding> {
        let positions =
            (position, Kind::Position, &self.robot.joints, "the joints did otherwise by the control error");
        let efforts =
            (effort, kind, targets, "drives that do not follow at once, or that are limited, gave others");
        let said = |(found, kind, targets, why): (&Found, Kind, &Targets, &str)| {
            let message = format!(
                "the {} (`{}`) are commanded by their names, and no measured ones are found: {why}",
                plural(kind),
                self.pattern_of(&found.columns, targets)
            );
            let remedy = format!("log measured ones, or name their columns with --columns '{}=…'", key(kind));
            COLUMN_DOUBTFUL.found(message).help(remedy)
        };
        [positions, efforts].into_iter().filter(|(found, ..)| found.is_commanded).map(said).collect()
    }

    /// Pattern, unit, and whose the first and the last column are.
    fn line(&self, what: &str, found: &Found, kind: Kind, targets: &Targets) -> Option<String> {
        let line = self.pattern_line(what, &found.columns, targets)?;
        let mut units: Vec<String> = Vec::new();
        for (i, column) in found.columns.iter().enumerate() {
            let (_, unit) = factor(self, *column, kind, i, found.unit(i)).ok()?;
            units.extend((!units.contains(&unit)).then_some(unit));
        }
        Some(format!("{line}, {}", units.join(" or ")))
    }

    fn pattern_line(&self, what: &str, columns: &[usize], targets: &Targets) -> Option<String> {
        let (first, last) = (columns.first()?, columns.last()?);
        let pattern = self.pattern_of(columns, targets);
        let name = |i: usize| targets.names.get(i).map_or("", String::as_str);
        let whose = match columns.len() {
            1 => format!(" of {}", name(0)),
            _ if pattern.contains("{name}") => String::new(),
            n => format!(
                " from {} of {} to {} of {}",
                self.label(*first),
                name(0),
                self.label(*last),
                name(n - 1)
            ),
        };
        Some(format!("{what}: `{pattern}`{whose}"))
    }

    fn ends(&self, what: &str, columns: &[usize]) -> Option<String> {
        let (first, last) = (columns.first()?, columns.last()?);
        Some(format!(
            "{what}: {} columns from {} to {}",
            columns.len(),
            self.label(*first),
            self.label(*last)
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::Fake;
    use super::super::{ColumnOptions, Recording, runs_of};
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
            "velocities: `dq{}` from `dq1` of joint_1 to `dq2` of joint_2, in rad/s as its header names no unit \
             (compared with the positions' derivatives, which are used)",
            "efforts, as forces at the joints: `tau_{}` from `tau_1` of joint_1 to `tau_2` of joint_2, in N*m as \
             its header names no unit",
            "not used: `temp_1`, `temp_2`",
        ];
        assert_eq!(said(header, ",1,2,3,4,5,6,7,8", None), expected);
    }

    /// A pattern with a number takes columns in the order of their numbers: where the rows name joints in another one, and
    /// where there are no headers, the columns are listed.
    #[test]
    fn patterns_name_the_columns_that_were_taken() {
        let listed =
            said("t,name0,name1,position0,position1,effort0,effort1\n", ",joint_2,joint_1,1,2,3,4", None);
        assert!(listed[1].contains("`position1|position0` from `position1` of joint_1"), "{listed:?}");
        let bare = said("", ",1,2,3,4", Some("time=1,position=2..3,torque=4|5"));
        assert!(bare[1].contains("`2|3` from number 2 of joint_1 to number 3 of joint_2"), "{bare:?}");
        // What is said can be given back.
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
            all[0].contains("column-doubtful]: the positions (`q_d{}`) are commanded by their names"),
            "{all:?}"
        );
        assert!(
            all[1].contains("the efforts (`tau_cmd{}`)") && all[1].ends_with("--columns 'torque=…'"),
            "{all:?}"
        );
        // Who names them knows.
        assert!(
            doubts("t,q_d1,q_d2,tau_cmd1,tau_cmd2\n", Some("position=q_d{},torque=tau_cmd{}")).is_empty()
        );
        assert!(doubts("t,q1,q2,tau1,tau2\n", None).is_empty());
        let both = read("t,q1,q2,tau1,tau2,q_d1,q_d2\n", ",1,2,3,4,5,6", None);
        assert!(both.columns.iter().any(|line| line.starts_with("commanded positions: `q_d{}`")));
        assert!(warnings(&both).is_empty());
    }

    #[test]
    fn units_of_times_are_known_or_doubted() {
        let minutes = read("Time [min],q1,q2,u1,u2\n", ",1,2,3,4", None);
        assert_eq!((minutes.runs[0].times[1], warnings(&minutes).len()), (600.0, 0));
        let ticks = read("Time [ticks],q1,q2,u1,u2\n", ",1,2,3,4", None);
        let said = warnings(&ticks);
        assert!(said[0].contains("`ticks`, which is no known unit"), "{said:?}");
        assert!(said[0].ends_with("--columns 'time=Time [ticks][0.001 s]'"), "{said:?}");
        let told = read("Time [ticks],q1,q2,u1,u2\n", ",1,2,3,4", Some("time=Time [ticks][0.001 s]"));
        assert_eq!((told.runs[0].times[1], warnings(&told).len()), (0.01, 0));
    }
}
