//! The command line of pinswitch; see [`pinswitch::run`].

use std::process::ExitCode;

fn main() -> ExitCode {
    pinswitch::run()
}
