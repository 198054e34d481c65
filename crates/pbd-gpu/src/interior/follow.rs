//! Follows an edit of the surface: cells, nodes, masses and the motion of what was divided.

use super::Interior;
use crate::constraints::cells::CellState;
use incise_lattice::{LatticeChange, NO_COPY};
use incise_mesh::{Surface, TopologyDelta, Vec3, VertexId};
use nalgebra::Matrix3;

/// Memory of edits, reused from one to the next.
#[derive(Debug, Default)]
pub(crate) struct EditScratch {
    change: LatticeChange,
    /// Removed copies with their states and fractions, ascending.
    removed: Vec<(u32, CellState, f64)>,
    /// Positions and velocities of added nodes.
    added: Vec<[[f32; 4]; 2]>,
    /// Whether a node has another mass or other cells, shape \[nodes\].
    is_changed: Vec<bool>,
}

impl Clone for EditScratch {
    /// Returns empty memory.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Momenta of some nodes about a point.
#[derive(Debug, Clone, Copy)]
struct Momenta {
    mass: f64,
    /// Mass times position, from the point.
    moment: Vec3,
    momentum: Vec3,
    angular: Vec3,
    /// Second moments `sum m (|x|^2 - x x^T)`.
    inertia: Matrix3<f64>,
}

impl Interior {
    /// Follows an edit of the surface, whose new vertices have rest positions already.
    ///
    /// Parts that an edit divides move on as they did: new nodes get position and velocity from the
    /// copies that held their parts, cells their rotation and their share of the forces. The nodes
    /// of changed cells keep their mass and their momenta.
    ///
    /// An undo restores the bits before the edit if nothing has moved since. Otherwise pieces that
    /// it joins move together. Returns whether they did.
    pub(crate) fn follow(
        &mut self,
        surface: &mut Surface,
        velocities: &mut [[f32; 4]],
        delta: &TopologyDelta,
    ) -> bool {
        let is_undo = !delta.removed_positions.is_empty();
        let is_current = self.edits.is_current(self.checksum());
        let undone = self.edits.pop_if(is_undo && is_current);
        let is_joined = is_undo && !is_current && self.join_pieces(surface, delta);
        let mut scratch = std::mem::take(&mut self.scratch);
        let change = &mut scratch.change;
        self.lattice.follow(surface, delta, change);
        self.inverse_masses.resize(surface.positions().len(), 0.0);
        if change.is_empty() {
            self.scratch = scratch;
            return is_joined;
        }
        let undone = undone.filter(|record| self.has_all_of(record));
        if !is_undo {
            self.edits.push(self.record_of(change));
        }
        let center = self.center_of(change);
        let leaving = change.nodes_removed.iter().chain(&change.nodes_changed);
        let before = self.momenta(leaving.copied(), center);
        scratch.removed.clear();
        for old in &change.copies_removed {
            let state = self.cells.remove(old.copy);
            (scratch.removed).push((old.copy, state, old.moments.fraction));
        }
        self.add_nodes(change, &mut scratch.added);
        self.update_cells(change, &scratch.removed);
        let staying = change.nodes_changed.iter().copied();
        let added = change.nodes_added.iter().map(|added| added.node);
        let nodes = staying.chain(added);
        match &undone {
            Some(record) => self.restore(record),
            None => {
                self.share_mass(nodes.clone(), before.mass);
                self.restore_momenta(nodes.clone(), &before, center);
            }
        }
        scratch.is_changed.clear();
        scratch.is_changed.resize(self.positions.len(), false);
        for node in nodes.chain(self.nodes_of_cells(change)) {
            scratch.is_changed[node as usize] = true;
        }
        self.update_weights_of(surface, &scratch.is_changed);
        if let Some(record) = &undone {
            // The sums depend on the order of cells, which an undo changes.
            self.restore_forces(record);
        }
        match is_joined {
            true => self.embed(surface, velocities),
            false => self.embed_changed(surface, velocities, change, &scratch.is_changed),
        }
        if !is_undo {
            self.edits.finish(self.checksum());
        }
        self.scratch = scratch;
        is_joined
    }

    /// Returns the nodes of removed, changed and added cells.
    ///
    /// Not all of them have another mass: a cell in the body may be replaced by an equal one.
    fn nodes_of_cells(&self, change: &LatticeChange) -> impl Iterator<Item = u32> {
        let old = change.copies_removed.iter().chain(&change.copies_changed);
        let new = (change.copies_changed.iter().map(|old| old.copy))
            .chain(change.copies_added.iter().map(|added| added.copy));
        let nodes = &self.lattice.nodes;
        let new = new.flat_map(|copy| nodes[copy as usize]);
        old.flat_map(|old| old.nodes).chain(new)
    }

    /// Returns a point near the changed nodes \[m\].
    fn center_of(&self, change: &LatticeChange) -> Vec3 {
        let nodes = change.nodes_removed.iter().chain(&change.nodes_changed);
        let first = nodes.clone().next().copied();
        first.map_or(Vec3::zeros(), |node| vector(self.positions[node as usize]))
    }

