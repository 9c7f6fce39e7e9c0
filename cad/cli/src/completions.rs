//! `pinswitch completions SHELL`.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, Failure, print_data};

/// Print the completion script of a shell.
#[derive(Args, Debug)]
#[command(
    after_help = "Example: pinswitch completions bash > ~/.local/share/bash-completion/completions/pinswitch"
)]
pub(super) struct Arguments {
    /// Shell that runs the script.
    shell: Shell,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "pinswitch", &mut script);
    print_data(&script)
}
