//! Volume constraints: closed forms and invariants.

use incise_mesh::{Surface, TriangleId, VertexId};
use incise_pbd_gpu::{Contact, Material, Solver, SolverParams, StepError, SupportedSide, Volume};
use incise_test_support::materials::{limp, with_pressure};
use incise_test_support::surfaces::{edge_keys, scaled, sphere, two_spheres};

const DT: f32 = 1.0 / 60.0;

fn weightless() -> SolverParams {
    SolverParams {
        gravity: [0.0; 3],
        ..SolverParams::default()
    }
}

/// A regular tetrahedron whose vertices are 1 m from its center.
fn tetrahedron() -> Surface {
    let c = 1.0 / 3.0_f32.sqrt();
    let corners = [[c, c, c], [c, -c, -c], [-c, c, -c], [-c, -c, c]];
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    Surface::from_triangles(&corners, &faces).unwrap()
}

/// The vertices of a regular tetrahedron move symmetrically, so it is one oscillator: `V = V0 r^3`,
/// pulled back by `(V - V0) / (compressibility V0)` on all of its mass. Every substep of one
/// iteration is backward Euler of it.
#[test]
fn a_tetrahedron_oscillates_as_in_backward_euler() {
    let compressibility = 1e-4_f32;
    let mut surface = tetrahedron();
    let rest = surface.volume();
    let material = limp(Volume {
        compressibility,
        pressure: 1.0,
    });
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    let scale = 1.001_f32;
    for p in surface.positions_mut() {
        p.iter_mut().take(3).for_each(|c| *c *= scale);
    }
    solver.mark_all_changed();
    for iterations in [1, 4] {
        let params = SolverParams {
            iterations,
            substep: None,
            lift: 0.0,
            diagonal_scale: 1.0,
            ..weightless()
        };
        let (h, mass) = (f64::from(DT) / 20.0, solver.total_mass());
        // d V / d r = 3 V0 at r = 1.
        let square = 9.0 * rest / (f64::from(compressibility) * mass);
        let mut body = (surface.clone(), solver.clone());
        let error = |surface: &Surface| surface.volume() / rest - 1.0;
        let (mut expected, mut before) = (error(&body.0), error(&body.0));
        let amplitude = expected;
        for step in 0..100 {
            let short = DT / 20.0;
            body.1.step(&mut body.0, short, &params).unwrap();
            let next = (2.0 * expected - before) / (1.0 + h * h * square);
            (before, expected) = (expected, next);
            let found = error(&body.0);
            // The volume is no linear function of the radius: 3e-3 of it at this amplitude.
            assert!(
                (found - expected).abs() < 0.01 * amplitude,
                "{found}, not {expected}, in step {step} with {iterations} iterations"
            );
        }
    }
}

#[test]
fn volume_constraints_act_on_their_piece_only() {
    let mut surface = two_spheres(3);
    let material = Material {
        volume: Some(with_pressure(1.3)),
        ..Material::default()
    };
    let mut solver = Solver::new(&mut surface, &material).unwrap();
    for v in surface.topology().vertices() {
        let [x, y, z, _] = surface.positions()[v.index()];
        let to = [3.0 * y - z, 1.0 + x * z, 2.0 * z];
        solver.set_velocity(v, to).unwrap();
    }
    let params = SolverParams {
        iterations: 4,
        ..weightless()
    };
    let momentum = solver.momentum();
    let mass = solver.total_mass();
    for _ in 0..60 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    for (is, was) in solver.momentum().into_iter().zip(momentum) {
        assert!((is - was).abs() < 1e-4 * mass, "momentum {was} became {is}");
    }
}

/// A ball with a volume constraint only keeps its angular momentum over one revolution.
///
/// Implicit Euler dissipates it in proportion to forces, which are small in a round body.
#[test]
fn volume_corrections_keep_angular_momentum() {
    let mut surface = sphere(3, [0.3, 0.0, 0.0]);
    let mut solver = Solver::new(&mut surface, &limp(with_pressure(1.5))).unwrap();
    for _ in 0..30 {
        solver.step(&mut surface, DT, &weightless()).unwrap();
    }
    let spin = solver.angular_momentum(&surface, [0.0; 3]);
    let moving = solver.total_mass() * 1.0;
    assert!(
        spin.iter().all(|l| l.abs() < 1e-4 * moving),
        "it turns by {spin:?}"
    );
}

