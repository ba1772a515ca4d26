//! One measurement, and all of them as CSV.

use super::entrant::{Entrant, Family, Way};
use super::judge::{Against, Verdict};
use crate::report::csv::quoted;

pub struct Row {
    pub scene: String,
    pub family: Family,
    pub setting: String,
    pub profile: &'static str,
    pub atlas: Option<u32>,
    /// Whether it runs for its profile, not its speed.
    pub is_model: bool,
    pub evaluations: Option<f64>,
    pub frame_ms: f64,
    pub scatter_ms: Option<f64>,
    pub verdict: Verdict,
}

impl Row {
    pub fn new(
        scene: &str,
        entrant: &Entrant,
        is_model: bool,
        taken: &super::shot::Taken,
        verdict: Verdict,
    ) -> Self {
        let atlas = match entrant.way {
            Way::Ours { atlas, .. } => Some(atlas),
            Way::Rival(_) => None,
        };
        Self {
            scene: scene.to_owned(),
            family: entrant.family,
            setting: entrant.setting.clone(),
            profile: entrant.profile,
            atlas,
            is_model,
            evaluations: taken.evaluations,
            frame_ms: taken.frame_ms,
            scatter_ms: taken.scatter_ms,
            verdict,
        }
    }

    pub fn against(&self, truth: Truth) -> Option<&Against> {
        match truth {
            Truth::Converged => self.verdict.quadrature.as_ref(),
            Truth::Traced => self.verdict.total.as_ref(),
        }
    }

    /// Time and relative RMSE, for a plot.
    pub fn point(&self, truth: Truth) -> Option<(f64, f64)> {
        self.against(truth).map(|against| (self.frame_ms, against.relative_rmse))
    }
}

/// What a picture is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// The integral of the same profile over the surface.
    Converged,
    /// Light followed through the volume.
    Traced,
}

const HEADER: &str = "scene,method,setting,profile,atlas,evaluations_per_texel,frame_ms,scatter_ms,\
quadrature_rel_rmse,quadrature_bias,quadrature_p99,total_rel_rmse,total_bias,total_p99,total_psnr_db,total_flip,noise,adapter\n";

/// Fields without a figure are empty.
pub fn csv(rows: &[Row], adapter: &str) -> String {
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.6}"));
    let mut text = HEADER.to_owned();
    for row in rows {
        let figures = |against: Option<&Against>| {
            let of = |figure: fn(&Against) -> f64| optional(against.map(figure));
            [of(|a| a.relative_rmse), of(|a| a.bias), of(|a| a.relative_p99)]
        };
        let mut fields = vec![
            quoted(&row.scene),
            quoted(row.family.name()),
            quoted(&row.setting),
            row.profile.to_owned(),
            row.atlas.map_or(String::new(), |atlas| atlas.to_string()),
            optional(row.evaluations),
            format!("{:.4}", row.frame_ms),
            optional(row.scatter_ms),
        ];
        fields.extend(figures(row.against(Truth::Converged)));
        fields.extend(figures(row.against(Truth::Traced)));
        fields.extend([
            optional(row.verdict.psnr),
            optional(row.verdict.flip),
            optional(row.verdict.noise),
            quoted(adapter),
        ]);
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

#[cfg(test)]
pub fn example(family: Family, frame_ms: f64, error: f64) -> Row {
    let against = Against { relative_rmse: error, bias: -0.5 * error, relative_p99: 3.0 * error };
    Row {
        scene: "egg, raw".to_owned(),
        family,
        setting: format!("{frame_ms}"),
        profile: "dipole",
        atlas: Some(64),
        is_model: false,
        evaluations: None,
        frame_ms,
        scatter_ms: None,
        verdict: Verdict { quadrature: Some(against), ..Verdict::default() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_fields_as_names() {
        let text = csv(&[example(Family::Tree, 2.0, 0.01)], "soft, slow");
        let columns = HEADER.trim().split(',').count();
        let line = text.lines().nth(1).unwrap();
        // Three fields hold a comma.
        assert_eq!(line.split(',').count(), columns + 2, "{line}");
        assert!(
            line.starts_with(
                "\"egg, raw\",one-sided tree,2,dipole,64,,2.0000,,0.010000,-0.005000,0.030000,,"
            )
        );
    }
}
