//! Claim 5: differences of encoder readings are coarse velocities. Total-variation regularization gives better velocities with a
//! limited bandwidth.

use super::data::{MEASURED, beta_alone, controller_arm, published_arm, record, rms};
use crate::arm::{PERIOD, Regime};
use crate::methods::central_differences;
use crate::methods::random::SplitMix64;
use crate::study::{Outcome, Part, Study};
use gelenk_identification::methods::differentiation::{Regularization, TotalVariation, quantization_noise};
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};
use std::f64::consts::TAU;

/// Share of the samples at both ends that is not compared.
const MARGIN: f64 = 0.05;
/// Amplitude of the sine for the measurement of the gain [rad]. It is small compared with the motion.
const PROBE: f64 = 1e-3;
/// Highest frequency of the motion (Hz).
const MOTION_TOP: f64 = 11.0 / 30.0;
/// A frequency far above the motion (Hz).
const BEYOND: f64 = 10.0;

/// Derivatives by both methods, and the reference derivative.
pub struct Comparison {
    pub times: Vec<f64>,
    pub reference: Vec<f64>,
    pub differences: Vec<f64>,
    pub smoothed: Vec<f64>,
}

impl Comparison {
    /// Root mean square errors of differences and of the regularized derivative.
    pub fn errors(&self) -> [f64; 2] {
        [&self.differences, &self.smoothed].map(|estimate| {
            let margin = (MARGIN * self.times.len() as f64) as usize;
            let rows = margin..self.times.len() - margin;
            rms(rows.map(|i| estimate[i] - self.reference[i]))
        })
    }

    /// Ratio of the error of the differences to that of the regularized derivative.
    pub fn gain(&self) -> f64 {
        let [differences, smoothed] = self.errors();
        differences / smoothed
    }

