//! Choice of the model by the error on held-out data: widths of Coulomb friction, optional terms, offsets, and the weight of
//! the description.

use super::super::error::Result;
use super::super::inertial::PER_BODY;
use super::super::methods::subset::MOST_ALIKE;
use super::super::run::moved;
use super::fit::{HeldOut, Solved, Weighting, fit, held_out, reweighted};
use super::gains::{Gains, gains};
use super::joint_prior::JointPrior;
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, LOAD, Layout, VISCOUS};
use super::levels;
use super::normal::{Centred, Model, Values};
use super::prior::Prior;
use super::result::Offsets;
use super::sums::Sums;
use nalgebra::{DMatrix, DVector};

const WEIGHTS: usize = 23;

const LESS_TRUST_STEPS: usize = 2;

/// A chosen model, its weights, and the values that were fitted with them.
pub(super) struct Chosen<'a> {
    pub(super) model: Model,
    pub(super) weighting: Weighting,
    pub(super) values: Values,
    /// Covariance of the logarithms of the drives' gains.
    pub(super) log_gains: DMatrix<f64>,
    pub(super) centred: Centred<'a>,
}

/// Quantities that the choice may vary.
#[derive(Debug, Clone, Copy)]
pub(super) struct Freedom<'a> {
    pub(super) offsets: Option<Offsets>,
    pub(super) terms: bool,
    pub(super) consistent: bool,
    /// For each joint, whether load-dependent friction may be added.
    pub(super) loads: &'a [bool],
}

fn grid() -> impl Iterator<Item = f64> {
    (0..WEIGHTS).map(|i| levels::LEAST_WEIGHT.get() * 10_f64.powf(0.5 * i as f64))
}

/// Chooses the model in this order: widths and offsets, then optional terms, then the weight of the description. The
/// constraints of physically possible bodies hold only in the last fit, because they cost more time than all choices and
/// hardly change a choice.
///
/// # Errors
/// The errors are those of [`gains`] and of [`super::fit::fit`]: the equations have no solution, or the gains do not
/// converge.
pub(super) fn choose<'a>(
    layout: &'a Layout,
    sums: &'a Sums,
    prior: &Prior,
    freedom: Freedom<'_>,
) -> Result<Chosen<'a>> {
    let model = Model {
        coulomb: vec![0; layout.joints],
        asymmetry: vec![false; layout.joints],
        armature: vec![false; layout.joints],
        load: vec![false; layout.joints],
        offsets: freedom.offsets.unwrap_or(Offsets::Common),
        consistent: false,
    };
    let centred = Centred::new(layout, sums, model.offsets, vec![0.0; layout.joints]);
    let Gains { values, covariance: log_gains } = gains(&centred, prior)?;
    let start = Values { unknowns: DVector::zeros(layout.len()), gains: values };
    let weighting = Weighting {
        sigma: super::fit::deviations(&centred, &start),
        description: 1.0,
        trust: vec![1.0; layout.parameters],
    };
    let mut chosen = Chosen { model, weighting, values: start, log_gains, centred };
    chosen.reweight(prior)?;
    chosen.weigh_offsets(layout, sums, prior);
    chosen.choose_weight(prior, true)?;
    chosen.reweight(prior)?;
    chosen.choose_widths(prior)?;
    if sums.by_run(0, None).len() > 1 {
        chosen.choose_spreads(layout, sums, prior)?;
    }
    if freedom.offsets.is_none() {
        chosen.choose_offsets(layout, sums, prior)?;
    }
    let optional: &[usize] = if freedom.terms { &[ARMATURE, ASYMMETRY] } else { &[] };
    let under_load = (LOAD..layout.terms).collect::<Vec<_>>();
    chosen.choose_terms(prior, &[&under_load, optional].concat(), freedom.loads)?;
    chosen.reweight(prior)?;
    chosen.choose_weight(prior, false)?;
    chosen.choose_trust(prior)?;
    chosen.model.consistent = freedom.consistent;
    chosen.reweight(prior)?;
    Ok(chosen)
}

