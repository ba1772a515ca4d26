//! `translume profile`: random walks of a medium become a table that `render --profile` takes.

use crate::cli;
use crate::error::Error;
use crate::files;
use crate::progress;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use translume::{Medium, Profile, Table};
use translume_reference::profile::{Channel, Entry, Numeric, Profile as _, half_space, walks};

/// Entries per octave of radius; between two of them a table is a power law.
const PER_OCTAVE: f64 = 6.0;
/// First and last radius in mean free paths, and in lengths of decay. Below the first 0.3 % of the light is lost at most.
const FIRST: f64 = 1e-3;
const LAST: f64 = 1e3;
const DECAYS: f64 = 25.0;
/// Stands for nothing, where a wide channel goes on and a narrow one has ended.
const LEAST: f64 = 1e-30;

/// The file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TableFile {
    radii_mm: Vec<f32>,
    reflectance_per_mm2: Vec<[f32; 3]>,
}

/// The profile of this name, or the table in a file of `directory` whose name ends in .json.
pub fn open(name: &str, directory: &Path) -> Result<Profile, Error> {
    if Path::new(name).extension().is_none_or(|extension| extension != "json") {
        return Ok(Profile::named(name)?);
    }
    let path = directory.join(name);
    let fail = |problem: String| Error::Table { path: path.clone(), problem };
    let text = files::read_to_string(&path).map_err(|error| fail(format!("cannot be read: {error}")))?;
    let file: TableFile = serde_json::from_str(&text)
        .map_err(|error| fail(format!("is not a table: {error}; `translume profile` writes one")))?;
    let profile =
        Profile::Tabulated(Table { radii: file.radii_mm.into(), values: file.reflectance_per_mm2.into() });
    profile.validate().map_err(|error| fail(error.to_string()))?;
    Ok(profile)
}

pub fn run(arguments: &cli::Profile) -> Result<(), Error> {
    let medium = medium(arguments)?;
    let entry = if arguments.entry == "normal" { Entry::Normal } else { Entry::Diffuse };
    let path = path(arguments, &medium);
    if arguments.output.is_dir() && path.exists() {
        progress::tell(&format!("{} is there already", path.display()));
        return Ok(());
    }
    let channels = [0, 1, 2].map(|k| Channel {
        sigma_s_prime: medium.sigma_s_prime[k].into(),
        sigma_a: medium.sigma_a[k].into(),
        ior: medium.ior.into(),
    });
    let bar = progress::bar("profile");
    bar.set_length(3000);
    let mut profiles = Vec::new();
    for (k, channel) in (0_u64..).zip(&channels) {
        let show = |share: f64| {
            bar.set_position(1000 * k + (1000.0 * share) as u64);
            ControlFlow::Continue(())
        };
        if let Some(light) = walks(channel, entry, arguments.photons).run(&show) {
            profiles.push(half_space(channel, entry, &light));
        }
    }
    bar.finish_and_clear();
    let fail = |problem: String| Error::Output { path: path.clone(), problem };
    let text = serde_json::to_string(&table(&channels, &profiles)).map_err(|e| fail(e.to_string()))?;
    std::fs::write(&path, text).map_err(|error| fail(format!("cannot be written: {error}")))?;
    progress::tell(&format!("{}: for `translume render --profile`", path.display()));
    Ok(())
}

/// In a folder the file is named after everything that makes it.
fn path(arguments: &cli::Profile, medium: &Medium) -> PathBuf {
    if !arguments.output.is_dir() {
        return arguments.output.clone();
    }
    let list = |values: [f32; 3]| values.map(|x| x.to_string()).join("-");
    arguments.output.join(format!(
        "s{}_a{}_ior{}_{}_{}.json",
        list(medium.sigma_s_prime),
        list(medium.sigma_a),
        medium.ior,
        arguments.entry,
        arguments.photons
    ))
}

fn medium(arguments: &cli::Profile) -> Result<Medium, Error> {
    let named = arguments.medium.as_deref().map(Medium::preset).transpose()?.unwrap_or_default();
    let medium = Medium {
        sigma_s_prime: arguments.scattering.unwrap_or(named.sigma_s_prime),
        sigma_a: arguments.absorption.unwrap_or(named.sigma_a),
        ior: arguments.ior.unwrap_or(named.ior),
        ..named
    };
    medium.validate()?;
    if medium.sigma_s_prime.contains(&0.0) {
        let problem = "a channel that does not scatter has no profile; give one above 0".to_owned();
        return Err(Error::Option { option: "--scattering", problem });
    }
    Ok(medium)
}

/// All channels at the same radii, for as far as the widest goes.
fn table(channels: &[Channel; 3], profiles: &[Numeric]) -> TableFile {
    let first = channels.iter().map(|c| FIRST / c.sigma_t()).fold(f64::MAX, f64::min);
    let end =
        |(channel, profile): (&Channel, &Numeric)| (LAST / channel.sigma_t()).min(DECAYS / profile.decay());
    let last = channels.iter().zip(profiles).map(end).fold(0.0, f64::max);
    let count = (PER_OCTAVE * (last / first).log2()).ceil() as usize;
    let radii = (0..=count).map(|k| first * (k as f64 / PER_OCTAVE).exp2());
    let value = |r: f64| {
        let of = |k: usize| profiles.get(k).map_or(0.0, |profile: &Numeric| profile.reflectance(r));
        [0, 1, 2].map(|k| of(k).max(LEAST * first / r) as f32)
    };
    TableFile {
        reflectance_per_mm2: radii.clone().map(value).collect(),
        radii_mm: radii.map(|r| r as f32).collect(),
    }
}
