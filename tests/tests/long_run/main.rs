//! A host that runs for long: a hundred bodies that deform in every frame, without growth, without allocations while recording, and without a
//! word from the driver's validation. `TRANSLUME_FRAMES` says for how many frames, 1,000 for what is promised.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a failure here is a failed test")]
#![allow(clippy::print_stderr, reason = "measured figures, for `--nocapture`")]

mod complaints;
mod recording;

use allocation_counter::measure;
use complaints::Complaints;
use std::time::Instant;
use translume::{
    AmbientLight, Body, BodyDescriptor, Config, Deformation, DirectionalLight, Frame, Light, Lighting,
    Medium, ShadowOptions, Translume, Transport, wgpu,
};
use translume_mesh::{Atlas, AtlasOptions, MorphTarget, Warp, builtin};

const BODIES: usize = 100;
/// So many frames at least make what is made once.
const WARM_UP: usize = 8;

struct Host {
    instance: wgpu::Instance,
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
}

impl Host {
    /// With the validation layer where there is one.
    fn new() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle().with_env();
        descriptor.flags = wgpu::InstanceFlags::VALIDATION;
        // Where no window is, OpenGL has complaints that are not about us.
        descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
        let instance = wgpu::Instance::new(descriptor);
        let adapter = pollster::block_on(wgpu::util::initialize_adapter_from_env(&instance, None))
            .or_else(|_| {
                pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            })
            .unwrap();
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).unwrap();
        let name = adapter.get_info().name;
        Self { instance, device, queue, name }
    }

    /// Everything that wgpu keeps for us: buffers, textures, groups, pipelines.
    fn objects(&self) -> usize {
        let report = self.instance.generate_report().unwrap();
        let hub = &report.hub;
        let counts = [
            &hub.buffers,
            &hub.textures,
            &hub.texture_views,
            &hub.bind_groups,
            &hub.bind_group_layouts,
            &hub.pipeline_layouts,
            &hub.compute_pipelines,
            &hub.render_pipelines,
            &hub.shader_modules,
            &hub.query_sets,
            &hub.samplers,
        ];
        counts.iter().map(|count| count.num_kept_from_user).sum()
    }
}

/// Resident bytes of this process, where Linux tells.
fn resident() -> f64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    4096.0 * statm.split_whitespace().nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0.0)
}

fn lights(time: f32) -> [Light; 2] {
    let sun = DirectionalLight { to_light: [time.cos(), 1.0, time.sin()], ..Default::default() };
    [Light::Directional(sun), Light::Ambient(AmbientLight { shadow: true, ..Default::default() })]
}

fn bodies(host: &Host, translume: &Translume) -> Vec<Body> {
    let mut mesh = builtin::sphere([0.0; 3], 20.0, 1);
    let position_deltas = mesh.positions.iter().map(|p| [0.0, 0.5 * p[1], 0.0]).collect();
    mesh.targets = vec![MorphTarget { name: "tall".to_owned(), position_deltas }];
    let atlas = Atlas::build(&mesh, &AtlasOptions { size: 24, ..AtlasOptions::default() }, |_| true).unwrap();
    let body = |k: usize| {
        let descriptor = BodyDescriptor {
            medium: [Medium::JADE, Medium::SKIN1, Medium::WAX][k % 3],
            mm_per_unit: 1.0,
            shares_scratch: k.is_multiple_of(2),
            transport: if k % 25 == 1 { Transport::Boundary } else { Transport::Classic },
            shadows: ShadowOptions {
                resolution: 32,
                area_points: 4,
                directions: 8,
                directions_per_frame: 8,
                direction_resolution: 16,
                ..Default::default()
            },
            ..BodyDescriptor::new(&mesh, &atlas)
        };
        translume.create_body(&host.device, &descriptor).unwrap()
    };
    (0..BODIES).map(body).collect()
}

#[test]
fn a_thousand_frames_of_a_hundred_bodies() {
    let complaints = Complaints::listen();
    let host = Host::new();
    let translume = Translume::new(&host.device, &Config::default()).unwrap();
    let mut bodies = bodies(&host, &translume);
    let frames: usize =
        std::env::var("TRANSLUME_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(40);
    let mut settled = None;
    let mut looks = Vec::new();
    let start = Instant::now();
    for number in 0..WARM_UP + frames {
        let time = 0.05 * number as f32;
        let lights = lights(time);
        let mut encoder = host.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for (k, body) in bodies.iter_mut().enumerate() {
            let phase = time + k as f32;
            body.prepare(
                &host.device,
                &host.queue,
                &Frame {
                    deformation: Deformation::Morph(&[phase.sin()]),
                    warp: Warp { twist: phase.cos(), ..Warp::default() },
                    lighting: Lighting::Lights(&lights),
                    ..Frame::default()
                },
            )
            .unwrap();
            assert!(!body.pending().is_empty());
        }
        let before = host.objects();
        let mut work = 0;
        let heap =
            measure(|| bodies.iter_mut().for_each(|body| work += body.encode(&mut encoder).dispatches));
        let made = host.objects() - before;
        host.queue.submit([encoder.finish()]);
        host.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        if number >= WARM_UP {
            assert_eq!(made, 0, "frame {number} makes objects of wgpu while recording");
            let now = (host.objects(), translume.memory(), work);
            assert_eq!(
                *settled.get_or_insert(now),
                now,
                "frame {number}: objects, bytes of the GPU, dispatches"
            );
            looks.push(resident());
            if number == WARM_UP {
                eprintln!(
                    "{work} dispatches; {} allocations on the heap while recording, {} kept",
                    heap.count_total, heap.count_current
                );
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let (first, last) = (looks[looks.len() / 4], looks[looks.len() - 1]);
    eprintln!(
        "[{}] {frames} frames of {BODIES} bodies in {seconds:.0} s; {:.1} MB of the GPU; {:.1} then {:.1} MB resident",
        host.name,
        translume.memory() as f64 / 1e6,
        first / 1e6,
        last / 1e6
    );
    complaints.expect_none();
}
