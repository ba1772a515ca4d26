//! An adapter and its device.

use crate::error::Error;
use translume::{readback, wgpu};
use web_time::Instant;

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
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new() -> Result<Self, Error> {
        pollster::block_on(Self::open())
    }

    /// The same without blocking.
    pub async fn open() -> Result<Self, Error> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = match wgpu::util::initialize_adapter_from_env(&instance, None).await {
            Ok(adapter) => adapter,
            Err(_) => instance
                .request_adapter(&options)
                .await
                .map_err(|error| Error::NoAdapter(error.to_string()))?,
        };
        let info = adapter.get_info();
        // Browsers tell no more of it.
        let name = match info.name.as_str() {
            "" => "WebGPU of this browser".to_owned(),
            name => format!("{name} ({}, {})", info.backend, info.driver_info),
        };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("translume"),
            // For timings.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| Error::NoDevice { adapter: name.clone(), reason: error.to_string() })?;
        let is_software = info.device_type == wgpu::DeviceType::Cpu;
        Ok(Self { device, queue, adapter: name, is_software })
    }

    /// The content of a buffer. It is waited for, in a browser without blocking.
    pub async fn buffer<T: bytemuck::Pod>(&self, source: &wgpu::Buffer) -> Result<Vec<T>, Error> {
        #[cfg(not(target_arch = "wasm32"))]
        let values = readback::buffer(&self.device, &self.queue, source);
        #[cfg(target_arch = "wasm32")]
        let values = readback::buffer_async(&self.device, &self.queue, source).await;
        Ok(values?)
    }

    /// The texels of a texture, in the same way.
    pub async fn texture<T: bytemuck::Pod>(&self, source: &wgpu::Texture) -> Result<Vec<T>, Error> {
        #[cfg(not(target_arch = "wasm32"))]
        let values = readback::texture(&self.device, &self.queue, source, 0);
        #[cfg(target_arch = "wasm32")]
        let values = readback::texture_async(&self.device, &self.queue, source, 0).await;
        Ok(values?)
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
