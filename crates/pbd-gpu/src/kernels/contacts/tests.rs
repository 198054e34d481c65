use super::*;
use crate::constraints::colliders::{Collider, ColliderRecord};
use crate::constraints::contacts::{ContactKind, NO_VERTEX};
use crate::kernels::contact_features::contact_features;
use crate::kernels::particle_state::on_arrays;

const NO_PLANES: Planes<'_> = planes(&[], 0.0);

const fn planes(records: &[ColliderRecord], time: f32) -> Planes<'_> {
    Planes { records, time }
}

/// A vertex of 2 kg over the middle of a triangle of 3 kg that lies in the plane y = 0.
fn pair() -> (Vec<[f32; 4]>, ContactRecord) {
    let x = vec![
        [1.0, 0.1, 1.0, 0.5],
        [0.0, 0.0, 0.0, 1.0],
        [3.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 3.0, 1.0],
    ];
    let contact = ContactRecord {
        vertices: [0, 1, 2, 3],
        weights: [1.0, -1.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0],
        normal: [0.0, 1.0, 0.0],
        gap: 0.05,
        ..ContactRecord::default()
    };
    (x, contact)
}

#[test]
fn vertex_and_triangle_are_separated_by_inverse_mass() {
    let (x, contact) = pair();
    let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
    on_arrays(&x, &mut d, |p| {
        contacts(p, &[], &[], &mut [contact], 0, &[0], NO_PLANES)
    });
    // 0.15 m too near; inverse masses 1/2 and 3 (1/3)^2.
    let step = 0.15 / (0.5 + 1.0 / 3.0);
    assert!((d[0][1] - (-0.2 + 0.5 * step)).abs() < 1e-6, "{d:?}");
    for corner in &d[1..] {
        assert!((corner[1] + step / 3.0).abs() < 1e-6, "{d:?}");
    }
    let before = d;
    on_arrays(&x, &mut d, |p| {
        contacts(p, &[], &[], &mut [contact], 0, &[0], NO_PLANES)
    });
    let off = (d[0][1] - before[0][1]).abs();
    assert!(off < 1e-6, "separated contacts are inactive");
}

/// Regression: next to pins a corner moved by the reciprocal of its weight, here by 1,500 m.
#[test]
fn a_vertex_moves_by_a_few_corrections_at_most() {
    let (mut x, contact) = pair();
    for fixed in &mut x[..3] {
        fixed[3] = 0.0;
    }
    let contact = ContactRecord {
        weights: [1.0, -0.5, -0.4999, -1e-4],
        ..contact
    };
    let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
    on_arrays(&x, &mut d, |p| {
        contacts(p, &[], &[], &mut [contact], 0, &[0], NO_PLANES)
    });
    let depth = 0.15;
    assert!((d[3][1] + MAX_SHARE * depth).abs() < 1e-5, "{d:?}");
}

