//! Standard output and error lines.

use std::io::{self, Write};

use std::process::ExitCode;

use anyhow::Result;
use clap::error::ErrorKind;

/// Prints to standard output. A reader that has gone away is no error.
pub fn print(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => Ok(result?),
    }
}

/// Prints clap's message: help and version as they are, an error in one line with clap's tip if it has one.
pub fn usage_error(error: &clap::Error) -> ExitCode {
    let asked_for = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
    if asked_for || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        // A reader that has gone away is no error.
        let _ = error.print();
        return if asked_for { ExitCode::SUCCESS } else { ExitCode::from(2) };
    }
    let text = error.to_string();
    // The message, its list of missing arguments and the tip; not the usage and the hint at --help.
    let lines = text.lines().map(str::trim).take_while(|line| !ends_message(line));
    let parts: Vec<_> = lines.filter(|line| !line.is_empty()).collect();
    eprintln!("{} (see --help)", parts.join("; "));
    ExitCode::from(2)
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
