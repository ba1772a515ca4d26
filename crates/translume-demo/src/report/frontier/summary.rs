//! One scene in one line: which error is the larger one.

use super::judge::Against;

/// What the library's default does in a scene.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Its picture against the integral of its profile.
    pub quadrature: Option<Against>,
    /// The integral against paths.
    pub model: Option<Against>,
    /// Its picture against paths.
    pub total: Option<Against>,
    pub flip: Option<f64>,
    /// Of the paths.
    pub noise: Option<f64>,
    /// Why there are no paths.
    pub untraced: Option<String>,
}

/// The error that is worth working on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dominant {
    Model,
    Quadrature,
    /// Both are smaller than what paths can tell.
    Neither,
    Unknown,
}

/// What is left of a difference after its noise was taken off is known to about this share of the noise.
const DOUBT: f64 = 0.3;

impl Summary {
    pub fn dominant(&self) -> Dominant {
        let (Some(quadrature), Some(model)) = (&self.quadrature, &self.model) else {
            return Dominant::Unknown;
        };
        let doubt = DOUBT * self.noise.unwrap_or(0.0);
        match (quadrature.relative_rmse, model.relative_rmse) {
            (quadrature, model) if quadrature > model.max(doubt) => Dominant::Quadrature,
            (_, model) if model > doubt => Dominant::Model,
            _ => Dominant::Neither,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_error_is_named_unless_noise_hides_it() {
        let against = |relative_rmse| Some(Against { relative_rmse, bias: 0.0, relative_p99: 0.0 });
        let dominant = |quadrature, model, noise| {
            Summary {
                quadrature: against(quadrature),
                model: against(model),
                noise: Some(noise),
                ..Summary::default()
            }
            .dominant()
        };
        assert_eq!(dominant(0.01, 0.2, 0.05), Dominant::Model);
        assert_eq!(dominant(0.05, 0.02, 0.01), Dominant::Quadrature);
        assert_eq!(dominant(0.005, 0.01, 0.05), Dominant::Neither);
        assert_eq!(Summary::default().dominant(), Dominant::Unknown);
    }
}
