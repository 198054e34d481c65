//! What must hold of a surface, its search tree, its constraints and its sums after every edit.

use super::case::larger;
use super::failure::Failure;
use incise_cut::Cutter;
use incise_mesh::Surface;
use incise_pbd_gpu::Solver;

/// Checks that a surface is sound: valid arrays, closed, oriented, one fan around each vertex, every pair of
/// neighbors joined by one edge, every piece one connected component.
///
/// # Errors
/// The first law that is broken.
pub(super) fn sound(surface: &Surface) -> Result<(), Failure> {
    let topology = surface.topology();
    (topology.validate()).map_err(|broken| Failure::Law(broken.to_string()))?;
    demand(topology.is_closed(), "the surface is open")?;
    let mut valence = vec![0; topology.vertex_slots()];
    let mut directed = Vec::with_capacity(3 * topology.triangle_count());
    for t in topology.triangles() {
        for h in t.half_edges() {
            valence[topology.origin(h).index()] += 1;
            directed.push((topology.origin(h), topology.target(h)));
        }
    }
    // Twins run against each other, so each direction once means each edge twice.
    directed.sort_unstable();
    let twice = directed.windows(2).any(|w| w[0] == w[1]);
    demand(!twice, "two half-edges run along an edge")?;
    for v in topology.vertices() {
        let fan = topology.outgoing_fan(v).count();
        demand(fan == valence[v.index()], "a vertex has more than one fan")?;
        demand(fan >= 3, "a vertex has less than three triangles")?;
    }
    let labels = topology.component_labels();
    let mut pairs: Vec<(u32, u32)> = (topology.triangles())
        .map(|t| (surface.piece(t), labels[t.index()]))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut components: Vec<u32> = pairs.iter().map(|pair| pair.1).collect();
    components.sort_unstable();
    components.dedup();
    let pieces_differ = pairs.windows(2).all(|w| w[0].0 != w[1].0);
    demand(
        pieces_differ && components.len() == pairs.len(),
        "pieces and connected components differ",
    )?;
    let slots = topology.vertex_slots();
    demand(
        surface.positions.len() == slots && surface.rest.len() == slots,
        "vertex data does not fit the vertices",
    )
}

/// Checks that search tree and constraints are those of the surface.
///
/// # Errors
/// The first law that is broken.
pub(super) fn followed(surface: &Surface, solver: &Solver, cutter: &Cutter) -> Result<(), Failure> {
    let tree = cutter.bvh().validate(surface);
    tree.map_err(|broken| Failure::Law(broken.to_string()))?;
    let constraints = solver.validate(surface);
    constraints.map_err(|broken| Failure::Law(broken.to_string()))
}

fn demand(holds: bool, law: &str) -> Result<(), Failure> {
    if holds {
        Ok(())
    } else {
        Err(Failure::Law(law.to_owned()))
    }
}

/// Mass, momentum and volume of a body, to be compared with those after an edit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sums {
    mass: f64,
    momentum: [f64; 3],
    /// What the momentum would be if everything moved as the fastest vertex does.
    momentum_scale: f64,
    volume: f64,
    /// Of the box around the body.
    volume_scale: f64,
}

impl Sums {
    pub(super) fn of(surface: &Surface, solver: &Solver) -> Self {
        let bounds = surface.bounds();
        Self {
            mass: solver.total_mass(),
            momentum: solver.momentum(),
            momentum_scale: solver.total_mass() * super::audit::fastest(solver),
            volume: surface.volume(),
            volume_scale: bounds.diagonal().powi(3),
        }
    }

    /// The largest relative change; `moved` is the volume that the edit may have moved \[m^3\].
    pub(super) fn change(&self, now: &Self, moved: f64) -> f64 {
        let mass = (now.mass - self.mass).abs() / self.mass;
        let change = |k: usize| (now.momentum[k] - self.momentum[k]).abs();
        let impulse = [0, 1, 2].map(change).into_iter().fold(0.0, larger);
        let momentum = impulse / self.momentum_scale.max(f64::MIN_POSITIVE);
        let volume = larger(0.0, (now.volume - self.volume).abs() - moved) / self.volume_scale;
        larger(larger(mass, momentum), volume)
    }
}
