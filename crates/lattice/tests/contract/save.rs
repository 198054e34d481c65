//! Loaded lattices equal the saved ones and follow the same cuts; damaged ones are refused or safe.

use super::follow::{Step, edit, step};
use super::{body, params};
use incise_cut::Cutter;
use incise_lattice::{InvalidLattice, Lattice, LatticeChange, NO_COPY};
use incise_mesh::{Surface, TriangleId, Undo};
use proptest::prelude::*;

/// A body with its lattice, and all that edits need.
struct Scene {
    surface: Surface,
    lattice: Lattice,
    cutter: Cutter,
    undos: Vec<Undo>,
    change: LatticeChange,
}

impl Scene {
    /// Makes a body with a lattice that has followed edits.
    fn new(number: u8, size: f64, steps: &[Step]) -> Self {
        Self::bent(number, size, 0.0, steps)
    }

    /// Makes a body that is bent when it is cut.
    fn bent(number: u8, size: f64, bend: f32, steps: &[Step]) -> Self {
        let mut surface = body(number);
        for p in surface.positions_mut() {
            p[0] += bend * p[2] * p[2];
        }
        let mut scene = Self {
            lattice: Lattice::build(&surface, &params(size)).unwrap(),
            cutter: Cutter::new(&surface),
            surface,
            undos: Vec::new(),
            change: LatticeChange::default(),
        };
        for step in steps {
            scene.edit(step, |_| {});
        }
        scene
    }

    /// Makes edits, and calls `check` after each that changes the body.
    fn edit(&mut self, step: &Step, mut check: impl FnMut(&Lattice)) {
        let Self {
            surface,
            lattice,
            cutter,
            undos,
            change,
        } = self;
        edit(surface, cutter, undos, step, |surface, delta| {
            lattice.follow(surface, delta, change);
            check(lattice);
        });
    }

    fn save(&self) -> Vec<u8> {
        postcard::to_stdvec(&self.lattice).unwrap()
    }
}

/// Loads a lattice. Returns why if it is refused.
fn load(bytes: &[u8], surface: &Surface) -> Result<Lattice, String> {
    let mut lattice: Lattice = postcard::from_bytes(bytes).map_err(|error| error.to_string())?;
    let done = lattice.finish_load(surface);
    done.map_err(|error| error.to_string())?;
    Ok(lattice)
}

/// Saves and loads a lattice after some edits, and compares both after some more.
fn check_round_trip(mut scene: Scene, after: &[Step]) {
    let bytes = scene.save();
    let mut loaded = load(&bytes, &scene.surface).unwrap();
    assert_eq!(loaded, scene.lattice, "a loaded lattice");
    assert_eq!(postcard::to_stdvec(&loaded).unwrap(), bytes, "saved again");
    let surface = Surface::load(&scene.surface.save().unwrap()).unwrap();
    let again = load(&bytes, &surface).unwrap();
    assert_eq!(again, loaded, "a lattice of a loaded surface");
    let mut change = LatticeChange::default();
    for step in after {
        let Scene {
            surface,
            lattice,
            cutter,
            undos,
            change: own,
        } = &mut scene;
        edit(surface, cutter, undos, step, |surface, delta| {
            lattice.follow(surface, delta, own);
            loaded.follow(surface, delta, &mut change);
            assert_eq!(&loaded, lattice, "both follow an edit");
            assert_eq!(
                format!("{:?}", Lists::of(own)),
                format!("{:?}", Lists::of(&change)),
                "changes"
            );
        });
    }
}

