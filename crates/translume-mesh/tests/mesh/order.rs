use translume_mesh::{Atlas, Mesh, Texel};

use crate::fixtures::{Random, clean, grid_atlas, sphere};

/// Mean radius around the mean of aligned runs of 4^level texels, model units.
fn mean_radius(texels: &[Texel], mesh: &Mesh, level: u32) -> f64 {
    let runs: Vec<f64> = texels
        .chunks_exact(4_usize.pow(level))
        .map(|run| {
            let points: Vec<[f32; 3]> =
                run.iter().map(|t| t.interpolate(mesh.corners(t.triangle as usize))).collect();
            let centre: [f32; 3] =
                std::array::from_fn(|k| points.iter().map(|p| p[k]).sum::<f32>() / points.len() as f32);
            let distance = |p: &[f32; 3]| (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f32>().sqrt();
            f64::from(points.iter().map(distance).fold(0.0, f32::max))
        })
        .collect();
    runs.iter().sum::<f64>() / runs.len() as f64
}

/// Runs must cover a share of the sphere that shrinks with their length: a cap of n of N texels has the radius
/// √(4n/N); splits make boxes instead of caps and rims lie a little off the surface, so allow twice as much.
fn is_compact(texels: &[Texel], mesh: &Mesh) -> bool {
    (1..=4).all(|level| {
        let share = 4_f64.powi(level as i32) / texels.len() as f64;
        mean_radius(texels, mesh, level) < 2.0 * (4.0 * share).sqrt()
    })
}

fn shuffled(atlas: &Atlas) -> Vec<Texel> {
    let mut texels = atlas.texels.clone();
    let mut random = Random(7);
    for k in (1..texels.len()).rev() {
        texels.swap(k, random.below(k + 1));
    }
    texels
}

#[test]
fn aligned_runs_are_compact() {
    let mesh = clean(sphere(2));
    let atlas = grid_atlas(&mesh, 240);
    assert!(is_compact(&atlas.texels, &mesh));
}

#[test]
fn the_compactness_test_notices_a_shuffle() {
    let mesh = clean(sphere(2));
    let atlas = grid_atlas(&mesh, 240);
    assert!(!is_compact(&shuffled(&atlas), &mesh));
}

/// A shift by one texel breaks the alignment of runs, and nothing else.
#[test]
fn alignment_matters() {
    let mesh = clean(sphere(2));
    let atlas = grid_atlas(&mesh, 240);
    let radius = |texels| mean_radius(texels, &mesh, 1);
    assert!(radius(&atlas.texels[1..]) > 1.2 * radius(&atlas.texels));
}

#[test]
fn texels_are_a_permutation_of_pixels() {
    let atlas = grid_atlas(&clean(sphere(2)), 240);
    let mut pixels: Vec<_> = atlas.texels.iter().map(|t| t.pixel).collect();
    pixels.sort_unstable();
    pixels.dedup();
    assert_eq!(pixels.len(), atlas.texels.len());
    for (index, texel) in atlas.texels.iter().enumerate() {
        let [x, y] = texel.pixel.map(usize::from);
        assert_eq!(atlas.pixels[y * 240 + x] as usize, index);
    }
}
