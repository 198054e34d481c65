//! Incisions that leave a body open: [`Caps::None`].

use crate::common::{check_manifold, params, shortest_edge};
use incise_cut::{Caps, CutParams, Cutter, Incision, IncisionState};
use incise_mesh::{Surface, cube_sphere, icosphere};

/// Slices a body in steps along x and returns it.
fn slice(whole: &Surface, speed: f32) -> Surface {
    let mut body = whole.clone();
    let mut cutter = Cutter::new(&body);
    let mut incision = Incision::default();
    let params = CutParams {
        caps: Caps::None,
        ..params(0.1)
    };
    let mut x = -1.8;
    let mut has_finished = false;
    while x <= 1.8 {
        let pose = [-2.0, 2.0].map(|z| [x, 0.1 + 0.05 * x, z]);
        let _ = cutter
            .advance(&mut body, &mut incision, &pose, &params)
            .unwrap_or_else(|error| panic!("speed {speed} x {x}: {error}"));
        has_finished |= incision.state() == IncisionState::Finished;
        x += speed;
    }
    assert!(has_finished, "speed {speed}");
    body
}

/// Between the two tips in the skin the body is open, and the sweep must not turn back there.
#[test]
fn slow_slices_part_a_body() {
    for (name, whole) in [
        ("icosphere", icosphere(3, 1.0)),
        ("cube", cube_sphere(8, 1.0)),
    ] {
        for speed in [0.02, 0.05, 0.15, 0.4] {
            let body = slice(&whole, speed);
            assert_eq!(body.piece_count(), 2, "{name} speed {speed}");
            assert_eq!(check_manifold(&body), 2, "{name} speed {speed}: two discs");
            let shortest = shortest_edge(&body);
            assert!(shortest > 0.0, "{name} speed {speed}: {shortest}");
        }
    }
}
