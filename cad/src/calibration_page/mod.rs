//! The page a reader follows from data to conclusion: `report.html` and its plots.

mod log_plot;
mod page;
mod plots;

pub use log_plot::log_svg;
pub use page::page;
pub use plots::{Plot, PlotFailure, plots};
