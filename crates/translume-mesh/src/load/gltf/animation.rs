//! Animations of the nodes of a scene.

use gltf::animation::{Interpolation as Mode, Property};

use super::budget::{Budget, cost};
use super::morph::Morphs;
use super::primitive::in_accessor;
use super::scene::Scene;
use super::{Fault, finite};
use crate::load::accessor;
use crate::load::buffers::Buffer;
use crate::rig::{Animation, Channel, Interpolation, Local, Target};

/// What channels are read against.
pub(super) struct Reader<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) morphs: &'a Morphs,
    pub(super) buffers: &'a [Buffer],
}

impl Reader<'_> {
    /// Every animation of the document. Channels that move nothing in the scene are left out.
    pub(super) fn animations(
        &self,
        document: &gltf::Document,
        budget: &mut Budget,
    ) -> Result<Vec<Animation>, Fault> {
        document.animations().map(|animation| self.animation(&animation, budget)).collect()
    }

    fn animation(&self, animation: &gltf::Animation<'_>, budget: &mut Budget) -> Result<Animation, Fault> {
        let mut channels = Vec::new();
        for channel in animation.channels() {
            let fault = |reason| {
                Fault::at(format!("animations[{}].channels[{}]", animation.index(), channel.index()), reason)
            };
            if let Some(target) = self.target(&channel.target()).map_err(fault)? {
                channels.push(self.channel(&channel.sampler(), target, budget).map_err(fault)?);
            }
        }
        let ends = channels.iter().filter_map(|channel| channel.times.last());
        let duration = ends.copied().fold(0.0, f32::max);
        Ok(Animation { name: animation.name().unwrap_or_default().into(), duration, channels })
    }

    fn target(&self, target: &gltf::animation::Target<'_>) -> Result<Option<Target>, String> {
        let index = target.node().index();
        let Some(place) = self.scene.place(index) else { return Ok(None) };
        let node = place as u32;
        let moved = match target.property() {
            Property::Translation => Target::Translation(node),
            Property::Rotation => Target::Rotation(node),
            Property::Scale => Target::Scale(node),
            Property::MorphTargetWeights => {
                let range = self.morphs.range(place);
                let (first, count) = (range.start as u32, range.len() as u32);
                // The targets may belong to lines or points, which are not read.
                return Ok((count > 0).then_some(Target::Weights { first, count }));
            }
        };
        if matches!(self.scene.nodes[place].local, Local::Matrix(_)) {
            return Err(format!("nodes[{index}] stands by a matrix, which cannot be animated"));
        }
        Ok(Some(moved))
    }

    fn channel(
        &self,
        sampler: &gltf::animation::Sampler<'_>,
        target: Target,
        budget: &mut Budget,
    ) -> Result<Channel, String> {
        let input = sampler.input();
        let at = in_accessor(input.index());
        budget.take(input.count(), cost::NUMBER)?;
        let times: Vec<[f32; 1]> =
            accessor::numbers(&input, self.buffers, (input.count(), "keys")).map_err(&at)?;
        let times = times.into_flattened();
        check_times(&times).map_err(at)?;
        let (interpolation, parts) = match sampler.interpolation() {
            Mode::Step => (Interpolation::Step, 1),
            Mode::Linear => (Interpolation::Linear, 1),
            Mode::CubicSpline => (Interpolation::CubicSpline, 3),
        };
        let values = self.values(&sampler.output(), target, times.len().saturating_mul(parts), budget)?;
        Ok(Channel { target, interpolation, times, values })
    }

    /// `count` values of what the target needs.
    fn values(
        &self,
        output: &gltf::Accessor<'_>,
        target: Target,
        count: usize,
        budget: &mut Budget,
    ) -> Result<Vec<f32>, String> {
        let at = in_accessor(output.index());
        let width = match target {
            Target::Translation(_) | Target::Scale(_) => 3,
            Target::Rotation(_) => 4,
            Target::Weights { count, .. } => count as usize,
        };
        let numbers = count.saturating_mul(width);
        let elements = if matches!(target, Target::Weights { .. }) { numbers } else { count };
        if output.count() != elements {
            return Err(at(format!("it has {} elements, but the keys need {elements}", output.count())));
        }
        budget.take(numbers, cost::NUMBER)?;
        let of = (elements, "values");
        let values = match target {
            Target::Translation(_) | Target::Scale(_) => {
                accessor::numbers::<3>(output, self.buffers, of).map(Vec::into_flattened)
            }
            Target::Rotation(_) => accessor::numbers::<4>(output, self.buffers, of).map(Vec::into_flattened),
            Target::Weights { .. } => {
                accessor::numbers::<1>(output, self.buffers, of).map(Vec::into_flattened)
            }
        }
        .map_err(&at)?;
        finite(&values).map_err(at)?;
        Ok(values)
    }
}

fn check_times(times: &[f32]) -> Result<(), String> {
    if times.is_empty() {
        return Err("it has no keys".into());
    }
    finite(times)?;
    match times.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(k) => Err(format!("key {} at {} s does not come after {} s", k + 1, times[k + 1], times[k])),
        None => Ok(()),
    }
}
