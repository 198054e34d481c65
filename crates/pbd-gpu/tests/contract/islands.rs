//! Bodies of an island are stepped in lockstep and share contacts.

use incise_mesh::{Surface, VertexId};
use incise_pbd_gpu::{
    Collider, ConstraintError, Contact, Integrator, Island, IslandError, Material, Solver,
    SolverParams, StepError, Volume,
};
use incise_test_support::surfaces::sphere;

const DT: f32 = 1.0 / 60.0;

struct Bodies(Vec<(Surface, Solver)>);

impl Bodies {
    /// Steps all bodies as an island.
    fn step(&mut self, island: &mut Island, params: &SolverParams) -> Result<(), IslandError> {
        let bodies = self.0.iter_mut().map(|(surface, solver)| (solver, surface));
        island.step(&mut bodies.collect::<Vec<_>>(), DT, params)
    }
}

/// Two balls of 1 m on top of each other, of different resolution and material.
fn balls() -> Bodies {
    let soft = Material {
        volume: Some(Volume::default()),
        bending: None,
        ..Material::default()
    };
    let body = |level, y, material: &Material| {
        let mut surface = sphere(level, [0.0, y, 0.0]);
        let solver = Solver::new(&mut surface, material).unwrap();
        (surface, solver)
    };
    Bodies(vec![
        body(2, 0.0, &Material::default()),
        body(1, 2.5, &soft),
    ])
}

fn bits((surface, solver): &(Surface, Solver)) -> Vec<[u32; 4]> {
    let all = surface.positions().iter().chain(solver.velocities());
    all.map(|p| p.map(f32::to_bits)).collect()
}

#[test]
fn bodies_without_contacts_move_as_alone() {
    for integrator in [Integrator::Euler, Integrator::Bdf2] {
        let params = SolverParams {
            integrator,
            ..SolverParams::default()
        };
        let (mut together, mut alone) = (balls(), balls());
        for (_, solver) in together.0.iter_mut().chain(&mut alone.0) {
            solver
                .set_colliders(&[Collider::ground(-1.1).into()])
                .unwrap();
        }
        let mut island = Island::default();
        for _ in 0..30 {
            together.step(&mut island, &params).unwrap();
            for (surface, solver) in &mut alone.0 {
                solver.step(surface, DT, &params).unwrap();
            }
        }
        for (i, (a, b)) in together.0.iter().zip(&alone.0).enumerate() {
            assert!(bits(a) == bits(b), "body {i} with {integrator:?}");
            assert_eq!(a.1.stats(), b.1.stats(), "statistics of body {i}");
        }
    }
}

#[test]
fn contacts_of_other_bodies_are_refused() {
    let (mut island, mut bodies) = (Island::default(), balls());
    let contact = Contact::vertex_face(VertexId(900), [0, 1, 2].map(VertexId), 0.1);
    island.set_contacts(&[contact], 1000).unwrap();
    let before: Vec<_> = bodies.0.iter().map(bits).collect();
    let refused = bodies.step(&mut island, &SolverParams::default());
    let error = refused.unwrap_err().error;
    let slots = before.iter().map(|body| body.len() / 2).sum();
    let expected = StepError::ContactMismatch {
        contacts: 1000,
        bodies: slots,
    };
    assert_eq!(error, expected);
    let after: Vec<_> = bodies.0.iter().map(bits).collect();
    assert!(before == after, "nothing has moved");
}

#[test]
fn a_contact_between_bodies_conserves_momentum() {
    let params = SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::default()
    };
    let mut bodies = balls();
    let lower = bodies.0[0].0.positions().len();
    let slots = lower + bodies.0[1].0.positions().len();
    let (surface, solver) = &mut bodies.0[1];
    for v in surface.topology().vertices() {
        solver.set_velocity(v, [0.0, -1.0, 0.0]).unwrap();
    }
    let momentum = solver.momentum()[1];
    // A vertex of the upper ball against the highest triangle of the lower one, whatever its place.
    let face = surface_top(&bodies.0[0].0);
    let vertex = VertexId::from_index(lower);
    let contact = Contact::vertex_face(vertex, face, 2.0);
    let mut island = Island::default();
    island.set_contacts(&[contact], slots).unwrap();
    for _ in 0..30 {
        bodies.step(&mut island, &params).unwrap();
    }
    let [low, high] = [0, 1].map(|i| bodies.0[i].1.momentum()[1]);
    assert!(
        low < -0.01 * momentum.abs(),
        "the lower ball is pushed: {low}"
    );
    assert!(
        (low + high - momentum).abs() < 1e-4 * momentum.abs(),
        "{low} + {high}, not {momentum}"
    );
    let beyond = Contact {
        vertices: [
            VertexId::from_index(slots),
            VertexId(0),
            VertexId(1),
            VertexId(2),
        ],
        ..contact
    };
    let refused = island.set_contacts(&[beyond], slots).unwrap_err();
    assert!(matches!(refused, ConstraintError::UnknownVertex { .. }));
    assert_eq!(island.contacts().len(), 1, "nothing is changed");
}

