//! Cuts along a sweep that cut the surface before, and along faces that are flush with it.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Surface, Vec3, cube_sphere, icosphere, torus};
use incise_refine::{RefineParams, RefinementLevel};
use std::collections::BTreeMap;

/// Directions of test planes, none along an axis.
const NORMALS: [[f64; 3]; 3] = [[0.3, 0.7, 0.6], [-0.8, 0.1, 0.5], [0.05, -0.2, 1.0]];

fn params(snap: f64, remesh: f64, level: RefinementLevel) -> CutParams {
    CutParams {
        snap,
        remesh,
        refine: RefineParams {
            level,
            ..RefineParams::default()
        },
        ..CutParams::default()
    }
}

/// Returns parameters with and without snapping, remeshing and refined caps.
fn all_params() -> Vec<CutParams> {
    let levels = [RefinementLevel::Original, RefinementLevel::Z(1e3)];
    let methods = [(0.0, 0.0), (0.1, 0.0), (0.1, 0.2)];
    (levels.into_iter())
        .flat_map(|level| methods.map(|(snap, remesh)| params(snap, remesh, level)))
        .collect()
}

/// Returns the closed surface of the unit cells that are solid, with their corners at `place`.
fn voxels(
    size: [usize; 3],
    is_solid: impl Fn([usize; 3]) -> bool,
    place: impl Fn(Vec3) -> [f32; 3],
) -> Surface {
    let is_solid = |cell: [Option<usize>; 3]| match cell {
        [Some(x), Some(y), Some(z)] if (0..3).all(|k| cell[k] < Some(size[k])) => {
            is_solid([x, y, z])
        }
        _ => false,
    };
    let (mut ids, mut positions, mut faces) = (BTreeMap::new(), Vec::new(), Vec::new());
    for i in 0..size[0] * size[1] * size[2] {
        let cell = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
        for (k, up) in (0..3).flat_map(|k| [(k, false), (k, true)]) {
            let mut beside = cell.map(Some);
            beside[k] = if up {
                Some(cell[k] + 1)
            } else {
                cell[k].checked_sub(1)
            };
            if !is_solid(cell.map(Some)) || is_solid(beside) {
                continue;
            }
            let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| {
                let mut corner = cell;
                corner[k] += usize::from(up);
                corner[(k + 1) % 3] += u;
                corner[(k + 2) % 3] += v;
                *ids.entry(corner).or_insert_with(|| {
                    positions.push(place(Vec3::from(corner.map(|x| x as f64))));
                    u32::try_from(positions.len() - 1).unwrap()
                })
            });
            if !up {
                quad.reverse();
            }
            let [a, b, c, d] = quad;
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Surface::from_triangles(&positions, &faces).unwrap()
}

fn to_f32(p: Vec3) -> [f32; 3] {
    incise_mesh::geometry::to_f32(p)
}

/// A plate with 16 square holes.
fn plate() -> Surface {
    let is_solid = |[x, y, _]: [usize; 3]| x % 2 == 0 || y % 2 == 0;
    voxels([9, 9, 2], is_solid, |p| to_f32(p / 9.0 - Vec3::repeat(0.5)))
}

/// A ball with a cavity.
fn hollow_ball() -> Surface {
    let (outer, inner) = (icosphere(3, 0.5), icosphere(2, 0.3));
    let mut positions = outer.rest_positions().to_vec();
    let count = u32::try_from(positions.len()).unwrap();
    positions.extend(inner.rest_positions());
    let (outer, inner) = (outer.topology(), inner.topology());
    let mut faces: Vec<[u32; 3]> = (outer.triangles())
        .map(|t| outer.triangle(t).map(|v| v.0))
        .collect();
    faces.extend(inner.triangles().map(|t| {
        let [a, b, c] = inner.triangle(t).map(|v| v.0 + count);
        [a, c, b]
    }));
    Surface::from_triangles(&positions, &faces).unwrap()
}

fn bodies() -> [(&'static str, Surface); 5] {
    [
        ("ball", icosphere(3, 0.5)),
        ("torus", torus(0.35, 0.15, 36, 18)),
        ("cube", cube_sphere(8, 0.5)),
        ("plate", plate()),
        ("hollow ball", hollow_ball()),
    ]
}

/// Returns the plane through the center of a box, shifted by a part of its diagonal and turned.
fn plane(surface: &Surface, normal: Vec3, shift: f64) -> Sweep {
    let bounds = surface.bounds();
    let n = normal.normalize();
    let d = n.dot(&bounds.center()) + shift * bounds.diagonal();
    Sweep::from_plane(n.into(), d, &bounds).unwrap()
}

/// Returns a plane again, turned by 1e-6 about its place in the body and moved by 1e-7 of the
/// body's size.
fn nearly(surface: &Surface, normal: Vec3, shift: f64) -> Vec<Sweep> {
    let n = normal.normalize();
    let side = n.cross(&Vec3::x()).normalize();
    let turns = [side, -side, n.cross(&side)].map(|u| plane(surface, n + u * 1e-6, shift));
    let moves = [1e-7, -1e-7].map(|by| plane(surface, n, shift + by));
    [vec![plane(surface, n, shift)], turns.into(), moves.into()].concat()
}

fn assert_closed(surface: &Surface) {
    surface.topology().validate().unwrap();
    assert!(surface.topology().is_closed(), "the surface is open");
}

/// Asserts that `sweeps` change nothing.
fn assert_misses(surface: &Surface, sweeps: &[Sweep], params: &CutParams, what: &str) {
    let mut cutter = Cutter::new(surface);
    let mut again = surface.clone();
    for (i, sweep) in sweeps.iter().enumerate() {
        let outcome = cutter.cut(&mut again, sweep, params);
        let outcome = outcome.unwrap_or_else(|e| panic!("{what}, sweep {i}: {e}"));
        assert!(outcome.is_miss(), "{what}, sweep {i} cuts again");
    }
    assert_eq!(&again, surface, "{what} changes the surface");
}

#[test]
fn a_second_cut_along_a_plane_changes_nothing() {
    for (name, whole) in bodies() {
        for params in all_params() {
            for (normal, shift) in NORMALS.into_iter().zip([0.01, -0.1, 0.004]) {
                let what = format!("{name}, {params:?}, {normal:?}");
                let normal = Vec3::from(normal);
                let mut body = whole.clone();
                let sweep = plane(&whole, normal, shift);
                let mut cutter = Cutter::new(&body);
                let outcome = cutter.cut(&mut body, &sweep, &params).unwrap();
                assert!(!outcome.is_miss(), "{what}");
                assert_closed(&body);
                let mut sweeps = vec![sweep; 5];
                sweeps.extend(nearly(&whole, normal, shift));
                assert_misses(&body, &sweeps, &params, &what);
                for (piece, part) in body.extract_pieces() {
                    assert_misses(&part, &sweeps, &params, &format!("{what}, piece {piece}"));
                }
            }
        }
    }
}

#[test]
fn a_hundred_cuts_along_a_plane_are_one() {
    let params = CutParams::default();
    for (name, mut body) in bodies() {
        let normal = Vec3::from(NORMALS[0]);
        let sweep = plane(&body, normal, 0.01);
        let outcome = Cutter::new(&body).cut(&mut body, &sweep, &params);
        assert!(!outcome.unwrap().is_miss(), "{name}");
        assert_misses(&body, &vec![sweep; 99], &params, name);
    }
}

#[test]
fn a_second_cut_along_a_bent_sweep_changes_nothing() {
    for (name, whole) in bodies() {
        for params in all_params() {
            for bend in [-0.7, -0.2, 0.01, 0.3, 0.8] {
                let mut body = whole.clone();
                let sweep = Sweep::new(
                    [[-1.0, 0.02, -1.0], [1.0, 0.02, -1.0]],
                    [[-1.0, bend, 1.0], [1.0, 0.02, 1.0]],
                );
                let sweep = sweep.unwrap();
                let outcome = Cutter::new(&body).cut(&mut body, &sweep, &params);
                // The plate does not reach up to all sweeps.
                assert!(!outcome.unwrap().is_miss() || name == "plate", "{name}");
                assert_misses(
                    &body,
                    &vec![sweep; 4],
                    &params,
                    &format!("{name}, {params:?}"),
                );
            }
        }
    }
}

#[test]
fn a_second_cut_changes_nothing_at_any_scale_and_off_the_origin() {
    let params = params(0.1, 0.0, RefinementLevel::Original);
    for (scale, shift) in [
        (1e-20, 0.0),
        (1e-6, 0.0),
        (1e15, 0.0),
        (1.0, 10.0),
        (1.0, 1000.0),
    ] {
        for (name, mut body) in bodies() {
            for p in body.positions_mut() {
                (0..3).for_each(|k| p[k] *= scale);
                p[0] += shift;
            }
            let what = format!("{name} times {scale} at {shift}");
            let normal = Vec3::from(NORMALS[0]);
            let sweeps = nearly(&body, normal, 0.01);
            let outcome = Cutter::new(&body).cut(&mut body, &sweeps[0], &params);
            assert!(!outcome.unwrap().is_miss(), "{what}");
            assert_misses(&body, &sweeps, &params, &what);
        }
    }
}

/// At 1e6 the coordinates of a body of size 1 are multiples of 1/16.
#[test]
fn a_body_few_roundings_long_is_still_cut() {
    for (name, mut body) in bodies() {
        body.positions_mut().iter_mut().for_each(|p| p[0] += 1e6);
        for normal in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.1], [0.6, 0.7, 0.5]] {
            let mut body = body.clone();
            let sweep = plane(&body, Vec3::from(normal), 0.01);
            let outcome = Cutter::new(&body).cut(&mut body, &sweep, &CutParams::default());
            assert!(!outcome.unwrap().is_miss(), "{name} along {normal:?}");
            assert_closed(&body);
        }
    }
}

