//! Diagnostics: what is wrong, where, and what to do about it.
//!
//! Every reader of the workspace reports errors as a [`Diagnostic`]: a [`Code`], a [`Location`], a problem, a help text and
//! the errors that caused it. The code names the kind of fault, and has a page in [`codes`] that explains it. A front end
//! decides how to show it: [`Diagnostic::render`] formats it for a person in two parts, with the line of the file if there
//! is one, and [`serde`] writes it as JSON for a program.
//!
//! ```
//! use pinswitch_diagnostic::{Diagnostic, Location, codes};
//!
//! let text = "[segment]\ngrooves = 40\n";
//! let location = Location::in_text("mine.toml", text, 20..22).with_field("segment.grooves", "40");
//! let problem = "grooves overlap (0.781 mm apart, at least 1.450 mm needed)";
//! let diagnostic = Diagnostic::new(codes::GROOVES_OVERLAP, problem)
//!     .with_location(location)
//!     .with_help("lower it to 20");
//! assert_eq!(
//!     diagnostic.render("error"),
//!     "error: mine.toml:2:11: segment.grooves = 40: grooves overlap (0.781 mm apart, at least 1.450 mm needed) \
//!      [grooves-overlap]\n\
//!      \x20 2 | grooves = 40\n\
//!      \x20   |           ^^\n\
//!      \x20 help: lower it to 20"
//! );
//! ```
//!
//! Text from untrusted files may contain control characters that move the cursor of a terminal or change its title.
//! [`neutral`] makes them visible. All text that a person sees passes through it.

mod code;
pub mod codes;
mod diagnostic;
mod excerpt;
mod location;
mod neutral;
mod number;

pub use code::{Area, Code};
pub use diagnostic::{Change, Diagnostic};
pub use excerpt::excerpt;
pub use location::{Location, Snippet};
pub use neutral::{neutral, neutral_line};
pub use number::short_number;
