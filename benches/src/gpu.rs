//! The adapter that is measured.

use crate::scene::Scene;
use crate::{Change, MODES, Model};
use translume::{Config, Translume, wgpu};
use translume_mesh::builtin;

/// A device with timestamps where the adapter has them, and every pipeline.
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The pipelines.
    pub translume: Translume,
    /// The adapter's name.
    pub adapter: String,
    /// Whether times are the GPU's own.
    pub has_timestamps: bool,
}

impl Gpu {
    /// `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` choose the adapter.
    ///
    /// # Panics
    /// If there is no adapter or no device.
    #[must_use]
    pub fn new() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(wgpu::util::initialize_adapter_from_env(&instance, None))
            .or_else(|_| pollster::block_on(instance.request_adapter(&options)))
            .expect("a graphics adapter: install a Vulkan, Metal or DX12 driver, or Mesa's lavapipe");
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("benches"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .unwrap_or_else(|error| panic!("{}: {error}", adapter.get_info().name));
        let translume = Translume::new(&device, &Config::default()).unwrap_or_else(|error| panic!("{error}"));
        let has_timestamps = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let mut gpu = Self { device, queue, translume, adapter: adapter.get_info().name, has_timestamps };
        gpu.has_timestamps &= gpu.timestamps_arrive();
        gpu
    }

    /// Some drivers have the feature but return zeros.
    fn timestamps_arrive(&self) -> bool {
        let model = Model::new(builtin::sphere([0.0; 3], 50.0, 2), 32);
        Scene::new(self, &model, &MODES[0]).try_frame(Change::Nothing).is_some()
    }

    /// What times are, for the names of groups.
    #[must_use]
    pub fn clock(&self) -> &'static str {
        if self.has_timestamps { "GPU time" } else { "wall time" }
    }

    /// Submits and waits for the end.
    ///
    /// # Panics
    /// If the device is lost.
    pub fn run(&self, encoder: wgpu::CommandEncoder) {
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the GPU's answer");
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }
}

impl Default for Gpu {
    fn default() -> Self {
        Self::new()
    }
}
