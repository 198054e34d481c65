//! [`CutObject`]: a cut copy of a mesh with its caps, pieces, origins and counts.

use crate::handles::Object;
use crate::memory::count;
use crate::origins::Origins;
use crate::status::{Error, Status};
use incise::cut::{CutOutcome, CutParams, Cutter, Incision, Sweep};
use incise::mesh::{Surface, TriangleId};
use std::collections::HashSet;
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
    /// The id of each vertex, see [`Origins`].
    pub(crate) ids: Vec<u32>,
    pub(crate) origins: Origins,
    pub(crate) counts: Counts,
}

/// Counts of all steps of a cut.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Counts {
    pub(crate) steps: usize,
    pub(crate) hits: usize,
    pub(crate) loops: usize,
    pub(crate) slits: usize,
    pub(crate) tip_vertices: usize,
    pub(crate) moved_volume: f64,
    pub(crate) moved_surface: f64,
    pub(crate) time: Duration,
}

impl Object for CutObject {
    type Handle = CutResult;
    const NAME: &'static str = "cut result";
}

/// A copy of a surface that is being cut.
struct Cutting {
    surface: Surface,
    params: CutParams,
    /// The material that caps are to have in the end. Until then they have one of their own.
    cap_material: u32,
    origins: Origins,
    counts: Counts,
    begin: Instant,
}

impl Cutting {
    fn new(surface: &Surface, params: &CutParams) -> Self {
        let begin = Instant::now();
        let topology = surface.topology();
        let materials = topology.triangles().map(|t| surface.material(t));
        let used: HashSet<u32> = materials.collect();
        let free = (params.cap_material..).find(|material| !used.contains(material));
        Self {
            surface: surface.clone(),
            params: CutParams {
                cap_material: free.unwrap_or(params.cap_material),
                ..*params
            },
            cap_material: params.cap_material,
            origins: Origins::new(count(topology.vertex_slots())),
            counts: Counts::default(),
            begin,
        }
    }

    fn add(&mut self, step: &CutOutcome) {
        self.origins.follow(&step.delta);
        let (counts, report) = (&mut self.counts, &step.report);
        counts.steps += usize::from(!step.is_miss());
        counts.hits += report.hits;
        counts.loops += report.loops;
        counts.slits += report.slits;
        counts.moved_volume += report.moved_volume;
        counts.moved_surface = counts.moved_surface.max(report.moved_surface);
    }

    fn finish(mut self) -> CutObject {
        let surface = &mut self.surface;
        let (vertex_map, _) = surface.compact();
        let triangles: Vec<TriangleId> = surface.topology().triangles().collect();
        let is_cap = |&t: &TriangleId| surface.material(t) == self.params.cap_material;
        let caps: Vec<bool> = triangles.iter().map(is_cap).collect();
        for (&t, _) in triangles.iter().zip(&caps).filter(|(_, is_cap)| **is_cap) {
            surface.set_material(t, self.cap_material);
        }
        let mut pieces: Vec<u32> = triangles.iter().map(|&t| surface.piece(t)).collect();
        pieces.sort_unstable();
        pieces.dedup();
        self.counts.time = self.begin.elapsed();
        CutObject {
            caps,
            pieces,
            ids: self.origins.renumbered(&vertex_map),
            surface: self.surface,
            origins: self.origins,
            counts: self.counts,
        }
    }
}

/// Cuts a copy of `surface` along a plane.
pub(crate) fn cut_plane(
    surface: &Surface,
    normal: [f64; 3],
    d: f64,
    params: &CutParams,
) -> Result<CutObject, Error> {
    let mut cutting = Cutting::new(surface, params);
    let sweep = Sweep::from_plane(normal, d, &surface.bounds())?;
    let mut cutter = Cutter::new(&cutting.surface);
    let outcome = cutter.cut(&mut cutting.surface, &sweep, &cutting.params)?;
    cutting.add(&outcome);
    Ok(cutting.finish())
}

/// Moves a blade of `points` points through a copy of `surface`, pose by pose.
pub(crate) fn cut_path(
    surface: &Surface,
    poses: &[[f32; 3]],
    points: usize,
    params: &CutParams,
) -> Result<CutObject, Error> {
    let mut cutting = Cutting::new(surface, params);
    let mut cutter = Cutter::new(&cutting.surface);
    let mut incision = Incision::default();
    for (i, pose) in poses.chunks(points).enumerate() {
        let step = cutter.advance(&mut cutting.surface, &mut incision, pose, &cutting.params);
        let outcome = step.map_err(|error| {
            Error::new(Status::Refused, format_args!("step to pose {i}: {error}"))
        })?;
        cutting.add(&outcome);
    }
    cutting.counts.tip_vertices = incision.tip().count();
    Ok(cutting.finish())
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
