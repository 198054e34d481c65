//! Who inherits the mass and momentum of what an edit took away.
//!
//! The corners of removed and added triangles of one piece form a pool. The pool's mass is what its
//! surviving members had, plus that of removed vertices next to it; its members share it by rest area.
//! Then one velocity is added to all of them, so that the pool's momentum is what it was.

use crate::mass::{lumped_area, shares_of};
use crate::solver::{Solver, inverse};
use incise_mesh::{Surface, TopologyDelta, VertexId};

/// A vertex that shares in a pool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    piece: u32,
    vertex: VertexId,
}

/// A vertex that went, and the piece that it was part of if a neighbor survived.
#[derive(Debug, Clone, Copy)]
struct Gone {
    vertex: VertexId,
    piece: Option<u32>,
}

/// Mass \[kg\] and momentum [kg m/s].
#[derive(Debug, Clone, Copy, Default)]
struct Estate {
    mass: f64,
    momentum: [f64; 3],
}

impl Estate {
    fn of(solver: &Solver, v: VertexId) -> Self {
        let mass = f64::from(solver.mass[v.index()]);
        Self {
            mass,
            momentum: solver.velocity(v).map(|c| mass * f64::from(c)),
        }
    }

    fn add(&mut self, other: Self, share: f64) {
        self.mass += share * other.mass;
        for k in 0..3 {
            self.momentum[k] += share * other.momentum[k];
        }
    }
}

/// The vertices concerned by an edit.
#[derive(Debug)]
pub(crate) struct Inheritance {
    /// Ascending by piece, then by vertex.
    members: Vec<Member>,
    /// Ascending by vertex.
    gone: Vec<Gone>,
    /// Vertices that came, ascending.
    came: Vec<VertexId>,
}

impl Inheritance {
    /// Sorts out who is concerned. The surface is the one after the edit.
    pub(crate) fn new(surface: &Surface, delta: &TopologyDelta) -> Self {
        let topology = surface.topology();
        let removed = delta.triangles_removed.iter().map(|&(_, corners)| corners);
        let added = delta.triangles_added.iter().map(|&t| topology.triangle(t));
        let mut touched: Vec<VertexId> = removed.chain(added).flatten().collect();
        touched.sort_unstable();
        touched.dedup();
        let (mut members, mut gone) = (Vec::new(), Vec::new());
        for vertex in touched {
            let h = topology.outgoing(vertex);
            if h.is_null() {
                gone.push(Gone {
                    vertex,
                    piece: None,
                });
            } else {
                let piece = surface.piece(h.triangle());
                members.push(Member { piece, vertex });
            }
        }
        members.sort_unstable();
        let mut came: Vec<VertexId> = delta.vertices_added.iter().map(|a| a.vertex).collect();
        came.sort_unstable();
        let mut inheritance = Self {
            members,
            gone,
            came,
        };
        inheritance.find_pieces(surface, delta);
        inheritance
    }

    /// Removed vertices belong to the piece of a surviving neighbor, or of a neighbor's neighbor.
    fn find_pieces(&mut self, surface: &Surface, delta: &TopologyDelta) {
        let topology = surface.topology();
        let mut changed = true;
        while changed {
            changed = false;
            for &(_, corners) in &delta.triangles_removed {
                let known = corners.iter().find_map(|&v| {
                    let h = topology.outgoing(v);
                    if h.is_null() {
                        self.gone_index(v).and_then(|i| self.gone[i].piece)
                    } else {
                        Some(surface.piece(h.triangle()))
                    }
                });
                for v in corners {
                    if let Some(i) = self.gone_index(v)
                        && self.gone[i].piece.is_none()
                        && known.is_some()
                    {
                        self.gone[i].piece = known;
                        changed = true;
                    }
                }
            }
        }
    }

    fn gone_index(&self, v: VertexId) -> Option<usize> {
        self.gone.binary_search_by_key(&v, |gone| gone.vertex).ok()
    }

    fn is_new(&self, v: VertexId) -> bool {
        self.came.binary_search(&v).is_ok()
    }

