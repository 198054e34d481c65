//! Sheets: surfaces with a boundary, which are slit without walls.

use crate::common::{check, check_manifold, params};
use incise_cut::{Caps, CutError, CutOutcome, CutParams, Cutter, Incision, Sweep};
use incise_mesh::geometry::area_vector;
use incise_mesh::{Surface, TriangleId, icosphere, sheet, torus};
use proptest::prelude::*;

fn area(surface: &Surface) -> f64 {
    let area = |t: TriangleId| area_vector(surface.triangle_positions(t)).norm() / 2.0;
    surface.topology().triangles().map(area).sum()
}

/// Cuts a copy of a sheet, checks everything that holds for any cut and undoes it.
fn incise(whole: &Surface, sweep: &Sweep, snap: f64) -> (Surface, CutOutcome) {
    let mut surface = whole.clone();
    let mut cutter = Cutter::new(&surface);
    let outcome = cutter.incise(&mut surface, sweep, &params(snap)).unwrap();
    check_manifold(&surface);
    cutter.bvh().validate(&surface).unwrap();
    assert!(outcome.cap.is_empty(), "sheets have no walls");
    if let Some(undo) = outcome.undo.clone() {
        let mut undone = surface.clone();
        undo.revert(&mut undone).unwrap();
        assert_eq!(undone, *whole, "the undo restores every bit");
    }
    (surface, outcome)
}

fn upright(from: [f32; 2], to: [f32; 2]) -> Sweep {
    let pose = |[x, y]: [f32; 2]| [[x, y, -1.0], [x, y, 1.0]];
    Sweep::new(pose(from), pose(to)).unwrap()
}

#[test]
fn a_cut_from_border_to_border_makes_two_sheets() {
    let whole = sheet([1.0, 1.0], [17, 13]);
    for snap in [0.0, 0.1] {
        let (cut, outcome) = incise(&whole, &upright([-0.7, 0.03], [0.7, 0.11]), snap);
        assert_eq!((outcome.report.loops, outcome.report.slits), (1, 0));
        assert_eq!((cut.piece_count(), check_manifold(&cut)), (2, 2));
        assert!((area(&cut) - 1.0).abs() < 1e-6);
        assert_eq!(cut.open_pieces(), [true, true]);
    }
    let mut cut = whole.clone();
    let sweep = upright([-0.7, 0.03], [0.7, 0.11]);
    let _ = Cutter::new(&cut)
        .cut(&mut cut, &sweep, &params(0.1))
        .unwrap();
    assert_eq!(cut.piece_count(), 2, "a full slice");
}

#[test]
fn a_slit_shares_its_ends() {
    let whole = sheet([1.0, 1.0], [17, 13]);
    for snap in [0.0, 0.1] {
        let (inside, outcome) = incise(&whole, &upright([-0.3, 0.03], [0.2, 0.11]), snap);
        assert_eq!((outcome.report.loops, outcome.report.slits), (0, 1));
        assert_eq!(
            (inside.piece_count(), check_manifold(&inside)),
            (1, 0),
            "a hole"
        );
        let (border, outcome) = incise(&whole, &upright([0.7, 0.03], [0.2, 0.11]), snap);
        assert_eq!((outcome.report.loops, outcome.report.slits), (0, 1));
        assert_eq!(
            (border.piece_count(), check_manifold(&border)),
            (1, 1),
            "a notch"
        );
    }
    let mut surface = whole.clone();
    let sweep = upright([-0.3, 0.03], [0.2, 0.11]);
    let refused = Cutter::new(&surface).cut(&mut surface, &sweep, &params(0.1));
    assert!(
        matches!(refused, Err(CutError::PartialCut { .. })),
        "{refused:?}"
    );
    assert_eq!(surface, whole);
}

