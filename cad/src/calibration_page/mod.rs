//! The page a reader follows from data to conclusion: `report.html` and its plots.

mod log_plot;
mod page;
mod plots;
mod published_page;

pub use log_plot::log_svg;
pub use page::page;
pub use plots::{Plot, PlotFailure, plots};
pub use published_page::{UNEXPLAINED, published_page, published_plot};
