//! Runs a fuzz case and checks invariants after every step.

use super::case::{Case, Step, SweepCase};
use crate::{assert_closed_manifold, assert_same_bits, cut_and_check};
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Undo, Vec3};
use incise_refine::RefineParams;

/// A cut that can be undone.
pub(crate) struct Done {
    pub(crate) before: Surface,
    pub(crate) undo: Undo,
    /// True if the body has moved since.
    pub(crate) moved: bool,
}

impl Case {
    /// Runs all steps, then undoes all cuts.
    ///
    /// # Panics
    /// If an invariant does not hold, or a cut fails that should not.
    pub fn run(&self) {
        let mut surface = self.surface();
        assert_closed_manifold(&surface);
        let mut cutter = Cutter::new(&surface);
        let mut done: Vec<Done> = Vec::new();
        for step in &self.steps {
            match *step {
                Step::Cut {
                    sweep,
                    level,
                    snap,
                    remesh,
                    only,
                } => {
                    let params = CutParams {
                        snap,
                        remesh,
                        only_piece: only.and_then(|n| piece(&surface, n)),
                        refine: RefineParams {
                            level,
                            ..RefineParams::default()
                        },
                        ..CutParams::default()
                    };
                    let before = surface.clone();
                    let undo = cut(&mut surface, &mut cutter, &sweep, &params);
                    done.extend(undo.map(|undo| Done {
                        before,
                        undo,
                        moved: false,
                    }));
                }
                Step::Undo => {
                    if let Some(last) = done.pop() {
                        undo_cut(&mut surface, &mut cutter, last);
                    }
                }
                Step::Bend(by) => {
                    bend(&mut surface, by);
                    cutter.refit(&surface);
                    done.iter_mut().for_each(|cut| cut.moved = true);
                }
            }
        }
        while let Some(last) = done.pop() {
            undo_cut(&mut surface, &mut cutter, last);
        }
    }

    /// The body where the case puts it.
    fn surface(&self) -> Surface {
        let mut surface = self.body.build();
        let shift = Vec3::from(self.offset) * surface.bounds().diagonal();
        let scale = 10.0_f64.powi(self.exponent);
        let vertices: Vec<_> = surface.topology().vertices().collect();
        for v in vertices {
            let [x, y, z] = to_f32((surface.position(v) + shift) * scale);
            surface.positions_mut()[v.index()] = [x, y, z, surface.positions()[v.index()][3]];
            surface.rest_positions_mut()[v.index()] = [x, y, z];
        }
        surface
    }
}

/// The piece of this number, modulo how many there are.
fn piece(surface: &Surface, n: u32) -> Option<u32> {
    let pieces = 0..surface.piece_bound();
    let pieces: Vec<u32> = pieces.filter(|&p| surface.piece_triangles(p) > 0).collect();
    pieces.get(n as usize % pieces.len().max(1)).copied()
}

fn cut(
    surface: &mut Surface,
    cutter: &mut Cutter,
    case: &SweepCase,
    params: &CutParams,
) -> Option<Undo> {
    let sweep = match case {
        SweepCase::Blade(blade) => blade.sweep(surface),
        SweepCase::Corners(corners) => around(*corners, surface),
    };
    let is_full = matches!(case, SweepCase::Blade(blade) if blade.is_full_plane());
    match cut_and_check(surface, cutter, &sweep.ok()?, params) {
        Ok(outcome) => outcome.undo,
        Err(CutError::PartialCut { .. }) if !is_full => None,
        Err(error) => panic!("{case:?} was refused: {error}"),
    }
}

fn around(corners: [[f64; 3]; 4], surface: &Surface) -> Result<Sweep, CutError> {
    let bounds = surface.bounds();
    let at = |c: [f64; 3]| to_f32(bounds.center() + Vec3::from(c) * bounds.diagonal());
    let [a, b, c, d] = corners.map(at);
    Sweep::new([a, b], [d, c])
}

/// Undoes a cut and checks that the surface is the one from before it.
pub(crate) fn undo_cut(surface: &mut Surface, cutter: &mut Cutter, done: Done) {
    let undone = cutter.undo(surface, done.undo);
    undone.expect("the last cut can be taken back");
    let tree = cutter.bvh().validate(surface);
    tree.expect("the BVH matches the surface");
    if done.moved {
        if done.before.topology().is_closed() {
            assert_closed_manifold(surface);
        }
        let (was, is) = (done.before.topology(), surface.topology());
        assert_eq!(was, is, "the old triangles are there");
    } else {
        assert_same_bits(&done.before, surface);
    }
}

/// Moves every vertex by a wave across the body.
pub(crate) fn bend(surface: &mut Surface, by: [f64; 3]) {
    let bounds = surface.bounds();
    let (center, diagonal) = (bounds.center(), bounds.diagonal());
    let vertices: Vec<_> = surface.topology().vertices().collect();
    for v in vertices {
        let p = surface.position(v);
        let at = (p - center) / diagonal;
        let wave = Vec3::from_fn(|k, _| by[k] * (7.0 * at[(k + 1) % 3]).sin());
        let [x, y, z] = to_f32(p + wave * diagonal);
        surface.positions_mut()[v.index()] = [x, y, z, surface.positions()[v.index()][3]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::random_bytes;
    use arbitrary::{Arbitrary, Unstructured};

    /// Runs cases from random bytes, which checks the harness without a fuzzer.
    #[test]
    fn random_cases_keep_the_invariants() {
        let mut cuts = 0;
        for bytes in random_bytes(400).take(60) {
            let case = Case::arbitrary(&mut Unstructured::new(&bytes));
            let case = case.expect("bytes for a case");
            let is_cut = |step: &&Step| matches!(step, Step::Cut { .. });
            cuts += case.steps.iter().filter(is_cut).count();
            case.run();
        }
        assert!(cuts > 100, "only {cuts} cuts were tried");
    }
}
