//! How a command that cuts is to cut: its options, and the cut itself.

use crate::clock::timed;
use crate::failure::Failure;
use crate::numbers::{Numbers, numbers};
use clap::ValueEnum;
use incise_cut::{CutError, CutMethod, CutOutcome, CutParams, Cutter, Sweep, starts_inside};
use incise_mesh::Surface;
use incise_mesh::geometry::area_vector;
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use std::path::Path;
use std::time::Duration;

/// Options of a cut. A command that takes them has a group `cutter` of `plane` and `blade`.
#[derive(clap::Args)]
pub(crate) struct CutOptions {
    /// Cut along the plane `nx x + ny y + nz z = d`.
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = numbers::<4>, allow_hyphen_values = true)]
    plane: Option<Numbers<4>>,
    /// Cut along the sweep of a blade's edge: from here, start and end ...
    ///
    /// The sweep is two triangles. Where the four corners do not lie in one plane it is folded along the diagonal from
    /// the start of --blade to the end of --to.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = numbers::<6>, allow_hyphen_values = true, requires = "to")]
    blade: Option<Numbers<6>>,
    /// ... to here, in the same order.
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = numbers::<6>, allow_hyphen_values = true, requires = "blade", conflicts_with = "plane")]
    to: Option<Numbers<6>>,
    /// How fine caps get: 2x-coarser, 1.5x-coarser, original, 1.5x-finer, 2x-finer, or z times the surface's edges.
    /// The rim's own edges stay, so a small cap has little to make coarser.
    #[arg(long, default_value = "original", requires = "cutter")]
    level: RefinementLevel,
    /// The exact method: by how much the caps' edges get longer with every unit off the rim. 0 keeps the
    /// surface's edge length at the rim to the middle; 0.3 makes caps that cost their outline and not their area.
    /// [default: 0]
    #[arg(long, value_name = "G", value_parser = grading, allow_hyphen_values = true, requires = "cutter")]
    grading: Option<f64>,
    /// Refuse the cut when a cap needs more triangles than this.
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().max_triangles, requires = "cutter")]
    max_triangles: usize,
    /// How the mesh is opened.
    #[arg(long, value_enum, default_value_t = Method::Exact, requires = "cutter")]
    method: Method,
    /// How caps are refined; by default `delaunay` with the exact method and `paper` with `rebuild`, which knows no other.
    #[arg(long, value_enum, value_name = "REFINEMENT", requires = "cutter")]
    refine_method: Option<Refinement>,
    /// The exact method: edges along the rim that are shorter than this part of the surface's edges are
    /// contracted. 0 keeps the exact geometry and leaves slivers, which a solver pays for; below 0.5.
    /// [default: 0.1]
    #[arg(long, value_name = "S", value_parser = snap, allow_hyphen_values = true, requires = "cutter")]
    snap: Option<f64>,
    /// The exact method: slivers that the blade leaves in the old surface beside the rim go, where the surface moves by no
    /// more than this part of its edges for that. 0 leaves them, 0.1 about halves them; below 0.5.
    /// [default: 0]
    #[arg(long, value_name = "T", value_parser = remesh, allow_hyphen_values = true, requires = "cutter")]
    remesh: Option<f64>,
}

/// Options that go together.
#[derive(Clone, Copy)]
pub(crate) struct CutPlan<'a> {
    options: &'a CutOptions,
    refinement: Refinement,
}

/// What a cut came to.
pub(crate) struct Cut {
    pub(crate) outcome: CutOutcome,
    /// Time that the search tree took.
    pub(crate) search_tree: Duration,
}

#[derive(Clone, Copy, ValueEnum)]
enum Method {
    /// Split the hit triangles along the sweep and close any cross-section: no surface is lost.
    Exact,
    /// The paper's: delete the hit triangles, rebuild the rim, patch and refine the hole.
    Rebuild,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Rebuild => "rebuild",
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Refinement {
    /// A core of equilateral triangles and a band around it.
    Delaunay,
    /// The paper's: ears cut off, then triangles divided and edges swapped. One edge length for each part of the section.
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

/// A share of an edge, from 0 up to 0.5.
fn snap(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|s| (0.0..0.5).contains(s));
    number.ok_or_else(|| String::from("snap is a part of an edge: at least 0 and below 0.5"))
}

/// A share of an edge, from 0 up to 0.5.
fn remesh(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|t| (0.0..0.5).contains(t));
    number.ok_or_else(|| String::from("remesh is a part of an edge: at least 0 and below 0.5"))
}

/// How targets grow: nothing or more.
fn grading(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|g: &f64| *g >= 0.0 && g.is_finite());
    number.ok_or_else(|| String::from("a grading is 0 or a positive number"))
}