/// Runs the end of a substep of 0.01 s.
fn recovered(d: [f32; 3], contact: ContactRecord) -> (Vec<ParticleState>, Vec<ParticleState>) {
    let [x, y, z] = d;
    let d = [[x, y, z, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
    let states: Vec<_> = (pair().0.into_iter().zip(d))
        .map(|(x, d)| ParticleState { x, d })
        .collect();
    let mut after = states.clone();
    let states_after = ParticleStates::new(&mut after);
    let change = recover_contacts(states_after, &[], &[contact], NO_PLANES, 0.01, [0.0; 3]);
    assert_eq!(change > 0.0, after != states);
    (states, after)
}

#[test]
fn active_contacts_separate_without_velocity() {
    let contact = ContactRecord {
        is_active: 1,
        thickness: 0.05,
        ..pair().1
    };
    let (before, after) = recovered([0.3, 0.1, 0.0], contact);
    let along = after[0].d[1] - (after[1].d[1] + after[2].d[1] + after[3].d[1]) / 3.0;
    assert!(along.abs() < 1e-7, "{along} m are left");
    assert_eq!(after[0].d[0], 0.3, "along the triangle it moves on");
    let momentum = 2.0 * after[0].d[1] + after[1].d[1] + after[2].d[1] + after[3].d[1];
    assert!((momentum - 0.2).abs() < 1e-6, "{momentum} is left");
    for (after, before) in after.iter().zip(&before) {
        for k in 0..3 {
            let [after, before] = [after, before].map(|state| state.x[k] + state.d[k]);
            assert!((after - before).abs() < 1e-6, "positions stay");
        }
    }
    let inactive = ContactRecord {
        is_active: 0,
        ..contact
    };
    for (d, contact) in [([0.0, 0.1, 0.0], inactive), ([0.0, -0.1, 0.0], contact)] {
        let (before, after) = recovered(d, contact);
        assert!(before == after, "nothing separates");
    }
}

#[test]
fn a_missing_distance_recovers_in_positions_only() {
    let contact = ContactRecord {
        is_active: 1,
        thickness: 0.07,
        gap: 0.03,
        ..pair().1
    };
    let (before, after) = recovered([0.0; 3], contact);
    let between = after[0].x[1] - (after[1].x[1] + after[2].x[1] + after[3].x[1]) / 3.0;
    // A twentieth of the missing 0.04 m in 0.01 s.
    assert!((between - 0.102).abs() < 1e-6, "{between} m apart");
    for (after, before) in after.iter().zip(&before) {
        assert_eq!(after.d, before.d, "velocities stay");
    }
}

/// Regression: the ground undid half of each correction, so that upper sheets sank into lower
/// ones.
#[test]
fn a_triangle_on_a_plane_counts_as_fixed_along_its_normal() {
    let (x, contact) = pair();
    let ground = [Collider::ground(0.0).record().unwrap()];
    for normal in [[0.0, 1.0, 0.0], [0.6, 0.8, 0.0]] {
        let contact = ContactRecord { normal, ..contact };
        let mut d = [[0.0, -0.08, 0.0, 0.0]; 4];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &[], &mut [contact], 0, &[0], planes(&ground, 0.0))
        });
        let lift = d[1..].iter().map(|corner| -0.08 - corner[1]).sum::<f32>() / 3.0;
        let press = 2.0 * (d[0][1] + 0.08) / 3.0;
        assert!(
            (lift - press).abs() < 1e-6,
            "{d:?}: the ground takes the reaction"
        );
        // Relative to the corners on the ground.
        let shift = d[0][0] - (d[1][0] + d[2][0] + d[3][0]) / 3.0;
        let distance = normal[0] * shift + normal[1] * (0.1 + d[0][1]);
        assert!((distance - 0.05).abs() < 1e-6, "{distance} m, {d:?}");
        let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
        assert!(momentum.abs() < 1e-6, "sideways it is free: {momentum}");
    }
}

/// Rounding of normals does not count as a slide: a million corrections would be lost in rounding.
#[test]
fn a_vertex_between_a_held_face_and_a_parallel_plane_stays() {
    let (sin, cos) = 0.3_f32.sin_cos();
    let plane = Collider::Plane {
        point: [0.0; 3],
        normal: [sin, cos, 1e-7],
    };
    let records = [plane.record().unwrap()];
    let x = [
        [0.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 0.0],
        [3.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 3.0, 0.0],
    ];
    let contact = ContactRecord {
        normal: [-sin, -cos, 0.0],
        ..pair().1
    };
    let mut d = [[0.0; 4]; 4];
    on_arrays(&x, &mut d, |p| {
        contacts(p, &[], &[], &mut [contact], 0, &[0], planes(&records, 0.0))
    });
    assert_eq!(d, [[0.0; 4]; 4]);
}

