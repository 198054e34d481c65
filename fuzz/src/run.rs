//! A case, step by step.

use crate::case::{Case, Knife, Step};
use incise_cut::{CutError, CutParams, Cutter, Sweep};
use incise_mesh::geometry::round;
use incise_mesh::{Surface, Undo, Vec3};
use incise_refine::RefineParams;
use incise_tests::{assert_same_bits, assert_sound, cut_and_check};

/// A cut that can be taken back.
struct Done {
    before: Surface,
    undo: Undo,
    /// Whether the body has moved since.
    moved: bool,
}

impl Case {
    /// Does it all.
    ///
    /// # Panics
    /// When a law does not hold, or a cut is refused that should not be.
    pub fn run(&self) {
        let mut surface = self.surface();
        assert_sound(&surface);
        let mut cutter = Cutter::new(&surface);
        let mut done: Vec<Done> = Vec::new();
        for step in &self.steps {
            match *step {
                Step::Cut {
                    knife,
                    level,
                    snap,
                    remesh,
                    method,
                    only,
                } => {
                    let params = CutParams {
                        snap,
                        remesh,
                        only_piece: only.and_then(|n| piece(&surface, n)),
                        refine: RefineParams {
                            method,
                            level,
                            ..RefineParams::default()
                        },
                        ..CutParams::default()
                    };
                    let before = surface.clone();
                    let undo = cut(&mut surface, &mut cutter, &knife, &params);
                    done.extend(undo.map(|undo| Done {
                        before,
                        undo,
                        moved: false,
                    }));
                }
                Step::Undo => {
                    if let Some(last) = done.pop() {
                        take_back(&mut surface, &mut cutter, last);
                    }
                }
                Step::Bend(by) => {
                    bend(&mut surface, by);
                    cutter.refit(&surface);
                    done.iter_mut().for_each(|cut| cut.moved = true);
                }
            }
        }
        // All the way back.
        while let Some(last) = done.pop() {
            take_back(&mut surface, &mut cutter, last);
        }
    }

    /// The body where the case puts it.
    fn surface(&self) -> Surface {
        let mut surface = self.body.build();
        let shift = Vec3::from(self.place) * surface.bounds().diagonal();
        let scale = 10.0_f64.powi(self.exponent);
        let vertices: Vec<_> = surface.topology().vertices().collect();
        for v in vertices {
            let [x, y, z] = round((surface.position(v) + shift) * scale);
            surface.positions[v.index()] = [x, y, z, surface.positions[v.index()][3]];
            surface.rest[v.index()] = [x, y, z];
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
    knife: &Knife,
    params: &CutParams,
) -> Option<Undo> {
    let sweep = match knife {
        Knife::Blade(blade) => blade.sweep(surface),
        Knife::Corners(corners) => around(*corners, surface),
    };
    let is_full = matches!(knife, Knife::Blade(blade) if blade.is_full_plane());
    match cut_and_check(surface, cutter, &sweep.ok()?, params) {
        Ok(outcome) => outcome.undo,
        Err(CutError::PartialCut { .. }) if !is_full => None,
        Err(error) => panic!("{knife:?} was refused: {error}"),
    }
}

fn around(corners: [[f64; 3]; 4], surface: &Surface) -> Result<Sweep, CutError> {
    let bounds = surface.bounds();
    let at = |c: [f64; 3]| round(bounds.center() + Vec3::from(c) * bounds.diagonal());
    let [a, b, c, d] = corners.map(at);
    Sweep::new([a, b], [d, c])
}

fn take_back(surface: &mut Surface, cutter: &mut Cutter, done: Done) {
    let undone = cutter.undo(surface, done.undo);
    undone.expect("the last cut can be taken back");
    let tree = cutter.bvh().validate(surface);
    tree.expect("the search tree fits the surface");
    if done.moved {
        assert_sound(surface);
        let (was, is) = (done.before.topology(), surface.topology());
        assert_eq!(was, is, "the old triangles are there");
    } else {
        assert_same_bits(&done.before, surface);
    }
}

/// Moves every vertex by a wave across the body.
fn bend(surface: &mut Surface, by: [f64; 3]) {
    let bounds = surface.bounds();
    let (center, diagonal) = (bounds.center(), bounds.diagonal());
    let vertices: Vec<_> = surface.topology().vertices().collect();
    for v in vertices {
        let p = surface.position(v);
        let at = (p - center) / diagonal;
        let wave = Vec3::from_fn(|k, _| by[k] * (7.0 * at[(k + 1) % 3]).sin());
        let [x, y, z] = round(p + wave * diagonal);
        surface.positions[v.index()] = [x, y, z, surface.positions[v.index()][3]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arbitrary::{Arbitrary, Unstructured};

    /// Bytes at random, so that a case that does not even begin is seen without a fuzzer.
    #[test]
    fn random_bytes_are_cases_that_keep_the_laws() {
        let mut state = 1_u64;
        let mut cuts = 0;
        for _ in 0..60 {
            let bytes: Vec<u8> = (0..400)
                .map(|_| {
                    // Knuth's linear congruence; the high bits are random.
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1);
                    state.to_be_bytes()[0]
                })
                .collect();
            let case = Case::arbitrary(&mut Unstructured::new(&bytes));
            let case = case.expect("bytes for a case");
            let is_cut = |step: &&Step| matches!(step, Step::Cut { .. });
            cuts += case.steps.iter().filter(is_cut).count();
            case.run();
        }
        assert!(cuts > 100, "only {cuts} cuts were tried");
    }
}
