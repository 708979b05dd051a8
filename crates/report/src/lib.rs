//! The folder of a run as one HTML page: the result in words, the body in three dimensions, plots, tables. The page holds
//! everything it needs (three.js and uPlot among it, see `vendor/`) and opens without a network.
//!
//! ```no_run
//! let page = nastic_report::html("out/cantilever".as_ref())?;
//! std::fs::write("out/cantilever/report.html", page)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Shapes are those of the surface alone, positions and fields rounded to 65535 steps of their range
//! (an error of at most 8e-6 of it); the VTU files beside the page have all digits.

mod carried;
mod case_name;
mod cloud;
mod compare;
pub mod console;
pub mod csv;
mod encode;
mod error;
mod figure;
mod fit_page;
mod folder;
mod frame;
pub mod gains;
mod html;
mod identification;
mod iterates;
mod number;
mod obstacles_label;
mod on_trial;
mod pace;
mod page;
mod plain_page;
mod plots;
pub mod record;
mod scene;
mod spectrum;
mod standing;
mod status;
mod summary;
mod surface;
mod sweep;
mod tables;

pub use case_name::case_name;
pub use cloud::cloud;
pub use compare::{CompareRequest, ComparedPart, compare};
pub use error::ReportError;
pub use figure::{FIELD, FigureRequest, Frames, figure, tension, uniform_field, with_marks};
pub use iterates::{Iterates, IteratesError};
pub use number::duration;
pub use obstacles_label::obstacles_label;
pub use on_trial::OnTrial;
pub use pace::Pace;
pub use page::{FILE, html};
pub use standing::Standing;
pub use status::bar;
pub use sweep::{SweepAxis, SweepRow, SweepTable};
