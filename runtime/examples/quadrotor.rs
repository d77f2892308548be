//! Simulates a quadrotor with predictive control. In the first flight it follows a figure of eight with a whole roll. In the second
//! flight it recovers after it was thrown upside down. Positions contain a quaternion, and errors are `y ⊖ y_d`.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example quadrotor [FOLDER]
//! ```
//!
//! The program prints a table and writes a page of plots to FOLDER. The default is a folder for temporary files.
//! `GELENK_EXAMPLE_SHORT=1` only simulates the recovery.

use flight::{Motion, PERIOD, Quadrotor, figure, options, pose};
use gelenk_report::Figure;
use gelenk_runtime::control_loop::Controller;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::Trajectory;
use outcome::Outcome;
use plots::{Folder, over_time};
use std::process::ExitCode;

#[path = "support/flight.rs"]
mod flight;
#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;
#[path = "support/simulated.rs"]
mod simulated;

/// State of the thrown quadrotor, which is rotated by 170° about a tilted axis and spins.
fn thrown() -> ([f64; 7], [f64; 6]) {
    let (sine, cosine) = (170.0_f64.to_radians() / 2.0).sin_cos();
    ([0.0, 0.0, 1.0, 0.8 * sine, 0.6 * sine, 0.0, cosine], [0.5, -0.5, 1.0, 0.5, -1.0, 0.3])
}

struct Flight {
    controller: &'static str,
    periods: Vec<simulated::Period<6, 4, 7>>,
    /// Position error [m] and attitude error [rad] in each period.
    errors: Vec<[f64; 2]>,
}

fn fly(
    name: &'static str,
    controller: &mut impl Controller<6, 4, 7>,
    motion: &Motion,
    (y, v): ([f64; 7], [f64; 6]),
    duration: f64,
) -> Outcome<Flight> {
    let limits = Quadrotor.input_limits().nominal;
    let mut plant = Plant::new(Quadrotor, PlantOptions { input_limits: limits, ..PlantOptions::default() })?;
    plant.reset(y, v)?;
    let steps = (duration / PERIOD).ceil() as u32;
    let periods = simulated::run(&mut plant, controller, [1.52 * 9.81 / 4.0; 4], PERIOD, steps)?;
    let length = |part: &[f64]| part.iter().map(|d| d * d).sum::<f64>().sqrt();
    let error = |period: &simulated::Period<6, 4, 7>| {
        let d = Quadrotor.difference(&motion.sample(period.time).positions, &period.positions);
        [length(&d[..3]), length(&d[3..])]
    };
    let errors = periods.iter().map(error).collect();
    Ok(Flight { controller: name, periods, errors })
}

/// Vertical component of the vertical axis of the body: 1 if level, −1 if upside down.
fn upright(y: &[f64; 7]) -> f64 {
    1.0 - 2.0 * (y[3] * y[3] + y[4] * y[4])
}

fn both(
    motion: &Motion,
    start: ([f64; 7], [f64; 6]),
    duration: f64,
    weights: [f64; 2],
) -> Outcome<[Flight; 2]> {
    let options = options(weights);
    let mut ltv = LtvMpc::new(Quadrotor, motion.clone(), options.clone())?;
    let mut nonlinear = Nmpc::new(Quadrotor, motion.clone(), options)?;
    Ok([
        fly("LTV-MPC", &mut ltv, motion, start, duration)?,
        fly("NMPC", &mut nonlinear, motion, start, duration)?,
    ])
}

/// Prints a row of the table.
///
/// # Errors
/// An error if the flight exceeds its bounds.
fn report(what: &str, flight: &Flight, bounds: &Bounds) -> Outcome<()> {
    let worst = |k: usize| flight.errors.iter().fold(0.0_f64, |most, errors| most.max(errors[k]));
    let last = flight.errors.last().copied().unwrap_or_default();
    let lowest = flight.periods.iter().map(|period| upright(&period.positions)).fold(1.0, f64::min);
    println!(
        "{what:<10} {:<10} {:>8.3} {:>8.3}   {:>9.1e} {:>9.1e}   {lowest:>6.2}",
        flight.controller,
        worst(0),
        worst(1),
        last[0],
        last[1]
    );
    bounds.hold(what, flight)
}

