//! [`Recording`]: the shapes of all bodies at the times of pictures.

use super::bodies::Bodies;
use super::scene_file::SceneFile;
use super::scheduled_cuts::ScheduledCuts;
use crate::failure::Failure;
use incise_mesh::Surface;
use incise_scene::Scene;

/// The shapes of a body between two changes of its topology.
pub(super) struct TopologySpan {
    /// The body at the first picture.
    pub(super) surface: Surface,
    /// Number of the first picture.
    pub(super) first: usize,
    /// Positions \[m\], shape \[pictures\]\[vertex slots\].
    pub(super) positions: Vec<Vec<[f32; 4]>>,
}

/// Shapes of bodies and edges of blades, picture by picture.
pub(super) struct Recording {
    /// Absent if no output shows the motion.
    frames_per_picture: Option<f64>,
    /// Takes of every body, in the order of their times.
    pub(super) bodies: Vec<Vec<TopologySpan>>,
    /// Edges of the blades that move from pose to pose \[m\], by picture.
    pub(super) blades: Vec<Vec<[[f32; 3]; 2]>>,
}

impl Recording {
    /// Creates a recording without pictures.
    pub(super) fn new(file: &SceneFile) -> Self {
        let rate = f64::from(file.output.pictures_per_second());
        let is_recorded = file.output.is_recorded();
        Self {
            frames_per_picture: is_recorded.then(|| 1.0 / (rate * file.dt)),
            bodies: file.bodies.iter().map(|_| Vec::new()).collect(),
            blades: Vec::new(),
        }
    }

    /// Returns the number of pictures.
    pub(super) fn len(&self) -> usize {
        self.blades.len()
    }

    /// Records the pictures that are due after a number of frames.
    pub(super) fn record(
        &mut self,
        frames: u32,
        scene: &mut Scene,
        bodies: &Bodies,
        cuts: &ScheduledCuts,
    ) -> Result<(), Failure> {
        while self.is_due(frames) {
            let picture = self.len();
            let surfaces = bodies.surfaces(scene)?;
            for (takes, (surface, _)) in self.bodies.iter_mut().zip(surfaces) {
                add(takes, picture, surface);
            }
            let edges = cuts.edges(scene).collect();
            self.blades.push(edges);
        }
        Ok(())
    }

    #[expect(clippy::cast_precision_loss, reason = "a number of pictures is small")]
    fn is_due(&self, frames: u32) -> bool {
        self.frames_per_picture
            .is_some_and(|step| (self.len() as f64 * step).round() <= f64::from(frames))
    }
}

/// Adds the shape of a body in a picture to its last take, or to a new one after a cut.
fn add(takes: &mut Vec<TopologySpan>, picture: usize, surface: &Surface) {
    let positions = surface.positions().to_vec();
    match takes.last_mut() {
        Some(take) if take.surface.fingerprint() == surface.fingerprint() => {
            take.positions.push(positions);
        }
        _ => takes.push(TopologySpan {
            surface: surface.clone(),
            first: picture,
            positions: vec![positions],
        }),
    }
}
