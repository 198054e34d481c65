//! [`Guard`]: damps motion, restores momenta and limits the energy at the end of a frame.
//!
//! - Damping slows the motion of a piece relative to its rigid motion (Mueller et al. 2007, 3.5).
//!   A body falls and spins as without it.
//! - Without contacts, pins and collisions the momentum and angular momentum of a piece change by
//!   gravity alone. Projections conserve them up to rounding, and up to the turn of directions in a
//!   substep. The rest is restored.
//! - The sum of kinetic and potential energy may grow by the slack of the body only: the energy
//!   that its constraints store. The excess is taken from the motion relative to the rigid one.
//!   Pieces with pins or in a collider have no momentum to keep: the rest is taken from their rigid
//!   motion.
//!
//! The slack decays to the [elastic energy](elastic_energy) with the time constant [`RELAXATION`],
//! since constraints dissipate the rest. It is unlimited while something does unknown work: moving
//! pins and colliders, pressure, and compressible volumes, whose energy is not counted.

use crate::constraints::cells::CellSet;
use crate::constraints::pieces::PieceVertices;
use crate::kernels::elastic::{ElasticSets, cell_energy, elastic_energy};
use crate::kernels::rigid_motion::{RigidMotion, cross};
use crate::step::constants::StepConstants;
use incise_mesh::VertexId;

/// Time constant of the decay of the slack to the elastic energy \[s\].
const RELAXATION: f32 = 1.0;

/// Time between two measurements of the elastic energy \[s\].
///
/// One takes about as long as three sweeps.
const INTERVAL: f32 = 0.25;

/// The energy budget of a body, which lasts from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EnergyBudget {
    /// Energy that constraints may give back \[J\]; [`UNLIMITED`] and more is no limit.
    pub(crate) slack: f32,
    /// Time since the elastic energy was measured \[s\].
    pub(crate) age: f32,
}

/// Slack of an unlimited budget \[J\]; drivers of GPUs may assume that no number is infinite.
pub(crate) const UNLIMITED: f32 = 1e30;

impl Default for EnergyBudget {
    /// Returns an unlimited budget, of a body in an unknown state.
    fn default() -> Self {
        Self {
            slack: UNLIMITED,
            age: 0.0,
        }
    }
}

impl EnergyBudget {
    /// Returns whether the budget is unlimited.
    pub(crate) fn is_unlimited(&self) -> bool {
        self.slack >= UNLIMITED
    }

    /// Advances the budget by a frame on the GPU, which has the slack.
    #[cfg(feature = "gpu")]
    pub(crate) fn follow(&mut self, inputs: &GuardInputs) {
        if !inputs.conserves {
            return;
        }
        self.age += inputs.time();
        if inputs.is_driven || inputs.relaxation.is_some() {
            self.age = 0.0;
            self.slack = if inputs.is_driven { UNLIMITED } else { 0.0 };
        }
    }
}

/// Inputs of the guard for one body and frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GuardInputs {
    /// Constants of the first-order substeps of the frame.
    pub(crate) constants: StepConstants,
    /// Factor of the velocities relative to the rigid motion, from damping.
    pub(crate) damping_factor: f32,
    /// Whether to restore momenta and to limit the energy.
    pub(crate) conserves: bool,
    /// Whether the body has pins.
    pub(crate) has_pins: bool,
    /// Whether something does unknown work in the frame.
    pub(crate) is_driven: bool,
    /// Whether the body has contacts.
    pub(crate) has_contacts: bool,
    /// Whether the budget is unlimited at the start of the frame.
    pub(crate) is_unlimited: bool,
    /// Factor of the slack beyond the elastic energy, if that is measured at the end of the frame.
    pub(crate) relaxation: Option<f32>,
}

impl GuardInputs {
    /// Returns the inputs of a frame; `None` if there is nothing to do.
    pub(crate) fn new(
        budget: &EnergyBudget,
        constants: &StepConstants,
        damping: f32,
        conserves: bool,
    ) -> Option<Self> {
        let time = frame_time(constants);
        let is_idle = damping == 0.0 && !conserves || constants.substeps == 0;
        let age = budget.age + time;
        let is_due = budget.is_unlimited() || age >= INTERVAL;
        (!is_idle).then_some(Self {
            constants: *constants,
            damping_factor: (-damping * time).exp(),
            conserves,
            has_pins: false,
            is_driven: false,
            has_contacts: false,
            is_unlimited: budget.is_unlimited(),
            relaxation: (conserves && is_due).then(|| (-age / RELAXATION).exp()),
        })
    }
}

impl GuardInputs {
    /// Returns the duration of all substeps of the frame \[s\].
    fn time(&self) -> f32 {
        frame_time(&self.constants)
    }
}

/// Returns the duration of all substeps of a frame \[s\].
fn frame_time(constants: &StepConstants) -> f32 {
    constants.h * constants.substeps as f32
}

