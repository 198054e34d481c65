//! Writes a recording as one file of glTF: a node per piece from cut to cut.

use super::recording::{Recording, TopologySpan};
use crate::failure::Failure;
use incise_mesh::{AnimatedSurface, Surface, Warning, write_glb_animation};
use std::path::Path;

/// A piece of a take.
struct Node {
    name: String,
    surface: Surface,
    times: Vec<f32>,
    positions: Vec<Vec<[f32; 4]>>,
    end: Option<f32>,
}

/// Writes the pieces of all bodies, and returns warnings about dropped attributes.
pub(super) fn write(
    recording: &Recording,
    pictures_per_second: u16,
    path: &Path,
) -> Result<Vec<Warning>, Failure> {
    let time = |picture: usize| seconds(picture, pictures_per_second);
    let mut nodes = Vec::new();
    for (body, takes) in recording.bodies.iter().enumerate() {
        for (i, take) in takes.iter().enumerate() {
            let end = takes.get(i + 1).map(|next| time(next.first));
            let last = take.first + take.positions.len();
            let times: Vec<f32> = (take.first..last).map(time).collect();
            for (piece, (surface, positions)) in pieces(take).into_iter().enumerate() {
                nodes.push(Node {
                    name: format!("body_{body}_take_{i}_piece_{piece:03}"),
                    surface,
                    times: times.clone(),
                    positions,
                    end,
                });
            }
        }
    }
    let animated = nodes.iter().map(|node| AnimatedSurface {
        name: &node.name,
        surface: &node.surface,
        times: node.times.clone(),
        positions: node.positions.clone(),
        end: node.end,
    });
    Ok(write_glb_animation(path, &animated.collect::<Vec<_>>())?)
}

/// Returns the pieces of a take with their positions after the first picture.
fn pieces(take: &TopologySpan) -> Vec<(Surface, Vec<Vec<[f32; 4]>>)> {
    let parts = take.surface.extract_pieces();
    let mut pieces: Vec<_> = parts.map(|(_, part)| (part, Vec::new())).collect();
    let mut moved = take.surface.clone();
    for shape in take.positions.iter().skip(1) {
        moved.positions_mut().copy_from_slice(shape);
        for ((_, shapes), (_, part)) in pieces.iter_mut().zip(moved.extract_pieces()) {
            shapes.push(part.positions().to_vec());
        }
    }
    pieces
}

#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "a time of a picture"
)]
fn seconds(picture: usize, pictures_per_second: u16) -> f32 {
    (picture as f64 / f64::from(pictures_per_second)) as f32
}
