//! What can be seen instead of light: the textures behind it, and how the surface is laid out.

use crate::error::Error;
use crate::gpu::Gpu;
use std::collections::HashMap;
use translume::Body;
use translume_mesh::Atlas;

/// What is shown of each texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// The picture.
    #[default]
    None,
    Position,
    Normal,
    Irradiance,
    Exitance,
    Charts,
    /// Texels per area of the surface as it stands.
    Density,
    /// Groups of 64 texels.
    Clusters,
    /// Against all pairs, of the same body in the same light.
    Error,
}

/// Texels of a cluster.
const CLUSTER: usize = 64;
/// The error at which the scale of colours ends.
pub const MOST_ERROR: f32 = 0.05;

impl Overlay {
    pub const ALL: [(Self, &'static str); 9] = [
        (Self::None, "picture"),
        (Self::Position, "position"),
        (Self::Normal, "normal"),
        (Self::Irradiance, "irradiance"),
        (Self::Exitance, "exitance"),
        (Self::Charts, "charts"),
        (Self::Density, "texel density"),
        (Self::Clusters, "clusters"),
        (Self::Error, "error against all pairs"),
    ];
}

/// sRGB of every pixel of the atlas; `errors` of every texel where they are shown.
pub async fn colours(
    gpu: &Gpu,
    body: &Body,
    atlas: &Atlas,
    overlay: Overlay,
    errors: &[f32],
) -> Result<Vec<[u8; 4]>, Error> {
    let outputs = body.outputs();
    let read = async |buffer| gpu.buffer::<[f32; 4]>(buffer).await;
    let texels: Vec<[f32; 3]> = match overlay {
        Overlay::None => Vec::new(),
        Overlay::Position => positions(&read(outputs.texel_positions).await?),
        Overlay::Normal => {
            rgb(&read(outputs.texel_normals).await?).map(|n| n.map(|x| 0.5 + 0.5 * x)).collect()
        }
        Overlay::Irradiance => exposed(&read(outputs.irradiance).await?),
        Overlay::Exitance => exposed(&read(outputs.exitance).await?),
        Overlay::Charts => by_number(&charts(atlas)),
        Overlay::Density => density(&read(outputs.texel_positions).await?),
        Overlay::Clusters => by_number(&(0..atlas.texels.len()).map(|k| k / CLUSTER).collect::<Vec<_>>()),
        Overlay::Error => errors.iter().map(|error| heat(error / MOST_ERROR)).collect(),
    };
    let pixel = |texel: &u32| match texels.get(*texel as usize) {
        Some(colour) => {
            let [r, g, b] = colour.map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
            [r, g, b, 255]
        }
        None => [24, 24, 24, 255],
    };
    Ok(atlas.pixels.iter().map(pixel).collect())
}

/// Relative error of every texel's exitance: over the mean of what is right, worst channel.
pub fn errors(found: &[[f32; 4]], right: &[[f32; 4]]) -> Vec<f32> {
    let count = right.len().max(1) as f32;
    let mean = |k: usize| (right.iter().map(|rgb| rgb[k]).sum::<f32>() / count).max(f32::MIN_POSITIVE);
    let means = [mean(0), mean(1), mean(2)];
    let error =
        |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|k| (a[k] - b[k]).abs() / means[k]).fold(0.0, f32::max);
    found.iter().zip(right).map(error).collect()
}

fn rgb(values: &[[f32; 4]]) -> impl Iterator<Item = [f32; 3]> {
    values.iter().map(|[r, g, b, _]| [*r, *g, *b])
}

/// From corner to corner of the body's box.
fn positions(values: &[[f32; 4]]) -> Vec<[f32; 3]> {
    let around = |pick: fn(f32, f32) -> f32, start| {
        rgb(values).fold([start; 3], |best: [f32; 3], p| std::array::from_fn(|k| pick(best[k], p[k])))
    };
    let (low, high) = (around(f32::min, f32::INFINITY), around(f32::max, f32::NEG_INFINITY));
    let share = |p: [f32; 3]| std::array::from_fn(|k| (p[k] - low[k]) / (high[k] - low[k]).max(1e-30));
    rgb(values).map(share).collect()
}

/// As bright as 98 % of the texels allow, in sRGB.
fn exposed(values: &[[f32; 4]]) -> Vec<[f32; 3]> {
    let mut levels: Vec<f32> = rgb(values).map(|rgb| rgb.into_iter().fold(0.0, f32::max)).collect();
    levels.sort_by(f32::total_cmp);
    let most = levels.get(levels.len() * 98 / 100).copied().unwrap_or(1.0).max(f32::MIN_POSITIVE);
    rgb(values).map(|rgb| rgb.map(|c| (c / most).clamp(0.0, 1.0).powf(1.0 / 2.2))).collect()
}