/// A body as the guard sees it at one time.
#[derive(Debug)]
pub(crate) struct GuardedBody<'a> {
    pub(crate) positions: &'a [[f32; 4]],
    pub(crate) velocities: &'a mut [[f32; 4]],
    pub(crate) pieces: &'a PieceVertices,
    pub(crate) sets: ElasticSets<'a>,
    /// The cells of a solid.
    pub(crate) cells: Option<&'a CellSet>,
    pub(crate) budget: &'a mut EnergyBudget,
}

/// The rigid motions of the pieces of an island, in memory reused between frames.
#[derive(Debug, Clone, Default)]
pub(crate) struct Guard {
    /// Rigid motions at the start of the frame, body after body.
    start: Vec<RigidMotion>,
    /// Changes at the end of the frame.
    end: Vec<Change>,
    energies: Vec<Energies>,
}

/// The next of the measured bodies and pieces.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct GuardCursor {
    body: usize,
    piece: usize,
}

/// The rigid motion of a piece at the end of a frame, and its change.
#[derive(Debug, Clone, Copy)]
struct Change {
    motion: RigidMotion,
    /// Whether pins or colliders hold the piece, so that it has no momentum to keep.
    is_held: bool,
    /// Angular velocity before the change [rad/s].
    turn: [f32; 3],
    velocity_change: [f32; 3],
    turn_change: [f32; 3],
}

/// Energies of a body in a frame \[J\].
#[derive(Debug, Clone, Copy, Default)]
struct Energies {
    /// Mass \[kg\].
    mass: f32,
    /// Kinetic energy at the start.
    before: f32,
    /// Kinetic energy of rigid motions at the end, changes included.
    rigid: f32,
    /// Kinetic energy of other motions at the end, damping included.
    relative: f32,
    /// The part of the rigid energy that may be taken: that of held pieces.
    held: f32,
    /// Change of the gravitational potential energy.
    potential_change: f32,
}

impl Energies {
    /// Returns the increase of kinetic and potential energy in the frame \[J\].
    fn gain(&self) -> f32 {
        ((self.rigid + self.relative) + self.potential_change) - self.before
    }
}

impl Guard {
    /// Begins a frame of an island.
    pub(crate) fn clear(&mut self) {
        self.start.clear();
        self.end.clear();
        self.energies.clear();
    }

    /// Measures a body at the start of a frame; bodies follow each other.
    pub(crate) fn begin(&mut self, body: &GuardedBody<'_>, inputs: &GuardInputs) {
        let pieces = body.pieces.iter();
        self.start
            .extend(pieces.map(|vertices| body.motion(vertices, inputs)));
    }

    /// Measures a body at the end of a frame; bodies follow each other as at its start.
    ///
    /// `met_collider` tells whether one has moved it.
    pub(crate) fn end(&mut self, body: &GuardedBody<'_>, inputs: &GuardInputs, met_collider: bool) {
        let is_free = !(inputs.has_contacts || met_collider);
        let constants = &inputs.constants;
        let fall = constants
            .gravity_step
            .map(|g| g * constants.substeps as f32);
        let mut energies = Energies::default();
        let first = self.end.len();
        for (start, vertices) in self.start[first..].iter().zip(body.pieces.iter()) {
            let motion = body.motion(vertices, inputs);
            let turn = motion.angular_velocity(motion.angular_momentum);
            let mut change = Change {
                motion,
                is_held: motion.pin_count > 0.0 || met_collider,
                turn,
                velocity_change: [0.0; 3],
                turn_change: [0.0; 3],
            };
            let (mut velocity, mut momentum) = (motion.velocity, motion.angular_momentum);
            let rigid = motion.rigid_energy(velocity, turn, momentum);
            if inputs.conserves && is_free && motion.pin_count == 0.0 {
                velocity = add(start.velocity, fall);
                momentum = start.angular_momentum;
                change.velocity_change = subtract(velocity, motion.velocity);
                change.turn_change =
                    motion.angular_velocity(subtract(momentum, motion.angular_momentum));
            }
            let relative = motion.kinetic_energy - rigid;
            let relative = if relative > 0.0 { relative } else { 0.0 };
            let moved = add(
                subtract(motion.origin, start.origin),
                subtract(motion.center, start.center),
            );
            energies.mass += motion.mass;
            energies.before += start.kinetic_energy;
            let rigid = motion.rigid_energy(velocity, add(turn, change.turn_change), momentum);
            energies.rigid += rigid;
            energies.held += if change.is_held { rigid } else { 0.0 };
            energies.relative += (inputs.damping_factor * inputs.damping_factor) * relative;
            energies.potential_change -=
                motion.mass * dot(constants.gravity_step, moved) / constants.h;
            self.end.push(change);
        }
        self.energies.push(energies);
    }

