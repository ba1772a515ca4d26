//! The web page: the picture on its canvas, figures beside it, and both for whoever listens.
//!
//! The window hears `drawn`, whose detail holds `pixels` (a `Float32Array`: linear red, green, blue and coverage, row by row from the
//! top), `load_ms` (from the start of the program to the first picture) and `frame_ms` (of a frame whose lamp moves);
//! or `failed`, whose detail says why. `?gain=1.03` in the address makes the lamp brighter, for a test that must notice.

use crate::show::{Lamp, SIZE, Show, Target};
use js_sys::{Float32Array, Object, Promise, Reflect};
use std::error::Error;
use translume::{Gloss, readback, wgpu};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{CustomEvent, CustomEventInit, HtmlCanvasElement, Window};
use web_time::Instant;

/// Frames that are timed, one turn of the lamp.
const FRAMES: u32 = 48;

type Outcome<T> = Result<T, Box<dyn Error>>;

pub fn start() {
    console_error_panic_hook::set_once();
    spawn_local(async {
        if let Some(window) = web_sys::window()
            && let Err(error) = run(&window).await
        {
            let words = error.to_string();
            // A page without an element for words still has the event.
            let _ = write(&window, &words);
            let _ = tell(&window, "failed", &words.into());
        }
    });
}

async fn run(window: &Window) -> Outcome<()> {
    let start = Instant::now();
    let canvas = canvas(window)?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let surface = instance.create_surface(wgpu::SurfaceTarget::Canvas(canvas))?;
    let options = wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
    let adapter = instance.request_adapter(&options).await.map_err(|error| {
        format!("this browser offers no WebGPU ({error}): take a newer one, or one that has it turned on")
    })?;
    let mut show = Show::new(&adapter).await?;
    let mut stage = Stage::new(&show, &adapter, &surface)?;
    let lamp = Lamp { gain: gain(window)?, ..Lamp::default() };
    let picture = show.picture(&lamp)?;
    let pixels = readback::texture_async::<[f32; 4]>(&show.device, &show.queue, &picture, 0).await?;
    let load_ms = 1e3 * start.elapsed().as_secs_f64();

    let start = Instant::now();
    for frame in 1..=FRAMES {
        next_frame(window).await?;
        let turn = frame as f32 / FRAMES as f32;
        stage.draw(&mut show, &Lamp { turn, ..lamp }, &surface)?;
    }
    // The last frame has ended once something after it can be read.
    readback::texture_async::<[f32; 4]>(&show.device, &show.queue, &picture, 0).await?;
    let frame_ms = 1e3 * start.elapsed().as_secs_f64() / f64::from(FRAMES);

    write(window, &format!("First picture after {load_ms:.0} ms, {frame_ms:.1} ms a frame."))?;
    let detail = Object::new();
    let fields = [
        ("pixels", Float32Array::from(pixels.as_flattened()).into()),
        ("load_ms", load_ms.into()),
        ("frame_ms", frame_ms.into()),
    ];
    for (name, value) in fields {
        Reflect::set(&detail, &name.into(), &value).map_err(words)?;
    }
    tell(window, "drawn", &detail)
}

/// The canvas as something to draw into.
struct Stage {
    target: Target,
    format: wgpu::TextureFormat,
}

impl Stage {
    fn new(show: &Show, adapter: &wgpu::Adapter, surface: &wgpu::Surface<'_>) -> Outcome<Self> {
        let mut config =
            surface.get_default_config(adapter, SIZE, SIZE).ok_or("the adapter cannot draw on the canvas")?;
        // The canvas takes sRGB; the view encodes what is drawn.
        let format = config.format.add_srgb_suffix();
        config.view_formats.push(format);
        surface.configure(&show.device, &config);
        Ok(Self { target: show.target(format, Gloss::Rough(0.35)), format })
    }

    fn draw(&mut self, show: &mut Show, lamp: &Lamp, surface: &wgpu::Surface<'_>) -> Outcome<()> {
        let (wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame)) =
            surface.get_current_texture()
        else {
            // A hidden page has none; the next frame may.
            return Ok(());
        };
        let view = wgpu::TextureViewDescriptor { format: Some(self.format), ..Default::default() };
        show.draw(lamp, &mut self.target, &frame.texture.create_view(&view))?;
        show.queue.present(frame);
        Ok(())
    }
}

fn canvas(window: &Window) -> Outcome<HtmlCanvasElement> {
    let element = window.document().and_then(|document| document.get_element_by_id("canvas"));
    let canvas = element.and_then(|element| element.dyn_into().ok());
    canvas.ok_or_else(|| "the page has no canvas of the id `canvas`; add one".into())
}

/// How much brighter the lamp is to be.
fn gain(window: &Window) -> Outcome<f32> {
    let search = window.location().search().map_err(words)?;
    let text = search.trim_start_matches('?').split('&').find_map(|pair| pair.strip_prefix("gain="));
    Ok(text
        .map(str::parse)
        .transpose()
        .map_err(|_| "gain in the address must be a number, as ?gain=1.03")?
        .unwrap_or(1.0))
}

async fn next_frame(window: &Window) -> Outcome<()> {
    let promise = Promise::new(&mut |resolve, _| {
        // A window that is going away has no next frame, and nobody who waits for it.
        let _ = window.request_animation_frame(&resolve);
    });
    JsFuture::from(promise).await.map(drop).map_err(words)
}

/// Under the canvas.
fn write(window: &Window, text: &str) -> Outcome<()> {
    let element = window.document().and_then(|document| document.get_element_by_id("figures"));
    element.ok_or("the page has no element of the id `figures`; add one")?.set_text_content(Some(text));
    Ok(())
}

fn tell(window: &Window, name: &str, detail: &JsValue) -> Outcome<()> {
    let init = CustomEventInit::new();
    init.set_detail(detail);
    let event = CustomEvent::new_with_event_init_dict(name, &init).map_err(words)?;
    window.dispatch_event(&event).map(drop).map_err(words)
}

fn words(error: JsValue) -> Box<dyn Error> {
    format!("{error:?}").into()
}
