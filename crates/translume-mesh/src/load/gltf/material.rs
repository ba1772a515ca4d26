//! Materials and their extensions.

use gltf::json::Value;

use super::Fault;
use crate::material::{DiffuseTransmission, Material, Scatter, ScatterDraft, Volume};

/// Reads a material.
pub(super) fn read(material: &gltf::Material<'_>) -> Result<Material, Fault> {
    let extension = |name: &str| {
        let element = format!("materials[{}].extensions.{name}", material.index().unwrap_or_default());
        material.extension_value(name).map(|json| Extension { element, json })
    };
    Ok(Material {
        name: material.name().unwrap_or_default().into(),
        base_color: material.pbr_metallic_roughness().base_color_factor(),
        ior: extension("KHR_materials_ior").map_or(Ok(1.5), |e| e.number("ior", 0.0..=f32::MAX, 1.5))?,
        volume: extension("KHR_materials_volume").map(|e| volume(&e)).transpose()?,
        scatter: match (extension("KHR_materials_scatter"), extension("KHR_materials_volume_scatter")) {
            (Some(e), _) => Some(scatter(&e)?),
            (None, Some(e)) => Some(volume_scatter(&e)?),
            (None, None) => None,
        },
        diffuse_transmission: extension("KHR_materials_diffuse_transmission")
            .map(|e| diffuse_transmission(&e))
            .transpose()?,
    })
}

fn volume(extension: &Extension<'_>) -> Result<Volume, Fault> {
    Ok(Volume {
        thickness: extension.number("thicknessFactor", 0.0..=f32::MAX, 0.0)?,
        attenuation_distance: extension.number(
            "attenuationDistance",
            f32::MIN_POSITIVE..=f32::INFINITY,
            f32::INFINITY,
        )?,
        attenuation_color: extension.color("attenuationColor")?.unwrap_or([1.0; 3]),
    })
}

/// Earlier revisions of the draft call the colour by another name.
fn volume_scatter(extension: &Extension<'_>) -> Result<Scatter, Fault> {
    let color = match extension.color("multiscatterColorFactor")? {
        None => extension.color("multiscatterColor")?,
        color => color,
    };
    Ok(Scatter {
        draft: ScatterDraft::VolumeScatter,
        multiscatter_color: color.unwrap_or([0.0; 3]),
        anisotropy: extension.number("scatterAnisotropy", -1.0..=1.0, 0.0)?,
    })
}

/// The strength has one name in the draft's text and one in its schema. Where it is missing it counts as 1, as in the
/// draft's examples and its first revisions, although the present text says 0: that would be no scattering at all.
fn scatter(extension: &Extension<'_>) -> Result<Scatter, Fault> {
    let strength = extension.number("scatterFactor", 0.0..=1.0, 1.0)?;
    let strength = extension.number("scatterStrengthFactor", 0.0..=1.0, strength)?;
    let color = match extension.color("multiscatterColorFactor")? {
        None => extension.color("multiscatterColor")?,
        color => color,
    };
    Ok(Scatter {
        draft: ScatterDraft::Scatter,
        multiscatter_color: color.unwrap_or([1.0; 3]).map(|c| c * strength),
        anisotropy: extension.number("scatterAnisotropy", -1.0..=1.0, 0.0)?,
    })
}

fn diffuse_transmission(extension: &Extension<'_>) -> Result<DiffuseTransmission, Fault> {
    Ok(DiffuseTransmission {
        factor: extension.number("diffuseTransmissionFactor", 0.0..=1.0, 0.0)?,
        color: extension.color("diffuseTransmissionColorFactor")?.unwrap_or([1.0; 3]),
    })
}

/// The JSON of an extension and where it is.
struct Extension<'a> {
    element: String,
    json: &'a Value,
}

impl Extension<'_> {
    fn fault(&self, key: &str, reason: String) -> Fault {
        Fault::at(format!("{}.{key}", self.element), reason)
    }

    fn number(&self, key: &str, range: std::ops::RangeInclusive<f32>, default: f32) -> Result<f32, Fault> {
        let Some(value) = self.json.get(key) else { return Ok(default) };
        let number = value.as_f64().map(|x| x as f32).filter(|x| range.contains(x));
        number.ok_or_else(|| {
            self.fault(key, format!("it is no number in {:e}..={:e}", range.start(), range.end()))
        })
    }

    fn color(&self, key: &str) -> Result<Option<[f32; 3]>, Fault> {
        let Some(value) = self.json.get(key) else { return Ok(None) };
        let color = || {
            let numbers: &[Value; 3] = value.as_array()?.as_slice().try_into().ok()?;
            let mut color = [0.0; 3];
            for (component, number) in color.iter_mut().zip(numbers) {
                *component = number.as_f64().map(|x| x as f32).filter(|x| (0.0..=1.0).contains(x))?;
            }
            Some(color)
        };
        color().map(Some).ok_or_else(|| self.fault(key, "it is no colour of three numbers in 0..=1".into()))
    }
}
