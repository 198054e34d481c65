//! A model, cut along a plane, and its two halves.

use super::figure::{BODY, CAP, Facts, FigureError, Shown};
use incise_cut::{CutMethod, CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{Model, Surface, TriangleId, Vec3, VertexId};
use incise_refine::{RefineParams, RefinementLevel};
use incise_render::{Camera, Color};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The two ways to cut, the paper's first.
pub(super) const METHODS: [CutMethod; 2] = [CutMethod::Rebuild, CutMethod::Exact];

/// A plane: its normal, of any length, and `d`.
pub(super) type Plane = [f64; 4];

/// A model that was cut along a plane.
pub(super) struct Slice {
    pub(super) surface: Surface,
    pub(super) outcome: CutOutcome,
    plane: Plane,
    /// By piece, whether it is behind the plane.
    is_behind: Vec<bool>,
}

/// A method's name in titles and in the index.
pub(super) fn name(method: CutMethod) -> &'static str {
    match method {
        CutMethod::Rebuild => "rebuild",
        _ => "exact",
    }
}

/// How to cut by this method.
pub(super) fn params(method: CutMethod, level: RefinementLevel) -> CutParams {
    CutParams {
        method,
        refine: RefineParams {
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    }
}

/// What the index tells of a model that is cut.
pub(super) fn facts(model: Model, params: &CutParams, planes: &[Plane]) -> Facts {
    Facts {
        model: Some(model.name()),
        method: Some(name(params.method)),
        level: Some(params.refine.level.to_string()),
        planes: planes.to_vec(),
        ..Facts::default()
    }
}

/// The plane as a sweep through all of the body.
pub(super) fn sweep(surface: &Surface, [x, y, z, d]: Plane) -> Result<Sweep, FigureError> {
    Ok(Sweep::across_box([x, y, z], d, &surface.bounds())?)
}

impl Slice {
    /// Cuts a copy of the surface.
    pub(super) fn of(
        surface: &Surface,
        plane: Plane,
        params: &CutParams,
    ) -> Result<Self, FigureError> {
        let mut surface = surface.clone();
        let sweep = sweep(&surface, plane)?;
        let outcome = Cutter::new(&surface).cut(&mut surface, &sweep, params)?;
        let [x, y, z, d] = plane;
        let centers = crate::apart::centers(&surface);
        let is_behind = centers.iter().map(|c| c.dot(&Vec3::new(x, y, z)) < d);
        Ok(Self {
            is_behind: is_behind.collect(),
            surface,
            outcome,
            plane,
        })
    }

    /// Whether a triangle is in the half behind the plane, which stays where the paper leaves one out.
    pub(super) fn is_behind(&self, t: TriangleId) -> bool {
        self.is_behind[self.surface.piece(t) as usize]
    }

    /// The half behind the plane.
    pub(super) fn half(&self) -> Rc<Shown> {
        Shown::new(self.surface.clone(), |surface, t| {
            self.is_behind(t).then(|| color(surface, t))
        })
    }

    /// The triangles of the caps of the half behind the plane \[m\].
    pub(super) fn caps(&self) -> Vec<[Vec3; 3]> {
        let caps = self.outcome.cap.iter().filter(|&&t| self.is_behind(t));
        caps.map(|&t| self.surface.triangle_positions(t)).collect()
    }

    /// The plane's normal, of length 1: out of the cap of the half behind it.
    pub(super) fn normal(&self) -> Vec3 {
        let [x, y, z, _] = self.plane;
        Vec3::new(x, y, z).normalize()
    }

    /// Edges around the caps of the half behind the plane, as the caps run along them.
    pub(super) fn rim_edges(&self) -> Vec<[VertexId; 2]> {
        let (surface, topology) = (&self.surface, self.surface.topology());
        let caps = topology
            .triangles()
            .filter(|&t| is_cap(surface, t) && self.is_behind(t));
        let sides = caps.flat_map(TriangleId::half_edges);
        let rim = sides.filter(|&h| !is_cap(surface, topology.twin(h).triangle()));
        rim.map(|h| [topology.origin(h), topology.target(h)])
            .collect()
    }

    /// The same edges as loops, each from its vertex with the smallest id on.
    pub(super) fn rims(&self) -> Vec<Vec<VertexId>> {
        let mut next: BTreeMap<VertexId, VertexId> =
            self.rim_edges().into_iter().map(|[a, b]| (a, b)).collect();
        let mut rims = Vec::new();
        while let Some((first, mut at)) = next.pop_first() {
            let mut rim = vec![first];
            while at != first {
                rim.push(at);
                let Some(then) = next.remove(&at) else { break };
                at = then;
            }
            rims.push(rim);
        }
        rims
    }
}

/// Where a vertex is \[m\].
pub(super) fn place(surface: &Surface, v: VertexId) -> [f32; 3] {
    let [x, y, z, _] = surface.positions[v.index()];
    [x, y, z]
}

/// Whether a cut made the triangle to close a lip.
pub(super) fn is_cap(surface: &Surface, t: TriangleId) -> bool {
    surface.material(t) == CutParams::default().cap_material
}

/// The usual color of a triangle.
pub(super) fn color(surface: &Surface, t: TriangleId) -> Color {
    if is_cap(surface, t) { CAP } else { BODY }
}

/// A camera that looks against this direction.
pub(super) fn against(direction: Vec3) -> Camera {
    let v = direction.normalize();
    Camera::looking(v.x.atan2(v.z), v.y.clamp(-1.0, 1.0).asin())
}

/// From straight in front of a cap with this normal.
pub(super) fn front(normal: Vec3) -> Camera {
    against(normal)
}

/// From beside the cap and a little above, so that it and the body behind it are seen, and the key light falls on it.
pub(super) fn side(normal: Vec3) -> Camera {
    let across = normal.cross(&Vec3::y());
    let across = across
        .try_normalize(0.3)
        .unwrap_or(Vec3::new(-0.55, 0.0, -0.83));
    against(normal - across * 1.1 + Vec3::y() * 0.35)
}
