//! Invariants of patches on whole bodies.

use crate::constraints::batches::{ConstraintSet, Slot};
use crate::constraints::coloring::LAYERS;
use crate::patches::PatchParams;
use crate::patches::content::{PatchBatch, PatchContents};
use crate::{Collider, ConstraintError, Material, Solver, SolverParams};
use incise_mesh::icosphere;
use incise_mesh::{HalfEdge, Surface, TriangleId, VertexId};
use incise_models::double_cone;
use incise_models::{Model, build_model};
use incise_test_support::edits::{flip, replace_vertex, split};
use incise_test_support::surfaces::sphere;
use proptest::prelude::*;

/// Constraints in each layer.
fn layer_sizes<const N: usize>(set: &ConstraintSet<N>) -> [usize; LAYERS] {
    let mut sizes = [0; LAYERS];
    for (color, batch) in set.numbered() {
        sizes[Slot { color, index: 0 }.layer()] += batch.len();
    }
    sizes
}

fn put_on_ground(solver: &mut Solver) {
    let ground = [Collider::ground(-0.6).into()];
    solver.set_colliders(&ground).unwrap();
}

fn in_patches(surface: &mut Surface, params: &PatchParams) -> Solver {
    let mut solver = Solver::with_patches(surface, &Material::default(), Some(params)).unwrap();
    put_on_ground(&mut solver);
    solver
}

/// Constraints of a patch by color, sorted within a color, rest values as bits.
type Colors<const N: usize> = Vec<Vec<([VertexId; N], u32)>>;

fn colors<const N: usize>(batch: &PatchBatch<N>) -> Colors<N> {
    let mut start = 0;
    let color = |&end: &usize| {
        let all = batch.vertices[start..end]
            .iter()
            .zip(&batch.rest[start..end]);
        let mut color: Vec<_> = all.map(|(&v, rest)| (v, rest.to_bits())).collect();
        color.sort_unstable();
        start = end;
        color
    };
    batch.color_ends.iter().map(color).collect()
}

/// Returns the constraints of all patches after an update of `contents`.
fn updated(solver: &Solver, contents: &mut PatchContents) -> Vec<(Colors<2>, Colors<4>)> {
    let patches = solver.constraints().patches.as_ref().unwrap();
    contents.update(patches, solver.stretch(), solver.bending());
    let all = (1..LAYERS).flat_map(|layer| contents.of_layer(layer));
    all.map(|patch| (colors(&patch.stretch), colors(&patch.bending)))
        .collect()
}

fn rebuilt(solver: &Solver) -> Vec<(Colors<2>, Colors<4>)> {
    updated(solver, &mut PatchContents::default())
}

#[test]
fn patches_have_the_constraints_of_their_layer() {
    let solver = in_patches(&mut icosphere(3, 0.5), &small_patches());
    let (mut stretch, mut bending) = (0, 0);
    for (edges, hinges) in rebuilt(&solver) {
        stretch += edges.concat().len();
        bending += hinges.concat().len();
    }
    let [in_stretch, in_bending] = [
        layer_sizes(solver.stretch()),
        layer_sizes(solver.bending().unwrap()),
    ];
    assert_eq!(stretch, in_stretch[1..].iter().sum::<usize>());
    assert_eq!(bending, in_bending[1..].iter().sum::<usize>());
}

fn small_patches() -> PatchParams {
    PatchParams {
        vertices: 24,
        room: 4,
    }
}

#[test]
fn a_body_in_one_patch_moves_as_without() {
    let mut plain = icosphere(2, 0.5);
    let mut patched = plain.clone();
    let mut solver = Solver::new(&mut plain, &Material::default()).unwrap();
    let mut other = in_patches(&mut patched, &PatchParams::default());
    let [stretch, bending] = [
        layer_sizes(other.stretch()),
        layer_sizes(other.bending().unwrap()),
    ];
    assert_eq!((stretch, bending), ([0, 480, 0, 0], [0, 480, 0, 0]));
    put_on_ground(&mut solver);
    for _ in 0..60 {
        solver
            .step(&mut plain, 1.0 / 60.0, &SolverParams::paper())
            .unwrap();
        other
            .step(&mut patched, 1.0 / 60.0, &SolverParams::paper())
            .unwrap();
    }
    assert_eq!(
        plain.positions(),
        patched.positions(),
        "the order is the same"
    );
}

