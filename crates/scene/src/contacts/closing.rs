//! Speeds at which pieces meet, relative to their thickness: violent impacts need more iterations.
//!
//! Only pieces whose volume is preserved count; others cannot stop what presses them flat. Features
//! close at most as fast as one of their pieces moves as a whole: limp pieces, whose vertices
//! tremble, would else keep themselves moving by iterations that come and go.

use super::narrow_phase::{Search, Searched};
use super::persistent::{PersistentContact, area_normal};
use crate::body::Body;
use incise_mesh::Vec3;
use incise_mesh::geometry::round_to_f32;

/// Minimum volume of a piece, relative to the other one. Smaller ones are slivers, which may be
/// crushed.
const SLIVER: f64 = 1e-3;

impl Search<'_> {
    /// Returns the [closing speed](incise_pbd_gpu::Contact::closing) of a vertex at `at` and a
    /// triangle that keep a distance of `gap` \[m\].
    ///
    /// 0 if they do not meet within the frame.
    pub(super) fn closing(
        &self,
        of: Searched<'_>,
        (contact, at): (&PersistentContact, Vec3),
        gap: f64,
    ) -> f32 {
        let Some(other) = self.bodies[contact.other as usize].as_ref() else {
            return 0.0;
        };
        let (surface, motion) = (other.surface(), &self.motions[contact.other as usize]);
        let corners = contact.corners.into_iter().zip(contact.weights);
        let (mut point, mut of_point) = (Vec3::zeros(), Vec3::zeros());
        for (corner, weight) in corners {
            point += surface.position(corner) * weight;
            of_point += motion.velocity(corner) * weight;
        }
        let normal = area_normal(surface, contact.triangle);
        let normal = normal.try_normalize(0.0).unwrap_or_default();
        let normal = if contact.is_behind { -normal } else { normal };
        let speed = normal.dot(&(of_point - of.motion.velocity(contact.vertex)));
        let own = of.body.surface();
        let first = own.topology().outgoing(contact.vertex).triangle();
        let sides = [
            (of.body, own.piece(first)),
            (other, surface.piece(contact.triangle)),
        ];
        let [a, b] = [0, 1].map(|i: usize| {
            let index = [of.motion, motion][i].pieces[sides[i].1 as usize];
            normal.dot(&self.pieces.own_velocity(index))
        });
        let speed = speed.min(f64::max(-a, b));
        let meets = speed > 0.0 && normal.dot(&(at - point)) - speed * self.frame.dt <= gap;
        if !meets {
            return 0.0;
        }
        let sides = sides.map(|(body, piece)| (body, body.piece_shapes().get(piece)));
        let least = SLIVER * f64::max(sides[0].1.volume, sides[1].1.volume);
        let is_solid = |body: &Body| body.solver().material().volume.is_some();
        let solid = (sides.iter()).filter(|(body, shape)| is_solid(body) && shape.volume > least);
        let thickness = solid.map(|(_, shape)| shape.thickness);
        let closing = speed / thickness.fold(f64::INFINITY, f64::min);
        round_to_f32(closing.min(f64::from(f32::MAX)))
    }
}