/// A slice is cut off a cube unless it is thinner than some roundings.
#[test]
fn thin_slices_are_cut() {
    let whole = cube_sphere(8, 0.5);
    let top = f64::from(whole.bounds().max[1]);
    for (depth, is_cut) in [
        (1e-2, true),
        (1e-4, true),
        (1e-5, true),
        (1e-7, false),
        (0.0, false),
    ] {
        for side in [1.0, -1.0] {
            let mut body = whole.clone();
            let sweep = Sweep::from_plane([0.0, side, 0.0], side * (top - depth), &body.bounds());
            let params = params(0.0, 0.0, RefinementLevel::Original);
            let outcome = Cutter::new(&body).cut(&mut body, &sweep.unwrap(), &params);
            assert_eq!(!outcome.unwrap().is_miss(), is_cut, "{depth} below the top");
        }
    }
}

/// A plate as thick as the rounding of its coordinates is cut across and not in its plane.
#[test]
fn a_plate_within_rounding_is_not_cut_in_its_plane() {
    let thickness = 4.0 * f64::from(f32::EPSILON);
    let place = |p: Vec3| to_f32(Vec3::new(p.x / 8.0, p.y / 8.0, 1.0 + p.z * thickness));
    let plate = voxels([8, 8, 1], |_| true, place);
    let bounds = plate.bounds();
    for side in [1.0, -1.0] {
        let d = side * (1.0 + thickness / 2.0);
        let sweep = Sweep::from_plane([0.0, 0.0, side], d, &bounds).unwrap();
        assert_misses(&plate, &[sweep], &CutParams::default(), "in its plane");
        let mut body = plate.clone();
        let sweep = Sweep::from_plane([side, 0.1, 0.0], side * 0.3, &bounds).unwrap();
        let outcome = Cutter::new(&body).cut(&mut body, &sweep, &CutParams::default());
        assert!(!outcome.unwrap().is_miss(), "across");
        assert_closed(&body);
    }
}

