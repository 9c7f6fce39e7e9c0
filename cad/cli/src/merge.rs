//! `pinswitch merge DIR…`.

use clap::Args;

use super::{Failure, print_json};
use pinswitch_batch::{Destination, MergeError, merge};

/// Join the shards of a batch: one table, plots and page for all, as if one machine had made them.
///
/// Shards that were written to one folder or bucket are merged there. Shards in several folders are merged into --out,
/// which gets tables, plots and page; the parts stay where they are. Gaps and overlaps are refused.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch merge out/sweep
  pinswitch merge node1/sweep node2/sweep --out out/sweep")]
pub(super) struct Arguments {
    /// Folders or object stores that hold finished shards.
    #[arg(required = true, value_name = "DIR|URL")]
    places: Vec<String>,
    /// Where the result goes [default: the place, if there is only one].
    #[arg(long, short, value_name = "DIR|URL")]
    out: Option<String>,
    /// Print the tally as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let open = |place: &String| Destination::open(place, ".partial-merge").map_err(Failure::bad_input);
    let out = match (&arguments.out, arguments.places.as_slice()) {
        (Some(out), _) => out,
        (None, [only]) => only,
        _ => return Err(Failure::bad_input("several places need --out, for the tables and the page of all")),
    };
    let places = arguments.places.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    let tally = merge(&places, &open(out)?).map_err(|e| match e {
        MergeError::Products(_) | MergeError::Destination(_) => Failure::failed(e),
        other => Failure::bad_input(other),
    })?;
    if arguments.json {
        print_json(&tally)?;
    }
    log::info!("{out}: {} variants made, {} refused, {} failed", tally.made, tally.refused, tally.failed);
    Ok(())
}
