//! Print time and filament of a switch, estimated with an installed `PrusaSlicer`
//! (cad/doc/slicing.md).
//!
//! [`find`] locates the program. [`Slicer::prepared`] runs it to write its settings, and
//! [`PreparedSlicer::slice`] runs it to return a [`PrintEstimate`] for each file. [`Slicing`]
//! contains the estimates of a set. G-code is written to a temporary folder and deleted, because it
//! contains time stamps and is not suitable for a particular printer.
//!
//! ```
//! use pinswitch_slicer::{GcodeError, PrintEstimate};
//!
//! let gcode = "; filament used [mm] = 1221.19\n; filament used [g] = 3.05\n\
//!              ; estimated printing time (normal mode) = 29m 42s\n";
//! let estimate = PrintEstimate::from_gcode(gcode)?;
//! assert_eq!((estimate.print_minutes, estimate.filament_g), (29.7, 3.05));
//! # Ok::<(), GcodeError>(())
//! ```

mod bounded;
mod estimate;
mod run;
mod settings;
mod slicing;

pub use bounded::{RunLimits, supervise};
pub use estimate::{GcodeError, PrintEstimate};
pub use run::{LIMIT_VARIABLE, PROGRAM_VARIABLE, PreparedSlicer, Slicer, SlicerError, find};
pub use settings::PrintSettings;
pub use slicing::{SETTINGS_FILE, SLICING_FILE, SlicedFile, Slicing};
