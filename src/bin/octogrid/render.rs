//! `octogrid render`: a picture of a scene.

use std::path::PathBuf;

use clap::ValueEnum;
use glam::{DVec3, Vec3};
use image::{ImageFormat, RgbImage};
use octogrid::Scene;

use crate::args::{BuildArgs, Choice};
use crate::camera::{CameraArg, Pinhole};
use crate::failure::Failure;
use crate::frame::{self, Rate, Rates};
use crate::integrators::{Integrator, Settings};
use crate::load::{self, Loaded};
use crate::output::{Output, say};
use crate::pool::ThreadArgs;
use crate::shade::Shading;
use crate::{heat, integrators, legend, npy, saved, table, tone, viewpoint};

/// Rays in flight at once, to keep memory and progress steady.
const BAND: usize = 1 << 18;
/// The largest picture, in pixels.
const MAX_PIXELS: u64 = 1 << 26;

/// Render a picture of a scene
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// An OBJ file or the name of a built-in scene
    #[arg(default_value = "interior")]
    scene: String,
    /// Where the picture goes
    #[arg(short, long, value_name = "FILE.png", default_value = "octogrid.png")]
    output: PathBuf,
    /// The voxel structure
    #[arg(long, value_enum, default_value = "auto")]
    structure: Choice,
    #[command(flatten)]
    build: BuildArgs,
    /// The structure of the scene from octogrid build, in place of building it
    #[arg(long, value_name = "FILE.ogrid", conflicts_with_all = ["structure", "params", "force", "quality", "memory_limit"])]
    accel: Option<PathBuf>,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "800x600", value_parser = parse_size)]
    size: [u32; 2],
    /// What to show
    #[arg(long, value_enum, default_value = "shaded")]
    view: View,
    #[command(flatten)]
    integrator: Settings,
    /// Also write the radiance of the shaded view, float32 of shape (height, width, 3)
    #[arg(long, value_name = "FILE.npy")]
    linear: Option<PathBuf>,
    /// The number of a built-in camera, or EYE:TARGET[:FOV] such as 0,1,5:0,0,0:60
    #[arg(long, value_name = "CAMERA", allow_hyphen_values = true)]
    camera: Option<CameraArg>,
    /// The axis that points up
    #[arg(long, value_enum, default_value = "y")]
    up: Up,
    #[command(flatten)]
    threads: ThreadArgs,
}

/// The values of `--view`.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum View {
    /// Light
    Shaded,
    /// Surface normals as colours
    Normals,
    /// Distance from the eye, near being bright
    Depth,
    /// Voxels and clusters visited a pixel
    Heat,
}

/// The values of `--up`.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Up {
    Y,
    Z,
}

/// Runs the command.
///
/// # Errors
/// On wrong parameters, on files that can't be read or written, and where the build fails.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = args.build.options(args.structure)?;
    let shaded = args.view == View::Shaded;
    if !shaded && (args.linear.is_some() || args.integrator.integrator != Integrator::Direct) {
        return Err(Failure::Usage("--integrator and --linear need --view shaded".into()));
    }
    let output = Output::at(&args.output)?;
    let linear = args.linear.as_deref().map(Output::at).transpose()?;
    let loaded = load::load(&args.scene)?;
    let (picture, summary) = args.threads.run(|| {
        let (scene, ready) = match &args.accel {
            Some(path) => {
                saved::load_for(path, &loaded.model).map(|(scene, ms)| (scene, ("load, ms", ms)))?
            }
            None => {
                let options = args.build.for_rays(&options, least_rays(args), &loaded.model);
                load::build(&loaded.model, &options).map(|(scene, ms)| (scene, ("build, ms", ms)))?
            }
        };
        let camera = camera(args, &loaded, &scene)?;
        let shading = Shading::new(&loaded.model, &scene, up(args.up));
        let mut rates = Rates::default();
        let picture = picture(args, &camera, &shading, &scene, linear.as_ref(), &mut rates)?;
        Ok((picture, summary(&loaded, &scene, ready, shading.lights(), &rates)))
    })?;
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png).map_err(|e| Failure::at(&args.output, e))?;
    output.write(|file| std::io::Write::write_all(file, png.get_ref()))?;
    say(summary)
}

/// At least how many rays a picture takes: one through each pixel or sample, and another from most of what these meet.
fn least_rays(args: &Args) -> usize {
    let pixels = args.size.map(|n| n as usize).iter().product::<usize>();
    match (args.view, args.integrator.integrator) {
        (View::Shaded, Integrator::Direct) => 2 * pixels,
        (View::Shaded, _) => 2 * pixels * args.integrator.samples as usize,
        _ => pixels,
    }
}

fn up(up: Up) -> DVec3 {
    match up {
        Up::Y => DVec3::Y,
        Up::Z => DVec3::Z,
    }
}

