//! What a host may change between frames, and look at.

use super::Body;
use super::kernel::{check_kernel, check_method};
use super::solver::check_transport;
use crate::boundary::Boundary;
use crate::buffers::Outputs;
use crate::evaluate::Evaluate;
use crate::stages::scatter::Method;
use crate::stages::visibility::SkyMemory;
use crate::stages::{Stage, StageSet};
use crate::variation::{VERTEX_MARK, Variation};
use crate::{Error, Geometry, Medium, Profile, ShadowOptions, Transport, View, transport};

impl Body {
    /// Changes how finely shadows are computed; the next frame looks anew from every light.
    ///
    /// # Errors
    /// [`Error::Shadow`] names the number that cannot be.
    pub fn set_shadows(&mut self, shadows: ShadowOptions) -> Result<(), Error> {
        shadows.validate(self.limits.max_texture_dimension_2d)?;
        let ShadowOptions { directions, direction_resolution, .. } = self.shadows;
        if (directions, direction_resolution) != (shadows.directions, shadows.direction_resolution) {
            self.sky = SkyMemory::new(&shadows);
        }
        self.shadows_stale |= shadows != self.shadows;
        self.shadows = shadows;
        Ok(())
    }

    /// How finely shadows are computed.
    #[must_use]
    pub fn shadows(&self) -> &ShadowOptions {
        &self.shadows
    }

    /// Changes the medium; the next frame scatters anew, and gathers too if the index of refraction or the profile's gain of
    /// entry changed.
    ///
    /// # Errors
    /// [`Error::Medium`] names the coefficient that cannot be.
    pub fn set_medium(&mut self, medium: Medium) -> Result<(), Error> {
        medium.validate()?;
        self.scatter_stale |= medium != self.medium;
        self.medium = medium;
        self.renew_surface();
        Ok(())
    }

    /// Makes the medium differ from texel to texel of the atlas, or with `None` no more; the next frame clusters and scatters anew.
    /// [`Method::Pattern`] heeds the albedo alone.
    ///
    /// # Errors
    /// [`Error::Frame`] names the texel whose variation is out of range, or how many there are of how many.
    pub fn set_variation(
        &mut self,
        queue: &wgpu::Queue,
        variation: Option<&[Variation]>,
    ) -> Result<(), Error> {
        let texels = self.marks.len();
        if let Some(count) = variation.map(<[_]>::len).filter(|count| *count != texels) {
            return Err(Error::Frame {
                problem: format!("the medium varies over {count} of {texels} texels"),
                remedy: "give one variation for each texel of the atlas",
            });
        }
        let variation = variation.unwrap_or_default();
        variation.iter().enumerate().try_for_each(|(texel, v)| v.validate(texel))?;
        let mut marks = self.marks.clone();
        for (mark, v) in marks.iter_mut().zip(variation) {
            *mark = *mark & VERTEX_MARK | v.mark();
        }
        queue.write_buffer(&self.buffers.marks, 0, bytemuck::cast_slice(&marks));
        self.kind.scaled = variation.iter().any(|v| v.scale != 1.0);
        self.greatest_scale = variation.iter().map(|v| v.scale).fold(1.0, f32::max);
        self.method_stale = true;
        self.pending.insert(StageSet::from_stage_on(Stage::Cluster));
        Ok(())
    }

    /// Changes the profile; the next frame scatters anew, unless both are classical dipoles, which differ in how light leaves alone, and gathers
    /// too where the gain of entry is another.
    ///
    /// # Errors
    /// [`Error::Profile`] names the parameter that cannot be, [`Error::Medium`] the coefficient of a layer.
    pub fn set_profile(&mut self, profile: Profile) -> Result<(), Error> {
        profile.validate()?;
        check_kernel(&profile, self.method, self.evaluate)?;
        self.scatter_stale |= !profile.scatters_like(&self.profile);
        self.profile = profile;
        self.renew_surface();
        Ok(())
    }

    /// What medium and profile say of how light enters and leaves.
    pub(super) fn renew_surface(&mut self) {
        let boundary = Boundary::new(&self.profile, &self.medium, self.solver.runs);
        self.surface_stale |= boundary != self.boundary;
        self.boundary = boundary;
        self.exit_scale = match self.solver.runs {
            Transport::Classic => self.profile.exit_scale(self.medium.ior),
            _ => transport::exit_scale(self.medium.ior),
        };
    }

