//! How long the stages of frames took, as a table.

use std::time::Duration;
use translume::{Clock, FrameTimings, Stage};

/// In Markdown: the mean and the longest of each stage over the frames in which it ran. A frame may be there more than once, as the
/// newest one whose timings were known.
pub fn table(frames: &[FrameTimings]) -> String {
    let mut frames = frames.to_vec();
    frames.dedup_by_key(|timings| timings.frame);
    let Some(newest) = frames.last() else {
        return "no timings: nothing was computed, or the driver returned no timestamps".to_owned();
    };
    let (heading, whole) = match newest.clock {
        Clock::Gpu => ("stage (GPU)", "all"),
        Clock::Wall => ("wall clock, no timestamps", "frame"),
    };
    let mut lines = vec![
        format!("| {heading} | frames | mean ms | longest ms |"),
        "| --- | --- | --- | --- |".to_owned(),
    ];
    for stage in Stage::ALL {
        let times: Vec<_> = frames.iter().filter_map(|timings| timings.stage(stage)).collect();
        if !times.is_empty() {
            lines.push(row(stage.name(), &times));
        }
    }
    lines.push(row(whole, &frames.iter().map(|timings| timings.total).collect::<Vec<_>>()));
    lines.join("\n")
}

/// Of at least one time.
fn row(name: &str, times: &[Duration]) -> String {
    let ms = |time: Duration| 1e3 * time.as_secs_f64();
    let mean = ms(times.iter().sum()) / times.len() as f64;
    let longest = ms(times.iter().max().copied().unwrap_or_default());
    format!("| {name} | {} | {mean:.3} | {longest:.3} |", times.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(frame: u64, gather: u64, scatter: Option<u64>) -> FrameTimings {
        let mut timings = FrameTimings { frame, clock: Clock::Gpu, ..Default::default() };
        timings.stages[Stage::Gather as usize] = Some(Duration::from_millis(gather));
        timings.stages[Stage::Scatter as usize] = scatter.map(Duration::from_millis);
        timings.total = Duration::from_millis(gather + scatter.unwrap_or(0));
        timings
    }

    #[test]
    fn stages_are_averaged_over_the_frames_they_ran_in() {
        let table = table(&[frame(1, 2, None), frame(1, 2, None), frame(3, 4, Some(10))]);
        let rows: Vec<_> = table.lines().skip(2).collect();
        let expected = [
            "| gather | 2 | 3.000 | 4.000 |",
            "| scatter | 1 | 10.000 | 10.000 |",
            "| all | 2 | 8.000 | 14.000 |",
        ];
        assert_eq!(rows, expected);
    }

    #[test]
    fn the_clock_is_named() {
        let wall = FrameTimings { frame: 1, total: Duration::from_millis(5), ..Default::default() };
        let by_wall = table(&[wall]);
        assert!(
            by_wall.contains("wall clock") && by_wall.ends_with("| frame | 1 | 5.000 | 5.000 |"),
            "{by_wall}"
        );
        assert!(!table(&[frame(1, 1, None)]).contains("wall"));
        assert!(table(&[]).starts_with("no timings"));
    }
}