    /// Shares mass and momentum out.
    pub(crate) fn settle(mut self, solver: &mut Solver, surface: &mut Surface) {
        for v in &self.came {
            solver.mass[v.index()] = 0.0;
        }
        if self.has_pool_without_mass(solver) {
            // A piece of new vertices only: the whole edit is one pool.
            self.members.iter_mut().for_each(|m| m.piece = 0);
            self.gone.iter_mut().for_each(|g| g.piece = Some(0));
            self.members.sort_unstable();
        }
        let areas: Vec<f64> = self
            .members
            .iter()
            .map(|m| lumped_area(surface, m.vertex))
            .collect();
        let orphaned = self.orphaned(solver);
        let heirs = |m: &Member| self.came.is_empty() || self.is_new(m.vertex);
        let heir_area: f64 = (self.members.iter().zip(&areas))
            .filter(|(m, _)| heirs(m))
            .map(|(_, area)| area)
            .sum();
        let mut start = 0;
        for pool in self.members.chunk_by(|a, b| a.piece == b.piece) {
            let areas = &areas[start..start + pool.len()];
            start += pool.len();
            let mut estate = self.estate(solver, pool);
            let part: f64 = (pool.iter().zip(areas))
                .filter(|(m, _)| heirs(m))
                .map(|(_, area)| area)
                .sum();
            let share = if heir_area > 0.0 {
                part / heir_area
            } else {
                pool.len() as f64 / self.members.len() as f64
            };
            estate.add(orphaned, share);
            share_out(solver, surface, pool, areas.to_vec(), estate);
        }
        for gone in &self.gone {
            let i = gone.vertex.index();
            solver.mass[i] = 0.0;
            solver.velocities[i] = [0.0; 4];
            // The slot of an undone vertex may be no more.
            if let Some(position) = surface.positions.get_mut(i) {
                position[3] = 0.0;
            }
        }
    }

    fn has_pool_without_mass(&self, solver: &Solver) -> bool {
        self.members
            .chunk_by(|a, b| a.piece == b.piece)
            .any(|pool| self.estate(solver, pool).mass <= 0.0)
    }

    fn estate(&self, solver: &Solver, pool: &[Member]) -> Estate {
        let piece = pool.first().map(|m| m.piece);
        let mut estate = Estate::default();
        for member in pool {
            estate.add(Estate::of(solver, member.vertex), 1.0);
        }
        for gone in self.gone.iter().filter(|gone| gone.piece == piece) {
            estate.add(Estate::of(solver, gone.vertex), 1.0);
        }
        estate
    }

    /// What removed vertices leave that have no piece.
    fn orphaned(&self, solver: &Solver) -> Estate {
        let mut estate = Estate::default();
        for gone in self.gone.iter().filter(|gone| gone.piece.is_none()) {
            estate.add(Estate::of(solver, gone.vertex), 1.0);
        }
        estate
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "computed masses and velocities are rounded once to storage"
)]
fn share_out(
    solver: &mut Solver,
    surface: &mut Surface,
    pool: &[Member],
    mut shares: Vec<f64>,
    estate: Estate,
) {
    shares_of(&mut shares);
    let mut missing = estate.momentum;
    let mut movable = 0.0;
    let is_pinned = |v: VertexId, solver: &Solver| {
        solver
            .pins
            .binary_search_by_key(&v, |pin| pin.vertex)
            .is_ok()
    };
    for (member, share) in pool.iter().zip(shares) {
        let v = member.vertex;
        solver.mass[v.index()] = (estate.mass * share) as f32;
        let now = Estate::of(solver, v);
        for (missing, now) in missing.iter_mut().zip(now.momentum) {
            *missing -= now;
        }
        if is_pinned(v, solver) {
            surface.positions[v.index()][3] = 0.0;
        } else {
            surface.positions[v.index()][3] = inverse(solver.mass[v.index()]);
            movable += now.mass;
        }
    }
    if movable <= 0.0 {
        return;
    }
    for v in pool.iter().map(|member| member.vertex) {
        if !is_pinned(v, solver) {
            let velocity = &mut solver.velocities[v.index()];
            for k in 0..3 {
                velocity[k] = (f64::from(velocity[k]) + missing[k] / movable) as f32;
            }
        }
    }
}
