//! The equations of all joints, evaluated block by block along the runs.

use super::super::numeric::kernel::BLOCK;
use super::super::preparation::Filter;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, LOAD, Layout, VISCOUS};
use super::loads::Loads;
use super::result::Gravity;
use std::ops::Range;

/// A function of the positions y that writes a change of the regressor into its second argument. In each row the columns of
/// the robot's parameters come first, then additional columns.
pub(super) type More<'a> = &'a dyn Fn(&[f64], &mut [f64]);

/// Evaluates the columns of up to [`BLOCK`] samples. Only one block is stored. The columns of joints whose force was not
/// measured are zero.
pub(super) struct Rows<'a> {
    robot: &'a dyn Robot,
    layout: &'a Layout,
    described: Vec<f64>,
    gravity: Gravity,
    filter: Option<&'a Filter>,
    loads: Option<&'a Loads>,
    /// Rates of the efforts without noise from a first fit; `None` if there is no first fit.
    rates: Option<&'a [Vec<Vec<f64>>]>,
    more: Option<More<'a>>,
    /// Magnitude |τ_l| of the load of each joint's gear at the last evaluated sample.
    load: Vec<f64>,
    regressor: Vec<f64>,
    at_rest: Vec<f64>,
    /// Entries of the regressor that a hypothesis adds at the last evaluated sample; empty if there is no
    /// such hypothesis.
    added: Vec<f64>,
    /// Columns of each joint. The distance between two columns is [`BLOCK`].
    columns: Vec<Vec<f64>>,
    /// Weight of each sample for each joint: 0 at rest, otherwise 1.
    moving: Vec<Vec<f64>>,
    count: usize,
}

impl<'a> Rows<'a> {
    pub(super) fn new(
        robot: &'a dyn Robot,
        layout: &'a Layout,
        gravity: Gravity,
        filter: Option<&'a Filter>,
        loads: Option<&'a Loads>,
    ) -> Self {
        let described = robot.parameters();
        let size = layout.joints * described.len();
        Self {
            robot,
            layout,
            described,
            gravity,
            filter,
            loads,
            rates: None,
            more: None,
            load: vec![0.0; layout.joints],
            regressor: vec![0.0; size],
            at_rest: vec![0.0; size],
            added: Vec::new(),
            columns: (0..layout.joints).map(|j| vec![0.0; layout.width(j) * BLOCK]).collect(),
            moving: vec![Vec::new(); layout.joints],
            count: 0,
        }
    }

    /// Sets the rates of the efforts that a first fit has predicted.
    pub(super) fn with_rates(self, rates: Option<&'a [Vec<Vec<f64>>]>) -> Self {
        Self { rates, ..self }
    }

    /// Sets the change of the regressor that belongs to a hypothesis.
    pub(super) fn with_more(self, more: Option<More<'a>>) -> Self {
        let added = vec![0.0; more.map_or(0, |_| self.layout.joints * self.layout.parameters)];
        Self { more, added, ..self }
    }

    /// For each sample of the last evaluated block, 0 if the joint rests, otherwise 1.
    pub(super) fn moving(&self, joint: usize) -> &[f64] {
        &self.moving[joint]
    }

    /// Columns of a joint at the samples of the last evaluated block.
    pub(super) fn joint(&self, joint: usize) -> Vec<&[f64]> {
        let columns = self.columns[joint].chunks_exact(BLOCK);
        columns.map(|column| &column[..self.count]).collect()
    }

    /// Evaluates the samples `rows` of the run with the index `number`, at most [`BLOCK`] samples.
    pub(super) fn evaluate(&mut self, (number, run): (usize, &PreparedRun), rows: Range<usize>) {
        let n = self.layout.joints;
        self.count = rows.len();
        let mut rigid = vec![0.0; n];
        self.friction(run, &rows);
        for (joint, moving) in self.moving.iter_mut().enumerate() {
            let rests = |sample: usize| self.layout.moves[joint] && run.rests(joint, sample);
            *moving = rows.clone().map(|sample| if rests(sample) { 0.0 } else { 1.0 }).collect();
        }
        for (place, sample) in rows.enumerate() {
            let [y, v, a] = run.state(sample);
            self.rigid_body(&y, &v, &a, &mut rigid);
            for j in (0..n).filter(|&j| self.layout.measured[j]) {
                self.write(
                    j,
                    place,
                    [v[j], a[j]],
                    [rigid[j], run.force(&self.layout.input_matrix, j, sample)],
                );
                self.write_delays(number, run, j, [place, sample]);
            }
        }
    }

