//! What can be said on the command line.

use crate::scene::Quality;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  translume                                                            a window
  translume view bunny.obj                                             the same, on a model of yours
  translume render creature --medium jade -o creature.png
  translume render bunny.obj --medium skimmilk --size 1024 -o bunny.png
  translume render creature --medium wax --frames 48 -o morph.png      an animated PNG
  translume render fox.glb --animation Walk --frames 24 -o walk.png    another
  translume render spot.obj --twist 90 --bend 40 -o candy.png
  translume render teapot --env sky.exr -o outdoors.png                light from all around
  translume render bunny.obj --into egg --frames 48 -o egg.png         whatever is closed melts
  translume render --scene scene.json -o scene.exr                     linear radiance, full float
  translume render creature --frames 9 --timings -o morph.png          and how long each stage took
  translume trace scene.json --noise 0.05 -o truth.exr                 the same scene by paths: slow, and exact but for noise
  translume inspect bunny.obj --json
  translume inspect creature teapot bunny.obj --table                  a line for each
  translume report --suite -o report                                   every method in every scene: a page for a browser
  translume report scene.json -o report                                the same of a scene of yours
  translume profile --medium marble -o marble.json                     random walks, as exact as you have patience
  translume render creature --medium marble --profile marble.json -o creature.png
  translume report --suite gather -o report                            error beside time of every kind of light
  translume report --suite scatter -o report                           and of every method
  translume report --suite transport -o report                         how far models of light are from paths, by dense sums

MODEL is an OBJ, glTF or GLB file, or a built-in: sphere, torus-knot, teapot, creature.
RUST_LOG=info shows what wgpu has to say; WGPU_ADAPTER_NAME picks an adapter.";

/// Translucent objects that deform, rendered in real time.
#[derive(Debug, Parser)]
#[command(name = "translume", version, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do; by default a window opens.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// A command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open a window on a model or a scene.
    #[command(after_help = EXAMPLES)]
    View(View),
    /// Render a model or a scene to a PNG (tone-mapped sRGB) or an EXR (linear radiance).
    #[command(after_help = EXAMPLES)]
    Render(Box<Render>),
    /// Follow paths of light through a scene: the truth that pictures are held against, to a PNG or an EXR.
    #[command(after_help = EXAMPLES)]
    Trace(Trace),
    /// Tell what a model holds and how it unwraps.
    #[command(after_help = EXAMPLES)]
    Inspect(Inspect),
    /// Walk light through a flat half-space of a medium and write what returns, as a table for `render --profile`.
    #[command(after_help = EXAMPLES)]
    Profile(Profile),
    /// Measure speed and error against the CPU reference; writes tables and a plot.
    #[command(after_help = EXAMPLES)]
    Report(Report),
}

/// `translume view`.
#[derive(Debug, Args)]
pub struct View {
    /// OBJ, glTF or GLB file, a scene (FILE.json), or the name of a built-in model. By default what was shown when the window was last closed.
    #[arg(value_name = "MODEL|SCENE")]
    pub name: Option<String>,
}

