//! Holes of a surface, closed.
//!
//! 1. [`rim`]: the rims, what is around them and how long edges are there.
//! 2. A rim that lies in a plane is covered exactly, see [`plane`] and [`crate::cover`]. Any other is
//!    triangulated so that it bends least ([`minimal`]), and these triangles are covered in the plane into which they
//!    unfold ([`unfold`]). Where they overlap there they are divided as they are ([`local`]).
//! 3. [`fair`]: if asked for, inner vertices go where the patch is smoothest.
//! 4. [`sew`]: all patches in one [`incise_mesh::Edit`], of which an error leaves nothing.

mod crossing;
mod error;
#[cfg(feature = "fair")]
mod fair;
mod local;
mod minimal;
mod plane;
mod rim;
mod sew;
mod smooth;
mod unfold;

pub use error::HoleError;

use crate::level::RefinementLevel;
use incise_mesh::geometry::{corner_angles, is_flat};
use incise_mesh::{
    AngleStats, HalfEdge, Surface, Topology, TopologyDelta, TriangleId, Undo, Vec3, VertexId,
};
use plane::Plane;
use rim::{Rim, Surroundings};
use std::f64::consts::PI;

/// A plane patch that stands on the surface as steeply as this, as the cosine of the mean angle between
/// their normals, is the flat end of something and stays plane: 60 degrees.
const STEEP: f64 = 0.5;

/// A triangle with a smaller angle is a sliver \[degrees\].
const SLIVER: f64 = 5.0;

/// The most new vertices of a patch that is faired: seconds. Time grows as the square.
const MOST_FAIRED: usize = 10_000;

/// How to fill holes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoleParams {
    /// How long the edges of patches get, relative to those of the surface around the hole.
    pub level: RefinementLevel,
    /// Whether patches go on as smoothly as they can from the surface around; needs the feature
    /// `fair`. A hole whose rim is plane and has the surface at a steep angle, the open end of a
    /// tube, stays plane.
    pub fair: bool,
    /// Rims of more edges stay open.
    pub max_edges: usize,
    /// The most triangles that all patches together may get.
    pub max_triangles: usize,
    /// The material of patches.
    pub material: u32,
}

impl Default for HoleParams {
    fn default() -> Self {
        Self {
            level: RefinementLevel::Original,
            fair: false,
            max_edges: usize::MAX,
            max_triangles: 1_000_000,
            material: 1,
        }
    }
}

/// A hole that was filled.
#[derive(Debug, Clone, PartialEq)]
pub struct FilledHole {
    /// Edges of its rim.
    pub rim: usize,
    /// A vertex of its rim.
    pub vertex: VertexId,
    /// Whether the rim lies in a plane and was covered there.
    pub planar: bool,
    /// Whether the patch was faired.
    pub faired: bool,
    /// Whether the patch passes through itself: the rim lies in a plane and crosses or touches itself there, or
    /// triangles on the rim alone cross before they are refined. Of more than 20,000 of them that is not told.
    pub self_crossing: bool,
    /// The patch. Empty where a slit was only joined.
    pub triangles: Vec<TriangleId>,
    /// Vertices that were inserted.
    pub inserted: usize,
    /// Triangles of the patch that have no area to the rounding of stored positions, as they must where the rim lies
    /// on a line or doubles back.
    pub flat: usize,
    /// Other triangles of the patch with an angle below 5 degrees, as there are beside edges of the rim that are much
    /// longer than the level asks for.
    pub slivers: usize,
    /// The patch's angles.
    pub angles: AngleStats,
    /// The mean length of the patch's edges, but for the rim's unless there are no others \[m\].
    pub mean_edge: f64,
    /// How long they were to be: the mean over the rim \[m\].
    pub target: f64,
}

/// What filling did.
#[derive(Debug, Clone, Default)]
pub struct Filled {
    /// The holes, in the order of [`Topology::boundary_loops`].
    pub holes: Vec<FilledHole>,
    /// Rims left open because they have too many edges.
    pub left_open: usize,
    /// The change.
    pub delta: TopologyDelta,
    /// The way back; `None` when nothing was to be filled.
    pub undo: Option<Undo>,
}

/// A patch before it is part of the surface. Vertices `0..rim` are the rim's, in its order.
#[derive(Debug, Clone, Default)]
struct Filling {
    rim: usize,
    points: Vec<Vec3>,
    rest: Vec<Vec3>,
    inner: Vec<Inner>,
    triangles: Vec<[u32; 3]>,
}

/// A new vertex: the weighted mean of three that come before it.
#[derive(Debug, Clone, Copy)]
struct Inner {
    parents: [u32; 3],
    weights: [f64; 3],
}

impl Filling {
    fn push(&mut self, inner: Inner) {
        for points in [&mut self.points, &mut self.rest] {
            let terms = inner.parents.iter().zip(inner.weights);
            let mean = terms.map(|(&p, weight)| points[p as usize] * weight).sum();
            points.push(mean);
        }
        self.inner.push(inner);
    }

