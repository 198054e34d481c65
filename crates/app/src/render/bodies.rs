//! Meshes of a rendered image: read, cut, moved apart, hidden.

use crate::cut_options::CutPlan;
use crate::explode::{centers, move_pieces};
use crate::failure::Failure;
use crate::input::InputOptions;
use crate::json::lossy;
use crate::reporter::Reporter;
use incise_cut::{CutParams, Sweep};
use incise_mesh::geometry::{to_f32, to_f64, to_file};
use incise_mesh::{Aabb, Surface, TriangleId, Vec3, Warning};
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Margin of a visible plane around the body's box [diagonals].
const PLANE_MARGIN: f64 = 0.06;

/// All meshes of an image.
pub(crate) struct Bodies {
    pub(super) bodies: Vec<Body>,
    pieces: usize,
    /// Triangles that the sweep crosses; none without a cut.
    pub(super) hits: Option<usize>,
    /// Repairs made while reading.
    pub(super) warnings: Vec<InputWarning>,
}

/// A warning about one input.
#[derive(Debug, Serialize)]
pub(super) struct InputWarning {
    #[serde(serialize_with = "lossy")]
    input: PathBuf,
    #[serde(flatten)]
    warning: Warning,
}

/// A mesh of an image.
pub(super) struct Body {
    pub(super) surface: Surface,
    /// The sweeps that cut it.
    sweeps: Vec<Sweep>,
    /// Bounding box before the cut.
    bounds: Aabb,
    /// Number of a piece in the image by its number in the surface; none for hidden pieces.
    pieces: Vec<Option<usize>>,
}

impl Body {
    /// Returns the number of a triangle's piece; none if it is hidden.
    pub(super) fn piece_of(&self, t: TriangleId) -> Option<usize> {
        self.pieces[self.surface.piece(t) as usize]
    }

    /// Returns true for the triangles of caps.
    pub(super) fn is_cap(&self, t: TriangleId) -> bool {
        self.surface.material(t) == CutParams::default().cap_material
    }

    /// Returns the visible triangles.
    fn visible(&self) -> impl Iterator<Item = TriangleId> {
        let triangles = self.surface.topology().triangles();
        triangles.filter(|&t| self.piece_of(t).is_some())
    }
}

impl Bodies {
    /// Reads all inputs, and cuts them if there is a plan.
    pub(super) fn read(
        inputs: &[PathBuf],
        reading: InputOptions,
        plan: Option<CutPlan<'_>>,
        reporter: &Reporter<impl Write>,
    ) -> Result<Self, Failure> {
        let (mut bodies, mut warnings, mut pieces) = (Vec::new(), Vec::new(), 0);
        let mut hits = plan.map(|_| 0);
        let mut origin = None;
        for input in inputs {
            let (mut surface, found) = reading.read_open(input)?;
            for warning in &found {
                reporter.warn(format_args!("{}: {warning}", input.display()));
            }
            warnings.extend(found.into_iter().map(|warning| InputWarning {
                input: input.clone(),
                warning,
            }));
            // All bodies have the origin of the first.
            let origin = *origin.get_or_insert(surface.origin());
            surface.move_origin(origin);
            let bounds = surface.bounds();
            let mut sweeps = Vec::new();
            if let Some(plan) = plan {
                sweeps = plan.sweeps(&surface, input)?;
                let cut = plan.cut(&mut surface, &sweeps, input)?;
                hits = hits.map(|hits| hits + cut.stroke.report.hits);
            }
            let numbers = (0..surface.piece_bound()).map(|piece| {
                let has_triangles = surface.piece_triangles(piece) > 0;
                pieces += usize::from(has_triangles);
                has_triangles.then(|| pieces - 1)
            });
            bodies.push(Body {
                pieces: numbers.collect(),
                sweeps,
                bounds,
                surface,
            });
        }
        Ok(Self {
            bodies,
            pieces,
            hits,
            warnings,
        })
    }

    /// Returns the number of pieces, hidden ones included.
    pub(crate) fn pieces(&self) -> usize {
        self.pieces
    }

    /// Hides pieces.
    pub(super) fn hide(&mut self, without: &[usize]) -> Result<(), Failure> {
        let pieces = self.pieces;
        if let Some(&piece) = without.iter().find(|&&piece| piece >= pieces) {
            return Err(Failure::NoPiece { piece, pieces });
        }
        for piece in self.bodies.iter_mut().flat_map(|body| &mut body.pieces) {
            *piece = piece.filter(|number| !without.contains(number));
        }
        Ok(())
    }