    /// Adds nodes, and frees removed ones.
    fn add_nodes(&mut self, change: &LatticeChange, added: &mut Vec<[[f32; 4]; 2]>) {
        added.clear();
        for new in &change.nodes_added {
            let sources = change.sources(new);
            let sum = |rows: &[[f32; 4]]| {
                let first = sources
                    .first()
                    .map_or(Vec3::zeros(), |source| vector(rows[source.node as usize]));
                let off = |source: &incise_lattice::NodeSource| {
                    (vector(rows[source.node as usize]) - first) * source.weight
                };
                first + sources.iter().map(off).sum::<Vec3>()
            };
            let position = if sources.is_empty() {
                self.lattice.node_positions[new.node as usize].into()
            } else {
                sum(&self.positions)
            };
            added.push([row(position), row(sum(&self.velocities))]);
        }
        let count = self.lattice.node_positions.len();
        self.cells.resize_nodes(count);
        self.positions.resize(count, [0.0; 4]);
        self.velocities.resize(count, [0.0; 4]);
        self.node_forces.resize(count, [0.0; 4]);
        self.mass.resize(count, 0.0);
        for &node in &change.nodes_removed {
            let node = node as usize;
            self.positions[node] = [0.0; 4];
            self.velocities[node] = [0.0; 4];
            self.node_forces[node] = [0.0; 4];
            self.mass[node] = 0.0;
        }
        for (new, &[position, velocity]) in change.nodes_added.iter().zip(&*added) {
            let node = new.node as usize;
            self.positions[node] = position;
            self.velocities[node] = velocity;
            self.node_forces[node] = [0.0; 4];
        }
    }

    /// Replaces the cells of changed copies, and adds those of new ones.
    fn update_cells(&mut self, change: &LatticeChange, removed: &[(u32, CellState, f64)]) {
        let of_parent = |interior: &Self, parent: u32| {
            if parent == NO_COPY {
                return None;
            }
            if let Ok(i) = removed.binary_search_by_key(&parent, |own| own.0) {
                return Some((removed[i].1, removed[i].2));
            }
            let changed = change
                .copies_changed
                .binary_search_by_key(&parent, |own| own.copy);
            let moments = match changed {
                Ok(i) => change.copies_changed[i].moments,
                Err(_) => interior.lattice.moments[parent as usize],
            };
            Some((interior.cells.state(parent), moments.fraction))
        };
        let states: Vec<CellState> = change
            .copies_added
            .iter()
            .map(|added| {
                let fraction = self.lattice.moments[added.copy as usize].fraction;
                of_parent(self, added.parent)
                    .map(|(state, whole)| state.of_part([fraction, whole]))
                    .unwrap_or_default()
            })
            .collect();
        for old in &change.copies_changed {
            let state = self.cells.remove(old.copy);
            let fraction = self.lattice.moments[old.copy as usize].fraction;
            self.insert_cell(old.copy, &state.of_part([fraction, old.moments.fraction]));
        }
        for (added, state) in change.copies_added.iter().zip(states) {
            self.insert_cell(added.copy, &state);
        }
    }

    fn insert_cell(&mut self, copy: u32, state: &CellState) {
        let nodes = self.lattice.nodes[copy as usize].map(VertexId);
        let moments = &self.lattice.moments[copy as usize];
        self.cells.insert(copy, nodes, moments, state);
    }

    /// Returns the momenta of nodes about a point.
    fn momenta(&self, nodes: impl Iterator<Item = u32>, about: Vec3) -> Momenta {
        let mut sums = Momenta {
            mass: 0.0,
            moment: Vec3::zeros(),
            momentum: Vec3::zeros(),
            angular: Vec3::zeros(),
            inertia: Matrix3::zeros(),
        };
        for node in nodes {
            let node = node as usize;
            let mass = f64::from(self.mass[node]);
            let arm = vector(self.positions[node]) - about;
            let momentum = vector(self.velocities[node]) * mass;
            sums.mass += mass;
            sums.moment += arm * mass;
            sums.momentum += momentum;
            sums.angular += arm.cross(&momentum);
            let square = Matrix3::identity() * arm.norm_squared() - arm * arm.transpose();
            sums.inertia += square * mass;
        }
        sums
    }

    /// Gives nodes a rigid motion in addition, so that they have given momenta about a point.
    fn restore_momenta(
        &mut self,
        nodes: impl Iterator<Item = u32> + Clone,
        to: &Momenta,
        about: Vec3,
    ) {
        let now = self.momenta(nodes.clone(), about);
        if now.mass <= 0.0 {
            return;
        }
        let center = now.moment / now.mass;
        let lost = to.momentum - now.momentum;
        // About the center of mass, where both parts are independent.
        let turn = (to.angular - now.angular) - center.cross(&lost);
        let square = Matrix3::identity() * center.norm_squared() - center * center.transpose();
        let inertia = now.inertia - square * now.mass;
        let regular = inertia + Matrix3::identity() * (1e-6 * inertia.trace());
        let rate = regular
            .try_inverse()
            .map_or(Vec3::zeros(), |inverse| inverse * turn);
        let velocity = lost / now.mass;
        for node in nodes {
            let node = node as usize;
            let arm = vector(self.positions[node]) - about - center;
            let [x, y, z, _] = row(vector(self.velocities[node]) + velocity + rate.cross(&arm));
            self.velocities[node] = [x, y, z, 0.0];
        }
    }

    /// Writes the positions and velocities of vertices with other weights or changed nodes.
    fn embed_changed(
        &mut self,
        surface: &mut Surface,
        velocities: &mut [[f32; 4]],
        change: &LatticeChange,
        is_changed: &[bool],
    ) {
        let with_weights = change.vertices_changed.iter().map(|v| v.index());
        let with_nodes = self.slots_of(is_changed).into_iter();
        for slot in with_nodes.map(|slot| slot as usize).chain(with_weights) {
            if let (Some([x, y, z]), Some([u, v, w])) = (self.position(slot), self.velocity(slot)) {
                let at = &mut surface.positions_mut()[slot];
                *at = [x, y, z, at[3]];
                // The next step reads velocities that the caller has set.
                if !self.has_new_velocities {
                    velocities[slot] = [u, v, w, 0.0];
                }
            }
        }
        self.note_embedded(surface);
    }
}

fn vector(row: [f32; 4]) -> Vec3 {
    Vec3::new(row[0].into(), row[1].into(), row[2].into())
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to storage")]
fn row(v: Vec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
