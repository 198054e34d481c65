//! A cut as it is written: floats as their bits, since not every format keeps all of them as numbers.

use super::Entry;
use crate::error::CutError;
use crate::params::{CutMethod, CutParams};
use crate::sweep::Sweep;
use incise_refine::{RefineMethod, RefineParams, RefinementLevel};
use serde::{Deserialize, Serialize};

/// [`CutMethod`] as it is written.
#[derive(Serialize, Deserialize)]
enum Method {
    Exact,
    Rebuild,
}

/// [`RefineMethod`] as it is written; older journals do not name it.
#[derive(Default, Serialize, Deserialize)]
enum Refinement {
    #[default]
    Delaunay,
    Paper,
}

/// [`RefinementLevel`] as it is written.
#[derive(Serialize, Deserialize)]
enum Level {
    Coarser2,
    Coarser1_5,
    Original,
    Finer1_5,
    Finer2,
    Z(u64),
}

/// A cut as it is written. A field that a cut gets must get its place here, or this does not compile.
#[derive(Serialize, Deserialize)]
pub(super) struct CutBits {
    corners: [[u32; 3]; 4],
    method: Method,
    #[serde(default)]
    refinement: Refinement,
    level: Level,
    rim_length: Option<u64>,
    #[serde(default)]
    grading: u64,
    max_rounds: u32,
    max_triangles: usize,
    snap: u64,
    #[serde(default)]
    remesh: u64,
    cap_material: u32,
    min_distance: u64,
    beta: u64,
    ear_angle: u64,
    only_piece: Option<u32>,
    after: u64,
}

impl From<Entry> for CutBits {
    fn from(entry: Entry) -> Self {
        let CutParams {
            method,
            refine,
            snap,
            remesh,
            cap_material,
            min_distance,
            beta,
            ear_angle,
            only_piece,
        } = entry.params;
        let RefineParams {
            method: refinement,
            level,
            rim_length,
            grading,
            max_rounds,
            max_triangles,
        } = refine;
        Self {
            corners: entry.sweep.corners().map(|p| p.map(f32::to_bits)),
            method: match method {
                CutMethod::Exact => Method::Exact,
                CutMethod::Rebuild => Method::Rebuild,
            },
            refinement: match refinement {
                RefineMethod::Paper => Refinement::Paper,
                _ => Refinement::Delaunay,
            },
            level: match level {
                RefinementLevel::Coarser2 => Level::Coarser2,
                RefinementLevel::Coarser1_5 => Level::Coarser1_5,
                RefinementLevel::Original => Level::Original,
                RefinementLevel::Finer1_5 => Level::Finer1_5,
                RefinementLevel::Finer2 => Level::Finer2,
                RefinementLevel::Z(z) => Level::Z(z.to_bits()),
            },
            rim_length: rim_length.map(f64::to_bits),
            grading: grading.to_bits(),
            max_rounds,
            max_triangles,
            snap: snap.to_bits(),
            remesh: remesh.to_bits(),
            cap_material,
            min_distance: min_distance.to_bits(),
            beta: beta.to_bits(),
            ear_angle: ear_angle.to_bits(),
            only_piece,
            after: entry.after,
        }
    }
}

impl TryFrom<CutBits> for Entry {
    type Error = CutError;

    fn try_from(bits: CutBits) -> Result<Self, CutError> {
        let [a, b, c, d] = bits.corners.map(|p| p.map(f32::from_bits));
        Ok(Self {
            sweep: Sweep::new([a, b], [d, c])?,
            params: CutParams {
                method: match bits.method {
                    Method::Exact => CutMethod::Exact,
                    Method::Rebuild => CutMethod::Rebuild,
                },
                refine: RefineParams {
                    method: match bits.refinement {
                        Refinement::Delaunay => RefineMethod::Delaunay,
                        Refinement::Paper => RefineMethod::Paper,
                    },
                    level: match bits.level {
                        Level::Coarser2 => RefinementLevel::Coarser2,
                        Level::Coarser1_5 => RefinementLevel::Coarser1_5,
                        Level::Original => RefinementLevel::Original,
                        Level::Finer1_5 => RefinementLevel::Finer1_5,
                        Level::Finer2 => RefinementLevel::Finer2,
                        Level::Z(z) => RefinementLevel::Z(f64::from_bits(z)),
                    },
                    rim_length: bits.rim_length.map(f64::from_bits),
                    grading: f64::from_bits(bits.grading),
                    max_rounds: bits.max_rounds,
                    max_triangles: bits.max_triangles,
                },
                snap: f64::from_bits(bits.snap),
                remesh: f64::from_bits(bits.remesh),
                cap_material: bits.cap_material,
                min_distance: f64::from_bits(bits.min_distance),
                beta: f64::from_bits(bits.beta),
                ear_angle: f64::from_bits(bits.ear_angle),
                only_piece: bits.only_piece,
            },
            after: bits.after,
        })
    }
}
