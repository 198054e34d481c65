//! Seeded strokes: straight paths of a blade of two points in planes through a body.

use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Vec3};
use incise_models::scenes::Directions;
use serde::Serialize;

/// Largest distance of the plane from the body's middle [half extents].
const SPREAD: f64 = 0.6;
/// Distance of the path's ends and of the blade's outer ends from the body [extents].
const MARGIN: f64 = 0.05;
/// Part of the body's height into which a dragged blade reaches.
const DEPTH: f64 = 0.25;
/// Part of the path after which half of the strokes end, inside the body.
const END: f64 = 0.6;
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// How the blade meets the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StrokeKind {
    /// One end of the blade is in the body and moves along it, like a scalpel's.
    Drag,
    /// Both ends of the blade are outside, like a cleaver's.
    Press,
}

impl StrokeKind {
    pub(super) const ALL: [Self; 2] = [Self::Drag, Self::Press];

    /// Returns the name in tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Drag => "drag",
            Self::Press => "press",
        }
    }
}

/// How the planes of a body's strokes lie to each other.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Planes {
    /// Parallel in the body: no stroke meets the walls of another.
    #[default]
    Parallel,
    /// In seeded directions: most strokes meet walls of others.
    Crossing,
}

/// The strokes through one body.
#[derive(Debug, Clone)]
pub(super) struct Strokes {
    planes: Planes,
    directions: Directions,
    /// Unit vectors along the plane's normal and the motion, for a body that has not turned.
    frame: [Vec3; 2],
    count: u32,
}

/// A path of a blade.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    /// The blade's ends at the start \[m\].
    ends: [Vec3; 2],
    /// Unit vector of the motion.
    along: Vec3,
    /// Length of the path \[m\].
    length: f64,
}

impl Strokes {
    pub(super) fn new(planes: Planes, seed: u64) -> Self {
        let mut directions = Directions(seed);
        Self {
            planes,
            frame: seeded_frame(&mut directions),
            directions,
            count: 0,
        }
    }

    /// Returns the next stroke through a body that has turned by an angle about the vertical axis
    /// \[rad\]. Half of them end inside the body.
    pub(super) fn next(&mut self, kind: StrokeKind, surface: &Surface, angle: f64) -> Stroke {
        self.count += 1;
        let ([normal, along], part) = match self.planes {
            Planes::Parallel => {
                // Multiples of the golden ratio are far from each other (Weyl's sequence).
                let share = (f64::from(self.count) * GOLDEN_RATIO).fract();
                (
                    self.frame.map(|axis| turned(axis, angle)),
                    2.0 * share - 1.0,
                )
            }
            Planes::Crossing => {
                let frame = seeded_frame(&mut self.directions);
                (frame, self.directions.signed())
            }
        };
        let across = normal.cross(&along);
        let extent = |axis: Vec3| {
            let vertices = surface.topology().vertices();
            let heights = vertices.map(|v| axis.dot(&surface.position(v)));
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
                [low.min(height), high.max(height)]
            })
        };
        let [[low, high], [from, to], [bottom, top]] = [normal, along, across].map(extent);
        let offset = f64::midpoint(low, high) + SPREAD * part * (high - low) / 2.0;
        let origin = normal * offset + along * (from - MARGIN * (to - from));
        let margin = MARGIN * (top - bottom);
        let inner = match kind {
            StrokeKind::Drag => top - DEPTH * (top - bottom),
            StrokeKind::Press => bottom - margin,
        };
        let whole = (1.0 + 2.0 * MARGIN) * (to - from);
        Stroke {
            ends: [inner, top + margin].map(|height| origin + across * height),
            along,
            length: if self.count % 4 < 2 {
                END * whole
            } else {
                whole
            },
        }
    }
}

/// Returns two orthogonal unit vectors.
fn seeded_frame(directions: &mut Directions) -> [Vec3; 2] {
    let normal = directions.next_unit();
    loop {
        let along = normal.cross(&directions.next_unit());
        if let Some(along) = along.try_normalize(0.1) {
            return [normal, along];
        }
    }
}

/// Turns a vector by an angle about the vertical axis \[rad\].
pub(super) fn turned(v: Vec3, angle: f64) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    Vec3::new(cos * v.x + sin * v.z, v.y, cos * v.z - sin * v.x)
}

impl Stroke {
    /// Iterates over the blade's poses, `step` apart \[m\].
    pub(super) fn poses(self, step: f64) -> impl Iterator<Item = [[f32; 3]; 2]> {
        let ways = (0_u32..).map(move |i| f64::from(i) * step);
        let ways = ways.take_while(move |way| *way <= self.length);
        ways.map(move |way| self.ends.map(|end| to_f32(end + self.along * way)))
    }
}
