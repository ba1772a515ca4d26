//! How long the stages take: timestamps at the ends of passes, read back some frames later.
//!
//! A recording borrows one of a few slots. The callback of its read-back holds the slot, so a slot is free once its submission has ended
//! or its encoder was dropped; a host that submits late or never only goes without timings. Timestamps stand at the bounds of passes
//! alone, as WebGPU's `timestamp-query` has them.

use crate::Work;
use crate::stages::{Stage, StageSet};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use web_time::Instant;

const STAGES: usize = Stage::ALL.len();
/// Recordings in flight that are timed: hosts keep two or three frames in flight.
const SLOTS: usize = 4;
/// One before the first pass, and beginning and end of every stage.
const QUERIES: usize = 1 + 2 * STAGES;

/// Where a duration comes from.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::Clock;
///
/// if let Some(timings) = body.timings() {
///     let of = if timings.clock == Clock::Gpu { "of the GPU" } else { "until it was heard of" };
///     println!("{:?} {of}", timings.total);
/// }
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Timestamps of the GPU.
    Gpu,
    /// The CPU's clock, where the device has no [`wgpu::Features::TIMESTAMP_QUERY`]: from `encode` until the host learns that the
    /// submission has ended. That holds whatever else the host did in between, and there is no time for each stage.
    #[default]
    Wall,
}

/// How long a frame took.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::Stage;
///
/// body.set_timings(true);
/// // some frames later
/// if let Some(scatter) = body.timings().and_then(|timings| timings.stage(Stage::Scatter)) {
///     println!("scatter: {scatter:?}");
/// }
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameTimings {
    /// Which frame: how many times the body had been prepared since timings were turned on, from 1.
    pub frame: u64,
    /// What measured it.
    pub clock: Clock,
    /// From the beginning of the first stage to the end of the last. Of a frame encoded in several parts, the sum over the parts by
    /// the GPU's clock, and the longest by the wall clock.
    pub total: Duration,
    /// From the end of the stage before to the end of this one, so that they add up to `total`; in the order of [`Stage::ALL`]. `None`
    /// for a stage that had nothing to do, and for all by the wall clock.
    pub stages: [Option<Duration>; STAGES],
}

impl FrameTimings {
    /// How long the stage took, if it ran.
    #[must_use]
    pub fn stage(&self, stage: Stage) -> Option<Duration> {
        self.stages[stage as usize]
    }

    /// Takes in another part of the same frame.
    fn join(&mut self, other: &Self) {
        self.total = match self.clock {
            Clock::Gpu => self.total + other.total,
            Clock::Wall => self.total.max(other.total),
        };
        for (mine, theirs) in self.stages.iter_mut().zip(other.stages) {
            *mine = mine.or(theirs);
        }
    }
}

/// The newest frame whose timings have arrived.
#[derive(Clone, Default)]
struct Newest(Arc<Mutex<Option<FrameTimings>>>);

impl Newest {
    fn get(&self) -> Option<FrameTimings> {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Submissions may end in another order than frames were prepared in.
    fn deliver(&self, timings: FrameTimings) {
        match &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(known) if known.frame > timings.frame => (),
            Some(known) if known.frame == timings.frame => known.join(&timings),
            known => *known = Some(timings),
        }
    }
}

/// Times the frames of a body.
pub(crate) struct Timer {
    /// Empty where the device has no timestamps.
    slots: Vec<Arc<Slot>>,
    /// Nanoseconds per tick.
    period: f32,
    frame: u64,
    newest: Newest,
}

/// Timestamps of one recording.
struct Slot {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_back: wgpu::Buffer,
}

impl Timer {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let has_timestamps = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let slots = if has_timestamps { SLOTS } else { 0 };
        Self {
            slots: (0..slots).map(|_| Arc::new(Slot::new(device))).collect(),
            period: queue.get_timestamp_period(),
            frame: 0,
            newest: Newest::default(),
        }
    }

    pub fn next_frame(&mut self) {
        self.frame += 1;
    }

    pub fn newest(&self) -> Option<FrameTimings> {
        self.newest.get()
    }

    /// Where a recording that begins now leaves its timestamps; `None` while all slots are in flight.
    fn marks(&mut self) -> Option<Marks> {
        // Nobody else holds a free slot.
        let free = self.slots.iter_mut().find_map(|slot| Arc::get_mut(slot).is_some().then_some(&*slot))?;
        Some(Marks { slot: Arc::clone(free), ran: StageSet::default() })
    }

    /// Asks for the times of what was recorded, for when it has run.
    fn collect(&self, encoder: &wgpu::CommandEncoder, recorded: Recorded) {
        let (frame, newest) = (self.frame, self.newest.clone());
        match recorded {
            Recorded::Marks(Marks { slot, ran }) => {
                let period = self.period;
                let read_back = slot.read_back.clone();
                encoder.map_buffer_on_submit(&read_back, wgpu::MapMode::Read, .., move |mapped| {
                    // A lost device has no times.
                    if mapped.is_ok() {
                        let timings = slot.read(ran, period, frame);
                        timings.into_iter().for_each(|timings| newest.deliver(timings));
                    }
                });
            }
            Recorded::Since(start) => encoder.on_submitted_work_done(move || {
                let total = start.elapsed();
                newest.deliver(FrameTimings { frame, total, ..Default::default() });
            }),
        }
    }
}

