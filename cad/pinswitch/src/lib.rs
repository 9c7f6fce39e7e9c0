//! pinswitch turns a layout of pins into printable parts of a friction switch, with the friction curve they will have,
//! and keeps that curve honest with measured data.
//!
//! This crate re-exports the crates of the workspace under short names. All but [`batch`] and [`slicer`] read no file, clock or environment: text and numbers
//! go in, and values, text and bytes come out.
//!
//! | crate | what it knows |
//! | --- | --- |
//! | [`friction`] | what the tendon lies on, the laws that predict its friction, the paper's numbers, the search for layouts |
//! | [`calibration`] | tables of measured plateaus, logs, the effects that the paper's model may lack, fits, verdicts |
//! | [`simulation`] | a rig whose truth is known: tables and logs with chosen effects, the power of a plan |
//! | [`solid`] | exact solids of lines and arcs, their meshes, what makes a mesh valid, STL, 3MF, STEP and DXF |
//! | [`switch`] | a switch: its configuration, its rules, its parts, built once, and every document made from them |
//! | [`batch`] | sweeps of many switches, made in parallel and taken up where they stopped |
//! | [`slicer`] | what an installed slicer says of printing them |
//! | [`report`] | figures of curves, layouts and calibrations, as SVG and HTML |
//!
//! A configuration becomes a design, the design parts, and the parts files. Everything that a configuration does not say
//! has a default with a reason:
//!
//! ```
//! use pinswitch::friction::{Transition, PredictionStatus};
//! use pinswitch::solid::validity::{Expectation, examine};
//! use pinswitch::switch::{built::Built, config, design::Design, formats, prediction::Prediction, set::Set};
//!
//! // Four pins, 11.9 degrees apart, in a shell whose wall is a little thicker than usual.
//! let text = "[layout]\npins = [5, 7, 9, 11]\n[shell]\nwall_mm = 6.5\n[friction]\npoints = 21\n";
//! let (configuration, _) = config::read(text, "four.toml")?;
//! let design = Design::new(configuration)?; // or one error: field, value, bound and remedy
//!
//! // Its curve says which law it comes from and how far to trust it.
//! let prediction = Prediction::of(&design);
//! let curve = &prediction.curve;
//! assert_eq!(curve.status, PredictionStatus::Interpolated);
//! let transition = Transition::of(curve).ok_or("it never switches")?;
//! assert!(transition.low_n < transition.threshold_n && transition.threshold_n < transition.high_n);
//!
//! // Its parts are built and meshed once; a mesh that is not valid would be an error.
//! let built = Built::new(design)?;
//! let shell = &built.printed()[0];
//! let expected = Expectation { bodies: Some(1), ..Expectation::default() };
//! assert!(examine(&shell.print_mesh, &expected).is_valid());
//!
//! // Every format takes them from there. Writing the bytes is left to you.
//! let set = Set::new(&built, &prediction, &formats::named(&["stl", "step"])?)?;
//! assert!(set.files.iter().any(|file| file.name == "shell.step"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! More to start from is in `cad/examples`: a part of one's own, the curve of any layout, the check of an STL, a
//! calibration, an effect of one's own, a sweep in code. `CONTRIBUTING.md` is the map of the repository.

pub use pinswitch_batch as batch;
pub use pinswitch_calibration as calibration;
pub use pinswitch_diagnostic as diagnostic;
pub use pinswitch_drafting as drafting;
pub use pinswitch_friction as friction;
pub use pinswitch_report as report;
pub use pinswitch_simulation as simulation;
pub use pinswitch_slicer as slicer;
pub use pinswitch_solid as solid;
pub use pinswitch_switch as switch;
