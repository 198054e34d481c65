//! Command-line options of a cut, and the cut itself, for `cut` and `render`.

use crate::clock::timed;
use crate::failure::{CutFailure, Failure};
use crate::input::in_file;
use crate::numbers::{Numbers, numbers};
use crate::param_options::{OptionSet, ParamOptions};
use crate::stroke::CutSums;
use clap::Arg;
use incise_cut::{CapMarker, CutError, CutParams, Cutter, Sweep, blade_starts_inside};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{Aabb, Surface, Vec3};
use incise_paper::PaperParams;
use incise_params::Value;
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
    #[command(flatten)]
    params: ParamOptions<CutOptionSet>,
}

/// The parameters of a cut, which need a plane or a blade.
#[derive(Debug)]
pub(crate) struct CutOptionSet;

impl OptionSet for CutOptionSet {
    type Params = CutParams;

    fn option(_: &str, option: Arg) -> Option<Arg> {
        Some(option.requires("cutter"))
    }
}

/// Validated options of a cut: no two exclude each other.
#[derive(Clone, Copy)]
pub(crate) struct CutPlan<'a> {
    options: &'a CutOptions,
    params: CutParams,
    /// The parameters of the paper's method, if it is chosen.
    paper: Option<PaperParams>,
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
            params: self.params.params()?,
            paper: None,
        })
    }

    /// Returns the parameters that are given, by name.
    pub(crate) fn given(&self) -> &[(String, Value)] {
        self.params.given()
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
    /// Returns the plan of a cut by the paper's method.
    pub(crate) fn by_paper(self, params: PaperParams) -> Self {
        let paper = Some(params);
        Self { paper, ..self }
    }

    /// Returns true unless the paper's method is chosen.
    pub(crate) fn is_exact(self) -> bool {
        self.paper.is_none()
    }

    /// Returns the parameters for the cutter.
    pub(crate) fn params(self) -> CutParams {
        self.params
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
            let outcome = match self.paper {
                None => cutter.cut(surface, sweep, params).map_err(CutFailure::Cut),
                Some(paper) => {
                    let paper = PaperParams {
                        cap_material: params.cap_material,
                        ..paper
                    };
                    let outcome = incise_paper::cut(&mut cutter, surface, sweep, &paper);
                    outcome
                        .map(|outcome| outcome.cut)
                        .map_err(CutFailure::Paper)
                }
            };
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
