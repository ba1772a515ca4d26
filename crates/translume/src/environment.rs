//! placeholder until the environment branch is merged
/// Sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentLight {
    /// c
    pub coefficients: [[f32; 3]; 9],
    /// s
    pub shadow: bool,
}
impl EnvironmentLight {
    pub(crate) fn through(&self, _eta: f32) -> [[f32; 4]; 9] {
        [[0.0; 4]; 9]
    }
    /// r
    pub fn radiance(&self, _direction: [f32; 3]) -> [f32; 3] {
        [0.0; 3]
    }
}