#[test]
fn a_blade_in_steps_cuts_a_sheet_in_two() {
    for steps in [1u8, 2, 3, 7, 20, 64] {
        let mut surface = sheet([1.0, 1.0], [31, 23]);
        let mut cutter = Cutter::new(&surface);
        let mut incision = Incision::default();
        for i in 0..=steps {
            let s = f32::from(i) / f32::from(steps);
            let pose = [
                [-0.7 + 1.4 * s, 0.03 + 0.1 * s, -1.0],
                [-0.7 + 1.4 * s, 0.02, 1.0],
            ];
            let outcome = cutter.advance(&mut surface, &mut incision, &pose, &params(0.1));
            let _ = outcome.unwrap_or_else(|error| panic!("step {i} of {steps}: {error}"));
            // Motions of less than half an edge add up.
            let x = pose[0][0].abs();
            assert!(incision.is_inside() || x > 0.47, "step {i} of {steps}");
            assert!(!incision.is_inside() || x < 0.53, "step {i} of {steps}");
            let discs = i64::try_from(surface.piece_count()).unwrap();
            assert_eq!(check_manifold(&surface), discs, "step {i} of {steps}");
        }
        assert_eq!(surface.piece_count(), 2, "{steps} steps");
        assert!((area(&surface) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn a_circle_in_steps_cuts_out_a_disc() {
    let mut surface = sheet([1.0, 1.0], [40, 40]);
    let mut cutter = Cutter::new(&surface);
    let mut incision = Incision::default();
    for i in 0..=66u8 {
        let (sin, cos) = (f32::from(i) * std::f32::consts::TAU / 60.0).sin_cos();
        let pose = [[0.3 * cos, 0.3 * sin, -1.0], [0.31 * cos, 0.31 * sin, 1.0]];
        let outcome = cutter.advance(&mut surface, &mut incision, &pose, &params(0.1));
        let _ = outcome.unwrap_or_else(|error| panic!("step {i}: {error}"));
        check_manifold(&surface);
    }
    let mut areas = vec![0.0; surface.piece_bound() as usize];
    for t in surface.topology().triangles() {
        let own = area_vector(surface.triangle_positions(t)).norm() / 2.0;
        areas[surface.piece(t) as usize] += own;
    }
    areas.sort_by(|a, b| f64::total_cmp(b, a));
    let disc = std::f64::consts::PI * 0.305 * 0.305;
    assert!((areas[1] - disc).abs() < 0.02 * disc, "{areas:?}");
    // Behind its start the blade does not follow exactly the same chords again.
    assert!(areas[2..].iter().all(|&area| area < 1e-3), "{areas:?}");
}

/// Returns a sphere without the triangles below a height.
fn bowl(height: f32) -> Surface {
    let mut surface = icosphere(4, 0.5);
    let topology = surface.topology();
    let is_low = |t: &TriangleId| {
        let corners = topology.triangle(*t);
        corners
            .iter()
            .all(|v| surface.positions()[v.index()][1] < height)
    };
    let low: Vec<TriangleId> = topology.triangles().filter(is_low).collect();
    let unused = surface.remove_triangles(&low);
    surface.remove_vertices(&unused);
    surface.compact();
    surface
}

#[test]
fn caps_are_for_bodies_or_for_all_loops_or_for_none() {
    let sweep = Sweep::new(
        [[-1.0, 0.1, -1.0], [-1.0, 0.1, 1.0]],
        [[1.0, 0.12, -1.0], [1.0, 0.12, 1.0]],
    )
    .unwrap();
    let ball = icosphere(4, 0.5);
    for (whole, caps, open) in [
        (&ball, Caps::Bodies, [false, false]),
        (&ball, Caps::AllLoops, [false, false]),
        (&ball, Caps::None, [true, true]),
        (&bowl(-0.3), Caps::Bodies, [true, true]),
        (&bowl(-0.3), Caps::AllLoops, [true, false]),
        (&bowl(-0.3), Caps::None, [true, true]),
    ] {
        let mut surface = whole.clone();
        let mut cutter = Cutter::new(&surface);
        let params = CutParams {
            caps,
            ..params(0.1)
        };
        let outcome = cutter.cut(&mut surface, &sweep, &params).unwrap();
        check_manifold(&surface);
        let mut is_open = surface.open_pieces();
        is_open.sort_unstable();
        is_open.reverse();
        assert_eq!(is_open, open, "{caps:?}");
        if open == [false, false] {
            assert_eq!(check(&surface), 4, "two balls");
        }
        // The parts go on as sheets or as bodies.
        let again = upright([0.03, -1.0], [0.01, 1.0]);
        let second = cutter.cut(&mut surface, &again, &params).unwrap();
        check_manifold(&surface);
        assert_eq!(surface.piece_count(), 4, "{caps:?}");
        assert_eq!(second.cap.is_empty(), open[1]);
        for undo in [second.undo, outcome.undo] {
            let _ = cutter.undo(&mut surface, undo.unwrap()).unwrap();
        }
        assert_eq!(surface, *whole);
    }
}

/// Returns a sheet that is waved, so that a sweep crosses it in many curves.
fn waved(waves: f32, height: f32, cells: u32) -> Surface {
    let mut surface = sheet([1.0, 1.0], [cells, cells]);
    for p in surface.positions_mut() {
        p[2] = height * (waves * (p[0] + 0.3 * p[1])).sin();
    }
    surface
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]
    /// The Euler characteristic changes by one for each cut from border to border, by minus one
    /// for each slit with two ends inside, and no area is lost.
    #[test]
    fn any_sweep_cuts_any_sheet(
        corners in prop::array::uniform4(prop::array::uniform3(-0.8f32..0.8)),
        waves in 0.0f32..20.0,
        height in 0.0f32..0.3,
        snap in prop::sample::select(vec![0.0, 0.1]),
    ) {
        let whole = waved(waves, height, 12);
        let [a, b, c, d] = corners;
        let Ok(sweep) = Sweep::new([a, b], [c, d]) else { return Ok(()) };
        let (cut, outcome) = incise(&whole, &sweep, snap);
        let lost = (area(&cut) - area(&whole)).abs() / area(&whole);
        prop_assert!(lost < if snap == 0.0 { 1e-6 } else { 1e-2 }, "{lost}");
        if outcome.report.loops == 0 && outcome.report.slits == 0 {
            prop_assert_eq!(&cut, &whole);
        }
    }

    /// A blade that turns and moves at random through sheets and pieces of sheets.
    #[test]
    fn any_path_cuts_any_sheet(
        poses in prop::collection::vec(
            prop::array::uniform2(prop::array::uniform3(-0.2f32..0.2)), 2..12),
        waves in 0.0f32..10.0,
        height in 0.0f32..0.2,
    ) {
        let mut surface = waved(waves, height, 16);
        let before = area(&surface);
        let mut cutter = Cutter::new(&surface);
        let mut incision = Incision::default();
        for (i, [at, turn]) in (0u8..).zip(&poses) {
            let x = -0.8 + 1.6 * f32::from(i) / 11.0;
            let pose = [
                [x + at[0] + turn[0], at[1] + turn[1], -0.7],
                [x + at[0] - turn[0], at[1] - turn[1], 0.7],
            ];
            match cutter.advance(&mut surface, &mut incision, &pose, &params(0.0)) {
                Ok(_) => {}
                Err(CutError::TipBlocked { .. }) => incision.restart(&pose),
                Err(error) => panic!("step {i}: {error}"),
            }
            check_manifold(&surface);
        }
        prop_assert!((area(&surface) - before).abs() < 1e-5 * before);
    }
}

/// A slit inside one mesh triangle turns at a crease of the sweep, in front of the nearest corner.
#[test]
fn a_slit_that_turns_inside_a_triangle_loses_no_area() {
    let whole = waved(11.155_249, 0.155_450_02, 12);
    let from = [
        [0.046_805_89, -0.306_422_38, -0.048_243_28],
        [0.793_091, 0.0, 0.0],
    ];
    let to = [
        [0.652_810_8, 0.365_056_78, 0.0],
        [0.676_451_1, 0.0, 0.321_679_35],
    ];
    let (cut, _) = incise(&whole, &Sweep::new(from, to).unwrap(), 0.0);
    let lost = (area(&cut) - area(&whole)).abs() / area(&whole);
    assert!(lost < 1e-6, "{lost}");
}

#[test]
fn a_body_beside_a_sheet_keeps_its_caps() {
    let ball = torus(0.3, 0.1, 24, 12);
    let cloth = sheet([1.0, 1.0], [10, 10]);
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for part in [&ball, &cloth] {
        let first = u32::try_from(positions.len()).unwrap();
        positions.extend(part.positions().iter().map(|p| [p[0], p[1], p[2]]));
        let own = part.topology().triangles();
        faces.extend(own.map(|t| part.topology().triangle(t).map(|v| v.0 + first)));
    }
    let whole = Surface::from_triangles(&positions, &faces).unwrap();
    let mut surface = whole.clone();
    let mut cutter = Cutter::new(&surface);
    let sweep = upright([-0.9, 0.013], [0.9, 0.021]);
    let outcome = cutter.cut(&mut surface, &sweep, &params(0.1)).unwrap();
    check_manifold(&surface);
    assert!(!outcome.cap.is_empty());
    let open = surface.open_pieces();
    assert_eq!(open.iter().filter(|&&is_open| is_open).count(), 2);
    assert_eq!(open.len(), 4);
}

/// Checks that a cut left neither an edge without length nor a triangle without area.
fn check_sizes(surface: &Surface) {
    for t in surface.topology().triangles() {
        let [a, b, c] = surface.triangle_positions(t);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            assert!(
                (p - q).norm() > 1e-6,
                "{t} has an edge without length at {p:?}"
            );
        }
        assert!(
            area_vector([a, b, c]).norm() > 1e-7,
            "{t} has no area: {a:?} {b:?} {c:?}"
        );
    }
}

/// Planes along lines of the grid left six triangles without area.
#[test]
fn a_cut_along_a_line_of_the_grid_leaves_no_sliver() {
    for [width, height] in [[4u8, 3u8], [7, 5], [2, 8]] {
        for turn in [0.0, 0.3, std::f64::consts::FRAC_PI_4, 1.2, 2.0] {
            let (sin, cos) = f64::sin_cos(turn);
            let flat = sheet([1.0, 1.0], [u32::from(width), u32::from(height)]);
            let mut whole = flat.clone();
            let vertices: Vec<_> = flat.topology().vertices().collect();
            for v in vertices {
                let p = flat.position(v);
                let at = [cos * p.x - sin * p.y, sin * p.x + cos * p.y, 0.0];
                let [x, y, z] = incise_mesh::geometry::to_f32(at.into());
                whole.positions_mut()[v.index()] = [x, y, z, 1.0];
            }
            for k in 1..width {
                let d = f64::from(k) / f64::from(width) - 0.5;
                for sign in [1.0, -1.0] {
                    let normal = [sign * cos, sign * sin, 0.0];
                    let sweep = Sweep::from_plane(normal, sign * d, &whole.bounds()).unwrap();
                    let mut cut = whole.clone();
                    let outcome = Cutter::new(&cut)
                        .cut(&mut cut, &sweep, &params(0.1))
                        .unwrap();
                    assert_eq!((check_manifold(&cut), cut.piece_count()), (2, 2));
                    check_sizes(&cut);
                    // A turned line is crossed where its rounded vertices are on two sides.
                    let triangles = [&cut, &whole].map(|s| s.topology().triangle_count());
                    assert!(triangles[0] == triangles[1] || turn > 0.0, "{turn} {d}");
                    let mut areas = vec![0.0; cut.piece_bound() as usize];
                    for t in cut.topology().triangles() {
                        let own = area_vector(cut.triangle_positions(t)).norm() / 2.0;
                        areas[cut.piece(t) as usize] += own;
                    }
                    areas.sort_unstable_by(f64::total_cmp);
                    assert!(
                        (areas[1] - (0.5 + d.abs())).abs() < 1e-5,
                        "{areas:?} at {d}"
                    );
                    let undo = outcome.undo.unwrap();
                    undo.revert(&mut cut).unwrap();
                    assert_eq!(cut, whole, "the undo restores every bit");
                }
            }
        }
    }
}

/// A curve ends beside the tip of a slit, within rounding, and another one goes on from the tip.
#[test]
fn snapping_beside_a_tip_keeps_its_vertex() {
    let mut surface = sheet([2.0, 2.0], [16, 16]);
    let mut cutter = Cutter::new(&surface);
    let mut incision = Incision::default();
    let tops = [
        [0.643_652, 0.267_420_92, 0.501_320_1],
        [0.665_400_9, 0.120_219_83, 0.498_469_74],
        [0.252_883_67, 0.612_738_55, 0.430_698_7],
        [0.602_092, 0.365_665_7, 0.497_068_67],
        [0.654_245_9, 0.226_349, 0.501_554_55],
        [0.587_772_37, 0.210_870_74, 0.793_687_6],
    ];
    let bottoms = [
        [0.820_914_8, 0.308_696_27, -0.277_701_23],
        [0.842_663_7, 0.161_495_16, -0.280_551_6],
        [0.430_146_46, 0.654_013_9, -0.348_322_63],
        [0.779_354_8, 0.406_941_06, -0.281_952_68],
        [0.831_508_7, 0.267_624_32, -0.277_466_77],
        [0.765_035_15, 0.252_146_07, 0.014_666_22],
    ];
    for (bottom, top) in bottoms.into_iter().zip(tops) {
        let _ = cutter
            .advance(&mut surface, &mut incision, &[bottom, top], &params(0.1))
            .unwrap();
        check_manifold(&surface);
        cutter.bvh().validate(&surface).unwrap();
    }
}
