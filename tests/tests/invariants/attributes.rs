//! A thousand cuts of a skinned, colored and textured body, and the undo of all of them.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::{Blend, Channel, Domain, Surface, TriangleId, VertexId};
use incise_models::{Model, build_model};
use incise_tests::assert_same_bits;

const CUTS: usize = 1000;

/// Steps of directions, which fill a cube evenly: powers of the inverse of a number whose fourth
/// power is itself plus one.
const STEPS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];

/// Returns a banana with texture, colors on corners, and four joints with weights per vertex.
fn dressed() -> Surface {
    let mut surface = build_model(Model::Banana);
    let slots = surface.topology().vertex_slots();
    let weights = (0..slots).flat_map(|i| {
        let share = move |joint: usize| 1.0 + ((i * (7 + joint)) % 13) as f32;
        let total: f32 = (0..4).map(share).sum();
        let joints = (0..4).map(move |joint| ((i / 50 + 3 * joint) % 20) as f32);
        joints.chain((0..4).map(move |joint| share(joint) / total))
    });
    let skin = Channel::new("skin", Domain::Vertex, Blend::Skin, 8, weights.collect());
    surface.set_channel(skin.unwrap()).unwrap();
    let corners = surface.topology().triangle_slots() * 3;
    let color = (0..4 * corners).map(|i| ((i * 37) % 256) as f32 / 255.0);
    let color = Channel::new("color", Domain::Corner, Blend::Linear, 4, color.collect());
    surface.set_channel(color.unwrap()).unwrap();
    assert!(!surface.corner_uvs().is_empty(), "the model has a texture");
    surface
}

/// Checks that weights sum to 1, colors lie between 0 and 1, and both sides of the cut are alike.
fn check(surface: &Surface, cap: &[TriangleId]) {
    let topology = surface.topology();
    let skin = surface.channel("skin").unwrap();
    for v in topology.vertices() {
        let (joints, weights) = skin.row(v.index()).split_at(4);
        let sum: f64 = weights.iter().map(|&w| f64::from(w)).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{v}: weights sum to {sum}");
        assert!(joints.iter().all(|j| j.fract() == 0.0 && *j < 20.0), "{v}");
    }
    let color = surface.channel("color").unwrap();
    for h in topology.triangles().flat_map(TriangleId::half_edges) {
        let row = color.row(h.index());
        assert!(row.iter().all(|c| (0.0..=1.0).contains(c)), "{h}: {row:?}");
    }
    let (below, above) = cap.split_at(cap.len() / 2);
    for (&a, &b) in below.iter().zip(above) {
        let corners = |t: TriangleId| topology.triangle(t);
        let ([a, b, c], [d, e, f]) = (corners(a), corners(b));
        for (v, w) in [(a, d), (b, f), (c, e)] {
            let row = |v: VertexId| skin.row(v.index());
            assert_eq!(row(v), row(w), "{v} and {w}");
        }
    }
}

#[test]
fn a_thousand_cuts_of_a_dressed_body_are_undone_to_the_bit() {
    let whole = dressed();
    let mut surface = whole.clone();
    let mut cutter = Cutter::new(&surface);
    let mut undos = Vec::new();
    for i in 1.. {
        if undos.len() == CUTS {
            break;
        }
        assert!(i < CUTS * 11 / 10, "{} cuts of {i}", undos.len());
        let normal = STEPS.map(|step| (i as f64 * step).fract() - 0.5);
        let pieces: Vec<u32> = (0..surface.piece_bound())
            .filter(|&piece| surface.piece_triangles(piece) > 0)
            .collect();
        // The largest piece of a few, so that pieces stay large enough to be cut.
        let candidates = (0..8).map(|k| pieces[(17 * i + 101 * k) % pieces.len()]);
        let piece = candidates
            .max_by_key(|&p| (surface.piece_triangles(p), p))
            .unwrap();
        let part = surface.extract_piece(piece);
        let center = part.bounds().center();
        let d = (0..3).map(|k| normal[k] * center[k]).sum();
        let params = CutParams {
            only_piece: Some(piece),
            ..CutParams::default()
        };
        let sweep = Sweep::from_plane(normal, d, &part.bounds()).unwrap();
        // A few touch the cap of an earlier one, and are refused.
        let Ok(outcome) = cutter.cut(&mut surface, &sweep, &params) else {
            continue;
        };
        if undos.len() % 50 == 0 {
            check(&surface, &outcome.cap);
        }
        undos.extend(outcome.undo);
    }
    surface.validate_closed().unwrap();
    check(&surface, &[]);
    while let Some(undo) = undos.pop() {
        cutter.undo(&mut surface, undo).unwrap();
    }
    assert_same_bits(&surface, &whole);
    assert_eq!(surface, whole, "and everything else");
}
