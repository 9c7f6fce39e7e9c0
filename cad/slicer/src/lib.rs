//! Asks an installed `PrusaSlicer` how long a switch prints, and how much filament it takes (cad/doc/slicing.md).
//!
//! The program is found by [`find`], its settings are written by itself ([`Slicer::prepared`]), and each file that it slices
//! comes back as a [`PrintEstimate`]; [`Slicing`] holds those of a set. G-code stays in a folder that goes away: it holds time
//! stamps, and is made for no printer in particular.

mod estimate;
mod run;
mod settings;
mod slicing;

pub use estimate::PrintEstimate;
pub use run::{PROGRAM_VARIABLE, PreparedSlicer, Slicer, SlicerError, find};
pub use settings::PrintSettings;
pub use slicing::{SETTINGS_FILE, SLICING_FILE, SlicedFile, Slicing};
