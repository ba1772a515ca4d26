use super::*;
use std::mem::offset_of;

/// Members of a WGSL struct with their offsets, and its size rounded up to its alignment.
fn naga_layout(source: &str, name: &str) -> (Vec<(String, u32)>, u32) {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let (_, ty) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
    let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no struct") };
    (members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect(), *span)
}

/// Compares offsets by name and the total size; says what differs.
fn compare(source: &str, name: &str, rust: &[(&str, usize)], size: usize) -> Result<(), String> {
    let (members, span) = naga_layout(source, name);
    for (field, offset) in rust {
        match members.iter().find(|(member, _)| member == field) {
            Some((_, there)) if *there as usize == *offset => {}
            other => return Err(format!("{name}.{field}: Rust has offset {offset}, WGSL {other:?}")),
        }
    }
    if span as usize != size || members.len() < rust.len() {
        return Err(format!("{name}: Rust has {size} bytes, WGSL {span}"));
    }
    Ok(())
}

macro_rules! check {
    ($shader:ident, $wgsl:literal, $rust:ty, [$($field:ident),+]) => {
        compare(
            translume_shaders::$shader.source,
            $wgsl,
            &[$((stringify!($field), offset_of!($rust, $field))),+],
            size_of::<$rust>(),
        )
        .unwrap();
    };
}

#[test]
fn rust_and_wgsl_agree() {
    check!(
        DEFORM,
        "Deform",
        DeformLayout,
        [model, normal, warp, vertex_count, target_count, influences_per_vertex, winding]
    );
    check!(DEFORM, "Warp", WarpLayout, [foot, inflate, height, per_height, twist, bend]);
    check!(ADOPT, "Adopt", AdoptLayout, [first_position, position_stride, first_normal, normal_stride]);
    check!(DEFORM, "Influence", InfluenceLayout, [joint, weight]);
    check!(
        GATHER,
        "Light",
        LightLayout,
        [
            vector,
            kind,
            colour,
            first_view,
            region_low,
            view_count,
            region_high,
            cone_scale,
            axis,
            cone_offset,
            half_right,
            first_emitter,
            half_up,
            emitter_count
        ]
    );
    check!(
        GATHER,
        "Ambient",
        AmbientLayout,
        [radiance, cone_cosine, axis, shadow, table, first_view, first_emitter, emitter_count]
    );
    check!(GATHER, "ShadowView", ShadowViewLayout, [matrix, tile, layer, texel, perspective]);
    check!(GATHER, "Sky", SkyLayout, [direction, radiance]);
    check!(VISIBILITY, "Direction", DirectionLayout, [column, row, depth, to_sky, texel]);
    check!(VISIBILITY, "Directions", DirectionsLayout, [word, eight]);
    check!(
        GATHER,
        "Gather",
        GatherLayout,
        [
            texel_count,
            light_count,
            ambient_count,
            flat_normals,
            eta,
            winding,
            filter_side,
            direction_count,
            slant,
            on_surface,
            open_sky,
            shadowed_sky,
            lights,
            ambients,
            emitters,
            views,
            sky
        ]
    );
    check!(GATHER, "Texel", TexelLayout, [triangle, barycentric_1, barycentric_2, area_ratio, points]);
    check!(GATHER, "LightPoint", LightPointLayout, [triangle, weights]);
    check!(
        CLUSTER,
        "Level",
        LevelLayout,
        [child_count, node_count, child_offset, node_offset, source_offset, receiver_offset, child_sources]
    );
    check!(CLUSTER, "Need", NeedLayout, [view_projection, eye, kind]);
    check!(CLUSTER, "Cluster", Cluster, [centroid, spread, power, radius, normal, area]);
    check!(SCATTER, "KernelTable", KernelTableLayout, [least_r2, least_s2, columns, rows]);
    check!(
        SCATTER,
        "Scatter",
        ScatterLayout,
        [
            table,
            texel_count,
            first_source,
            source_count,
            top_level,
            theta_squared,
            z_r_squared,
            sources,
            terms
        ]
    );
    check!(
        PATTERN,
        "Pattern",
        PatternLayout,
        [table, texel_count, size, near_step, far_step, near_area, far_area]
    );
    assert_eq!(
        u64::from(naga_layout(translume_shaders::DUAL.source, "Expansion").1),
        crate::stages::scatter::dual::EXPANSION
    );
    check!(DUAL, "Term", TermLayout, [depth, weight]);
    check!(DUAL, "Lamp", LampLayout, [power, spread, normal, marks, moments]);
    check!(CLUSTER, "Receiver", ReceiverLayout, [centre, spread, radius, texels]);
    check!(
        DUAL,
        "Dual",
        DualLayout,
        [
            table,
            texel_count,
            level,
            start_level,
            top_level,
            theta_squared,
            leaf_theta_squared,
            z_r_squared,
            capacity,
            first_receiver,
            first_expansion,
            terms,
            offsets,
            sources
        ]
    );
    check!(
        POTENTIAL,
        "Transport",
        TransportLayout,
        [
            extinction,
            albedo,
            diffusion,
            decay,
            robin,
            shortfall,
            site_count,
            top_level,
            eta,
            source_count,
            groups,
            reach_squared,
            texel_count,
            texels_per_site,
            hopf,
            open,
            bend,
            along,
            lean,
            eye,
            light_bounds,
            offsets,
            sources
        ]
    );
    check!(NEAR, "Surroundings", SurroundingsLayout, [count, reach, sites]);
    check!(GROUP, "SiteLight", SiteLightLayout, [irradiance, tint]);
    check!(POTENTIAL, "Shape", ShapeLayout, [normal, spread, moments, area, turns, size]);
    check!(POTENTIAL, "Charge", ChargeLayout, [power, x, y, z]);
    check!(POTENTIAL, "Strata", StrataLayout, [direction, cosine, ways, rises, mean, rise, square]);
    let (_, expansion) = naga_layout(translume_shaders::POTENTIAL.source, "Expansion");
    assert_eq!(u64::from(expansion), crate::stages::scatter::dual::EXPANSION);
    check!(SITES, "Node", NodeLayout, [centre, radius, axis, thickness, middle, reach, scatter, sites]);
    check!(
        PICTURE,
        "Parabola",
        ParabolaLayout,
        [surface, thickness, slope, cosine, curve, around, open, light]
    );
    check!(KRYLOV, "State", StateLayout, [mean, weights, scale, residual, next, count, failed, failures]);
    let (members, span) = naga_layout(translume_shaders::COMPOSITE.source, "Composite");
    assert_eq!(members[1], ("eye".to_owned(), offset_of!(CompositeLayout, eye) as u32));
    assert_eq!(members[3], ("exit_scale".to_owned(), offset_of!(CompositeLayout, exit_scale) as u32));
    assert_eq!(members[4], ("roughness".to_owned(), offset_of!(CompositeLayout, roughness) as u32));
    assert_eq!(span as usize, size_of::<CompositeLayout>());
}

#[test]
fn a_shifted_field_is_noticed() {
    let wgsl = translume_shaders::CLUSTER.source;
    assert!(
        compare(wgsl, "Cluster", &[("power", offset_of!(Cluster, power) + 4)], size_of::<Cluster>()).is_err()
    );
    assert!(
        compare(wgsl, "Cluster", &[("power", offset_of!(Cluster, power))], size_of::<Cluster>() + 16)
            .is_err()
    );
}