/// Largest allowed errors of position (m) and attitude (rad) during the flight and at its end.
struct Bounds {
    on_the_way: [f64; 2],
    at_the_end: [f64; 2],
}

const RECOVERY: Bounds = Bounds { on_the_way: [2.2, 3.0], at_the_end: [1e-3, 1e-2] };

/// Bounds of the short form, in which the quadrotor is upright again but still far from its goal.
const SHORT_RECOVERY: Bounds = Bounds { at_the_end: [2.2, 1.0], ..RECOVERY };

const FIGURE: Bounds = Bounds { on_the_way: [0.6, 0.7], at_the_end: [1e-2, 2e-3] };

impl Bounds {
    /// Checks the errors of a flight.
    ///
    /// # Errors
    /// An error if the flight exceeds the bounds, or if a number is NaN.
    fn hold(&self, what: &str, flight: &Flight) -> Outcome<()> {
        let within = |errors: &[f64; 2], bounds: [f64; 2]| errors[0] <= bounds[0] && errors[1] <= bounds[1];
        if !flight.errors.iter().all(|errors| within(errors, self.on_the_way)) {
            return Err(format!("{what}, {}: the quadrotor leaves its way", flight.controller).into());
        }
        if !flight.errors.last().is_some_and(|errors| within(errors, self.at_the_end)) {
            return Err(format!("{what}, {}: the quadrotor does not arrive", flight.controller).into());
        }
        Ok(())
    }
}

fn figure_of(id: &str, caption: &str, flights: &[Flight; 2]) -> Figure {
    let points = |flight: &Flight, value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        flight.periods.iter().enumerate().map(|(k, period)| [period.time, value(k)]).collect()
    };
    let each = |value: fn(&Flight, usize) -> f64| {
        flights.each_ref().map(|flight| (flight.controller, points(flight, &|k| value(flight, k))))
    };
    let [ltv, _] = flights;
    let thrust = |j: usize| (Quadrotor.input_names()[j], points(ltv, &|k| ltv.periods[k].inputs[j]));
    let plots = [
        over_time("distance", "m", each(|flight, k| flight.errors[k][0])),
        over_time("upright", "1", each(|flight, k| upright(&flight.periods[k].positions))),
        over_time("height", "m", each(|flight, k| flight.periods[k].positions[2])),
        over_time("thrust of LTV-MPC", "N", [0, 1, 2, 3].map(thrust)),
    ];
    plots::figure(id, caption, plots)
}

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = Folder::from_arguments("quadrotor")?;
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    println!("                      largest error         error at the end     lowest");
    println!("flight     controller      [m]    [rad]         [m]     [rad]    axis z");
    let hover = pose([0.0, 0.0, 1.0], 0.0, 0.0);
    let still = Motion::between(Quadrotor, hover, hover, 1.0)?;
    let recovery = both(&still, thrown(), if short { 0.6 } else { 4.5 }, [100.0, 10.0])?;
    let bounds = if short { SHORT_RECOVERY } else { RECOVERY };
    recovery.iter().try_for_each(|flight| report("thrown", flight, &bounds))?;
    if short {
        return Ok(());
    }
    let motion = figure()?;
    let figure = both(&motion, (motion.sample(0.0).positions, [0.0; 6]), 8.0, [10.0, 10.0])?;
    figure.iter().try_for_each(|flight| report("figure", flight, &FIGURE))?;
    let figures = vec![
        figure_of("thrown", "Thrown upside down.", &recovery),
        figure_of("figure", "A figure with a roll in its middle.", &figure),
    ];
    folder.write("A quadrotor by predictive control", figures)
}