/// `translume render`.
#[derive(Debug, Args)]
pub struct Render {
    /// OBJ, glTF or GLB file, or the name of a built-in model.
    #[arg(required_unless_present = "scene", conflicts_with = "scene")]
    pub model: Option<String>,
    /// Scene description in JSON.
    #[arg(long, value_name = "FILE.json")]
    pub scene: Option<PathBuf>,
    /// Medium by name, as jade, wax, skimmilk, marble, skin1; a wrong name lists them all.
    #[arg(long, value_name = "NAME")]
    pub medium: Option<String>,
    /// Texture of albedo, .png or .jpg, on the model's own texture coordinates: how much of the light comes back.
    #[arg(long, value_name = "FILE")]
    pub albedo: Option<PathBuf>,
    /// Millimetres per unit of the model. By default a model is taken to be 100 mm from corner to corner.
    #[arg(long, value_name = "X")]
    pub mm_per_unit: Option<f32>,
    /// Width of the picture in pixels; the height follows the scene's camera, else the picture is square.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub size: Option<u32>,
    /// How the surface is laid out.
    #[command(flatten)]
    pub layout: Layout,
    /// Even out charts until every texel holds about the same area of the surface.
    #[arg(long)]
    pub even: bool,
    /// Finer texels where the body is thinner than this, for what shines through; six mean free paths of light serve, which is 3 to 9 mm in skin, milk or jade.
    #[arg(long, value_name = "MM")]
    pub finer_below: Option<f32>,
    /// How light goes through the body: auto (the default: layers where light crosses the body, classic where it stays at the surface or a profile or
    /// method is asked for), classic (as if the body were a half-space around every texel), boundary (diffusion with the boundary that the body has, for
    /// thin parts and light from behind), or layers (the same, and light leaves as the field under the surface says).
    #[arg(long, value_name = "NAME")]
    pub transport: Option<String>,
    /// Diffuse profile: half-space (random walks, tabulated, light by its angle; the default), half-space-diffuse (all light as from all sides), dipole (the paper's formula to the letter), dipole-normalised, dipole-oriented (its sources below and above the surface), better-dipole, photon-beam, normalised-diffusion,
    /// normalised-diffusion-searchlight; a dipole, the better one or photon-beam with -single adds light scattered once; or
    /// a table that `translume profile` wrote, by the name of its .json.
    #[arg(long, value_name = "NAME")]
    pub profile: Option<String>,
    /// How the scatter sum is evaluated: dual (groups of texels at both ends; the default), tree (each texel by itself), all-pairs (exact and slow), or
    /// pattern (57 samples around a texel of the atlas, tens of percent off: for comparison).
    #[arg(long, value_name = "NAME")]
    pub method: Option<String>,
    /// Error that dual keeps within, root mean square over the mean: 0.0001 to 0.1, by default 0.01.
    #[arg(long, value_name = "X", conflicts_with = "theta")]
    pub tolerance: Option<f32>,
    /// Where exitance is evaluated: texel (the default), vertex, fragment (with dual), or auto for whichever is cheapest and loses nothing.
    #[arg(long, value_name = "PLACE")]
    pub evaluate: Option<String>,
    /// For experts: opening angle of dual in place of a tolerance (0.01 is 0.65), or of tree (by default 0.4).
    #[arg(long, value_name = "X")]
    pub theta: Option<f32>,
    /// Width of a shadow map in texels, by default 2048.
    #[arg(long, value_name = "N")]
    pub shadow: Option<u32>,
    /// Directions in which the body's own shadow on sky light is known, a multiple of 8 up to 256, which is the default.
    #[arg(long, value_name = "N")]
    pub directions: Option<u32>,
    /// Samples per pixel along each axis. By default 2 for a PNG, and 1, the pixel's centre, for an EXR.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    pub samples: Option<u32>,
    /// Roughness of the surface's own reflection, 0.03 (polished) to 1 (matt); 0 for none. By default 0.35 for a model, and for a scene what it says or 0.
    #[arg(long, value_name = "X")]
    pub gloss: Option<f32>,
    /// Where the camera stands: degrees to the right of the front and upwards.
    #[arg(long, value_name = "YAW,PITCH", conflicts_with = "scene", allow_hyphen_values = true, default_value = "14,9", value_parser = degrees)]
    pub view: [f32; 2],
    /// Which axis of the model points up: y or z.
    #[arg(long, value_name = "AXIS", conflicts_with = "scene", default_value = "y", value_parser = ["y", "z"])]
    pub up: String,
    /// Light from this equirectangular map, .exr or .hdr, in place of all other lights.
    #[arg(long, value_name = "FILE")]
    pub env: Option<PathBuf>,
    /// Degrees by which the map turns about the vertical, anticlockwise seen from above.
    #[arg(
        long,
        value_name = "DEGREES",
        requires = "env",
        allow_negative_numbers = true,
        default_value_t = 0.0
    )]
    pub env_rotation: f32,
    /// Brightness of a PNG, in stops; by default 0, or what the scene says.
    #[arg(long, value_name = "EV", allow_negative_numbers = true)]
    pub exposure: Option<f32>,
    /// Melt a closed model into an egg or a sphere: it takes the place of the model's own morph targets and skin.
    #[arg(long, value_name = "SHAPE", conflicts_with = "scene", value_parser = ["egg", "sphere"])]
    pub into: Option<String>,
    /// Weight of each morph target, separated by commas.
    #[arg(long, value_name = "W,…", value_delimiter = ',', allow_negative_numbers = true)]
    pub morph: Vec<f32>,
    /// Degrees by which the top turns against the bottom.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub twist: Option<f32>,
    /// Degrees of the arc that the upright axis becomes; positive leans to the right.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub bend: Option<f32>,
    /// Units of the model by which the surface moves outwards.
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub inflate: Option<f32>,
    /// An animation of the model, by name or by number from 0; a wrong name lists them all.
    #[arg(long, value_name = "NAME")]
    pub animation: Option<String>,
    /// Seconds into the animation, the first one if none is named.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// Frames of an animated PNG: all of the animation, if one is named; else through the first morph target and back, or once around
    /// where there is none.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub frames: u32,
    /// Print how long each stage took on the GPU; without timestamps the wall time of whole frames.
    #[arg(long)]
    pub timings: bool,
    /// Picture to write, .png or .exr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// Two finite numbers with a comma between.