enum Recorded {
    Marks(Marks),
    Since(Instant),
}

impl Slot {
    fn new(device: &wgpu::Device) -> Self {
        let buffer = |usage| {
            let label = Some("timestamps");
            let size = size_of::<[u64; QUERIES]>() as u64;
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("stages"),
                ty: wgpu::QueryType::Timestamp,
                count: QUERIES as u32,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            read_back: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
        }
    }

    /// Reads the mapped buffer and gives it back to the GPU.
    fn read(&self, ran: StageSet, period: f32, frame: u64) -> Option<FrameTimings> {
        let ticks =
            self.read_back.get_mapped_range(..).ok().map(|bytes| bytemuck::pod_read_unaligned(&bytes));
        self.read_back.unmap();
        evaluate(&ticks?, ran, period, frame)
    }
}

/// From ticks to durations. `None` where the driver wrote no timestamps, which then are 0 (some resolve them too early), or set the
/// clock back.
fn evaluate(ticks: &[u64; QUERIES], ran: StageSet, period: f32, frame: u64) -> Option<FrameTimings> {
    let duration = |ticks: u64| Duration::from_nanos((ticks as f64 * f64::from(period)).round() as u64);
    // Metal leaves that of an empty pass at 0.
    let start = if ticks[0] > 0 { ticks[0] } else { ticks[1] };
    let mut timings = FrameTimings { frame, clock: Clock::Gpu, ..Default::default() };
    let mut last = start;
    let stages = Stage::ALL.into_iter().filter(|stage| ran.contains(*stage));
    for (stage, pair) in stages.zip(ticks[1..].chunks_exact(2)) {
        let end = pair[1];
        if start == 0 || end < start {
            return None;
        }
        // Where passes overlap, a later one may end first.
        timings.stages[stage as usize] = Some(duration(end.saturating_sub(last)));
        last = last.max(end);
    }
    timings.total = duration(last - start);
    Some(timings)
}

/// Timestamps of a recording: the start, and two for each stage that ran, in the order in which stages run.
pub(crate) struct Marks {
    slot: Arc<Slot>,
    ran: StageSet,
}

impl Marks {
    /// An empty pass before the first.
    ///
    /// Mesa's software driver (22.3) takes a timestamp only when the next one is asked for. So those at the beginnings of passes come at
    /// their ends, and are asked for only to have the ones before them taken: at the end of the stage before, and here at the start.
    fn start(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("start"),
            timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                query_set: &self.slot.queries,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: None,
            }),
        });
    }

    /// The queries of the stage's next pass. Each pass marks the end of its stage, so that the last one's mark stays.
    fn pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        stage: Stage,
    ) -> (&wgpu::QuerySet, Option<u32>, Option<u32>) {
        if self.ran.is_empty() {
            self.start(encoder);
        }
        let is_first = !self.ran.contains(stage);
        self.ran.set(stage, true);
        let end = 2 * self.ran.len();
        (&self.slot.queries, is_first.then_some(end - 1), Some(end))
    }
}

/// What is being recorded.
pub(crate) struct Recording<'a> {
    pub work: Work,
    timer: Option<&'a mut Timer>,
    marks: Option<Marks>,
    start: Option<Instant>,
}

impl<'a> Recording<'a> {
    pub fn begin(mut timer: Option<&'a mut Timer>) -> Self {
        let marks = timer.as_mut().and_then(|timer| timer.marks());
        let by_wall = timer.as_ref().is_some_and(|timer| timer.slots.is_empty());
        Self { work: Work::default(), timer, marks, start: by_wall.then(Instant::now) }
    }

    pub fn compute_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        stage: Stage,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, beginning_of_pass_write_index, end_of_pass_write_index) =
            self.marks.as_mut()?.pass(encoder, stage);
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index,
            end_of_pass_write_index,
        })
    }

    pub fn render_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        stage: Stage,
    ) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, beginning_of_pass_write_index, end_of_pass_write_index) =
            self.marks.as_mut()?.pass(encoder, stage);
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index,
            end_of_pass_write_index,
        })
    }

    /// After the last pass. What recorded nothing has no times.
    pub fn end(self, encoder: &mut wgpu::CommandEncoder) -> Work {
        let recorded = match (self.marks, self.start) {
            (Some(marks), _) if !marks.ran.is_empty() => {
                let (slot, count) = (&*marks.slot, 1 + 2 * marks.ran.len());
                encoder.resolve_query_set(&slot.queries, 0..count, &slot.resolved, 0);
                let size = u64::from(count) * u64::from(wgpu::QUERY_SIZE);
                encoder.copy_buffer_to_buffer(&slot.resolved, 0, &slot.read_back, 0, size);
                Some(Recorded::Marks(marks))
            }
            (_, Some(start)) if self.work != Work::default() => Some(Recorded::Since(start)),
            _ => None,
        };
        if let (Some(timer), Some(recorded)) = (self.timer, recorded) {
            timer.collect(encoder, recorded);
        }
        self.work
    }
}

#[cfg(test)]
mod tests;
