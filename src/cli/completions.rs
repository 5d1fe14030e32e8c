//! `cityweld completions` and `cityweld man`: what shells and manuals ask of a program.

use anyhow::{Context, Result};
use clap::CommandFactory;

use super::args::{Args, CompletionsArgs, ManArgs};
use super::{Outcome, Session};

/// Words that a shell completes, on standard output.
pub fn completions(args: &CompletionsArgs, session: &Session) -> Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "cityweld", &mut script);
    session.voice.result(&String::from_utf8(script)?, None)?;
    Ok(Outcome::Good)
}

/// The manual page of the program, or of one command, on standard output; or a page for each in a folder.
pub fn man(args: &ManArgs, session: &Session) -> Result<Outcome> {
    let program = program();
    let Some(folder) = &args.output else {
        session.voice.result(&String::from_utf8(page(&program, args.command.as_deref())?)?, None)?;
        return Ok(Outcome::Good);
    };
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder: {}", folder.display()))?;
    let commands = program.get_subcommands().map(|command| Some(command.get_name().to_owned()));
    for command in std::iter::once(None).chain(commands) {
        let name = command.as_ref().map_or("cityweld.1".into(), |name| format!("cityweld-{name}.1"));
        let path = folder.join(name);
        std::fs::write(&path, page(&program, command.as_deref())?)
            .with_context(|| format!("cannot write the page: {}", path.display()))?;
    }
    session.voice.result(&format!("pages written to {}\n", folder.display()), Some(folder))?;
    Ok(Outcome::Good)
}

fn page(program: &clap::Command, command: Option<&str>) -> Result<Vec<u8>> {
    let described = match command {
        None => program,
        Some(name) => program.find_subcommand(name).with_context(|| format!("there is no command {name}"))?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(described.clone()).render(&mut page)?;
    Ok(page)
}

/// All commands with their full names.
fn program() -> clap::Command {
    let mut program = Args::command();
    program.build();
    program
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_and_a_completion_in_every_shell() {
        let program = program();
        for command in program.get_subcommands().map(clap::Command::get_name) {
            let page = String::from_utf8(page(&program, Some(command)).unwrap()).unwrap();
            assert!(page.contains("SYNOPSIS") && page.contains(&format!("cityweld\\-{command}")), "{command}");
        }
        for shell in <clap_complete::Shell as clap::ValueEnum>::value_variants() {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Args::command(), "cityweld", &mut script);
            assert!(String::from_utf8(script).unwrap().contains("--positions"), "{shell}");
        }
    }
}
