//! The least of Translume in a browser: a lamp behind a creature of jade, on a canvas.
//!
//! `cargo xtask web` builds the page and serves it. Natively the same program leaves the same picture in a file, as
//! `cargo xtask web --test` compares the two: `cargo run --release -p translume-web -- FILE` writes linear red, green, blue and coverage
//! of every pixel, row by row from the top, as 32-bit floats, the least significant byte first.

#[cfg(target_arch = "wasm32")]
mod page;
mod show;

#[cfg(target_arch = "wasm32")]
fn main() {
    page::start();
}

#[cfg(not(target_arch = "wasm32"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    use show::{Lamp, Show};
    use translume::{readback, wgpu};
    use web_time::Instant;

    let file = std::env::args().nth(1).ok_or("name the file that is to hold the picture")?;
    let start = Instant::now();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let mut show = pollster::block_on(Show::new(&adapter))?;
    let picture = show.picture(&Lamp::default())?;
    let pixels = readback::texture::<[f32; 4]>(&show.device, &show.queue, &picture, 0)?;
    std::fs::write(&file, bytemuck::cast_slice::<_, u8>(&pixels))?;
    say(&format!("{}: first picture after {:.2} s", adapter.get_info().name, start.elapsed().as_secs_f64()));
    Ok(())
}

#[cfg(not(target_arch = "wasm32"))]
#[allow(clippy::print_stdout, reason = "a program talks to its terminal")]
fn say(line: &str) {
    println!("{line}");
}
