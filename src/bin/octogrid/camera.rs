//! A pinhole camera and how the command line names it.

use std::str::FromStr;

use glam::DVec3;
use octogrid::{Ray, builtin};

use crate::streams::generator;

/// Where one stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewpoint {
    pub(crate) eye: DVec3,
    pub(crate) target: DVec3,
    /// Vertical field of view.
    pub(crate) fov_degrees: f64,
}

impl From<&builtin::Camera> for Viewpoint {
    fn from(camera: &builtin::Camera) -> Self {
        let [eye, target] = [camera.eye, camera.target].map(|p| DVec3::from_array(p.map(f64::from)));
        Self { eye, target, fov_degrees: camera.vertical_fov_degrees.into() }
    }
}

/// The value of `--camera`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraArg {
    /// A camera of a built-in scene.
    Number(usize),
    /// A camera of one's own.
    At(Viewpoint),
}

impl FromStr for CameraArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Ok(number) = text.parse() {
            return Ok(Self::Number(number));
        }
        let parts: Vec<&str> = text.split(':').collect();
        let (eye, target, fov) = match parts[..] {
            [eye, target] => (eye, target, "60"),
            [eye, target, fov] => (eye, target, fov),
            _ => return Err("neither a number nor X,Y,Z:X,Y,Z[:FOV]".into()),
        };
        let (eye, target) = (point(eye)?, point(target)?);
        if eye == target {
            return Err("the eye is at the target".into());
        }
        let fov_degrees = fov.parse().ok().filter(|fov| (1.0..=170.0).contains(fov));
        let fov_degrees = fov_degrees.ok_or("the field of view must be 1 to 170 degrees")?;
        Ok(Self::At(Viewpoint { eye, target, fov_degrees }))
    }
}

fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if [x, y, z].iter().all(|n| n.is_finite()) => {
            Ok(DVec3::new(x.into(), y.into(), z.into()))
        }
        _ => Err(format!("'{text}' is not a point such as 0,1.5,-2")),
    }
}

/// A camera that makes the rays of an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinhole {
    eye: DVec3,
    /// From the eye to the image's centre, its right edge and its upper edge.
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: [u32; 2],
    /// Where rays don't go through the centres of pixels: what chooses the points.
    jitter: Option<u64>,
}

impl Pinhole {
    /// The camera at `view` for an image of `size` pixels, `up` being a unit vector.
    pub(crate) fn new(view: &Viewpoint, up: DVec3, size: [u32; 2]) -> Self {
        let forward = (view.target - view.eye).normalize_or(DVec3::NEG_Z);
        let side = forward.cross(up);
        // Looking straight up or down, any side will do.
        let right = if side.length() > 1e-6 { side.normalize() } else { forward.any_orthonormal_vector() };
        let height = (view.fov_degrees.to_radians() / 2.0).tan();
        let width = height * f64::from(size[0]) / f64::from(size[1]);
        Self {
            eye: view.eye,
            forward,
            right: right * width,
            up: right.cross(forward) * height,
            size,
            jitter: None,
        }
    }

    /// The same camera with its rays through random points of the pixels.
    pub(crate) fn jittered(self, seed: u64) -> Self {
        Self { jitter: Some(seed), ..self }
    }

    /// The number of pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// The ray through a pixel, counted from the upper left; its direction has length 1.
    pub(crate) fn ray(&self, pixel: usize) -> Ray {
        let width = self.size[0] as usize;
        let within = self.jitter.map_or([0.5; 2], |seed| {
            let rng = &mut generator(seed, pixel as u64);
            [(); 2].map(|()| rng.unit())
        });
        let at = [pixel % width, pixel / width];
        let along = |axis: usize| 2.0 * (at[axis] as f64 + within[axis]) / f64::from(self.size[axis]) - 1.0;
        let (x, y) = (along(0), along(1));
        let dir = (self.forward + x * self.right - y * self.up).normalize();
        Ray::new(self.eye.as_vec3(), dir.as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_numbers_or_points() {
        assert_eq!("2".parse(), Ok(CameraArg::Number(2)));
        let view = Viewpoint { eye: DVec3::new(0.0, 1.0, -5.0), target: DVec3::ZERO, fov_degrees: 60.0 };
        assert_eq!("0,1,-5:0,0,0".parse(), Ok(CameraArg::At(view)));
        for bad in
            ["", "-1", "0,1,5", "0,1,5:0,0", "0,0,0:0,0,0", "0,0,1:0,0,NaN", "0,0,1:0,0,0:180", "1:2:3:4"]
        {
            assert!(bad.parse::<CameraArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn rays_go_through_pixels() {
        let view = Viewpoint { eye: DVec3::ZERO, target: DVec3::NEG_Z, fov_degrees: 90.0 };
        let camera = Pinhole::new(&view, DVec3::Y, [4, 2]);
        let at_depth_1 = |pixel| {
            let dir = camera.ray(pixel).dir;
            (dir / -dir.z).to_array()
        };
        let close = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-6);
        assert!(close(at_depth_1(0), [-1.5, 0.5, -1.0]));
        assert!(close(at_depth_1(7), [1.5, -0.5, -1.0]));
    }

    #[test]
    fn jitter_stays_within_the_pixel() {
        let view = Viewpoint { eye: DVec3::ZERO, target: DVec3::NEG_Z, fov_degrees: 90.0 };
        let camera = Pinhole::new(&view, DVec3::Y, [4, 2]);
        let dirs: Vec<_> = (0..1000).map(|seed| camera.jittered(seed).ray(0).dir).collect();
        let mean = dirs.iter().map(|dir| dir / -dir.z).sum::<glam::Vec3>() / 1000.0;
        assert!((mean.x + 1.5).abs() < 0.05 && (mean.y - 0.5).abs() < 0.05, "{mean}");
        assert!(dirs.iter().map(|dir| dir / -dir.z).all(|d| d.x <= -1.0 && d.y >= 0.0));
    }
}
