//! The command line of pinswitch; see [`pinswitch::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    pinswitch::cli::run()
}