impl Chosen<'_> {
    fn error(&self, model: &Model, prior: &Prior) -> Result<HeldOut> {
        held_out(&self.centred, model, prior, &self.weighting, &self.values)
    }

    pub(super) fn held_out(&self, prior: &Prior) -> Result<HeldOut> {
        self.error(&self.model, prior)
    }

    /// The fit of the choice to all data.
    pub(super) fn solved(&self, prior: &Prior) -> Result<Solved> {
        fit(&self.centred, &self.centred.all, &self.model, prior, &self.weighting, &self.values)
    }

    pub(super) fn reweight(&mut self, prior: &Prior) -> Result<()> {
        let solved = reweighted(&self.centred, &self.model, prior, &mut self.weighting, &self.values)?;
        self.values = solved.values;
        Ok(())
    }

    /// Chooses the weight λ of the distance from the description. If `least` is set, λ is the weight with the least held-out
    /// error. Otherwise λ is the largest weight whose error exceeds the least error by at most one standard error.
    pub(super) fn choose_weight(&mut self, prior: &Prior, least: bool) -> Result<()> {
        let mut errors = Vec::with_capacity(WEIGHTS);
        for description in grid() {
            let weighting = Weighting { description, ..self.weighting.clone() };
            errors.push(held_out(&self.centred, &self.model, prior, &weighting, &self.values)?);
        }
        let best = (0..WEIGHTS).fold(0, |b, i| if errors[i].total() < errors[b].total() { i } else { b });
        let near = |i: &usize| {
            let (excess, error) = errors[*i].excess_of_choice(&errors[best]);
            excess <= error
        };
        let index = if least { best } else { (best..WEIGHTS).take_while(near).last().unwrap_or(best) };
        self.weighting.description = grid().nth(index).unwrap_or(1.0);
        Ok(())
    }

    /// Reduces the weight of a described body if this lowers the held-out error by more than one standard error. Such bodies
    /// are dummy bodies of exporters and links with tools that the description omits.
    pub(super) fn choose_trust(&mut self, prior: &Prior) -> Result<()> {
        let mut best = self.held_out(prior)?;
        for body in &prior.bodies {
            for _ in 0..LESS_TRUST_STEPS {
                let mut weighting = self.weighting.clone();
                weighting.trust[body * PER_BODY..(body + 1) * PER_BODY]
                    .iter_mut()
                    .for_each(|t| *t *= levels::LESS_TRUST.get());
                let error = held_out(&self.centred, &self.model, prior, &weighting, &self.values)?;
                let (excess, deviation) = error.excess_of_choice(&best);
                if excess >= -deviation {
                    break;
                }
                (best, self.weighting) = (error, weighting);
            }
        }
        Ok(())
    }

    /// Chooses the width of each joint's Coulomb term. The default is the steepest term, because friction changes its sign at
    /// zero velocity. A wider term replaces it if this lowers the held-out error by more than one standard error.
    fn choose_widths(&mut self, prior: &Prior) -> Result<()> {
        let mut best = self.held_out(prior)?;
        for joint in self.centred.layout.rubbing() {
            for width in 1..COULOMB.len() {
                let mut model = self.model.clone();
                model.coulomb[joint] = width;
                let error = self.error(&model, prior)?;
                let (excess, deviation) = error.excess_of_choice(&best);
                if excess < -deviation {
                    (best, self.model) = (error, model);
                }
            }
        }
        Ok(())
    }

    /// Adds a term to a joint if it lowers the held-out error by more than one standard error.
    fn choose_terms(&mut self, prior: &Prior, terms: &[usize], loads: &[bool]) -> Result<()> {
        let mut best = self.held_out(prior)?;
        for joint in self.centred.layout.rubbing() {
            for term in terms {
                let mut model = self.model.clone();
                let (possible, chosen) = match *term {
                    LOAD => (loads[joint], &mut model.load),
                    ASYMMETRY => (self.both_directions(joint), &mut model.asymmetry),
                    _ => (self.centred.layout.takes_inertia[joint], &mut model.armature),
                };
                if !possible {
                    continue;
                }
                chosen[joint] = true;
                let error = self.error(&model, prior)?;
                let (excess, deviation) = error.excess_of_choice(&best);
                if excess < -deviation && self.can_exist(&model, joint, prior)? {
                    (best, self.model) = (error, model);
                }
            }
        }
        Ok(())
    }

    /// Whether the joint moves enough in both directions to separate the terms v and |v|.
    fn both_directions(&self, joint: usize) -> bool {
        let first = self.centred.layout.first_term(joint);
        let place = |term: usize| first + term;
        let products = self.centred.sums.products(joint, None);
        let entry = |a: usize, b: usize| products[(place(a), place(b))];
        let cosine =
            entry(VISCOUS, ASYMMETRY) / (entry(VISCOUS, VISCOUS) * entry(ASYMMETRY, ASYMMETRY)).sqrt();
        cosine.abs() < MOST_ALIKE
    }

    /// Whether the reflected inertia of the fitted model is positive and the coefficient of load-dependent friction lies
    /// between 0 and 1. Friction that lags behind the speed would make the estimated inertia negative, which is impossible.
    fn can_exist(&self, model: &Model, joint: usize, prior: &Prior) -> Result<bool> {
        let all = &self.centred.all;
        let solved = fit(&self.centred, all, model, prior, &self.weighting, &self.values)?;
        let value = |term: usize| solved.values.unknowns[self.centred.layout.term(joint, term)];
        let has_inertia = !model.armature[joint] || value(ARMATURE) > 0.0;
        let has_share = !model.load[joint] || (value(LOAD) > 0.0 && value(LOAD) < 1.0);
        Ok(has_inertia && has_share)
    }
}

