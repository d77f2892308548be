//! Reports as data, written as HTML pages, JSON and CSV.
//!
//! A [`Report`] consists of sections with paragraphs, equations, tables, claims, figures and a 3-D view of a robot. It is
//! written as an HTML page that needs neither a network nor other files. The page is suitable for light and dark screens,
//! narrow and wide screens, and paper. The page rounds numbers. The JSON and CSV files contain the same numbers with all
//! digits.
//!
//! ```
//! use gelenk_report::{Block, Claim, Criterion, Report, Section, text};
//!
//! let error = 0.004; // rad, measured
//! let tracks = Claim::new("tracking", "The feed-forward follows the trajectory.")
//!     .criterion(Criterion::at_most("largest error", error, 0.01, "rad"))
//!     .flipped_by("a friction model with the wrong sign");
//! let report = Report::new("Feed-forward on a simulated arm").section(
//!     Section::new("claims", "Claims")
//!         .block(text("The torque is $u = B^{-1}(M \\ddot y + k - q)$."))
//!         .block(Block::Claims(vec![tracks])),
//! );
//! let page = report.html()?;
//! assert!(page.contains("<math") && page.contains("holds"));
//! # Ok::<(), gelenk_report::ReportError>(())
//! ```

mod block;
mod claim;
mod data;
mod diagram;
mod equation;
mod error;
mod files;
mod inline;
mod number;
mod output;
mod page;
mod pattern;
mod plot;
mod report;
mod scene;
mod style;
mod table;

pub use block::{Block, Section, plain, text};
pub use claim::{Bound, Claim, Criterion, Verdict};
pub use equation::Equation;
pub use error::ReportError;
pub use inline::{Inline, code};
pub use pattern::Pattern;
pub use plot::{Axis, Figure, Marks, Plot, Series};
pub use report::Report;
pub use scene::{Scene, SceneBody, SceneFrame, SceneJoint, SceneKind, SceneMotion, SceneRod, SceneSymbol};
pub use table::{Cell, Column, Table};