/// The recovery of a contact above a tilted plane, which the triangle touches or is just above.
#[test]
fn recovery_moves_no_vertex_into_a_plane() {
    let contact = ContactRecord {
        is_active: 1,
        thickness: 0.07,
        gap: 0.03,
        ..pair().1
    };
    for gap in [0.0, 1e-4] {
        let plane = Collider::Plane {
            point: [0.0, -gap, 0.0],
            normal: [0.6, 0.8, 0.0],
        };
        let records = [plane.record().unwrap()];
        let planes = planes(&records, 0.0);
        let mut states: Vec<_> = (pair().0.into_iter())
            .map(|x| ParticleState { x, d: [0.0; 4] })
            .collect();
        let before = states.clone();
        let particles = ParticleStates::new(&mut states);
        recover_contacts(particles, &[], &[contact], planes, 0.01, [0.0; 3]);
        assert!(states[0].x[1] > before[0].x[1], "the vertex rises");
        for state in &states {
            let depth: f32 = planes.push_out(*state).flatten().sum();
            assert!(depth < 1e-7, "{depth} m below the plane");
        }
        if gap == 0.0 {
            assert_eq!(states[1], before[1], "it lies on the plane");
        }
    }
}

/// Regression: a contact on which others press lost more in each substep than it regained.
#[test]
fn a_carried_feature_rises() {
    let contact = ContactRecord {
        is_active: 1,
        thickness: 0.07,
        gap: 0.03,
        ..pair().1
    };
    let fall = [0.0, -0.005, 0.0];
    for missing in [0.04, 0.005] {
        let contact = ContactRecord {
            gap: contact.thickness - missing,
            carried: SupportedSide::First as u16,
            ..contact
        };
        let mut states: Vec<_> = (pair().0.into_iter())
            .map(|x| ParticleState { x, d: [0.0; 4] })
            .collect();
        let before = states.clone();
        let particles = ParticleStates::new(&mut states);
        recover_contacts(particles, &[], &[contact], NO_PLANES, 0.01, fall);
        let expected = f32::min(missing, 0.05 * missing + 0.02);
        assert!(
            (states[0].x[1] - 0.1 - expected).abs() < 1e-6,
            "{expected} m"
        );
        assert_eq!(states[1..], before[1..], "nothing is pressed down");
    }
}

#[test]
fn crossed_edges_are_separated_by_inverse_mass() {
    // Edges along x and z cross at a quarter of the first and the middle of the second.
    let x = [
        [-1.0, 0.1, 0.0, 0.5],
        [3.0, 0.1, 0.0, 0.5],
        [0.0, 0.0, -1.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ];
    let contact = ContactRecord {
        vertices: [0, 1, 2, 3],
        weights: [0.75, 0.25, -0.5, -0.5],
        normal: [0.0, 1.0, 0.0],
        gap: 0.05,
        ..ContactRecord::default()
    };
    let mut d = [
        [0.0, -0.2, 0.0, 0.0],
        [0.0, -0.2, 0.0, 0.0],
        [0.0; 4],
        [0.0; 4],
    ];
    on_arrays(&x, &mut d, |p| {
        contacts(p, &[], &[], &mut [contact], 0, &[0], NO_PLANES)
    });
    let heights = [0, 1, 2, 3].map(|i: usize| x[i][1] + d[i][1]);
    let between = 0.75 * heights[0] + 0.25 * heights[1] - 0.5 * (heights[2] + heights[3]);
    assert!((between - 0.05).abs() < 1e-6, "{between} m apart");
    let momentum = 2.0 * (d[0][1] + d[1][1] + 0.4) + (d[2][1] + d[3][1]);
    assert!(momentum.abs() < 1e-6, "none is made: {momentum}");
}

#[test]
fn a_vertex_below_a_plane_is_lifted_with_the_gap_rate() {
    let (x, contact) = pair();
    let plane = ContactRecord {
        vertices: [0, NO_VERTEX, NO_VERTEX, NO_VERTEX],
        kind: ContactKind::Plane as u16,
        weights: [1.0, 0.0, 0.0, 0.0],
        friction: 0.5,
        gap: 0.15,
        gap_rate: 2.0,
        ..contact
    };
    for (time, height) in [(0.0, 0.15), (0.05, 0.25)] {
        let mut d = [[0.3, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &[], &mut [plane], 0, &[0], planes(&[], time))
        });
        assert!((x[0][1] + d[0][1] - height).abs() < 1e-6, "{d:?}");
        // Friction removes half of the lift.
        let left = 0.3 - 0.5 * (height + 0.1);
        assert!((d[0][0] - left).abs() < 1e-6 && d[0][2] == 0.0, "{d:?}");
        assert_eq!(d[1..], [[0.0; 4]; 3], "other vertices stay");
    }
    let mut held = x;
    held[0][3] = 0.0;
    let mut d = [[0.0; 4]; 4];
    on_arrays(&held, &mut d, |p| {
        contacts(p, &[], &[], &mut [plane], 0, &[0], NO_PLANES)
    });
    assert_eq!(d, [[0.0; 4]; 4], "pinned vertices stay");
}

