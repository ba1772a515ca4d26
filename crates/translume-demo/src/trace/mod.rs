//! `translume trace`: a scene by paths of light, as the truth that pictures are held against.

mod subject;

pub use subject::{Body, Subject};

use crate::cli;
use crate::error::Error;
use crate::picture::{Format, Output, Picture};
use crate::progress;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use translume_reference::path::{Closed, Estimate, PathTracer, Shape};
use web_time::Instant;

/// Paths a pixel and channel that find out where further ones are needed; a pixel learns from its neighbours too.
const PILOT: u32 = 8;

/// Paths a pixel and channel between two estimates.
const PASS: u32 = 4;

/// How often the picture is written while it grows.
const WRITES: Duration = Duration::from_secs(5);

/// When the work ends: whatever is reached first.
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// [`Estimate::noise`].
    pub noise: Option<f64>,
    /// Wall time; the pass that is under way then ends early.
    pub seconds: Option<f64>,
    /// Paths of an average pixel in each channel. Alone, every pixel gets as many.
    pub samples: Option<u32>,
    pub seed: u64,
    /// Ends the work as soon as it is set, whatever there is by then.
    pub stop: Option<&'a AtomicBool>,
}

/// How far the work has come.
pub struct Status<'a> {
    pub estimate: &'a Estimate,
    pub noise: f64,
    /// Paths of an average pixel in each channel.
    pub samples: u32,
}

/// Follows paths until a limit is reached or `proceed` returns `false`; it hears of every pass.
pub fn trace(
    subject: &Subject,
    limits: &Limits<'_>,
    mut proceed: impl FnMut(&Status<'_>) -> bool,
) -> Result<Estimate, Error> {
    let closed;
    let shape: &dyn Shape = match &subject.body {
        Body::Mesh(surface) => {
            closed = Closed::new(surface)?;
            &closed
        }
        Body::Ball(ball) => ball,
        Body::Block(block) => block,
    };
    let tracer = PathTracer::new(shape, subject.volume, &subject.lights)?;
    let mut trace = tracer.trace(subject.camera, limits.seed);
    let start = Instant::now();
    let is_stopped = || limits.stop.is_some_and(|stop| stop.load(Ordering::Relaxed));
    let in_time =
        || !is_stopped() && limits.seconds.is_none_or(|seconds| start.elapsed().as_secs_f64() < seconds);
    if limits.noise.is_some() || limits.seconds.is_some() {
        // A pilot that used up the time is the picture.
        if !(0..PILOT).all(|_| trace.pass(1, |_| in_time())) {
            return Ok(trace.estimate());
        }
        trace.focus();
    }
    let mut samples = 0;
    loop {
        let next = limits.samples.map_or(PASS, |most| PASS.min(most - samples));
        // The first pass cannot be cut short, or pixels would have no path at all.
        let whole = trace.pass(next, |_| samples == 0 && !is_stopped() || in_time());
        samples += next;
        let estimate = trace.estimate();
        let noise = estimate.noise();
        let is_enough = limits.noise.is_some_and(|enough| noise <= enough)
            || limits.samples.is_some_and(|most| samples >= most);
        if !proceed(&Status { estimate: &estimate, noise, samples }) || is_enough || !whole {
            return Ok(estimate);
        }
    }
}

pub fn run(arguments: &cli::Trace) -> Result<(), Error> {
    let limits = limits(arguments)?;
    let outputs = Outputs::new(arguments)?;
    let subject = Subject::from_scene(&arguments.scene, arguments.size)?;
    let bar = progress::bar("trace");
    let (start, mut written) = (Instant::now(), Instant::now());
    let (mut samples, mut failure) = (0, None);
    let estimate = trace(&subject, &limits, |status| {
        samples = status.samples;
        show(&bar, &limits, status, start.elapsed().as_secs_f64());
        if written.elapsed() > WRITES {
            failure = outputs.write(status.estimate).err();
            written = Instant::now();
        }
        failure.is_none()
    })?;
    bar.finish_and_clear();
    if let Some(failure) = failure {
        return Err(failure);
    }
    outputs.write(&estimate)?;
    progress::tell(&format!(
        "{}: {} × {} pixels, {samples} paths each, noise {:.2} %, in {:.1} s",
        arguments.scene.display(),
        estimate.width,
        estimate.height,
        100.0 * estimate.noise(),
        start.elapsed().as_secs_f64(),
    ));
    Ok(())
}

fn limits(arguments: &cli::Trace) -> Result<Limits<'static>, Error> {
    for (option, value) in [("--noise", arguments.noise), ("--seconds", arguments.seconds)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(Error::Option { option, problem: format!("{value} is not a positive number") });
        }
    }
    let cli::Trace { noise, seconds, samples, seed, .. } = *arguments;
    let is_endless = noise.is_none() && seconds.is_none() && samples.is_none();
    Ok(Limits { noise: if is_endless { Some(0.05) } else { noise }, seconds, samples, seed, stop: None })
}

/// The bar is the nearest end: noise falls with the square root of the work.
fn show(bar: &indicatif::ProgressBar, limits: &Limits<'_>, status: &Status<'_>, seconds: f64) {
    let shares = [
        limits.noise.map(|enough| (enough / status.noise).powi(2)),
        limits.seconds.map(|most| seconds / most),
        limits.samples.map(|most| f64::from(status.samples) / f64::from(most)),
    ];
    let share = shares.into_iter().flatten().fold(0.0, f64::max);
    bar.set_length(1000);
    bar.set_position((1000.0 * share.min(1.0)) as u64);
    bar.set_message(format!("noise {:.1} %", 100.0 * status.noise));
}

/// The files asked for.
struct Outputs {
    picture: Output,
    exposure: f32,
    error: Option<Output>,
    single: Option<Output>,
}

impl Outputs {
    fn new(arguments: &cli::Trace) -> Result<Self, Error> {
        let exr = |path: &Option<std::path::PathBuf>| path.as_deref().map(linear).transpose();
        Ok(Self {
            picture: Output::new(&arguments.output)?,
            exposure: arguments.exposure,
            error: exr(&arguments.stderr)?,
            single: exr(&arguments.single)?,
        })
    }

    fn write(&self, estimate: &Estimate) -> Result<(), Error> {
        let develop = self.picture.format.develop(self.exposure);
        let picture = Picture::from_samples(&samples(estimate), estimate.width as u32, 1, develop);
        self.picture.write(&[picture])?;
        for (output, values) in [(&self.error, &estimate.error), (&self.single, &estimate.single)] {
            if let Some(output) = output {
                output.write(&[plain(estimate, values)])?;
            }
        }
        Ok(())
    }
}

/// Radiance and coverage of every pixel.
pub fn samples(estimate: &Estimate) -> Vec<[f32; 4]> {
    let covered = estimate.radiance.iter().zip(&estimate.coverage);
    covered.map(|(rgb, coverage)| [rgb[0] as f32, rgb[1] as f32, rgb[2] as f32, *coverage as f32]).collect()
}

/// A file of numbers, which a tone mapper would spoil.
fn linear(path: &Path) -> Result<Output, Error> {
    let output = Output::new(path)?;
    if output.format == Format::Exr {
        return Ok(output);
    }
    Err(Error::Output { path: path.to_owned(), problem: "numbers that are compared need an .exr".to_owned() })
}

fn plain(estimate: &Estimate, values: &[[f64; 3]]) -> Picture {
    let pixels = values.iter().map(|rgb| rgb.map(|c| c as f32)).collect();
    Picture { width: estimate.width as u32, height: estimate.height as u32, pixels }
}
