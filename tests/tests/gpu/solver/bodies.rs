//! Many bodies on one GPU: they are independent, and only requested data is read back.

use incise_mesh::{HalfEdge, Surface, VertexId};
use incise_models::{Model, build_model};
use incise_pbd_gpu::{
    Contact, Context, GpuBackend, GpuBody, GpuError, Material, Schedule, Solver, SolverParams,
};
use incise_test_support::cpu_gpu_pair::{
    DT, SCHEDULES, assert_same, solver_for, with_most_features,
};
use incise_test_support::edits::split;
use incise_test_support::gpu::Needs;
use incise_test_support::surfaces::sphere;
use std::collections::BTreeSet;

/// Edits upload their changes, and requested data is read back.
pub(crate) fn transfers(context: Context) {
    super::deltas::uploaded_bytes(context.clone());
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    reads(&mut gpu);
    prefetched(&mut gpu);
    collected(&mut gpu);
    removed(&mut gpu);
}

/// Bodies are independent, runs and devices give the same bits, and momentum is conserved.
pub(crate) fn independent(context: Context) {
    together_as_alone(context.clone());
    for schedule in SCHEDULES {
        twice(context.clone(), schedule);
        momentum(context.clone(), schedule);
    }
}

/// A GPU body and its CPU copy.
struct Hosted {
    surface: Surface,
    solver: Solver,
    body: GpuBody,
}

impl Hosted {
    fn add(gpu: &mut GpuBackend, mut surface: Surface, schedule: Schedule) -> Self {
        let solver = solver_for(&mut surface, &with_most_features().0, schedule);
        Self::take_in(gpu, surface, solver, schedule)
    }

    fn take_in(
        gpu: &mut GpuBackend,
        surface: Surface,
        mut solver: Solver,
        schedule: Schedule,
    ) -> Self {
        gpu.force_schedule(Some(schedule));
        let body = gpu.add(&surface, &mut solver).expect("room");
        Self {
            surface,
            solver,
            body,
        }
    }

    fn stepped(&mut self) -> (GpuBody, &mut Solver) {
        (self.body, &mut self.solver)
    }

    fn step(&mut self, gpu: &mut GpuBackend) -> Result<(), GpuError> {
        gpu.step([self.stepped()], DT, &with_most_features().1)
            .map(|_| ())
    }

    fn read(&mut self, gpu: &mut GpuBackend) -> Result<(), GpuError> {
        gpu.read(self.body, &mut self.surface, &mut self.solver)
    }

    fn assert_same(&self, other: &Self, when: &str) {
        assert_same(
            (&self.surface, &self.solver),
            (&other.surface, &other.solver),
            when,
        );
    }
}

/// Backends on clones of one context, each stepped and read by a thread of its own.
pub(crate) fn on_threads(context: Context) {
    let run = |schedule| {
        let mut gpu = GpuBackend::from_context(context.clone()).expect("a device");
        let mut hosted = Hosted::add(&mut gpu, build_model(Model::Sphere80), schedule);
        let mut compiled = 0;
        for _ in 0..10 {
            hosted.step(&mut gpu).expect("a step");
            compiled += gpu.stats().kernels_compiled;
            hosted.read(&mut gpu).expect("a state");
        }
        let kernels: Vec<&str> = gpu.kernels().collect();
        (hosted, compiled, kernels)
    };
    let (mut compiled, mut kernels) = (0, BTreeSet::new());
    for schedule in SCHEDULES {
        let all = std::thread::scope(|scope| {
            let threads = [(); 3].map(|()| scope.spawn(|| run(schedule)));
            threads.map(|thread| thread.join().expect("it ends"))
        });
        let (alone, none, _) = run(schedule);
        assert_eq!(none, 0, "the threads have compiled all kernels");
        for (hosted, by_thread, used) in all {
            alone.assert_same(&hosted, "on another thread");
            compiled += by_thread as usize;
            kernels.extend(used);
        }
    }
    assert_eq!(compiled, kernels.len(), "each kernel is compiled once");
}