#[test]
fn next_to_nothing_is_left_to_the_whole_body() {
    for surface in [build_model(Model::Banana), icosphere(5, 0.5)] {
        let solver = in_patches(&mut surface.clone(), &PatchParams::default());
        let stretch = layer_sizes(solver.stretch());
        let bending = layer_sizes(solver.bending().unwrap());
        assert_eq!((stretch[0], bending[0]), (0, 0), "{stretch:?} {bending:?}");
        let all: usize = stretch.iter().chain(&bending).sum();
        let first = stretch[1] + bending[1];
        assert!(
            first * 10 > all * 8,
            "{first} of {all} lie within the first patches"
        );
    }
}

#[test]
fn patches_follow_a_body_that_overflows() {
    // A vertex with more edges than a layer has colors: constraints without a color go to layer 0.
    let mut surface = double_cone(150);
    let mut solver = in_patches(&mut surface, &PatchParams::default());
    solver.validate(&surface).unwrap();
    let stretch = layer_sizes(solver.stretch());
    assert_eq!(stretch, [150 - 64 + 150 - 64, 450 - 172, 0, 0]);
    assert_eq!(solver.stretch().overflow().len(), 2 * (150 - 128));
    for _ in 0..60 {
        solver
            .step(&mut surface, 1.0 / 60.0, &SolverParams::paper())
            .unwrap();
    }
    assert!(solver.stretch_error(&surface) < 0.05);
    let delta = replace_vertex(&mut surface, VertexId(0)).unwrap();
    solver.apply_delta(&mut surface, &delta).unwrap();
    solver.validate(&surface).unwrap();
}

#[test]
fn another_order_converges_as_well() {
    for model in [Model::Octopus, Model::Banana] {
        let mut plain = build_model(model);
        let mut patched = plain.clone();
        let mut solver = Solver::new(&mut plain, &Material::default()).unwrap();
        put_on_ground(&mut solver);
        let mut other = in_patches(&mut patched, &PatchParams::default());
        let (mut error, mut other_error) = (0.0, 0.0);
        for _ in 0..60 {
            solver
                .step(&mut plain, 1.0 / 60.0, &SolverParams::paper())
                .unwrap();
            other
                .step(&mut patched, 1.0 / 60.0, &SolverParams::paper())
                .unwrap();
            error += solver.stretch_error(&plain) / 60.0;
            other_error += other.stretch_error(&patched) / 60.0;
        }
        assert!(
            other_error < 1.06 * error,
            "{}: {other_error} with patches, {error} without",
            model.name()
        );
    }
}

#[test]
fn patches_without_a_place_are_refused() {
    for (vertices, room) in [(7, 0), (257, 0), (64, 64)] {
        let refused = Solver::with_patches(
            &mut icosphere(1, 0.5),
            &Material::default(),
            Some(&PatchParams { vertices, room }),
        );
        let error = ConstraintError::BadPatches { vertices, room };
        assert_eq!(refused.err(), Some(error));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn patches_follow_edits(
        edits in prop::collection::vec((0_u8..3, any::<u16>(), 0.1_f32..0.9), 1..60),
    ) {
        let mut surface = sphere(3, [0.0; 3]);
        let mut solver = in_patches(&mut surface, &small_patches());
        let mass = solver.total_mass();
        let mut contents = PatchContents::default();
        for (kind, at, t) in edits {
            let topology = surface.topology();
            let half_edges: Vec<HalfEdge> =
                topology.triangles().flat_map(TriangleId::half_edges).collect();
            // Within one part of the body, so that its patches fill up.
            let h = half_edges[usize::from(at) % (half_edges.len() / 8)];
            let v = topology.origin(h);
            let delta = match kind {
                0 => flip(&mut surface, h),
                1 => split(&mut surface, h, t),
                _ => replace_vertex(&mut surface, v),
            };
            if let Some(delta) = delta {
                solver.apply_delta(&mut surface, &delta).unwrap();
                prop_assert_eq!(solver.validate(&surface), Ok(()));
                prop_assert_eq!(&updated(&solver, &mut contents), &rebuilt(&solver));
            }
        }
        prop_assert!((solver.total_mass() / mass - 1.0).abs() < 1e-6);
        solver.step(&mut surface, 1.0 / 60.0, &SolverParams::paper()).unwrap();
    }
}
