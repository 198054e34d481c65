//! The figures by name, with captions and the functions that make them: the paper's, one of
//! incisions and one of textures.

use super::boundary::{PLANE, boundary};
use super::figure::{FigureError, Row};
use super::incisions::incisions;
use super::levels::{Look, levels};
use super::refinement::refinement;
use super::slice::Plane;
use super::slices::{slices, textured};
use super::sweep::sweep_plane;
use incise_models::Model;

/// A figure.
pub(super) struct Entry {
    /// Name of the figure and of its file.
    pub(super) name: &'static str,
    pub(super) caption: &'static str,
    pub(super) make: fn() -> Result<Vec<Row>, FigureError>,
}

/// All figures of the paper that show models, then incisions and textures.
pub(super) const ALL: [Entry; 16] = [
    Entry {
        name: "fig1",
        caption: "Sweep plane: the blade, the area between the previous and the current position \
                  of its edge (red), the two triangles of the sweep, and the triangles of \
                  Sphere80 that it crosses.",
        make: sweep_plane,
    },
    Entry {
        name: "fig2",
        caption: "Reconstruction of the boundary: Sphere80, without the triangles that the sweep \
                  crosses, with new triangles on one side, and with the boundary of the cap. \
                  Boundary in blue, intersection points in red, new triangles in green.",
        make: boundary,
    },
    Entry {
        name: "fig3",
        caption: "Refinement: Sphere80, the initial triangulation of the rim, triangles split in \
                  the first round, the refined patch, and the same without the edge swaps before \
                  the first round. Numbers count triangles of the patch. The last panel shows \
                  the exact method's own cap.",
        make: refinement,
    },
    Entry {
        name: "fig4",
        caption: "Refinement levels of Sphere80, second half removed.",
        make: || levels(Model::Sphere80, PLANE, &[Look::Side]),
    },
    Entry {
        name: "fig5",
        caption: "Slices of the spheres at the original level, pieces moved apart.",
        make: || {
            slices(&[
                (Model::Sphere20, &SPHERE_SLICES),
                (Model::Sphere80, &SPHERE_SLICES),
                (Model::Sphere768, &SPHERE_SLICES),
            ])
        },
    },
    Entry {
        name: "fig6",
        caption: "Slices of the other models at the original level, pieces moved apart; the paper \
                  shows Bunny and Banana.",
        make: || {
            slices(&[
                (Model::Bunny, &BUNNY_SLICES),
                (Model::Octopus, &OCTOPUS_SLICES),
                (Model::Banana, &BANANA_SLICES),
                (Model::Armadillo, &ARMADILLO_SLICES),
            ])
        },
    },
    Entry {
        name: "fig7",
        caption: "Refinement levels of Sphere20, second half removed.",
        make: || levels(Model::Sphere20, PLANE, BOTH),
    },
    Entry {
        name: "fig8",
        caption: "Refinement levels of Sphere768, second half removed.",
        make: || levels(Model::Sphere768, PLANE, BOTH),
    },
    Entry {
        name: "fig9",
        caption: "Refinement levels of Bunny, cut through its body, second half removed.",
        make: || levels(Model::Bunny, BUNNY_BODY, BOTH),
    },
    Entry {
        name: "fig10",
        caption: "Refinement levels of Bunny, cut through its head, second half removed.",
        make: || levels(Model::Bunny, BUNNY_HEAD, BOTH),
    },
    Entry {
        name: "figA1",
        caption: "Refinement levels of Sphere80, second half removed.",
        make: || levels(Model::Sphere80, PLANE, BOTH),
    },
    Entry {
        name: "figA2",
        caption: "Refinement levels of Octopus, second half removed.",
        make: || levels(Model::Octopus, OCTOPUS, BOTH),
    },
    Entry {
        name: "figA3",
        caption: "Refinement levels of Banana, second half removed.",
        make: || levels(Model::Banana, BANANA, BOTH),
    },
    Entry {
        name: "figA4",
        caption: "Refinement levels of Armadillo, second half removed.",
        make: || levels(Model::Armadillo, ARMADILLO, BOTH),
    },
    Entry {
        name: "incisions",
        caption: "Cuts that end inside, by the exact method, opened by pulling at the sides: five \
                  depths in one ball, a curved blade, a cross, and slits in cloth. Walls in red.",
        make: incisions,
    },
    Entry {
        name: "texture",
        caption: "Texture coordinates of cuts by the exact method: a checkerboard on Banana, \
                  whole, in slices, and these cut again. Skin keeps its texture to the rim; caps \
                  have their own, at one scale.",
        make: || textured(Model::Banana, &[&[], &BANANA_SLICES, &BANANA_CUT_AGAIN]),
    },
];

/// The paper's two views.
const BOTH: &[Look] = &[Look::Side, Look::Front];

const SPHERE_SLICES: [Plane; 2] = [[1.0, 0.12, 0.2, 0.03], [0.1, 1.0, -0.15, 0.05]];

const BUNNY_BODY: Plane = [1.0, 0.1, 0.2, 0.01];
const BUNNY_HEAD: Plane = [0.05, 1.0, 0.3, 0.17];
const OCTOPUS: Plane = [1.0, 0.05, 0.12, 0.015];
const BANANA: Plane = [1.0, 0.1, 0.1, 0.02];
const ARMADILLO: Plane = [0.08, 1.0, 0.15, 0.03];

const BUNNY_SLICES: [Plane; 2] = [BUNNY_HEAD, BUNNY_BODY];
const OCTOPUS_SLICES: [Plane; 2] = [OCTOPUS, [0.1, 1.0, 0.05, 0.02]];
const BANANA_SLICES: [Plane; 2] = [[1.0, 0.1, 0.1, -0.12], [1.0, -0.1, 0.1, 0.13]];
const BANANA_CUT_AGAIN: [Plane; 3] = [BANANA_SLICES[0], BANANA_SLICES[1], [0.1, 0.4, 1.0, 0.0]];
const ARMADILLO_SLICES: [Plane; 2] = [ARMADILLO, [1.0, 0.05, 0.1, 0.01]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_names_are_unique_file_names() {
        for (i, entry) in ALL.iter().enumerate() {
            assert!(entry.name.chars().all(|c| c.is_ascii_alphanumeric()));
            let is_same = |other: &Entry| other.name.eq_ignore_ascii_case(entry.name);
            assert!(!ALL[..i].iter().any(is_same), "{}", entry.name);
        }
    }
}