    fn window(&self, column: &[f64], [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
        let all = self.times.iter().zip(column).map(|(t, x)| [*t, *x]);
        all.filter(|[t, _]| (from..=to).contains(t)).collect()
    }

    /// Plot of the derivatives.
    ///
    /// - `marks`: style of the differences. With steps, each difference is drawn over the period of which it is the mean.
    fn plot(&self, title: &str, y: Axis, window: [f64; 2], marks: Marks) -> Plot {
        let early = if marks == Marks::Steps { 0.5 * PERIOD } else { 0.0 };
        let differences = self.window(&self.differences, window);
        let differences = differences.into_iter().map(|[t, x]| [t - early, x]).collect();
        Plot::new(title, Axis::new("time", "s"), y)
            .series("differences", marks, differences)
            .series("TVDiff", Marks::Line, self.window(&self.smoothed, window))
            .series("reference", Marks::Dashed, self.window(&self.reference, window))
    }
}

/// Compares the velocity of β from encoders with the resolution `step` [rad] with the true velocity of the plant.
pub fn measured_like(step: f64, seconds: f64) -> Outcome<Comparison> {
    let regime = Regime { encoder_step: step, ..MEASURED };
    let log = record(published_arm(), &controller_arm(), &beta_alone(), seconds, (&regime, 1))?;
    let [beta, _] = &log.positions;
    let smooth = TotalVariation::from_noise(quantization_noise(step)).differentiate(&log.times, beta)?;
    let differences = beta.windows(2).map(|y| (y[1] - y[0]) / PERIOD);
    let [reference, _] = &log.velocities;
    // A difference is the mean velocity of its period, so all velocities are compared in the middle of the periods.
    let middle = |column: &[f64]| column.windows(2).map(|x| 0.5 * (x[0] + x[1])).collect();
    Ok(Comparison {
        times: middle(&log.times),
        reference: middle(reference),
        differences: differences.collect(),
        smoothed: middle(&smooth.first),
    })
}

/// Two sines of 0.3 and 0.8 Hz [rad], and their first and second derivatives.
fn analytic(t: f64) -> [f64; 3] {
    [(0.5, 0.3 * TAU), (0.1, 0.8 * TAU)].iter().fold([0.0; 3], |[s, v, a], (size, rate)| {
        let (sin, cos) = (rate * t).sin_cos();
        [s + size * sin, v + size * rate * cos, a - size * rate * rate * sin]
    })
}

/// First and second derivative of an analytic signal with normal noise [rad].
pub fn synthetic(noise: f64, seconds: f64) -> Outcome<[Comparison; 2]> {
    let mut random = SplitMix64::new(5);
    let times: Vec<f64> = (0..(seconds / PERIOD) as usize).map(|k| PERIOD * k as f64).collect();
    let truth: Vec<[f64; 3]> = times.iter().map(|t| analytic(*t)).collect();
    let signal: Vec<f64> = truth.iter().map(|[s, _, _]| s + noise * random.normal()).collect();
    let smooth = TotalVariation::from_noise(noise).differentiate(&times, &signal)?;
    let first = central_differences(&times, &signal);
    let inner = signal.windows(3).map(|s| (s[2] - 2.0 * s[1] + s[0]) / (PERIOD * PERIOD));
    let second = std::iter::once(0.0).chain(inner).chain(std::iter::once(0.0));
    let column = |k: usize| truth.iter().map(|all| all[k]).collect::<Vec<_>>();
    Ok([
        Comparison { times: times.clone(), reference: column(1), differences: first, smoothed: smooth.first },
        Comparison { times, reference: column(2), differences: second.collect(), smoothed: smooth.second },
    ])
}

/// TVDiff with the weight that suits the encoders along the motion of β, multiplied by `factor`.
pub struct LowPass {
    settings: TotalVariation,
    times: Vec<f64>,
    signal: Vec<f64>,
    still: Vec<f64>,
}

impl LowPass {
    pub fn new(factor: f64, seconds: f64) -> Outcome<Self> {
        let motion = beta_alone();
        let step = MEASURED.encoder_step;
        let times: Vec<f64> = (0..(seconds / PERIOD) as usize).map(|k| PERIOD * k as f64).collect();
        let signal: Vec<f64> =
            times.iter().map(|t| (motion.instant(*t)[0][0] / step).round() * step).collect();
        let acceleration = times.windows(2).map(|t| {
            let [a, b] = [t[0], t[1]].map(|t| motion.instant(t)[2][0]);
            (b - a) / PERIOD
        });
        let by_noise = TotalVariation {
            epsilon: Some(rms(acceleration).powi(2)),
            ..TotalVariation::from_noise(quantization_noise(step))
        };
        let gamma = by_noise.differentiate(&times, &signal)?.parameter;
        let settings = TotalVariation { regularization: Regularization::Weight(factor * gamma), ..by_noise };
        let still = settings.differentiate(&times, &signal)?.first;
        Ok(Self { settings, times, signal, still })
    }

    /// Gain of the velocity of a small sine of `frequency` (Hz) that is added to the motion.
    pub fn gain(&self, frequency: f64) -> Outcome<f64> {
        let rate = TAU * frequency;
        let shaken: Vec<f64> =
            (self.times.iter().zip(&self.signal)).map(|(t, s)| s + PROBE * (rate * t).sin()).collect();
        let derivative = self.settings.differentiate(&self.times, &shaken)?.first;
        let margin = (MARGIN * self.times.len() as f64) as usize;
        let (mut product, mut energy) = (0.0, 0.0);
        for i in margin..self.times.len() - margin {
            let expected = PROBE * rate * (rate * self.times[i]).cos();
            product += expected * (derivative[i] - self.still[i]);
            energy += expected * expected;
        }
        Ok(product / energy)
    }

