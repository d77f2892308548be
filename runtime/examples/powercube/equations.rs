//! Equations of the arm and of its controllers for the page.

use crate::study::Outcome;
use gelenk_report::{Block, Equation, Section, text};

/// Parameters of the published model: M_11, M_22 without rotors and h [kg m²], first moments [kg m], gear ratio, rotor inertia
/// [kg m²], gravity [m/s²].
struct Published {
    m11: f64,
    m22: f64,
    h: f64,
    first: f64,
    second: f64,
    gear: f64,
    rotor: f64,
    gravity: f64,
}

const PUBLISHED: Published = Published {
    m11: 0.956_037_516_856_5,
    m22: 0.660_889_906_856_5,
    h: 0.310_754_986_2,
    first: 1.626_138,
    second: 1.726_416_59,
    gear: 161.0,
    rotor: 5.267e-5,
    gravity: 9.806_65,
};

/// The section of the page.
pub fn section() -> Outcome<Section> {
    let Published { m11, m22, h, first, second, gear, rotor, gravity } = PUBLISHED;
    let rotor = 1e5 * rotor;
    let equations = |sources: &[String]| -> Outcome<Block> {
        let set = sources.iter().map(|latex| Equation::new(latex.as_str()));
        Ok(Block::Equations(set.collect::<Result<_, _>>()?))
    };
    let arm = [
        r"M(y)\,\ddot y + k(y, \dot y) = q(y, \dot y) + B u, \quad y = \begin{pmatrix} \beta \\ \gamma \end{pmatrix}, \quad B = \begin{pmatrix} i & 0 \\ 0 & i \end{pmatrix}".to_owned(),
        format!(r"M = \begin{{pmatrix}} J_R i^2 + {m11:.5} + 2 h \cos\gamma & J_R i + {m22:.5} + h \cos\gamma \\ J_R i + {m22:.5} + h \cos\gamma & J_R i^2 + {m22:.5} \end{{pmatrix}}"),
        r"k = h \sin\gamma \begin{pmatrix} -(2 \dot\beta \dot\gamma + \dot\gamma^2) \\ \dot\beta^2 \end{pmatrix}".to_owned(),
        format!(r"q = g \begin{{pmatrix}} {first} \sin\beta + {second} \sin(\beta + \gamma) \\ {second} \sin(\beta + \gamma) \end{{pmatrix}} - \begin{{pmatrix}} \tau_\beta(\dot\beta) \\ \tau_\gamma(\dot\gamma) \end{{pmatrix}}"),
        r"\tau_\beta(v) = 76.556\,v + 3.924 \tanh 5v + 10.838 \tanh 10v + 2.236 \tanh 20v".to_owned(),
        r"\tau_\gamma(v) = 56.231\,v + 0.368 \tanh 5v + 0.368 \tanh 10v + 8.342 \tanh 100v + 0.492 \operatorname{sign} v".to_owned(),
        r"\tau_{\mathrm{old}}(v) = 45\,v + 9 \tanh 10v".to_owned(),
    ];
    let control = [
        r"u_{\mathrm{ff}} = B^{-1} \left( M(y_{\mathrm{ref}})\, \ddot y_{\mathrm{ref}} + k - q \right)".to_owned(),
        r"\dot x = \begin{pmatrix} \dot y \\ M^{-1} (q + B u - k) \end{pmatrix} = f(x, u) \approx A x + B_x u + c, \quad A = \frac{\partial f}{\partial x}, \quad B_x = \frac{\partial f}{\partial u}, \quad c = f(\bar x, \bar u) - A \bar x - B_x \bar u".to_owned(),
        r"x_{k+1} = A_k x_k + B_k u_k + c_k, \quad u \text{ held over } T = 20\,\mathrm{ms}".to_owned(),
        r"\min_{u_0, \ldots, u_{K-1}} \; \frac{1}{2} \sum_{k=1}^{K-1} \delta x_k^T Q\, \delta x_k + \frac{1}{2} \delta x_K^T P\, \delta x_K + \frac{1}{2} \sum_{k=0}^{K-1} \delta u_k^T R\, \delta u_k".to_owned(),
        r"\delta x = x - x_{\mathrm{ref}}, \quad \delta u = u - u_{\mathrm{ff}}, \quad -u_{\max} \le u_k \le u_{\max}, \quad |\dot y_k| \le \dot y_{\max}".to_owned(),
    ];
    Ok(Section::new("equations", "Equations")
        .block(text(&format!("The PowerCube arm with all joints but $\\beta$ and $\\gamma$ held: both axes are parallel and horizontal, $y = 0$ is upright, $\\gamma$ is measured relative to the first link. $g = {gravity}$ m/s², $h = {h}$ kg m², $i = {gear}$, $J_R = {rotor:.3} \\cdot 10^{{-5}}$ kg m²; torques in N m, speeds in rad/s. As published by Nicodemus et al. (2022).")))
        .block(equations(&arm)?)
        .block(text("Two-step control: feed-forward along the desired trajectory, and feedback by model predictive control. The predictions of the LTV-MPC are the exact zero-order hold of the linearization along the desired trajectory (as in the paper) or along the previous plan; those of the nonlinear MPC are Runge–Kutta steps of $f$ with their sensitivities. $P$ solves the discrete Riccati equation. Bounds of the torque are hard, those of the speed soft with an exact penalty. The state is estimated from the encoders by an extended Kalman filter, on request together with a disturbance $d$ that acts like an input."))
        .block(equations(&control)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Arm, Friction, arm};
    use gelenk_runtime::dynamics::Dynamics;

    #[test]
    fn the_equations_are_those_of_the_generated_arm() {
        let p = PUBLISHED;
        let model = Arm::default();
        let rigid = arm([Friction([0.0; 7]); 2]);
        for [beta, gamma, v1, v2] in [[0.3, -0.8, 0.5, 0.2], [-1.1, 0.4, -0.3, 0.7]] {
            let (y, v): ([f64; 2], [f64; 2]) = ([beta, gamma], [v1, v2]);
            let coupled = p.rotor * p.gear + p.m22 + p.h * gamma.cos();
            let mass = [
                [p.rotor * p.gear * p.gear + p.m11 + 2.0 * p.h * gamma.cos(), coupled],
                [coupled, p.rotor * p.gear * p.gear + p.m22],
            ];
            let s = p.h * gamma.sin();
            let coriolis = [-s * (2.0 * v1 * v2 + v2 * v2), s * v1 * v1];
            let outer = p.second * (beta + gamma).sin();
            let gravity = [p.gravity * (p.first * beta.sin() + outer), p.gravity * outer];
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
            for i in 0..2 {
                for j in 0..2 {
                    close(model.mass_matrix(&y)[i][j], mass[i][j]);
                    close(model.input_matrix(&y)[i][j], if i == j { p.gear } else { 0.0 });
                }
                close(model.coriolis_forces(&y, &v)[i], coriolis[i]);
                close(rigid.applied_forces(&y, &v)[i], gravity[i]);
            }
        }
    }
}
