//! Rules of findings about a log.

use gelenk_findings::Rule;

/// Sees: fields of a column that are empty, or rows that end before it.
/// Matters: rows without a time, a position or an effort are not used.
/// Example: a row `0.02,0.1,` of `t,q1,u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
pub(super) const MISSING: Rule = Rule::note("missing-values");

/// Sees: text in a column of numbers.
/// Matters: its rows are not used; a unit or a thousands separator may be the reason.
/// Example: `x` below `u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
pub(super) const NOT_A_NUMBER: Rule = Rule::note("not-a-number");

/// Sees: rows and runs that are not used: incomplete ones, rows of zeros, rows with a field too many, runs of few samples.
/// Matters: the estimate uses the remaining samples.
/// Example: a driver writes 0 for all positions and efforts where a message was lost.
/// Fixture: `zero_rows` in `codegen/tests/findings/arm.rs`.
pub(super) const LEFT_OUT: Rule = Rule::note("rows-left-out");

/// Sees: samples with the time of the one before.
/// Matters: one of them is left out.
/// Example: two rows at 0.01 s.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
pub(super) const REPEATED: Rule = Rule::note("repeated-times");

/// Sees: a time that is earlier than the one before.
/// Matters: a new run begins there, with an offset of its own.
/// Example: two logs in one file.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
pub(super) const NEW_RUN: Rule = Rule::note("time-goes-back");

/// Sees: jumps of a position by a whole turn.
/// Matters: such jumps are not motion. They are unwrapped.
/// Example: an encoder that counts from -π to π.
/// Fixture: `turns_are_unwrapped` in `log/tests/styles.rs`.
pub(super) const TURNS: Rule = Rule::note("turns");

/// Sees: times without a unit, or times that step by exactly one second.
/// Matters: a wrong unit of the time makes every rate wrong.
/// Example: times that step by 4, taken as ms.
/// Fixture: `epoch_times_keep_their_digits` in `log/tests/styles.rs`.
pub(super) const UNIT_ASSUMED: Rule = Rule::note("unit-assumed");

/// Sees: single efforts far beyond all others.
/// Matters: they are left out.
/// Example: 999999 where a driver has no value.
/// Fixture: `spikes` in `codegen/tests/findings/arm.rs`.
pub(super) const OUTLIER: Rule = Rule::note("outliers");

/// Sees: a column of velocities that is not the slope of the positions.
/// Matters: a sign, a unit or the order of columns may be wrong. The velocities themselves are not used.
/// Example: velocities in deg/s next to positions in rad.
/// Fixture: `joints_that_look_wrong_are_named` in `log/tests/styles.rs`.
pub(super) const VELOCITY_DISAGREES: Rule = Rule::note("velocity-disagrees");

/// Sees: efforts that are at their largest or smallest value for a part of the motion.
/// Matters: the model is wrong there: a sensor or a drive was saturated.
/// Example: a torque sensor that ends at 6 N m.
/// Fixture: `efforts_that_are_cut_off_are_said_with_their_column_and_share` in `log/saturation.rs`.
pub(super) const CUT_OFF: Rule = Rule::note("efforts-cut-off");

/// Sees: columns with names of commanded values if no measured ones are found, or a time in an unknown unit.
/// Matters: commanded values differ from measured ones by the control error.
/// Example: `q_d1` without a `q1`.
/// Fixture: `what_is_commanded_is_doubted_where_nothing_is_measured` in `log/tests/printed.rs`.
pub(super) const COLUMN_DOUBTFUL: Rule = Rule::warning("column-doubtful");

/// Sees: the columns that were taken for a quantity, and those that were not used.
/// Matters: a wrong column makes a wrong estimate.
/// Example: positions: `q{}` from `q1` of pan to `q3` of elbow.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
pub(super) const COLUMNS: Rule = Rule::note("columns");
