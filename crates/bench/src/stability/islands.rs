//! Cuts without end: of bodies into pieces and smaller pieces, and of one that is made whole again each time; the room that is left behind.

use super::audit::{EnergyLaw, Rule};
use super::case::{Case, Worst, larger};
use super::cuts::{cut, pieces, through};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, ball};
use super::sound::{followed, sound};
use super::stage::{Effort, Mover, Stage};
use crate::directions::Directions;
use incise_cut::{CutParams, Cutter};
use incise_pbd_gpu::SolverParams;
use incise_refine::{RefineParams, RefinementLevel};

pub(super) const CASES: [Case; 4] = [
    Case {
        id: "T12",
        torture: "10,000 cuts at 60 a second: 2000 balls of 20 triangles in 5 cuts each, the largest piece first",
        law: "topology, colors, tree; change of mass, momentum, volume",
        bound: 1e-5,
        run: |stage| Ok(islands(stage)?.sums),
    },
    Case {
        id: "T12",
        torture: "10,000 cuts at 60 a second: 2000 balls of 20 triangles in 5 cuts each, the largest piece first",
        law: "slots for vertices and triangles, of those in use",
        bound: 2.0,
        run: |stage| Ok(islands(stage)?.slots),
    },
    Case {
        id: "T12",
        torture: "10,000 cuts at 60 a second: 2000 balls of 20 triangles in 5 cuts each, the largest piece first",
        law: "energy of what there was",
        bound: 1.01,
        run: |stage| Ok(islands(stage)?.energy),
    },
    Case {
        id: "T12",
        torture: "a ball is cut and made whole again 1000 times while it falls",
        law: "slots and the solver's room, of what a new one took that was cut once",
        bound: 2.0,
        run: whole_again,
    },
];

/// Quick steps: what is asked is about cuts.
const STEP: SolverParams = SolverParams {
    iterations: 1,
    ..GROUND
};

/// What the same cuts came to, by three laws.
#[derive(Debug, Clone, Default)]
pub(super) struct Islands {
    /// The largest change of a sum.
    sums: Worst,
    /// Slots of those in use.
    slots: Worst,
    /// Of what there was.
    energy: Worst,
}

fn islands(stage: &mut Stage) -> Result<Islands, Failure> {
    if let Some(known) = &stage.islands {
        return Ok(known.clone());
    }
    let mut found = Islands::default();
    let (bodies, cuts) = match (stage.effort, &stage.device) {
        (Effort::Quick, _) => (4, 5),
        (Effort::Full, None) => (2000, 5),
        // A device, which may be software, a tenth.
        (Effort::Full, Some(_)) => (200, 5),
    };
    for seed in 1..=bodies {
        crumble(stage, seed, cuts, &mut found)?;
    }
    stage.islands = Some(found.clone());
    Ok(found)
}

/// Cuts one body, its piece of the most triangles each time, a frame between one cut and the next.
fn crumble(stage: &mut Stage, seed: u64, cuts: u32, found: &mut Islands) -> Result<(), Failure> {
    let mut mover = stage.enter(ball(0, 0.8), &crate::motion::material())?;
    crate::motion::start(&mut mover.solver, &mover.surface)?;
    let mut cutter = Cutter::new(&mover.surface);
    let mut directions = Directions(seed);
    let mut law = EnergyLaw::start(&mover, &STEP, Rule::above(0.0).within(5.0));
    for number in 1..=cuts {
        mover.step(FRAME, &STEP)?;
        let all = pieces(&mover.surface);
        let size = |p: &u32| mover.surface.piece_triangles(*p);
        let Some(piece) = all.iter().copied().max_by_key(size) else {
            return Err(Failure::Law("no piece is left".to_owned()));
        };
        let told = format!(
            "ball {seed}, cut {number}, {} pieces of up to {} triangles, {} in all",
            all.len(),
            size(&piece),
            mover.surface.topology().triangle_count()
        );
        law.look(&mover, &STEP);
        found.energy.judge(Ok(law.found()), || told.clone());
        let sweep = through(&mover.surface, piece, &mut directions)?;
        let params = CutParams {
            only_piece: Some(piece),
            // Caps of no more triangles than they need: a piece that was cut off has few.
            refine: RefineParams {
                level: RefinementLevel::Z(1e3),
                grading: 1e3,
                ..RefineParams::default()
            },
            ..CutParams::default()
        };
        let change = cut(&mut mover, &mut cutter, &sweep, &params);
        let broken = change.is_err();
        found.sums.judge(change, || told.clone());
        (found.slots).judge(Ok(slots_in_use(&mover)), || told.clone());
        if broken {
            break;
        }
    }
    Ok(())
}

/// Slots of vertices or triangles, whichever are more, of those that hold one.
fn slots_in_use(mover: &Mover<'_>) -> f64 {
    let topology = mover.surface.topology();
    let part = |slots: usize, used: usize| slots as f64 / used.max(1) as f64;
    part(topology.vertex_slots(), topology.vertex_count())
        .max(part(topology.triangle_slots(), topology.triangle_count()))
}

/// Slots and the solver's room.
fn room(mover: &Mover<'_>) -> [f64; 3] {
    let topology = mover.surface.topology();
    let room = [
        topology.vertex_slots(),
        topology.triangle_slots(),
        mover.solver.capacity(),
    ];
    room.map(|count| count as f64)
}

fn whole_again(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let full = if stage.device.is_some() { 100 } else { 1000 };
    let times = stage.pick(10, full);
    let mut mover = stage.enter(ball(2, 0.8), &crate::motion::material())?;
    crate::motion::start(&mut mover.solver, &mover.surface)?;
    let mut cutter = Cutter::new(&mover.surface);
    let mut directions = Directions(21);
    let mut first: Option<[f64; 3]> = None;
    for number in 1..=times {
        mover.step(FRAME, &GROUND)?;
        cutter.refit(&mover.surface);
        let sweep = through(&mover.surface, 0, &mut directions)?;
        let before = (
            mover.surface.topology().triangle_count(),
            mover.solver.total_mass(),
        );
        let outcome = cutter.cut(&mut mover.surface, &sweep, &CutParams::default());
        let Ok(outcome) = outcome else { continue };
        let Some(undo) = outcome.undo else { continue };
        mover.follow(&outcome.delta)?;
        let delta = cutter.undo(&mut mover.surface, undo)?;
        mover.follow(&delta)?;
        let found = (|| {
            sound(&mover.surface)?;
            followed(&mover.surface, &mover.solver, &cutter)?;
            let triangles = mover.surface.topology().triangle_count();
            let mass = mover.solver.total_mass();
            if triangles != before.0 || (mass / before.1 - 1.0).abs() > 1e-5 {
                let why = format!("{triangles} triangles of {mass} kg are not what was cut");
                return Err(Failure::Law(why));
            }
            let now = room(&mover);
            let first = first.get_or_insert(now);
            Ok((0..3).map(|k| now[k] / first[k]).fold(0.0, larger))
        })();
        let broken = found.is_err();
        worst.judge(found, || format!("cut {number}"));
        if broken {
            break;
        }
    }
    Ok(worst)
}