/// Returns the corners of the triangle with the highest center.
fn surface_top(surface: &Surface) -> [VertexId; 3] {
    let topology = surface.topology();
    let height = |t: &_| {
        let corners = topology
            .triangle(*t)
            .map(|v| surface.positions()[v.index()][1]);
        corners.iter().sum::<f32>()
    };
    let all = topology.triangles();
    let top = all.max_by(|a, b| height(a).total_cmp(&height(b))).unwrap();
    topology.triangle(top)
}

#[test]
fn an_error_names_the_body() {
    let mut bodies = balls();
    bodies.0[1].0.positions_mut()[3][0] = f32::NAN;
    let before = bits(&bodies.0[0]);
    let error = bodies.step(&mut Island::default(), &SolverParams::default());
    let error = error.unwrap_err();
    assert_eq!(error.body, 1);
    let vertex = VertexId(3);
    assert_eq!(error.error, StepError::NonFiniteInput { vertex });
    assert!(bits(&bodies.0[0]) == before, "nothing has moved");
}

/// Returns a row of balls beside each other, every seventh large, and the contacts of neighbors.
fn row() -> (Bodies, Vec<Contact>, usize) {
    let material = Material::soft_body();
    let (mut bodies, mut contacts, mut slots) = (Vec::new(), Vec::new(), 0);
    for i in 0..21_u8 {
        let level = if i % 7 == 3 { 4 } else { 2 };
        let mut surface = sphere(level, [2.2 * f32::from(i), 0.1 * f32::from(i), 0.0]);
        let solver = Solver::new(&mut surface, &material).unwrap();
        let count = surface.positions().len();
        if let Some(vertex) = usize::checked_sub(slots, 1) {
            let face = [0, 1, 2].map(|k| VertexId::from_index(slots + k));
            contacts.push(Contact::vertex_face(
                VertexId::from_index(vertex),
                face,
                2.0,
            ));
        }
        slots += count;
        bodies.push((surface, solver));
    }
    (Bodies(bodies), contacts, slots)
}

#[test]
fn threads_share_small_bodies_with_the_same_bits() {
    let params = SolverParams::default();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let (mut bodies, contacts, slots) = row();
            for (_, solver) in &mut bodies.0 {
                solver
                    .set_colliders(&[Collider::ground(-1.05).into()])
                    .unwrap();
            }
            let mut island = Island::default();
            island.set_contacts(&contacts, slots).unwrap();
            for _ in 0..20 {
                bodies.step(&mut island, &params).unwrap();
            }
            bodies.0.iter().map(bits).collect::<Vec<_>>()
        })
    };
    let one = run(1);
    for threads in [2, 5] {
        assert!(one == run(threads), "{threads} threads differ from one");
    }
}

#[test]
fn an_error_names_the_first_body_on_any_number_of_threads() {
    for threads in [1, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let error = pool.build().unwrap().install(|| {
            let (mut bodies, ..) = row();
            // The second one is large: threads share its passes.
            for i in [18, 10, 7, 9] {
                let (_, solver) = &mut bodies.0[i];
                solver.set_velocity(VertexId(5), [f32::MAX; 3]).unwrap();
            }
            let (mut island, params) = (Island::default(), SolverParams::default());
            (0..100).find_map(|_| bodies.step(&mut island, &params).err())
        });
        assert_eq!(
            error.map(|error| error.body),
            Some(7),
            "{threads} threads: {error:?}"
        );
    }
}
