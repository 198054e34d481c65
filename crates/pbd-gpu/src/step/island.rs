//! [`Island`]: bodies in contact with each other, which are stepped in lockstep.
//!
//! The states of all bodies lie in one array during a frame, body after body. A contact refers to
//! them by island vertex: the number of vertex slots of the bodies before plus the vertex.

use crate::constraints::contacts::{Contact, ContactSet, LoadRatio};
use crate::error::{ConstraintError, StepError};
use crate::kernels::integrate::first_non_finite;
use crate::solver::Solver;
use crate::step::backend::{NonFinite, StepScratch, execute};
use crate::step::body::Body;
use crate::step::constants::StepConstants;
use crate::step::guard::{Guard, GuardCursor, GuardInputs};
use crate::step::params::{Integrator, SolverParams, StepStats};
use crate::step::prepare::{FrameInputs, both_orders};
use crate::step::reach::{max_motion, reaches_colliders};
use crate::step::rounds::contact_rounds;
use crate::step::second_order::{Orders, add};
use crate::step::substeps::Substeps;
use incise_mesh::Surface;

/// A body of an island: its solver and its surface.
pub type IslandBody<'a> = (&'a mut Solver, &'a mut Surface);

/// The contacts of touching bodies, and the memory of their steps.
///
/// In contacts, the planes among the colliders of one body hold for all of them.
#[derive(Debug, Clone, Default)]
pub struct Island {
    contacts: ContactSet,
    /// Vertex slots of the bodies that the contacts are for.
    vertices: usize,
    members: Vec<Member>,
    /// Substeps of the frame.
    substeps: Substeps,
    /// Time that the frame leaves to the next one, in substeps.
    time_left: f64,
    integrator: Integrator,
    /// Statistics of the second-order substeps so far, by member.
    sums: Vec<StepStats>,
    scratch: StepScratch,
    guard: Guard,
}

/// A body during a frame of its island.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Member {
    /// Constants of the current substeps.
    pub(crate) constants: StepConstants,
    pub(crate) guard: Option<GuardInputs>,
    /// Constants of second-order integration.
    pub(crate) orders: Orders,
    /// Upper bound of the change of a coordinate before the current second-order substep \[m\].
    extrapolated: f32,
    /// Number of the island's particles before its own: vertices, or nodes of a solid.
    pub(crate) first: usize,
    /// Island vertex of its first vertex.
    pub(crate) first_vertex: usize,
    /// Whether its pins are those of the current second-order substep.
    pub(crate) has_own_pins: bool,
    pub(crate) has_volumes: bool,
    /// Whether a collider may reach it within the frame.
    pub(crate) reaches_colliders: bool,
    /// Whether a vertex was in a collider since the last execution began.
    pub(crate) meets_collider: bool,
    /// Whether a vertex was in a collider since the frame began.
    pub(crate) met_collider: bool,
    pub(crate) stats: StepStats,
}

/// An error of one body of an island.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IslandError {
    /// Index of the body in the island.
    pub body: usize,
    /// The error.
    pub error: StepError,
}

impl Island {
    /// Returns the contacts of the next frames.
    #[must_use]
    pub fn contacts(&self) -> &ContactSet {
        &self.contacts
    }

    /// Sets the contacts of the next frames of bodies with `vertices` vertex slots in total.
    ///
    /// They stay until they are set again.
    /// Contacts of a single body belong to its solver, see [`Solver::set_contacts`].
    ///
    /// # Errors
    /// As [`Solver::set_contacts`], for island vertices; nothing is changed then.
    pub fn set_contacts(
        &mut self,
        contacts: &[Contact],
        vertices: usize,
    ) -> Result<(), ConstraintError> {
        for contact in contacts {
            contact.check(|v| v.index() < vertices)?;
        }
        self.contacts.set(contacts, vertices);
        self.vertices = vertices;
        Ok(())
    }

