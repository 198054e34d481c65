//! Bad input: a typed error, and everything as it was.

use super::case::{Case, Worst};
use super::device::Device;
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, ball, elastic_shell};
use super::stage::{Mover, Stage};
use incise_mesh::{Surface, TopologyDelta, TopologyError, TriangleId, VertexId};
use incise_pbd_gpu::{
    ConstraintError, Density, Material, Solver, SolverParams, StepError, Stiffness,
};

pub(super) const CASES: [Case; 3] = [
    Case {
        id: "T15",
        torture: "bad meshes, materials, time steps, parameters, pins, masses, deltas, positions",
        law: "inputs without their typed error, or that left a trace",
        bound: 0.0,
        run: bad_input,
    },
    Case {
        id: "T15",
        torture: "no triangle, one triangle, one tetrahedron",
        law: "bodies that are refused",
        bound: 0.0,
        run: small,
    },
    Case {
        id: "T16",
        torture: "a device that is not there, and one that is lost",
        law: "calls without a typed error",
        bound: 0.0,
        run: no_device,
    },
];

/// Counts what was wrong.
#[derive(Default)]
struct Tally(Worst);

impl Tally {
    fn expect(&mut self, is_right: bool, what: impl Fn() -> String) {
        let (found, at) = if is_right {
            (0.0, "nowhere".to_owned())
        } else {
            (1.0, what())
        };
        self.0.judge(Ok(found), || at.clone());
    }
}

type Bits = (Vec<[u32; 4]>, Vec<[u32; 4]>);

/// Everything that moves, to the bit.
fn bits(surface: &Surface, solver: &Solver) -> Bits {
    let of = |all: &[[f32; 4]]| all.iter().map(|v| v.map(f32::to_bits)).collect();
    (of(&surface.positions), of(solver.velocities()))
}

fn bad_input(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut tally = Tally::default();
    meshes(&mut tally);
    materials(&mut tally);
    let mut mover = stage.enter(ball(1, 0.6), &elastic_shell(1e-4, 1e-2))?;
    mover.advance(FRAME, &GROUND, 10)?;
    steps(&mut tally, &mut mover);
    values(&mut tally, &mut mover);
    deltas(&mut tally, &mut mover);
    // After all that it goes on.
    let goes_on = mover.advance(FRAME, &GROUND, 10).is_ok();
    tally.expect(goes_on, || "the body after all refusals".to_owned());
    positions(&mut tally)?;
    Ok(tally.0)
}

fn meshes(tally: &mut Tally) {
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0; 3],
    ];
    let of = |faces: &[[u32; 3]]| Surface::from_triangles(&points, faces).err();
    let out = of(&[[0, 1, 9]]);
    let is = matches!(out, Some(TopologyError::VertexOutOfRange { .. }));
    tally.expect(is, || format!("an index out of range: {out:?}"));
    let twice = of(&[[0, 1, 1]]);
    let is = matches!(twice, Some(TopologyError::RepeatedVertex { .. }));
    tally.expect(is, || format!("a corner twice: {twice:?}"));
    let three = of(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let is = matches!(
        three,
        Some(TopologyError::NonManifoldEdge { .. } | TopologyError::InconsistentWinding { .. })
    );
    tally.expect(is, || format!("three triangles at an edge: {three:?}"));
    let wound = of(&[[0, 1, 2], [0, 1, 3]]);
    let is = matches!(wound, Some(TopologyError::InconsistentWinding { .. }));
    tally.expect(is, || format!("winding: {wound:?}"));
}

/// A material with one number changed.
type Spoil = fn(&mut Material);