#[test]
fn every_closed_piece_has_its_rest_volume() {
    let mut surface = two_spheres(2);
    let volumes = surface.piece_volumes();
    // Rest volumes follow from rest positions, not from positions.
    for p in surface.positions_mut() {
        p[1] *= 1.5;
    }
    let material = limp(Volume::default());
    let solver = Solver::new(&mut surface, &material).unwrap();
    let pieces = solver.volumes().pieces();
    assert_eq!(pieces.len(), 2);
    let mut vertices = 0;
    for (piece, expected) in pieces.iter().zip(volumes) {
        let off = (f64::from(piece.rest()) - expected).abs();
        assert!(off < 1e-6 * expected, "{} of {expected}", piece.rest());
        vertices += piece.vertices();
    }
    assert_eq!(vertices, surface.topology().vertex_count());
    solver.validate(&surface).unwrap();
}

#[test]
fn a_ball_in_a_ball_is_a_cavity_that_keeps_its_size() {
    let (outer, inner) = (sphere(2, [0.0; 3]), sphere(2, [0.0; 3]));
    let mut corners: Vec<[f32; 3]> = outer.rest_positions().to_vec();
    let offset = u32::try_from(corners.len()).unwrap();
    corners.extend(inner.rest_positions().iter().map(|p| p.map(|c| c * 0.5)));
    let of = |s: &Surface| -> Vec<[u32; 3]> {
        let t = s.topology();
        t.triangles().map(|f| t.triangle(f).map(|v| v.0)).collect()
    };
    let mut faces = of(&outer);
    faces.extend(
        of(&inner)
            .iter()
            .map(|&[a, b, c]| [a, c, b].map(|v| v + offset)),
    );
    let mut surface = Surface::from_triangles(&corners, &faces).unwrap();
    let volumes = surface.piece_volumes();
    let mut solver = Solver::new(&mut surface, &limp(with_pressure(1.2))).unwrap();
    assert!(solver.volumes().pieces()[1].rest() < 0.0);
    for _ in 0..30 {
        solver.step(&mut surface, DT, &weightless()).unwrap();
    }
    for (now, was) in surface.piece_volumes().iter().zip(volumes) {
        assert!((now / was - 1.2).abs() < 1e-4, "{now} of {was}");
    }
}

#[test]
fn open_and_flat_pieces_have_no_volume_constraint() {
    let square = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let sheet = [[0, 1, 2], [0, 2, 3]];
    let pillow = [[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]];
    // Two tetrahedra that share vertex 0: a traversal around it visits one of them only.
    let bow_tie = [
        [0, 2, 1],
        [0, 1, 3],
        [1, 2, 3],
        [2, 0, 3],
        [0, 4, 5],
        [0, 6, 4],
        [4, 6, 5],
        [5, 6, 0],
    ];
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
    ];
    let mut bodies = vec![
        Surface::from_triangles(&square, &sheet).unwrap(),
        Surface::from_triangles(&corners, &bow_tie).unwrap(),
    ];
    bodies.extend(Surface::from_triangles(&square, &pillow));
    let mut open = sphere(2, [0.0; 3]);
    open.remove_triangles(&[TriangleId(0)]);
    bodies.push(open);
    // Coordinates of 10 m are stored to a micrometer, half the thickness of the chip.
    let mut chip = scaled(sphere(2, [0.0; 3]), [1e-3, 1e-6, 1e-3]);
    chip.rest_positions_mut()
        .iter_mut()
        .for_each(|p| p[1] += 10.0);
    bodies.push(chip);
    for mut surface in bodies {
        let material = Material {
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        let keys = edge_keys(&surface).len();
        let pieces = solver.volumes().pieces().len();
        // Of the bow tie, only the half that the traversal visits may have a constraint.
        assert!(pieces == 0 || keys == 12 && pieces == 1, "{pieces}");
        for _ in 0..10 {
            solver.step(&mut surface, DT, &weightless()).unwrap();
        }
        assert!(solver.kinetic_energy() < 1e-6, "nothing pushes");
    }
}

