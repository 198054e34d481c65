//! [`BladeMap`]: a blade in a deformed body, in the coordinates of the body's rest shape.

use super::TipPoint;
use super::entry::EntryCorners;
use super::line::point_at;
use super::piercings::Piercing;
use crate::affine::{AffineMap, MIN_STRETCH};
use incise_mesh::{Surface, Vec3, VertexId};
use nalgebra::Matrix3;

/// Rounding error of stored coordinates [of the largest coordinate].
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Number of vertices that are compared at once, in a few kilobytes.
const BLOCK: usize = 64;

/// The map of a blade from the present shape of a body to its rest shape, near a tip.
///
/// Walls of an incision coincide at rest, and the body overlaps itself nowhere. So a cut that goes
/// on in the rest shape meets neither open walls nor folds. On the surface the map is exact: it
/// takes the points at which the blade pierces the surface to their places at rest. Between two,
/// a straight blade stays straight. So it does not depend on the motion of walls.
#[derive(Debug, Clone, Default)]
pub(crate) struct BladeMap {
    /// Along the blade; empty for a body at rest.
    anchors: Vec<Anchor>,
    /// For a blade without a tip, its corners beside the body.
    pub(super) corners: EntryCorners,
}

/// A point beside the blade with its place at rest.
#[derive(Debug, Clone, Copy)]
struct Anchor {
    parameter: f64,
    point: Vec3,
    rest: Vec3,
    inverse_gradient: Matrix3<f64>,
}

impl BladeMap {
    /// Returns the map near a tip in a deformed body, of a blade that enters and leaves it at some
    /// piercings.
    ///
    /// `local` is the length of edges near the tip \[m\].
    pub(super) fn new(
        surface: &Surface,
        tip: &[TipPoint],
        piercings: &[Piercing],
        local: f64,
    ) -> Self {
        let mut anchors = Vec::new();
        for part in tip.chunk_by(|point, _| point.is_joined || point.meets_next) {
            anchors.extend(anchors_of(surface, part, piercings, local));
        }
        anchors.sort_by(|a: &Anchor, b| a.parameter.total_cmp(&b.parameter));
        Self {
            anchors,
            ..Self::default()
        }
    }

    /// Returns the map of a blade without a tip that enters and leaves a deformed body at some
    /// piercings.
    ///
    /// `bends` are parameters of the blade, `local` is the length of edges near the piercings
    /// \[m\].
    pub(super) fn of_entry(
        surface: &Surface,
        blade: &[[f32; 3]],
        ends: &[Piercing],
        bends: &[f64],
        local: f64,
    ) -> Self {
        let anchor = |i: usize| {
            let end = &ends[i];
            // The other end of the same part of the blade in the body.
            let partner = if end.enters {
                ends.get(i + 1)
            } else {
                i.checked_sub(1).map(|i| &ends[i])
            };
            Anchor {
                parameter: end.parameter,
                point: end.point,
                rest: end.rest,
                inverse_gradient: gradient_at(surface, [Some(end), partner]),
            }
        };
        let anchors: Vec<Anchor> = (0..ends.len()).map(anchor).collect();
        let speed = |anchor: &Anchor| {
            let [before, after] = [-0.5, 0.5].map(|d| point_at(blade, anchor.parameter + d));
            (anchor.inverse_gradient * (after - before)).norm()
        };
        let speeds: Vec<f64> = anchors.iter().map(speed).collect();
        let corners = EntryCorners::beside(surface, ends, bends, &speeds, local);
        Self { anchors, corners }
    }

    /// Returns whether the body is at rest, or no tip is known.
    pub(crate) fn is_identity(&self) -> bool {
        self.anchors.is_empty()
    }

    /// Returns the position of a vertex in the shape in which the cut is made \[m\].
    pub(super) fn vertex(&self, surface: &Surface, v: VertexId) -> Vec3 {
        if self.is_identity() {
            surface.position(v)
        } else {
            surface.rest_position(v)
        }
    }

    /// Returns the place of a piercing in the shape in which the cut is made \[m\].
    pub(super) fn piercing(&self, piercing: &Piercing) -> Vec3 {
        if self.is_identity() {
            piercing.point
        } else {
            piercing.rest
        }
    }

    /// Returns the blade as a polyline: parameters and mapped points \[m\].
    pub(super) fn line(&self, blade: &[[f32; 3]]) -> Vec<(f64, Vec3)> {
        #[expect(clippy::cast_precision_loss, reason = "few points")]
        let points = (0..blade.len()).map(|i| i as f64);
        let anchors = self.anchors.iter().map(|anchor| anchor.parameter);
        let mut parameters: Vec<f64> = points.chain(anchors).collect();
        parameters.sort_by(f64::total_cmp);
        parameters.dedup();
        let at = |parameter| (parameter, self.at(parameter, point_at(blade, parameter)));
        parameters.into_iter().map(at).collect()
    }

