//! An adapter and its device.

use crate::error::Error;
use std::time::Instant;
use translume::wgpu;

/// A device and the name of the adapter behind it.
#[derive(Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub adapter: String,
    /// Whether the CPU does the work.
    pub is_software: bool,
}

impl Gpu {
    /// The best adapter there is, with all its limits; `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` have their say.
    pub fn new() -> Result<Self, Error> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = match pollster::block_on(wgpu::util::initialize_adapter_from_env(&instance, None)) {
            Ok(adapter) => adapter,
            Err(_) => pollster::block_on(instance.request_adapter(&options))
                .map_err(|error| Error::NoAdapter(error.to_string()))?,
        };
        let info = adapter.get_info();
        let name = format!("{} ({}, {})", info.name, info.backend, info.driver_info);
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("translume"),
            // For timings.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| Error::NoDevice { adapter: name.clone(), reason: error.to_string() })?;
        let is_software = info.device_type == wgpu::DeviceType::Cpu;
        Ok(Self { device, queue, adapter: name, is_software })
    }

    /// Runs commands; from submission to their end, ms.
    pub fn time(&self, commands: wgpu::CommandBuffer) -> Result<f64, Error> {
        let start = Instant::now();
        self.queue.submit([commands]);
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|error| translume::Error::ReadBack(error.to_string()))?;
        Ok(1e3 * start.elapsed().as_secs_f64())
    }
}