/// Bodies of all schedules and sizes in one submission, and each one's double by itself; some come,
/// go, or rest for a frame.
fn together_as_alone(context: Context) {
    let (_, params) = with_most_features();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut next = 0;
    let mut double = |gpu: &mut GpuBackend| {
        let schedule = SCHEDULES[next % 2];
        let model = [Model::Sphere20, Model::Sphere80, Model::Sphere768][next / 2 % 3];
        next += 1;
        let one = Hosted::add(gpu, build_model(model), schedule);
        let other = Hosted::add(gpu, build_model(model), schedule);
        (one, other)
    };
    let mut bodies: Vec<(Hosted, Hosted)> = (0..9).map(|_| double(&mut gpu)).collect();
    for frame in 0..8 {
        let rests = |i: usize| (i + frame).is_multiple_of(4);
        // Bodies with a contact have no lift, so they have another submission.
        for (i, (one, other)) in bodies.iter_mut().enumerate() {
            let topology = one.surface.topology();
            let far = topology.triangles().last().expect("a triangle");
            let contact = Contact::vertex_face(VertexId(0), topology.triangle(far), 0.01);
            let contacts = if (i + frame) % 3 == 0 {
                &[contact][..]
            } else {
                &[]
            };
            for hosted in [&mut *one, other] {
                (hosted.solver.set_contacts(contacts)).expect("vertices of the body");
            }
        }
        let all = (bodies.iter_mut().enumerate())
            .filter(|(i, _)| !rests(*i))
            .map(|(_, (one, _))| one.stepped());
        gpu.step(all, DT, &params).expect("a step");
        for (i, (one, other)) in bodies.iter_mut().enumerate() {
            if !rests(i) {
                other.step(&mut gpu).expect("a step");
            }
            for hosted in [&mut *one, other] {
                hosted.read(&mut gpu).expect("a state");
            }
            one.assert_same(other, &format!("of body {i} after frame {frame}"));
        }
        if frame % 2 == 1 {
            let (one, other) = bodies.remove(3);
            gpu.remove(one.body);
            gpu.remove(other.body);
            bodies.push(double(&mut gpu));
            bodies.swap(0, 5);
        }
    }
}

fn removed(gpu: &mut GpuBackend) {
    let mut first = Hosted::add(gpu, sphere(1, [0.0; 3]), Schedule::Patches);
    gpu.remove(first.body);
    gpu.remove(first.body);
    let mut second = Hosted::add(gpu, sphere(1, [0.0; 3]), Schedule::Patches);
    assert_ne!(first.body, second.body, "though it has the other's place");
    let unknown = GpuError::UnknownBody;
    assert_eq!(first.step(gpu), Err(unknown.clone()));
    assert_eq!(first.read(gpu), Err(unknown.clone()));
    let Hosted {
        surface,
        solver,
        body,
    } = &mut first;
    let results = [
        gpu.update(*body, surface, solver),
        gpu.bounds(*body).map(|_| ()),
        gpu.prefetch(*body),
        gpu.prefetch_bounds(*body),
        gpu.positions(*body).map(|_| ()),
        gpu.schedule(*body).map(|_| ()),
    ];
    for result in results {
        assert_eq!(result, Err(unknown.clone()));
    }
    second.step(gpu).expect("it is there");
    gpu.step([], DT, &SolverParams::paper())
        .expect("nobody steps");
    second.read(gpu).expect("it is there");
}

fn reads(gpu: &mut GpuBackend) {
    let mut bodies = SCHEDULES.map(|schedule| Hosted::add(gpu, sphere(2, [0.0; 3]), schedule));
    let vertices = bodies[0].surface.positions().len() as u64;
    let read_before = |gpu: &mut GpuBackend, bodies: &mut [Hosted; 2]| {
        let all = bodies.iter_mut().map(Hosted::stepped);
        gpu.step(all, DT, &with_most_features().1)
            .expect("a step")
            .bytes_read
    };
    for _ in 0..5 {
        assert_eq!(read_before(gpu, &mut bodies), 0);
    }
    for hosted in &bodies {
        gpu.bounds(hosted.body).expect("a box");
    }
    assert_eq!(read_before(gpu, &mut bodies), 2 * 44, "a report each");
    for hosted in &mut bodies {
        hosted.read(gpu).expect("a state");
    }
    // Position, velocity and displacement by constraints of a vertex, and the report.
    let state = 48 * vertices + 44;
    assert_eq!(read_before(gpu, &mut bodies), 2 * state);
    assert_eq!(read_before(gpu, &mut bodies), 0, "nobody reads again");
    // A requested state that was not read back does not count.
    gpu.prefetch(bodies[0].body).expect("it is there");
    for _ in 0..2 {
        assert_eq!(read_before(gpu, &mut bodies), 0);
    }
}

fn prefetched(gpu: &mut GpuBackend) {
    for schedule in SCHEDULES {
        let surface = sphere(2, [0.0; 3]);
        let mut asked = Hosted::add(gpu, surface.clone(), schedule);
        let mut other = Hosted::add(gpu, surface, schedule);
        for frame in 0..3 {
            gpu.prefetch(asked.body).expect("it is there");
            gpu.prefetch_bounds(asked.body).expect("it is there");
            if frame == 1 {
                // This one is found apart and takes nothing away from the step.
                gpu.bounds(asked.body).expect("a box");
            }
            for hosted in [&mut asked, &mut other] {
                hosted.step(gpu).expect("a step");
            }
            let boxes = [&asked, &other].map(|h| gpu.bounds(h.body).expect("a box"));
            // Velocities that are set on the CPU while the copy is pending are kept.
            let v = VertexId(frame);
            for hosted in [&mut asked, &mut other] {
                hosted.solver.set_velocity(v, [1.0; 3]).expect("a vertex");
                hosted.read(gpu).expect("a state");
                assert_eq!(hosted.solver.velocity(v), [1.0; 3]);
            }
            asked.assert_same(&other, &format!("in frame {frame}"));
            for found in boxes {
                let wanted = asked.surface.bounds();
                assert_eq!((found.min, found.max), (wanted.min, wanted.max));
            }
        }
        gpu.remove(asked.body);
        gpu.remove(other.body);
    }
}

