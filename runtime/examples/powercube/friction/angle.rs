//! Claim 6: an error of gravity makes identified friction seem to depend on the angle. Two methods avoid this effect.

use super::data::{
    MEASURED, REPEAT, Samples, alpha, beta_alone, controller_arm, friction_samples, gamma_alone, opposed,
    periodic, published_arm, record, rms,
};
use super::law::{Method, curve, curve_error, true_curve};
use crate::arm::{Friction, heavier};
use crate::study::{Outcome, Part, Study};
use gelenk_identification::excitation::FourierMotion;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::Samples as Columns;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};

/// Relative error of gravity in the model for the identification.
pub const GRAVITY_ERROR: f64 = 0.08;
/// Largest angle of the selected samples [rad].
pub const NARROW: f64 = 0.1;
/// Largest dependence of the torque on the angle that is hidden by noise of 0.3 N m [N m].
const UNSEEN: f64 = 0.2;
/// Length of the link between the axes [m].
const LINK: f64 = 0.18;

/// Friction samples of β and γ along a motion, computed with a relative error of gravity.
pub fn arm_samples(motion: &FourierMotion, gravity_error: f64, seconds: f64) -> Outcome<[Samples; 2]> {
    let log = record(published_arm(), &controller_arm(), motion, seconds, (&MEASURED, 2))?;
    let model = heavier(published_arm(), gravity_error);
    friction_samples(&log, &model, MEASURED.encoder_step)
}

/// Friction samples of α along its motion.
pub fn alpha_samples(seconds: f64) -> Outcome<Samples> {
    let log = record(alpha(Friction::A), &alpha(Friction::OLD), &periodic([1.0]), seconds, (&MEASURED, 3))?;
    let [samples] = friction_samples(&log, &alpha(Friction::OLD), MEASURED.encoder_step)?;
    Ok(samples)
}

/// Dependence of the torque on the angle in addition to the speed [N m]. It is the rms of the part `c sin y` in the least-squares
/// fit `τ = Σ a_i θ_i(v) + c sin y`.
pub fn dependence(samples: &Samples) -> Outcome<f64> {
    let library = Library::new(&["v", "tanh(10*v)", "tanh(100*v)", "sin(y)"], &["v", "y"])?;
    let channels: Vec<&[f64]> = vec![&samples.velocities, &samples.angles];
    let columns = Columns::from_library(&library, channels, vec![&samples.torques])?;
    let fit = Reduced::new(&columns)?.fit(0, &[0, 1, 2, 3])?;
    let sines = samples.angles.iter().map(|y| y.sin());
    Ok(fit.coefficients[3].abs() * rms(sines))
}

/// Claim 6a for motions of β alone and of γ alone.
pub fn seeming_claim([beta, gamma]: [&Samples; 2]) -> Outcome<Claim> {
    Ok(Claim::new("claim-6a", "With gravity 8 % wrong the friction of β and γ seems to depend on the angle.")
        .criterion(Criterion::at_least(
            "torque that depends on the angle, β, rms",
            dependence(beta)?,
            0.5,
            "N m",
        ))
        .criterion(Criterion::at_least("the same, γ", dependence(gamma)?, 0.25, "N m"))
        .flipped_by("the right gravity in the identifying model")
        .shown_in("by-angle"))
}

/// Claim 6b for a motion of β alone, with the samples for which |β| < `narrow`.
pub fn selection_claim(beta: &Samples, narrow: f64) -> Outcome<Claim> {
    let kept = beta.select(|angle, _| angle.abs() < narrow);
    let share = kept.len() as f64 / beta.len() as f64;
    Ok(Claim::new("claim-6b", "Keeping only |β| < 0.1 removes the dependence, at the price of data.")
        .criterion(Criterion::at_most(
            "torque that depends on the angle, β, rms",
            dependence(&kept)?,
            UNSEEN,
            "N m",
        ))
        .criterion(Criterion::at_most("share of the data kept", share, 0.35, ""))
        .flipped_by("keeping |β| < 0.8: the dependence is back")
        .shown_in("by-angle"))
}

