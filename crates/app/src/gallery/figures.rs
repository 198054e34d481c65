//! The figures as words of `incise render`.

/// A grid of pictures. The words of a panel are those of the figure, its row and its column.
pub(super) struct Figure {
    /// Name of the figure and of its file.
    pub(super) name: &'static str,
    pub(super) caption: &'static str,
    pub(super) words: &'static str,
    pub(super) rows: &'static [&'static str],
    pub(super) columns: &'static [&'static str],
}

/// The paper's figures that show models, and one of textures.
pub(super) const ALL: [Figure; 13] = [
    Figure {
        name: "fig1",
        caption: "Sweep of a blade through Sphere80, and the pieces that it makes.",
        words: "Sphere80 --blade 0.1,-0.75,0.8,0.1,0.75,0.66 --show-sweep \
                --to -0.02,-0.75,-0.7,-0.02,0.75,-0.84",
        rows: METHODS,
        columns: &["", "--explode 0.1"],
    },
    Figure {
        name: "fig4",
        caption: "Refinement levels of Sphere80, second half removed.",
        words: "Sphere80 --plane 1,0.12,0.2,0.06 --behind",
        rows: &[
            "--method paper --camera 126.6,17.5",
            "--grading 0 --camera 126.6,17.5",
        ],
        columns: LEVELS,
    },
    Figure {
        name: "fig5",
        caption: "Slices of the spheres, pieces moved apart.",
        words: "--plane 1,0.12,0.2,0.03 --plane 0.1,1,-0.15,0.05 --explode 0.12",
        rows: METHODS,
        columns: &["Sphere20", "Sphere80", "Sphere768"],
    },
    Figure {
        name: "fig6",
        caption: "Slices of the other models, pieces moved apart.",
        words: "--explode 0.12",
        rows: METHODS,
        columns: &[
            "Bunny --plane 0.05,1,0.3,0.17 --plane 1,0.1,0.2,0.01",
            "Octopus --plane 1,0.05,0.12,0.015 --plane 0.1,1,0.05,0.02",
            "Banana --plane 1,0.1,0.1,-0.12 --plane 1,-0.1,0.1,0.13",
            "Armadillo --plane 0.08,1,0.15,0.03 --plane 1,0.05,0.1,0.01",
        ],
    },
    levels(
        "fig7",
        "Refinement levels of Sphere20, second half removed.",
        "Sphere20 --plane 1,0.12,0.2,0.06 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "fig8",
        "Refinement levels of Sphere768, second half removed.",
        "Sphere768 --plane 1,0.12,0.2,0.06 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "fig9",
        "Refinement levels of Bunny, cut through its body, second half removed.",
        "Bunny --plane 1,0.1,0.2,0.01 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "fig10",
        "Refinement levels of Bunny, cut through its head, second half removed.",
        "Bunny --plane 0.05,1,0.3,0.17 --behind",
        FROM_ABOVE,
    ),
    levels(
        "figA1",
        "Refinement levels of Sphere80, second half removed.",
        "Sphere80 --plane 1,0.12,0.2,0.06 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "figA2",
        "Refinement levels of Octopus, second half removed.",
        "Octopus --plane 1,0.05,0.12,0.015 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "figA3",
        "Refinement levels of Banana, second half removed.",
        "Banana --plane 1,0.1,0.1,0.02 --behind",
        FROM_THE_LEFT,
    ),
    levels(
        "figA4",
        "Refinement levels of Armadillo, second half removed.",
        "Armadillo --plane 0.08,1,0.15,0.03 --behind",
        FROM_ABOVE,
    ),
    Figure {
        name: "texture",
        caption: "Texture coordinates of exact cuts: a checkerboard on Banana. Skin keeps its \
                  texture to the rim; caps have their own, at one scale.",
        words: "Banana --checkers 16 --explode 0.12 --plane 1,0.1,0.1,-0.12",
        rows: &[""],
        columns: &[
            "",
            "--plane 1,-0.1,0.1,0.13",
            "--plane 1,-0.1,0.1,0.13 --plane 0.1,0.4,1,0",
        ],
    },
];

/// The paper's method and the exact one, with caps as uniform as the paper's.
const METHODS: &[&str] = &["--method paper", "--grading 0"];

const LEVELS: &[&str] = &[
    "--level 2x-coarser",
    "--level 1.5x-coarser",
    "--level original",
    "--level 1.5x-finer",
    "--level 2x-finer",
];

/// Both methods, from beside the cap and from its front, of a cut across the x axis.
const FROM_THE_LEFT: &[&str] = &[
    "--method paper --camera 127,17",
    "--method paper --camera 79,6",
    "--grading 0 --camera 127,17",
    "--grading 0 --camera 79,6",
];

/// Both methods, from beside the cap and from its front, of a cut across the y axis.
const FROM_ABOVE: &[&str] = &[
    "--method paper --camera 30,45",
    "--method paper --camera 19,77",
    "--grading 0 --camera 30,45",
    "--grading 0 --camera 19,77",
];

/// Returns a figure of the five refinement levels.
const fn levels(
    name: &'static str,
    caption: &'static str,
    words: &'static str,
    rows: &'static [&'static str],
) -> Figure {
    Figure {
        name,
        caption,
        words,
        rows,
        columns: LEVELS,
    }
}
