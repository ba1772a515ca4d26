//! Tests of the public interface. `TRANSLUME_MODELS` names a folder of real models; without it those tests do nothing.

#[cfg(test)]
mod atlas;
#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod holes;
#[cfg(test)]
#[cfg(feature = "load")]
mod load_gltf;
#[cfg(test)]
#[cfg(feature = "load")]
mod load_obj;
#[cfg(test)]
#[cfg(feature = "load")]
mod load_ply;
#[cfg(test)]
#[cfg(all(feature = "load", feature = "unwrap"))]
mod models;
#[cfg(test)]
mod normals;
#[cfg(test)]
mod order;
#[cfg(test)]
mod repair;
#[cfg(test)]
mod repair_options;
#[cfg(test)]
mod spherical;
#[cfg(test)]
#[cfg(feature = "unwrap")]
mod unwrap;
