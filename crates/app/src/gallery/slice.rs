//! A model cut along a plane, and the cameras for its halves.

use super::figure::{BODY, CAP, ColoredSurface, Facts, FigureError};
use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId};
use incise_models::Model;
use incise_paper::PaperParams;
use incise_refine::{RefineParams, RefinementLevel};
use incise_render::{Camera, Color};
use std::collections::BTreeMap;
use std::rc::Rc;

/// A method to cut, with its parameters.
#[derive(Clone, Copy)]
pub(super) enum Method {
    Paper(PaperParams),
    Exact(CutParams),
}

/// The two methods at a refinement level, the paper's first.
pub(super) fn methods(level: RefinementLevel) -> [Method; 2] {
    let refine = RefineParams {
        level,
        // The paper's caps are uniform.
        grading: 0.0,
        ..RefineParams::default()
    };
    [
        Method::Paper(PaperParams {
            level,
            ..PaperParams::default()
        }),
        Method::Exact(CutParams {
            refine,
            ..CutParams::default()
        }),
    ]
}

impl Method {
    /// Returns the name for titles and the index.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Paper(_) => "paper",
            Self::Exact(_) => "exact",
        }
    }

    /// Returns the refinement level.
    pub(super) fn level(self) -> RefinementLevel {
        match self {
            Self::Paper(params) => params.level,
            Self::Exact(params) => params.refine.level,
        }
    }

    /// Cuts a surface.
    pub(super) fn cut(
        self,
        cutter: &mut Cutter,
        surface: &mut Surface,
        sweep: &Sweep,
    ) -> Result<CutOutcome, FigureError> {
        Ok(match self {
            Self::Paper(params) => incise_paper::cut(cutter, surface, sweep, &params)?.cut,
            Self::Exact(params) => cutter.cut(surface, sweep, &params)?,
        })
    }
}

/// A plane: its normal, of any length, and its offset `d`.
pub(super) type Plane = [f64; 4];

/// A model cut along a plane.
pub(super) struct Slice {
    pub(super) surface: Surface,
    pub(super) outcome: CutOutcome,
    plane: Plane,
    /// Whether a piece is behind the plane, by piece.
    is_behind: Vec<bool>,
}

/// Returns the facts of a cut model for the index.
pub(super) fn facts(model: Model, method: Method, planes: &[Plane]) -> Facts {
    Facts {
        model: Some(model.name()),
        method: Some(method.name()),
        level: Some(method.level().to_string()),
        planes: planes.to_vec(),
        ..Facts::default()
    }
}

/// Returns the sweep of a plane through the whole body.
pub(super) fn sweep(surface: &Surface, [x, y, z, d]: Plane) -> Result<Sweep, FigureError> {
    Ok(Sweep::from_plane([x, y, z], d, &surface.bounds())?)
}

impl Slice {
    /// Cuts a copy of the surface.
    pub(super) fn new(
        surface: &Surface,
        plane: Plane,
        method: Method,
    ) -> Result<Self, FigureError> {
        let mut surface = surface.clone();
        let sweep = sweep(&surface, plane)?;
        let outcome = method.cut(&mut Cutter::new(&surface), &mut surface, &sweep)?;
        let [x, y, z, d] = plane;
        let centers = crate::explode::centers(&surface);
        let is_behind = centers.iter().map(|c| c.dot(&Vec3::new(x, y, z)) < d);
        Ok(Self {
            is_behind: is_behind.collect(),
            surface,
            outcome,
            plane,
        })
    }

    /// Returns true for triangles behind the plane, the half that the paper's figures show.
    pub(super) fn is_behind(&self, t: TriangleId) -> bool {
        self.is_behind[self.surface.piece(t) as usize]
    }

    /// Returns the half behind the plane.
    pub(super) fn half(&self) -> Rc<ColoredSurface> {
        ColoredSurface::new(self.surface.clone(), |surface, t| {
            self.is_behind(t).then(|| color(surface, t))
        })
    }

    /// Returns the cap triangles of the half behind the plane \[m\].
    pub(super) fn caps(&self) -> Vec<[Vec3; 3]> {
        let caps = self.outcome.cap.iter().filter(|&&t| self.is_behind(t));
        caps.map(|&t| self.surface.triangle_positions(t)).collect()
    }

    /// Returns the plane's unit normal, the outward normal of the visible cap.
    pub(super) fn normal(&self) -> Vec3 {
        let [x, y, z, _] = self.plane;
        Vec3::new(x, y, z).normalize()
    }

    /// Returns the rim edges of the visible caps, in the direction of the caps.
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

    /// Returns the rims as loops, each starting at its smallest vertex id.
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

/// Returns the position of a vertex \[m\].
pub(super) fn place(surface: &Surface, v: VertexId) -> [f32; 3] {
    let [x, y, z, _] = surface.positions()[v.index()];
    [x, y, z]
}

/// Returns true for triangles of caps.
pub(super) fn is_cap(surface: &Surface, t: TriangleId) -> bool {
    surface.material(t) == CutParams::default().cap_material
}

/// Returns the default color of a triangle.
pub(super) fn color(surface: &Surface, t: TriangleId) -> Color {
    if is_cap(surface, t) { CAP } else { BODY }
}

/// Returns a camera that looks against a direction.
pub(super) fn against(direction: Vec3) -> Camera {
    let v = direction.normalize();
    Camera::from_angles(v.x.atan2(v.z), v.y.clamp(-1.0, 1.0).asin())
}

/// Returns the front view of a cap with this normal.
pub(super) fn front(normal: Vec3) -> Camera {
    against(normal)
}

/// Returns the view from beside the cap and above, which shows the cap lit and the body behind it.
pub(super) fn side(normal: Vec3) -> Camera {
    let across = normal.cross(&Vec3::y());
    let across = across
        .try_normalize(0.3)
        .unwrap_or(Vec3::new(-0.55, 0.0, -0.83));
    against(normal - across * 1.1 + Vec3::y() * 0.35)
}
