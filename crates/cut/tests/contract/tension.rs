//! Strokes through stretched bodies: slits that gape behind the blade, and skin in folds.

use crate::common::{check, params};
use incise_cut::{CutError, Cutter, Incision};
use incise_mesh::geometry::{area_vector, to_f32};
use incise_mesh::{HalfEdge, Surface, Vec3, VertexId, cube_sphere, icosphere};

/// A blade that moves through a body along a plane, whose sides move apart behind it.
#[derive(Debug, Clone, Copy)]
struct Gape {
    normal: Vec3,
    /// Place of the plane along its normal \[m\].
    height: f64,
    motion: Vec3,
    /// Displacement of each side \[m\], and the distance behind the blade at which it is reached.
    gap: f64,
    length: f64,
    steps: u32,
    snap: f64,
}

impl Gape {
    /// Returns 1 for a vertex above the plane, -1 below it, and 0 for one of the tip.
    ///
    /// Vertices of walls lie in the plane at rest. Their side is that of their triangles.
    fn side(&self, body: &Surface, v: VertexId) -> f64 {
        let topology = body.topology();
        let rest = |v: VertexId| body.rest_position(v);
        let height = |v: VertexId| self.normal.dot(&rest(v)) - self.height;
        let across = |h: HalfEdge| rest(topology.origin(h.prev()));
        let mut fan = topology.outgoing_fan(v);
        if fan.any(|h| across(h) == across(topology.twin(h))) {
            return 0.0;
        }
        let (mut off, mut facing) = (0.0, 0.0);
        for h in topology.outgoing_fan(v) {
            let corners = topology.triangle(h.triangle());
            off += corners.map(height).iter().sum::<f64>();
            facing -= self.normal.dot(&area_vector(corners.map(rest)));
        }
        if off.abs() > 1e-2 {
            off.signum()
        } else {
            facing.signum()
        }
    }

    /// Opens the slit behind the blade, which is at `front` along the motion.
    fn open(&self, body: &mut Surface, front: f64) {
        let vertices: Vec<VertexId> = body.topology().vertices().collect();
        for v in vertices {
            let rest = body.rest_position(v);
            let behind = front - self.motion.dot(&rest);
            let gap = self.gap * (behind / self.length).clamp(0.0, 1.0);
            let [x, y, z] = to_f32(rest + self.normal * (gap * self.side(body, v)));
            let weight = body.positions()[v.index()][3];
            body.positions_mut()[v.index()] = [x, y, z, weight];
        }
    }

    /// Moves the blade through a body; returns the refused steps.
    fn run(&self, body: &mut Surface) -> Vec<(u32, CutError)> {
        let across = self.normal.cross(&self.motion);
        let mut cutter = Cutter::new(body);
        let mut incision = Incision::default();
        let mut refused = Vec::new();
        for step in 0..=self.steps {
            let front = -1.3 + 2.6 * f64::from(step) / f64::from(self.steps);
            let at = self.normal * self.height + self.motion * front;
            let pose = [-1.5, 1.5].map(|end| to_f32(at + across * end));
            match cutter.advance(body, &mut incision, &pose, &params(self.snap)) {
                Ok(_) => {}
                Err(error) => refused.push((step, error)),
            }
            self.open(body, front);
            cutter.refit(body);
        }
        refused
    }
}

/// Returns numbers from -1 to 1.
fn random(seed: u32) -> impl FnMut() -> f64 {
    let mut state = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state =
            (state.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u16::try_from(state >> 48).unwrap()) / 32_768.0 - 1.0
    }
}

#[test]
fn a_slit_that_gapes_behind_the_blade_parts_the_body() {
    for seed in 0..60_u32 {
        let mut random = random(seed);
        let mut vector = || Vec3::new(random(), random(), random());
        let normal = vector().normalize();
        let motion = vector().cross(&normal).normalize();
        let gape = Gape {
            normal,
            height: 0.3 * random(),
            motion,
            gap: 0.2,
            length: 0.3,
            steps: [12, 24, 48, 100][seed as usize % 4],
            snap: [0.0, 0.1][seed as usize / 4 % 2],
        };
        let mut body = if seed % 3 == 0 {
            cube_sphere(6, 1.0)
        } else {
            icosphere(3, 1.0)
        };
        let whole = body.volume();
        let refused = gape.run(&mut body);
        check(&body);
        assert_eq!(refused, [], "{gape:?}");
        assert_eq!(body.piece_count(), 2, "{gape:?}");
        let volume = |piece: u32| {
            body.rest_volume_of((body.topology().triangles()).filter(|&t| body.piece(t) == piece))
        };
        let [first, second] = [0, 1].map(volume);
        assert!(
            first.min(second) > 0.02 * whole,
            "{gape:?}: {first} and {second}"
        );
        assert!(((first + second) / whole - 1.0).abs() < 1e-3, "{gape:?}");
    }
}

/// A stretched ball whose skin lies in folds parts at a blade across it.
///
/// In a fold, the blade pierces the skin in another order than at rest, or inside out. Three of 24
/// strokes have a refused step or not two pieces.
#[test]
fn a_blade_enters_through_folds_of_the_skin() {
    let mut failed = Vec::new();
    for seed in 0..24 {
        let mut random = random(seed);
        let (height, phase) = (0.3 * random(), 3.0 * random());
        let (size, waves) = (0.15 + 0.05 * random(), 12.0 + 4.0 * random());
        let mut body = icosphere(3, 1.0);
        let whole = body.volume();
        for p in body.positions_mut() {
            let [x, y, z] = [p[0], p[1], p[2]].map(f64::from);
            // A trochoid: with loops where the product of both numbers is above 0.6.
            let (sin, cos) = (waves * (z + 0.5 * x) + phase).sin_cos();
            let [y, z] = [0.6 * y + size * cos, 0.6 * z + size * sin];
            let [x, y, z] = to_f32(Vec3::new(1.5 * x, y, z));
            *p = [x, y, z, p[3]];
        }
        let mut cutter = Cutter::new(&body);
        let mut incision = Incision::default();
        let steps = [12, 24, 48][seed as usize % 3];
        let mut is_refused = false;
        for step in 0..=steps {
            let depth = -1.1 + 2.2 * f64::from(step) / f64::from(steps);
            let pose = [-2.0, 2.0].map(|z| to_f32(Vec3::new(height, depth, z)));
            let outcome = cutter.advance(&mut body, &mut incision, &pose, &params(0.1));
            is_refused |= outcome.is_err();
        }
        check(&body);
        let volume = |piece: u32| {
            body.rest_volume_of((body.topology().triangles()).filter(|&t| body.piece(t) == piece))
        };
        let is_piece = |piece: &u32| volume(*piece) > 0.02 * whole;
        let pieces = (0..body.piece_bound()).filter(is_piece).count();
        if is_refused || pieces != 2 || body.piece_count() != 2 {
            failed.push((seed, incision.state()));
        }
    }
    assert!(failed.len() <= 3, "{failed:?}");
}
