//! Command-line options of a cut, and the cut itself, for `cut`, `render` and `simulate`.

use crate::caps::CapsOption;
use crate::clock::timed;
use crate::failure::Failure;
use crate::input::in_file;
use crate::numbers::{Numbers, numbers};
use crate::stroke::CutSums;
use clap::ValueEnum;
use incise_cut::{
    CapMarker, CutError, CutMethod, CutParams, Cutter, ExactParams, PaperParams, Sweep,
    blade_starts_inside,
};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{Aabb, Surface, Vec3};
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use std::path::Path;

/// Options of a cut. Commands with them need a group `cutter` of `plane` and `blade`.
#[derive(clap::Args)]
pub(crate) struct CutOptions {
    /// Cut along the plane `nx x + ny y + nz z = d`. Several planes cut all pieces, in their order.
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = numbers::<4>, allow_hyphen_values = true)]
    plane: Vec<Numbers<4>>,
    /// Cut along the sweep of a blade's edge: start and end of the edge before the sweep.
    ///
    /// The sweep is two triangles that share the diagonal from the start of --blade to the end of
    /// --to.
    #[arg(
        long,
        value_name = "X,Y,Z,X,Y,Z",
        value_parser = numbers::<6>,
        allow_hyphen_values = true,
        requires = "to"
    )]
    blade: Option<Numbers<6>>,
    /// Start and end of the blade's edge after the sweep.
    #[arg(
        long,
        value_name = "X,Y,Z,X,Y,Z",
        value_parser = numbers::<6>,
        allow_hyphen_values = true,
        requires = "blade",
        conflicts_with = "plane"
    )]
    to: Option<Numbers<6>>,
    /// Ratio of the caps' edge length to that of the surface at the rim: 2x-coarser (2),
    /// 1.5x-coarser (1.5), original (1), 1.5x-finer (0.667), 2x-finer (0.5), or any positive
    /// number. Rim edges are not refined.
    #[arg(
        long,
        value_name = "Z",
        default_value = "original",
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    level: RefinementLevel,
    /// Growth of the caps' edge length per unit of distance from the rim (exact method). With 0.3
    /// the number of cap triangles grows with the outline, not with the area; with 0 the length at
    /// the rim holds everywhere. [default: 0.3]
    #[arg(
        long,
        value_name = "G",
        value_parser = zero_or_more,
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    grading: Option<f64>,
    /// Maximum number of triangles per cap. A cut that needs more is refused.
    #[arg(
        long,
        value_name = "N",
        default_value_t = RefineParams::default().max_triangles,
        requires = "cutter"
    )]
    max_triangles: usize,
    /// Cut method.
    #[arg(long, value_enum, default_value_t = Method::Exact, requires = "cutter")]
    method: Method,
    /// Refinement method of the caps. The exact method supports both, `delaunay` by default; the
    /// paper's method supports `paper` only.
    #[arg(long, value_enum, value_name = "REFINEMENT", requires = "cutter")]
    refine_method: Option<Refinement>,
    /// Collapse rim edges shorter than this fraction of the local edge length, from 0 up to, not
    /// including, 0.5 (exact method). 0 keeps the exact geometry and leaves slivers. [default: 0.1]
    #[arg(
        long,
        value_name = "S",
        value_parser = part_of_an_edge,
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    snap: Option<f64>,
    /// Remove slivers next to the cut (exact method). The surface moves by at most this fraction of
    /// the local edge length, from 0 up to, not including, 0.5. 0.1 removes about half of the
    /// slivers. [default: 0]
    #[arg(
        long,
        value_name = "T",
        value_parser = part_of_an_edge,
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    remesh: Option<f64>,
    /// Curves along which caps close the cut (exact method). [default: bodies]
    #[arg(long, value_enum, value_name = "CURVES", requires = "cutter")]
    caps: Option<CapsOption>,
    /// Texture coordinates of caps per unit of length of the mesh, if it has any (exact method).
    /// [default: 1]
    #[arg(
        long,
        value_name = "S",
        value_parser = zero_or_more,
        allow_hyphen_values = true,
        requires = "cutter"
    )]
    cap_uv_scale: Option<f64>,
}