    /// Changes the velocities of bodies with a common budget of `slack` \[J\], and their budgets.
    ///
    /// These are the next `count` of the measured ones.
    pub(crate) fn finish<'a>(
        &self,
        bodies: impl Iterator<Item = (GuardedBody<'a>, GuardInputs)>,
        place: &mut GuardCursor,
        count: usize,
        slack: f32,
    ) {
        let energies = &self.energies[place.body..place.body + count];
        let sum = |of: fn(&Energies) -> f32| energies.iter().map(of).fold(0.0, |a, b| a + b);
        let (relative, held) = (sum(|e| e.relative), sum(|e| e.held));
        let gain = sum(Energies::gain);
        let excess = gain - slack;
        let scale = scale_to_lose(excess, relative);
        let held_scale = scale_to_lose(excess - relative, held);
        let lost = (1.0 - scale * scale) * relative + (1.0 - held_scale * held_scale) * held;
        let slack = slack + (lost - gain);
        let slack = if slack > 0.0 { slack } else { 0.0 };
        let mass = sum(|e| e.mass);
        for ((mut body, inputs), energies) in bodies.zip(energies) {
            let changes = &self.end[place.piece..place.piece + body.pieces.len()];
            for (vertices, change) in body.pieces.iter().zip(changes) {
                let rigid = if change.is_held { held_scale } else { 1.0 };
                let factors = [inputs.damping_factor * scale, rigid];
                if !(factors == [1.0; 2] && change.is_none()) {
                    change.apply(body.positions, body.velocities, vertices, factors);
                }
            }
            place.piece += changes.len();
            let share = if mass > 0.0 {
                energies.mass / mass
            } else {
                0.0
            };
            if inputs.conserves {
                body.update_budget(&inputs, slack * share);
            }
        }
        place.body += count;
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.start.capacity() + self.end.capacity() + self.energies.capacity()
    }
}

/// Returns the factor of velocities by which a kinetic energy loses `excess`, at most all of it.
fn scale_to_lose(excess: f32, energy: f32) -> f32 {
    if !(excess > 0.0 && energy > 0.0) {
        return 1.0;
    }
    let kept = 1.0 - excess / energy;
    (if kept > 0.0 { kept } else { 0.0 }).sqrt()
}

impl Change {
    fn is_none(&self) -> bool {
        self.velocity_change == [0.0; 3] && self.turn_change == [0.0; 3]
    }

    /// Changes the velocities of a piece, with factors of the relative and the rigid motion.
    #[inline(always)]
    fn apply(
        &self,
        positions: &[[f32; 4]],
        velocities: &mut [[f32; 4]],
        vertices: &[VertexId],
        [relative, rigid]: [f32; 2],
    ) {
        let RigidMotion {
            origin,
            center,
            velocity,
            ..
        } = self.motion;
        for v in vertices {
            let [x, y, z, w] = positions[v.index()];
            if w > 0.0 {
                let arm = subtract(subtract([x, y, z], origin), center);
                let v = &mut velocities[v.index()];
                let own = [v[0], v[1], v[2]];
                let rigid_velocity = add(velocity, cross(self.turn, arm));
                let relative_velocity = subtract(own, rigid_velocity);
                let restored = add(self.velocity_change, cross(self.turn_change, arm));
                for k in 0..3 {
                    let scaled =
                        (relative - 1.0) * relative_velocity[k] + (rigid - 1.0) * rigid_velocity[k];
                    v[k] += scaled + restored[k];
                }
            }
        }
    }
}

impl RigidMotion {
    /// Returns the kinetic energy of a rigid motion \[J\].
    #[inline(always)]
    fn rigid_energy(&self, velocity: [f32; 3], turn: [f32; 3], momentum: [f32; 3]) -> f32 {
        0.5 * (self.mass * dot(velocity, velocity) + dot(turn, momentum))
    }
}

impl GuardedBody<'_> {
    /// Measures a piece.
    fn motion(&self, vertices: &[VertexId], inputs: &GuardInputs) -> RigidMotion {
        let (positions, velocities) = (self.positions, &*self.velocities);
        RigidMotion::from_vertices(positions, velocities, vertices, inputs.has_pins)
    }

    /// Updates the budget after a frame that left `slack` \[J\].
    fn update_budget(&mut self, inputs: &GuardInputs, slack: f32) {
        let (mut slack, mut age) = (slack, self.budget.age + inputs.time());
        if inputs.is_driven {
            (slack, age) = (UNLIMITED, 0.0);
        } else if let Some(relaxation) = inputs.relaxation {
            let elastic = match self.cells {
                Some(cells) => cell_energy(cells, &inputs.constants),
                None => elastic_energy(self.positions, self.sets, &inputs.constants),
            };
            if inputs.is_unlimited {
                slack = elastic;
            } else if slack > elastic {
                slack = elastic + (slack - elastic) * relaxation;
            }
            age = 0.0;
        }
        *self.budget = EnergyBudget { slack, age };
    }
}

#[inline(always)]
fn add(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
fn subtract(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}
