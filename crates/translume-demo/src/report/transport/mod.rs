//! The dipole and what goes past it against paths: on the CPU, where sums are dense and errors are those of models alone, and on the GPU, with the time of a frame.

mod blocks;

use super::bench::Repeats;
use super::frontier::scenes::{self, Source};
use super::frontier::shot::Shot;
use super::frontier::stage::Stage;
use super::frontier::truth::{Patience, Truths};
use super::{csv, date, prepare_folder, write};
use crate::cli::Report;
use crate::error::Error;
use crate::gpu::Gpu;
use crate::picture::{Output, Picture};
use crate::progress;
use crate::trace::Body as Subject;
use blocks::{Figures, Truth};
use indicatif::ProgressBar;
use std::time::{Duration, Instant};
use translume::{Config, Translume, Transport};
use translume_mesh::Atlas;
use translume_reference::composite::{Exit, look_up, render};
use translume_reference::gather::{Gather, Source as Texel};
use translume_reference::path::{Closed, Shape};
use translume_reference::transport::{Body, Solution, Tier, picture, sites};
use translume_reference::{Surface, scatter};

/// Width of the atlas: about five thousand sites.
const ATLAS: u32 = 96;
/// The same on the GPU, for a glance.
const QUICK_ATLAS: u32 = 128;
/// Applications of the sums, enough for a residual below a per cent on the scans that we know.
const STEPS: usize = 6;
/// Points along each side of a texel, and directions from each towards a light of some extent, squared.
const LIGHT: [u32; 2] = [2, 4];

/// The paper's is in the twin's first row.
const GPU_MODELS: [(&str, Transport); 3] = [
    ("GPU, classic", Transport::Classic),
    ("GPU, boundary", Transport::Boundary),
    ("GPU, layers", Transport::BoundaryLayers),
];

struct Row {
    scene: String,
    model: &'static str,
    figures: Figures,
    seconds: f64,
}

