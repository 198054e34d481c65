//! Meshes that nobody should make: slivers, fans, seams that are open.

use super::audit::{Rule, energy_over};
use super::case::{Case, Worst};
use super::failure::Failure;
use super::scenes::{FRAME, GROUND, ball, double_cone, materials, sheet, shift};
use super::stage::Stage;
use incise_mesh::{Surface, Vec3};

pub(super) const CASES: [Case; 4] = [
    Case {
        id: "T7",
        torture: "triangles 1 to 1e7 times as long as wide",
        law: "energy of what there was",
        bound: 1.01,
        run: slivers,
    },
    Case {
        id: "T7",
        torture: "vertices of 3 to 500 triangles",
        law: "energy of what there was",
        bound: 1.01,
        run: fans,
    },
    Case {
        id: "T7",
        torture: "triangle without area, free vertex, seams that are not welded",
        law: "energy of what there was",
        bound: 1.01,
        run: seams,
    },
    Case {
        id: "valence 1000",
        torture: "vertices of 1000 triangles: constraints without a color",
        law: "energy of what there was",
        bound: 1.01,
        run: overflow,
    },
];

/// Nothing here is as far away at first. Of a sliver no storage knows how long its short edges are.
const THROWN: Rule = Rule::above(0.0).within(15.0);

/// Drops a surface in every material.
fn drop_all(
    stage: &mut Stage,
    surface: &Surface,
    name: &str,
    rule: Rule,
    worst: &mut Worst,
) -> Result<(), Failure> {
    let frames = stage.pick(60, 300);
    for (kind, material) in materials() {
        let mut mover = stage.enter(surface.clone(), &material)?;
        let found = energy_over(&mut mover, FRAME, &GROUND, frames, rule);
        worst.judge(found, || format!("{name}, {kind}"));
    }
    Ok(())
}

fn slivers(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for exponent in (0..=7).step_by(stage.pick(7, 1)) {
        let height = 0.125 * 10.0_f32.powi(-exponent);
        let mut surface = sheet([8, 1], [1.0, height])?;
        shift(&mut surface, Vec3::new(0.0, 0.3, 0.0));
        drop_all(
            stage,
            &surface,
            &format!("1e{exponent}"),
            THROWN,
            &mut worst,
        )?;
    }
    Ok(worst)
}

fn fans(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    for &valence in stage.pick(&[3, 100][..], &[3, 4, 10, 50, 64, 65, 100, 200, 500]) {
        let surface = double_cone(valence)?;
        drop_all(
            stage,
            &surface,
            &valence.to_string(),
            THROWN.recovering(),
            &mut worst,
        )?;
    }
    Ok(worst)
}

fn overflow(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let surface = double_cone(1000)?;
    let mover = stage.enter(surface.clone(), &materials()[0].1)?;
    let without_color = mover.solver.stretch().overflow().len();
    let bent = mover.solver.bending().map_or(0, |set| set.overflow().len());
    drop(mover);
    if without_color == 0 || bent == 0 {
        let why = "every constraint has found a color, so this is no test of those without";
        return Err(Failure::Law(why.to_owned()));
    }
    let name = format!("{without_color} edges and {bent} angles without a color");
    drop_all(stage, &surface, &name, THROWN.recovering(), &mut worst)?;
    Ok(worst)
}

fn seams(stage: &mut Stage) -> Result<Worst, Failure> {
    let mut worst = Worst::default();
    let points = |surface: &Surface| -> Vec<[f32; 3]> {
        let all = surface.positions.iter();
        all.map(|&[x, y, z, _]| [x, y, z]).collect()
    };
    let faces = |surface: &Surface| -> Vec<[u32; 3]> {
        let topology = surface.topology();
        let all = topology.triangles();
        all.map(|t| topology.triangle(t).map(|v| v.0)).collect()
    };
    let whole = ball(1, 0.6);
    let mut with_free = points(&whole);
    with_free.push([7.0, 7.0, 7.0]);
    let free = Surface::from_triangles(&with_free, &faces(&whole))?;
    drop_all(
        stage,
        &free,
        "a free vertex",
        THROWN.recovering(),
        &mut worst,
    )?;
    // Every triangle has corners of its own.
    let (from, mut apart, mut own) = (points(&whole), Vec::new(), Vec::new());
    for corners in faces(&whole) {
        let first = u32::try_from(apart.len()).unwrap_or(u32::MAX);
        apart.extend(corners.map(|v| from[v as usize]));
        own.push([first, first + 1, first + 2]);
    }
    let soup = Surface::from_triangles(&apart, &own)?;
    drop_all(
        stage,
        &soup,
        "no seam welded",
        THROWN.recovering(),
        &mut worst,
    )?;
    let line = [
        [0.0, 0.5, 0.0],
        [1.0, 0.5, 0.0],
        [0.5, 0.5, 0.0],
        [0.5, 1.0, 0.0],
    ];
    let flat = Surface::from_triangles(&line, &[[0, 1, 2], [1, 0, 3]])?;
    drop_all(stage, &flat, "no area", THROWN.recovering(), &mut worst)?;
    Ok(worst)
}
