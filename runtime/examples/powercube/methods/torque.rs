//! Computes friction torques from a motion and the generated model, and the motor constant from a known load.

use gelenk_identification::methods::least_squares::{Reduced, Solution};
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::Samples;
use gelenk_identification::{IdentificationError, Result};
use gelenk_runtime::dynamics::{Dynamics, Named, load};

/// A recorded motion, with one column of samples for each joint and input.
#[derive(Debug, Clone)]
pub struct Motion<'a, const N: usize, const M: usize> {
    /// Positions y [rad or m].
    pub positions: [&'a [f64]; N],
    /// Velocities ẏ [rad/s or m/s].
    pub velocities: [&'a [f64]; N],
    /// Accelerations ÿ [rad/s² or m/s²].
    pub accelerations: [&'a [f64]; N],
    /// Inputs u: motor torques (N m) or forces (N).
    pub inputs: [&'a [f64]; M],
}

/// Returns the forces `M ÿ + k − q_s` at the joints that the motion needs without friction, with one column for each joint. q_s are
/// the applied forces without friction.
///
/// Friction of the model is removed by `inverse_dynamics(y, ẏ, ÿ) − friction_torques(y, ẏ)`. If the model has load-dependent
/// friction, the load is computed from this difference.
///
/// # Errors
/// An error for columns of different length, for no samples, and for values that are not finite.
pub fn rigid_forces<const N: usize, const M: usize>(
    model: &impl Dynamics<N, M>,
    motion: &Motion<N, M>,
) -> Result<[Vec<f64>; N]> {
    let m = motion.positions.first().map_or(0, |c| c.len());
    let kinds = [
        ("position", &motion.positions),
        ("velocity", &motion.velocities),
        ("acceleration", &motion.accelerations),
    ];
    let names = model.joint_names();
    for (kind, columns) in kinds {
        for (name, column) in names.iter().zip(columns) {
            require_column(&format!("{kind} of joint {}", Named(name)), m, column)?;
        }
    }
    let mut forces: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(m));
    for i in 0..m {
        let y = motion.positions.map(|c| c[i]);
        let v = motion.velocities.map(|c| c[i]);
        let all = model.inverse_dynamics(&y, &v, &motion.accelerations.map(|c| c[i]));
        let (friction, shares) = (model.friction_torques(&y, &v), model.load_friction(&y, &v));
        for (joint, force) in forces.iter_mut().enumerate() {
            force.push(load(all[joint] - friction[joint], shares[joint]));
        }
    }
    Ok(forces)
}

/// Returns the friction torques `τ = q_s + B u − M ÿ − k`, with one column for each joint.
///
/// # Errors
/// The errors of [`rigid_forces`], also for the inputs.
pub fn friction_torques<const N: usize, const M: usize>(
    model: &impl Dynamics<N, M>,
    motion: &Motion<N, M>,
) -> Result<[Vec<f64>; N]> {
    let mut torques = rigid_forces(model, motion)?;
    let m = torques.first().map_or(0, Vec::len);
    let names = model.input_names();
    for (name, column) in names.iter().zip(&motion.inputs) {
        require_column(&format!("input {}", Named(name)), m, column)?;
    }
    for i in 0..m {
        let input_matrix = model.input_matrix(&motion.positions.map(|c| c[i]));
        for (torque, gears) in torques.iter_mut().zip(&input_matrix) {
            let drive: f64 = gears.iter().zip(&motion.inputs).map(|(b, u)| b * u[i]).sum();
            torque[i] = drive - torque[i];
        }
    }
    Ok(torques)
}

fn require_column(what: &str, samples: usize, column: &[f64]) -> Result<()> {
    if column.len() != samples {
        let what = format!("samples of the {what}");
        return Err(IdentificationError::Shape { what, expected: samples, got: column.len() });
    }
    let Some(row) = column.iter().position(|x| !x.is_finite()) else { return Ok(()) };
    let count = column.iter().filter(|x| !x.is_finite()).count();
    let (what, value) = (format!("the {what}"), column[row]);
    Err(IdentificationError::NotFinite { what, row, value, count, samples })
}

/// Returns the motor constant K_M [N m/A] and the friction coefficients ξ from a motion with known load.
///
/// The equations `gear_ratio · K_M · i = τ_load + Θ(v) ξ` for the currents i are solved by least squares. In the solution, K_M is
/// coefficient 0, and ξ follows.
///
/// - `load`: joint torque τ_load that the motion needs without friction, `M ÿ + k − q_s` [N m]
///
/// # Errors
/// The errors of least squares, for example if the load is proportional to friction (no gravity and only one speed).
pub fn motor_constant(
    currents: &[f64],
    gear_ratio: f64,
    load: &[f64],
    library: &Library,
    velocities: &[f64],
) -> Result<Solution> {
    if load.iter().all(|t| *t == 0.0) {
        return Err(IdentificationError::ZeroColumn { term: "the known load".into(), samples: load.len() });
    }
    let drive: Vec<f64> = currents.iter().map(|i| gear_ratio * i).collect();
    let mut theta = library.matrix(&[velocities])?;
    theta.neg_mut();
    let mut names = vec!["K_M".to_string()];
    names.extend_from_slice(library.terms());
    let mut columns: Vec<&[f64]> = vec![&drive];
    columns.extend(theta.as_slice().chunks_exact(theta.nrows().max(1)));
    let samples = Samples::from_columns(&names, columns, vec![load])?;
    let all: Vec<usize> = (0..names.len()).collect();
    Reduced::new(&samples)?.fit(0, &all)
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

    const I: f64 = 161.0;

    /// M ÿ + k − q_s of the reduced PowerCube, as published (Neweul-M²; Nicodemus et al., 2022).
    fn published_forces(y: &[f64; 2], v: &[f64; 2], a: &[f64; 2]) -> [f64; 2] {
        let (rotor, h, g) = (5.267e-5, 0.310_754_986_2, 9.80665);
        let m11 = rotor * I * I + 2.0 * h * y[1].cos() + 0.956_037_516_856_5;
        let m12 = rotor * I + h * y[1].cos() + 0.660_889_906_856_5;
        let m22 = rotor * I * I + 0.660_889_906_856_5;
        let k = [-h * y[1].sin() * (2.0 * v[0] * v[1] + v[1] * v[1]), h * v[0] * v[0] * y[1].sin()];
        let second = 1.72641659 * g * (y[0] + y[1]).sin();
        let q = [1.626138 * g * y[0].sin() + second, second];
        [m11 * a[0] + m12 * a[1] + k[0] - q[0], m12 * a[0] + m22 * a[1] + k[1] - q[1]]
    }

    #[test]
    fn friction_and_motor_constant_come_back_from_a_simulated_motion() {
        let m = 4000;
        let t = |i: usize| 0.005 * i as f64;
        let wave = |a: f64, w: f64| -> [Vec<f64>; 3] {
            let of = |f: &dyn Fn(f64) -> f64| (0..m).map(|i| f(t(i))).collect::<Vec<f64>>();
            [of(&|t| a * (w * t).sin()), of(&|t| a * w * (w * t).cos()), of(&|t| -a * w * w * (w * t).sin())]
        };
        let (b, g) = (wave(0.6, 1.1), wave(0.9, 1.7));
        let friction = |v: f64| 76.556 * v + 3.924 * (5.0 * v).tanh();
        let (mut u, mut load) = ([vec![], vec![]], vec![]);
        for i in 0..m {
            let (y, v) = ([b[0][i], g[0][i]], [b[1][i], g[1][i]]);
            let rigid = published_forces(&y, &v, &[b[2][i], g[2][i]]);
            u[0].push((rigid[0] + friction(b[1][i])) / I);
            u[1].push((rigid[1] + friction(g[1][i])) / I);
            load.push(rigid[0]);
        }
        let motion = Motion {
            positions: [&b[0], &g[0]],
            velocities: [&b[1], &g[1]],
            accelerations: [&b[2], &g[2]],
            inputs: [&u[0], &u[1]],
        };
        let torques = friction_torques(&PowerCube, &motion).unwrap();
        let known = rigid_forces(&PowerCube, &motion).unwrap();
        for i in 0..m {
            assert!((torques[1][i] - friction(g[1][i])).abs() < 1e-8);
            assert!((known[0][i] - load[i]).abs() < 1e-8);
        }
        let mut random = SplitMix64::new(1);
        let currents: Vec<f64> = u[0].iter().map(|u| u / 0.12 + 1e-3 * random.normal()).collect();
        let library = Library::new(&["v", "tanh(5*v)"], &["v"]).unwrap();
        let fit = motor_constant(&currents, I, &load, &library, &b[1]).unwrap();
        assert!(
            (fit.coefficients[0] - 0.12).abs() < 4.0 * fit.standard_errors[0].max(1e-5),
            "{}",
            fit.coefficients
        );
        assert!((fit.coefficients[1] - 76.556).abs() < 0.1, "{}", fit.coefficients);
        let nan = [f64::NAN; 4000];
        let broken = Motion { velocities: [&b[1], &nan], ..motion };
        let message = friction_torques(&PowerCube, &broken).unwrap_err().to_string();
        assert!(message.starts_with("the velocity of joint gamma is not finite (NaN) at row 0"), "{message}");
        let zero = vec![0.0; m];
        assert!(
            motor_constant(&currents, I, &zero, &library, &b[1])
                .unwrap_err()
                .to_string()
                .contains("the known load")
        );
    }
}
