//! The program `orograph`: arguments in, exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(orograph::cli::run(std::env::args_os()))
}
