//! [`CutObject`]: a cut copy of a mesh with its caps, pieces, origins and counts.

use crate::handles::Object;
use crate::memory::count;
use crate::status::{Error, Status};
use incise::cut::{CapMarker, CutOutcome, CutParams, Cutter, Stroke, Sweep};
use incise::mesh::{Lineage, Surface};
use std::time::{Duration, Instant};

/// A cut copy of a mesh with its pieces, caps and origins of vertices.
#[derive(Debug)]
pub struct CutResult {
    _opaque: [u8; 0],
}

/// A cut surface without free slots, and all that is known of the cut.
#[derive(Debug)]
pub(crate) struct CutObject {
    pub(crate) surface: Surface,
    /// Whether each triangle belongs to a cap or wall.
    pub(crate) caps: Vec<bool>,
    /// Piece numbers, ascending: a piece's index in the interface is its place here.
    pub(crate) pieces: Vec<u32>,
    /// The id of each vertex, see [`Lineage`].
    pub(crate) ids: Vec<u32>,
    pub(crate) lineage: Lineage,
    /// Counts of all steps.
    pub(crate) stroke: Stroke,
    pub(crate) time: Duration,
}

impl Object for CutObject {
    type Handle = CutResult;
    const NAME: &'static str = "cut result";
}

/// Cuts a copy of `surface` along a plane.
pub(crate) fn cut_plane(
    surface: &Surface,
    normal: [f64; 3],
    d: f64,
    params: &CutParams,
) -> Result<CutObject, Error> {
    cut(surface, params, |cutter, surface, params, lineage| {
        let sweep = Sweep::from_plane(normal, d, &surface.bounds())?;
        let outcome = cutter.cut(surface, &sweep, params)?;
        lineage.follow(&outcome.delta);
        let mut stroke = Stroke::default();
        stroke.add(&outcome);
        Ok(stroke)
    })
}

/// Moves a blade of `points` points through a copy of `surface`, pose by pose.
pub(crate) fn cut_path(
    surface: &Surface,
    poses: &[[f32; 3]],
    points: usize,
    params: &CutParams,
) -> Result<CutObject, Error> {
    cut(surface, params, |cutter, surface, params, lineage| {
        let follow = |step: &CutOutcome| lineage.follow(&step.delta);
        let stroke = cutter.advance_along(surface, poses.chunks(points), params, follow);
        stroke.map_err(|error| Error::new(Status::Refused, error))
    })
}

/// Cuts a copy of `surface` by a function that also follows the lineage.
fn cut(
    surface: &Surface,
    params: &CutParams,
    cut: impl FnOnce(&mut Cutter, &mut Surface, &CutParams, &mut Lineage) -> Result<Stroke, Error>,
) -> Result<CutObject, Error> {
    let begin = Instant::now();
    let mut surface = surface.clone();
    let marker = CapMarker::new(&surface, params);
    let mut lineage = Lineage::new(&surface);
    let mut cutter = Cutter::new(&surface);
    let stroke = cut(&mut cutter, &mut surface, marker.params(), &mut lineage)?;
    let marked = marker.take(&mut surface);
    let vertices = surface.topology().vertices();
    let ids = vertices.map(|v| lineage.id(v)).collect();
    // Slots keep their order.
    let mut marked = marked.into_iter().peekable();
    let triangles = surface.topology().triangles();
    let caps = triangles.map(|t| marked.next_if_eq(&t).is_some()).collect();
    surface.compact();
    let triangles = surface.topology().triangles();
    let mut pieces: Vec<u32> = triangles.map(|t| surface.piece(t)).collect();
    pieces.sort_unstable();
    pieces.dedup();
    Ok(CutObject {
        surface,
        caps,
        pieces,
        ids,
        lineage,
        stroke,
        time: begin.elapsed(),
    })
}

impl CutObject {
    /// Returns the index of the piece of each triangle.
    pub(crate) fn face_pieces(&self) -> Vec<u32> {
        let triangles = self.surface.topology().triangles();
        let index = |t| {
            self.pieces
                .partition_point(|&piece| piece < self.surface.piece(t))
        };
        triangles.map(|t| count(index(t))).collect()
    }

    /// Returns one piece as a surface of its own.
    pub(crate) fn piece(&self, index: usize) -> Result<Surface, Error> {
        match self.pieces.get(index) {
            Some(&piece) => Ok(self.surface.extract_piece(piece)),
            None => Err(Error::new(
                Status::OutOfRange,
                format_args!("piece {index} of {} pieces", self.pieces.len()),
            )),
        }
    }
}
