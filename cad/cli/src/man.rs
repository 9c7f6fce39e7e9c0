//! `pinswitch man --out DIR`.

use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_mangen::Man;
use pinswitch_diagnostic::{Diagnostic, codes};
use pinswitch_switch::output::OutputFile;

use super::{Cli, Failure};
use crate::write::SetFolder;

/// Write the manual pages.
///
/// Writes pinswitch.1 and one page per command.
#[derive(Args, Debug)]
#[command(after_help = "Example: pinswitch man --out ~/.local/share/man/man1")]
pub(super) struct Arguments {
    /// Folder for the pages.
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pages = pages().map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?;
    SetFolder::lock(&arguments.out)?.replace(&pages)?;
    log::info!("{}: {} pages", arguments.out.display(), pages.len());
    Ok(())
}

/// Renders the page of the program and of each visible command.
fn pages() -> std::io::Result<Vec<OutputFile>> {
    let mut program = Cli::command().disable_help_subcommand(true);
    // Gives every command its full name, such as `pinswitch-generate`.
    program.build();
    let commands = program.get_subcommands().filter(|command| !command.is_hide_set());
    commands.chain([&program]).map(page).collect()
}

fn page(command: &clap::Command) -> std::io::Result<OutputFile> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    let mut bytes = Vec::new();
    Man::new(command.clone()).title(name.clone()).render(&mut bytes)?;
    Ok(OutputFile { name: format!("{name}.1"), bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_names_its_options() {
        let pages = pages().unwrap();
        let program = Cli::command();
        let visible = program.get_subcommands().filter(|command| !command.is_hide_set());
        let mut count = 1;
        for command in visible {
            let file = format!("pinswitch-{}.1", command.get_name());
            let page = pages.iter().find(|page| page.name == file).unwrap();
            let text = String::from_utf8(page.bytes.clone()).unwrap().replace('\\', "");
            for option in command.get_opts().filter_map(clap::Arg::get_long) {
                assert!(text.contains(&format!("--{option}")), "{file} lacks --{option}");
            }
            count += 1;
        }
        assert_eq!(pages.len(), count);
        assert!(pages.iter().any(|page| page.name == "pinswitch.1"));
    }
}