    /// A fan around a new vertex, for a rim without a free diagonal.
    fn fan(&mut self, rim: &[u32]) {
        let n = rim.len();
        let parents = [rim[0], rim[n / 3], rim[2 * n / 3]];
        let center = u32::try_from(self.points.len()).expect("patches have 32-bit numbers");
        self.push(Inner {
            parents,
            weights: [1.0 / 3.0; 3],
        });
        let fan = (0..n).map(|i| [rim[i], rim[(i + 1) % n], center]);
        self.triangles.extend(fan);
    }
}

/// Closes every hole of a surface: every loop of its boundary, also the outer one of an open sheet.
///
/// Each patch meets the surface edge to edge, has the loop's direction, makes no second edge between two
/// vertices and no second triangle on three, and gets edges as long as the surface's around it times
/// z. A patch may pass through other parts of the surface. Vertices and triangles that were there
/// keep their ids and bits. O(n) for the surface, O(k^3) for a rim of k edges that is not plane and
/// has up to 256, O(k) such parts above.
///
/// # Errors
/// [`HoleError`]; the surface is then bit for bit what it was.
///
/// ```
/// use incise_mesh::icosphere;
/// use incise_refine::{HoleParams, fill_holes};
///
/// let mut body = icosphere(3, 0.5);
/// let is_cap = |t: &_| body.triangle_positions(*t).iter().all(|p| p.z > 0.3);
/// let hole: Vec<_> = body.topology().triangles().filter(is_cap).collect();
/// let unused = body.remove_triangles(&hole);
/// body.remove_vertices(&unused);
/// assert!(!body.topology().is_closed());
///
/// let filled = fill_holes(&mut body, &HoleParams::default())?;
/// assert_eq!(filled.holes.len(), 1);
/// assert!(body.topology().is_closed());
/// # Ok::<(), incise_refine::HoleError>(())
/// ```
pub fn fill_holes(surface: &mut Surface, params: &HoleParams) -> Result<Filled, HoleError> {
    check(params)?;
    let loops = surface.topology().boundary_loops();
    fill(surface, &loops, params)
}

/// Closes one hole, given its rim: boundary half-edges, each beginning where the one before ends, as
/// [`Topology::boundary_loops`] gives them. Else like [`fill_holes`].
///
/// # Errors
/// [`HoleError`]; the surface is then bit for bit what it was.
pub fn fill_hole(
    surface: &mut Surface,
    rim: &[HalfEdge],
    params: &HoleParams,
) -> Result<Filled, HoleError> {
    check(params)?;
    fill(surface, &[rim.to_vec()], params)
}

fn check(params: &HoleParams) -> Result<(), HoleError> {
    let z = params.level.z();
    if !(z > 0.0 && z.is_finite()) {
        return Err(HoleError::NonPositiveLevel { z });
    }
    if params.fair && cfg!(not(feature = "fair")) {
        return Err(HoleError::NoFairing);
    }
    Ok(())
}

fn fill(
    surface: &mut Surface,
    loops: &[Vec<HalfEdge>],
    params: &HoleParams,
) -> Result<Filled, HoleError> {
    let topology = surface.topology();
    let (small, large): (Vec<_>, Vec<_>) =
        (loops.iter()).partition(|boundary| boundary.len() <= params.max_edges);
    let mut filled = Filled {
        left_open: large.len(),
        ..Filled::default()
    };
    let rims = (small.iter())
        .map(|boundary| Rim::new(topology, boundary))
        .collect::<Result<Vec<Rim>, HoleError>>()?;
    if rims.is_empty() {
        return Ok(filled);
    }
    let mut around = Surroundings::new(topology, &rims);
    around.check_finite(surface)?;
    around.check_fans(topology, &rims)?;
    let mut left = params.max_triangles;
    let mut fillings = Vec::with_capacity(rims.len());
    for rim in &rims {
        let made = close(surface, rim, &mut around, params, left).map_err(|error| match error {
            HoleError::TooManyTriangles { .. } => HoleError::TooManyTriangles {
                limit: params.max_triangles,
            },
            error => error,
        })?;
        left -= made.0.triangles.len();
        fillings.push(made);
    }
    let mut edit = surface.edit();
    for (rim, (filling, mut hole)) in rims.iter().zip(fillings) {
        if filling.triangles.is_empty() {
            edit.join(rim.across[0], rim.across[1]);
        } else {
            hole.triangles = sew::sew(&mut edit, rim, &filling, params.material, hole.faired);
            hole.count_bad(edit.surface());
        }
        filled.holes.push(hole);
    }
    let (delta, undo) = edit.finish();
    filled.delta = delta;
    filled.undo = Some(undo);
    Ok(filled)
}

