//! Draws a recording: as PNG files, and as an animated PNG.

mod obstacles;

use super::output::SimulateOutput;
use super::recording::{Recording, TopologySpan};
use crate::failure::Failure;
use crate::picture::PictureOptions;
use incise_cut::CutParams;
use incise_mesh::Aabb;
use incise_pbd_gpu::{AdapterRequest, Collider, Context};
use incise_render::{
    BodyView, Color, DrawList, Image, Line, Offscreen, Overlay, RenderError, Renderer, View,
    write_animation,
};
use obstacles::Obstacles;
use std::path::{Path, PathBuf};

/// Color of the blades' edges.
const BLADE: Color = Color::rgb(40, 70, 140);
/// Width of the blades' edges [pixels].
const BLADE_WIDTH: f32 = 3.0;

/// Draws the pictures that an output names, and returns their number.
pub(super) fn draw(
    recording: &Recording,
    output: &SimulateOutput,
    colliders: &[Collider],
    adapter: Option<String>,
) -> Result<usize, Failure> {
    if output.frames.is_none() && output.animation.is_none() {
        return Ok(0);
    }
    let context = Context::open(&AdapterRequest::any(adapter))?;
    let renderer = Renderer::offscreen(context.device(), context.queue())?;
    let mut artist = Artist::new(&renderer, recording, &output.picture, colliders)?;
    if let Some(folder) = &output.frames {
        std::fs::create_dir_all(folder).map_err(|source| Failure::Folder {
            path: folder.clone(),
            source,
        })?;
    }
    let mut images = (0..recording.len()).map(|picture| {
        let image = artist.image(picture)?;
        if let Some(folder) = &output.frames {
            image.write_png(&frame_path(folder, picture))?;
        }
        Ok(image)
    });
    match &output.animation {
        Some(file) => write_animation(file, output.pictures_per_second(), images)?,
        None => images.try_for_each(|image| image.map(drop))?,
    }
    context.check()?;
    if let Some(folder) = &output.frames {
        remove_surplus(folder, recording.len())?;
    }
    Ok(recording.len())
}

/// Returns the positions of a take in a picture; none outside of it.
fn positions_in(take: &TopologySpan, picture: usize) -> Option<&[[f32; 4]]> {
    let positions = take.positions.get(picture.checked_sub(take.first)?)?;
    Some(positions)
}

fn frame_path(folder: &Path, picture: usize) -> PathBuf {
    folder.join(format!("frame_{picture:04}.png"))
}

/// Removes the frames of a longer run.
fn remove_surplus(folder: &Path, count: usize) -> Result<(), Failure> {
    let paths = (count..).map(|picture| frame_path(folder, picture));
    for path in paths.take_while(|path| path.is_file()) {
        std::fs::remove_file(&path).map_err(|source| Failure::Remove { path, source })?;
    }
    Ok(())
}

/// Draws pictures of a recording, in any order, with one camera.
struct Artist<'a> {
    renderer: &'a Renderer,
    recording: &'a Recording,
    options: &'a PictureOptions,
    offscreen: Offscreen,
    view: View,
    obstacles: Obstacles,
    bodies: Vec<Drawn>,
}

/// A body on the GPU.
struct Drawn {
    view: BodyView,
    /// The take whose triangles it has.
    take: Option<usize>,
}

impl<'a> Artist<'a> {
    fn new(
        renderer: &'a Renderer,
        recording: &'a Recording,
        options: &'a PictureOptions,
        colliders: &[Collider],
    ) -> Result<Self, RenderError> {
        let points = || {
            let takes = recording.bodies.iter().flatten();
            takes.flat_map(TopologySpan::points)
        };
        let [width, height] = options.size();
        let drawn = |_: &Vec<TopologySpan>| {
            let view = BodyView::new(renderer)?;
            Ok(Drawn { view, take: None })
        };
        Ok(Self {
            renderer,
            recording,
            options,
            offscreen: Offscreen::new(renderer, width, height)?,
            view: options.view(points),
            obstacles: Obstacles::new(renderer, colliders, &Aabb::around(points()))?,
            bodies: (recording.bodies.iter().map(drawn)).collect::<Result<_, RenderError>>()?,
        })
    }

    fn image(&mut self, picture: usize) -> Result<Image, RenderError> {
        let mut first_piece = 0;
        for (drawn, takes) in self.bodies.iter_mut().zip(&self.recording.bodies) {
            let found = takes.iter().enumerate();
            let mut found =
                found.filter_map(|(i, take)| Some((i, take, positions_in(take, picture)?)));
            let Some((i, take, positions)) = found.next() else {
                continue;
            };
            let surface = &take.surface;
            if drawn.take.replace(i) != Some(i) {
                let cap_material = CutParams::default().cap_material;
                drawn.view.update_topology(self.renderer, surface, |t| {
                    let piece = first_piece + surface.piece(t) as usize;
                    let is_cap = surface.material(t) == cap_material;
                    Some(self.options.triangle_color(is_cap, piece))
                })?;
            }
            drawn.view.update_positions(self.renderer, positions)?;
            first_piece += surface.piece_bound() as usize;
        }
        let blades = self.recording.blades[picture].iter().map(|&ends| Line {
            ends,
            color: BLADE,
            width: BLADE_WIDTH,
        });
        let blades = Overlay::new(self.renderer, &[], &blades.collect::<Vec<_>>())?;
        let views = self.bodies.iter().map(|drawn| &drawn.view);
        let content = DrawList {
            bodies: &views.chain(&self.obstacles.solids).collect::<Vec<_>>(),
            overlays: &[&self.obstacles.planes, &blades],
        };
        self.offscreen.render(self.renderer, &self.view, &content)
    }
}

impl TopologySpan {
    /// Returns the positions of the vertices in all pictures \[m\].
    fn points(&self) -> impl Iterator<Item = [f32; 3]> {
        self.positions.iter().flat_map(|positions| {
            let vertices = self.surface.topology().vertices();
            vertices.map(|v| {
                let [x, y, z, _] = positions[v.index()];
                [x, y, z]
            })
        })
    }
}
