//! The command line of pinswitch; see [`pinswitch_cli::run`].

use std::process::ExitCode;

fn main() -> ExitCode {
    pinswitch_cli::run()
}
