//! The browser's picture against that of the same program without a browser.

use std::path::Path;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::browser::{Browser, driver};
use super::server::{Message, Server};
use crate::process::{Failure, Outcome, cargo, run as run_command};

/// How far pictures may be apart: root mean square over the mean. Both are drawn by the browser's software driver, and were less than 0.001 %
/// apart, or 0.6 % where the mesh had ragged ears, most of it one pixel at the outline. Other rasterisers have other outlines and edges of
/// shadows: 8 %.
const TOLERANCE: f64 = 0.01;
/// A lamp that is brighter by so much must be noticed.
const BROKEN_GAIN: &str = "1.03";
/// Of a browser on a busy processor.
const PATIENCE: Duration = Duration::from_secs(300);
/// How long we listen before we see whether the browser is still there.
const NAP: Duration = Duration::from_secs(1);

pub fn run(pages: &Path) -> Outcome {
    let file = pages.join("native.f32");
    let native = ["run", "--release", "-p", "translume-web", "--"];
    run_command(cargo(&native).arg(&file).env("VK_DRIVER_FILES", driver()?))?;
    let bytes = std::fs::read(&file)
        .map_err(|error| Failure::new(format!("{} cannot be read: {error}", file.display())))?;
    let native = radiance(&bytes)?;

    let server = Server::new(0, pages.to_owned())?;
    let (sender, messages) = channel();
    let sender = Mutex::new(sender);
    let hear = move |message| {
        // Nobody listens to what comes late.
        let _ = sender.lock().map(|sender| sender.send(message));
    };
    let address = server.address("minimal.html?report");
    // It serves until the program ends.
    std::thread::spawn(move || server.serve(&hear));

    let distance = |address: &str| -> Result<f64, Failure> {
        let message = heard(address, pages, &messages)?;
        let field = |name: &str| {
            message.fields.iter().find(|(field, _)| field == name).map_or("?", |(_, value)| value)
        };
        println!(
            "{}: first picture after {} ms, {} ms a frame",
            field("adapter"),
            whole(field("load_ms")),
            whole(field("frame_ms"))
        );
        apart(&radiance(&message.body)?, &native)
    };
    let right = distance(&address)?;
    println!("browser against native: {:.3} % apart (at most {:.0} %)", 100.0 * right, 100.0 * TOLERANCE);
    let broken = distance(&format!("{address}&gain={BROKEN_GAIN}"))?;
    println!("with a lamp {BROKEN_GAIN} times as bright: {:.3} %", 100.0 * broken);
    if right > TOLERANCE {
        return Err(Failure::new("the browser draws another picture; open both pages and look"));
    }
    if broken <= TOLERANCE {
        return Err(Failure::new("the comparison did not notice a brighter lamp"));
    }
    Ok(())
}

/// What the page at the address has drawn.
fn heard(address: &str, pages: &Path, messages: &Receiver<Message>) -> Result<Message, Failure> {
    let mut browser = Browser::open(address, &pages.join("profile"))?;
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        match messages.recv_timeout(NAP) {
            Ok(message) if message.to == "drawn" => return Ok(message),
            Ok(message) => {
                let words = String::from_utf8_lossy(&message.body).into_owned();
                return Err(Failure::new(format!("the page {}: {words}", message.to)));
            }
            Err(_) if !browser.runs() => {
                return Err(Failure::new("the browser ended before the page was drawn"));
            }
            Err(_) => {}
        }
    }
    Err(Failure::new(format!("{address}: nothing was drawn within {} s", PATIENCE.as_secs())))
}

/// Red, green and blue of every pixel, from four floats each.
fn radiance(bytes: &[u8]) -> Result<Vec<[f32; 3]>, Failure> {
    let (pixels, rest) = bytes.as_chunks::<16>();
    if pixels.is_empty() || !rest.is_empty() {
        return Err(Failure::new(format!("{} bytes are no picture", bytes.len())));
    }
    let value =
        |pixel: &[u8; 16], k: usize| f32::from_le_bytes(std::array::from_fn(|byte| pixel[4 * k + byte]));
    Ok(pixels.iter().map(|pixel| [0, 1, 2].map(|k| value(pixel, k))).collect())
}

/// Root mean square of the difference over the mean of what is right.
fn apart(found: &[[f32; 3]], right: &[[f32; 3]]) -> Result<f64, Failure> {
    let (found, right) = (found.as_flattened(), right.as_flattened());
    let count = right.len() as f64;
    let mean = right.iter().copied().map(f64::from).sum::<f64>() / count;
    if found.len() != right.len() {
        return Err(Failure::new("the pictures have different sizes; build both from the same source"));
    }
    if found.iter().any(|value| !value.is_finite()) || mean <= 0.0 || !mean.is_finite() {
        return Err(Failure::new("a picture is black or holds values that are no numbers"));
    }
    let square = |(a, b): (&f32, &f32)| (f64::from(*a) - f64::from(*b)).powi(2);
    Ok((found.iter().zip(right).map(square).sum::<f64>() / count).sqrt() / mean)
}

/// Without digits that mean nothing.
fn whole(number: &str) -> &str {
    number.split('.').next().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_relative_to_the_mean() {
        let right = [[1.0, 2.0, 3.0], [0.0, 0.0, 6.0]];
        assert_eq!(apart(&right, &right).unwrap(), 0.0);
        let brighter = right.map(|pixel| pixel.map(|c| 1.03 * c));
        // 0.03 · √(50/6) / 2
        assert!((apart(&brighter, &right).unwrap() - 0.0433).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let right = [[1.0; 3]; 2];
        assert!(apart(&[[f32::NAN; 3]; 2], &right).is_err());
        assert!(apart(&right[..1], &right).is_err());
        assert!(apart(&right, &[[0.0; 3]; 2]).is_err());
        assert!(radiance(&[0; 15]).is_err() && radiance(&[]).is_err());
        let bytes: Vec<u8> = [1.0_f32, 2.0, 3.0, 1.0].into_iter().flat_map(f32::to_le_bytes).collect();
        assert_eq!(radiance(&bytes).unwrap(), [[1.0, 2.0, 3.0]]);
    }
}
