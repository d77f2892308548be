//! Pages with plots over time for the examples.
#![allow(dead_code, reason = "no example needs all of it")]

use gelenk_report::{Axis, Block, Figure, Marks, Plot, Report, Section};
use gelenk_runtime::trajectory::{Sample, Trajectory};
use std::error::Error;
use std::path::PathBuf;

/// Folder of a page.
pub struct Folder(PathBuf);

impl Folder {
    /// The folder in the first argument of the program. The default is `gelenk-examples/NAME` in the folder for temporary files.
    pub fn from_arguments(name: &str) -> Result<Self, Box<dyn Error>> {
        let folder = std::env::args_os()
            .nth(1)
            .map_or_else(|| std::env::temp_dir().join("gelenk-examples").join(name), PathBuf::from);
        Self::made(folder)
    }

    /// This folder, which is created if it does not exist.
    pub fn made(folder: PathBuf) -> Result<Self, Box<dyn Error>> {
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        Ok(Self(folder))
    }

    /// Writes a page with figures.
    pub fn write(&self, title: &str, figures: Vec<Figure>) -> Result<(), Box<dyn Error>> {
        let plots = Section::new("plots", "Plots").blocks(figures.into_iter().map(Block::Figure));
        let files = Report::new(title).section(plots).write(&self.0)?;
        println!("plots: {}", files[0].display());
        Ok(())
    }
}

/// A figure with several plots.
pub fn figure(id: &str, caption: &str, plots: impl IntoIterator<Item = Plot>) -> Figure {
    plots.into_iter().fold(Figure::new(id, caption), Figure::plot)
}

/// A plot of named lines over time [s].
pub fn over_time<S: Into<String>>(
    quantity: &str,
    unit: &str,
    lines: impl IntoIterator<Item = (S, Vec<[f64; 2]>)>,
) -> Plot {
    let plot = Plot::new("", Axis::new("time", "s"), Axis::new(quantity, unit));
    lines.into_iter().fold(plot, |plot, (name, points)| plot.series(name, Marks::Line, points))
}

/// A figure with positions, velocities and accelerations of a motion.
pub fn motion<const N: usize>(
    id: &str,
    caption: &str,
    motion: &impl Trajectory<N>,
    names: [&str; N],
) -> Figure {
    let plot = |quantity: &str, unit: &str, value: fn(&Sample<N>) -> [f64; N]| {
        let line = |i: usize| {
            let times = (0..=600).map(|k| motion.duration() * f64::from(k) / 600.0);
            (names[i], times.map(|t| [t, value(&motion.sample(t))[i]]).collect())
        };
        over_time(quantity, unit, (0..N).map(line))
    };
    let plots = [
        plot("position", "rad", |s| s.positions),
        plot("velocity", "rad/s", |s| s.velocities),
        plot("acceleration", "rad/s²", |s| s.accelerations),
    ];
    figure(id, caption, plots)
}
