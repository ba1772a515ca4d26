//! `translume`: render, inspect and measure translucent models.

mod canvas;
mod cli;
mod environment;
mod error;
mod framing;
mod gpu;
mod inspect;
mod model;
mod motion;
mod picture;
mod profile;
mod progress;
mod render;
mod report;
mod scene;
mod studio;
mod timings;
mod trace;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let result = match cli::Arguments::parse().command {
        cli::Command::Render(arguments) => render::run(&arguments),
        cli::Command::Inspect(arguments) => inspect::run(&arguments),
        cli::Command::Profile(arguments) => profile::run(&arguments),
        cli::Command::Trace(arguments) => trace::run(&arguments),
        cli::Command::Report(arguments) => report::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            progress::tell(&format!("translume: {error}"));
            ExitCode::from(2)
        }
    }
}
