//! Progress for people who wait.

use crate::model::Watch;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A line to the person at the terminal; results go to standard output, everything else here.
#[allow(clippy::print_stderr, reason = "the one place that speaks to the terminal")]
pub fn tell(line: &str) {
    eprintln!("{line}");
}

/// A line of results.
#[allow(clippy::print_stdout, reason = "the one place that prints results")]
pub fn print(line: &str) {
    println!("{line}");
}

/// A bar with a name. It hides itself where nobody watches.
pub fn bar(name: &str) -> ProgressBar {
    let bar = ProgressBar::new(1);
    // A template that does not parse would only lose its looks.
    if let Ok(style) = ProgressStyle::with_template("{prefix:>8} {wide_bar} {msg} {elapsed}") {
        bar.set_style(style);
    }
    bar.set_prefix(name.to_owned());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// Work behind a bar.
pub fn during<T>(name: &str, work: impl FnOnce(Watch<'_>) -> T) -> T {
    let bar = bar(name);
    let result = work(&|progress| {
        bar.set_message(progress.stage);
        if let Some(total) = progress.total {
            bar.set_length(total as u64);
            bar.set_position(progress.done as u64);
        }
        true
    });
    bar.finish_and_clear();
    result
}
