//! Detection of saturated efforts: for a part of the motion they are at an extreme value, which is a limit of a sensor, a
//! drive or a program.

use super::super::run::Run;
use super::levels;
use gelenk_findings::{Finding, Rule};

/// Sees: efforts that are at their largest or smallest value for a part of the motion.
/// Matters: a sensor or a drive was saturated, so that the model is wrong for these samples.
/// Example: a torque sensor with a range of ±6 N m.
/// Fixture: `efforts_that_are_cut_off_are_said_with_their_column_and_share` in `log/saturation.rs`.
const CUT_OFF: Rule = Rule::note("efforts-cut-off");

/// Returns findings about efforts that are cut off at a limit.
///
/// - `names`: names of the joints or inputs
/// - `columns`: headers of the columns of their efforts in the log
pub(super) fn cut_off(runs: &[Run], names: &[String], columns: &[String]) -> Vec<Finding> {
    let of = |(place, name): (usize, &String)| {
        let values: Vec<f64> = runs.iter().flat_map(|run| moving(run, place)).collect();
        let mut largest = values.clone();
        largest.sort_by(f64::total_cmp);
        let smallest: Vec<f64> = largest.iter().map(|x| -x).collect();
        largest.reverse();
        let ends = [("largest", crowd(&largest), 1.0), ("smallest", crowd(&smallest), -1.0)];
        let said = ends.into_iter().filter_map(|(end, found, sign)| {
            let (value, count) = found?;
            let share = 100.0 * count as f64 / values.len() as f64;
            Some(format!("at its {end} value of {} in {share:.1} %", sign * value))
        });
        let said: Vec<String> = said.collect();
        (!said.is_empty()).then(|| {
            let message = format!(
                "its effort (column {}) is {} of the samples in motion. Probably a limit of the sensor or the drive cuts it off, \
                 so the model is wrong for these samples",
                columns.get(place).map_or("unknown", String::as_str),
                said.join(" and ")
            );
            let remedy = "record a slower motion, or delete these efforts from the log";
            CUT_OFF.found(message).joint(name).help(remedy)
        })
    };
    names.iter().enumerate().filter_map(of).collect()
}

/// Returns the efforts of the samples to which a joint has moved. At rest, the same effort may last long.
fn moving(run: &Run, place: usize) -> Vec<f64> {
    let Some(efforts) = run.efforts.get(place) else { return Vec::new() };
    let moved = |i: &usize| run.positions.iter().any(|q| q[*i] != q[*i - 1]);
    (1..efforts.len()).filter(moved).map(|i| efforts[i]).filter(|x| x.is_finite()).collect()
}

/// Returns the first value of a sorted list and its count if the count is too high for an unlimited signal; otherwise
/// `None`. Zero does not count as a limit.
fn crowd(sorted: &[f64]) -> Option<(f64, usize)> {
    let value = *sorted.first().filter(|value| **value != 0.0)?;
    let count = sorted.iter().take_while(|x| **x == value).count();
    let next = *sorted.get(count)?;
    let beside = sorted[count..].iter().take_while(|x| **x == next).count();
    let is_seen = count as f64 >= levels::CUT_OFF_SHARE.get() * sorted.len() as f64;
    (is_seen && count >= levels::MORE_THAN_BESIDE.get() * beside).then_some((value, count))
}

#[cfg(test)]
mod tests {
    use super::super::super::numeric::random::SplitMix64;
    use super::super::super::run::Effort;
    use super::*;

    /// Returns a run with a noisy wave, which is cut off at `limit` and rounded to multiples of `step`.
    fn run(limit: f64, step: f64) -> Run {
        let mut random = SplitMix64::new(3);
        let times: Vec<f64> = (0..2000).map(|i| 0.01 * f64::from(i)).collect();
        let effort = |t: &f64| {
            let value = 10.0 * (1.3 * t).sin() + 3.0 * (3.1 * t).cos() + 0.1 * (2.0 * random.uniform() - 1.0);
            if step > 0.0 { (value.clamp(-6.0, limit) / step).round() * step } else { value.min(limit) }
        };
        Run {
            name: "log".into(),
            rows: (2..2002).collect(),
            positions: vec![times.iter().map(|t| t.sin()).collect()],
            poses: Vec::new(),
            velocities: vec![None],
            efforts: vec![times.iter().map(effort).collect()],
            effort: Effort::Joint,
            times,
        }
    }

    #[test]
    fn efforts_that_are_cut_off_are_said_with_their_column_and_share() {
        let said = |run: Run| {
            let found = cut_off(&[run], &["lift".into()], &["`tau2`".into()]);
            found.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        let one = said(run(6.0, 0.0));
        // It is unknown whether the first sample is in motion.
        let moving = run(6.0, 0.0).efforts[0].split_off(1);
        let share = 100.0 * moving.iter().filter(|x| **x == 6.0).count() as f64 / moving.len() as f64;
        assert!(
            one[0].starts_with("note[efforts-cut-off]")
                && one[0].contains(&format!("(column `tau2`) is at its largest value of 6 in {share:.1} %")),
            "{one:?}"
        );
        let both = said(run(6.0, 0.5));
        assert!(both[0].contains("of 6 in") && both[0].contains("smallest value of -6 in"), "{both:?}");
        // Neither an unlimited wave nor a wave with coarse steps is cut off.
        assert_eq!(said(run(f64::INFINITY, 0.0)), Vec::<String>::new());
        let mut coarse = run(f64::INFINITY, 0.0);
        coarse.efforts[0].iter_mut().for_each(|x| *x = x.round());
        assert_eq!(said(coarse), Vec::<String>::new());
    }
}