fn materials(tally: &mut Tally) {
    let spoilt: [(&str, Spoil); 10] = [
        ("density 0", |m| m.density = Density::Area(0.0)),
        ("density NaN", |m| m.density = Density::Area(f32::NAN)),
        ("density -1 by volume", |m| {
            m.density = Density::Volume(-1.0)
        }),
        ("compliance -1", |m| m.stretch = Stiffness::Compliance(-1.0)),
        ("compliance NaN", |m| {
            m.bending = Some(Stiffness::Compliance(f32::NAN))
        }),
        ("compliance infinite", |m| {
            m.stretch = Stiffness::Compliance(f32::INFINITY)
        }),
        ("stiffness 1.5", |m| m.stretch = Stiffness::Pbd(1.5)),
        ("stiffness NaN", |m| {
            m.bending = Some(Stiffness::Pbd(f32::NAN))
        }),
        ("friction -1", |m| m.friction = -1.0),
        ("damping NaN", |m| m.damping = f32::NAN),
    ];
    let whole = ball(1, 0.6);
    let mut refused = |name: &str, spoil: &dyn Fn(&mut Surface, &mut Material)| {
        let (mut surface, mut material) = (whole.clone(), Material::default());
        spoil(&mut surface, &mut material);
        let before: Vec<[u32; 4]> = surface
            .positions
            .iter()
            .map(|p| p.map(f32::to_bits))
            .collect();
        let is_refused = Solver::new(&mut surface, &material).is_err();
        let same = surface
            .positions
            .iter()
            .zip(&before)
            .all(|(p, b)| p.map(f32::to_bits) == *b);
        tally.expect(is_refused && same, || name.to_owned());
    };
    for (name, spoil) in spoilt {
        refused(name, &|_, material| spoil(material));
    }
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refused("a position that is no number", &|surface, _| {
            surface.positions[7][1] = value
        });
        refused("a rest position that is no number", &|surface, _| {
            surface.rest[7][2] = value
        });
    }
    refused("an edge without length", &|surface, _| {
        let topology = surface.topology();
        let next = topology.target(topology.outgoing(VertexId(0)));
        surface.rest[0] = surface.rest[next.index()];
    });
    refused("a density by volume inside out", &|surface, material| {
        material.density = Density::Volume(1.0);
        surface.rest.iter_mut().for_each(|r| r[0] = -r[0]);
    });
}

fn steps(tally: &mut Tally, mover: &mut Mover<'_>) {
    let mut refused = |name: &str, dt: f32, params: SolverParams| {
        let before = bits(&mover.surface, &mover.solver);
        let found = mover.step(dt, &params);
        let typed = matches!(found, Err(Failure::Step(_)));
        let same = bits(&mover.surface, &mover.solver) == before;
        tally.expect(typed && same, || format!("{name}: {found:?}"));
    };
    for dt in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        refused("time step", dt, GROUND);
    }
    let none = [
        SolverParams {
            iterations: 0,
            ..GROUND
        },
        SolverParams {
            substeps: 0,
            ..GROUND
        },
    ];
    for params in none {
        refused("no iterations or substeps", FRAME, params);
    }
    for bad in [f32::NAN, f32::INFINITY] {
        refused(
            "gravity",
            FRAME,
            SolverParams {
                gravity: [0.0, bad, 0.0],
                ..GROUND
            },
        );
        refused(
            "ground",
            FRAME,
            SolverParams {
                ground: Some(bad),
                ..GROUND
            },
        );
    }
}

fn values(tally: &mut Tally, mover: &mut Mover<'_>) {
    let (v, unknown) = (VertexId(3), VertexId(1 << 20));
    let Mover {
        surface, solver, ..
    } = mover;
    let before = (
        bits(surface, solver),
        solver.masses().to_vec(),
        solver.pins().to_vec(),
    );
    let nan = [0.0, f32::NAN, 0.0];
    let found = [
        ("velocity NaN", solver.set_velocity(v, nan)),
        (
            "velocity of no vertex",
            solver.set_velocity(unknown, [0.0; 3]),
        ),
        ("pin of no vertex", solver.pin(surface, unknown)),
        (
            "pin of the null vertex",
            solver.pin(surface, VertexId::NULL),
        ),
        ("unpin of what is free", solver.unpin(surface, v)),
        ("target of what is free", solver.set_pin_target(v, [0.0; 3])),
        ("target NaN", solver.set_pin_target(v, nan)),
        ("mass 0", solver.set_mass(surface, v, 0.0)),
        ("mass -1", solver.set_mass(surface, v, -1.0)),
        ("mass NaN", solver.set_mass(surface, v, f32::NAN)),
        ("mass infinite", solver.set_mass(surface, v, f32::INFINITY)),
        (
            "mass without an inverse",
            solver.set_mass(surface, v, 1e-45),
        ),
        ("mass of no vertex", solver.set_mass(surface, unknown, 1.0)),
        (
            "stretch NaN",
            solver.set_stretch(Stiffness::Compliance(f32::NAN)),
        ),
        ("stretch 2", solver.set_stretch(Stiffness::Pbd(2.0))),
    ];
    let after = (
        bits(surface, solver),
        solver.masses().to_vec(),
        solver.pins().to_vec(),
    );
    for (name, found) in found {
        tally.expect(found.is_err() && after == before, || {
            format!("{name}: {found:?}")
        });
    }
}

