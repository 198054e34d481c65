//! Heaps of bodies that come to rest: small ones in a bowl, and models on each other.

use super::group::{Group, seconds};
use super::runner::Runner;
use super::{Case, Found, Run};
use incise_mesh::Surface;
use incise_models::scenes::Grouping;
use incise_models::scenes::heaps::{RADIUS, SIZE, TRIANGLES, bowl, heap, outside_of_bowl};

pub(super) const CASES: [Case; 2] = [
    Case {
        id: "bowl",
        stress: "a thousand balls of 20 triangles poured into a bowl of planes",
        invariants: &[
            ("time until they sleep [s]", 30.0),
            (
                "depth of a vertex in another ball at the end, in radii",
                0.1,
            ),
            (
                "distance of a vertex outside of the bowl at the end, in radii",
                0.1,
            ),
        ],
        run: |runner| vec![Run::new("1000 balls".to_owned(), pour(runner))],
    },
    Case {
        id: "stack",
        stress: "ten models fall on each other",
        invariants: &[
            ("time until they sleep [s]", 30.0),
            (
                "depth of a vertex in another model at the end, in sizes",
                0.01,
            ),
            ("relative volume error at the end", 0.01),
        ],
        run: stack,
    },
];

/// Longest wait for a heap to sleep \[frames\]: a second beyond the bound.
const LONGEST: u32 = 31 * 60;

fn pour(runner: &Runner) -> Found<[f64; 3]> {
    let mut group = Group::new(bowl(&runner.backend, 1000))?;
    let time = seconds(group.settle(LONGEST)?);
    let positions = group.all_positions()?;
    let left = positions.iter().flatten().map(outside_of_bowl);
    let left = left.fold(0.0, f64::max);
    Ok([time, group.depth()? / RADIUS, left / RADIUS])
}

fn stack(runner: &Runner) -> Vec<Run> {
    let subjects = runner.closed_subjects(TRIANGLES);
    let models: Vec<Surface> = subjects.map(|subject| subject.surface.clone()).collect();
    if models.is_empty() {
        return Vec::new();
    }
    runner.each(&Grouping::ALL, |&(name, grouping)| {
        let settle = || -> Found<[f64; 3]> {
            let mut group = Group::new(heap(&runner.backend, &models, grouping))?;
            let time = seconds(group.settle(LONGEST)?);
            Ok([time, group.depth()? / SIZE, group.volume_error()?])
        };
        Run::new(name.to_owned(), settle())
    })
}
