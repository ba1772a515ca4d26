//! What WGSL reads, against naga's own offsets.

use crate::dipole::MediumLayout;
use crate::scene::{LightLayout, SceneLayout};
use crate::screen_space::ProfileLayout;
use std::mem::offset_of;

fn compare(source: &[&str], name: &str, rust: &[(&str, usize)], size: usize) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(&source.join("\n")).map_err(|error| error.to_string())?;
    let named = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, ty) = named.ok_or_else(|| format!("there is no {name}"))?;
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        return Err(format!("{name} is no struct"));
    };
    for (field, offset) in rust {
        let there = members.iter().find(|member| member.name.as_deref() == Some(field));
        if there.map(|member| member.offset as usize) != Some(*offset) {
            return Err(format!("{name}.{field}: Rust has offset {offset}, WGSL {there:?}"));
        }
    }
    if *span as usize == size { Ok(()) } else { Err(format!("{name}: Rust has {size} bytes, WGSL {span}")) }
}

macro_rules! fields {
    ($rust:ty, [$($field:ident),+]) => { [$((stringify!($field), offset_of!($rust, $field))),+] };
}

#[test]
fn rust_and_wgsl_agree() {
    let light = fields!(
        LightLayout,
        [
            origin,
            perspective,
            right,
            half_width,
            up,
            near,
            forward,
            far,
            colour,
            shadow,
            region_low,
            region_high
        ]
    );
    let scene = fields!(SceneLayout, [view_projection, eye, eta, exit_scale, light_count, lights]);
    for source in [crate::TRANSLUCENT_SHADOW_MAP, crate::SCREEN_SPACE] {
        compare(&source, "Light", &light, size_of::<LightLayout>()).unwrap();
        compare(&source, "Scene", &scene, size_of::<SceneLayout>()).unwrap();
    }
    let medium = fields!(MediumLayout, [sigma_tr, table_step, z_real, z_virtual, half_albedo, share, radii]);
    compare(&crate::TRANSLUCENT_SHADOW_MAP, "Medium", &medium, size_of::<MediumLayout>()).unwrap();
    let profile = fields!(ProfileLayout, [albedo, sample_count, shape, focal]);
    compare(&crate::SCREEN_SPACE, "Profile", &profile, size_of::<ProfileLayout>()).unwrap();

    let moved = [("focal", offset_of!(ProfileLayout, focal) + 4)];
    assert!(compare(&crate::SCREEN_SPACE, "Profile", &moved, size_of::<ProfileLayout>()).is_err());
}
