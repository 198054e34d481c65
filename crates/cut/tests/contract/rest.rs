//! Rest positions of caps after cuts of a deformed body.

use incise_cut::{CutOutcome, CutParams, Cutter, Sweep};
use incise_mesh::geometry::{angle_between, area_vector, to_f32};
use incise_mesh::{Surface, TriangleId, Vec3, VertexId, VertexOrigin, icosphere};
use std::collections::{BTreeMap, BTreeSet};

/// The body with every position moved; rest positions stay.
fn moved(mut body: Surface, map: impl Fn(Vec3) -> Vec3) -> Surface {
    let vertices: Vec<_> = body.topology().vertices().collect();
    for v in vertices {
        let [x, y, z] = to_f32(map(body.rest_position(v)));
        body.positions_mut()[v.index()] = [x, y, z, body.positions()[v.index()][3]];
    }
    body
}

fn bent(p: Vec3) -> Vec3 {
    let ripple = 0.02 * (12.0 * p.x).sin() * (12.0 * p.y).cos();
    Vec3::new(
        p.x + 0.4 * p.z * p.z,
        p.y + 0.1 * (3.0 * p.x).sin(),
        p.z + ripple + 0.3 * p.x * p.y,
    )
}

fn cut(body: &mut Surface, sweep: &Sweep) -> CutOutcome {
    let outcome = Cutter::new(body).cut(body, sweep, &CutParams::default());
    let outcome = outcome.unwrap();
    assert!(!outcome.cap.is_empty(), "the body is cut");
    body.validate().unwrap();
    outcome
}

/// Vertices inside of caps, and the means of their parents' rest positions.
fn means(body: &Surface, outcome: &CutOutcome) -> BTreeMap<VertexId, Vec3> {
    let added = outcome.delta.vertices_added.iter();
    let on_cap = added.filter(|a| matches!(a.origin, VertexOrigin::OnCap { .. }));
    on_cap
        .map(|a| {
            (
                a.vertex,
                a.origin
                    .interpolate(|v| body.rest_positions()[v.index()])
                    .into(),
            )
        })
        .collect()
}

/// The energy of the map from the cap to the body at rest, and the sum of the squares of the angles
/// between neighboring triangles there that lie in a plane now.
fn energies(body: &Surface, cap: &[TriangleId], rest: impl Fn(VertexId) -> Vec3) -> [f64; 2] {
    let topology = body.topology();
    let inside: BTreeSet<_> = cap.iter().copied().collect();
    let normal = |t: TriangleId| area_vector(topology.triangle(t).map(&rest));
    let now = |t: TriangleId| area_vector(body.triangle_positions(t));
    let (mut energy, mut creases) = (0.0, 0.0);
    for &t in cap {
        let doubled = now(t).norm();
        for h in t.half_edges() {
            let (a, b) = (topology.origin(h), topology.target(h));
            let apex = body.position(topology.origin(h.prev()));
            let (u, w) = (body.position(a) - apex, body.position(b) - apex);
            energy += u.dot(&w) / doubled / 2.0 * (rest(a) - rest(b)).norm_squared();
            let other = topology.twin(h).triangle();
            if inside.contains(&other) && angle_between(now(t), now(other)) < 0.01 {
                creases += angle_between(normal(t), normal(other)).powi(2) / 2.0;
            }
        }
    }
    [energy, creases]
}

fn assert_smooth(body: &Surface, outcome: &CutOutcome) {
    let means = means(body, outcome);
    assert!(means.len() > 100, "only {} inner vertices", means.len());
    let (lower, upper) = outcome.cap.split_at(outcome.cap.len() / 2);
    for cap in [lower, upper] {
        let smooth = energies(body, cap, |v| body.rest_position(v));
        let linear = energies(body, cap, |v| match means.get(&v) {
            Some(&mean) => mean,
            None => body.rest_position(v),
        });
        assert!(
            smooth[0] <= linear[0] * (1.0 + 1e-6),
            "{smooth:?} {linear:?}"
        );
        assert!(smooth[1] < 0.5 * linear[1], "{smooth:?} {linear:?}");
    }
    // The two sides have the same rest positions at the same places.
    let of = |cap: &[TriangleId]| -> BTreeSet<([u32; 3], [u32; 3])> {
        let corners = cap.iter().flat_map(|&t| body.topology().triangle(t));
        let bits = |v: VertexId| {
            let [x, y, z, _] = body.positions()[v.index()].map(f32::to_bits);
            (
                [x, y, z],
                body.rest_positions()[v.index()].map(f32::to_bits),
            )
        };
        corners.map(bits).collect()
    };
    assert!(of(lower) == of(upper), "the sides differ at rest");
    // None is outside of the rim's.
    let corners = outcome
        .cap
        .iter()
        .flat_map(|&t| body.topology().triangle(t));
    let rim: BTreeSet<_> = corners.filter(|v| !means.contains_key(v)).collect();
    for k in 0..3 {
        let along = rim.iter().map(|v| body.rest_positions()[v.index()][k]);
        let (low, high) = along.fold((f32::MAX, f32::MIN), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        for v in means.keys() {
            let x = body.rest_positions()[v.index()][k];
            assert!(
                low <= x && x <= high,
                "{v} is at {x}, the rim {low} to {high}"
            );
        }
    }
}

#[test]
fn the_rest_shape_of_a_bent_body_has_no_creases() {
    for normal in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.3, 0.7, 0.6]] {
        let mut body = moved(icosphere(4, 0.5), bent);
        let before = body.clone();
        let sweep = Sweep::from_plane(normal, 0.03, &body.bounds()).unwrap();
        let outcome = cut(&mut body, &sweep);
        assert_smooth(&body, &outcome);
        outcome.undo.unwrap().revert(&mut body).unwrap();
        assert_eq!(body, before, "all is undone");
    }
}

/// A sheet with a crease, through a body that has one nowhere.
#[test]
fn a_bent_sweep_through_a_bent_body_leaves_smooth_halves() {
    let mut body = moved(icosphere(4, 0.5), bent);
    let sweep = Sweep::new(
        [[-2.0, 0.02, -2.0], [2.0, 0.02, -2.0]],
        [[-2.0, -0.7, 2.0], [2.0, 0.02, 2.0]],
    );
    let outcome = cut(&mut body, &sweep.unwrap());
    assert_smooth(&body, &outcome);
}

/// A body that was turned and carried away is cut as one at rest: the cap is the plane that it is.
#[test]
fn in_a_body_that_was_turned_the_cap_is_flat_at_rest() {
    let (sin, cos) = 0.7_f64.sin_cos();
    let turn = |p: Vec3| {
        Vec3::new(
            cos * p.x - sin * p.z + 0.3,
            p.y - 0.2,
            sin * p.x + cos * p.z + 0.1,
        )
    };
    let back = |p: Vec3| {
        let (x, z) = (p.x - 0.3, p.z - 0.1);
        Vec3::new(cos * x + sin * z, p.y + 0.2, cos * z - sin * x)
    };
    let mut body = moved(icosphere(4, 0.5), turn);
    let sweep = Sweep::from_plane([0.3, 0.7, 0.6], 0.03, &body.bounds()).unwrap();
    let outcome = cut(&mut body, &sweep);
    let means = means(&body, &outcome);
    assert!(!means.is_empty(), "there are inner vertices");
    for (&v, &mean) in &means {
        assert_eq!(
            body.rest_positions()[v.index()],
            to_f32(mean),
            "{v} is its parents' mean"
        );
        let off = (body.rest_position(v) - back(body.position(v))).amax();
        assert!(off < 1e-6, "{v} is {off} from where it was at rest");
    }
}