    /// Computes the regressor W and the described rigid-body force. If the robot compensates gravity, the force does not
    /// contain gravity. W does not contain gravity either, unless the robot compensates the described bodies only. In this
    /// case the efforts contain the weight of the differences from these bodies.
    fn rigid_body(&mut self, y: &[f64], v: &[f64], a: &[f64], rigid: &mut [f64]) {
        self.regressor.fill(0.0);
        self.robot.inertial_regressor(y, v, a, &mut self.regressor);
        self.robot.rigid_forces(y, v, a, rigid);
        self.load(a, rigid);
        self.compensate(y, v, rigid);
        let Some(more) = self.more else { return };
        self.added.fill(0.0);
        more(y, &mut self.added);
        let rows = self.added.chunks_exact(self.layout.parameters.max(1));
        for (force, row) in rigid.iter_mut().zip(rows) {
            *force += row.iter().zip(&self.described).map(|(w, pi)| w * pi).sum::<f64>();
        }
    }

    fn compensate(&mut self, y: &[f64], v: &[f64], rigid: &mut [f64]) {
        if self.gravity == Gravity::Recorded {
            return;
        }
        let zero = vec![0.0; v.len()];
        self.at_rest.fill(0.0);
        self.robot.inertial_regressor(y, &zero, &zero, &mut self.at_rest);
        let p = self.described.len();
        for (joint, force) in rigid.iter_mut().enumerate() {
            for i in 0..p {
                let gravity = self.at_rest[joint * p + i];
                if self.gravity == Gravity::Compensated {
                    self.regressor[joint * p + i] -= gravity;
                }
                *force -= gravity * self.described[i];
            }
        }
    }

    /// Computes the loads of the gears. The loads include the weight, even if the robot compensates it.
    fn load(&mut self, a: &[f64], rigid: &[f64]) {
        let Some(loads) = self.loads else { return };
        let rows = self.regressor.chunks_exact(self.described.len().max(1));
        for (joint, row) in rows.enumerate().filter(|(joint, _)| loads.joints[*joint]) {
            self.load[joint] = loads.magnitude(joint, rigid[joint], row, a[joint]);
        }
    }

    /// Computes the columns of friction that are not multiples of v. The columns pass the filter if there is one.
    fn friction(&mut self, run: &PreparedRun, rows: &Range<usize>) {
        let layout = self.layout;
        let half = self.filter.map_or(0, Filter::half_length);
        for joint in (0..layout.joints).filter(|&j| layout.measured[j]) {
            let velocities = &run.velocities[joint];
            let around = rows.start.saturating_sub(half)..(rows.end + half).min(velocities.len());
            let inner = rows.start - around.start..rows.end - around.start;
            let first = layout.first_term(joint);
            let mut set = |term: usize, of: &dyn Fn(f64) -> f64| {
                let sharp: Vec<f64> = velocities[around.clone()].iter().map(|v| of(*v)).collect();
                let values = match self.filter {
                    Some(filter) => filter.apply_at(&sharp, inner.clone()),
                    None => sharp,
                };
                let start = (first + term) * BLOCK;
                self.columns[joint][start..start + values.len()].copy_from_slice(&values);
            };
            for (term, steepness) in COULOMB.zip(&layout.steepness[joint]) {
                set(term, &|v| (steepness * v).tanh());
            }
            set(ASYMMETRY, &f64::abs);
        }
    }

    fn write(&mut self, joint: usize, place: usize, [v, a]: [f64; 2], last: [f64; 2]) {
        let own = &self.regressor[joint * self.described.len()..][..self.described.len()];
        let added = self.added.get(joint * self.layout.parameters..).unwrap_or_default();
        let entry = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
        let local = &self.layout.local[joint];
        let parameters = self.layout.first_term(joint);
        let column = &mut self.columns[joint];
        for (k, &i) in local[..parameters].iter().enumerate() {
            column[k * BLOCK + place] = entry(own, i) + entry(added, i);
        }
        let direction = column[(parameters + COULOMB.start) * BLOCK + place];
        let mut set = |term: usize, value: f64| column[(parameters + term) * BLOCK + place] = value;
        set(VISCOUS, v);
        set(ARMATURE, a);
        if self.loads.is_some() {
            // Loads change little within the length of the filter. The filter rounds only the jump of the direction.
            set(LOAD, self.load[joint] * direction);
        }
        let behind = self.layout.terms + self.layout.delays_of[joint].len();
        set(behind, last[0]);
        set(behind + 1, last[1]);
    }

    /// Writes the columns of the delays. An effort z that is late by a time δ is `z(t + δ) ≈ z + δ ż` at the
    /// time of the motion, so the column of δ is −ż.
    fn write_delays(&mut self, number: usize, run: &PreparedRun, joint: usize, [place, sample]: [usize; 2]) {
        let layout = self.layout;
        let first = layout.first_term(joint) + layout.terms;
        for (k, delay) in layout.delays_of[joint].iter().enumerate() {
            let acting = layout.acting(joint).filter(|(effort, _)| layout.delays[*effort] == *delay);
            let measured = || acting.map(|(effort, factor)| factor * run.effort_rate(effort, sample)).sum();
            let of_joint = self.rates.map(|rates| &rates[number][joint]);
            let rate: f64 =
                of_joint.filter(|rates| !rates.is_empty()).map_or_else(measured, |rates| rates[sample]);
            self.columns[joint][(first + k) * BLOCK + place] = -rate;
        }
    }
}