/// Validated options of a cut: no two exclude each other.
#[derive(Clone, Copy)]
pub(crate) struct CutPlan<'a> {
    options: &'a CutOptions,
    refinement: Refinement,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Split the triangles that the sweep crosses. Closes any cross-section and loses no surface.
    Exact,
    /// The paper's method: delete the triangles that the sweep crosses, rebuild the rim, fill the
    /// hole.
    Paper,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Paper => "paper",
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Refinement {
    /// A core of equilateral triangles and a graded band around it.
    Delaunay,
    /// The paper's: ear clipping, then centroid splits and edge swaps, with one edge length per
    /// component of the section.
    Paper,
}

impl Refinement {
    fn name(self) -> &'static str {
        match self {
            Self::Delaunay => "delaunay",
            Self::Paper => "paper",
        }
    }
}

/// Parses a part of an edge length, from 0 up to 0.5.
fn part_of_an_edge(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|s| (0.0..0.5).contains(s));
    number.ok_or_else(|| String::from("expected a part of an edge: at least 0 and below 0.5"))
}

/// Parses a finite number, 0 or more.
fn zero_or_more(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number: &f64| *number >= 0.0 && number.is_finite());
    number.ok_or_else(|| String::from("expected 0 or a positive number"))
}

impl CutOptions {
    /// Returns true if the command line names a plane or a blade.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_cut(&self) -> bool {
        !self.plane.is_empty() || self.blade.is_some()
    }

    /// Returns true if the cut is along an infinite plane.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_plane(&self) -> bool {
        !self.plane.is_empty()
    }

    /// Checks that no two options exclude each other.
    pub(crate) fn check(&self) -> Result<CutPlan<'_>, Failure> {
        Ok(CutPlan {
            options: self,
            refinement: self.checked_refinement()?,
        })
    }

    /// Returns the refinement, or the two options that exclude each other.
    fn checked_refinement(&self) -> Result<Refinement, Failure> {
        let refuse = |option, with| Err(Failure::NotWith { option, with });
        let paper = "--method paper";
        match (self.method, self.refine_method) {
            (Method::Paper, _) if self.snap.is_some() => refuse("--snap", paper),
            (Method::Paper, _) if self.remesh.is_some() => refuse("--remesh", paper),
            (Method::Paper, _) if self.grading.is_some() => refuse("--grading", paper),
            (Method::Paper, _) if self.caps.is_some() => refuse("--caps", paper),
            (Method::Paper, _) if self.cap_uv_scale.is_some() => refuse("--cap-uv-scale", paper),
            (Method::Paper, Some(Refinement::Delaunay)) => refuse(
                "--refine-method delaunay",
                "--method paper, whose refinement is the paper's",
            ),
            (Method::Paper, _) => Ok(Refinement::Paper),
            (Method::Exact, Some(Refinement::Paper)) if self.grading.is_some() => refuse(
                "--grading",
                "--refine-method paper, which has one edge length for each part of the section",
            ),
            (Method::Exact, given) => Ok(given.unwrap_or(Refinement::Delaunay)),
        }
    }

    fn sweeps(&self, surface: &Surface, path: &Path) -> Result<Vec<Sweep>, Failure> {
        if !self.plane.is_empty() {
            let (origin, bounds) = (surface.origin(), surface.bounds());
            let planes = self.plane.iter();
            return planes
                .map(|&plane| plane_sweep(plane, origin, &bounds, path))
                .collect();
        }
        let origin = Vec3::from(surface.origin());
        let edge = |numbers: Option<Numbers<6>>| {
            let Numbers([a, b, c, d, e, f]) = numbers.unwrap_or(Numbers([0.0; 6]));
            [[a, b, c], [d, e, f]].map(|p| to_f32(Vec3::from(p) - origin))
        };
        let sweep = Sweep::new(edge(self.blade), edge(self.to)).map_err(Failure::Sweep)?;
        Ok(vec![sweep])
    }
}

