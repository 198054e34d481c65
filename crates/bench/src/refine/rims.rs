//! The sections that planes leave of a model.

use super::row::Stamp;
use crate::directions::{Directions, GENERIC, SPREAD};
use crate::statistics::mean;
use crate::subject::Subject;
use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3};
use incise_refine::{CoverSize, RefineParams, RefinementLevel, Section};
use std::error::Error;

/// A section, and how long edges are to get at its points \[m\].
pub(super) struct Rims {
    points: Vec<[f64; 2]>,
    loops: Vec<Vec<u32>>,
    lengths: Vec<f64>,
    crease: bool,
}

impl Rims {
    pub(super) fn section(&self) -> Section<'_> {
        Section {
            points: &self.points,
            loops: &self.loops,
            crease: self.crease,
        }
    }

    pub(super) fn size(&self) -> CoverSize<'_> {
        CoverSize::Local(&self.lengths)
    }

    pub(super) fn points(&self) -> usize {
        self.points.len()
    }

    /// The target at every point \[m\].
    pub(super) fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// How long edges are to get in the mean \[m\]: what programs that take one length are asked for.
    pub(super) fn target(&self) -> f64 {
        mean(&self.lengths)
    }

    /// Sixteen digits that tell sections apart, made of every bit of one (FNV-1a, Fowler et al. 1991).
    pub(super) fn fingerprint(&self) -> String {
        let points = self.points.iter().flatten().map(|x| x.to_bits());
        let loops = self.loops.iter().flat_map(|points| {
            let corners = points.iter().map(|&p| u64::from(p));
            corners.chain([u64::MAX])
        });
        let lengths = self.lengths.iter().map(|length| length.to_bits());
        let words = points.chain(loops).chain(lengths);
        let hash = words
            .flat_map(u64::to_le_bytes)
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        format!("{hash:016x}")
    }

    /// Loops in the plane with these targets.
    #[cfg(test)]
    pub(super) fn new(points: Vec<[f64; 2]>, loops: Vec<Vec<u32>>, lengths: Vec<f64>) -> Self {
        Self {
            points,
            loops,
            lengths,
            crease: false,
        }
    }

    /// One loop with these targets.
    #[cfg(test)]
    pub(super) fn of_loop(points: Vec<[f64; 2]>, lengths: Vec<f64>) -> Self {
        let corners = (0..).take(points.len()).collect();
        Self::new(points, vec![corners], lengths)
    }

    pub(super) fn is_one_loop(&self) -> bool {
        self.loops.len() == 1
    }

    /// The first loop in space, counterclockwise seen against z, and its targets.
    pub(super) fn only_loop(&self) -> (Vec<Vec3>, Vec<f64>) {
        let corners = self.loops.first().map_or(&[][..], |points| points);
        let points = corners.iter().map(|&p| {
            let [x, y] = self.points[p as usize];
            (Vec3::new(x, y, 0.0), self.lengths[p as usize])
        });
        points.unzip()
    }
}

/// Sections of planes of one kind at one level, and why cuts failed.
type Cuts = (&'static str, RefinementLevel, Vec<Rims>, Vec<String>);

/// The sections along the plane through the middle and along seeded ones.
pub(super) fn of(
    subject: &Subject,
    levels: &[RefinementLevel],
    planes: u32,
    stamp: &Stamp,
) -> Result<Vec<Cuts>, Box<dyn Error>> {
    let mut surface = subject.surface()?;
    let mut cutter = Cutter::new(&surface);
    let mut cuts = Vec::new();
    for &level in levels {
        let mut directions = Directions(stamp.seed);
        let middle = vec![(Vec3::from(GENERIC).normalize(), 0.0)];
        let seeded: Vec<(Vec3, f64)> = (0..planes)
            .map(|_| (directions.next_unit(), SPREAD * directions.next()))
            .collect();
        let params = CutParams {
            snap: stamp.snap,
            refine: RefineParams {
                level,
                grading: stamp.grading,
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        for (name, planes) in [("middle", middle), ("seeded", seeded)] {
            if planes.is_empty() {
                continue;
            }
            let (mut rims, mut failures) = (Vec::new(), Vec::new());
            for (normal, part) in planes {
                match cut(&mut surface, &mut cutter, normal, part, &params)? {
                    Ok(found) => rims.extend(found),
                    Err(failure) => failures.push(failure),
                }
            }
            cuts.push((name, level, rims, failures));
        }
    }
    Ok(cuts)
}

/// Cuts along a plane and takes it back. Nothing where the plane misses; the inner error is the cut's.
fn cut(
    surface: &mut Surface,
    cutter: &mut Cutter,
    normal: Vec3,
    part: f64,
    params: &CutParams,
) -> Result<Result<Option<Rims>, String>, Box<dyn Error>> {
    let vertices = surface.topology().vertices();
    let heights = vertices.map(|v| normal.dot(&surface.position(v)));
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
        [low.min(height), high.max(height)]
    });
    let d = (low + high) / 2.0 + part * (high - low) / 2.0;
    let sweep = Sweep::across_box(normal.into(), d, &surface.bounds())?;
    let outcome = match cutter.cut(surface, &sweep, params) {
        Ok(outcome) => outcome,
        Err(error) => return Ok(Err(format!("{error} (normal {normal:?}, d {d})"))),
    };
    let Some(undo) = outcome.undo else {
        return Ok(Ok(None));
    };
    let (section, lengths) = cutter.section();
    let rims = Rims {
        points: section.points.to_vec(),
        loops: section.loops.to_vec(),
        lengths: lengths.to_vec(),
        crease: section.crease,
    };
    cutter.undo(surface, undo)?;
    Ok(Ok(Some(rims)))
}
