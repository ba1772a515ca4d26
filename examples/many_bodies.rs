//! A hundred bodies that all deform, within a budget: pipelines, depth maps and lists are shared, each has two levels of detail, and what is
//! out of sight costs nothing.
//!
//! `cargo run --release -p translume-examples --example many_bodies` writes `out/many_bodies.png` and says what memory it takes and how
//! long frames last.

#![allow(clippy::print_stdout, reason = "a program talks to its terminal")]

use std::error::Error;
use std::time::Instant;
use translume::{
    AmbientLight, BodyDescriptor, CompositeView, Config, Deformation, DirectionalLight, Frame, Gloss, Levels,
    Light, Lighting, Medium, ShadowOptions, Translume, View, wgpu,
};
use translume_examples::{Host, Picture, camera};
use translume_mesh::{Atlas, AtlasOptions, builtin, warp::Warp};

const SIDE: usize = 10;
const FRAMES: usize = 3;
const BUDGET: u64 = 512 << 20;
const PIXELS: [u32; 2] = [640, 400];

/// One thing in the scene: its levels, and a view of each for the composite.
struct Thing {
    levels: Levels,
    views: Vec<CompositeView>,
    model: [[f32; 4]; 4],
    phase: f32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let host = Host::new()?;
    let picture = Picture::new(&host, PIXELS);
    let camera = camera([420.0, 560.0, 1000.0], [0.0, 20.0, 30.0], picture.aspect());
    let view = View { camera, pixels: PIXELS };

    // Once: one mesh with two atlases, a hundred things. A budget that does not suffice is an error of `create_body` or `prepare`.
    let translume = Translume::new(&host.device, &Config { memory: Some(BUDGET) })?;
    let mesh = builtin::creature_with(4_000);
    let atlas = |size| Atlas::build(&mesh, &AtlasOptions { size, ..Default::default() }, |_| true);
    let atlases = [atlas(96)?, atlas(48)?];
    let composite = translume.composite(&host.device, Picture::TARGET);
    let media = [Medium::JADE, Medium::WAX, Medium::SKIN1, Medium::WHOLEMILK];
    let mut things = Vec::new();
    for k in 0..SIDE * SIDE {
        let body = |atlas| {
            let descriptor = BodyDescriptor {
                medium: media[k % media.len()],
                mm_per_unit: 0.3,
                shares_scratch: true,
                shadows: ShadowOptions { resolution: 256, ..ShadowOptions::default() },
                ..BodyDescriptor::new(&mesh, atlas)
            };
            translume.create_body(&host.device, &descriptor)
        };
        let levels = Levels::new(vec![body(&atlases[0])?, body(&atlases[1])?]);
        let views = levels.bodies().iter().map(|body| composite.view(&host.device, body)).collect();
        let [x, z] = [k % SIDE, k / SIDE].map(|k| 90.0 * (k as f32 - 0.5 * (SIDE - 1) as f32));
        let mut model = Frame::default().model;
        (model[3][0], model[3][2]) = (x, z);
        things.push(Thing { levels, views, model, phase: 0.37 * k as f32 });
    }

    // Each frame.
    let sun =
        DirectionalLight { to_light: [-0.5, 0.5, -0.6], irradiance: [3.5, 3.2, 2.8], ..Default::default() };
    let sky = AmbientLight { radiance: [0.08, 0.09, 0.11], ..Default::default() };
    let lights = [Light::Directional(sun), Light::Ambient(sky)];
    let mut counts = [0; 3];
    for number in 0..FRAMES {
        let start = Instant::now();
        counts = [0; 3];
        let mut drawn = Vec::new();
        let mut encoder = host.encoder();
        for thing in &mut things {
            // Neither prepared nor encoded, a thing keeps its last light: so hide what is out of sight, or freeze what may stand still.
            let Some(body) = thing.levels.pick(&view) else {
                counts[2] += 1;
                continue;
            };
            let time = 0.2 * number as f32 + thing.phase;
            body.prepare(
                &host.device,
                &host.queue,
                &Frame {
                    model: thing.model,
                    deformation: Deformation::Morph(&[0.5 - 0.5 * time.cos()]),
                    warp: Warp { twist: 0.4 * time.sin(), ..Default::default() },
                    lighting: Lighting::Lights(&lights),
                    ..Default::default()
                },
            )?;
            body.encode(&mut encoder);
            let picked = thing.levels.picked();
            counts[picked] += 1;
            let body = &thing.levels.bodies()[picked];
            let view = &mut thing.views[picked];
            view.prepare(&host.device, &host.queue, body, &camera, Gloss::Rough(0.4));
            drawn.push(&thing.views[picked]);
        }
        {
            let mut pass = picture.pass(&mut encoder);
            drawn.iter().for_each(|view| composite.draw(&mut pass, view));
        }
        host.queue.submit([encoder.finish()]);
        host.device.poll(wgpu::PollType::wait_indefinitely())?;
        println!("frame {number}: {:.0} ms", 1e3 * start.elapsed().as_secs_f64());
    }
    let [fine, coarse, hidden] = counts;
    let megabytes = translume.memory() as f64 / 1e6;
    println!(
        "{fine} bodies with the larger atlas, {coarse} with the smaller, {hidden} out of sight; {megabytes:.0} MB"
    );
    println!("wrote {}", picture.save(&host, "many_bodies")?.display());
    Ok(())
}
