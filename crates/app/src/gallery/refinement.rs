//! Figure 3: a hole, triangulated and refined by the paper's listings, step by step.
//!
//! `incise-refine` gives the steps: its triangulation, its refinement with no round and with one, and of each vertex
//! inside the triangle that was divided for it.

use super::boundary::PLANE;
use super::figure::{BODY, CAP, FigureError, Panel, Row, Shown, letter};
use super::slice::{METHODS, Slice, facts, is_cap, name, params, side};
use incise_cut::CutMethod;
use incise_mesh::geometry::{area_vector, round};
use incise_mesh::{Model, Surface, Vec3, build_model};
use incise_refine::{
    Patch, RefineError, RefineParams, RefinementLevel, fill, mean_rim_length, refine, triangulate,
};
use incise_render::Camera;

const MODEL: Model = Model::Sphere80;

/// The steps of the paper's figure from its second on.
const STEPS: [&str; 4] = [
    "initial triangulation",
    "triangles divided once",
    "refined",
    "refined, no swaps before",
];

pub(super) fn refinement() -> Result<Vec<Row>, FigureError> {
    let surface = build_model(MODEL);
    let [x, y, z, _] = PLANE;
    let whole = Shown::new(surface.clone(), |_, _| Some(BODY));
    let camera = side(Vec3::new(x, y, z)).frame(whole.corners(), 1.0);
    let rows = METHODS.map(|method| row(&surface, camera, method));
    rows.into_iter().collect()
}

fn row(surface: &Surface, camera: Camera, method: CutMethod) -> Result<Row, FigureError> {
    let params = params(method, RefinementLevel::Original);
    let slice = Slice::of(surface, PLANE, &params)?;
    let mut facts = facts(MODEL, &params, &[PLANE]);
    let whole = Shown::new(surface.clone(), |_, _| Some(BODY));
    let label = "(a) before the cut".to_owned();
    let mut panels = vec![Panel::of(label, camera, vec![whole], facts.clone())];
    facts.second_half_removed = true;
    let open = Shown::new(slice.surface.clone(), |surface, t| {
        (slice.is_behind(t) && !is_cap(surface, t)).then_some(BODY)
    });
    let mut patches: [Vec<Patch>; 4] = Default::default();
    for rim in slice.rims() {
        let rim = rim.iter().map(|&v| slice.surface.position(v)).collect();
        let rim = as_the_cut_begins(rim, &slice.caps())?;
        for (all, patch) in patches.iter_mut().zip(steps(&rim)?) {
            all.push(patch);
        }
    }
    for (i, (text, patches)) in STEPS.into_iter().zip(patches).enumerate() {
        let mut shown = vec![open.clone()];
        for patch in &patches {
            let points: Vec<[f32; 3]> = patch.points.iter().map(|&p| round(p)).collect();
            let patch = Surface::from_triangles(&points, &patch.triangles)?;
            shown.push(Shown::new(patch, |_, _| Some(CAP)));
        }
        let triangles: usize = patches.iter().map(|patch| patch.triangles.len()).sum();
        let label = format!("({}) {text}, {triangles}", letter(i + 1));
        panels.push(Panel::of(label, camera, shown, facts.clone()));
    }
    if method == CutMethod::Exact {
        let half = slice.half();
        let label = format!("(f) the method's own cap, {}", half.caps());
        panels.push(Panel::of(label, camera, vec![half], facts));
    }
    Ok(Row {
        title: format!("{}, rim of {}", MODEL.name(), name(method)),
        panels,
    })
}

/// The patch of a rim after each of the steps.
fn steps(rim: &[Vec3]) -> Result<[Patch; 4], RefineError> {
    let (alpha, normal) = (mean_rim_length(rim), newell(rim));
    let rounds = |max_rounds| RefineParams {
        max_rounds,
        ..RefineParams::default()
    };
    let free = |_, _| false;
    let initial = triangulate(rim, normal, &free);
    let mut swapped = initial.clone();
    refine(&mut swapped, normal, alpha, &rounds(0), &free)?;
    let mut once = initial.clone();
    refine(&mut once, normal, alpha, &rounds(1), &free)?;
    let divided = divided(swapped, &once);
    let refined = fill(rim, normal, &RefineParams::default(), free)?;
    // Swaps before the first round would only make edges between vertices of the rim, which are all there are; where these
    // count as joined there are none. After it the listing goes on as always, beginning with the swaps of that round.
    let mut once = initial.clone();
    refine(&mut once, normal, alpha, &rounds(1), &|_, _| true)?;
    let mut unswapped = self::divided(initial.clone(), &once);
    refine(
        &mut unswapped,
        normal,
        alpha,
        &rounds(RefineParams::default().max_rounds - 1),
        &free,
    )?;
    Ok([initial, divided, refined, unswapped])
}