#[test]
fn friction_is_limited_by_the_normal_correction() {
    for (slide, left) in [(0.03, 0.0), (0.4, 0.325)] {
        let (x, contact) = pair();
        let mut d = [[slide, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        let mut list = [ContactRecord {
            friction: 0.5,
            ..contact
        }];
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &[], &mut list, 0, &[0], NO_PLANES)
        });
        let point = (d[1][0] + d[2][0] + d[3][0]) / 3.0;
        assert!((d[0][0] - point - left).abs() < 1e-6, "{d:?}");
        let momentum = 2.0 * d[0][0] + d[1][0] + d[2][0] + d[3][0];
        assert!((momentum - 2.0 * slide).abs() < 1e-6, "none is lost");
    }
}

#[test]
fn friction_is_bounded_by_the_sums_of_a_substep() {
    let (x, contact) = pair();
    let mut list = [ContactRecord {
        friction: 0.5,
        ..contact
    }];
    // 0.15 m too near, then not at all: friction holds 0.075 m of all slides together.
    let mut d = [[0.06, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
    for (pull, left) in [(0.0, 0.0), (-0.1, 0.0), (0.06, 0.0), (0.1, 0.045)] {
        d[0][0] += pull;
        d[0][1] -= 1e-9;
        on_arrays(&x, &mut d, |p| {
            contacts(p, &[], &[], &mut list, 0, &[0], NO_PLANES)
        });
        let slide = d[0][0] - (d[1][0] + d[2][0] + d[3][0]) / 3.0;
        assert!((slide - left).abs() < 1e-6, "{slide} m after {pull} m");
    }
}

/// Regression: each substep forgot what other constraints had moved on, and heaps crept.
#[test]
fn friction_takes_back_what_others_moved_in_the_last_substep() {
    let drift = 0.02;
    for (friction, left) in [(1.0, -drift), (0.05, 0.01 - drift - 0.05 * 0.15)] {
        let (mut x, contact) = pair();
        let mut list = [ContactRecord {
            friction,
            // Its normal points up.
            vertices: [0, 1, 3, 2],
            thickness: 0.05,
            ..contact
        }];
        let mut d = [[0.0, -0.2, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]];
        on_arrays(&x, &mut d, |p| {
            contact_features(p, &mut list, &mut Vec::new());
            contacts(p, &[], &[], &mut list, 0, &[0], NO_PLANES);
        });
        // Others move the vertex; then the substep ends, and it slides on.
        d[0][0] += drift;
        for (x, d) in x.iter_mut().zip(&mut d) {
            for k in 0..3 {
                x[k] += std::mem::take(&mut d[k]);
            }
        }
        d[0] = [0.01 - drift, -0.15, 0.0, 0.0];
        on_arrays(&x, &mut d, |p| {
            contact_features(p, &mut list, &mut Vec::new());
            contacts(p, &[], &[], &mut list, 0, &[0], NO_PLANES);
        });
        let slide = d[0][0] - (d[1][0] + d[2][0] + d[3][0]) / 3.0;
        assert!((slide - left).abs() < 1e-5, "{slide} m with {friction}");
    }
}
