//! Merges the step plans of all bodies into one list of dispatches.
//!
//! Bodies share dispatches. A GPU finishes a dispatch before it starts the next one that writes the
//! same arrays, so separate dispatches for each body would leave it idle.

use super::body::DeviceBody;
use super::layout::{CELL_FORCES, CELLS, Link, PassUniform, STRETCH};
use super::pipelines::{Kernel, Lanes};
use super::shaders::EntryPoint;
use super::stats::Schedule;
use crate::step::pass::Pass;
use crate::step::plan::StepPlan;
use incise_mesh::index_u32;

/// Parameters of a pass without kind and color.
pub(super) const PLAIN_PASS: PassUniform = PassUniform {
    first_link: 0,
    links: 0,
    kind: STRETCH,
    color: 0,
    colors: 0,
    with_overflow: 0,
    substep: 0,
    is_back: 0,
};

/// One dispatch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dispatch {
    pub(super) kernel: Kernel,
    /// Index of its parameters in the first substep.
    pub(super) pass: u32,
    /// True if every substep has its own parameters.
    pub(super) by_substep: bool,
    pub(super) groups: u32,
}

/// A body in the program.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stepped<'a> {
    /// Slot of the body.
    pub(super) slot: u32,
    pub(super) body: &'a DeviceBody,
    pub(super) plan: &'a StepPlan,
}

/// All dispatches of a frame.
#[derive(Debug, Default)]
pub(super) struct Program {
    /// Dispatches of the whole-body schedule: one per frame, or several on adapters that limit
    /// loops.
    pub(super) whole: Vec<Dispatch>,
    /// Dispatches of a substep: the prologue, `iterations` times the iteration, the epilogue.
    ///
    /// More than one of the `contact_rounds` repeat the last dispatches of an iteration.
    pub(super) prologue: Vec<Dispatch>,
    pub(super) iteration: Vec<Dispatch>,
    pub(super) contact_round: Vec<Dispatch>,
    pub(super) epilogue: Vec<Dispatch>,
    /// The sums of the forces of cells before the first substep, if they are needed.
    pub(super) sums: Vec<Dispatch>,
    /// The vertices of solids near colliders, before the first substep.
    pub(super) near: Option<Dispatch>,
    /// The vertices of solids, after the guard.
    pub(super) embedding: Option<Dispatch>,
    /// The guard before and after all substeps, if a body has one.
    pub(super) guard: [Option<Dispatch>; 2],
    /// Bounding boxes after the last substep, if requested.
    pub(super) bounds: [Option<Dispatch>; 2],
    pub(super) iterations: u32,
    pub(super) contact_rounds: u32,
    /// Maximum number of substeps of a frame.
    pub(super) substeps: u32,
    pub(super) passes: Vec<PassUniform>,
    pub(super) links: Vec<Link>,
}

/// Builds a program.
pub(super) struct Compiler<'a> {
    bodies: &'a [Stepped<'a>],
    pub(super) workgroup: u32,
    pub(super) lanes: Lanes,
    /// Whether dispatches are those of a second or later round of an iteration.
    pub(super) is_later_round: bool,
    program: Program,
}

