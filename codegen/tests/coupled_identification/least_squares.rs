//! Random robots of three joints with two motors that move several of them, against least squares over all columns.

use std::fmt::Write as _;

use gelenk_codegen::identify::InterpretedRobot;
use gelenk_codegen::read::{self, ReadOptions};
use gelenk_identification::estimation::{EstimationSettings, Offsets, estimate};
use gelenk_identification::robot::Robot;
use gelenk_identification::run::{Effort, PreparedRun};
use gelenk_identification::shafts::with_rows_of_shafts;
use nalgebra::{DMatrix, DVector};

use super::described::Noise;

const N: usize = 3;
const SAMPLES: usize = 2000;
/// Slope of the Coulomb terms.
const SLOPE: f64 = 5.0;

/// A described arm, the motion of its shafts by that of its joints, and friction of its rows: viscous and Coulomb.
struct Random {
    text: String,
    ratios: DMatrix<f64>,
    friction: [[f64; 2]; N],
}

impl Random {
    fn new(seed: u64) -> Self {
        let mut noise = Noise(seed);
        for _ in 0..8 {
            noise.next();
        }
        let mut near = |middle: f64, span: f64| middle + span * noise.next();
        let mut text = String::from("name = \"random\"\n");
        for (joint, axis) in ["[0, 1, 0]", "[1, 0, 0]", "[0, 0, 1]"].iter().enumerate() {
            let [x, y, z] = [near(0.0, 0.2), near(0.0, 0.2), near(0.3, 0.1)];
            let drive = if joint == 0 { "drive = \"ideal\"\n" } else { "" };
            write!(text, "\n[[joints]]\nname = \"j{joint}\"\naxis = {axis}\norigin = {{ xyz = [{x}, {y}, {z}] }}\n{drive}")
                .unwrap();
            let [m, x, y, z] = [near(2.0, 1.0), near(0.0, 0.1), near(0.0, 0.1), near(0.1, 0.1)];
            write!(text, "\n[[bodies]]\nlink = \"j{joint}\"\nmass = {m}\ncenter_of_mass = [{x}, {y}, {z}]\ninertia = 0.02\n")
                .unwrap();
        }
        // The second drive brakes the driven joint too.
        let rows = [[0.0, near(1.0, 0.3), near(0.8, 0.3)], [near(0.5, 0.4), near(0.9, 0.3), near(-1.0, 0.3)]];
        for (drive, weights) in rows.iter().enumerate() {
            let on = weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
            let on: Vec<String> = on.map(|(joint, weight)| format!("j{joint} = {weight}")).collect();
            let on = on.join(", ");
            write!(text, "\n[[drives]]\nname = \"d{drive}\"\non = {{ {on} }}\n").unwrap();
        }
        let mut ratios = DMatrix::identity(N, N);
        let friction = std::array::from_fn(|_| [near(0.6, 0.4), near(0.8, 0.5)]);
        rows.iter().enumerate().for_each(|(drive, weights)| {
            weights.iter().enumerate().for_each(|(joint, weight)| ratios[(drive + 1, joint)] = *weight);
        });
        Self { text, ratios, friction }
    }

    fn robot(&self) -> InterpretedRobot {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("random.toml");
        std::fs::write(&path, &self.text).unwrap();
        InterpretedRobot::new(&read::read(&path, &ReadOptions::default()).unwrap().model).unwrap()
    }
}

/// Motion of the joints at a time.
fn motion(t: f64) -> [DVector<f64>; 3] {
    let waves = [[0.8, 1.3, 0.5, 3.7], [0.9, 1.9, 0.4, 4.1], [1.1, 1.6, 0.3, 5.3]];
    let at = |shape: &dyn Fn(f64, f64) -> f64| {
        let wave =
            |(k, &[a, w, b, x]): (usize, &[f64; 4])| a * shape(w, w * t + k as f64) + b * shape(x, x * t);
        DVector::from_iterator(N, waves.iter().enumerate().map(wave))
    };
    [at(&|_, x| x.sin()), at(&|w, x| w * x.cos()), at(&|w, x| -w * w * x.sin())]
}

