//! Random sweeps and a moving body with its cutter, for `cuts_in_motion`.

use incise_cut::{CutParams, Cutter, Sweep};
use incise_mesh::geometry::to_f32;
use incise_mesh::{Surface, Undo, Vec3, VertexId, icosphere};
use incise_pbd_gpu::{Material, Solver, SolverParams, Stiffness};
use incise_test_support::random::Random;
use incise_tests::{assert_closed_manifold, assert_same_bits};

/// Largest relative change of mass, momentum and volume by a cut.
pub(crate) const ROUNDING: f64 = 1e-5;

/// Returns a random unit vector.
pub(crate) fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::from_fn(|_, _| random.signed());
        if (0.1..1.0).contains(&v.norm()) {
            return v.normalize();
        }
    }
}

/// Returns a plane through the middle half of a piece.
pub(crate) fn through(random: &mut Random, surface: &Surface, piece: u32) -> Sweep {
    let triangles = surface.topology().triangles();
    let triangles = triangles.filter(|&t| surface.piece(t) == piece);
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for p in triangles.flat_map(|t| surface.triangle_positions(t)) {
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let part = Vec3::from_fn(|_, _| random.between(0.25, 0.75));
    let at = low + part.component_mul(&(high - low));
    plane(surface, direction(random), &at)
}

pub(crate) fn plane(surface: &Surface, normal: Vec3, point: &Vec3) -> Sweep {
    let sweep = Sweep::from_plane(normal.into(), normal.dot(point), &surface.bounds());
    sweep.expect("a body with a size")
}

pub(crate) fn pieces(surface: &Surface) -> Vec<u32> {
    let numbers = 0..surface.piece_bound();
    numbers
        .filter(|&p| surface.piece_triangles(p) > 0)
        .collect()
}

pub(crate) fn shell(stretch: Stiffness, bending: Stiffness) -> Material {
    Material {
        stretch,
        bending: Some(bending),
        ..Material::default()
    }
}

pub(crate) fn paper_shell() -> Material {
    shell(Stiffness::Pbd(1.0), Stiffness::Pbd(0.5))
}

/// Mass \[kg\], momentum [kg m/s] and volume \[m^3\] of a body.
pub(crate) struct Sums {
    pub(crate) mass: f64,
    pub(crate) momentum: [f64; 3],
    pub(crate) volume: f64,
}

/// A body in motion and its cutter.
pub(crate) struct Body {
    pub(crate) surface: Surface,
    pub(crate) solver: Solver,
    pub(crate) cutter: Cutter,
}

impl Body {
    pub(crate) fn new(mut surface: Surface, material: &Material) -> Self {
        let solver = Solver::new(&mut surface, material).expect("a body that can be simulated");
        let cutter = Cutter::new(&surface);
        Self {
            surface,
            solver,
            cutter,
        }
    }

    /// Creates a rotating, compressed ball at a height.
    pub(crate) fn turning(subdivisions: u32, height: f64, material: &Material) -> Self {
        let mut surface = icosphere(subdivisions, 0.5);
        place(&mut surface, |p| p + Vec3::new(0.0, height, 0.0));
        let mut body = Self::new(surface, material);
        body.turn();
        body
    }

    pub(crate) fn turn(&mut self) {
        let center = self.surface.bounds().center();
        for v in self.surface.topology().vertices() {
            let r = self.surface.position(v) - center;
            let velocity = to_f32(Vec3::new(r.z, -0.25 * r.y, -r.x));
            self.solver.set_velocity(v, velocity).expect("a vertex");
        }
    }

    pub(crate) fn step(&mut self, dt: f32, params: &SolverParams) {
        let stepped = self.solver.step(&mut self.surface, dt, params);
        stepped.expect("positions stay finite");
    }

    pub(crate) fn sums(&self) -> Sums {
        Sums {
            mass: self.solver.total_mass(),
            momentum: self.solver.momentum(),
            volume: self.surface.volume(),
        }
    }

    /// Cuts and asserts valid topology, constraints and BVH, and preserved sums.
    ///
    /// A failed cut must leave the surface unchanged.
    pub(crate) fn cut(&mut self, sweep: &Sweep, params: &CutParams, context: &str) -> Option<Undo> {
        self.cutter.refit(&self.surface);
        let (whole, before) = (self.surface.clone(), self.sums());
        let Ok(outcome) = self.cutter.cut(&mut self.surface, sweep, params) else {
            assert_same_bits(&whole, &self.surface);
            return None;
        };
        let applied = self.solver.apply_delta(&mut self.surface, &outcome.delta);
        applied.expect("the delta of a cut fits");
        self.validate();
        let now = self.sums();
        let speed = |v: &[f32; 4]| v[..3].iter().map(|&c| f64::from(c).powi(2)).sum::<f64>();
        let fastest = self
            .solver
            .velocities()
            .iter()
            .map(speed)
            .fold(0.0, f64::max);
        let scale = before.mass * fastest.sqrt().max(f64::MIN_POSITIVE);
        let mass = (now.mass - before.mass).abs();
        assert!(mass <= ROUNDING * before.mass, "{context}: {mass} kg");
        for (was, is) in before.momentum.into_iter().zip(now.momentum) {
            let change = (is - was).abs();
            assert!(change <= ROUNDING * scale, "{context}: {change} kg m/s");
        }
        let volume = (now.volume - before.volume).abs() - outcome.report.moved_volume;
        let space = whole.bounds().diagonal().powi(3);
        assert!(volume <= ROUNDING * space, "{context}: {volume} m^3");
        outcome.undo
    }

    pub(crate) fn validate(&self) {
        assert_closed_manifold(&self.surface);
        // Cuts of a body in motion wait for the next refit.
        let mut cutter = self.cutter.clone();
        cutter.refit(&self.surface);
        let bvh = cutter.bvh().validate(&self.surface);
        bvh.expect("the BVH fits the surface");
        let constraints = self.solver.validate(&self.surface);
        constraints.expect("constraints are those from scratch");
    }

    /// Returns kinetic energy plus potential energy above the ground \[J\].
    pub(crate) fn energy(&self) -> f64 {
        let vertices = self.surface.topology().vertices();
        let weight = vertices.map(|v| {
            let mass = f64::from(self.solver.masses()[v.index()]);
            mass * 9.81 * self.surface.position(v).y
        });
        self.solver.kinetic_energy() + weight.sum::<f64>()
    }
}

pub(crate) fn place(surface: &mut Surface, to: impl Fn(Vec3) -> Vec3) {
    for i in 0..surface.positions().len() {
        let p = to_f32(to(surface.rest_position(VertexId::from_index(i))));
        surface.rest_positions_mut()[i] = p;
        surface.positions_mut()[i] = [p[0], p[1], p[2], surface.positions()[i][3]];
    }
}