/// Two triangles of the same surface are the same when their centers are this close \[m\]; a cut rounds its points to
/// 32 bits.
const SAME: f64 = 1e-5;

/// Whether a patch has these triangles.
fn has_made(patch: &Patch, caps: &[[Vec3; 3]]) -> bool {
    let center = |[a, b, c]: [Vec3; 3]| (a + b + c) / 3.0;
    let own = patch.triangles.iter();
    let own: Vec<Vec3> = own
        .map(|t| center(t.map(|v| patch.points[v as usize])))
        .collect();
    let is_own = |&cap: &[Vec3; 3]| own.iter().any(|p| (p - center(cap)).norm() < SAME);
    own.len() == caps.len() && caps.iter().all(is_own)
}

/// The rim from the vertex on that the cut began with, since ties are broken by the order: the one from which the whole
/// refinement gives the cut's own caps. As it is where none does, as with caps that are not made by the listings.
fn as_the_cut_begins(mut rim: Vec<Vec3>, caps: &[[Vec3; 3]]) -> Result<Vec<Vec3>, RefineError> {
    for _ in 0..rim.len() {
        let patch = fill(&rim, newell(&rim), &RefineParams::default(), |_, _| false)?;
        if has_made(&patch, caps) {
            break;
        }
        rim.rotate_left(1);
    }
    Ok(rim)
}

/// The normal of a loop, which need not be flat: the paper's rims are not.
fn newell(rim: &[Vec3]) -> Vec3 {
    let ears = rim.windows(2).skip(1);
    ears.map(|pair| area_vector([rim[0], pair[0], pair[1]]))
        .sum()
}

/// The patch with those triangles divided, and not yet swapped, that were divided on the way to `after`.
fn divided(mut patch: Patch, after: &Patch) -> Patch {
    for (&corners, &center) in after.inner.iter().zip(&after.points[after.rim..]) {
        let Some(t) = patch.triangles.iter().position(|&t| t == corners) else {
            continue;
        };
        // A patch has 32-bit ids, so this is one.
        let Ok(v) = u32::try_from(patch.points.len()) else {
            continue;
        };
        let [a, b, c] = corners;
        patch.points.push(center);
        patch.inner.push(corners);
        patch.triangles[t] = [a, b, v];
        patch.triangles.extend([[v, b, c], [a, v, c]]);
    }
    patch
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_those_of_the_cut() {
        let surface = build_model(MODEL);
        let params = params(CutMethod::Rebuild, RefinementLevel::Original);
        let slice = Slice::of(&surface, PLANE, &params).unwrap();
        let rims = slice.rims();
        assert_eq!(rims.len(), 1);
        let rim = rims[0].iter().map(|&v| slice.surface.position(v)).collect();
        let rim = as_the_cut_begins(rim, &slice.caps()).unwrap();
        let [initial, divided, refined, unswapped] = steps(&rim).unwrap();
        assert_eq!(initial.triangles.len(), rim.len() - 2, "corners alone");
        assert!(has_made(&refined, &slice.caps()), "the cut's own cap");
        // All vertices that a round makes are there, each in place of one triangle by three, and no swap has changed that.
        let mut once = initial.clone();
        let one = RefineParams {
            max_rounds: 1,
            ..RefineParams::default()
        };
        refine(
            &mut once,
            newell(&rim),
            mean_rim_length(&rim),
            &one,
            &|_, _| false,
        )
        .unwrap();
        assert_eq!(divided.points, once.points);
        assert_eq!(divided.triangles.len(), once.triangles.len());
        assert_ne!(divided.triangles, once.triangles, "swaps come after");
        assert!(divided.triangles.len() > initial.triangles.len());
        let sorted = |patch: &Patch| {
            let mut triangles = patch.triangles.clone();
            triangles.sort_unstable();
            triangles
        };
        assert_ne!(
            sorted(&unswapped),
            sorted(&refined),
            "swaps before make a difference"
        );
        for patch in [&initial, &divided, &refined, &unswapped] {
            let inner = patch.points.len() - patch.rim;
            assert_eq!(patch.triangles.len(), rim.len() - 2 + 2 * inner);
        }
    }
}
