//! Cluster: sums of texels up the implicit 4-ary tree (twin of the GPU's cluster stage).

use glam::DVec3;

use crate::gather::Source;
use crate::rgb::{accumulate, mean};

/// A run of texels seen as one source. Level l node k covers texels k·4^l … (k+1)·4^l − 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Power Σ E·A, W/m² · mm².
    pub power: [f64; 3],
    /// Live area, mm².
    pub area: f64,
    /// Mean position weighted by power (mean over RGB); by area if there is no power, equally if there is no area. mm.
    pub centroid: [f64; 3],
    /// Rms distance of the power from the centroid, mm.
    pub spread: f64,
    /// Unit mean normal under the weights of the centroid; the zero vector if they cancel.
    pub normal: [f64; 3],
    /// Bound on the distance of the texels' positions from the centroid, mm.
    pub radius: f64,
}

impl From<&Source> for Cluster {
    fn from(source: &Source) -> Self {
        Self {
            power: source.power(),
            area: source.area,
            centroid: source.position,
            spread: source.spread(),
            normal: source.normal,
            radius: 0.0,
        }
    }
}

/// The whole tree, finest level first: one cluster per texel, then a quarter as many on each level (rounded up), and a
/// single root. Empty without texels.
#[must_use]
pub fn levels(sources: &[Source]) -> Vec<Vec<Cluster>> {
    let mut levels = Vec::new();
    let mut level: Vec<Cluster> = sources.iter().map(Cluster::from).collect();
    while level.len() > 1 {
        let above = level.chunks(4).map(sum).collect();
        levels.push(std::mem::replace(&mut level, above));
    }
    if !level.is_empty() {
        levels.push(level);
    }
    levels
}

/// The parent of up to four children.
fn sum(children: &[Cluster]) -> Cluster {
    let mut power = [0.0; 3];
    for child in children {
        accumulate(&mut power, child.power, 1.0);
    }
    let weights = weights(children);
    let average = |value: fn(&Cluster) -> [f64; 3]| -> DVec3 {
        children.iter().zip(&weights).map(|(child, &w)| DVec3::from(value(child)) * w).sum()
    };
    let centroid = average(|child| child.centroid);
    let distance = |child: &Cluster| (DVec3::from(child.centroid) - centroid).length();
    let variance: f64 = children
        .iter()
        .zip(&weights)
        .map(|(child, &w)| w * (child.spread.powi(2) + distance(child).powi(2)))
        .sum();
    Cluster {
        power,
        area: children.iter().map(|child| child.area).sum(),
        centroid: centroid.to_array(),
        spread: variance.sqrt(),
        normal: average(|child| child.normal).normalize_or_zero().to_array(),
        radius: children.iter().map(|child| distance(child) + child.radius).fold(0.0, f64::max),
    }
}

/// Weights that add up to 1: by power, else by area, else equal.
fn weights(children: &[Cluster]) -> Vec<f64> {
    let normalised = |weight: fn(&Cluster) -> f64| {
        let sum: f64 = children.iter().map(weight).sum();
        (sum > 0.0).then(|| children.iter().map(|child| weight(child) / sum).collect())
    };
    normalised(|child| mean(child.power))
        .or_else(|| normalised(|child| child.area))
        .unwrap_or_else(|| vec![1.0 / children.len() as f64; children.len()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_rel;
    use std::f64::consts::PI;

    fn texels(count: u32) -> Vec<Source> {
        let texel = |k: u32| {
            let x = f64::from(k);
            Source {
                position: [(1.7 * x).sin() * 5.0, (2.3 * x).cos() * 3.0, 0.1 * x],
                normal: DVec3::new((0.3 * x).sin(), 1.0, (0.2 * x).cos()).normalize().to_array(),
                area: 0.1 + 0.01 * x,
                irradiance: [1.0 + (0.7 * x).sin(), 0.5, f64::from(k % 3)],
            }
        };
        (0..count).map(texel).collect()
    }

    /// Power, centroid and spread of a run of texels straight from their definition.
    fn brute(texels: &[Source]) -> ([f64; 3], DVec3, f64) {
        let power: [f64; 3] = std::array::from_fn(|k| texels.iter().map(|t| t.irradiance[k] * t.area).sum());
        let weight = |t: &Source| t.irradiance.iter().sum::<f64>() * t.area;
        let total: f64 = texels.iter().map(weight).sum();
        let centroid = texels.iter().map(|t| DVec3::from(t.position) * weight(t)).sum::<DVec3>() / total;
        let distance2 = |t: &Source| DVec3::from(t.position).distance_squared(centroid);
        let variance =
            texels.iter().map(|t| weight(t) * (t.area / (2.0 * PI) + distance2(t))).sum::<f64>() / total;
        (power, centroid, variance.sqrt())
    }

    #[test]
    fn every_node_matches_its_texels() {
        let texels = texels(83);
        let levels = levels(&texels);
        assert_eq!(levels.iter().map(Vec::len).collect::<Vec<_>>(), [83, 21, 6, 2, 1]);
        for (level, nodes) in levels.iter().enumerate() {
            let size = 4usize.pow(level as u32);
            for (node, run) in nodes.iter().zip(texels.chunks(size)) {
                let (power, centroid, spread) = brute(run);
                // Rounding only.
                (0..3).for_each(|k| assert!((node.power[k] - power[k]).abs() <= 1e-13 * (1.0 + power[k])));
                assert!((DVec3::from(node.centroid) - centroid).length() < 1e-12);
                assert_rel(node.spread, spread, 1e-12, "spread");
                assert_rel(node.area, run.iter().map(|t| t.area).sum(), 1e-13, "area");
                for texel in run {
                    assert!(DVec3::from(texel.position).distance(centroid) <= node.radius + 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_shifted_tree_is_noticed() {
        let texels = texels(83);
        let shifted = levels(&texels[1..]);
        let (_, centroid, _) = brute(&texels[..16]);
        assert!((DVec3::from(shifted[2][0].centroid) - centroid).length() > 1e-3);
    }

    #[test]
    fn darkness_falls_back_to_area_then_to_equal_weights() {
        let mut texels = texels(2);
        texels.iter_mut().for_each(|t| t.irradiance = [0.0; 3]);
        texels[0].position = [0.0; 3];
        texels[1].position = [1.0, 0.0, 0.0];
        (texels[0].area, texels[1].area) = (1.0, 3.0);
        assert_eq!(levels(&texels)[1][0].centroid, [0.75, 0.0, 0.0]);
        texels.iter_mut().for_each(|t| t.area = 0.0);
        let root = levels(&texels)[1][0];
        assert_eq!(root.centroid, [0.5, 0.0, 0.0]);
        assert_eq!((root.spread, root.radius, root.power), (0.5, 0.5, [0.0; 3]));
    }

    #[test]
    fn opposite_normals_cancel_to_zero() {
        let mut texels = texels(2);
        texels[1] = texels[0];
        texels[1].normal = texels[0].normal.map(|x| -x);
        assert_eq!(levels(&texels)[1][0].normal, [0.0; 3]);
        assert!(levels(&[]).is_empty());
    }
}