    /// Hides the pieces with a center in front of a sweep: where the normal of its plane points.
    pub(super) fn hide_front(&mut self) {
        for body in &mut self.bodies {
            for (piece, center) in body.pieces.iter_mut().zip(centers(&body.surface)) {
                let planes = body.sweeps.iter().map(Sweep::plane);
                let is_behind = |(point, normal): (Vec3, Vec3)| (center - point).dot(&normal) < 0.0;
                *piece = piece.filter(|_| planes.clone().all(is_behind));
            }
        }
    }

    /// Returns the bounding box of all meshes before the cut.
    pub(super) fn bounds(&self) -> Aabb {
        let boxes = self.bodies.iter().map(|body| body.bounds);
        boxes.fold(Aabb::default(), Aabb::union)
    }

    /// Returns [`Self::bounds`] in the coordinates of the files.
    pub(super) fn file_bounds(&self) -> Aabb {
        let origin = self.bodies.first().map(|body| body.surface.origin());
        let (origin, bounds) = (origin.unwrap_or_default(), self.bounds());
        Aabb {
            min: to_file(origin, bounds.min),
            max: to_file(origin, bounds.max),
        }
    }

    /// Moves pieces apart by a part of the diagonal of the scene.
    pub(super) fn explode(&mut self, part: f64) {
        let whole = self.bounds();
        for body in &mut self.bodies {
            let centers = centers(&body.surface);
            let moves = centers.iter().map(|&center| {
                let apart = body.sweeps.iter().map(|sweep| {
                    let (point, normal) = sweep.plane();
                    let side = (center - point).dot(&normal).signum();
                    normal * (side * part * whole.diagonal() / 2.0)
                });
                apart
                    .reduce(|a, b| a + b)
                    .unwrap_or((center - whole.center()) * part)
            });
            move_pieces(&mut body.surface, &moves.collect::<Vec<_>>());
        }
    }

    /// Returns the numbers of visible triangles and of caps among them.
    pub(crate) fn count(&self) -> (usize, usize) {
        let mut counts = (0, 0);
        for body in &self.bodies {
            for t in body.visible() {
                counts.0 += 1;
                counts.1 += usize::from(body.is_cap(t));
            }
        }
        counts
    }

    /// Returns the points that the camera frames: corners of visible triangles and of sheets.
    pub(super) fn points(&self, sheets: &[[[f32; 3]; 4]]) -> impl Iterator<Item = [f32; 3]> {
        let corners = self.bodies.iter().flat_map(|body| {
            let corners = body
                .visible()
                .flat_map(|t| body.surface.topology().triangle(t));
            corners.map(|v| {
                let [x, y, z, _] = body.surface.positions()[v.index()];
                [x, y, z]
            })
        });
        corners.chain(sheets.iter().flatten().copied())
    }

    /// Returns the corners of the sweeps: of a blade's whole sweep, or of a plane within the body's
    /// box.
    pub(super) fn sheets(&self, is_plane: bool) -> Vec<[[f32; 3]; 4]> {
        let of = |(bounds, sweep): (&Aabb, &Sweep)| {
            if is_plane {
                section(sweep, bounds)
            } else {
                let [[a, b], [d, c]] = sweep.ends();
                Some([a, b, c, d])
            }
        };
        let sweeps = self.bodies.iter().flat_map(|body| {
            let sweeps = body.sweeps.iter();
            sweeps.map(|sweep| (&body.bounds, sweep))
        });
        sweeps.filter_map(of).collect()
    }
}

