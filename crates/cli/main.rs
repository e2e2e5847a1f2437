//! The command line of evigrid.
//!
//! Exit codes: 0 fine, 1 a check found problems or a comparison found something worse, 2 bad usage or bad
//! input. Results go to files and standard output, everything else to standard error.
#![warn(clippy::print_stderr)]

mod args;
mod build_info;
mod check;
mod compare;
mod methods;
mod metrics;
mod output;
mod progress;
mod recorder;
mod reproduce;
mod run;
mod score;
mod sweep;
mod synth;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn"))
        .format_timestamp(None)
        .format_target(false)
        .init();
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => return output::usage_error(&error),
    };
    let result = match args.command {
        Command::Run(args) if !args.sweeps.is_empty() => sweep::around(&args).map(|()| ExitCode::SUCCESS),
        Command::Run(args) => run::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Sweep(args) => sweep::sweep(&args).map(|()| ExitCode::SUCCESS),
        Command::Score(args) => score::score(&args).map(|()| ExitCode::SUCCESS),
        Command::Compare(args) => compare::compare(&args),
        Command::Check(args) => check::check(&args),
        Command::Reproduce(args) => reproduce::reproduce_all(&args).map(|()| ExitCode::SUCCESS),
        Command::Synth(args) => synth::synth(&args).map(|()| ExitCode::SUCCESS),
        Command::Methods => methods::methods().map(|()| ExitCode::SUCCESS),
        Command::Metrics => metrics::metrics().map(|()| ExitCode::SUCCESS),
    };
    result.unwrap_or_else(|error| output::report(&error))
}
