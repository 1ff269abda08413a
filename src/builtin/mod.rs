//! Built-in scenes: generated, the same on every platform, each with cameras.
//!
//! Metres, y up. `room` and `interior` have the numbers of triangles and lights of the two scenes
//! that Dmitriev measured; the others each take one property to its end. Closed parts share their
//! vertices, so that each of their edges belongs to two triangles.

mod builder;
mod furniture;
mod interior;
mod lamps;
mod room;
mod shapes;
mod small;
#[cfg(test)]
mod tests;
mod trig;

pub use interior::interior;
pub use room::room;
pub use small::{cube, empty, icosphere, plane, slivers, soup, sphere, stadium, torus, triangle};

use crate::model::Model;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands.
    pub eye: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// The direction that is up in the picture.
    pub up: [f32; 3],
    /// The full opening angle from bottom to top.
    pub vertical_fov_degrees: f32,
}

impl Camera {
    const fn new(eye: [f32; 3], target: [f32; 3], vertical_fov_degrees: f32) -> Self {
        Self { eye, target, up: [0.0, 1.0, 0.0], vertical_fov_degrees }
    }
}

/// A scene that needs no file.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// One line on what it is.
    pub description: &'static str,
    /// Generates it.
    pub model: fn() -> Model,
    /// Views of it, the default one first; never empty.
    pub cameras: &'static [Camera],
}

/// All built-in scenes.
pub fn all() -> &'static [Builtin] {
    &SCENES
}

/// The built-in scene of that name.
pub fn by_name(name: &str) -> Option<&'static Builtin> {
    SCENES.iter().find(|scene| scene.name == name)
}

const OUTSIDE: &[Camera] = &[Camera::new([2.5, 1.8, 3.0], [0.0, 0.0, 0.0], 40.0)];

const SCENES: [Builtin; 11] = [
    Builtin {
        name: "room",
        description: "room with a table and chairs, 3,368 triangles, 5 lights",
        model: room,
        cameras: &room::CAMERAS,
    },
    Builtin {
        name: "interior",
        description: "hall with columns, stairs, a gallery and a library, 97,036 triangles, 39 lights",
        model: interior,
        cameras: &interior::CAMERAS,
    },
    Builtin {
        name: "soup",
        description: "100,000 unconnected triangles in the unit cube",
        model: || soup(100_000, 1),
        cameras: &[Camera::new([1.8, 1.4, 2.2], [0.5, 0.5, 0.5], 35.0)],
    },
    Builtin {
        name: "stadium",
        description: "sphere of 100,000 triangles and diameter 1 in a box with sides of 1,000",
        model: stadium,
        cameras: &[
            Camera::new([1.0, 0.7, 1.2], [0.0, 0.0, 0.0], 45.0),
            Camera::new([400.0, 300.0, 450.0], [0.0, 0.0, 0.0], 45.0),
        ],
    },
    Builtin {
        name: "sphere",
        description: "closed sphere, 8,064 triangles",
        model: || sphere(64, 64),
        cameras: OUTSIDE,
    },
    Builtin {
        name: "torus",
        description: "closed torus, 8,192 triangles",
        model: || torus(128, 32),
        cameras: OUTSIDE,
    },
    Builtin { name: "cube", description: "closed cube, 12 triangles", model: cube, cameras: OUTSIDE },
    Builtin {
        name: "plane",
        description: "flat square of 32 x 32 cells, 2,048 triangles",
        model: || plane(32),
        cameras: OUTSIDE,
    },
    Builtin {
        name: "triangle",
        description: "a single triangle",
        model: triangle,
        cameras: &[Camera::new([0.3, 0.3, 2.0], [0.3, 0.3, 0.0], 45.0)],
    },
    Builtin { name: "empty", description: "no triangle at all", model: empty, cameras: OUTSIDE },
    Builtin {
        name: "slivers",
        description: "needles with aspect ratios from 1 to 1e8, 5,248 triangles",
        model: slivers,
        cameras: &[Camera::new([0.5, 3.0, 3.5], [-0.8, 0.2, 0.3], 45.0)],
    },
];
