//! Parameters of cuts and of the filling of holes.

use crate::memory::count;
use crate::status::Error;
use incise::cut::{self, Caps};
use incise::refine::{HoleParams, RefineParams, RefinementLevel};

/// Closes cut bodies; a piece with a boundary is a sheet and stays open.
pub const INCISE_CAPS_BODIES: u32 = 0;
/// Closes bodies, and closed curves in sheets.
pub const INCISE_CAPS_ALL_LOOPS: u32 = 1;
/// Closes nothing.
pub const INCISE_CAPS_NONE: u32 = 2;

/// Parameters of a cut; `incise_cut_params_init` writes the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutParams {
    /// `INCISE_CAPS_BODIES`, `INCISE_CAPS_ALL_LOOPS` or `INCISE_CAPS_NONE`.
    pub caps: u32,
    /// Material number of caps.
    pub cap_material: u32,
    /// Texture coordinates of caps per meter, at least 0.
    pub cap_uv_scale: f64,
    /// Edge length of caps relative to the surface at the rim, above 0. The paper's levels are 2,
    /// 1.5, 1, 1/1.5 and 0.5.
    pub level: f64,
    /// Growth of the edge lengths of caps with the distance from the rim (meters per meter), at
    /// least 0. At 0 the length at the rim holds everywhere.
    pub grading: f64,
    /// Minimum length of rim edges in local edge lengths, at least 0, below 0.5.
    pub snap: f64,
    /// Maximum displacement by remeshing in local edge lengths, at least 0, below 0.5.
    pub remesh: f64,
}

impl From<&cut::CutParams> for CutParams {
    fn from(params: &cut::CutParams) -> Self {
        Self {
            caps: match params.caps {
                Caps::None => INCISE_CAPS_NONE,
                Caps::AllLoops => INCISE_CAPS_ALL_LOOPS,
                _ => INCISE_CAPS_BODIES,
            },
            cap_material: params.cap_material,
            cap_uv_scale: params.cap_uv_scale,
            level: params.refine.level.z(),
            grading: params.refine.grading,
            snap: params.snap,
            remesh: params.remesh,
        }
    }
}

impl CutParams {
    /// Returns the parameters of the library; `base` has the ones without a field here.
    pub(crate) fn check(&self, base: cut::CutParams) -> Result<cut::CutParams, Error> {
        let params = cut::CutParams {
            snap: self.snap,
            remesh: self.remesh,
            refine: RefineParams {
                level: level(self.level)?,
                grading: self.grading,
                ..base.refine
            },
            caps: match self.caps {
                INCISE_CAPS_BODIES => Caps::Bodies,
                INCISE_CAPS_ALL_LOOPS => Caps::AllLoops,
                INCISE_CAPS_NONE => Caps::None,
                caps => return Err(Error::constant("caps", caps)),
            },
            cap_material: self.cap_material,
            cap_uv_scale: self.cap_uv_scale,
            ..base
        };
        params.check().map_err(Error::argument)?;
        Ok(params)
    }
}

/// Returns a level, the named one of an equal value.
fn level(z: f64) -> Result<RefinementLevel, Error> {
    if !(z > 0.0 && z.is_finite()) {
        return Err(Error::argument(format_args!(
            "level is {z}; pass a number above 0"
        )));
    }
    let named = RefinementLevel::FIVE.into_iter().find(|l| l.z() == z);
    Ok(named.unwrap_or(RefinementLevel::Z(z)))
}

/// Parameters of `incise_mesh_fill`; `incise_fill_params_init` writes the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FillParams {
    /// Edge length of patches relative to the surface around the hole, above 0.
    pub level: f64,
    /// Maximum number of edges of a rim; holes with more stay open.
    pub max_rim_edges: u32,
    /// Maximum number of triangles of all patches together.
    pub max_triangles: u32,
}

impl From<&HoleParams> for FillParams {
    fn from(params: &HoleParams) -> Self {
        Self {
            level: params.level.z(),
            max_rim_edges: count(params.max_rim_edges),
            max_triangles: count(params.max_triangles),
        }
    }
}

impl FillParams {
    /// Returns the parameters of the library.
    pub(crate) fn check(&self) -> Result<HoleParams, Error> {
        Ok(HoleParams {
            level: level(self.level)?,
            max_rim_edges: self.max_rim_edges as usize,
            max_triangles: self.max_triangles as usize,
            ..HoleParams::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::Status;

    #[test]
    fn defaults_are_those_of_the_libraries() {
        let cut = cut::CutParams::default();
        assert_eq!(CutParams::from(&cut).check(cut), Ok(cut));
        let z = RefinementLevel::Finer1_5.z();
        assert_eq!(level(z), Ok(RefinementLevel::Finer1_5), "bits of 1/1.5");
        let fill = FillParams::from(&HoleParams::default()).check();
        assert_eq!(
            fill.map(|p| (p.level, p.max_triangles, p.fair)),
            Ok((RefinementLevel::Original, 1_000_000, false))
        );
    }

    #[test]
    fn constants_and_levels_are_checked() {
        let base = cut::CutParams::default();
        let valid = CutParams::from(&base);
        let caps = CutParams { caps: 7, ..valid }.check(base);
        assert_eq!(caps, Err(Error::constant("caps", 7)));
        for z in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(CutParams { level: z, ..valid }.check(base).is_err(), "{z}");
        }
        let (snap, remesh, grading) = (0.5, 0.5, -0.1);
        for params in [
            CutParams { snap, ..valid },
            CutParams { remesh, ..valid },
            CutParams { grading, ..valid },
            CutParams {
                cap_uv_scale: f64::NAN,
                ..valid
            },
        ] {
            let status = params.check(base).map_err(|error| error.status);
            assert_eq!(status, Err(Status::InvalidArgument), "{params:?}");
        }
    }
}
