//! Uploads of edits equal a full upload, and their size is that of the changed data.

use incise_mesh::{HalfEdge, Surface, TopologyDelta, TriangleId, VertexId, icosphere};
use incise_pbd_gpu::{Context, GpuBackend, Material, PatchParams, Schedule, Solver, SolverParams};
use incise_test_support::cpu_gpu_pair::{
    CpuGpuPair, DT, SCHEDULES, assert_same, with_attachments, with_most_features,
};
use incise_test_support::edits::{
    flip, remove_vertex, replace_vertex, replace_with_undo, split, vertex_replacement,
};
use incise_test_support::random::Random;
use incise_test_support::surfaces::sphere;
use std::cell::{Cell, RefCell};

/// Random edits equal a full upload, undone edits restore pins, and many edits leak no memory.
pub(crate) fn to_the_bit(context: Context) {
    for schedule in SCHEDULES {
        for (material, params) in [with_most_features(), with_attachments()] {
            edited_equals_uploaded(context.clone(), schedule, &material, &params);
        }
        undo_restores_pins(context.clone(), schedule);
        hundreds_of_deltas(context.clone(), schedule);
    }
}

/// An edit uploads what it changed, however large the body is.
pub(super) fn uploaded_bytes(context: Context) {
    for patches in [None, Some(PatchParams::default())] {
        an_edit_uploads_its_changes(context.clone(), patches.as_ref());
    }
}

/// Parameters of a random edit.
#[derive(Debug, Clone, Copy)]
struct Throw {
    kind: usize,
    at: usize,
    t: f32,
}

impl Throw {
    fn new(dice: &mut Random) -> Self {
        Self {
            kind: dice.below(10),
            at: dice.below(1 << 30),
            t: dice.fraction(),
        }
    }
}

/// Changes the topology, if the edit that was thrown is possible there. Bodies keep between 80 and
/// 240 triangles.
fn cut(surface: &mut Surface, throw: Throw) -> Option<TopologyDelta> {
    let Throw { kind, at, t } = throw;
    let topology = surface.topology();
    let half_edges: Vec<HalfEdge> = (topology.triangles())
        .flat_map(TriangleId::half_edges)
        .collect();
    let h = half_edges[at % half_edges.len()];
    let v = topology.origin(h);
    let triangles = half_edges.len() / 3;
    match kind {
        0..=2 => flip(surface, h),
        3..=5 if triangles < 240 => split(surface, h, t),
        6 | 7 if triangles > 80 => remove_vertex(surface, v),
        _ => replace_vertex(surface, v),
    }
}

/// Cuts both bodies; returns whether that was possible.
fn cut_both(twin: &mut CpuGpuPair, throw: Throw) -> bool {
    twin.edit(|surface, solver| {
        let delta = cut(surface, throw);
        if let Some(delta) = &delta {
            solver.apply_delta(surface, delta).expect("it fits");
        }
        delta.is_some()
    })
}

/// Applies one kind of edit to both bodies.
fn edit_both(twin: &mut CpuGpuPair, dice: &mut Random) {
    let throw = Throw::new(dice);
    let vertices: Vec<VertexId> = twin.on_cpu.topology().vertices().collect();
    let v = vertices[dice.below(vertices.len())];
    let to = [dice.fraction(), -dice.fraction(), dice.fraction()];
    match dice.below(8) {
        0 => twin.edit(|surface, solver| solver.pin(surface, v).expect("a vertex")),
        1 => twin.edit(|_, solver| solver.set_velocity(v, to).expect("a vertex")),
        2 | 3 => twin.edit(|surface, solver| {
            let pinned = solver.pins().first().map(|pin| pin.vertex);
            if let Some(v) = pinned {
                solver.unpin(surface, v).expect("it is pinned");
            }
        }),
        4 => twin.edit(|surface, solver| {
            let p = &mut surface.positions_mut()[v.index()];
            *p = [p[0] + 0.1 * to[0], p[1] + 0.1, p[2], p[3]];
            solver.mark_all_changed();
        }),
        _ => {
            cut_both(twin, throw);
        }
    }
}

