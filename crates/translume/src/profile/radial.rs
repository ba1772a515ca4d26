//! What the kernel table asks of a profile.

/// Radial diffuse reflectance R_d(r) of one colour channel and its integrals over rings, with an exponential e^(−decay·r) taken out so
/// that nothing underflows.
pub(crate) trait Radial: Send + Sync {
    /// Rate of the exponential taken out, 1/mm. R_d falls at least as fast far away.
    fn decay(&self) -> f64;

    /// R_d(r)·e^(decay·r), 1/mm². `r` > 0 mm.
    fn scaled_reflectance(&self, r: f64) -> f64;

    /// e^(decay·inner) · ∫ R_d 2πρ dρ over the ring from `inner` ≥ 0 to `outer` ≥ `inner`, mm, without cancellation where the ring is
    /// thin.
    fn scaled_ring(&self, inner: f64, outer: f64) -> f64;

    /// ∫ R_d over the whole plane.
    fn total(&self) -> f64;

    /// Length below which R_d is smooth, mm: the trees need not resolve what is nearer. 0 where R_d has no bound at r = 0.
    fn smooth_length(&self) -> f64;

    /// ∫ R_d 2πρ dρ from 0 to r.
    fn enclosed(&self, r: f64) -> f64 {
        self.scaled_ring(0.0, r)
    }
}
