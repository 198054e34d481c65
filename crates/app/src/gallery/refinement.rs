//! Figure 3: triangulation and refinement of a hole by the paper's listings, step by step.
//!
//! `incise-paper` provides the steps: its triangulation, its refinement with zero rounds and with
//! one, and for every new vertex the triangle that it split.

use super::boundary::PLANE;
use super::figure::{BODY, CAP, ColoredSurface, FigureError, Panel, Row, letter};
use super::slice::{Method, Slice, facts, is_cap, methods, side};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{Surface, Vec3};
use incise_models::{Model, build_model};
use incise_paper::{PaperError, PaperParams, Patch, fill, mean_rim_length, refine, triangulate};
use incise_refine::RefinementLevel;
use incise_render::Camera;

const MODEL: Model = Model::Sphere80;

/// Returns the steps of the paper's figure from the second on.
const STEPS: [&str; 4] = [
    "initial triangulation",
    "triangles divided once",
    "refined",
    "refined, no swaps before",
];

pub(super) fn refinement() -> Result<Vec<Row>, FigureError> {
    let surface = build_model(MODEL);
    let [x, y, z, _] = PLANE;
    let whole = ColoredSurface::new(surface.clone(), |_, _| Some(BODY));
    let camera = side(Vec3::new(x, y, z)).frame(whole.corners(), 1.0);
    let rows = methods(RefinementLevel::Original).map(|method| row(&surface, camera, method));
    rows.into_iter().collect()
}

fn row(surface: &Surface, camera: Camera, method: Method) -> Result<Row, FigureError> {
    let slice = Slice::new(surface, PLANE, method)?;
    let mut facts = facts(MODEL, method, &[PLANE]);
    let whole = ColoredSurface::new(surface.clone(), |_, _| Some(BODY));
    let label = "(a) before the cut".to_owned();
    let mut panels = vec![Panel::from_surfaces(
        label,
        camera,
        vec![whole],
        facts.clone(),
    )];
    facts.second_half_removed = true;
    let open = ColoredSurface::new(slice.surface.clone(), |surface, t| {
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
            let points: Vec<[f32; 3]> = patch.points.iter().map(|&p| to_f32(p)).collect();
            let patch = Surface::from_triangles(&points, &patch.triangles)?;
            shown.push(ColoredSurface::new(patch, |_, _| Some(CAP)));
        }
        let triangles: usize = patches.iter().map(|patch| patch.triangles.len()).sum();
        let label = format!("({}) {text}, {triangles}", letter(i + 1));
        panels.push(Panel::from_surfaces(label, camera, shown, facts.clone()));
    }
    if matches!(method, Method::Exact(_)) {
        let half = slice.half();
        let label = format!("(f) the method's own cap, {}", half.caps());
        panels.push(Panel::from_surfaces(label, camera, vec![half], facts));
    }
    Ok(Row {
        title: format!("{}, rim of {}", MODEL.name(), method.name()),
        panels,
    })
}

/// The patch of a rim after each step.
fn steps(rim: &[Vec3]) -> Result<[Patch; 4], PaperError> {
    let (alpha, normal) = (mean_rim_length(rim), newell(rim));
    let rounds = |max_rounds| PaperParams {
        max_rounds,
        ..PaperParams::default()
    };
    let free = |_, _| false;
    let initial = triangulate(rim, normal, &free);
    let mut swapped = initial.clone();
    refine(&mut swapped, normal, alpha, &rounds(0), &free)?;
    let mut once = initial.clone();
    refine(&mut once, normal, alpha, &rounds(1), &free)?;
    let divided = divided(swapped, &once);
    let refined = fill(rim, normal, &PaperParams::default(), free)?;
    // Swaps before the first round would only make edges between vertices of the rim, which are all
    // there are; where these count as joined there are none. After it the listing goes on as
    // always, beginning with the swaps of that round.
    let mut once = initial.clone();
    refine(&mut once, normal, alpha, &rounds(1), &|_, _| true)?;
    let mut unswapped = self::divided(initial.clone(), &once);
    refine(
        &mut unswapped,
        normal,
        alpha,
        &rounds(PaperParams::default().max_rounds - 1),
        &free,
    )?;
    Ok([initial, divided, refined, unswapped])
}

/// Largest distance between the centers of equal triangles \[m\]; a cut rounds points to 32 bits.
const SAME: f64 = 1e-5;

/// Returns true if a patch has these triangles.
fn has_made(patch: &Patch, caps: &[[Vec3; 3]]) -> bool {
    let center = |[a, b, c]: [Vec3; 3]| (a + b + c) / 3.0;
    let own = patch.triangles.iter();
    let own: Vec<Vec3> = own
        .map(|t| center(t.map(|v| patch.points[v as usize])))
        .collect();
    let is_own = |&cap: &[Vec3; 3]| own.iter().any(|p| (p - center(cap)).norm() < SAME);
    own.len() == caps.len() && caps.iter().all(is_own)
}

/// Rotates a rim to the start vertex of the cut, since ties are broken by order.
///
/// That is the start from which the whole refinement gives the cut's own caps. Caps of the exact
/// method have none, and their rim stays as it is.
fn as_the_cut_begins(mut rim: Vec<Vec3>, caps: &[[Vec3; 3]]) -> Result<Vec<Vec3>, PaperError> {
    for _ in 0..rim.len() {
        let patch = fill(&rim, newell(&rim), &PaperParams::default(), |_, _| false)?;
        if has_made(&patch, caps) {
            break;
        }
        rim.rotate_left(1);
    }
    Ok(rim)
}

/// Returns the normal of a loop, which need not be planar.
fn newell(rim: &[Vec3]) -> Vec3 {
    let ears = rim.windows(2).skip(1);
    ears.map(|pair| area_vector([rim[0], pair[0], pair[1]]))
        .sum()
}

/// Returns the patch after the centroid splits and before the edge swaps of a round that ends in
/// `after`.
fn divided(mut patch: Patch, after: &Patch) -> Patch {
    for (&corners, &center) in after.parents.iter().zip(&after.points[after.rim_len..]) {
        let Some(t) = patch.triangles.iter().position(|&t| t == corners) else {
            continue;
        };
        // A patch has 32-bit ids, so this is one.
        let Ok(v) = u32::try_from(patch.points.len()) else {
            continue;
        };
        let [a, b, c] = corners;
        patch.points.push(center);
        patch.parents.push(corners);
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
        let [paper, _] = methods(RefinementLevel::Original);
        let slice = Slice::new(&surface, PLANE, paper).unwrap();
        let rims = slice.rims();
        assert_eq!(rims.len(), 1);
        let rim = rims[0].iter().map(|&v| slice.surface.position(v)).collect();
        let rim = as_the_cut_begins(rim, &slice.caps()).unwrap();
        let [initial, divided, refined, unswapped] = steps(&rim).unwrap();
        assert_eq!(initial.triangles.len(), rim.len() - 2, "corners alone");
        assert!(has_made(&refined, &slice.caps()), "the cut's own cap");
        // All vertices that a round makes are there, each in place of one triangle by three, and no
        // swap has changed that.
        let mut once = initial.clone();
        let one = PaperParams {
            max_rounds: 1,
            ..PaperParams::default()
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
            let inner = patch.points.len() - patch.rim_len;
            assert_eq!(patch.triangles.len(), rim.len() - 2 + 2 * inner);
        }
    }
}