fn degrees(text: &str) -> Result<[f32; 2], String> {
    let number = |part: &str| part.trim().parse().ok().filter(|x: &f32| x.is_finite());
    match text.split_once(',').map(|(yaw, pitch)| (number(yaw), number(pitch))) {
        Some((Some(yaw), Some(pitch))) => Ok([yaw, pitch]),
        _ => Err("give two numbers with a comma between, as 14,9".to_owned()),
    }
}

/// Three numbers with commas between.
fn colour(text: &str) -> Result<[f32; 3], String> {
    let numbers = text.split(',').map(|part| part.trim().parse().ok()).collect::<Option<Vec<f32>>>();
    let three = numbers.and_then(|numbers| numbers.try_into().ok());
    three.ok_or_else(|| "give three numbers with commas between, as 0.7,1.2,1.9".to_owned())
}

/// `translume trace`.
#[derive(Debug, Args)]
pub struct Trace {
    /// Scene description in JSON.
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,
    /// Stop at this noise: root mean square of the pixels' standard errors over the mean of the picture. By default 0.05, if nothing else ends
    /// the work.
    #[arg(long, value_name = "X")]
    pub noise: Option<f64>,
    /// Stop after so many seconds.
    #[arg(long, value_name = "N")]
    pub seconds: Option<f64>,
    /// Stop after so many paths a pixel and channel. Alone, every pixel gets as many; with --noise or --seconds noisy pixels get more.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub samples: Option<u32>,
    /// Width of the picture in pixels; the height follows the scene's camera, else the picture is square.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16384))]
    pub size: Option<u32>,
    /// Where random numbers begin: another number gives other noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Brightness of a PNG, in stops.
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Standard error of every pixel, .exr.
    #[arg(long, value_name = "FILE")]
    pub stderr: Option<PathBuf>,
    /// Light that was scattered once, .exr.
    #[arg(long, value_name = "FILE")]
    pub single: Option<PathBuf>,
    /// Picture to write, .png or .exr; it is there after a few seconds and gets better until the work ends.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// `translume inspect`.
#[derive(Debug, Args)]
pub struct Inspect {
    /// OBJ, glTF or GLB files, or the names of built-in models.
    #[arg(required = true, value_name = "MODEL")]
    pub models: Vec<String>,
    /// Print JSON; a list where there are several models.
    #[arg(long, conflicts_with = "table")]
    pub json: bool,
    /// Print a table in Markdown, a line for each model.
    #[arg(long)]
    pub table: bool,
    /// How the surface is laid out.
    #[command(flatten)]
    pub layout: Layout,
}

/// `translume profile`.
#[derive(Debug, Args)]
pub struct Profile {
    /// Medium by name, as jade, wax, skimmilk, marble, skin1; a wrong name lists them all.
    #[arg(long, value_name = "NAME")]
    pub medium: Option<String>,
    /// Reduced scattering coefficients in 1/mm, in place of those of the medium.
    #[arg(long, value_name = "R,G,B", value_parser = colour)]
    pub scattering: Option<[f32; 3]>,
    /// Absorption coefficients in 1/mm, in place of those of the medium.
    #[arg(long, value_name = "R,G,B", value_parser = colour)]
    pub absorption: Option<[f32; 3]>,
    /// Index of refraction, in place of that of the medium.
    #[arg(long, value_name = "X")]
    pub ior: Option<f32>,
    /// How light enters: normal, or diffuse as under a uniform sky.
    #[arg(long, value_name = "WAY", default_value = "diffuse", value_parser = ["normal", "diffuse"])]
    pub entry: String,
    /// Random walks for each channel.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1000..))]
    pub photons: u64,
    /// Table to write, .json; or a folder, in which it gets a name of its own and is left as it is if it is there already.
    #[arg(short, long, value_name = "FILE|DIR")]
    pub output: PathBuf,
}

/// The suite of every method in every scene.
pub const ALL: &str = "methods";

/// `translume report`.
#[derive(Debug, Args)]
pub struct Report {
    /// Scenes (FILE.json), or models: OBJ, glTF or GLB files, or the names of built-in models. By default the scenes that come with
    /// the program; of gather and scatter the creature, and stanford-bunny.obj where the folder that TRANSLUME_MODELS names has it; scatter then
    /// twists its spot.obj too.
    #[arg(value_name = "SCENE|MODEL")]
    pub models: Vec<String>,
    /// What to measure: methods (every method in every scene, against both truths; the default), gather (irradiance in every kind of light),
    /// scatter (exitance against all pairs) or transport (the dipole, and what goes past it, against paths; on the CPU and on the GPU). Without a name the scenes that come with the program are added to those named.
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = ALL)]
    pub suite: Option<String>,
    /// Width of the atlas in texels; scatter also takes a quarter, a half and twice of that, transport 96 on the CPU.
    #[arg(long, value_name = "N", default_value_t = 512)]
    pub atlas: u32,
    /// The reference looks at every Nth texel: of gather by default 7, quickly 31; of scatter as many as give some hundred texels. Texels
    /// come in groups of four, so odd numbers are fairer.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub every: Option<u32>,
    /// Fewer settings, fewer repetitions.
    #[arg(long)]
    pub quick: bool,
    /// Folder to write the report to: index.html, report.csv and pareto.png; of gather and scatter SUITE.csv, SUITE.md and SUITE.svg; of transport the
    /// first two and a strip of pictures a scene. It is made
    /// where there is none.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// How the surface is laid out in the atlas.
#[derive(Debug, Args)]
pub struct Layout {
    /// Width of the atlas in texels, by default 512.
    #[arg(long, value_name = "N")]
    pub atlas: Option<u32>,
    /// Where charts come from: unwrap (if nothing is said), own (the file's texture coordinates), or auto (own where they are fit for light).
    #[arg(long, value_name = "SOURCE")]
    pub charts: Option<String>,
}

impl Layout {
    /// With defaults for what is not said.
    pub fn quality(&self, even: bool) -> Quality {
        let mut quality = Quality { even, ..Quality::default() };
        self.put(&mut quality);
        quality
    }

    /// What is said.
    pub fn put(&self, quality: &mut Quality) {
        put(&mut quality.atlas, self.atlas);
        put(&mut quality.charts, self.charts.clone());
    }
}

/// What the command line says has the last word.
pub fn put<T>(into: &mut T, said: Option<T>) {
    if let Some(said) = said {
        *into = said;
    }
}
