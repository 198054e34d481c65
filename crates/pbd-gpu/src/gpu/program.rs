//! The plans of all bodies as one list of dispatches.
//!
//! Bodies share dispatches: a device finishes one before it starts the next that writes the same
//! arrays, so a dispatch a body would leave it idle most of the time.

use super::body::DeviceBody;
use super::layout::{BENDING, Link, PassUniform, STRETCH, STRUTS};
use super::pipelines::{Kernel, Lanes};
use super::shaders::EntryPoint;
use super::stats::Schedule;
use crate::coloring::MAX_COLORS;
use crate::plan::{Pass, StepPlan};

/// A pass over whatever its links say.
pub(super) const NOTHING: PassUniform = PassUniform {
    first_link: 0,
    links: 0,
    kind: STRETCH,
    color: 0,
    colors: 0,
    with_overflow: 0,
    substep: 0,
    pad: 0,
};

/// One dispatch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dispatch {
    pub(super) kernel: Kernel,
    /// Which pass record it reads, in the first substep.
    pub(super) pass: u32,
    /// Whether every substep has a record of its own.
    pub(super) by_substep: bool,
    pub(super) groups: u32,
}

/// A body that is stepped.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stepped<'a> {
    /// The body's place on the device.
    pub(super) slot: u32,
    pub(super) body: &'a DeviceBody,
    pub(super) plan: &'a StepPlan,
}

/// All dispatches of a frame.
#[derive(Debug, Default)]
pub(super) struct Program {
    /// Bodies that a workgroup steps alone: one dispatch a frame, or several where the device ends loops early.
    pub(super) whole: Vec<Dispatch>,
    /// Once a substep, then `iterations` times, then once.
    pub(super) prologue: Vec<Dispatch>,
    pub(super) iteration: Vec<Dispatch>,
    pub(super) epilogue: Vec<Dispatch>,
    /// After the last substep, if somebody asks for boxes.
    pub(super) bounds: [Option<Dispatch>; 2],
    pub(super) iterations: u32,
    pub(super) substeps: u32,
    pub(super) passes: Vec<PassUniform>,
    pub(super) links: Vec<Link>,
}

/// Makes programs.
pub(super) struct Compiler<'a> {
    bodies: &'a [Stepped<'a>],
    pub(super) workgroup: u32,
    program: Program,
}

