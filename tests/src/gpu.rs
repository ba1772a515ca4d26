//! The adapter under test.

use std::sync::OnceLock;
use translume::{Config, Translume, wgpu};

/// A device, its queue, the pipelines, and the name of the adapter behind them.
pub struct Gpu {
    /// What the device came from.
    pub instance: wgpu::Instance,
    /// Created with WebGPU's default limits and no feature, what translume promises to need, unless asked for otherwise.
    pub device: wgpu::Device,
    /// The device's queue.
    pub queue: wgpu::Queue,
    /// Every pipeline, compiled once for all tests.
    pub translume: Translume,
    /// For failure messages.
    pub adapter_name: String,
}

/// The one device of this test binary. `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` choose the adapter.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::with(wgpu::Features::empty()))
}

impl Gpu {
    /// A device of its own, with those of the features that the adapter has.
    ///
    /// # Panics
    /// If there is no adapter, or no device with WebGPU's default limits.
    #[must_use]
    pub fn with(features: wgpu::Features) -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let adapter = pollster::block_on(wgpu::util::initialize_adapter_from_env(&instance, None))
            .or_else(|_| {
                pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            })
            .expect("no graphics adapter; install a Vulkan, Metal or DX12 driver, or Mesa's lavapipe");
        let info = adapter.get_info();
        let adapter_name = format!("{} ({}, {})", info.name, info.backend, info.driver_info);
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("tests"),
            required_features: adapter.features() & features,
            required_limits: wgpu::Limits::default(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).unwrap_or_else(|error| {
                panic!("[{adapter_name}] no device with WebGPU's default limits: {error}")
            });
        let translume = Translume::new(&device, &Config::default())
            .unwrap_or_else(|error| panic!("[{adapter_name}] no pipelines: {error}"));
        eprintln!("adapter: {adapter_name}");
        Self { instance, device, queue, translume, adapter_name }
    }
}
