//! What a body is made of.

use crate::bounds::WEIGHT_SLACK;
use crate::{Error, Evaluate, Medium, Method, Profile, ShadowOptions, Transport};
use translume_mesh::repair::RepairReport;
use translume_mesh::{Atlas, Influence, Mesh, Skin};

/// What a body is made of and how it is computed.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, translume: &translume::Translume, mesh: &translume_mesh::Mesh,
/// #     atlas: &translume_mesh::Atlas) -> Result<(), translume::Error> {
/// use translume::{BodyDescriptor, Medium, Method, ShadowOptions};
///
/// let body = translume.create_body(device, &BodyDescriptor {
///     medium: Medium::WAX,
///     mm_per_unit: 10.0, // an engine that counts in centimetres
///     method: Method::Within { tolerance: 0.03 },
///     shadows: ShadowOptions { resolution: 512, ..Default::default() },
///     ..BodyDescriptor::new(mesh, atlas)
/// })?;
/// # Ok(()) }
/// ```
#[derive(Clone, Debug)]
pub struct BodyDescriptor<'a> {
    /// The mesh, clean (see [`translume_mesh::repair`]).
    pub mesh: &'a Mesh,
    /// Its atlas.
    pub atlas: &'a Atlas,
    /// The medium.
    pub medium: Medium,
    /// The profile.
    pub profile: Profile,
    /// How light goes through the body.
    pub transport: Transport,
    /// How the scatter sum is evaluated.
    pub method: Method,
    /// Memory of [`Method::Dual`] for open sources, in entries of four bytes per texel, 0..=1024; no more than one storage binding
    /// holds are made, and more at smaller opening angles. What finds no room takes longer, but is not lost
    /// ([`Outputs::lists`](crate::Outputs::lists) counts it); the same input then need not give the same bits. Bodies lit from
    /// everywhere took 6 to 17 at a tolerance of 1 %.
    pub list_entries: u32,
    /// Where exitance is evaluated.
    pub evaluate: Evaluate,
    /// Millimetres per world unit: 1000 for an engine that counts in metres. Finite, > 0.
    pub mm_per_unit: f32,
    /// Whether each triangle keeps its own normal instead of the smooth vertex normals.
    pub flat_normals: bool,
    /// How finely shadows are computed.
    pub shadows: ShadowOptions,
    /// Whether the body takes turns with others of its device that do, for what none needs beyond its own part of a frame: depth maps, and
    /// lists of the scatter. Then a light that changes costs the same as before, but a change of the medium's index of refraction looks from the
    /// lights again, and [`Gloss`](crate::Gloss) reflects lights without their shadows. For scenes of many bodies; off by default.
    pub shares_scratch: bool,
    /// For frames of [`Deformation::Vertices`](crate::Deformation::Vertices): where each vertex of the mesh is among the host's, as in
    /// [`RepairReport::origins`](translume_mesh::repair::RepairReport::origins). `None` where they are numbered alike.
    pub host_vertices: Option<&'a [u32]>,
}

impl<'a> BodyDescriptor<'a> {
    /// Defaults for everything but the shape: marble, half-space, dual, metres, smooth normals.
    #[must_use]
    pub fn new(mesh: &'a Mesh, atlas: &'a Atlas) -> Self {
        Self {
            mesh,
            atlas,
            medium: Medium::default(),
            profile: Profile::default(),
            transport: Transport::default(),
            method: Method::default(),
            list_entries: 32,
            evaluate: Evaluate::default(),
            mm_per_unit: 1000.0,
            flat_normals: false,
            shadows: ShadowOptions::default(),
            shares_scratch: false,
            host_vertices: None,
        }
    }

    /// Checks everything. `limit` is the widest texture of the device.
    pub(crate) fn validate(&self, limit: u32) -> Result<(), Error> {
        validate_shape(self.mesh, self.atlas)?;
        self.medium.validate()?;
        self.profile.validate()?;
        self.method.validate()?;
        let fail =
            |problem: String, remedy| Err(Error::Body { mesh: self.mesh.name.clone(), problem, remedy });
        if !(self.mm_per_unit > 0.0 && self.mm_per_unit.is_finite()) {
            let problem = format!("{} mm per unit", self.mm_per_unit);
            return fail(problem, "give a finite scale above 0");
        }
        if !(0..=1024).contains(&self.list_entries) {
            let problem = format!("{} words a texel for the lists of the scatter", self.list_entries);
            return fail(problem, "give at most 1024");
        }
        if let Some(numbers) = self.host_vertices {
            let vertices = self.mesh.positions.len();
            if numbers.len() != vertices {
                let problem = format!("{} numbers of the host for {vertices} vertices", numbers.len());
                return fail(problem, "give one for each vertex of the mesh");
            }
            if let Some(vertex) = numbers.iter().position(|number| *number == RepairReport::NEW) {
                let problem = format!("vertex {vertex} is none of the host's");
                return fail(problem, "leave the holes open, or let the library deform the mesh");
            }
        }
        self.shadows.validate(limit)
    }
}