impl CutPlan<'_> {
    /// Returns the name of the method.
    pub(crate) fn method(self) -> &'static str {
        self.options.method.name()
    }

    /// Returns true for the exact method.
    pub(crate) fn is_exact(self) -> bool {
        matches!(self.options.method, Method::Exact)
    }

    /// Returns the name of the refinement.
    pub(crate) fn refinement(self) -> &'static str {
        self.refinement.name()
    }

    /// Returns the parameters for the cutter.
    pub(crate) fn params(self) -> CutParams {
        let options = self.options;
        CutParams {
            method: match options.method {
                Method::Exact => CutMethod::Exact(self.exact()),
                Method::Paper => CutMethod::Paper(PaperParams::default()),
            },
            refine: RefineParams {
                method: match self.refinement {
                    Refinement::Delaunay => RefineMethod::Delaunay,
                    Refinement::Paper => RefineMethod::Paper,
                },
                level: options.level,
                grading: (options.grading).unwrap_or(RefineParams::default().grading),
                max_triangles: options.max_triangles,
                ..RefineParams::default()
            },
            caps: self.caps().caps(),
            cap_uv_scale: (options.cap_uv_scale).unwrap_or(CutParams::default().cap_uv_scale),
            ..CutParams::default()
        }
    }

    /// Returns the curves that get caps.
    pub(crate) fn caps(self) -> CapsOption {
        self.options.caps.unwrap_or_default()
    }

    /// Returns the exact method's parameters; its defaults with the paper's method.
    pub(crate) fn exact(self) -> ExactParams {
        let default = ExactParams::default();
        ExactParams {
            snap: self.options.snap.unwrap_or(default.snap),
            remesh: self.options.remesh.unwrap_or(default.remesh),
        }
    }

    /// Returns the sweeps through a surface, in the order of the cuts.
    ///
    /// `path` names it in errors.
    pub(crate) fn sweeps(self, surface: &Surface, path: &Path) -> Result<Vec<Sweep>, Failure> {
        let sweeps = self.options.sweeps(surface, path)?;
        if sweeps.iter().any(crosses_itself) {
            return Err(Failure::SweepCrossesItself);
        }
        Ok(sweeps)
    }

    /// Cuts a surface along sweeps, one after the other; `path` names it in errors.
    pub(crate) fn cut(
        self,
        surface: &mut Surface,
        sweeps: &[Sweep],
        path: &Path,
    ) -> Result<CutSums, Failure> {
        let params = self.params();
        let marker = CapMarker::new(surface, &params);
        let mut sums = CutSums::default();
        let (bvh_build, mut cutter) = timed(|| Cutter::new(surface));
        sums.bvh_build = bvh_build;
        cutter.set_threads(None);
        for (number, sweep) in (1..).zip(sweeps) {
            let params = if sweeps.len() == 1 {
                &params
            } else {
                marker.params()
            };
            let outcome = cutter.cut(surface, sweep, params);
            let outcome = outcome.map_err(|source| Failure::Cut {
                path: path.to_owned(),
                source,
            })?;
            if outcome.report.hits == 0 && blade_starts_inside(surface, sweep) {
                let path = path.to_owned();
                return Err(Failure::SweepInside { path });
            }
            sums.stroke.add(&outcome);
            if outcome.report.hits == 0 {
                sums.missed.push(number);
            }
            sums.walls = outcome.cap;
        }
        if sweeps.len() > 1 {
            // Later cuts have divided the caps of earlier ones.
            sums.walls = marker.take(surface);
        }
        Ok(sums)
    }
}

/// Returns the sweep of a plane of the command line, in the file's coordinates, through a box
/// relative to an origin.
pub(crate) fn plane_sweep(
    plane: Numbers<4>,
    origin: [f64; 3],
    bounds: &Aabb,
    path: &Path,
) -> Result<Sweep, Failure> {
    let Numbers([x, y, z, d]) = plane;
    let d = d - Vec3::new(x, y, z).dot(&Vec3::from(origin));
    Sweep::from_plane([x, y, z], d, bounds).map_err(|error| match error {
        // The plane's numbers are finite, so the box is too large.
        CutError::SweepNotFinite { .. } => Failure::TooLarge {
            path: path.to_owned(),
            bounds: in_file(origin, bounds),
        },
        error => Failure::Sweep(error),
    })
}

/// Cosine of the angle between the normals of a folded sweep's triangles. A blade bends that much
/// only if its ends are exchanged.
const FOLDED: f64 = -0.999;

/// Returns true if the sweep's two triangles lie on each other. Such a sweep could be cut along,
/// but its user meant the sweep without the fold.
fn crosses_itself(sweep: &Sweep) -> bool {
    let normals: Vec<Vec3> = sweep.triangles().map(area_vector).collect();
    let (first, second) = (normals[0], normals[1]);
    first.dot(&second) < FOLDED * first.norm() * second.norm()
}
