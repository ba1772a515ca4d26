//! The same scene for the CPU twins.

use crate::Fixture;
use glam::{DMat4, DVec3, Mat4};
use translume::{BurleyFit, Deformation, Diffusion, Frame, Layer, Light, Lighting, Medium, Profile, Region};
use translume_mesh::Warp;
use translume_reference::gather::{Gather, Source};
use translume_reference::profile::{self, Channel, Entry, Numeric, Profile as _, Sheet};
use translume_reference::{Dipole, Surface, deform};

/// Where a body is and how it is bent.
#[derive(Clone, Debug)]
pub struct Pose {
    /// Model space to world space.
    pub model: Mat4,
    /// One weight per morph target.
    pub weights: Vec<f32>,
    /// One matrix per joint of the mesh's skin, or none for joints at rest.
    pub joints: Vec<[[f32; 4]; 4]>,
    /// Inflation, twist and bend.
    pub warp: Warp,
}

impl Pose {
    /// As loaded, for a mesh with this many morph targets.
    #[must_use]
    pub fn rest(targets: usize) -> Self {
        Self { model: Mat4::IDENTITY, weights: vec![0.0; targets], joints: Vec::new(), warp: Warp::default() }
    }

    /// The frame that shows this pose in this light.
    #[must_use]
    pub fn frame<'a>(&'a self, lights: &'a [Light]) -> Frame<'a> {
        let deformation = if self.joints.is_empty() {
            Deformation::Morph(&self.weights)
        } else {
            Deformation::Pose { weights: &self.weights, joints: &self.joints }
        };
        Frame {
            model: self.model.to_cols_array_2d(),
            deformation,
            warp: self.warp,
            lighting: Lighting::Lights(lights),
            casters: None,
            view: None,
        }
    }
}

impl Fixture {
    /// Vertex positions of a pose, mm.
    #[must_use]
    pub fn twin_positions(&self, pose: &Pose) -> Vec<[f64; 3]> {
        let weights: Vec<f64> = pose.weights.iter().copied().map(f64::from).collect();
        let joints: Vec<_> =
            pose.joints.iter().map(|joint| joint.map(|column| column.map(f64::from))).collect();
        let model = pose.model.as_dmat4();
        let deformed = deform::Pose { weights: &weights, joints: &joints, warp: pose.warp };
        deform::posed(&self.model.mesh, &deformed, 1.0)
            .into_iter()
            .map(|p| (model.transform_point3(p.into()) * self.mm_per_unit).to_array())
            .collect()
    }

    /// Vertex normals of a pose. A mesh that nothing deforms keeps its own.
    #[must_use]
    pub fn twin_normals(&self, pose: &Pose, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let model = pose.model.as_dmat4();
        let mesh = &self.model.mesh;
        if mesh.targets.is_empty() && mesh.skin.is_none() && pose.warp.is_identity() {
            let normal = DMat4::transpose(&model.inverse());
            let turned = mesh.normals.iter().map(|n| normal.transform_vector3(DVec3::from(n.map(f64::from))));
            return turned.map(|n| n.normalize().to_array()).collect();
        }
        let winding = model.determinant().signum();
        deform::normals(mesh, positions).into_iter().map(|n| n.map(|x| x * winding)).collect()
    }

    /// The surface of a pose that does not mirror.
    #[must_use]
    pub fn twin_surface(&self, pose: &Pose) -> Surface {
        let positions = self.twin_positions(pose);
        let normals = self.twin_normals(pose, &positions);
        Surface::new(positions, normals, self.model.mesh.triangles.clone(), self.flat_normals)
    }

    /// What the twin gathers, averaged over `samples`² points of each texel.
    #[must_use]
    pub fn twin_sources(&self, pose: &Pose, lights: &[Light], samples: u32) -> Vec<Source> {
        let lights: Vec<_> = lights.iter().map(|each| light(each, self.mm_per_unit)).collect();
        self.twin_sources_lit(pose, &lights, [samples, 16])
    }

    /// The same in lights of the twin, which also knows maps of the environment, with `rays`² rays to each area light or sky.
    #[must_use]
    pub fn twin_sources_lit(
        &self,
        pose: &Pose,
        lights: &[translume_reference::Light],
        [samples, rays]: [u32; 2],
    ) -> Vec<Source> {
        let rest = deform::positions(&self.model.mesh, &[], self.mm_per_unit);
        let gather = Gather {
            atlas: &self.model.atlas,
            rest: &rest,
            mm_per_unit: self.mm_per_unit,
            surface: &self.twin_surface(pose),
            lights,
            ior: f64::from(self.body.medium().ior),
            samples,
            rays,
        };
        gather.run()
    }
}