impl CutOptions {
    /// Whether there is anything to cut along.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_cut(&self) -> bool {
        self.plane.is_some() || self.blade.is_some()
    }

    /// Whether it is cut along a plane, which goes on without end.
    #[cfg(feature = "gpu")]
    pub(crate) fn is_plane(&self) -> bool {
        self.plane.is_some()
    }

    /// The options, if they go together.
    pub(crate) fn check(&self) -> Result<CutPlan<'_>, Failure> {
        Ok(CutPlan {
            options: self,
            refinement: self.checked_refinement()?,
        })
    }

    /// How caps are refined, if the options go together.
    fn checked_refinement(&self) -> Result<Refinement, Failure> {
        let refuse = |option, with| Err(Failure::NotWith { option, with });
        let rebuild = "--method rebuild";
        match (self.method, self.refine_method) {
            (Method::Rebuild, _) if self.snap.is_some() => refuse("--snap", rebuild),
            (Method::Rebuild, _) if self.remesh.is_some() => refuse("--remesh", rebuild),
            (Method::Rebuild, _) if self.grading.is_some() => refuse("--grading", rebuild),
            (Method::Rebuild, Some(Refinement::Delaunay)) => refuse(
                "--refine-method delaunay",
                "--method rebuild, whose refinement is the paper's",
            ),
            (Method::Rebuild, _) => Ok(Refinement::Paper),
            (Method::Exact, Some(Refinement::Paper)) if self.grading.is_some() => refuse(
                "--grading",
                "--refine-method paper, which has one edge length for each part of the section",
            ),
            (Method::Exact, given) => Ok(given.unwrap_or(Refinement::Delaunay)),
        }
    }

    fn sweep(&self, surface: &Surface) -> Result<Sweep, CutError> {
        if let Some(Numbers([x, y, z, d])) = self.plane {
            return Sweep::across_box([x, y, z], d, &surface.bounds());
        }
        let edge = |numbers: Option<Numbers<6>>| {
            let Numbers([a, b, c, d, e, f]) = numbers.unwrap_or(Numbers([0.0; 6]));
            [[a, b, c], [d, e, f]].map(|p| incise_mesh::geometry::round(p.into()))
        };
        Sweep::new(edge(self.blade), edge(self.to))
    }
}

impl CutPlan<'_> {
    /// The method's name.
    pub(crate) fn method(self) -> &'static str {
        self.options.method.name()
    }

    /// Whether the method is the exact one, which has options of its own.
    pub(crate) fn is_exact(self) -> bool {
        matches!(self.options.method, Method::Exact)
    }

    /// The refinement's name.
    pub(crate) fn refinement(self) -> &'static str {
        self.refinement.name()
    }

    /// The options as the cutter takes them.
    pub(crate) fn params(self) -> CutParams {
        let (options, default) = (self.options, CutParams::default());
        CutParams {
            method: match options.method {
                Method::Exact => CutMethod::Exact,
                Method::Rebuild => CutMethod::Rebuild,
            },
            snap: options.snap.unwrap_or(default.snap),
            remesh: options.remesh.unwrap_or(default.remesh),
            refine: RefineParams {
                method: match self.refinement {
                    Refinement::Delaunay => RefineMethod::Delaunay,
                    Refinement::Paper => RefineMethod::Paper,
                },
                level: options.level,
                grading: options.grading.unwrap_or_default(),
                max_triangles: options.max_triangles,
                ..RefineParams::default()
            },
            ..default
        }
    }

    /// What cuts a surface.
    pub(crate) fn sweep(self, surface: &Surface) -> Result<Sweep, Failure> {
        let sweep = self.options.sweep(surface).map_err(Failure::Sweep)?;
        if crosses_itself(&sweep) {
            return Err(Failure::SweepCrossesItself);
        }
        Ok(sweep)
    }

    /// Cuts a surface that was read from `path`.
    pub(crate) fn cut(
        self,
        surface: &mut Surface,
        sweep: &Sweep,
        path: &Path,
    ) -> Result<Cut, Failure> {
        let (search_tree, mut cutter) = timed(|| Cutter::new(surface));
        let outcome = cutter.cut(surface, sweep, &self.params());
        let outcome = outcome.map_err(|source| Failure::Cut {
            path: path.to_owned(),
            source,
        })?;
        if outcome.report.hits == 0 && starts_inside(surface, sweep) {
            let path = path.to_owned();
            return Err(Failure::SweepInside { path });
        }
        Ok(Cut {
            outcome,
            search_tree,
        })
    }
}

/// Cosine of the angle between the normals of a sweep's triangles from which on they lie on each other: a
/// blade that bends that much has its ends exchanged.
const FOLDED: f64 = -0.999;

/// Whether the sweep's two triangles lie on each other. They could be cut along, but what was meant is the
/// blade's way without the crossing.
fn crosses_itself(sweep: &Sweep) -> bool {
    let [first, second] = sweep.triangles().map(area_vector);
    first.dot(&second) < FOLDED * first.norm() * second.norm()
}