/// Claim 6c for γ while β moves too.
pub fn opposed_claim(gamma: &Samples) -> Outcome<Claim> {
    Ok(Claim::new(
        "claim-6c",
        "Moving β = −γ removes it for γ without losing data.",
    )
    .criterion(Criterion::at_most(
        "torque that depends on the angle, γ, rms, all data kept",
        dependence(gamma)?,
        UNSEEN,
        "N m",
    ))
    .flipped_by("moving β = γ, or γ alone: what lies beyond γ then leans")
    .remark("With β + γ = 0 what γ carries stays upright, so that an error of gravity makes no torque about its axis. β still carries the arm.")
    .shown_in("by-angle"))
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let seconds = study.pick(60.0, REPEAT);
    let [beta, _] = arm_samples(&beta_alone(), GRAVITY_ERROR, seconds)?;
    let [_, gamma] = arm_samples(&gamma_alone(), GRAVITY_ERROR, seconds)?;
    let [_, free] = arm_samples(&opposed(), GRAVITY_ERROR, seconds)?;
    let a = alpha_samples(seconds)?;
    let narrow = beta.select(|angle, _| angle.abs() < NARROW);
    let cases = [
        ("A (α), no gravity", &a, Friction::A),
        ("B (β), all data", &beta, Friction::B),
        ("B (β), |β| < 0.1", &narrow, Friction::B),
        ("C (γ), γ alone", &gamma, Friction::C),
        ("C (γ), β = −γ", &free, Friction::C),
    ];
    let mut figure = Figure::new(
        "characteristics",
        "Friction torque over velocity from the simulated records, gravity of the identifying model 8 % too large: samples by angle, the \
         law that SINDy (LASSO) fits to all of them, and the plant's own law.",
    );
    let mut table = Table::new(
        "characteristics-errors",
        "What the angle does to each set of data, and what becomes of the identified law.",
    )
    .column("joint, data", "data", "")
    .column("samples", "samples", "")
    .column("depends on the angle, rms", "dependence", "N m")
    .column("error of the law, rms", "law_error", "N m");
    let mut by_angle = Figure::new(
        "by-angle",
        "What the identified laws leave of the same samples, over the angle of the joint.",
    );
    for (name, samples, truth) in cases {
        let law = Method::Lasso.identify(samples)?.result.law;
        let fastest = samples.fastest();
        figure = figure.plot(characteristic(name, samples, curve(&law, fastest)?, &truth));
        by_angle = by_angle.plot(left_over(name, samples, &law.torques(&samples.velocities)?));
        table = table.row([
            Cell::text(name),
            Cell::Count(samples.len()),
            Cell::number(dependence(samples)?),
            Cell::number(curve_error(&law, |v| truth.at(v), fastest)?),
        ]);
    }
    let section = Section::new("angle", "Friction that seems to depend on the angle")
        .block(text(
            "The identifying model has the plant's masses, but a gravity that is 8 % too large. What it calls friction then holds \
             $0.08 \\, q_g(y)$, up to 1.8 N m at β.",
        ))
        .block(Block::Figure(frames()))
        .block(Block::Figure(figure))
        .block(Block::Figure(by_angle))
        .block(Block::Table(table));
    let claims =
        vec![seeming_claim([&beta, &gamma])?, selection_claim(&beta, NARROW)?, opposed_claim(&free)?];
    Ok(Part { section, claims })
}

type Condition = fn(f64) -> bool;

fn characteristic(name: &str, samples: &Samples, law: Vec<[f64; 2]>, truth: &Friction) -> Plot {
    let groups: [(&str, Condition); 3] = [
        ("angle below −0.1", |y| y <= -NARROW),
        ("|angle| < 0.1", |y| y.abs() < NARROW),
        ("angle above 0.1", |y| y >= NARROW),
    ];
    let mut plot = Plot::new(
        name,
        Axis::new("velocity", "rad/s").over(-0.55, 0.55),
        Axis::new("friction torque", "N m").over(-65.0, 65.0),
    );
    for (group, holds) in groups {
        let points = samples.select(|y, _| holds(y)).points(400);
        if !points.is_empty() {
            plot = plot.series(group, Marks::Points, points);
        }
    }
    plot.series("identified", Marks::Line, law).series(
        "plant",
        Marks::Dashed,
        true_curve(|v| truth.at(v), samples.fastest()),
    )
}

fn left_over(name: &str, samples: &Samples, law: &[f64]) -> Plot {
    let shown = samples.len().div_ceil(800).max(1);
    let points = (0..samples.len()).step_by(shown);
    let points = points.map(|i| [samples.angles[i], samples.torques[i] - law[i]]);
    Plot::new(
        name,
        Axis::new("angle", "rad").over(-0.9, 0.9),
        Axis::new("sample minus law", "N m").over(-3.5, 3.5),
    )
    .series("samples", Marks::Points, points.collect())
}

/// Figure of the arm along its periodic motions, with links as lines.
fn frames() -> Figure {
    let motions = [("β alone", beta_alone()), ("γ alone", gamma_alone()), ("β = −γ", opposed())];
    let mut figure = Figure::new(
        "frames",
        "The arm along a cycle of 10 s of its periodic motions, every 1.67 s: link between β and γ, and what γ carries up to the tool.",
    );
    for (name, motion) in motions {
        let mut plot = Plot::new(
            name,
            Axis::new("x", "m").over(-0.84, 0.84),
            Axis::new("height above β", "m").over(-0.1, 0.9),
        );
        for k in 0..6 {
            let time = f64::from(k) / 0.6;
            let [angles, ..] = motion.instant(time);
            plot = plot.series(format!("{time:.1} s"), Marks::Line, links(angles[0], angles[1]));
        }
        figure = figure.plot(plot);
    }
    figure
}

/// Positions of base, elbow and tool in the plane of motion. At y = 0 the arm is upright.
fn links(beta: f64, gamma: f64) -> Vec<[f64; 2]> {
    let elbow = [LINK * beta.sin(), LINK * beta.cos()];
    let ([x, _, z], _) = gelenk_generated::powercube::frame_tool_pose(&[beta, gamma]);
    vec![[0.0, 0.0], elbow, [x, z]]
}
