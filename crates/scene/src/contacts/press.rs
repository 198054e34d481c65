//! Load ratios of pieces on thinner ones, which need more rounds of contacts and volumes.
//!
//! Only pieces whose volume is preserved count; others are pressed flat in any case. The approach
//! speed of features is at most that of one of their pieces as a whole: in limp pieces, whose
//! vertices tremble, changing round counts would otherwise inject energy.

use super::narrow_phase::{Search, Searched};
use super::persistent::{PersistentContact, area_normal};
use incise_mesh::Vec3;
use incise_mesh::geometry::round_to_f32;
use incise_pbd_gpu::LoadRatio;

/// Minimum volume of a piece, relative to the other one. Smaller ones are slivers, which may be
/// crushed.
const SLIVER: f64 = 1e-3;

impl Search<'_> {
    /// Returns how a vertex at `at` and a triangle press each other, which keep a distance of `gap`
    /// \[m\].
    ///
    /// They do not if they stay apart within the frame.
    pub(super) fn press(
        &self,
        of: Searched<'_>,
        (contact, at): (&PersistentContact, Vec3),
        gap: f64,
    ) -> LoadRatio {
        let Some(other) = self.bodies[contact.other as usize].as_ref() else {
            return LoadRatio::NONE;
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
        let pieces = [0, 1].map(|i: usize| [of.motion, motion][i].pieces[sides[i].1 as usize]);
        let [a, b] = pieces.map(|index| normal.dot(&self.pieces.own_velocity(index)));
        let speed = speed.min(f64::max(-a, b)).max(0.0);
        let meets = normal.dot(&(at - point)) - speed * self.frame.dt <= gap;
        if !meets {
            return LoadRatio::NONE;
        }
        let masses = pieces.map(|index| self.pieces.mass(index));
        let shapes = sides.map(|(body, piece)| body.piece_shapes().get(piece));
        let least = SLIVER * f64::max(shapes[0].volume, shapes[1].volume);
        let load = [0, 1].map(|i: usize| {
            let is_solid = sides[i].0.solver().material().volume.is_some();
            if is_solid && shapes[i].volume > least {
                f64::max(1.0, masses[1 - i] / masses[i]) / shapes[i].thickness
            } else {
                0.0
            }
        });
        let load = f64::max(load[0], load[1]);
        let [load, closing] =
            [load, load * speed].map(|c| round_to_f32(c.min(f64::from(f32::MAX))));
        LoadRatio { load, closing }
    }
}