impl Program {
    /// Compiles the plans of bodies.
    pub(super) fn compile(bodies: &[Stepped<'_>], substeps: u32, lanes: Lanes) -> Self {
        let mut compiler = Compiler {
            bodies,
            workgroup: lanes.pass,
            lanes,
            is_later_round: false,
            program: Self {
                substeps,
                iterations: bodies.first().map_or(0, |b| b.plan.iterations()),
                contact_rounds: bodies.first().map_or(1, |b| b.plan.contact_rounds()),
                ..Self::default()
            },
        };
        compiler.whole_bodies(lanes);
        let prologue = compiler.merged(StepPlan::prologue);
        compiler.program.prologue = compiler.dispatches(&prologue);
        let iteration = compiler.merged(StepPlan::iteration);
        compiler.program.iteration = compiler.dispatches(&iteration);
        let round = compiler.merged(StepPlan::contact_round);
        compiler.is_later_round = true;
        compiler.program.contact_round = compiler.dispatches(&round);
        compiler.is_later_round = false;
        let epilogue = compiler.merged(StepPlan::epilogue);
        compiler.program.epilogue = compiler.dispatches(&epilogue);
        compiler.force_sums();
        compiler.program.near = compiler.solids(EntryPoint::FindNear);
        compiler.program.embedding = compiler.solids(EntryPoint::Embed);
        compiler.guard();
        compiler.bounds();
        compiler.program
    }

    /// Returns a program that only computes the bounding box of one body.
    pub(super) fn bounds_of(slot: u32, vertices: u32, lanes: Lanes) -> Self {
        let mut compiler = Compiler {
            bodies: &[],
            workgroup: lanes.pass,
            lanes,
            is_later_round: false,
            program: Self::default(),
        };
        compiler.bounds_of(&[(slot, vertices)]);
        compiler.program
    }

    /// Returns the number of dispatches of a frame of that many substeps.
    pub(super) fn dispatches(&self, substeps: u32, with_bounds: bool) -> u32 {
        let count = |list: &[Dispatch]| list.len() as u64;
        let more_rounds =
            u64::from(self.contact_rounds.saturating_sub(1)) * count(&self.contact_round);
        let substep = count(&self.prologue)
            + u64::from(self.iterations) * (count(&self.iteration) + more_rounds)
            + count(&self.epilogue);
        let bounds = self.bounds.iter().flatten().count() * usize::from(with_bounds);
        let solids = self.near.iter().chain(&self.embedding).count();
        let once = self.whole.len() + bounds + solids;
        let all = u64::from(substeps).saturating_mul(substep);
        u32::try_from(all.saturating_add(once as u64)).unwrap_or(u32::MAX)
    }

    /// Returns the kernels of every frame.
    pub(super) fn kernels(&self) -> impl Iterator<Item = Kernel> {
        let lists = [&self.prologue, &self.iteration, &self.epilogue];
        let dispatches = lists.into_iter().flatten().chain(&self.whole);
        let of_solids = self.near.iter().chain(&self.embedding);
        dispatches.chain(of_solids).map(|d| d.kernel)
    }

    /// Returns the kernels of bounding boxes.
    pub(super) fn kernels_of_bounds(&self) -> impl Iterator<Item = Kernel> {
        self.bounds.iter().flatten().map(|d| d.kernel)
    }
}

impl Compiler<'_> {
    /// Returns the bodies of [`Schedule::Patches`].
    pub(super) fn by_passes(&self) -> impl Iterator<Item = &Stepped<'_>> {
        (self.bodies.iter()).filter(|b| b.body.schedule == Schedule::Patches)
    }

    /// Merges the passes of these bodies in the order of [`Pass`].
    fn merged(&self, part: impl Fn(&StepPlan) -> &[Pass]) -> Vec<Pass> {
        let all = self.by_passes().flat_map(|b| part(b.plan));
        let mut passes: Vec<Pass> = all.copied().collect();
        passes.sort_unstable();
        passes.dedup();
        passes
    }

    fn whole_bodies(&mut self, lanes: Lanes) {
        let bodies = self.bodies.iter();
        let whole = || {
            let bodies = bodies.clone();
            bodies.filter(|b| b.body.schedule == Schedule::WholeBody)
        };
        let links: Vec<(u32, u32)> = whole().map(|b| (b.slot, self.workgroup)).collect();
        let substeps = self.program.substeps;
        let max_rounds = whole()
            .map(|b| b.body.rounds(lanes.whole_body, b.plan))
            .max();
        let at_once =
            (lanes.rounds / max_rounds.unwrap_or(1).max(1)).clamp(1, u64::from(substeps.max(1)));
        let at_once = u32::try_from(at_once).unwrap_or(u32::MAX);
        for substep in (0..substeps).step_by(at_once as usize) {
            let pass = PassUniform {
                substep,
                colors: at_once.min(substeps - substep),
                ..PLAIN_PASS
            };
            let dispatch = self.dispatch(Kernel::WholeBody, pass, false, &links);
            self.program.whole.extend(dispatch);
        }
    }

    /// Adds the guard, one workgroup per body.
    fn guard(&mut self) {
        let bodies = self.bodies.iter();
        let lanes: Vec<(u32, u32)> = bodies.map(|b| (b.slot, self.workgroup)).collect();
        self.program.guard = [EntryPoint::BeginGuard, EntryPoint::EndGuard]
            .map(|entry| self.dispatch(Kernel::Pass(entry), PLAIN_PASS, false, &lanes));
    }

    /// Adds the sums of the forces of cells at nodes.
    fn force_sums(&mut self) {
        let mut sums = Vec::new();
        sums.extend(self.solids(EntryPoint::ClearForces));
        let merged = self.merged(StepPlan::iteration);
        let cells: Vec<Pass> = (merged.into_iter())
            .filter(|pass| matches!(pass, Pass::Cells(_)))
            .collect();
        self.cells(CELL_FORCES, &cells, &mut sums);
        self.program.sums = sums;
    }

    fn bounds(&mut self) {
        let lanes: Vec<(u32, u32)> = (self.bodies.iter())
            .map(|b| (b.slot, b.body.vertex_count))
            .collect();
        self.bounds_of(&lanes);
    }

    fn bounds_of(&mut self, lanes: &[(u32, u32)]) {
        let reset = Kernel::Pass(EntryPoint::ResetBounds);
        let reset = self
            .dispatch(reset, PLAIN_PASS, false, lanes)
            .map(|d| Dispatch {
                // One lane per link.
                groups: self.program.passes[d.pass as usize]
                    .links
                    .div_ceil(self.workgroup),
                ..d
            });
        let bounds = Kernel::Pass(EntryPoint::Bounds);
        self.program.bounds = [reset, self.dispatch(bounds, PLAIN_PASS, false, lanes)];
    }

    fn dispatches(&mut self, passes: &[Pass]) -> Vec<Dispatch> {
        let mut out = Vec::new();
        let together = |a: &Pass, b: &Pass| {
            let is_same = a.kind_and_layer() == b.kind_and_layer() && a.is_back() == b.is_back();
            let are_cells = |a, b| matches!((a, b), (Pass::Cells(_), Pass::Cells(_)));
            a.kind_and_layer().is_some() && is_same || are_cells(*a, *b)
        };
        // Both kinds of a layer share one dispatch over its patches.
        let mut layer = None;
        for run in passes.chunk_by(together) {
            match run[0] {
                Pass::Project { kind, batch } | Pass::ProjectBack { kind, batch } => {
                    let way = (batch.layer(), run[0].is_back());
                    if layer.replace(way) != Some(way) && way.0 > 0 {
                        out.extend(self.patches(Kernel::Patches, way.0, way.1));
                    }
                    self.batches(kind, run, &mut out);
                }
                Pass::ResetMultipliers => self.resets(&mut out),
                Pass::ContactFeatures
                | Pass::ContactsBeforeVolumes
                | Pass::Contacts
                | Pass::ContactRecovery => self.contacts(run[0], &mut out),
                Pass::Volumes => self.volumes(&mut out),
                Pass::Cells(_) => self.cells(CELLS, run, &mut out),
                Pass::SolidPins => out.extend(self.solids(EntryPoint::SolidPins)),
                Pass::SolidSupports => {
                    out.extend(self.solids(EntryPoint::SolidPins));
                    out.extend(self.solids(EntryPoint::SolidColliders));
                }
                Pass::Predict | Pass::Colliders => {
                    out.extend(self.vertices(run[0]));
                    out.extend(self.solids(match run[0] {
                        Pass::Predict => EntryPoint::PredictNodes,
                        _ => EntryPoint::SolidColliders,
                    }));
                }
                pass => out.extend(self.vertices(pass)),
            }
        }
        out
    }

    /// Adds a dispatch over bodies with their numbers of lanes; `None` without any lane.
    pub(super) fn dispatch(
        &mut self,
        kernel: Kernel,
        pass: PassUniform,
        by_substep: bool,
        lanes: &[(u32, u32)],
    ) -> Option<Dispatch> {
        let first_link = index_u32(self.program.links.len());
        let mut groups = 0;
        for &(body, lanes) in lanes.iter().filter(|(_, lanes)| *lanes > 0) {
            self.program.links.push(Link {
                first_group: groups,
                body,
            });
            groups += lanes.div_ceil(self.workgroup);
        }
        let links = index_u32(self.program.links.len()) - first_link;
        if links == 0 {
            return None;
        }
        let dispatch = Dispatch {
            kernel,
            pass: index_u32(self.program.passes.len()),
            by_substep,
            groups,
        };
        for substep in 0..if by_substep { self.program.substeps } else { 1 } {
            self.program.passes.push(PassUniform {
                first_link,
                links,
                substep: pass.substep + substep,
                ..pass
            });
        }
        Some(dispatch)
    }
}