/// A light in millimetres. Intensity is per steradian, so its irradiance over distance² takes the square of the scale.
///
/// # Panics
/// For a kind of light the twins do not know.
#[must_use]
pub fn light(light: &Light, mm_per_unit: f64) -> translume_reference::Light {
    use translume_reference::Light as Twin;
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    let region = |region: Option<Region>| region.map(|r| (mm(r.low), mm(r.high)));
    match light {
        Light::Directional(light) => Twin::Directional {
            to_light: DVec3::from(light.to_light.map(f64::from)).normalize().to_array(),
            irradiance: light.irradiance.map(f64::from),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Point(light) => Twin::Point {
            position: mm(light.position),
            intensity: light.intensity.map(|x| f64::from(x) * mm_per_unit * mm_per_unit),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Spot(light) => Twin::Spot {
            position: mm(light.position),
            direction: light.direction.map(f64::from),
            intensity: light.intensity.map(|x| f64::from(x) * mm_per_unit * mm_per_unit),
            inner_angle: light.inner_angle.into(),
            outer_angle: light.outer_angle.into(),
            shadow: light.shadow,
            region: region(light.region),
        },
        Light::Rectangle(light) => Twin::Rectangle {
            center: mm(light.center),
            half_right: mm(light.half_right),
            half_up: mm(light.half_up),
            radiance: light.radiance.map(f64::from),
            shadow: light.shadow,
        },
        Light::Sphere(light) => Twin::Sphere {
            center: mm(light.center),
            radius: f64::from(light.radius) * mm_per_unit,
            radiance: light.radiance.map(f64::from),
            shadow: light.shadow,
        },
        Light::Ambient(light) => Twin::Ambient {
            radiance: light.radiance.map(f64::from),
            axis: DVec3::from(light.axis.map(f64::from)).normalize().to_array(),
            half_angle: light.half_angle.into(),
            shadow: light.shadow,
        },
        other => panic!("the twins do not know {other:?}"),
    }
}

/// The dipole of each channel.
#[must_use]
pub fn dipoles(medium: &Medium) -> [Dipole; 3] {
    let twin = translume_reference::Medium {
        sigma_s_prime: medium.sigma_s_prime.map(f64::from),
        sigma_a: medium.sigma_a.map(f64::from),
        ior: medium.ior.into(),
    };
    twin.dipoles()
}

/// Any profile of each channel, by the twin's own quadrature.
///
/// # Panics
/// For a kind of profile the twins do not know.
#[must_use]
pub fn profiles(profile: &Profile, medium: &Medium) -> [Numeric; 3] {
    std::array::from_fn(|channel| numeric(profile, medium, channel))
}

/// For each channel: their totals are then known to some 0.3 %.
const WALKS: u64 = 100_000;

fn channel(medium: &Medium, index: usize) -> Channel {
    let [sigma_s_prime, sigma_a] = [medium.sigma_s_prime[index], medium.sigma_a[index]].map(f64::from);
    Channel { sigma_s_prime, sigma_a, ior: medium.ior.into() }
}

fn numeric(kind: &Profile, medium: &Medium, index: usize) -> Numeric {
    let colour = channel(medium, index);
    let white = Channel { sigma_s_prime: colour.sigma_t(), sigma_a: 0.0, ..colour };
    let dipole = dipoles(medium)[index];
    match kind {
        Profile::Dipole | Profile::DipoleNormalised => {
            let z = dipole.z[0];
            Numeric::new(|r| dipole.reflectance(r), dipole.sigma_tr, z, [1e-4 * z, 1e4 * z])
        }
        Profile::HalfSpace(entry) => {
            let way = if *entry == translume::Entry::Normal { Entry::Normal } else { Entry::Diffuse };
            profile::half_space(&colour, way, &profile::walks(&colour, way, WALKS).finish())
        }
        Profile::BetterDipole => profile::better_dipole(&colour),
        Profile::PhotonBeam => profile::photon_beam(&colour),
        Profile::WithSingleScattering(Diffusion::Dipole) => profile::with_single(&colour, &dipole, 1.0),
        Profile::WithSingleScattering(Diffusion::BetterDipole) => {
            profile::with_single(&colour, &profile::better_dipole(&colour), 1.0)
        }
        Profile::WithSingleScattering(Diffusion::PhotonBeam) => {
            let total = profile::photon_beam(&white).total();
            profile::with_single(&colour, &profile::photon_beam(&colour), total)
        }
        Profile::NormalisedDiffusion(fit) => {
            let entry = if *fit == BurleyFit::Searchlight { Entry::Normal } else { Entry::Diffuse };
            let length = match fit {
                BurleyFit::DiffuseMeanFreePath(lengths) => Some(f64::from(lengths[index])),
                _ => None,
            };
            profile::normalised_diffusion(&colour, entry, length)
        }
        Profile::Multipole(layers) => {
            let top = Layer { medium: *medium, thickness_mm: layers.thickness_mm };
            let sheet = |layer: &Layer| Sheet {
                channel: channel(&layer.medium, index),
                thickness: layer.thickness_mm.into(),
            };
            let sheets: Vec<_> = std::iter::once(&top).chain(layers.below.iter()).map(sheet).collect();
            profile::stack(&sheets, [3e-3, 15.0], 0.1)
        }
        Profile::Tabulated(table) => {
            let radii: Vec<f64> = table.radii.iter().map(|&r| r.into()).collect();
            let values: Vec<f64> = table.values.iter().map(|v| v[index].into()).collect();
            profile::table(&radii, &values)
        }
        other => panic!("the twins do not know {other:?}"),
    }
}

/// Irradiance of sources.
#[must_use]
pub fn luminous(sources: &[Source]) -> Vec<[f64; 3]> {
    sources.iter().map(|source| source.irradiance).collect()
}

/// Σ value · area over the texels.
#[must_use]
pub fn sum(values: &[[f64; 3]], sources: &[Source]) -> [f64; 3] {
    let each = values.iter().zip(sources).map(|(value, source)| DVec3::from(*value) * source.area);
    each.sum::<DVec3>().to_array()
}
