//! Simulates a PowerCube in a separate process. A controller drives it over UDP.
//!
//! ```text
//! cargo run -p gelenk-runtime --example plant_process -- --port 4711
//! cargo run -p gelenk-runtime --example remote_loop -- 127.0.0.1:4711
//! ```
//!
//! The process first prints its address. It starts with engaged brakes, and engages the brakes again if no inputs arrive. It
//! ends if no datagram arrives for `--idle` seconds.

use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::transport::{Pace, PlantServer, ServerOptions};
use outcome::Outcome;
use std::error::Error;
use std::io::Write;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const USAGE: &str = "\
plant_process [options]
  --port PORT            UDP port, 0 for any [0]
  --start BETA,GAMMA     positions at the start [rad] [-0.6,0.4]
  --period SECONDS       step of the plant [0.02]
  --lock-step            a period passes with each query, not with the clock
  --watchdog PERIODS     brake after so many periods without inputs [5]
  --loss PROBABILITY     of each datagram [0]
  --silence FIRST,END    periods in which nothing arrives and nothing is answered
  --seed SEED            of the losses [0]
  --idle SECONDS         end when nothing arrived for so long [60]";

struct Arguments {
    port: u16,
    start: [f64; 2],
    idle: f64,
    server: ServerOptions,
}

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let mut arguments = parse(std::env::args().skip(1))?;
    if std::env::var_os("GELENK_EXAMPLE_SHORT").is_some() {
        arguments.idle = 0.2;
    }
    let options = PlantOptions {
        encoder_resolution: [1e-4; 2],
        input_limits: [[-0.5, 0.5]; 2],
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(PowerCube, options)?;
    plant.reset(arguments.start, [0.0; 2])?;
    let mut server = PlantServer::bind(plant, ("127.0.0.1", arguments.port), arguments.server)?;
    println!("listening on {}", server.local_address()?);
    std::io::stdout().flush()?;
    server.serve(Duration::try_from_secs_f64(arguments.idle)?)?;
    let (positions, velocities) = server.plant().state();
    println!("at {positions:.4?} rad, {velocities:.4?} rad/s");
    println!("braked: {}", server.plant().is_braked());
    if let Some(fault) = server.last_breakdown() {
        println!("broke down {} times: {fault}", server.breakdowns());
    }
    Ok(())
}

fn parse(mut words: impl Iterator<Item = String>) -> Outcome<Arguments> {
    let mut arguments =
        Arguments { port: 0, start: [-0.6, 0.4], idle: 60.0, server: ServerOptions::default() };
    while let Some(option) = words.next() {
        if option == "--lock-step" {
            arguments.server.pace = Pace::LockStep;
            continue;
        }
        let value = words.next().ok_or_else(|| format!("{option}?\n{USAGE}"))?;
        set(&mut arguments, &option, &value)
            .map_err(|error| format!("{option} {value}: {error}\n{USAGE}"))?;
    }
    Ok(arguments)
}

fn set(arguments: &mut Arguments, option: &str, value: &str) -> Outcome<()> {
    let server = &mut arguments.server;
    match option {
        "--port" => arguments.port = value.parse()?,
        "--start" => arguments.start = pair(value)?.into(),
        "--period" => server.period = value.parse()?,
        "--watchdog" => server.watchdog_periods = value.parse()?,
        "--loss" => server.loss = value.parse()?,
        "--silence" => {
            let (first, end) = pair(value)?;
            server.silence = first..end;
        }
        "--seed" => server.seed = value.parse()?,
        "--idle" => arguments.idle = value.parse()?,
        _ => return Err("there is no such option".into()),
    }
    Ok(())
}

fn pair<T: FromStr>(text: &str) -> Outcome<(T, T)>
where
    T::Err: Error + 'static,
{
    let (first, second) = text.split_once(',').ok_or("not two values with a comma between")?;
    Ok((first.parse()?, second.parse()?))
}
