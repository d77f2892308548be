//! Plots of motions, for the examples.

use gelenk_runtime::trajectory::{Sample, Trajectory};
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;
use std::path::PathBuf;

const SIZE: (u32, u32) = (900, 900);
const COLORS: [RGBColor; 6] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 39, 40),
    RGBColor(44, 160, 44),
    RGBColor(148, 103, 189),
    RGBColor(255, 127, 14),
    RGBColor(90, 90, 90),
];

/// Where plots go.
pub struct Folder(PathBuf);

/// One line of a panel.
pub struct Line {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

impl Folder {
    /// The first argument, or `gelenk-examples` in the folder for temporary files.
    pub fn from_arguments() -> Result<Self, Box<dyn Error>> {
        let folder = std::env::args_os()
            .nth(1)
            .map_or_else(|| std::env::temp_dir().join("gelenk-examples"), PathBuf::from);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        Ok(Self(folder))
    }

    /// Positions, velocities and accelerations of a motion, one panel each.
    #[allow(dead_code, reason = "not every example plots motions")]
    pub fn plot<const N: usize>(
        &self,
        file: &str,
        title: &str,
        motion: &impl Trajectory<N>,
        names: [&str; N],
    ) -> Result<(), Box<dyn Error>> {
        let panel = |value: fn(&Sample<N>) -> [f64; N]| -> Vec<Line> {
            (0..N)
                .map(|i| Line {
                    name: names[i].to_owned(),
                    points: (0..=600)
                        .map(|k| motion.duration() * f64::from(k) / 600.0)
                        .map(|t| (t, value(&motion.sample(t))[i]))
                        .collect(),
                })
                .collect()
        };
        let panels = [
            ("position [rad]", panel(|s| s.positions)),
            ("velocity [rad/s]", panel(|s| s.velocities)),
            ("acceleration [rad/s²]", panel(|s| s.accelerations)),
        ];
        self.lines(file, title, &panels)
    }

    /// Panels of lines over time, one above the other.
    pub fn lines(&self, file: &str, title: &str, panels: &[(&str, Vec<Line>)]) -> Result<(), Box<dyn Error>> {
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            root.fill(&WHITE)?;
            let root = root.titled(title, ("sans-serif", 22))?;
            let areas = root.split_evenly((panels.len(), 1));
            for (area, (label, lines)) in areas.iter().zip(panels) {
                let all = || lines.iter().flat_map(|l| &l.points);
                let mut chart = ChartBuilder::on(area)
                    .margin(10)
                    .x_label_area_size(36)
                    .y_label_area_size(70)
                    .build_cartesian_2d(
                        beside(span(all().map(|p| p.0), 0.0)),
                        span(all().map(|p| p.1), 0.05),
                    )?;
                chart.configure_mesh().max_light_lines(0).x_desc("time [s]").y_desc(*label).draw()?;
                for (line, color) in lines.iter().zip(COLORS.iter().cycle()) {
                    let style = color.stroke_width(2);
                    chart
                        .draw_series(LineSeries::new(line.points.iter().copied(), style))?
                        .label(&line.name)
                        .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], style));
                }
                chart
                    .configure_series_labels()
                    .position(SeriesLabelPosition::UpperRight)
                    .background_style(WHITE.mix(0.8))
                    .border_style(BLACK.mix(0.3))
                    .draw()?;
            }
            root.present()?;
        }
        let path = self.0.join(file);
        gelenk_files::write_whole(&path, svg).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("  plot: {}", path.display());
        Ok(())
    }
}

/// With room for the names of the lines at the right.
fn beside(x: Range<f64>) -> Range<f64> {
    let room = 0.16 * (x.end - x.start);
    x.start..x.end + room
}

fn span(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let room = (margin * (high - low)).max(if high > low { 0.0 } else { 1e-3 });
    low - room..high + room
}