    /// Steps bodies by one frame of `dt` \[s\] on the CPU.
    ///
    /// A substep of all bodies ends before the next one begins. [`Solver::stats`] has the
    /// statistics of each body; contacts count for the first one.
    ///
    /// # Errors
    /// [`IslandError`] as in [`Solver::step`]; [`StepError::ContactMismatch`] for contacts that
    /// were set for other bodies or before an edit. After [`StepError::NonFinitePosition`] all
    /// bodies must be created again.
    pub fn step(
        &mut self,
        bodies: &mut [IslandBody<'_>],
        dt: f32,
        params: &SolverParams,
    ) -> Result<(), IslandError> {
        self.prepare(bodies, dt, params)?;
        let slots = bodies.iter().map(|(_, surface)| surface.positions().len());
        let slots = slots.sum();
        if !self.contacts.is_empty() && slots != self.vertices {
            let error = StepError::ContactMismatch {
                contacts: self.vertices,
                bodies: slots,
            };
            return Err(IslandError { body: 0, error });
        }
        let mut contacts = std::mem::take(&mut self.contacts);
        let done = self.run(bodies, &mut contacts);
        self.contacts = contacts;
        done
    }

    /// Validates the bodies and computes the constants of a frame.
    ///
    /// # Errors
    /// As [`Self::step`]; nothing has moved then.
    pub(crate) fn prepare(
        &mut self,
        bodies: &mut [IslandBody<'_>],
        dt: f32,
        params: &SolverParams,
    ) -> Result<(), IslandError> {
        self.members.clear();
        params
            .check(dt)
            .map_err(|error| IslandError { body: 0, error })?;
        // Bodies that were created at different times may have different remainders, by less
        // than a substep. In lockstep that of the first one holds for all.
        let (substeps, time_left) = match bodies.first() {
            Some((first, _)) => first.substeps_of(dt, params),
            None => Default::default(),
        };
        let needed = bodies
            .iter_mut()
            .map(|(solver, _)| solver.needed_parts(substeps.h, params));
        let substeps = substeps.divided(needed.fold(1, u32::max));
        (self.substeps, self.time_left) = (substeps, time_left);
        // The prediction of a solid repeats forces instead of an earlier motion.
        let has_solid = bodies.iter().any(|(solver, _)| solver.is_solid());
        self.integrator = if has_solid {
            Integrator::Euler
        } else {
            params.integrator
        };
        let presses = bodies.iter().map(|(solver, _)| solver.contacts().press());
        let press = presses.fold(self.contacts.press(), LoadRatio::max);
        let frame = FrameInputs {
            dt,
            substeps,
            has_contacts: !self.contacts.is_empty(),
            contact_rounds: contact_rounds(substeps.h, press, params.gravity),
            reaches_colliders: true,
        };
        let reach = max_motion(bodies, dt + substeps.h, params.gravity);
        for (body, (solver, surface)) in bodies.iter_mut().enumerate() {
            let frame = FrameInputs {
                reaches_colliders: reaches_colliders(solver, surface, reach, dt),
                ..frame
            };
            let has_contacts = !self.contacts.is_empty();
            let member = prepare_member(solver, surface, frame, has_contacts, params);
            self.members
                .push(member.map_err(|error| IslandError { body, error })?);
        }
        Ok(())
    }

    /// Steps the prepared bodies by one frame.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub(crate) fn run(
        &mut self,
        bodies: &mut [IslandBody<'_>],
        contacts: &mut ContactSet,
    ) -> Result<(), IslandError> {
        let Self {
            members,
            sums,
            scratch,
            guard,
            substeps,
            time_left,
            integrator,
            ..
        } = self;
        let has_contacts = !contacts.is_empty();
        begin_guard(guard, bodies, members);
        let done = match integrator {
            Integrator::Euler => {
                for (solver, _) in bodies.iter_mut() {
                    solver.step_parts().2.history.forget();
                }
                execute(bodies, members, contacts, 0..substeps.count, scratch)
            }
            Integrator::Bdf2 => {
                sums.clear();
                sums.resize(members.len(), StepStats::default());
                run_second_order(bodies, members, sums, contacts, substeps.count, scratch)
            }
        };
        if done.is_ok() {
            end_guard(guard, bodies, members, has_contacts);
        }
        for (solver, surface) in bodies.iter_mut() {
            solver.embed(surface);
        }
        if *integrator == Integrator::Bdf2 {
            for (solver, surface) in bodies.iter_mut() {
                let (particles, _, step) = solver.step_parts();
                let positions = surface.positions();
                step.history.end_frame(positions, &particles.velocities);
            }
        }
        for ((solver, _), member) in bodies.iter_mut().zip(&*members) {
            solver.set_time_left(*time_left);
            solver.end_step(done.is_ok().then_some(member.stats));
        }
        done.map_err(|at| {
            let error = StepError::NonFinitePosition {
                vertex: first_non_finite(bodies[at.body].1.positions()),
                substep: at.substep,
            };
            IslandError {
                body: at.body,
                error,
            }
        })
    }

    /// Returns the allocated size in elements.
    pub(crate) fn capacity(&self) -> usize {
        self.contacts.capacity()
            + self.members.capacity()
            + self.sums.capacity()
            + self.scratch.capacity()
            + self.guard.capacity()
    }
}

/// Validates a body and computes its constants of a frame.
fn prepare_member(
    solver: &mut Solver,
    surface: &mut Surface,
    frame: FrameInputs,
    has_contacts: bool,
    params: &SolverParams,
) -> Result<Member, StepError> {
    solver.check_step(surface)?;
    if solver.adopt_motion(surface) {
        solver.embed(surface);
    }
    solver.begin_pins();
    let constants = solver.prepare(frame, params)?;
    let orders = both_orders(solver.material(), &frame, params);
    let guard = solver.prepare_guard(&constants, has_contacts, params);
    let (_, constraints, _) = solver.step_parts();
    constraints.update_patch_contents();
    if guard.is_some() {
        constraints.update_pieces(surface);
    }
    Ok(Member {
        constants,
        guard,
        orders,
        extrapolated: 0.0,
        first: 0,
        first_vertex: 0,
        has_own_pins: false,
        has_volumes: !constraints.volumes.pieces().is_empty(),
        reaches_colliders: frame.reaches_colliders,
        meets_collider: false,
        met_collider: false,
        stats: StepStats::default(),
    })
}

/// Steps bodies by a frame with second order where their histories are valid.
fn run_second_order(
    bodies: &mut [IslandBody<'_>],
    members: &mut [Member],
    sums: &mut [StepStats],
    contacts: &mut ContactSet,
    substeps: u32,
    scratch: &mut StepScratch,
) -> Result<(), NonFinite> {
    for ((solver, surface), member) in bodies.iter_mut().zip(&mut *members) {
        let (particles, constraints, step) = solver.step_parts();
        let body = Body::new(particles, constraints, surface);
        step.history.begin_frame(member.orders.first.h, &body);
        member.has_own_pins = true;
    }
    let mut done = Ok(());
    for substep in 0..substeps {
        for ((solver, surface), member) in bodies.iter_mut().zip(&mut *members) {
            let (particles, constraints, step) = solver.step_parts();
            let mut body = Body::new(particles, constraints, surface);
            let history = &mut step.history;
            let (constants, extrapolated) =
                history.begin_substep(&member.orders, &mut body, substeps - substep);
            member.constants = constants;
            member.extrapolated = extrapolated;
        }
        done = execute(bodies, members, contacts, substep..substep + 1, scratch);
        let states = members.iter_mut().zip(&mut *sums);
        for ((solver, _), (member, sum)) in bodies.iter_mut().zip(states) {
            let (_, _, step) = solver.step_parts();
            step.history
                .end_substep(done.is_ok(), member.meets_collider);
            member.stats.max_displacement += member.extrapolated;
            member.stats.max_substep_displacement += member.extrapolated;
            add(sum, &member.stats);
        }
        if done.is_err() {
            break;
        }
    }
    for (member, sum) in members.iter_mut().zip(&*sums) {
        member.stats = *sum;
    }
    done
}

/// Measures the rigid motions of guarded bodies at the start of a frame.
fn begin_guard(guard: &mut Guard, bodies: &mut [IslandBody<'_>], members: &[Member]) {
    guard.clear();
    for ((solver, surface), member) in bodies.iter_mut().zip(members) {
        if let Some(inputs) = &member.guard {
            guard.begin(&solver.guarded(surface), inputs);
        }
    }
}

/// Applies damping, momenta and the energy budget of an island at the end of a frame.
///
/// Bodies in contact have a common budget, and others each their own.
fn end_guard(
    guard: &mut Guard,
    bodies: &mut [IslandBody<'_>],
    members: &[Member],
    has_contacts: bool,
) {
    for ((solver, surface), member) in bodies.iter_mut().zip(members) {
        if let Some(inputs) = &member.guard {
            guard.end(&solver.guarded(surface), inputs, member.met_collider);
        }
    }
    let size = if has_contacts { bodies.len() } else { 1 };
    let mut place = GuardCursor::default();
    for (bodies, members) in bodies
        .chunks_mut(size.max(1))
        .zip(members.chunks(size.max(1)))
    {
        let (mut slack, mut count) = (0.0, 0);
        for ((solver, surface), member) in bodies.iter_mut().zip(members) {
            if member.guard.is_some() {
                slack += solver.guarded(surface).budget.slack;
                count += 1;
            }
        }
        let guarded = bodies.iter_mut().zip(members);
        let guarded = guarded.filter_map(|((solver, surface), member)| {
            Some((solver.guarded(surface), member.guard?))
        });
        guard.finish(guarded, &mut place, count, slack);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constraints::batches::StretchSet;
    use crate::material::{Material, Stiffness};
    use incise_mesh::VertexId;

    /// A spring between a pinned and a free corner of a triangle that has no other constraints.
    #[test]
    fn a_spring_moves_as_in_backward_euler() {
        let (compliance, h) = (1e-3_f32, 0.01_f32);
        for iterations in [1, 5] {
            let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            let mut surface = Surface::from_triangles(&corners, &[[0, 1, 2]]).unwrap();
            let material = Material {
                stretch: Stiffness::Compliance(compliance),
                bending: None,
                ..Material::default()
            };
            let mut solver = Solver::new(&mut surface, &material).unwrap();
            solver.pin(&mut surface, VertexId(0)).unwrap();
            let mut spring = StretchSet::new(3);
            spring.insert([VertexId(0), VertexId(1)], 1.0);
            solver.step_parts().1.stretch = spring;
            surface.positions_mut()[1][0] = 1.25;
            let mass = solver.masses()[1];
            let params = SolverParams {
                iterations,
                gravity: [0.0; 3],
                ..SolverParams::paper()
            };
            let stiff = 1.0 + f64::from(h * h) / f64::from(compliance * mass);
            let mut expected = 0.25;
            let mut before = expected;
            for step in 0..200 {
                solver.step(&mut surface, h, &params).unwrap();
                (before, expected) = (expected, (2.0 * expected - before) / stiff);
                let found = f64::from(surface.positions()[1][0]) - 1.0;
                assert!(
                    (found - expected).abs() < 2e-6,
                    "{found}, not {expected}, in step {step} with {iterations} iterations"
                );
            }
        }
    }
}