/// Whether mesh and atlas belong together and every index leads somewhere.
fn validate_shape(mesh: &Mesh, atlas: &Atlas) -> Result<(), Error> {
    const REPAIR: &str = "pass the mesh through `translume_mesh::repair` first";
    const REBUILD: &str = "build the atlas from this very mesh";
    let fail = |problem: String, remedy| Err(Error::Body { mesh: mesh.name.clone(), problem, remedy });
    let vertices = mesh.positions.len();
    if mesh.triangles.is_empty() || atlas.texels.is_empty() {
        return fail("no triangle or no texel, so nothing to light".to_owned(), REPAIR);
    }
    if mesh.normals.len() != vertices {
        return fail(format!("{} normals for {vertices} vertices", mesh.normals.len()), REPAIR);
    }
    if let Some(vertex) =
        (0..vertices).find(|&v| !mesh.positions[v].iter().chain(&mesh.normals[v]).all(|x| x.is_finite()))
    {
        return fail(format!("vertex {vertex} is not finite"), REPAIR);
    }
    if let Some(triangle) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices)) {
        return fail(format!("triangle {triangle} uses a vertex beyond the {vertices} there are"), REPAIR);
    }
    for (k, target) in mesh.targets.iter().enumerate() {
        if target.position_deltas.len() != vertices
            || !target.position_deltas.iter().flatten().all(|x| x.is_finite())
        {
            return fail(format!("morph target {k} needs {vertices} finite deltas"), REPAIR);
        }
    }
    if let Some(problem) = mesh.skin.as_ref().and_then(|skin| skin_problem(skin, vertices)) {
        return fail(problem, "re-export the mesh with its skin, or drop the skin");
    }
    if atlas.triangles.len() != mesh.triangles.len()
        || atlas.vertices.iter().any(|v| v.xref as usize >= vertices)
    {
        return fail("the atlas was built from another mesh".to_owned(), REBUILD);
    }
    if atlas.triangles.iter().flatten().any(|&v| v as usize >= atlas.vertices.len()) {
        return fail("the atlas uses vertices it does not have".to_owned(), REBUILD);
    }
    if atlas.pixels.len() != (atlas.size as usize).pow(2) {
        return fail(format!("the atlas has {} pixels for {}²", atlas.pixels.len(), atlas.size), REBUILD);
    }
    let strays = |texel: &u32| *texel != Atlas::EMPTY && *texel as usize >= atlas.texels.len();
    if atlas.size == 0 || atlas.pixels.iter().any(strays) {
        return fail("a pixel of the atlas shows a texel that is not there".to_owned(), REBUILD);
    }
    if let Some(k) = atlas.texels.iter().position(|t| t.pixel.iter().any(|&x| u32::from(x) >= atlas.size)) {
        return fail(format!("texel {k} of the atlas lies outside of it"), REBUILD);
    }
    if let Some(k) =
        atlas.texels.iter().position(|t| t.triangle as usize >= mesh.triangles.len() || !t.area.is_finite())
    {
        return fail(format!("texel {k} of the atlas stands on no triangle"), REBUILD);
    }
    Ok(())
}

/// What is wrong with a skin.
fn skin_problem(skin: &Skin, vertices: usize) -> Option<String> {
    let Skin { joints, per_vertex, influences } = skin;
    if *per_vertex == 0 || per_vertex.checked_mul(vertices) != Some(influences.len()) {
        return Some(format!(
            "{} influences, {per_vertex} for each of {vertices} vertices",
            influences.len()
        ));
    }
    if let Some(k) = influences.iter().position(|influence| influence.joint as usize >= *joints) {
        let vertex = k / per_vertex;
        return Some(format!(
            "vertex {vertex} follows joint {}, but there are {joints}",
            influences[k].joint
        ));
    }
    let whole = |vertex: &[Influence]| {
        let sum: f32 = vertex.iter().map(|influence| influence.weight).sum();
        vertex.iter().all(|influence| influence.weight >= 0.0) && (sum - 1.0).abs() <= WEIGHT_SLACK
    };
    let vertex = influences.chunks(*per_vertex).position(|vertex| !whole(vertex))?;
    Some(format!("the shares of the joints in vertex {vertex} are not 0 or more, adding up to 1"))
}
