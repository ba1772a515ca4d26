//! The program `translume`: look at translucent models in a window, render, inspect and measure them.
#![cfg_attr(target_arch = "wasm32", allow(dead_code, reason = "a page has no command line"))]

mod albedo;
mod app;
mod canvas;
mod cli;
mod develop;
mod environment;
mod error;
mod files;
mod film;
mod framing;
mod gpu;
mod inspect;
mod model;
mod motion;
mod overlay;
mod paint;
mod picture;
mod profile;
mod progress;
#[cfg(not(target_arch = "wasm32"))]
mod render;
#[cfg(not(target_arch = "wasm32"))]
mod report;
mod scene;
mod setup;
mod studio;
mod timings;
mod trace;

use std::process::ExitCode;

/// The program as a page of a browser.
#[cfg(target_arch = "wasm32")]
#[must_use]
pub fn main() -> ExitCode {
    app::web::start();
    ExitCode::SUCCESS
}

/// The program, by its command line.
#[cfg(not(target_arch = "wasm32"))]
#[must_use]
pub fn main() -> ExitCode {
    use clap::Parser as _;
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let result = match cli::Arguments::parse().command {
        None => app::run(None),
        Some(cli::Command::View(arguments)) => app::run(arguments.name.as_deref()),
        Some(cli::Command::Render(arguments)) => render::run(&arguments),
        Some(cli::Command::Inspect(arguments)) => inspect::run(&arguments),
        Some(cli::Command::Profile(arguments)) => profile::run(&arguments),
        Some(cli::Command::Trace(arguments)) => trace::run(&arguments),
        Some(cli::Command::Report(arguments)) => report::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            progress::tell(&format!("translume: {error}"));
            ExitCode::from(2)
        }
    }
}
