//! Irradiance that the host supplies.

use translume::{DirectionalLight, Frame, Light, Lighting, Stage, wgpu};
use translume_tests::{Fixture, Pose, creature, gpu, sphere};
use wgpu::BufferUsages;

fn sun(x: f32) -> [Light; 1] {
    [Light::Directional(DirectionalLight { to_light: [x, 0.8, 0.6], ..Default::default() })]
}

fn host_buffer(size: u64, usage: BufferUsages) -> wgpu::Buffer {
    gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("irradiance of the host"),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// What a body gathered, in a buffer of the host's.
fn copied(fixture: &Fixture) -> wgpu::Buffer {
    let from = fixture.body.outputs().irradiance;
    let buffer = host_buffer(from.size(), BufferUsages::COPY_SRC | BufferUsages::COPY_DST);
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, &buffer, 0, from.size());
    gpu().queue.submit([encoder.finish()]);
    buffer
}

fn supplied(buffer: &wgpu::Buffer) -> Frame<'_> {
    Frame { lighting: Lighting::Irradiance(buffer), ..Frame::default() }
}

#[test]
fn a_copy_of_what_was_gathered_scatters_alike() {
    let [mut first, mut second] = [(); 2].map(|()| Fixture::new(&creature(), |_| ()));
    let lights = sun(0.4);
    let lit = Frame { lighting: Lighting::Lights(&lights), ..Frame::default() };
    first.run(&lit);
    let buffer = copied(&first);
    second.run(&supplied(&buffer));
    assert_eq!(first.exitance(), second.exitance(), "[{}]", gpu().adapter_name);
    assert_eq!(first.irradiance(), second.irradiance(), "[{}]", gpu().adapter_name);

    // The host may write the buffer again without telling; a frame that supplies it always reads it.
    let others = sun(-0.7);
    first.run(&Frame { lighting: Lighting::Lights(&others), ..lit });
    let from = first.body.outputs().irradiance;
    let mut encoder = gpu().device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, &buffer, 0, from.size());
    gpu().queue.submit([encoder.finish()]);
    let before = second.exitance();
    second.run(&supplied(&buffer));
    assert_ne!(before, second.exitance(), "[{}] other light changes nothing", gpu().adapter_name);
    assert_eq!(first.exitance(), second.exitance(), "[{}]", gpu().adapter_name);
}

#[test]
fn lights_come_back() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let lights = sun(0.4);
    let lit = Frame { lighting: Lighting::Lights(&lights), ..Frame::default() };
    fixture.run(&lit);
    let before = fixture.exitance();
    let dark = host_buffer(fixture.body.outputs().irradiance.size(), BufferUsages::COPY_SRC);
    fixture.run(&supplied(&dark));
    assert!(fixture.irradiance().iter().all(|e| *e == [0.0; 3]), "[{}] not dark", gpu().adapter_name);
    // Not even the lights of before may be taken for what is there.
    for lights in [lit, Frame::default(), supplied(&dark), Frame::default(), lit] {
        fixture.prepare(&lights).unwrap();
        let stages = fixture.body.pending();
        assert!(!stages.contains(Stage::Deform) && stages.contains(Stage::Cluster), "{stages:?}");
        fixture.encode();
    }
    assert_eq!(before, fixture.exitance(), "[{}]", gpu().adapter_name);
    // Dark lights after supplied darkness after lights: each is a change.
    fixture.run(&supplied(&copied(&fixture)));
    fixture.run(&Frame::default());
    assert!(fixture.irradiance().iter().all(|e| *e == [0.0; 3]), "[{}] not dark", gpu().adapter_name);
}

/// The host reads where the texels are before it writes their light.
#[test]
fn a_moved_body_takes_new_light() {
    let mut fixture = Fixture::new(&creature(), |_| ());
    let pose = Pose { weights: vec![0.5], ..Pose::rest(1) };
    let buffer = host_buffer(fixture.body.outputs().irradiance.size(), BufferUsages::COPY_SRC);
    fixture.run(&supplied(&buffer));
    let before = fixture.sources();
    let frame = Frame { lighting: Lighting::Irradiance(&buffer), ..pose.frame(&[]) };
    fixture.light(&frame);
    let after = fixture.sources();
    assert!(before.iter().zip(&after).any(|(a, b)| a.position != b.position));
    let pending = fixture.body.pending();
    assert!(pending.contains(Stage::Cluster) && !pending.contains(Stage::Gather), "{pending:?}");
}

#[test]
fn bad_buffers_are_refused_by_name() {
    let mut fixture = Fixture::new(&sphere(), |_| ());
    let size = fixture.body.outputs().irradiance.size();
    let short = host_buffer(size - 4, BufferUsages::COPY_SRC);
    let stuck = host_buffer(size, BufferUsages::COPY_DST | BufferUsages::STORAGE);
    let words = [size - 4, size / 16, size].map(|n| n.to_string());
    for (buffer, words) in [
        (short, words.iter().map(String::as_str).collect::<Vec<_>>()),
        (stuck, vec!["cannot be copied", "COPY_SRC"]),
    ] {
        let message = fixture.prepare(&supplied(&buffer)).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "[{}] {message}", gpu().adapter_name);
    }
    fixture.prepare(&supplied(&host_buffer(size, BufferUsages::COPY_SRC))).unwrap();
}

/// A frame in two parts gives the bits of the frame at once.
#[test]
fn a_frame_may_be_encoded_in_parts() {
    let [mut parts, mut whole] = [(); 2].map(|()| Fixture::new(&creature(), |_| ()));
    let lights = sun(0.4);
    let frame = Frame { lighting: Lighting::Lights(&lights), ..Frame::default() };
    let first = parts.light(&frame);
    let dark = parts.exitance();
    assert!(dark.iter().all(|b| *b == [0.0; 3]), "[{}] scattered too early", gpu().adapter_name);
    let second = parts.encode();
    whole.prepare(&frame).unwrap();
    let all = whole.encode();
    assert_eq!(first.draws + second.draws, all.draws);
    assert_eq!(first.dispatches + second.dispatches, all.dispatches);
    assert_eq!(parts.exitance(), whole.exitance(), "[{}]", gpu().adapter_name);
    assert!(parts.body.pending().is_empty());
}