#[test]
fn an_overflow_of_compressibility_is_an_error() {
    // 1e30 / h^2 is a number, times 4e9 m^3 it is none.
    let mut surface = scaled(sphere(2, [0.0; 3]), [1e3; 3]);
    let material = |compressibility| Material {
        volume: Some(Volume {
            compressibility,
            ..Volume::default()
        }),
        ..Material::default()
    };
    for (compressibility, is_refused) in [(1e20, false), (1e30, true)] {
        let mut solver = Solver::new(&mut surface, &material(compressibility)).unwrap();
        let before = surface.positions().to_vec();
        let done = solver.step(&mut surface, DT, &weightless()).map(|_| ());
        let is_short = matches!(done, Err(StepError::SubstepTooShort { .. }));
        assert_eq!(is_short, is_refused, "{done:?}");
        assert!(
            !is_refused || surface.positions() == before,
            "nothing moves"
        );
    }
}

#[test]
fn volume_constraints_follow_the_material() {
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = Solver::new(&mut surface, &limp(Volume::default())).unwrap();
    let params = weightless();
    solver.step(&mut surface, DT, &params).unwrap();
    assert!(solver.stats().volume_projections > 0);
    solver.set_volume(&surface, None).unwrap();
    solver.step(&mut surface, DT, &params).unwrap();
    assert_eq!(solver.stats().volume_projections, 0);
    let bad = with_pressure(f32::INFINITY);
    assert!(solver.set_volume(&surface, Some(bad)).is_err());
    assert_eq!(solver.material().volume, None, "nothing is changed");
    solver
        .set_volume(&surface, Some(with_pressure(2.0)))
        .unwrap();
    let rest = surface.volume();
    for _ in 0..60 {
        solver.step(&mut surface, DT, &params).unwrap();
    }
    assert!((surface.volume() / rest - 2.0).abs() < 1e-4);
}

/// A ball without a radius has no gradient to grow along, one that is turned inside out grows
/// through nothing.
#[test]
fn crushed_and_inverted_bodies_stay_finite() {
    for scale in [0.0_f32, 1e-6, 0.01, -1.0] {
        let mut surface = sphere(2, [0.0; 3]);
        let material = Material {
            volume: Some(Volume::default()),
            ..Material::default()
        };
        let mut solver = Solver::new(&mut surface, &material).unwrap();
        for p in surface.positions_mut() {
            p.iter_mut().take(3).for_each(|c| *c *= scale);
        }
        for _ in 0..120 {
            solver.step(&mut surface, DT, &weightless()).unwrap();
        }
        let far = surface
            .positions()
            .iter()
            .flat_map(|p| &p[..3])
            .fold(0.0, |a: f32, c| a.max(c.abs()));
        assert!(far < 3.0, "thrown {far} m from a ball of 1 m by {scale}");
    }
}

/// A tetrahedron on two of its vertices, which a plane holds up; the other two move down.
#[test]
fn carried_vertices_do_not_move_down_for_the_volume() {
    let volume_error = |carried| {
        let mut surface = tetrahedron();
        let rest = surface.volume();
        let mut solver = Solver::new(&mut surface, &limp(Volume::default())).unwrap();
        let (upper, lower) = ([0, 2].map(VertexId), [1, 3].map(VertexId));
        for v in upper {
            solver.set_velocity(v, [0.0, -1.0, 0.0]).unwrap();
        }
        let height = surface.positions()[1][1];
        let contacts = lower.map(|v| Contact {
            carried,
            ..Contact::plane(v, [0.0, 1.0, 0.0], height + 1e-4)
        });
        solver.set_contacts(&contacts).unwrap();
        // So little that it only tells where down is.
        let params = SolverParams {
            substep: None,
            gravity: [0.0, -1e-6, 0.0],
            ..weightless()
        };
        solver.step(&mut surface, DT, &params).unwrap();
        (surface.volume() / rest - 1.0).abs()
    };
    let [carried, free] = [SupportedSide::First, SupportedSide::Neither].map(volume_error);
    assert!(
        carried < 1e-4,
        "the upper vertices restore the volume: {carried}"
    );
    assert!(
        free > 50.0 * carried,
        "the plane takes a part of it: {free}"
    );
}