impl Program {
    /// Makes the program of some bodies for workgroups of `workgroup` lanes.
    pub(super) fn compile(bodies: &[Stepped<'_>], substeps: u32, lanes: Lanes) -> Self {
        let mut compiler = Compiler {
            bodies,
            workgroup: lanes.pass,
            program: Self {
                substeps,
                iterations: bodies.first().map_or(0, |b| b.plan.iterations()),
                ..Self::default()
            },
        };
        compiler.whole_bodies(lanes);
        let prologue = compiler.merged(StepPlan::prologue);
        compiler.program.prologue = compiler.dispatches(&prologue);
        let iteration = compiler.merged(StepPlan::iteration);
        compiler.program.iteration = compiler.dispatches(&iteration);
        let epilogue = compiler.merged(StepPlan::epilogue);
        compiler.program.epilogue = compiler.dispatches(&epilogue);
        compiler.bounds();
        compiler.program
    }

    /// A program that finds the box of one body of so many vertices and does nothing else.
    pub(super) fn bounds_of(slot: u32, vertices: u32, workgroup: u32) -> Self {
        let mut compiler = Compiler {
            bodies: &[],
            workgroup,
            program: Self::default(),
        };
        compiler.bounds_of(&[(slot, vertices)]);
        compiler.program
    }

    /// How many dispatches a frame has.
    pub(super) fn dispatches(&self, with_bounds: bool) -> u32 {
        let count = |list: &[Dispatch]| list.len() as u64;
        let substep = count(&self.prologue)
            + u64::from(self.iterations) * count(&self.iteration)
            + count(&self.epilogue);
        let bounds = self.bounds.iter().flatten().count() * usize::from(with_bounds);
        let once = self.whole.len() + bounds;
        let all = u64::from(self.substeps).saturating_mul(substep);
        u32::try_from(all.saturating_add(once as u64)).unwrap_or(u32::MAX)
    }

    /// The kernels that the program needs in every frame.
    pub(super) fn kernels(&self) -> impl Iterator<Item = Kernel> {
        let lists = [&self.prologue, &self.iteration, &self.epilogue];
        let dispatches = lists.into_iter().flatten().chain(&self.whole);
        dispatches.map(|d| d.kernel)
    }

    /// The kernels that it needs if somebody asks for boxes.
    pub(super) fn kernels_of_bounds(&self) -> impl Iterator<Item = Kernel> {
        self.bounds.iter().flatten().map(|d| d.kernel)
    }
}

impl Compiler<'_> {
    /// Those that go pass by pass, by patches too.
    pub(super) fn by_passes(&self) -> impl Iterator<Item = &Stepped<'_>> {
        (self.bodies.iter()).filter(|b| b.body.schedule != Schedule::WholeBody)
    }

    /// The passes of all bodies that go pass by pass, in the order that all of them have.
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
        let (substeps, iterations) = (self.program.substeps, self.program.iterations);
        let most = whole()
            .map(|b| b.body.rounds(lanes.whole_body, iterations))
            .max();
        let at_once =
            (lanes.rounds / most.unwrap_or(1).max(1)).clamp(1, u64::from(substeps.max(1)));
        let at_once = u32::try_from(at_once).unwrap_or(u32::MAX);
        for substep in (0..substeps).step_by(at_once as usize) {
            let pass = PassUniform {
                substep,
                colors: at_once.min(substeps - substep),
                ..NOTHING
            };
            let dispatch = self.dispatch(Kernel::WholeBody, pass, false, &links);
            self.program.whole.extend(dispatch);
        }
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
            .dispatch(reset, NOTHING, false, lanes)
            .map(|d| Dispatch {
                // A lane a link.
                groups: self.program.passes[d.pass as usize]
                    .links
                    .div_ceil(self.workgroup),
                ..d
            });
        let bounds = Kernel::Pass(EntryPoint::Bounds);
        self.program.bounds = [reset, self.dispatch(bounds, NOTHING, false, lanes)];
    }

    fn dispatches(&mut self, passes: &[Pass]) -> Vec<Dispatch> {
        let mut out = Vec::new();
        let together = |a: &Pass, b: &Pass| family(*a).is_some() && family(*a) == family(*b);
        let mut layer = 0;
        for run in passes.chunk_by(together) {
            match family(run[0]) {
                Some(family) => {
                    // Struts come after all layers.
                    if family.layer != layer && family.kind != STRUTS {
                        layer = family.layer;
                        out.extend(self.patches(Kernel::Patches, layer));
                    }
                    self.colors(family.kind, run, &mut out);
                }
                None if run[0] == Pass::ResetMultipliers => self.resets(&mut out),
                None if run[0] == Pass::ContactsBeforeVolumes => self.contacts(true, &mut out),
                None if run[0] == Pass::Contacts => self.contacts(false, &mut out),
                None if run[0] == Pass::Volumes => self.volumes(&mut out),
                None => out.extend(self.vertices(run[0])),
            }
        }
        out
    }

    /// A dispatch over bodies with so many lanes each; none if there is nothing to do.
    pub(super) fn dispatch(
        &mut self,
        kernel: Kernel,
        pass: PassUniform,
        by_substep: bool,
        lanes: &[(u32, u32)],
    ) -> Option<Dispatch> {
        let first_link = narrow(self.program.links.len());
        let mut groups = 0;
        for &(body, lanes) in lanes.iter().filter(|(_, lanes)| *lanes > 0) {
            self.program.links.push(Link {
                first_group: groups,
                body,
            });
            groups += lanes.div_ceil(self.workgroup);
        }
        let links = narrow(self.program.links.len()) - first_link;
        if links == 0 {
            return None;
        }
        let dispatch = Dispatch {
            kernel,
            pass: narrow(self.program.passes.len()),
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

/// Passes of one family have the same kind and layer and may share a dispatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Family {
    kind: u32,
    layer: usize,
}

fn family(pass: Pass) -> Option<Family> {
    let (kind, layer) = match pass {
        Pass::Stretch { color } => (STRETCH, color / MAX_COLORS),
        Pass::StretchOverflow => (STRETCH, 0),
        Pass::Bending { color } => (BENDING, color / MAX_COLORS),
        Pass::BendingOverflow => (BENDING, 0),
        Pass::Struts { .. } | Pass::StrutsOverflow => (STRUTS, 0),
        _ => return None,
    };
    Some(Family { kind, layer })
}

/// The color of a pass; none for an overflow.
pub(super) fn color_of(pass: Pass) -> Option<usize> {
    match pass {
        Pass::Stretch { color } | Pass::Bending { color } | Pass::Struts { color } => Some(color),
        _ => None,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "more than that many are more than a device has room for"
)]
pub(super) const fn narrow(count: usize) -> u32 {
    if count < u32::MAX as usize {
        count as u32
    } else {
        u32::MAX
    }
}