fn deltas(tally: &mut Tally, mover: &mut Mover<'_>) {
    let corners = mover.surface.topology().triangle(TriangleId(0));
    let [a, b, c] = corners;
    let foreign = [
        TopologyDelta {
            triangles_removed: vec![(TriangleId(0), [b, a, c])],
            ..TopologyDelta::default()
        },
        TopologyDelta {
            triangles_removed: vec![(TriangleId(1 << 20), corners)],
            ..TopologyDelta::default()
        },
        TopologyDelta {
            triangles_added: vec![TriangleId(1 << 20)],
            ..TopologyDelta::default()
        },
    ];
    for delta in foreign {
        let before = bits(&mover.surface, &mover.solver);
        let found = mover.follow(&delta);
        let typed = matches!(
            found,
            Err(Failure::Constraint(
                ConstraintError::DeltaMismatch { .. }
                    | ConstraintError::DeltaUnknownTriangle { .. }
            ))
        );
        let sound = mover.solver.validate(&mover.surface).is_ok();
        let same = bits(&mover.surface, &mover.solver) == before;
        tally.expect(typed && sound && same, || {
            format!("a foreign delta: {found:?}")
        });
    }
}

/// On the host: a device's copy is not what is set there.
fn positions(tally: &mut Tally) -> Result<(), Failure> {
    for value in [f32::NAN, f32::INFINITY] {
        let mut surface = ball(1, 0.6);
        let mut solver = Solver::new(&mut surface, &Material::default())?;
        solver.step(&mut surface, FRAME, &GROUND)?;
        surface.positions[5][2] = value;
        let before = bits(&surface, &solver);
        let found = solver.step(&mut surface, FRAME, &GROUND).map(|_| ());
        let vertex = VertexId(5);
        let typed = found == Err(StepError::NonFiniteInput { vertex });
        let same = bits(&surface, &solver) == before;
        tally.expect(typed && same, || {
            format!("a position {value} between steps: {found:?}")
        });
        // Mended, it goes on.
        surface.positions[5] = surface.positions[4];
        surface.positions[5][2] += 0.1;
        let goes_on = solver.step(&mut surface, FRAME, &GROUND).is_ok();
        tally.expect(goes_on, || "a body whose position was mended".to_owned());
    }
    let mut surface = ball(1, 0.6);
    let mut solver = Solver::new(&mut surface, &Material::default())?;
    surface.add_vertex([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
    let before = bits(&surface, &solver);
    let found = solver.step(&mut surface, FRAME, &GROUND).map(|_| ());
    let typed = matches!(found, Err(StepError::SurfaceMismatch { .. }));
    let same = bits(&surface, &solver) == before;
    tally.expect(typed && same, || {
        format!("an edit without its delta: {found:?}")
    });
    Ok(())
}

fn small(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut tally = Tally::default();
    let points = [
        [0.0, 0.5, 0.0],
        [1.0, 0.5, 0.0],
        [0.0, 1.5, 0.0],
        [0.0, 0.5, 1.0],
    ];
    let solid: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let bodies = [
        ("nothing", 0, 0),
        ("a triangle", 3, 1),
        ("a tetrahedron", 4, 4),
    ];
    for (name, vertices, triangles) in bodies {
        let surface = Surface::from_triangles(&points[..vertices], &solid[..triangles])?;
        for material in [Material::default(), elastic_shell(1e-4, 1e-2)] {
            let moved = stage
                .enter(surface.clone(), &material)
                .and_then(|mut mover| mover.advance(FRAME, &GROUND, 60));
            tally.expect(moved.is_ok(), || format!("{name}: {moved:?}"));
        }
    }
    Ok(tally.0)
}

fn no_device(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut tally = Tally::default();
    let is_typed = |found: &Option<Failure>| matches!(found, Some(Failure::Device(_)));
    let found = Device::open(Some("an adapter of no machine")).err();
    tally.expect(is_typed(&found), || format!("{found:?}"));
    // One of its own is lost: the others go on.
    if stage.device.is_some() {
        let mut lost = Stage::new(stage.effort, Some(Device::open(None)?));
        let mut mover = lost.enter(ball(1, 0.6), &elastic_shell(1e-4, 1e-2))?;
        mover.advance(FRAME, &GROUND, 3)?;
        let before = bits(&mover.surface, &mover.solver);
        mover.lose_device();
        for _ in 0..2 {
            let found = mover.advance(FRAME, &GROUND, 1).err();
            tally.expect(is_typed(&found), || format!("after the loss: {found:?}"));
        }
        let kept = bits(&mover.surface, &mover.solver) == before;
        tally.expect(kept, || "a lost device left a trace".to_owned());
    }
    Ok(tally.0)
}
