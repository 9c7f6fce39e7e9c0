//! Import of friction measurements: any laboratory's file becomes a plateau table or a log.
//!
//! 1. [`import`] reads the bytes of one or several files with a [`Map`] of decisions that were
//!    taken before.
//! 2. The [`Import`] contains an [`Understanding`]: what was recognised, ignored and left open.
//! 3. Without open questions it also contains the [`Output`] and a complete map, which gives the
//!    same output again.
//!
//! The crate reads no files. `model/doc/import.md` describes it for users.
//!
//! # Examples
//!
//! ```
//! use pinswitch_import::{Map, Output, Source, import};
//!
//! let text = "Last [kg];F_heben [N];F_senken [N]\n1,5;19,25;11,2\n";
//! let import = import(&[Source::new("rig.csv", text.as_bytes())], &Map::default())?;
//! let Some(Output::Table(csv)) = import.output else { return Err("a question is open".into()) };
//! assert_eq!(csv.lines().nth(1), Some("1.5 kg,plain,,1500,14.709975,concentric,19.25"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![warn(clippy::disallowed_methods)]

mod clock;
mod column;
mod columns;
mod computed;
mod conversion;
mod decimal;
mod dialect;
mod direction_words;
mod encoding;
mod file;
mod header;
mod import;
mod log;
mod lvm;
mod map;
mod map_file;
mod name;
mod number;
mod parquet_file;
mod pattern;
mod quantity;
mod question;
mod recording;
#[cfg(test)]
mod round_trip;
mod sheet;
mod table;
mod times;
mod trials;
#[cfg(test)]
mod two_readings;
mod understanding;
mod unit;
mod vocabulary;
mod workbook;

pub use clock::DateOrder;
pub use decimal::Decimal;
pub use dialect::Delimiter;
pub use import::{Import, Output, Source, import, import_with_pattern};
pub use log::LogColumns;
pub use map::{Kind, Map, SCHEMA};
pub use map_file::map_schema;
pub use number::DecimalSign;
pub use pattern::Pattern;
pub use quantity::Quantity;
pub use question::{Answer, Question};
pub use understanding::{ColumnUnderstanding, FileUnderstanding, Understanding};
pub use unit::{Dimension, Unit};