/// By how dense texels are on the surface, sixteen times more or less than in the middle from end to end of the scale.
fn density(values: &[[f32; 4]]) -> Vec<[f32; 3]> {
    let mut areas: Vec<f32> = values.iter().map(|value| value[3]).filter(|area| *area > 0.0).collect();
    areas.sort_by(f32::total_cmp);
    let median = areas.get(areas.len() / 2).copied().unwrap_or(1.0);
    let colour = |[_, _, _, area]: &[f32; 4]| {
        if *area > 0.0 { heat(0.5 + (median / area).log2() / 8.0) } else { [0.1; 3] }
    };
    values.iter().map(colour).collect()
}

/// Which chart every texel is on: triangles that share vertices of the atlas are one.
fn charts(atlas: &Atlas) -> Vec<usize> {
    let mut parents: Vec<u32> = (0..atlas.vertices.len() as u32).collect();
    fn root(parents: &mut [u32], mut vertex: u32) -> u32 {
        while parents[vertex as usize] != vertex {
            parents[vertex as usize] = parents[parents[vertex as usize] as usize];
            vertex = parents[vertex as usize];
        }
        vertex
    }
    for [a, b, c] in &atlas.triangles {
        for other in [b, c] {
            let (one, two) = (root(&mut parents, *a), root(&mut parents, *other));
            parents[one as usize] = two;
        }
    }
    let mut numbers = HashMap::new();
    let texels = atlas.texels.iter().map(|texel| {
        let root = root(&mut parents, atlas.triangles[texel.triangle as usize][0]);
        let next = numbers.len();
        *numbers.entry(root).or_insert(next)
    });
    texels.collect()
}

/// Colours that neighbours in number do not share: hues by the golden ratio.
fn by_number(numbers: &[usize]) -> Vec<[f32; 3]> {
    let colour = |number: &usize| {
        let hue = (*number as f32 * 0.618_034).fract();
        let level = 0.6 + 0.3 * (*number as f32 * 0.754_878).fract();
        [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
            let wave = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
            level * (0.35 + 0.65 * wave.clamp(0.0, 1.0))
        })
    };
    numbers.iter().map(colour).collect()
}

/// Blue, green, yellow, red from 0 to 1.
pub fn heat(x: f32) -> [f32; 3] {
    const STOPS: [[f32; 3]; 5] =
        [[0.1, 0.15, 0.5], [0.1, 0.6, 0.7], [0.3, 0.75, 0.3], [0.95, 0.85, 0.2], [0.85, 0.15, 0.1]];
    let place = x.clamp(0.0, 1.0) * 4.0;
    let k = (place as usize).min(3);
    let share = place - k as f32;
    std::array::from_fn(|c| STOPS[k][c] + (STOPS[k + 1][c] - STOPS[k][c]) * share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_mesh::{AtlasOptions, builtin};

    #[test]
    fn charts_are_as_many_as_the_atlas_says() {
        let mesh = builtin::builtin("torus-knot").unwrap();
        let atlas = Atlas::build(&mesh, &AtlasOptions { size: 64, ..Default::default() }, |_| true).unwrap();
        let numbers = charts(&atlas);
        let found: std::collections::HashSet<_> = numbers.iter().collect();
        assert_eq!(found.len(), atlas.report.charts);
        assert_eq!(numbers.len(), atlas.texels.len());
    }

    #[test]
    fn errors_are_of_the_worst_channel() {
        let right = [[1.0, 2.0, 4.0, 0.0], [3.0, 2.0, 4.0, 0.0]];
        let found = [[1.0, 2.0, 5.0, 9.0], [3.2, 2.0, 4.0, 0.0]];
        let errors = errors(&found, &right);
        // Over means of 2, 2 and 4.
        assert!((errors[0] - 0.25).abs() < 1e-6 && (errors[1] - 0.1).abs() < 1e-6, "{errors:?}");
    }

    #[test]
    fn heat_goes_from_blue_to_red() {
        let ([cold_r, _, cold_b], [hot_r, _, hot_b]) = (heat(0.0), heat(1.0));
        assert!(cold_b > cold_r && hot_r > hot_b);
        assert_eq!(heat(f32::NAN.max(0.0)), heat(0.0));
        assert_eq!(heat(7.0), heat(1.0));
    }
}