/// The camera that the arguments ask for, else the scene's first one, else a sensible one.
fn camera(args: &Args, loaded: &Loaded, scene: &Scene) -> Result<Pinhole, Failure> {
    let number = match &args.camera {
        Some(CameraArg::At(view)) => return Ok(Pinhole::new(view, up(args.up), args.size)),
        Some(CameraArg::Number(number)) => Some(*number),
        None => None,
    };
    let view = match (loaded.cameras.get(number.unwrap_or(0)), number) {
        (Some(camera), _) => camera.into(),
        (None, Some(number)) => {
            let (name, count) = (&loaded.name, loaded.cameras.len());
            return Err(Failure::Usage(format!("no camera {number}: {name} has {count}, counted from 0")));
        }
        (None, None) => viewpoint::automatic(&loaded.model, scene, args.up as usize + 1),
    };
    Ok(Pinhole::new(&view, up(args.up), args.size))
}

fn picture(
    args: &Args,
    camera: &Pinhole,
    shading: &Shading,
    scene: &Scene,
    linear: Option<&Output>,
    rates: &mut Rates,
) -> Result<RgbImage, Failure> {
    let pixels = camera.pixels();
    let mut range = [0; 2];
    let colours: Vec<[u8; 3]> = match args.view {
        View::Shaded => {
            let samples = integrators::samples(&args.integrator, shading, scene, camera, rates)?;
            if let Some(file) = linear {
                let radiance = samples.iter().map(|s| s.radiance.to_array());
                file.write(|file| npy::write_image(file, args.size, radiance))?;
            }
            // The other integrators find the light that direct has to guess.
            let ambient = args.integrator.integrator == Integrator::Direct && shading.lights() > 0;
            tone::expose(&samples, ambient)
        }
        View::Normals => frame::in_bands(pixels, BAND, |band| {
            let rays = frame::primary_rays(camera, band);
            let hits = frame::closest(scene, &rays, &mut rates.primary);
            let colour = |n: DVec3| tone::to_bytes((n.as_vec3() + Vec3::ONE) / 2.0);
            let pairs = rays.iter().zip(&hits);
            pairs.map(|(ray, hit)| shading.normal(ray, hit).map_or([0; 3], colour)).collect()
        }),
        View::Depth => depth(&frame::in_bands(pixels, BAND, |band| {
            let hits = frame::closest(scene, &frame::primary_rays(camera, band), &mut rates.primary);
            hits.iter().map(|hit| hit.t).collect()
        })),
        View::Heat => {
            let work = frame::in_bands(pixels, BAND, |band| {
                let rays = frame::primary_rays(camera, band);
                frame::closest(scene, &rays, &mut rates.primary);
                heat::work(scene, &rays)
            });
            range = heat::range(&work);
            work.iter().map(|&work| heat::colour(work, range)).collect()
        }
    };
    let [width, height] = args.size;
    let mut picture = RgbImage::from_fn(width, height, |x, y| colours[(y * width + x) as usize].into());
    if matches!(args.view, View::Heat) {
        legend::draw(&mut picture, range);
    }
    Ok(picture)
}

/// Grey by distance, from white to dark; misses are black.
fn depth(distances: &[f32]) -> Vec<[u8; 3]> {
    let seen = distances.iter().copied().filter(|t| t.is_finite());
    let (near, far) = seen.fold((f32::INFINITY, 0f32), |(near, far), t| (near.min(t), far.max(t)));
    let span = (far - near).max(f32::MIN_POSITIVE);
    let grey = |&t: &f32| if t.is_finite() { 1.0 - 0.85 * ((t - near) / span) } else { 0.0 };
    distances.iter().map(|t| tone::to_bytes(Vec3::splat(grey(t)))).collect()
}

fn summary(
    loaded: &Loaded,
    scene: &Scene,
    (ready, ms): (&'static str, f64),
    lights: usize,
    rates: &Rates,
) -> impl std::fmt::Display + Send + use<> {
    let rate = |rate: &Rate| format!("{:.3}", rate.mrays_per_s());
    table::pairs([
        ("scene", loaded.name.clone()),
        ("triangles", scene.triangles().to_string()),
        ("lights", lights.to_string()),
        ("structure", scene.structure().to_string()),
        (ready, format!("{ms:.2}")),
        ("bytes a triangle", format!("{:.1}", load::bytes_per_triangle(scene))),
        ("primary rays", rates.primary.rays().to_string()),
        ("primary, Mray/s", rate(&rates.primary)),
        ("shadow rays", rates.shadow.rays().to_string()),
        ("shadow, Mray/s", rate(&rates.shadow)),
        ("scattered rays", rates.scattered.rays().to_string()),
        ("scattered, Mray/s", rate(&rates.scattered)),
    ])
}

/// `WxH` in pixels.
pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once('x').ok_or("not of the form WxH, such as 800x600")?;
    let number = |n: &str| n.parse::<u32>().map_err(|_| format!("'{n}' is not a number of pixels"));
    let [width, height] = [number(width)?, number(height)?];
    match u64::from(width) * u64::from(height) {
        0 => Err("a picture needs at least one pixel".into()),
        1..=MAX_PIXELS => Ok([width, height]),
        _ => Err(format!("more than {MAX_PIXELS} pixels")),
    }
}