    /// Maps a point of the blade, or near it, at a parameter of the blade \[m\].
    pub(super) fn at(&self, parameter: f64, point: Vec3) -> Vec3 {
        let next = (self.anchors).partition_point(|anchor| anchor.parameter <= parameter);
        let before = next.checked_sub(1).map(|i| self.anchors[i]);
        let anchor = match (before, self.anchors.get(next)) {
            (None, None) => return point,
            (Some(anchor), None) => anchor,
            (None, Some(&anchor)) => anchor,
            (Some(a), Some(b)) => a.toward(b, parameter),
        };
        anchor.rest + anchor.inverse_gradient * (point - anchor.point)
    }
}

/// Returns the anchors at the ends of a part of the tip, moved to where the blade pierces the
/// surface near them now, if it does.
fn anchors_of(
    surface: &Surface,
    part: &[TipPoint],
    piercings: &[Piercing],
    local: f64,
) -> Vec<Anchor> {
    let last = part.len() - 1;
    let mut ends = vec![0, last];
    ends.dedup();
    let mut around: Vec<VertexId> = ends.iter().map(|&i| part[i].vertex).collect();
    let mut anchors = Vec::with_capacity(ends.len());
    for i in ends {
        let mut anchor = Anchor::at_vertex(surface, &part[i]);
        // Along the blade, the body begins at the first end and stops at the last one.
        let enters = (last > 0).then_some(i == 0);
        if let Some(piercing) = anchor.nearest(piercings, enters, local) {
            around.extend(surface.topology().triangle(piercing.triangle));
            anchor.parameter = piercing.parameter;
            anchor.point = piercing.point;
            anchor.rest = piercing.rest;
        }
        anchors.push(anchor);
    }
    let fitted = inverse_gradient(surface, &around);
    for anchor in &mut anchors {
        anchor.inverse_gradient = fitted;
    }
    anchors
}

impl Anchor {
    /// Returns the anchor at a vertex of the tip.
    fn at_vertex(surface: &Surface, point: &TipPoint) -> Self {
        Self {
            parameter: point.parameter,
            point: surface.position(point.vertex),
            rest: surface.rest_position(point.vertex),
            inverse_gradient: Matrix3::identity(),
        }
    }

    /// Returns where the blade pierces the surface near an end of the tip, if it does.
    ///
    /// `enters` is whether the blade goes into the body there, if that is known.
    fn nearest<'a>(
        &self,
        piercings: &'a [Piercing],
        enters: Option<bool>,
        local: f64,
    ) -> Option<&'a Piercing> {
        let distance = |p: &&Piercing| (p.rest - self.rest).norm();
        // Places in the body are at most this far apart at rest.
        let is_near =
            |p: &&Piercing| distance(p) <= (p.point - self.point).norm() / MIN_STRETCH + local;
        let own = piercings
            .iter()
            .filter(|p| enters.is_none_or(|enters| p.enters == enters));
        (own.filter(is_near)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// Returns the anchor at a parameter on the way to the next one.
    fn toward(&self, next: &Self, parameter: f64) -> Self {
        let part = (parameter - self.parameter) / (next.parameter - self.parameter);
        let (a, b) = (self.inverse_gradient, next.inverse_gradient);
        Self {
            parameter,
            point: self.point.lerp(&next.point, part),
            rest: self.rest.lerp(&next.rest, part),
            inverse_gradient: a + (b - a) * part,
        }
    }
}

/// Returns the inverse deformation gradient around piercings.
pub(super) fn gradient_at(surface: &Surface, piercings: [Option<&Piercing>; 2]) -> Matrix3<f64> {
    let around = piercings.into_iter().flatten();
    let around = around.flat_map(|piercing| surface.topology().triangle(piercing.triangle));
    inverse_gradient(surface, &around.collect::<Vec<_>>())
}

/// Returns the inverse deformation gradient around vertices.
fn inverse_gradient(surface: &Surface, vertices: &[VertexId]) -> Matrix3<f64> {
    let topology = surface.topology();
    let mut pairs = Vec::new();
    for &v in vertices {
        let around = topology.outgoing_fan(v).map(|h| topology.target(h));
        let own = [v].into_iter().chain(around);
        pairs.extend(own.map(|v| (surface.rest_position(v), surface.position(v))));
    }
    AffineMap::fit(&pairs).inverse_gradient()
}

/// Returns whether all positions are rest positions, up to rounding.
pub(super) fn is_at_rest(surface: &Surface) -> bool {
    let rest = surface.rest_positions();
    // Integers, which keep the order, take the largest several at a time.
    let bits = rest.as_flattened().iter().map(|x| x.abs().to_bits());
    let tolerance = ROUNDING * f32::from_bits(bits.fold(0, u32::max));
    let is_near = |p: &[f32; 4], r: &[f32; 3]| {
        (0..3).fold(true, |all, k| all & ((p[k] - r[k]).abs() <= tolerance))
    };
    let mut blocks = (surface.positions().chunks(BLOCK)).zip(rest.chunks(BLOCK));
    blocks.all(|(positions, rest)| {
        let pairs = positions.iter().zip(rest);
        pairs.fold(true, |all, (p, r)| all & is_near(p, r))
    })
}
