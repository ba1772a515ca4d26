use super::*;
use crate::builtin::topology::{check_clean, normal_agreement};

const NAMES: [&str; 4] = ["body", "lid", "handle", "spout"];

fn tessellated(patches: &[Patch], divisions: u32) -> Mesh {
    let mut mesh = Mesh::default();
    append(&mut mesh, patches, divisions);
    mesh
}

#[test]
fn has_the_papers_triangle_count() {
    let mesh = teapot();
    assert_eq!(mesh.triangles.len(), 2256, "Gong et al. 2008, Table 1");
    assert_eq!(teapot_with(10).triangles.len(), 64 * 100 - 80);
    assert_eq!(teapot_with(0), teapot_with(1));
    check_clean(&mesh);
    check_clean(&teapot_with(24));
}

/// Landmarks of Newell's data, his units and axes: corners of patches lie on the surface.
#[test]
fn corners_of_patches_are_where_newell_put_them() {
    let corners =
        parts().concat().iter().flat_map(|p| [p[0][0], p[0][3], p[3][0], p[3][3]]).collect::<Vec<_>>();
    for (x, y, z) in [
        (1.4, 0.0, 2.4),  // the rim's inner edge
        (0.0, -1.5, 2.4), // the rim's outer edge
        (-2.0, 0.0, 0.9), // the widest circle
        (0.0, 1.5, 0.15), // the foot
        (0.0, 0.0, 0.0),  // the bottom's pole
        (0.0, 0.0, 3.15), // the knob's pole
        (0.0, -0.2, 2.7), // the knob's neck
        (1.3, 0.0, 2.4),  // the lid's edge
        (-1.6, 0.0, 2.025),
        (-1.5, 0.0, 2.25),
        (-3.0, 0.0, 1.8),
        (-1.9, 0.0, 0.6), // the handle
        (1.7, 0.0, 1.425),
        (1.7, 0.0, 0.6),
        (3.3, 0.0, 2.4),
        (2.8, 0.0, 2.4),
        (3.2, 0.0, 2.4), // the spout
    ] {
        let expected = millimetres(x, y, z);
        assert!(corners.iter().any(|c| c.distance(expected) < 1e-9), "({x}, {y}, {z})");
    }
    assert!(
        corners.iter().all(|c| c.distance(millimetres(1.5, 0.0, 0.9)) > 1.0),
        "a point that is no corner"
    );
}

/// A directed edge that occurs twice joins two triangles of opposite winding.
fn doubled_edges(mesh: &Mesh) -> usize {
    let mut seen = std::collections::HashSet::new();
    mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).filter(|&e| !seen.insert(e)).count()
}

/// Where a part reaches farthest in a direction, outside lies in that direction.
fn check_outward(name: &str, mesh: &Mesh) -> Result<(), String> {
    let directions: &[DVec3] = match name {
        "body" => &[DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z, DVec3::NEG_Y],
        "lid" => &[DVec3::Y],
        "handle" => &[DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z],
        _ => &[DVec3::X, DVec3::Z, DVec3::NEG_Z],
    };
    for &direction in directions {
        let reach = |v: usize| DVec3::from(mesh.positions[v].map(f64::from)).dot(direction);
        let far = (0..mesh.positions.len()).max_by(|&a, &b| reach(a).total_cmp(&reach(b))).unwrap();
        let cosine = DVec3::from(mesh.normals[far].map(f64::from)).dot(direction);
        // A step of 1/24 patch turns the normal by some 4° on the body, up to 40° on the spout's lip.
        if cosine < 0.7 {
            return Err(format!("{name} towards {direction}: {cosine}"));
        }
    }
    Ok(())
}

#[test]
fn every_part_faces_outward() {
    for (name, patches) in NAMES.into_iter().zip(parts()) {
        let mesh = tessellated(&patches, 24);
        assert_eq!(doubled_edges(&mesh), 0, "{name}");
        assert!(normal_agreement(&mesh) > 40f64.to_radians().cos(), "{name}: the rim turns 31° in one step");
        check_outward(name, &mesh).unwrap();
    }
    assert!(normal_agreement(&teapot()) > 0.0, "even at 6 divisions no normal points through its triangle");
}

#[test]
fn a_patch_turned_inside_out_is_noticed() {
    for (name, mut patches) in NAMES.into_iter().zip(parts()) {
        patches[1].reverse();
        assert_ne!(doubled_edges(&tessellated(&patches, 6)), 0, "{name}");
        patches[1].reverse();
        patches.iter_mut().for_each(|p| p.reverse());
        check_outward(name, &tessellated(&patches, 24)).unwrap_err();
    }
}

/// The pole's normal is a limit; the axis is what it must be.
#[test]
fn poles_point_along_the_axis() {
    let mesh = teapot();
    let on_axis = |p: &[f32; 3]| p[0].hypot(p[2]) < 1e-4;
    let poles = (0..mesh.positions.len()).filter(|&v| on_axis(&mesh.positions[v])).collect::<Vec<_>>();
    assert_eq!(poles.len(), 2);
    for v in poles {
        let up = if mesh.positions[v][1] > 1.0 { 1.0 } else { -1.0 };
        assert!(mesh.normals[v][1] * up > 0.999_99, "four limits taken 10⁻⁴ inside, averaged");
    }
}