fn edited_equals_uploaded(
    context: Context,
    schedule: Schedule,
    material: &Material,
    params: &SolverParams,
) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut dice = Random::new(1);
    let mut twin = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), material, schedule);
    let mut pulled = 0;
    for round in 0..30 {
        // A long frame, then short ones.
        let dt = DT * [1.0, 0.2, 0.35, 0.1][round % 4];
        // Now and then without attachments, where there were some.
        let params = SolverParams {
            attachments: params.attachments && round % 5 != 0,
            ..*params
        };
        for _ in 0..=dice.below(4) {
            edit_both(&mut twin, &mut dice);
        }
        // Some edits are uploaded together with later ones.
        if dice.below(3) == 0 {
            twin.update(&mut gpu);
            edit_both(&mut twin, &mut dice);
        }
        twin.update(&mut gpu);
        let mut others: Vec<_> = SCHEDULES
            .into_iter()
            .map(|schedule| {
                let (surface, mut solver) = (twin.on_gpu.clone(), twin.solver.clone());
                gpu.force_schedule(Some(schedule));
                let body = gpu.add(&surface, &mut solver).expect("room");
                assert_eq!(gpu.schedule(body), Ok(schedule));
                (body, surface, solver)
            })
            .collect();
        gpu.force_schedule(Some(schedule));
        twin.cpu
            .step(&mut twin.on_cpu, dt, &params)
            .expect("a step");
        let all = (others.iter_mut())
            .map(|(body, _, solver)| (*body, solver))
            .chain([(twin.body, &mut twin.solver)]);
        gpu.step(all, dt, &params).expect("a step");
        let when = format!("in round {round}");
        twin.assert_equal(&mut gpu, &when);
        pulled += twin.solver.attachments().len();
        for (body, surface, solver) in &mut others {
            gpu.read(*body, surface, solver).expect("a state");
            assert_same((surface, solver), (&twin.on_gpu, &twin.solver), &when);
            gpu.remove(*body);
        }
    }
    assert_eq!(gpu.schedule(twin.body), Ok(schedule));
    assert_eq!(
        pulled > 0,
        params.attachments,
        "what was compared had attachments"
    );
}

fn hundreds_of_deltas(context: Context, schedule: Schedule) {
    const DELTAS: usize = 500;
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut dice = Random::new(2);
    let mut twin = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), &material, schedule);
    let at_first = gpu.memory();
    let mut done = 0;
    while done < DELTAS {
        if !cut_both(&mut twin, Throw::new(&mut dice)) {
            continue;
        }
        twin.update(&mut gpu);
        done += 1;
        if done.is_multiple_of(50) {
            twin.step(&mut gpu, &params);
            twin.assert_equal(&mut gpu, &format!("after {done} deltas"));
        }
    }
    twin.solver
        .validate(&twin.on_gpu)
        .expect("valid constraints");
    let edited = gpu.memory();
    gpu.remove(twin.body);
    assert_eq!(gpu.memory().rented, 0, "what edits rent they give back");
    twin.solver.mark_all_changed();
    gpu.add(&twin.on_gpu, &mut twin.solver).expect("room");
    let fresh = gpu.memory();
    assert!(edited.rented <= 2 * fresh.rented, "{edited:?} {fresh:?}");
    assert_eq!(edited.reserved, at_first.reserved, "the first buffers do");
}