pub fn run(arguments: &Report) -> Result<(), Error> {
    prepare_folder(&arguments.output)?;
    let mut sources: Vec<Source> = arguments.models.iter().map(|name| scenes::named(name)).collect();
    if sources.is_empty() {
        sources = scenes::own(arguments.quick);
    }
    let gpu = Gpu::new()?;
    let translume = Translume::new(&gpu.device, &Config::default())?;
    let bar = progress::bar("transport");
    bar.set_length(sources.len() as u64);
    let (mut rows, mut left_out) = (Vec::new(), Vec::new());
    for source in &sources {
        scene(source, arguments, (&gpu, &translume), &bar, &mut rows, &mut left_out)?;
        write(&arguments.output, "transport.csv", &csv(&rows))?;
        let atlas = gpu_atlas(arguments);
        write(&arguments.output, "transport.md", &markdown(&rows, &left_out, (&gpu.adapter, atlas)))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    progress::tell(&format!("{}: {} rows", arguments.output.join("transport.md").display(), rows.len()));
    Ok(())
}

fn gpu_atlas(arguments: &Report) -> u32 {
    if arguments.quick { QUICK_ATLAS } else { arguments.atlas }
}

fn scene(
    source: &Source,
    arguments: &Report,
    (gpu, translume): (&Gpu, &Translume),
    bar: &ProgressBar,
    rows: &mut Vec<Row>,
    left_out: &mut Vec<String>,
) -> Result<(), Error> {
    let stage = Stage::open(source)?;
    let told = |what: &str| bar.set_message(format!("{}: {what}", stage.name));
    let patience = if arguments.quick {
        Patience { samples: 250, noise: 0.1, most: Duration::from_secs(3) }
    } else {
        Patience { samples: 250, noise: 0.01, most: Duration::from_secs(30) }
    };
    let truths = Truths::new(&stage, &[], patience, &told)?;
    let Some(traced) = &truths.traced else {
        left_out.push(format!("{}: {}", stage.name, truths.untraced.as_deref().unwrap_or("no paths")));
        return Ok(());
    };
    let atlas = stage.atlas(ATLAS)?;
    let surface = stage.surface();
    let texels = texels(&stage, &atlas, &surface);
    let truth = Truth {
        width: stage.camera.width as usize,
        radiance: &traced.radiance,
        error: &traced.error,
        mask: &truths.mask,
    };
    let mut strip = Vec::new();
    let mut add = |model, radiance: Vec<[f32; 3]>, seconds| {
        strip.extend(truths.shown(&radiance));
        let row = |figures| Row { scene: stage.name.clone(), model, figures, seconds };
        rows.extend(blocks::compare(&radiance, &truth).map(row));
    };
    told("dipole");
    let start = Instant::now();
    add("dipole", dipole(&stage, &atlas, &surface, &texels), start.elapsed().as_secs_f64());
    told("boundary");
    let (start, sites) = (Instant::now(), sites(&atlas, &surface, &texels));
    let closed;
    let shape: &dyn Shape = match &stage.paths.body {
        Subject::Mesh(surface) => {
            closed = Closed::new(surface)?;
            &closed
        }
        Subject::Ball(ball) => ball,
        Subject::Block(block) => block,
    };
    let body = Body { shape, volume: stage.paths.volume, lights: &stage.paths.lights };
    let solution = Solution::new(body, sites, STEPS);
    log::info!("{}: residual {:?}", stage.name, solution.residual());
    for (model, tier) in [("boundary", Tier::Boundary), ("layers", Tier::Layers)] {
        told(model);
        let taken = picture(&stage.paths.camera, &surface, &atlas, &solution, tier);
        add(model, taken.radiance, start.elapsed().as_secs_f64());
    }
    let mut shot = Shot::new(gpu, translume, &stage);
    for (model, transport) in GPU_MODELS {
        told(model);
        let taken = shot.transport(transport, gpu_atlas(arguments), Repeats { warm_up: 1, timed: 3 })?;
        let radiance = taken.picture.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
        add(model, radiance, taken.frame_ms / 1000.0);
    }
    strip.extend(truths.shown(&traced.radiance));
    let file = arguments.output.join(format!("transport-{}.png", stage.name));
    Output::new(&file)?.write(&[side_by_side(&strip)])
}

fn texels(stage: &Stage, atlas: &Atlas, surface: &Surface) -> Vec<Texel> {
    let mm = f64::from(stage.mm_per_unit);
    let rest: Vec<[f64; 3]> =
        stage.model.mesh.positions.iter().map(|p| p.map(|x| f64::from(x) * mm)).collect();
    let [samples, rays] = LIGHT;
    let boundary = stage.paths.volume.ior.into();
    let lights = &stage.paths.lights;
    Gather { atlas, rest: &rest, mm_per_unit: mm, surface, lights, boundary, samples, rays }.run()
}

fn dipole(stage: &Stage, atlas: &Atlas, surface: &Surface, texels: &[Texel]) -> Vec<[f32; 3]> {
    let all: Vec<usize> = (0..texels.len()).collect();
    let exitance = scatter::all_pairs(texels, &translume_twin::dipoles(&stage.medium), &all);
    let exit = Exit { eta: stage.paths.volume.ior, normalised: false };
    render(&stage.paths.camera, surface, exit, |hit| look_up(atlas, &exitance, hit)).radiance
}

fn side_by_side(pictures: &[Picture]) -> Picture {
    let (width, height) = pictures.first().map_or((0, 0), |first| (first.width, first.height));
    let row = |k: usize| {
        pictures.iter().flat_map(move |picture| &picture.pixels[k * width as usize..][..width as usize])
    };
    let pixels = (0..height as usize).flat_map(row).copied().collect();
    Picture { width: width * pictures.len() as u32, height, pixels }
}

fn csv(rows: &[Row]) -> String {
    let mut text = "scene,model,red,green,blue,bias_red,bias_green,bias_blue,seconds\n".to_owned();
    for row in rows {
        let Figures { relative_rmse, bias } = row.figures;
        let figures =
            relative_rmse.iter().chain(&bias).map(|x| format!("{x:.5}")).collect::<Vec<_>>().join(",");
        text += &format!("{},{},{figures},{:.3}\n", csv::quoted(&row.scene), row.model, row.seconds);
    }
    text
}

fn markdown(rows: &[Row], left_out: &[String], (adapter, atlas): (&str, u32)) -> String {
    let command: Vec<_> = std::env::args().skip(1).collect();
    let mut text = format!(
        "# Models against paths\n\n`translume {}`\n\n{}, CPU, double precision, atlas {ATLAS}², {STEPS} steps; GPU: {adapter}, atlas {atlas}², the frame of a body that moves.\n\n\
         RMS of the difference of means of 4 × 4 pixels over the mean of the truth, its noise taken off, and the mean of the difference over it; red, green, blue. \
         Seconds are of dense sums and rays on the CPU, where nothing is fast, and of a frame on the GPU.\n\n\
         | scene | model | error | bias, % | s |\n| --- | --- | --- | --- | ---: |\n",
        command.join(" "),
        date::today(),
    );
    for row in rows {
        let three = |values: [f64; 3], form: fn(f64) -> String| values.map(form).join(" ");
        let (error, bias) = (row.figures.relative_rmse, row.figures.bias);
        let (error, bias) =
            (three(error, |x| format!("{x:.3}")), three(bias, |x| format!("{:+.1}", 100.0 * x)));
        text += &format!("| {} | {} | {error} | {bias} | {:.2} |\n", row.scene, row.model, row.seconds);
    }
    for scene in left_out {
        text += &format!("\nLeft out: {scene}\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_side_by_side() {
        let picture = |value: f32| Picture {
            width: 2,
            height: 2,
            pixels: (0..4).map(|k| [value + k as f32; 3]).collect(),
        };
        let both = side_by_side(&[picture(0.0), picture(10.0)]);
        let firsts: Vec<f32> = both.pixels.iter().map(|pixel| pixel[0]).collect();
        assert_eq!((both.width, both.height), (4, 2));
        assert_eq!(firsts, [0.0, 1.0, 10.0, 11.0, 2.0, 3.0, 12.0, 13.0]);
    }
}
