//! Rules of findings about a log.

use gelenk_findings::Rule;

/// Sees: empty fields of a column, or rows that end before the column.
/// Matters: rows without a time, a position or an effort are not used.
/// Example: a row `0.02,0.1,` of `t,q1,u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
pub(super) const MISSING: Rule = Rule::note("missing-values");

/// Sees: text in a column of numbers.
/// Matters: the rows with this text are not used; a unit or a thousands separator may be the reason.
/// Example: `x` below `u1`.
/// Fixture: `incomplete_rows_are_left_out_by_number` in `log/tests/styles.rs`.
pub(super) const NOT_A_NUMBER: Rule = Rule::note("not-a-number");

/// Sees: rows and runs that are not used: incomplete rows, rows of zeros, rows with too many fields, runs of few samples.
/// Matters: the estimate uses the remaining samples.
/// Example: a driver writes 0 for all positions and efforts if a message was lost.
/// Fixture: `zero_rows` in `codegen/tests/findings/arm.rs`.
pub(super) const LEFT_OUT: Rule = Rule::note("rows-left-out");

/// Sees: consecutive samples with the same time.
/// Matters: only the first one is used.
/// Example: two rows at 0.01 s.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
pub(super) const REPEATED: Rule = Rule::note("repeated-times");

/// Sees: a time that is earlier than the time of the row before.
/// Matters: a new run begins at this row. Each run has its own offset of the efforts.
/// Example: two logs in one file.
/// Fixture: `times_cut_runs` in `log/tests/styles.rs`.
pub(super) const NEW_RUN: Rule = Rule::note("time-goes-back");

/// Sees: jumps of a position by a whole turn.
/// Matters: such jumps are not motion. They are removed.
/// Example: an encoder that counts from -π to π.
/// Fixture: `turns_are_unwrapped` in `log/tests/styles.rs`.
pub(super) const TURNS: Rule = Rule::note("turns");

/// Sees: times without a unit, or times with steps of exactly one second.
/// Matters: a wrong unit of the time makes every rate wrong.
/// Example: times with steps of 4, which are read as ms.
/// Fixture: `epoch_times_keep_their_digits` in `log/tests/styles.rs`.
pub(super) const UNIT_ASSUMED: Rule = Rule::note("unit-assumed");

/// Sees: single efforts far beyond all others.
/// Matters: these efforts are not used.
/// Example: a driver writes 999999 if it has no value.
/// Fixture: `spikes` in `codegen/tests/findings/arm.rs`.
pub(super) const OUTLIER: Rule = Rule::note("outliers");

/// Sees: a column of velocities that is not the derivative of the positions.
/// Matters: a sign, a unit or the order of columns may be wrong. The velocities themselves are not used.
/// Example: velocities in deg/s next to positions in rad.
/// Fixture: `joints_that_look_wrong_are_named` in `log/tests/styles.rs`.
pub(super) const VELOCITY_DISAGREES: Rule = Rule::note("velocity-disagrees");

/// Sees: efforts that are at their largest or smallest value for a part of the motion.
/// Matters: a sensor or a drive was saturated, so that the model is wrong for these samples.
/// Example: a torque sensor with a range of ±6 N m.
/// Fixture: `efforts_that_are_cut_off_are_said_with_their_column_and_share` in `log/saturation.rs`.
pub(super) const CUT_OFF: Rule = Rule::note("efforts-cut-off");

/// Sees: columns with names of commanded values if there are no measured values, or times in an unknown unit.
/// Matters: commanded values differ from measured ones by the control error.
/// Example: `q_d1` without a `q1`.
/// Fixture: `what_is_commanded_is_doubted_where_nothing_is_measured` in `log/tests/printed.rs`.
pub(super) const COLUMN_DOUBTFUL: Rule = Rule::warning("column-doubtful");

/// Sees: the columns that are used for each quantity, and the columns that are not used.
/// Matters: a wrong column makes a wrong estimate.
/// Example: the columns `q{}`, from `q1` of joint pan to `q3` of joint elbow, are the positions.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
pub(super) const COLUMNS: Rule = Rule::note("columns");
