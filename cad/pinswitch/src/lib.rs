//! pinswitch generates the printable parts of a friction switch, predicts its friction curve, and
//! calibrates the prediction with measured data.
//!
//! A friction switch is a segment of a pulley with steel pins in a silicone layer on a rigid shell. At low load a coated
//! tendon slides on the pins; at high load the pins sink, and it slides on the silicone with several times the friction.
//!
//! This crate re-exports the crates of the workspace under short names, without a command line. All but [`batch`] and
//! [`slicer`] read no file, clock or environment: text and numbers go in; values, text and bytes come out.
//!
//! | crate | content |
//! | --- | --- |
//! | [`friction`] | contacts, pin patterns, the friction laws, the published numbers |
//! | [`calibration`] | tables of measured plateaus, segmentation of logs, effects, fits, verdicts |
//! | [`import`] | any laboratory's file, read into a plateau table or a log |
//! | [`simulation`] | a simulated rig: tables and logs with chosen effects, the power of a plan |
//! | [`formula`] | the formula language of user-defined effects and sweep constraints |
//! | [`solid`] | exact solids of lines and arcs, meshes, their examination, and their files: STL, 3MF, GLB, STEP and DXF |
//! | [`drafting`] | technical drawings of solids, as SVG, PDF and DXF |
//! | [`switch`] | configurations, rules, parts, sets and their documents, the search for designs |
//! | [`batch`] | sweeps of many switches, made in parallel and resumed after an interruption |
//! | [`slicer`] | print time and filament from an installed slicer |
//! | [`robot`] | models of a switch for robot simulators: MuJoCo, URDF, FMI |
//! | [`report`] | figures of curves, layouts and calibrations as SVG and HTML |
//! | [`diagnostic`] | errors with a location, a problem and a help |
//!
//! A configuration becomes a design, the design becomes parts, and the parts become files. A
//! parameter that the configuration does not set has its default:
//!
//! ```
//! use pinswitch::friction::{Transition, PredictionStatus};
//! use pinswitch::solid::validity::{Expectation, examine};
//! use pinswitch::switch::{built::Built, config, design::Design, formats, prediction::Prediction, set::Set};
//!
//! // Four pins, 11.9 degrees apart, in a shell with a thinner wall than the default.
//! let text = "[layout]\npins = [5, 7, 9, 11]\n[shell]\nwall_mm = 6.5\n[friction]\npoints = 21\n";
//! let (configuration, _) = config::read(text, "four.toml")?;
//! let design = Design::new(configuration)?; // or one error: field, value, bound and remedy
//!
//! // The curve names its law and has a prediction status.
//! let prediction = Prediction::of(&design);
//! let curve = &prediction.curve;
//! assert_eq!(curve.status, PredictionStatus::Interpolated);
//! let transition = Transition::of(curve).ok_or("it never switches")?;
//! assert!(transition.low_n < transition.threshold_n && transition.threshold_n < transition.high_n);
//!
//! // Each part is built, meshed and examined once.
//! let built = Built::new(design)?;
//! let shell = &built.printed()[0];
//! let expected = Expectation { bodies: Some(1), ..Expectation::default() };
//! assert!(examine(&shell.print_mesh, &expected).is_valid());
//!
//! // Each format makes files from the built parts; the caller writes them.
//! let set = Set::new(&built, &prediction, &formats::named(&["stl", "step"])?)?;
//! assert!(set.files.iter().any(|file| file.name == "shell.step"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `cad/examples` in the repository contains complete programs; `CONTRIBUTING.md` describes the
//! crates.

pub use pinswitch_batch as batch;
pub use pinswitch_calibration as calibration;
pub use pinswitch_diagnostic as diagnostic;
pub use pinswitch_drafting as drafting;
pub use pinswitch_formula as formula;
pub use pinswitch_friction as friction;
pub use pinswitch_import as import;
pub use pinswitch_report as report;
pub use pinswitch_robot as robot;
pub use pinswitch_simulation as simulation;
pub use pinswitch_slicer as slicer;
pub use pinswitch_solid as solid;
pub use pinswitch_store as store;
pub use pinswitch_switch as switch;