impl<'a> Chosen<'a> {
    /// The same choice of the model, fitted to other sums with new weights.
    pub(super) fn with_sums<'b>(&self, sums: &'b Sums, prior: &Prior) -> Result<Chosen<'b>>
    where
        'a: 'b,
    {
        let mut other = self.over(sums);
        other.reweight(prior)?;
        Ok(other)
    }

    /// The same choice and weights for other sums, not fitted yet.
    pub(super) fn over<'b>(&self, sums: &'b Sums) -> Chosen<'b>
    where
        'a: 'b,
    {
        self.with_more(self.centred.layout, sums, 1.0)
    }

    /// The same choice with more inertial parameters, not fitted yet.
    ///
    /// - `trust`: factor of the weight that holds each additional parameter at zero
    pub(super) fn with_more<'b>(&self, layout: &'b Layout, sums: &'b Sums, trust: f64) -> Chosen<'b> {
        let mut weighting = self.weighting.clone();
        weighting.trust.resize(layout.parameters, trust);
        Chosen {
            model: self.model.clone(),
            weighting,
            values: Values { unknowns: DVector::zeros(layout.len()), gains: self.values.gains.clone() },
            log_gains: self.log_gains.clone(),
            centred: Centred::new(layout, sums, self.model.offsets, self.centred.zeros.clone()),
        }
    }

    /// Sets the weight of the prior of each offset, from the standard deviations of the offset and of the residuals.
    fn weigh_offsets(&mut self, layout: &'a Layout, sums: &'a Sums, prior: &Prior) {
        let deviations = self.weighting.sigma.iter().zip(&self.values.gains).map(|(s, gain)| s * gain);
        let zeros = prior.joints.iter().zip(deviations).map(|(joint, s)| joint.samples_of_offset(s));
        let mut zeros: Vec<f64> = zeros.collect();
        zeros.resize(layout.joints, 0.0);
        self.centred = Centred::new(layout, sums, self.model.offsets, zeros);
    }

    /// Allows a joint a larger standard deviation of its offsets if this lowers the held-out error by more than one standard
    /// error. Several runs are necessary, because in a part of a single run in which the joint moves in one direction, an
    /// offset cannot be distinguished from friction.
    fn choose_spreads(&mut self, layout: &'a Layout, sums: &'a Sums, prior: &Prior) -> Result<()> {
        let mut best = self.held_out(prior)?;
        for joint in layout.rubbing() {
            let mut zeros = self.centred.zeros.clone();
            zeros[joint] = JointPrior::fewer(zeros[joint]);
            let centred = Centred::new(layout, sums, self.model.offsets, zeros);
            let error = held_out(&centred, &self.model, prior, &self.weighting, &self.values)?;
            let (excess, deviation) = error.excess(&best);
            if excess < -deviation {
                (best, self.centred) = (error, centred);
            }
        }
        Ok(())
    }

    /// Chooses an offset for each run if there are several runs and this lowers the held-out error by more than one standard
    /// error.
    fn choose_offsets(&mut self, layout: &'a Layout, sums: &'a Sums, prior: &Prior) -> Result<()> {
        if sums.by_run(0, None).len() < 2 {
            return Ok(());
        }
        let common = self.held_out(prior)?;
        let centred = Centred::new(layout, sums, Offsets::ByRun, self.centred.zeros.clone());
        let by_run = held_out(&centred, &self.model, prior, &self.weighting, &self.values)?;
        let (excess, deviation) = by_run.excess_of_choice(&common);
        if excess < -deviation {
            self.centred = centred;
            self.model.offsets = Offsets::ByRun;
        }
        Ok(())
    }
}

impl Chosen<'_> {
    /// Moves friction, offsets and weights with the columns of the joints: joint j has the columns of joint `order[j]`.
    pub(super) fn reorder(&mut self, order: &[usize]) {
        let model = &mut self.model;
        model.coulomb = moved(order, &model.coulomb);
        for of_joints in [&mut model.asymmetry, &mut model.armature, &mut model.load] {
            *of_joints = moved(order, of_joints);
        }
        self.weighting.sigma = moved(order, &self.weighting.sigma);
        let zeros = moved(order, &self.centred.zeros);
        self.centred = Centred::new(self.centred.layout, self.centred.sums, self.model.offsets, zeros);
    }
}
