//! The stress tests on a GPU, and motions that are compared with those of the CPU.

use crate::runner::{Body, FRAME, Runner, ball, largest_offset};
use incise_mesh::{HalfEdge, Surface};
use incise_pbd_gpu::{Context, GpuBackend, Material, PatchParams, Schedule, Solver};
use incise_test_support::edits::split;
use incise_test_support::gpu::{Needs, trial};
use incise_test_support::materials::elastic_shell;
use incise_test_support::params::{GROUND, HANGING};
use libtest_mimic::Trial;

/// Largest distance from the CPU's positions \[m\].
const MAX_OFFSET: f64 = 1e-4;

pub(crate) fn trials() -> Vec<Trial> {
    let any = Needs::AnyDevice;
    let cases = crate::cases().map(|(name, case)| {
        trial(&format!("{name} on a GPU"), any, move |context| {
            let mut gpu = GpuBackend::from_context(context).expect("a device");
            case(&mut Runner {
                advance: &mut |surface, solver, dt, params, frames| {
                    solver.mark_all_changed();
                    let body = gpu.add(surface, solver).expect("room");
                    for _ in 0..frames {
                        let stepped = gpu.step([(body, &mut *solver)], dt, params);
                        stepped.expect("a step");
                    }
                    gpu.read(body, surface, solver).expect("a state");
                    gpu.remove(body);
                },
                is_gpu: true,
            });
        })
    });
    let mut all: Vec<Trial> = cases.collect();
    all.extend([
        trial("every_schedule_moves_as_the_cpu", any, |context| {
            every_schedule(&mut GpuBackend::from_context(context).expect("a device"));
        }),
        trial("portable_limits_change_no_motion", any, |_| {
            every_schedule(&mut GpuBackend::from_context(portable()).expect("a device"));
        }),
        trial("edits_outgrow_buffers", any, |context| {
            outgrow(context, Schedule::Colors)
        }),
        trial("edits_outgrow_buffers_of_patches", any, |context| {
            outgrow(context, Schedule::Patches);
        }),
        trial("edits_outgrow_buffers_of_portable_limits", any, |_| {
            outgrow(portable(), Schedule::Colors);
        }),
    ]);
    all
}

/// Returns the same adapter with the default limits of WebGPU.
fn portable() -> Context {
    Context::open(&Needs::AnyDevice.portable_request()).expect("it was there before")
}

fn solver_for(surface: &mut Surface, material: &Material, schedule: Schedule) -> Solver {
    let patches = (schedule == Schedule::Patches).then(PatchParams::default);
    Solver::with_patches(surface, material, patches.as_ref()).expect("a body that can be simulated")
}

/// A body that turns, so that every vertex has a velocity of its own.
fn turning(surface: Surface, material: &Material, schedule: Schedule) -> Body {
    let mut surface = surface;
    let mut solver = solver_for(&mut surface, material, schedule);
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        let to = [z, -0.25 * y, -x];
        solver.set_velocity(v, to).expect("a vertex");
    }
    Body { surface, solver }
}

fn every_schedule(gpu: &mut GpuBackend) {
    let materials = [elastic_shell(1e-4, 1e-1), Material::default()];
    // Bodies that fit into a workgroup's memory and one that does not.
    for (subdivisions, material) in [1, 2, 4]
        .into_iter()
        .flat_map(|n| materials.map(|m| (n, m)))
    {
        for schedule in [Schedule::WholeBody, Schedule::Colors, Schedule::Patches] {
            let mut there = turning(ball(subdivisions, 0.6), &material, schedule);
            let mut here = there.clone();
            gpu.force_schedule(Some(schedule));
            let body = gpu.add(&there.surface, &mut there.solver).expect("room");
            for _ in 0..30 {
                let stepped = gpu.step([(body, &mut there.solver)], FRAME, &HANGING);
                stepped.expect("a step");
                (here.solver.step(&mut here.surface, FRAME, &HANGING)).expect("a step");
            }
            let read = gpu.read(body, &mut there.surface, &mut there.solver);
            read.expect("a state");
            gpu.remove(body);
            let offset = largest_offset(here.surface.positions(), there.surface.positions());
            assert!(
                offset <= MAX_OFFSET,
                "{offset} m, {subdivisions} subdivisions by {}",
                schedule.name()
            );
        }
    }
}

/// Splits edges until the backend has replaced its buffers by larger ones twice.
fn outgrow(context: Context, schedule: Schedule) {
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    // Its vertices with their slack just fit the first buffers.
    let mut there = turning(ball(4, 0.6), &elastic_shell(1e-4, 1e-1), schedule);
    let body = gpu.add(&there.surface, &mut there.solver).expect("room");
    let first = gpu.memory().reserved;
    let (mut has_grown, mut next) = (false, 0);
    for _ in 0..100 {
        for _ in 0..50 {
            let delta = split(&mut there.surface, HalfEdge(next), 0.5).expect("it is closed");
            (there.solver.apply_delta(&mut there.surface, &delta)).expect("it fits");
            next = (next + 211) % 15_000;
        }
        gpu.update(body, &there.surface, &mut there.solver)
            .expect("room");
        // Starts from the state of the GPU, since rounding grows at hinges near half a turn.
        let mut here = there.clone();
        let stepped = gpu.step([(body, &mut there.solver)], FRAME, &GROUND);
        stepped.expect("a step");
        let read = gpu.read(body, &mut there.surface, &mut there.solver);
        read.expect("a state");
        (here.solver.step(&mut here.surface, FRAME, &GROUND)).expect("a step");
        let offset = largest_offset(here.surface.positions(), there.surface.positions());
        assert!(offset <= MAX_OFFSET, "{offset} m after an edit");
        if has_grown {
            return;
        }
        has_grown = gpu.memory().reserved > first;
    }
    panic!("the first buffers had room for all edits");
}
