//! How long pictures take.

use super::super::worker::Shown;
use eframe::egui;
use egui_plot::{Corner, Legend, Line, Plot, PlotPoints};
use std::collections::VecDeque;
use translume::{FrameTimings, Stage};
use web_time::Instant;

/// Pictures that are remembered.
const KEPT: usize = 120;

/// Stages worth a line.
const SLOW: [Stage; 3] = [Stage::Shadow, Stage::Gather, Stage::Scatter];

/// The last pictures' times.
#[derive(Default)]
pub struct Frames {
    took: VecDeque<f32>,
    timings: VecDeque<FrameTimings>,
    /// How many there were in all, and when the first and the last came.
    count: u32,
    came: Option<[Instant; 2]>,
}

impl Frames {
    pub fn add(&mut self, shown: &Shown) {
        keep(&mut self.took, 1e3 * shown.took.as_secs_f32());
        let now = Instant::now();
        if self.came.is_none() {
            log::info!("the first picture is there");
        }
        self.came = Some([self.came.map_or(now, |[first, _]| first), now]);
        self.count += 1;
        // What did nothing anew has the timings of the frame before.
        let newest = self.timings.back().map(|timings| timings.frame);
        if let Some(timings) = shown.timings.filter(|timings| newest != Some(timings.frame)) {
            keep(&mut self.timings, timings);
        }
    }

    /// Median time of a picture, ms.
    pub fn median(&self) -> Option<f32> {
        quantile(self.took.iter().copied(), 0.5)
    }

    /// Pictures a second, in the log.
    pub fn tell(&self) {
        if let (Some([first, last]), Some(median)) = (self.came, self.median()) {
            let (count, seconds) = (self.count, last.duration_since(first).as_secs_f32());
            let rate = (count - 1) as f32 / seconds.max(1e-3);
            log::info!("{count} pictures in {seconds:.1} s: {rate:.1} a second, median {median:.0} ms");
        }
    }

    pub fn show(&self, ui: &mut egui::Ui) {
        Plot::new("frames")
            .height(120.0)
            .include_y(0.0)
            .show_x(false)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_scroll(false)
            .y_axis_label("ms")
            .legend(Legend::default().position(Corner::LeftTop).text_style(egui::TextStyle::Small))
            .show(ui, |plot| {
                for stage in SLOW {
                    let times = self.timings.iter().map(|timings| timings.stage(stage).unwrap_or_default());
                    plot.line(line(stage.name(), times.map(|time| 1e3 * time.as_secs_f64())));
                }
            });
        egui::Grid::new("stages").num_columns(3).striped(true).show(ui, |ui| {
            ui.strong("stage");
            ui.strong("median ms");
            ui.strong("95 % ms");
            ui.end_row();
            for stage in Stage::ALL {
                let times = || {
                    let stages = self.timings.iter().filter_map(|timings| timings.stage(stage));
                    stages.map(|time| 1e3 * time.as_secs_f32())
                };
                row(ui, stage.name(), times);
            }
            row(ui, "whole picture", || self.took.iter().copied());
        });
    }
}

fn line(name: &str, times: impl Iterator<Item = f64>) -> Line<'_> {
    Line::new(name, times.enumerate().map(|(k, ms)| [k as f64, ms]).collect::<PlotPoints<'_>>())
}

fn row<I: Iterator<Item = f32>>(ui: &mut egui::Ui, name: &str, times: impl Fn() -> I) {
    if let (Some(median), Some(most)) = (quantile(times(), 0.5), quantile(times(), 0.95)) {
        ui.label(name);
        ui.monospace(format!("{median:8.2}"));
        ui.monospace(format!("{most:8.2}"));
        ui.end_row();
    }
}

fn keep<T>(queue: &mut VecDeque<T>, value: T) {
    if queue.len() == KEPT {
        queue.pop_front();
    }
    queue.push_back(value);
}

fn quantile(values: impl Iterator<Item = f32>, share: f32) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values.get((share * (values.len().max(1) - 1) as f32).round() as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_of_the_sorted_values() {
        let values = || [5.0, 1.0, 4.0, 2.0, 3.0].into_iter();
        assert_eq!((quantile(values(), 0.5), quantile(values(), 0.95)), (Some(3.0), Some(5.0)));
        assert_eq!(quantile(std::iter::empty(), 0.5), None);
    }
}