fn collected(gpu: &mut GpuBackend) {
    let [kicked, pinned] = [1, 7].map(VertexId);
    let [mut asked, mut other] =
        [0, 1].map(|_| Hosted::add(gpu, sphere(1, [0.0; 3]), Schedule::Patches));
    for Hosted {
        surface, solver, ..
    } in [&mut asked, &mut other]
    {
        solver.pin(surface, pinned).expect("a vertex");
    }
    gpu.prefetch(asked.body).expect("it is there");
    for hosted in [&mut asked, &mut other] {
        hosted.step(gpu).expect("a step");
        let to = [1.0, 2.0, 3.0];
        hosted.solver.set_velocity(kicked, to).expect("a vertex");
        hosted.solver.set_pin_target(pinned, to).expect("pinned");
    }
    gpu.wait().expect("it ends");
    let Hosted {
        surface,
        solver,
        body,
    } = &mut asked;
    let before = surface.positions().to_vec();
    let wrong = gpu.collect(*body, surface, &mut other.solver);
    assert_eq!(wrong, Err(GpuError::ForeignSolver));
    assert_eq!(surface.positions(), before);
    // A pin that is dragged in every frame keeps nothing away.
    assert_eq!(gpu.collect(*body, surface, solver), Ok(true));
    assert_ne!(surface.positions(), before);
    for hosted in [&mut asked, &mut other] {
        hosted.step(gpu).expect("a step");
        hosted.read(gpu).expect("a state");
    }
    asked.assert_same(&other, "after a state that came by the way");
    // A vertex that was put elsewhere stays there.
    gpu.prefetch(asked.body).expect("it is there");
    asked.step(gpu).expect("a step");
    gpu.wait().expect("it ends");
    asked.surface.positions_mut()[0][0] = 7.0;
    asked.solver.mark_all_changed();
    let late = gpu.collect(asked.body, &mut asked.surface, &mut asked.solver);
    assert_eq!(late, Err(GpuError::StaleBody));
    assert_eq!(asked.surface.positions()[0][0], 7.0);
}

fn twice(context: Context, schedule: Schedule) {
    let run = |gpu: &mut GpuBackend| {
        let mut hosted = Hosted::add(gpu, build_model(Model::Sphere768), schedule);
        for frame in 0..12 {
            hosted.step(gpu).expect("a step");
            if frame % 4 == 3 {
                hosted.read(gpu).expect("a state");
                let h = HalfEdge(7 * frame);
                let delta = split(&mut hosted.surface, h, 0.5).expect("it is closed");
                let Hosted {
                    surface,
                    solver,
                    body,
                } = &mut hosted;
                solver.apply_delta(surface, &delta).expect("it fits");
                gpu.update(*body, surface, solver).expect("room");
            }
        }
        hosted.read(gpu).expect("a state");
        hosted
    };
    let other = Context::open(&Needs::AnyDevice.request()).expect("it opens twice");
    let runs = [context, other].map(|context| {
        let mut gpu = GpuBackend::from_context(context).expect("a device");
        [run(&mut gpu), run(&mut gpu)]
    });
    let [[first, second], [third, _]] = runs;
    first.assert_same(&second, "in a second run");
    first.assert_same(&third, "on a device opened anew");
}

/// A spinning, compressed body keeps its momentum.
///
/// The tolerance is relative to the total mass times the highest speed.
fn momentum(context: Context, schedule: Schedule) {
    let params = SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::paper()
    };
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = solver_for(&mut surface, &Material::default(), schedule);
    solver.set_colliders(&[]).expect("no collider");
    for p in surface.positions_mut() {
        p[1] *= 0.7;
    }
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    let mut hosted = Hosted::take_in(&mut gpu, surface, solver, schedule);
    let mut fastest = 0.0_f64;
    for v in hosted.surface.topology().vertices() {
        let [x, y, z, _] = hosted.surface.positions()[v.index()];
        let velocity = [1.0 + 2.0 * z, 0.5 * y, -2.0 * x];
        let square: f32 = velocity.iter().map(|c| c * c).sum();
        fastest = fastest.max(f64::from(square).sqrt());
        hosted.solver.set_velocity(v, velocity).expect("a vertex");
    }
    let before = hosted.solver.momentum();
    for _ in 0..30 {
        gpu.step([hosted.stepped()], DT, &params).expect("a step");
    }
    hosted.read(&mut gpu).expect("a state");
    let off = (hosted.solver.momentum().iter())
        .zip(before)
        .map(|(now, then)| (now - then).abs())
        .fold(0.0, f64::max);
    let unit = f64::from(f32::EPSILON) * hosted.solver.total_mass() * fastest;
    assert!(off <= 8.0 * unit, "{} roundings in 30 frames", off / unit);
    let moved = hosted.surface.bounds();
    assert!(moved.min[0] > -0.9, "it has gone its way: {moved:?}");
}
