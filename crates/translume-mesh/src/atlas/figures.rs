//! Figures of merit of a layout.

use glam::DVec2;

use super::AtlasReport;
use super::raster::{Fragments, signed_area};

/// Share of a texel by which overlaps may exceed it through rounding of UVs to f32.
const OVERLAP_TOLERANCE: f64 = 1e-4;

/// Measures a layout in texel units; `charts` and `seconds` are the caller's.
pub(super) fn measure(
    corners: &[[DVec2; 3]],
    areas: &[f64],
    fragments: &Fragments,
    size: u32,
) -> AtlasReport {
    let signed: Vec<f64> = corners.iter().map(signed_area).collect();
    let uv_areas: Vec<f64> = signed.iter().map(|a| a.abs()).collect();
    let mut report = AtlasReport {
        flipped: signed.iter().filter(|&&a| a < 0.0).count(),
        area_cv: area_cv(&uv_areas, areas),
        area_ratio_p99: area_ratio_p99(&uv_areas, areas),
        ..AtlasReport::default()
    };
    let mut covered = 0.0;
    for pixel in 0..(size * size) as usize {
        let found = fragments.at(pixel);
        let overlap: f64 = found.iter().map(|f| f64::from(f.overlap)).sum();
        report.covered_texels += usize::from(!found.is_empty());
        report.overlapping_texels += usize::from(overlap > 1.0 + OVERLAP_TOLERANCE);
        covered += overlap.min(1.0);
    }
    report.utilisation = covered / f64::from(size).powi(2);
    report
}

/// Standard deviation over mean of surface per UV area, weighted by surface. Triangles without UV area are left out.
fn area_cv(uv_areas: &[f64], areas: &[f64]) -> f64 {
    let spread = || uv_areas.iter().zip(areas).filter(|(uv, _)| **uv > 0.0);
    let moment = |power: i32| spread().map(|(uv, area)| area * (area / uv).powi(power)).sum::<f64>();
    let total = moment(0);
    let mean = moment(1) / total;
    let variance = spread().map(|(uv, area)| area * (area / uv - mean).powi(2)).sum::<f64>() / total;
    if mean > 0.0 { variance.sqrt() / mean } else { 0.0 }
}

fn area_ratio_p99(uv_areas: &[f64], areas: &[f64]) -> f64 {
    let total: f64 = areas.iter().sum();
    let mean = uv_areas.iter().sum::<f64>() / total;
    let mut ratios: Vec<(f64, f64)> = uv_areas
        .iter()
        .zip(areas)
        .filter(|(_, area)| **area > 0.0)
        .map(|(uv, area)| {
            let ratio = uv / area / mean;
            (ratio.max(1.0 / ratio), *area)
        })
        .collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    ratios
        .into_iter()
        .find(|(_, area)| {
            below += area;
            below >= 0.99 * total
        })
        .map_or(1.0, |(ratio, _)| ratio)
}
