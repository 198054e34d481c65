//! [`IslandPoints`]: the vertices of an island with solids, as contacts see them.

use crate::kernels::contacts::VertexStates;
use crate::kernels::particle_state::{ParticleState, ParticleStates};
use crate::kernels::points::Points;
use crate::step::stage::SteppedBody;

/// The vertices of the bodies of an island: particles of surfaces, points of solids.
#[derive(Debug, Clone, Copy)]
pub(super) struct IslandPoints<'a, 'b> {
    /// States of the particles of all bodies.
    pub(super) particles: ParticleStates<'a>,
    pub(super) bodies: &'a [SteppedBody<'b>],
}

/// A vertex: a particle, or a slot of a solid.
enum Vertex<'a> {
    Particle(usize),
    Point(Points<'a>, usize),
}

impl<'a> IslandPoints<'a, '_> {
    /// Finds an island vertex.
    #[inline(always)]
    fn find(self, v: usize) -> Vertex<'a> {
        let after = self
            .bodies
            .partition_point(|body| body.member.first_vertex <= v);
        let body = &self.bodies[after - 1];
        let slot = v - body.member.first_vertex;
        match &body.arrays.solid {
            Some(solid) => {
                let count = body.arrays.positions.len();
                let nodes = self.particles.slice(body.member.first, count);
                Vertex::Point(solid.points(nodes), slot)
            }
            None => Vertex::Particle(body.member.first + slot),
        }
    }
}

impl VertexStates for IslandPoints<'_, '_> {
    #[inline(always)]
    fn state(self, v: usize) -> ParticleState {
        match self.find(v) {
            Vertex::Particle(i) => self.particles.get(i),
            Vertex::Point(points, slot) => points.state(slot),
        }
    }

    /// Vertices of one side may have common nodes: their weighted roots add up before they are
    /// squared, which bounds the motion of the side (Cauchy-Schwarz).
    #[inline(always)]
    fn shares(self, w: [f32; 4], p: [ParticleState; 4]) -> [f32; 4] {
        let mut shares = [0.0; 4];
        for is_second in [false, true] {
            let (mut roots, mut sum) = (0.0, 0.0);
            for i in 0..4 {
                if (w[i] < 0.0) == is_second {
                    let by = w[i].abs() * p[i].x[3].sqrt();
                    roots += by;
                    sum += by * by;
                }
            }
            let bound = if sum > 0.0 { roots * roots / sum } else { 1.0 };
            for i in 0..4 {
                if (w[i] < 0.0) == is_second {
                    shares[i] = bound * (w[i] * p[i].x[3]);
                }
            }
        }
        shares
    }

    #[inline(always)]
    fn move_to(self, v: usize, from: ParticleState, to: ParticleState, [share, w]: [f32; 2]) {
        match self.find(v) {
            Vertex::Particle(i) => self.particles.set(i, to),
            Vertex::Point(points, slot) => {
                let by = if share != 0.0 { w / share } else { 0.0 };
                let impulse =
                    |a: [f32; 4], b: [f32; 4]| [0, 1, 2].map(|k: usize| by * (b[k] - a[k]));
                points.push(slot, impulse(from.d, to.d));
                points.shift(slot, impulse(from.x, to.x));
            }
        }
    }
}
