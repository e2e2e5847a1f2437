//! Standard output and standard error. Nothing here panics, whatever has become of the two.

use std::io::{self, Write};
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::error::ErrorKind;

/// Prints to standard output what a command is called for. A reader that has gone away is no error.
///
/// # Errors
/// If the text cannot be written, for want of space for example.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Prints to standard output what also stands in files. The files are whole by then: if the text cannot be
/// written, that is a warning and the command goes on.
pub fn tell(text: &str) {
    if let Err(error) = print(text) {
        log::warn!("{}", one_line(&error));
    }
}

/// Writes a line to standard error.
pub fn note(line: &str) {
    // One write, so that lines of several programs do not mix. Where standard error itself is full or gone
    // there is nobody left to tell, and no work is to be lost for it.
    let _ = io::stderr().lock().write_all(format!("{line}\n").as_bytes());
}

/// Writes an error to standard error, in one line; the exit code.
pub fn report(error: &anyhow::Error) -> ExitCode {
    note(&format!("error: {}", one_line(error)));
    ExitCode::from(2)
}

/// Prints clap's message: help and version as they are, an error in one line with clap's tip if it has one.
pub fn usage_error(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            written(error.print()).map_or_else(|error| report(&error), |()| ExitCode::SUCCESS)
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // Goes to standard error, as a note does.
            let _ = error.print();
            ExitCode::from(2)
        }
        _ => {
            note(&usage_line(&error.to_string()));
            ExitCode::from(2)
        }
    }
}

/// The outcome of writing to standard output.
fn written(result: io::Result<()>) -> Result<()> {
    match result {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result.context("cannot write to standard output"),
    }
}

/// Clap's message, its list of missing arguments and the tip, in one line; not the usage.
fn usage_line(text: &str) -> String {
    let lines = text.lines().map(str::trim).take_while(|line| !ends_message(line));
    // Nobody who mistypes an option means to pass it as a value.
    let parts: Vec<_> = lines.filter(|line| !line.is_empty() && !line.starts_with("tip: to pass")).collect();
    format!("{} (see --help)", parts.join("; ").replace(":; ", ": "))
}

/// Whether a line of clap's is the first after its message and tip.
fn ends_message(line: &str) -> bool {
    line.starts_with("Usage:") || line.starts_with("For more information")
}

/// An error with all its causes in one line, without repeating what a cause already says.
pub fn one_line(error: &anyhow::Error) -> String {
    let mut line = String::new();
    for cause in error.chain() {
        let text = cause.to_string();
        if !line.contains(&text) {
            let separator = if line.is_empty() { "" } else { ": " };
            line = format!("{line}{separator}{text}");
        }
    }
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}