/// Signals along the shafts, and the columns of least squares: W and friction of each row, over the torques.
fn data(random: &Random, robot: &InterpretedRobot) -> (PreparedRun, DMatrix<f64>, DVector<f64>) {
    let parameters = DVector::from_vec(robot.parameters());
    let p = parameters.len();
    let (mut columns, mut torques) = (DMatrix::zeros(N * SAMPLES, p + 2 * N), DVector::zeros(N * SAMPLES));
    let mut noise = Noise(11);
    let mut signals = vec![vec![vec![0.0; SAMPLES]; N]; 4];
    let to_rows = random.ratios.transpose().try_inverse().unwrap();
    for sample in 0..SAMPLES {
        let moved = motion(0.01 * sample as f64);
        let mut regressor = vec![0.0; N * p];
        robot.inertial_regressor(
            moved[0].as_slice(),
            moved[1].as_slice(),
            moved[2].as_slice(),
            &mut regressor,
        );
        let w = &to_rows * DMatrix::from_row_slice(N, p, &regressor);
        let along = moved.map(|x| &random.ratios * x);
        for row in 0..N {
            let (place, v) = (N * sample + row, along[1][row]);
            columns.view_mut((place, 0), (1, p)).copy_from(&w.row(row));
            columns[(place, p + 2 * row)] = v;
            columns[(place, p + 2 * row + 1)] = (SLOPE * v).tanh();
            let [viscous, coulomb] = random.friction[row];
            let rigid = (w.row(row) * &parameters)[0];
            torques[place] = rigid + viscous * v + coulomb * (SLOPE * v).tanh() + 0.02 * noise.next();
            (0..3).for_each(|kind| signals[kind][row][sample] = along[kind][row]);
            signals[3][row][sample] = torques[place];
        }
    }
    let [positions, velocities, accelerations, torques_of_rows] = <[_; 4]>::try_from(signals).unwrap();
    // The first input is the force at the first joint, whose row has the remainder without the second drive's.
    let efforts = torques_of_rows;
    let run = PreparedRun {
        name: "random".into(),
        times: (0..SAMPLES).map(|sample| 0.01 * sample as f64).collect(),
        rows: (2..SAMPLES + 2).collect(),
        positions,
        poses: Vec::new(),
        resting: Vec::new(),
        velocities,
        accelerations,
        efforts,
        effort: Effort::Input,
    };
    (run, columns, torques)
}

#[test]
fn friction_of_random_shafts_is_that_of_least_squares() {
    for seed in 1..4 {
        let random = Random::new(seed);
        let robot = random.robot();
        let shafts = with_rows_of_shafts(&robot);
        assert_eq!(shafts.joint_names(), ["j0", "d0", "d1"]);
        let identity = shafts.input_matrix();
        (0..N * N)
            .for_each(|k| assert!((identity[k] - f64::from(k % (N + 1) == 0)).abs() < 1e-12, "{identity:?}"));

        let (run, columns, torques) = data(&random, &robot);
        let least = columns.svd(true, true).solve(&torques, 1e-9).unwrap();
        let settings = EstimationSettings {
            offsets: Some(Offsets::None),
            steepness: Some(vec![SLOPE; N]),
            optional_terms: false,
            robust_passes: 0,
            consistent: false,
            ..EstimationSettings::default()
        };
        let found = estimate(&shafts, &[run], &settings, &mut |_| ()).unwrap();
        let p = robot.parameters().len();
        for (row, joint) in found.joints.iter().enumerate() {
            for (term, true_) in random.friction[row].iter().enumerate() {
                let (coefficient, least) = (joint.terms[term].coefficient, least[p + 2 * row + term]);
                println!(
                    "{seed} {} {}: {true_:.5} {least:.5} {coefficient:?}",
                    joint.name, joint.terms[term].basis
                );
                let apart = (coefficient.value - least).abs();
                assert!(apart < coefficient.standard_error, "{}: {least} {coefficient:?}", joint.name);
                assert!((coefficient.value - true_).abs() < 0.02, "{}: {true_} {coefficient:?}", joint.name);
            }
        }
    }
}