/// The public lists of a change.
#[derive(Debug)]
#[expect(dead_code, reason = "compared as text")]
struct Lists<'a> {
    copies: [&'a [incise_lattice::OldCopy]; 2],
    added: (
        &'a [incise_lattice::AddedCopy],
        &'a [incise_lattice::AddedNode],
    ),
    sources: &'a [incise_lattice::NodeSource],
    nodes: [&'a [u32]; 2],
    vertices: &'a [incise_mesh::VertexId],
}

impl<'a> Lists<'a> {
    fn of(change: &'a LatticeChange) -> Self {
        Self {
            copies: [&change.copies_removed, &change.copies_changed],
            added: (&change.copies_added, &change.nodes_added),
            sources: &change.node_sources,
            nodes: [&change.nodes_removed, &change.nodes_changed],
            vertices: &change.vertices_changed,
        }
    }
}

fn incision() -> Step {
    Step::Incision {
        angle: 0.3,
        offset: 0.05,
        depth: -0.2,
        steps: 4,
    }
}

#[test]
fn a_loaded_lattice_follows_cuts_of_a_bent_body() {
    for number in 0..3 {
        let scene = Scene::bent(number, 0.09, 0.4, &[incision(), Step::Undo]);
        let after = [Step::Plane([1.0, 0.2, 0.1], 0.05), Step::Undo, incision()];
        check_round_trip(scene, &after);
    }
}

#[test]
fn a_saved_lattice_takes_few_bytes() {
    for number in 0..4 {
        let scene = Scene::new(number, 0.08, &[incision()]);
        let (bytes, copies) = (scene.save().len(), scene.lattice.cells.len());
        assert!(bytes < 300 * copies, "{bytes} bytes for {copies} copies");
    }
}

#[test]
fn lattices_of_other_surfaces_are_refused() {
    let scene = Scene::new(0, 0.11, &[incision()]);
    let bytes = scene.save();
    for number in 0..4 {
        let refused = load(&bytes, &body(number));
        assert!(refused.is_err(), "body {number}");
    }
    let mut lattice: Lattice = postcard::from_bytes(&bytes).unwrap();
    lattice.nodes.pop();
    let array = "copies of parts";
    let expected = Err(InvalidLattice::Array { array });
    assert_eq!(lattice.finish_load(&scene.surface), expected);
}

#[test]
fn a_lattice_may_be_completed_again() {
    let scene = Scene::new(1, 0.1, &[incision(), Step::Undo]);
    let mut lattice = scene.lattice.clone();
    lattice.finish_load(&scene.surface).unwrap();
    assert_eq!(lattice, scene.lattice);
}

/// Loads changed bytes. Lattices that are not refused follow edits. Returns whether it is.
fn check_damaged(bytes: &[u8], surface: &Surface, steps: &[Step]) -> bool {
    let Ok(mut lattice) = load(bytes, surface) else {
        return true;
    };
    let mut surface = surface.clone();
    let mut cutter = Cutter::new(&surface);
    let mut undos = Vec::new();
    let mut change = LatticeChange::default();
    for step in steps {
        edit(
            &mut surface,
            &mut cutter,
            &mut undos,
            step,
            |surface, delta| {
                lattice.follow(surface, delta, &mut change);
                for source in &change.node_sources {
                    let node = source.node as usize;
                    assert!(node < lattice.node_positions.len(), "source {node}");
                }
                for (copy, nodes) in (0..).zip(&lattice.nodes) {
                    let is_used = lattice.is_copy(copy);
                    assert!(
                        nodes.iter().all(|&node| lattice.is_node(node) == is_used),
                        "nodes of copy {copy}"
                    );
                }
                for &copy in lattice
                    .vertex_copies
                    .iter()
                    .filter(|&&copy| copy != NO_COPY)
                {
                    assert!(lattice.is_copy(copy), "a vertex has copy {copy}");
                }
                for slot in 0..lattice.vertex_copies.len() {
                    let _ = lattice.embedded(slot, &lattice.node_positions);
                }
            },
        );
    }
    // Removal of all triangles touches every cell.
    let topology = surface.topology();
    let all: Vec<TriangleId> = topology.triangles().collect();
    let mut delta = incise_mesh::TopologyDelta::default();
    delta
        .triangles_removed
        .extend(all.iter().map(|&t| (t, topology.triangle(t))));
    delta.triangles_added.extend(all);
    lattice.follow(&surface, &delta, &mut change);
    false
}

/// A change of the bytes of a file.
#[derive(Debug, Clone)]
enum Damage {
    Flip(u8),
    Set(u8),
    /// A byte of another place.
    Copy(prop::sample::Index),
    Insert(u8),
    Remove,
}

fn damage() -> impl Strategy<Value = (prop::sample::Index, Damage)> {
    let kind = prop_oneof![
        4 => (0u8..8).prop_map(|bit| Damage::Flip(1 << bit)),
        2 => any::<u8>().prop_map(Damage::Set),
        2 => (0u8..4).prop_map(Damage::Set),
        2 => any::<prop::sample::Index>().prop_map(Damage::Copy),
        1 => any::<u8>().prop_map(Damage::Insert),
        1 => Just(Damage::Remove),
    ];
    (any::<prop::sample::Index>(), kind)
}

fn apply(bytes: &mut Vec<u8>, at: usize, damage: &Damage) {
    match damage {
        Damage::Flip(bits) => bytes[at] ^= bits,
        Damage::Set(value) => bytes[at] = *value,
        Damage::Copy(from) => bytes[at] = bytes[from.index(bytes.len())],
        Damage::Insert(value) => bytes.insert(at, *value),
        Damage::Remove => {
            bytes.remove(at);
        }
    }
}

#[test]
fn every_damaged_byte_of_a_small_lattice_is_safe() {
    let scene = Scene::new(3, 0.3, &[incision()]);
    let bytes = scene.save();
    let steps = [Step::Plane([0.3, 1.0, 0.2], 0.02)];
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flipped in [1, 2, 0x10, 0x80] {
            let mut damaged = bytes.clone();
            damaged[at] ^= flipped;
            refused += usize::from(check_damaged(&damaged, &scene.surface, &steps));
        }
    }
    assert!(
        refused > bytes.len() / 2,
        "{refused} of {} bytes",
        bytes.len()
    );
}

proptest! {
    #[test]
    fn loaded_lattices_follow_the_same_edits(
        number in 0u8..4,
        size in 0.06..0.5f64,
        before in prop::collection::vec(step(), 0..5),
        after in prop::collection::vec(step(), 1..4),
    ) {
        check_round_trip(Scene::new(number, size, &before), &after);
    }

    /// A file may hold a lattice that has missed edits of its surface.
    #[test]
    fn lattices_that_missed_edits_are_refused_or_safe(
        number in 0u8..4,
        size in 0.1..0.5f64,
        before in prop::collection::vec(step(), 0..3),
        missed in prop::collection::vec(step(), 1..3),
        after in prop::collection::vec(step(), 1..3),
    ) {
        let mut scene = Scene::new(number, size, &before);
        let bytes = scene.save();
        for step in &missed {
            edit(&mut scene.surface, &mut scene.cutter, &mut scene.undos, step, |_, _| {});
        }
        check_damaged(&bytes, &scene.surface, &after);
    }

    #[test]
    fn damaged_lattices_are_refused_or_safe(
        number in 0u8..4,
        size in 0.1..0.4f64,
        before in prop::collection::vec(step(), 0..3),
        damages in prop::collection::vec(prop::collection::vec(damage(), 1..4), 1..24),
        after in prop::collection::vec(step(), 1..3),
    ) {
        let scene = Scene::new(number, size, &before);
        let bytes = scene.save();
        for own in &damages {
            let mut damaged = bytes.clone();
            for (at, damage) in own {
                let at = at.index(damaged.len());
                apply(&mut damaged, at, damage);
            }
            check_damaged(&damaged, &scene.surface, &after);
        }
    }
}