    fn curve(&self, frequencies: &[f64]) -> Outcome<Vec<[f64; 2]>> {
        let point = |f: &f64| Ok([*f, self.gain(*f)?]);
        frequencies.iter().map(point).collect()
    }
}

/// Claim 5a for an encoder with the resolution `step` [rad], and for an encoder that is ten times coarser.
pub fn encoder_claim([fine, coarse]: &[Comparison; 2], step: f64) -> Claim {
    let [differences, smoothed] = fine.errors();
    Claim::new(
        "claim-5a",
        "The velocity that encoders give is coarse; total-variation regularized differentiation (TVDiff) makes it usable.",
    )
    .criterion(Criterion::at_least(
        "error of differences over that of TVDiff, rms",
        fine.gain(),
        1.5,
        "",
    ))
    .criterion(Criterion::at_least(
        "the same with an encoder that is ten times coarser",
        coarse.gain(),
        3.0,
        "",
    ))
    .flipped_by("encoders a hundred times finer: differences then follow the velocity better than anything smooth")
    .remark(format!(
        "A step of {:.3} mrad in 20 ms is a step of {:.2} mrad/s; differences err by {:.2} mrad/s rms, TVDiff by {:.2}, much of which is          jitter that the noise of the torque really makes. Reference is the plant's own velocity.",
        1e3 * step,
        1e3 * step / PERIOD,
        1e3 * differences,
        1e3 * smoothed
    ))
    .shown_in("velocity")
}

/// Claim 5b for the analytic signal.
pub fn synthetic_claim([first, second]: &[Comparison; 2]) -> Claim {
    Claim::new(
        "claim-5b",
        "On noisy signals whose derivative is known TVDiff is far better than finite differences.",
    )
    .criterion(Criterion::at_least(
        "error of central differences over that of TVDiff, first derivative",
        first.gain(),
        5.0,
        "",
    ))
    .criterion(Criterion::at_least("the same, second derivative", second.gain(), 50.0, ""))
    .flipped_by("noise a thousand times smaller: what remains is the error of the formulas")
    .shown_in("synthetic")
}

/// Claim 5c for one weight.
pub fn low_pass_claim(filter: &LowPass) -> Outcome<Claim> {
    Ok(Claim::new(
        "claim-5c",
        "TVDiff acts as a low-pass: it keeps the motion and takes what is faster.",
    )
    .criterion(Criterion::at_least(
        "gain at the motion's highest frequency, 0.37 Hz",
        filter.gain(MOTION_TOP)?,
        0.95,
        "",
    ))
    .criterion(Criterion::at_most("gain at 10 Hz", filter.gain(BEYOND)?, 0.05, ""))
    .flipped_by("a weight that is a million times smaller passes 10 Hz, one that is ten thousand times larger takes the motion too")
    .remark("The gain belongs to a small sine on top of the motion; the method is not linear, and where the motion's jerk changes its sign the gain differs.")
    .shown_in("low-pass"))
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let seconds = study.pick(60.0, 20.0);
    let step = MEASURED.encoder_step;
    let logs = [measured_like(step, seconds)?, measured_like(10.0 * step, seconds)?];
    let by_step = by_encoder_step(study, seconds)?;
    let synthetic = synthetic(1e-3, seconds)?;
    let filters = [0.01, 1.0, 100.0].map(|factor| LowPass::new(factor, seconds));
    let [light, chosen, heavy] = filters;
    let (light, chosen, heavy) = (light?, chosen?, heavy?);
    let count = study.pick(31, 11);
    let frequencies: Vec<f64> =
        (0..count).map(|i| 0.1 * 200_f64.powf(f64::from(i) / f64::from(count - 1))).collect();
    let of_difference = |f: &f64| [*f, (TAU * f * PERIOD).sin() / (TAU * f * PERIOD)];
    let low_pass =
        Plot::new("", Axis::new("frequency", "Hz").logarithmic(), Axis::new("gain", "").over(0.0, 1.1))
            .series("γ of the encoders", Marks::Line, chosen.curve(&frequencies)?)
            .series("γ/100", Marks::Line, light.curve(&frequencies)?)
            .series("100 γ", Marks::Line, heavy.curve(&frequencies)?)
            .series("central differences", Marks::Dashed, frequencies.iter().map(of_difference).collect());
    let claims = vec![encoder_claim(&logs, step), synthetic_claim(&synthetic), low_pass_claim(&chosen)?];
    Ok(Part { section: section(&logs[0], by_step, &synthetic, low_pass), claims })
}

/// Plot of the errors of the velocity over the resolution of the encoder.
fn by_encoder_step(study: &Study, seconds: f64) -> Outcome<Plot> {
    let steps: &[f64] = study.pick(&[1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3], &[1e-5, 1e-4, 1e-3]);
    let mut curves = [Vec::new(), Vec::new()];
    for step in steps {
        let errors = measured_like(*step, seconds)?.errors();
        for (curve, error) in curves.iter_mut().zip(errors) {
            curve.push([1e3 * step, 1e3 * error]);
        }
    }
    let [differences, smoothed] = curves;
    Ok(Plot::new(
        "Error over the encoder's step",
        Axis::new("encoder step", "mrad").logarithmic(),
        Axis::new("error of the velocity, rms", "mrad/s").logarithmic(),
    )
    .series("differences", Marks::Line, differences)
    .series("TVDiff", Marks::Line, smoothed))
}

fn section(log: &Comparison, by_step: Plot, synthetic: &[Comparison; 2], low_pass: Plot) -> Section {
    let [first, second] = synthetic;
    let row = |name: &str, unit: &str, one: &Comparison| {
        let [differences, smoothed] = one.errors();
        [Cell::text(name), Cell::text(unit), Cell::number(differences), Cell::number(smoothed)]
    };
    Section::new("differentiation", "Velocities from encoders")
        .block(text(
            "Joint β moves at up to 0.5 rad/s; its encoder counts 0.1 mrad and is read every 20 ms. TVDiff minimizes \
             $\\tfrac12 \\lVert s-f \\rVert^2 + \\gamma \\, \\Delta t \\sum \\sqrt{(D^3 s)^2 + \\varepsilon}$ over the smoothed \
             signal $s$; $\\gamma$ follows from the encoder's rounding error, $\\Delta/\\sqrt{12}$.",
        ))
        .block(Block::Figure(
            Figure::new("velocity", "Velocity of β from its encoder at a reversal and at speed, and the errors over the step of the encoder.")
                .plot(log.plot("Reversal", Axis::new("velocity", "rad/s"), [7.0, 7.3], Marks::Steps))
                .plot(log.plot("Fast", Axis::new("velocity", "rad/s"), [14.3, 14.6], Marks::Steps))
                .plot(by_step),
        ))
        .block(Block::Figure(
            Figure::new(
                "synthetic",
                "Derivatives of an analytic signal with 1 mrad of normal noise; the reference is the analytic derivative.",
            )
            .plot(first.plot("First derivative", Axis::new("velocity", "rad/s"), [4.0, 8.0], Marks::Line))
            .plot(second.plot("Second derivative", Axis::new("acceleration", "rad/s²"), [4.0, 8.0], Marks::Line)),
        ))
        .block(Block::Table(
            Table::new("differentiation-errors", "Errors of the derivatives, rms over the inner 90 % of the samples.")
                .column("signal", "signal", "")
                .column("unit", "unit", "")
                .column("finite differences", "differences", "")
                .column("TVDiff", "tvdiff", "")
                .row(row("β from its encoder, velocity", "rad/s", log))
                .row(row("analytic, first derivative", "rad/s", first))
                .row(row("analytic, second derivative", "rad/s²", second)),
        ))
        .block(Block::Figure(
            Figure::new(
                "low-pass",
                "What TVDiff leaves of the velocity of a sine of 1 mrad on top of the motion of β, for three weights.",
            )
            .plot(low_pass),
        ))
}