    /// Changes how light goes through the body; the next frame scatters anew, and gathers too where the gain of entry is another.
    ///
    /// # Errors
    /// [`Error::Frame`] where the method or the place of evaluation is not the solver's, [`Error::Limit`] where the device cannot hold what it
    /// remembers.
    pub fn set_transport(&mut self, transport: Transport) -> Result<(), Error> {
        check_transport(self.extent.texels, transport, self.method, self.evaluate, &self.limits)?;
        self.solver.asked = transport;
        Ok(())
    }

    /// How light goes through the body, as it was asked for.
    #[must_use]
    pub fn transport(&self) -> Transport {
        self.solver.asked
    }

    /// How it goes through the body that was prepared last; never [`Transport::Auto`].
    #[must_use]
    pub fn transport_in_use(&self) -> Transport {
        self.solver.runs
    }

    /// Whether the frame that was prepared last is as right as it gets: a boundary solver comes closer in the few frames after the last change. Always,
    /// with [`Transport::Classic`].
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.solver.is_settled()
    }

    /// Changes how the scatter sum is evaluated; the next frame scatters anew.
    ///
    /// # Errors
    /// [`Error::Frame`] for an opening angle outside its range, [`Error::Limit`] where the device cannot hold what the method remembers.
    pub fn set_method(&mut self, method: Method) -> Result<(), Error> {
        method.validate()?;
        check_method(&self.tree, method, self.evaluate, &self.limits)?;
        check_transport(self.extent.texels, self.solver.asked, method, self.evaluate, &self.limits)?;
        check_kernel(&self.profile, method, self.evaluate)?;
        self.method_stale |= method != self.method;
        self.method = method;
        Ok(())
    }

    /// Changes where exitance is evaluated; the next frame scatters anew if that is elsewhere.
    ///
    /// # Errors
    /// [`Error::Frame`] where the method has no points, [`Error::Limit`] where the device cannot hold what it remembers.
    pub fn set_evaluate(&mut self, evaluate: Evaluate) -> Result<(), Error> {
        check_method(&self.tree, self.method, evaluate, &self.limits)?;
        check_transport(self.extent.texels, self.solver.asked, self.method, evaluate, &self.limits)?;
        check_kernel(&self.profile, self.method, evaluate)?;
        self.evaluate = evaluate;
        Ok(())
    }

    /// Where the last prepared frame is evaluated; never [`Evaluate::Auto`].
    #[must_use]
    pub fn evaluated(&self) -> Evaluate {
        self.evaluated
    }

    /// The medium.
    #[must_use]
    pub fn medium(&self) -> &Medium {
        &self.medium
    }

    /// The profile.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Radiant exitance B over the atlas, `Rgba32Float`: linear RGB, alpha 1 where a texel or gutter is. Sample it with
    /// [`translume_shaders::MATERIAL`].
    #[must_use]
    pub fn exitance_view(&self) -> &wgpu::TextureView {
        &self.exitance_view
    }

    /// The texture behind [`exitance_view`](Self::exitance_view); it can be copied from.
    #[must_use]
    pub fn exitance_texture(&self) -> &wgpu::Texture {
        &self.exitance
    }

    /// The deformed surface, for pipelines of the host's own.
    #[must_use]
    pub fn geometry(&self) -> Geometry<'_> {
        Geometry {
            vertices: &self.buffers.atlas_vertices,
            corners: &self.buffers.corners,
            indices: &self.buffers.atlas_indices,
            index_count: self.extent.triangles * 3,
        }
    }

    /// Pixels of a picture that the box around the body covers at most, in the pose that was prepared last: for choosing a level of detail, and 0
    /// where it is out of sight.
    #[must_use]
    pub fn covered(&self, view: &View) -> f32 {
        let corners =
            self.bounds.posed(&self.pose).corners().map(|corner| self.model.transform_point3(corner));
        view.covered(corners.into_iter())
    }

    /// How many texels light is computed at.
    #[must_use]
    pub fn texels(&self) -> u32 {
        self.extent.texels
    }

    /// What the stages wrote, for copies and read-back.
    #[must_use]
    pub fn outputs(&self) -> Outputs<'_> {
        self.buffers.outputs(&self.depth_maps, self.dual.as_ref(), self.solver.state())
    }
}
