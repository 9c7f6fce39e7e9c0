//! `pinswitch merge DIR…`.

use clap::Args;
use pinswitch_batch::{Destination, merge};

use crate::write::lock_policy;
use pinswitch_diagnostic::{Diagnostic, codes};

use super::{Failure, print_json};

/// Join the shards of a batch.
///
/// The table, the plots and the page are those of a batch on one machine. Shards in one folder or bucket are merged there. Shards in several folders are merged into --out, which gets the
/// table, the plots and the page; the parts stay in their folders. Gaps and overlaps are refused.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch merge out/sweep
  pinswitch merge node1/sweep node2/sweep --out out/sweep")]
pub(super) struct Arguments {
    /// Folders or object stores with finished shards.
    #[arg(required = true, value_name = "DIR|URL")]
    places: Vec<String>,
    /// Folder or object store for the result [default: that of the shards, if it is one].
    #[arg(long, short, value_name = "DIR|URL")]
    out: Option<String>,
    /// Print the tally as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let open = |place: &String| {
        let destination = Destination::open(place, ".partial-merge").map_err(Failure::bad_input)?;
        Ok::<_, Failure>(destination.with_lock_policy(lock_policy()))
    };
    let out = match (&arguments.out, arguments.places.as_slice()) {
        (Some(out), _) => out,
        (None, [only]) => only,
        _ => {
            return Err(Failure::bad_input(
                Diagnostic::new(codes::USAGE, "--out is missing")
                    .with_help("give --out DIR to merge several places"),
            ));
        }
    };
    let places = arguments.places.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    let tally = merge(&places, &open(out)?)
        .map_err(|e| if e.is_bad_input() { Failure::bad_input(e) } else { Failure::failed(e) })?;
    if arguments.json {
        print_json(&tally)?;
    }
    log::info!("{out}: {}", tally.summary());
    Ok(())
}