/// Makes one patch and notes its edges between vertices of rims.
fn close(
    surface: &Surface,
    rim: &Rim,
    around: &mut Surroundings,
    params: &HoleParams,
    limit: usize,
) -> Result<(Filling, FilledHole), HoleError> {
    let mut sizes = around.sizes(surface, rim, params.level.z());
    let mut filling = Filling {
        rim: rim.len(),
        points: rim.vertices.iter().map(|&v| surface.position(v)).collect(),
        rest: rim
            .vertices
            .iter()
            .map(|&v| surface.rest_position(v))
            .collect(),
        ..Filling::default()
    };
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    let mut hole = FilledHole {
        rim: rim.len(),
        vertex: rim.vertices[0],
        planar: false,
        faired: false,
        self_crossing: false,
        triangles: Vec::new(),
        inserted: 0,
        flat: 0,
        slivers: 0,
        angles: AngleStats::default(),
        mean_edge: 0.0,
        target: sizes.iter().sum::<f64>() / sizes.len() as f64,
    };
    if rim.len() < 3 {
        return Ok((filling, hole));
    }
    if rim.len() - 2 > limit {
        return Err(HoleError::TooManyTriangles { limit });
    }
    let normals = rim.normals(surface);
    let joined = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|v| rim.vertices[v as usize]);
        around.are_joined(a, b)
    };
    let plane = Plane::of(&filling.points, rim.mean_edge(surface));
    let cos = |plane: &Plane| normals.iter().map(|n| n.dot(&plane.normal)).sum::<f64>();
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^53 vertices")]
    let is_end = |plane: &Plane| cos(plane) < STEEP * normals.len() as f64;
    let is_faired = params.fair && !plane.as_ref().is_some_and(is_end);
    // What is too fine to be faired is not refined to the end first.
    let most = if is_faired {
        limit.min(rim.len() - 2 + 2 * MOST_FAIRED)
    } else {
        limit
    };
    let too_many = |error| match error {
        HoleError::TooManyTriangles { .. } if most < limit => HoleError::TooFineToFair {
            vertex: rim.vertices[0],
            limit: MOST_FAIRED,
        },
        error => error,
    };
    if is_doubled(surface.topology(), rim, around) {
        filling.fan(&[0, 1, 2]);
    } else if let Some(plane) = &plane {
        let made = plane::fill(&mut filling, plane, &sizes, most, &joined);
        hole.planar = made.map_err(too_many)?;
        hole.self_crossing = !hole.planar;
    }
    if !hole.planar {
        if filling.triangles.is_empty() {
            let minimal = minimal::minimal(&filling.points, &normals, &joined);
            filling.triangles = minimal.triangles;
            minimal.open.iter().for_each(|part| filling.fan(part));
        }
        hole.self_crossing |= crossing::is_self_crossing(&filling.points, &filling.triangles);
        let made = unfold::refine(&mut filling, &sizes, most, &joined).map_err(too_many)?;
        if made {
            local::settle(&mut filling, &joined);
        } else {
            local::refine(&mut filling, &mut sizes, most, &joined).map_err(too_many)?;
        }
    }
    if filling.triangles.len() > most {
        return Err(too_many(HoleError::TooManyTriangles { limit }));
    }
    #[cfg(feature = "fair")]
    if is_faired && !filling.inner.is_empty() {
        hole.faired = fair::fair(&mut filling, surface, rim, around, &joined);
    }
    for &[a, b, c] in &filling.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]].map(|side| side.map(|v| v as usize)) {
            if let (Some(&a), Some(&b)) = (rim.vertices.get(a), rim.vertices.get(b)) {
                around.join(a, b);
            }
        }
    }
    hole.measure(&filling);
    Ok((filling, hole))
}

/// Whether the one triangle on a rim of three edges is there already, on the other side.
fn is_doubled(topology: &Topology, rim: &Rim, around: &Surroundings) -> bool {
    let corners = <[VertexId; 3]>::try_from(rim.vertices.as_slice());
    corners.is_ok_and(|corners| around.has_triangle(topology, corners))
}

impl FilledHole {
    fn count_bad(&mut self, surface: &Surface) {
        for &t in &self.triangles {
            let corners = surface.triangle_positions(t);
            let smallest = corner_angles(corners).into_iter().fold(PI, f64::min);
            if is_flat(corners) {
                self.flat += 1;
            } else if smallest.to_degrees() < SLIVER {
                self.slivers += 1;
            }
        }
    }

    fn measure(&mut self, filling: &Filling) {
        let at = |v: u32| filling.points[v as usize];
        self.inserted = filling.inner.len();
        self.angles = AngleStats::of(filling.triangles.iter().map(|t| t.map(at)));
        let count = filling.rim;
        let is_rim =
            |a: u32, b: u32| b as usize == (a as usize + 1) % count && (a as usize) < count;
        let (mut inside, mut all) = ((0.0, 0.0), (0.0, 0.0));
        for &[a, b, c] in &filling.triangles {
            for (a, b) in [(a, b), (b, c), (c, a)] {
                let length = (at(b) - at(a)).norm();
                all = (all.0 + length, all.1 + 1.0);
                if !is_rim(a, b) {
                    inside = (inside.0 + length, inside.1 + 1.0);
                }
            }
        }
        let (sum, sides) = if inside.1 > 0.0 { inside } else { all };
        self.mean_edge = sum / f64::max(sides, 1.0);
    }
}
