//! Runs the control loop in real time at 50 Hz, with a simulated robot in another process over UDP.
//!
//! ```text
//! cargo run -p gelenk-runtime --example plant_process -- --port 4711
//! cargo run -p gelenk-runtime --example remote_loop -- 127.0.0.1:4711
//! ```
//!
//! Without an address, the program starts the plant process itself. Ctrl-C stops the arm on its path and engages the brakes.
//! `GELENK_EXAMPLE_SHORT=1` shortens the motion to 0.4 s.

use gelenk_runtime::control_loop::{
    ControlLoop, FeedForwardPd, JointGains, JointPd, LoopSettings, MonotonicClock, RealtimeRequest,
    StopRequest,
};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::UdpTransport;
use outcome::Outcome;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, ExitCode, Stdio};

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const RATE: f64 = 50.0;
const START: [f64; 2] = [-0.2, 0.3];

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let (plant, address) = match std::env::args().nth(1) {
        Some(address) => (None, address),
        None => start_plant().map(|(plant, address)| (Some(plant), address))?,
    };
    let outcome = drive(&address);
    if let Some(mut plant) = plant {
        plant.kill()?;
        plant.wait()?;
    }
    outcome
}

fn drive(address: &str) -> Outcome<()> {
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    let motion = if short {
        RestToRest::new(START, [-0.14, 0.26], 0.4)?
    } else {
        RestToRest::new(START, [0.2, 0.0], 3.0)?
    };
    let settings =
        LoopSettings { position_limits: [[-1.0, 1.0]; 2], ..LoopSettings::for_robot(RATE, &PowerCube) };
    let gains = JointGains::from_bandwidth(&PowerCube, &START, 10.0, 0.7);
    let law = JointPd::new(PowerCube, gains)?;
    let controller = FeedForwardPd::new(law.clone(), motion, 1.0 / RATE, 0.01)?;
    let mut robot: UdpTransport<2, 2> =
        UdpTransport::connect(address, settings.period() / 4).map_err(|e| format!("{address}: {e}"))?;
    let mut control = ControlLoop::new(settings, law, motion, controller, &mut robot, MonotonicClock)?
        .with_stop_request(StopRequest::on_signals()?);
    println!("{}", RealtimeRequest::default().apply());
    println!("{}", control.run());
    drop(control);
    if let Some((state, brakes)) = robot.inspect()? {
        let positions = state.positions;
        println!("the plant says: at {positions:.4?} rad, brakes {brakes:?}");
    }
    Ok(())
}

/// Starts the program `plant_process` in the folder of this program.
fn start_plant() -> Outcome<(Child, String)> {
    let name = format!("plant_process{}", std::env::consts::EXE_SUFFIX);
    let program = std::env::current_exe()?.with_file_name(name);
    if !program.exists() {
        build_plant()?;
    }
    let start = START.map(|y| y.to_string()).join(",");
    let mut plant = Command::new(&program)
        .args(["--start", &start])
        .env_remove("GELENK_EXAMPLE_SHORT")
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    let output = plant.stdout.take().ok_or("no output of the plant")?;
    let mut line = String::new();
    BufReader::new(output).read_line(&mut line)?;
    let address = line.trim().strip_prefix("listening on ");
    let address = address.ok_or("the plant process does not say where it listens")?;
    Ok((plant, address.to_owned()))
}

/// Builds `plant_process`, because `cargo run --example remote_loop` does not build it.
fn build_plant() -> Outcome<()> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--package", "gelenk-runtime"]);
    build.args(["--example", "plant_process"]);
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    if build.status()?.success() {
        return Ok(());
    }
    Err("the plant process cannot be built: cargo build -p gelenk-runtime --examples".into())
}