/// A body hangs by four vertices, two of which an edit takes away and its undo brings back: it
/// hangs by four again.
fn undo_restores_pins(context: Context, schedule: Schedule) {
    let (material, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut twin = CpuGpuPair::add(&mut gpu, sphere(2, [0.0; 3]), &material, schedule);
    let held = [3, 20, 41, 60].map(VertexId);
    twin.edit(|surface, solver| held.map(|v| solver.pin(surface, v).expect("a vertex")));
    let pinned =
        |solver: &Solver| -> Vec<VertexId> { solver.pins().iter().map(|pin| pin.vertex).collect() };
    let targets = twin.solver.pins().to_vec();
    for round in 0..3 {
        let undos = RefCell::new(Vec::new());
        let mut steps = |twin: &mut CpuGpuPair, when: &str| {
            twin.update(&mut gpu);
            for _ in 0..2 {
                twin.step(&mut gpu, &params);
            }
            twin.assert_equal(&mut gpu, &format!("{when} in round {round}"));
        };
        for v in [held[1], held[3]] {
            twin.edit(|surface, solver| {
                let (remove, addition) = vertex_replacement(surface, v).expect("it is closed");
                let (delta, undo) = replace_with_undo(surface, &remove, &addition);
                solver.apply_delta(surface, &delta).expect("it fits");
                undos.borrow_mut().push(undo);
            });
        }
        steps(&mut twin, "without two");
        assert_eq!(pinned(&twin.solver), [held[0], held[2]]);
        // One for each body: those of the second edit are the last two.
        for pair in [[2, 3], [0, 1]] {
            let undos = undos.borrow();
            let turn = Cell::new(0);
            twin.edit(|surface, solver| {
                let undo = undos[pair[turn.replace(1)]].clone();
                let back = undo.revert(surface).expect("it is the last");
                solver.apply_delta(surface, &back).expect("it fits");
            });
        }
        steps(&mut twin, "with all");
        assert_eq!(twin.solver.pins(), targets, "all are held where they were");
        for pin in &targets {
            let [x, y, z, inverse] = twin.on_gpu.positions()[pin.vertex.index()];
            assert_eq!(inverse, 0.0, "{} is held on the device", pin.vertex);
            let off = [x, y, z].map(f64::from);
            let off = (0..3).map(|k| (off[k] - f64::from(pin.target[k])).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6, "{} is off", pin.vertex);
        }
    }
}

/// Bytes that were sent, with those of the program that the step after an edit sends anew.
#[derive(Debug)]
struct Sent {
    /// By taking the body in.
    added: u64,
    /// By a split.
    split: u64,
    /// By a hundred splits one after the other.
    hundred: u64,
}

fn sent(gpu: &mut GpuBackend, mut surface: Surface, patches: Option<&PatchParams>) -> Sent {
    let params = SolverParams {
        iterations: 1,
        ..SolverParams::paper()
    };
    let material = Material::default();
    let mut solver =
        Solver::with_patches(&mut surface, &material, patches).expect("a valid sphere");
    gpu.force_schedule(Some(Schedule::Patches));
    let body = gpu.add(&surface, &mut solver).expect("room");
    let mut dice = Random::new(4);
    let mut sent = |gpu: &mut GpuBackend, splits: usize| {
        gpu.read(body, &mut surface, &mut solver).expect("a state");
        for _ in 0..splits {
            let count = surface.topology().triangle_slots();
            let [h, ..] = TriangleId::from_index(dice.below(count)).half_edges();
            let delta = split(&mut surface, h, 0.5).expect("it is closed");
            solver.apply_delta(&mut surface, &delta).expect("it fits");
            gpu.update(body, &surface, &mut solver).expect("room");
        }
        let stats = gpu
            .step([(body, &mut solver)], DT, &params)
            .expect("a step");
        stats.bytes_uploaded
    };
    let added = sent(gpu, 0);
    assert_eq!(sent(gpu, 0), 0, "nothing was edited");
    let sent = Sent {
        added,
        split: sent(gpu, 1),
        hundred: sent(gpu, 100),
    };
    gpu.remove(body);
    sent
}

/// Uploads the slots that a split changes and the list of dispatches, forward and back.
///
/// The length of that list does not depend on the body. With patches, the upload has the block of
/// every patch whose constraints change, mostly one or two. The block of a patch of 256 vertices
/// has about 30 KB.
fn an_edit_uploads_its_changes(context: Context, patches: Option<&PatchParams>) {
    let most = if patches.is_some() { 60_000 } else { 24_000 };
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let small = sent(&mut gpu, icosphere(4, 0.5), patches);
    let large = sent(&mut gpu, icosphere(5, 0.5), patches);
    for (sent, triangles) in [(&small, 5120), (&large, 20_480)] {
        // 1.5 edges a triangle, 16 bytes of stretch and 24 of bending each, and half a vertex of
        // 32.
        assert!(sent.added > triangles * 76, "{sent:?}");
        assert!(sent.split < most, "{sent:?}");
        assert!(sent.hundred < 100 * most, "{sent:?}");
    }
    let sum = |sent: &Sent| sent.split + sent.hundred;
    assert!(
        4 * sum(&large) < 5 * sum(&small),
        "four times the body, as many edits: {small:?} {large:?}"
    );
}
