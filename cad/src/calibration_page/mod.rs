//! The page a reader follows from data to conclusion: `report.html` and its plots.

mod page;
mod plots;

pub use page::page;
pub use plots::{Plot, PlotFailure, plots};