/// Bodies of two layers of unit cells with faces flush with the plane z = 1 between them.
type Layers = (&'static str, [usize; 3], fn([usize; 3]) -> bool);

fn layers() -> [Layers; 5] {
    [
        ("a step", [2, 1, 2], |[x, _, z]| x == 0 || z == 0),
        ("a hat", [5, 5, 2], |[x, y, z]| {
            z == 0 || (1..4).contains(&x) && (1..4).contains(&y)
        }),
        ("a hat upside down", [5, 5, 2], |[x, y, z]| {
            z == 1 || (1..4).contains(&x) && (1..4).contains(&y)
        }),
        ("a table", [5, 5, 2], |[x, y, z]| {
            z == 1 || x % 4 == 0 && y % 4 == 0
        }),
        ("a ring on a plate with a hole", [7, 7, 2], |[x, y, z]| {
            let from_middle = x.abs_diff(3).max(y.abs_diff(3));
            if z == 0 {
                from_middle > 0
            } else {
                from_middle == 2
            }
        }),
    ]
}

/// What stands on a flush face is cut off whole, without pieces of rounding, however the face's
/// vertices are rounded.
#[test]
fn what_stands_on_a_flush_face_is_cut_off() {
    for (name, size, is_solid) in layers() {
        let cells =
            |z| (0..size[0] * size[1]).filter(move |i| is_solid([i % size[0], i / size[0], z]));
        let halves = [0, 1].map(|z| cells(z).count() as f64);
        for seed in 0..60_u32 {
            // Rounding up and down at random, and by a turn.
            let turn = rotation(if seed % 2 == 0 { 0.0 } else { f64::from(seed) });
            let place = |p: Vec3| {
                let mut q = p;
                if seed % 2 == 0 && p.z == 1.0 {
                    let hash = (p.x * 7.0 + p.y * 13.0 + 1.0) * f64::from(seed + 1) * 0.618_034;
                    q.z += (hash.fract() * 4.0 - 2.0).round() * f64::from(f32::EPSILON);
                }
                to_f32(turn(q))
            };
            let whole = voxels(size, is_solid, place);
            let normal = turn(Vec3::z());
            for side in [1.0, -1.0] {
                for snap in [0.0, 0.1] {
                    let what = format!("{name}, seed {seed}, side {side}, snap {snap}");
                    let mut body = whole.clone();
                    let params = params(snap, 0.0, RefinementLevel::Original);
                    let sweep = Sweep::from_plane((normal * side).into(), side, &body.bounds());
                    let sweep = sweep.unwrap();
                    let outcome = Cutter::new(&body).cut(&mut body, &sweep, &params);
                    assert!(!outcome.unwrap().is_miss(), "{what}");
                    assert_closed(&body);
                    let mut volumes = body.piece_volumes();
                    volumes.sort_unstable_by(f64::total_cmp);
                    // Legs may stay joined by the flush face, which has no volume.
                    assert!(volumes[0] > 0.5, "{what}: {volumes:?}");
                    let bound = if snap == 0.0 { 1e-5 } else { 2e-3 };
                    for found in [volumes.pop().unwrap(), volumes.iter().sum()] {
                        let error = |v: &f64| (found - v).abs() / v;
                        assert!(
                            halves.iter().map(error).fold(1.0, f64::min) < bound,
                            "{what}: {found}"
                        );
                    }
                    assert_misses(&body, &vec![sweep; 3], &params, &what);
                }
            }
        }
    }
}

/// Returns a rotation by multiples of an angle about two axes.
fn rotation(angle: f64) -> impl Fn(Vec3) -> Vec3 {
    let (s, c) = angle.sin_cos();
    let (t, d) = (0.7 * angle).sin_cos();
    move |p: Vec3| {
        let p = Vec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
        Vec3::new(p.x, d * p.y - t * p.z, t * p.y + d * p.z)
    }
}

/// The plane of a cap is cut where it meets another part of the body.
#[test]
fn a_cap_does_not_keep_its_plane_from_cutting_elsewhere() {
    // Two legs under a bar.
    let is_solid = |[x, _, z]: [usize; 3]| z == 2 || x != 1;
    let place = |p: Vec3| to_f32(Vec3::new(p.x, p.y, p.z + 0.01 * p.x - 0.03 * p.y));
    let whole = voxels([3, 1, 3], is_solid, place);
    for params in all_params() {
        let mut body = whole.clone();
        let mut cutter = Cutter::new(&body);
        let across = |to: f32| {
            let at = |x: f32, y: f32| [x, y, 1.1 + 0.03 * x + 0.07 * y];
            Sweep::new([at(-0.5, -1.0), at(-0.5, 2.0)], [at(to, -1.0), at(to, 2.0)]).unwrap()
        };
        for (to, pieces) in [(1.5, 2), (1.5, 2), (3.5, 3), (3.5, 3)] {
            let outcome = cutter.cut(&mut body, &across(to), &params);
            let _ = outcome.unwrap();
            assert_closed(&body);
            assert_eq!(body.extract_pieces().count(), pieces, "to {to}");
        }
    }
}

/// A sweep between the two caps of a cut that ends there touches both and is no partial cut.
#[test]
fn a_sweep_that_ends_between_two_caps_is_a_miss() {
    for (name, whole) in bodies() {
        for params in all_params() {
            for (i, normal) in NORMALS.into_iter().enumerate() {
                let what = format!("{name}, {params:?}, {normal:?}");
                let n = Vec3::from(normal).normalize();
                let d = n.dot(&whole.bounds().center()) + 0.01;
                let mut body = whole.clone();
                let sweep = Sweep::from_plane(n.into(), d, &body.bounds()).unwrap();
                let outcome = Cutter::new(&body).cut(&mut body, &sweep, &params);
                assert!(!outcome.unwrap().is_miss(), "{what}");
                let u = n.cross(&Vec3::x()).normalize();
                let v = n.cross(&u);
                let at = |x: f64, y: f64| to_f32(n * d + u * x + v * y);
                // One ends along a line through the caps, one in a corner.
                let parts = [[-1.0, -1.0, 0.1, 1.0], [-1.0, -1.0, 0.2, 0.1]];
                let parts = parts.map(|[x, y, to_x, to_y]| {
                    Sweep::new([at(x, y), at(x, to_y)], [at(to_x, y), at(to_x, to_y)]).unwrap()
                });
                assert_misses(&body, &parts, &params, &what);
                // Away from the caps it ends inside the body.
                let n = n * if i % 2 == 0 { 1.0 } else { -1.0 };
                let off = |x: f64, y: f64| to_f32(n * (d + 0.005) + u * x + v * y);
                let part = Sweep::new(
                    [off(-1.0, -1.0), off(-1.0, 1.0)],
                    [off(0.01, -1.0), off(0.01, 1.0)],
                );
                let result = Cutter::new(&body).cut(&mut body, &part.unwrap(), &params);
                let is_partial = matches!(result, Err(incise_cut::CutError::PartialCut { .. }));
                assert!(is_partial || name != "ball", "{what}");
            }
        }
    }
}

#[test]
fn textures_of_caps_have_the_stated_scale_also_after_cuts_of_cuts() {
    for scale in [0.25, 1.0, 2.5] {
        let mut body = icosphere(4, 0.5);
        let corners = 3 * body.topology().triangle_slots();
        body.set_corner_uvs(vec![[0.5; 2]; corners]).unwrap();
        // Snapping moves rim vertices of earlier caps along the skin, out of the plane of the cap.
        let params = CutParams {
            cap_uv_scale: scale,
            ..params(0.0, 0.0, RefinementLevel::Original)
        };
        let mut cutter = Cutter::new(&body);
        for (normal, d) in NORMALS.into_iter().zip([0.1, -0.05, 0.12]) {
            let sweep = Sweep::from_plane(normal, d, &body.bounds()).unwrap();
            let outcome = cutter.cut(&mut body, &sweep, &params).unwrap();
            assert!(!outcome.is_miss());
        }
        let mut caps = 0;
        for t in body
            .topology()
            .triangles()
            .filter(|&t| body.material(t) == 1)
        {
            caps += 1;
            let points = body.triangle_positions(t);
            let uvs = t.half_edges().map(|h| body.corner_uvs()[h.index()]);
            for [i, j] in [[0, 1], [1, 2], [2, 0]] {
                let length = (points[j] - points[i]).norm();
                let chart = [0, 1].map(|k| f64::from(uvs[j][k]) - f64::from(uvs[i][k]));
                let chart = chart[0].hypot(chart[1]);
                assert!(
                    (chart - scale * length).abs() < 2e-6,
                    "{length} m has the length {chart} at {scale} per m"
                );
            }
        }
        assert!(caps > 1000, "{caps} triangles on caps");
    }
}
