//! Moves pieces together that an undo joins, after they have moved apart.
//!
//! Every such piece moves as a rigid body into the frame of the heaviest one. Only the difference
//! of their deformations remains, as a strain of the cells that they share again.

use super::Interior;
use crate::rigid_frame::RigidFrame;
use incise_mesh::{Surface, TopologyDelta, Vec3, index_u32};

/// No piece.
const NONE: u32 = u32::MAX;

impl Interior {
    /// Moves the pieces that an undo joins into one frame, before the lattice follows it.
    ///
    /// The center of mass stays, and so do all velocities. Returns whether there are such pieces.
    pub(super) fn join_pieces(&mut self, surface: &Surface, delta: &TopologyDelta) -> bool {
        if delta.pieces_removed.is_empty() {
            return false;
        }
        let count = self.positions.len();
        let mut sets = self.pieces();
        // The present piece of each former one, which its first node names.
        let mut present = vec![NONE; count];
        for v in surface.topology().vertices() {
            if let Some(nodes) = self.nodes_of(v.index()) {
                let piece = surface.piece(surface.topology().outgoing(v).triangle());
                present[sets.find(nodes[0]) as usize] = piece;
            }
        }
        let mut former: Vec<(u32, u32)> = (0..index_u32(count))
            .map(|root| (present[root as usize], root))
            .filter(|&(piece, _)| piece != NONE)
            .collect();
        former.sort_unstable();
        let roots: Vec<u32> = (0..index_u32(count)).map(|node| sets.find(node)).collect();
        let mut is_joined = false;
        for members in former.chunk_by(|a, b| a.0 == b.0) {
            if members.len() > 1 {
                self.align(members, &roots);
                is_joined = true;
            }
        }
        if is_joined {
            (self.cells).sum_forces(&mut self.node_forces, &self.constants, |_| true);
        }
        is_joined
    }

    /// Moves former pieces, each given with the root of its nodes, into the frame of the heaviest.
    fn align(&mut self, members: &[(u32, u32)], roots: &[u32]) {
        let frames: Vec<RigidFrame> = members
            .iter()
            .map(|&(_, root)| self.frame(|node| roots[node] == root))
            .collect();
        let Some(target) = frames.iter().max_by(|a, b| a.mass.total_cmp(&b.mass)) else {
            return;
        };
        let mass: f64 = frames.iter().map(|frame| frame.mass).sum();
        // Where the center of a piece lies in the frame of the heaviest one.
        let place = |frame: &RigidFrame| target.to_present(frame.to_rest(frame.center));
        let moved = |frame: &RigidFrame| (place(frame) - frame.center) * frame.mass;
        let shift = frames.iter().map(moved).sum::<Vec3>() / mass;
        for (frame, &(_, root)) in frames.iter().zip(members) {
            let turn = target.rotation * frame.rotation.transpose();
            let center = place(frame) - shift;
            for (x, _) in (self.positions.iter_mut().zip(roots)).filter(|own| *own.1 == root) {
                let arm = vector(*x) - frame.center;
                let [a, b, c] = to_row(center + turn * arm);
                *x = [a, b, c, x[3]];
            }
            for copy in 0..index_u32(self.lattice.nodes.len()) {
                let node = self.lattice.nodes[copy as usize][0];
                if self.lattice.is_copy(copy) && roots[node as usize] == root {
                    self.cells.turn(copy, &turn);
                }
            }
        }
    }

    /// Returns the rigid motion of the nodes that a predicate selects.
    fn frame(&self, is_own: impl Fn(usize) -> bool) -> RigidFrame {
        let is_own = &is_own;
        let all = self.positions.iter().zip(&self.lattice.node_positions);
        let own = (all.zip(&self.mass).enumerate()).filter(move |(node, _)| is_own(*node));
        RigidFrame::of(
            own.map(|(_, ((x, rest), mass))| (vector(*x), Vec3::from(*rest), f64::from(*mass))),
        )
    }
}

fn vector(row: [f32; 4]) -> Vec3 {
    Vec3::new(row[0].into(), row[1].into(), row[2].into())
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn to_row(x: Vec3) -> [f32; 3] {
    [x.x as f32, x.y as f32, x.z as f32]
}