/// Returns the rectangle around the section of a box by a sweep's plane, with a margin; none if the
/// plane misses the box.
fn section(sweep: &Sweep, bounds: &Aabb) -> Option<[[f32; 3]; 4]> {
    let (point, normal) = sweep.plane();
    let u = normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize();
    let v = normal.cross(&u);
    let corner = |i: usize| {
        let side = |k: usize| {
            if i >> k & 1 == 0 {
                bounds.min[k]
            } else {
                bounds.max[k]
            }
        };
        to_f64([0, 1, 2].map(side)) - point
    };
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    // Every edge of the box runs from a corner along one axis.
    for (i, k) in (0..8)
        .flat_map(|i| (0..3).map(move |k| (i, k)))
        .filter(|(i, k)| i >> k & 1 == 0)
    {
        let (a, b) = (corner(i), corner(i | 1 << k));
        let (from, to) = (a.dot(&normal), b.dot(&normal));
        if from.min(to) > 0.0 || from.max(to) < 0.0 || from == to {
            continue;
        }
        let p = a + (b - a) * (from / (from - to));
        for (k, x) in [p.dot(&u), p.dot(&v)].into_iter().enumerate() {
            (low[k], high[k]) = (low[k].min(x), high[k].max(x));
        }
    }
    if low[0] > high[0] {
        return None;
    }
    let margin = PLANE_MARGIN * bounds.diagonal();
    let [low, high] = [low.map(|x| x - margin), high.map(|x| x + margin)];
    let corner = |s: f64, t: f64| to_f32(point + u * s + v * t);
    Some([
        corner(low[0], low[1]),
        corner(high[0], low[1]),
        corner(high[0], high[1]),
        corner(low[0], high[1]),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use incise_models::{Model, build_model};

    #[test]
    fn a_visible_plane_spans_the_section_of_the_box() {
        let bounds = Aabb::around([[-1.0; 3], [1.0, 2.0, 3.0]]);
        let of = |normal, d| section(&Sweep::from_plane(normal, d, &bounds).unwrap(), &bounds);
        for (normal, d) in [
            ([0.0, 1.0, 0.0], 0.5),
            ([0.3, -0.4, 0.7], 0.2),
            ([1.0; 3], -2.9),
        ] {
            let corners = of(normal, d).expect("it meets the box").map(to_f64);
            let normal = Vec3::from(normal);
            for p in corners {
                assert!((p.dot(&normal) - d).abs() < 1e-5, "{p} is on the plane");
            }
            let [a, b, c, e] = corners;
            assert!((b - a).dot(&(e - a)).abs() < 1e-5, "a right angle");
            assert!((a + c - b - e).norm() < 1e-5, "opposite sides are alike");
        }
        // Through the middle of the box, along a side: that side and a margin.
        let [a, b, c, _] = of([0.0, 1.0, 0.0], 0.5)
            .expect("it meets the box")
            .map(to_f64);
        let mut sides = [(b - a).norm(), (c - b).norm()];
        sides.sort_by(f64::total_cmp);
        let margin = 2.0 * PLANE_MARGIN * bounds.diagonal();
        assert!((sides[0] - 2.0 - margin).abs() < 1e-5 && (sides[1] - 4.0 - margin).abs() < 1e-5);
        assert_eq!(of([0.0, 1.0, 0.0], 2.5), None);
    }

    #[test]
    fn pieces_move_apart_along_the_normal() {
        let mut surface = build_model(Model::Sphere80);
        let bounds = surface.bounds();
        let sweep = Sweep::from_plane([0.0, 2.0, 0.0], 0.1, &bounds).unwrap();
        let mut cutter = incise_cut::Cutter::new(&surface);
        let cut = cutter.cut(&mut surface, &sweep, &CutParams::default());
        assert_eq!(cut.unwrap().delta.pieces_added.len(), 1);
        let body = Body {
            pieces: vec![Some(0), Some(1)],
            sweeps: vec![sweep],
            bounds,
            surface,
        };
        let mut bodies = Bodies {
            bodies: vec![body],
            pieces: 2,
            hits: None,
            warnings: Vec::new(),
        };
        let before = centers(&bodies.bodies[0].surface);
        bodies.explode(0.25);
        let after = centers(&bodies.bodies[0].surface);
        let gap = |centers: &[Vec3]| (centers[0] - centers[1]).y.abs();
        let moved = gap(&after) - gap(&before);
        assert!((moved - 0.25 * bounds.diagonal()).abs() < 1e-5, "{moved}");
        for (a, b) in before.iter().zip(&after) {
            assert!(
                (a - b).x.abs() + (a - b).z.abs() < 1e-6,
                "along the normal alone"
            );
        }
        // Without a cut all pieces move away from the center.
        bodies.bodies[0].sweeps.clear();
        let middle = bounds.center();
        bodies.explode(1.0);
        for (a, b) in after.iter().zip(&centers(&bodies.bodies[0].surface)) {
            assert!(((b - middle) - 2.0 * (a - middle)).norm() < 1e-5);
        }
        assert!(bodies.hide(&[1]).is_ok());
        let (triangles, caps) = bodies.count();
        assert!(0 < caps && caps < triangles);
        assert!(matches!(
            bodies.hide(&[0, 2]),
            Err(Failure::NoPiece {
                piece: 2,
                pieces: 2
            })
        ));
    }
}
