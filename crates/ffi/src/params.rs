//! Parameter structs of the header, and their conversion to those of the libraries.
//!
//! Each has an `incise_..._init` function that writes the defaults of the libraries.

mod cut;

pub use cut::{
    CutParams, FillParams, INCISE_CAPS_ALL_LOOPS, INCISE_CAPS_BODIES, INCISE_CAPS_NONE,
    INCISE_METHOD_EXACT, INCISE_METHOD_PAPER, INCISE_REFINE_DELAUNAY, INCISE_REFINE_PAPER,
};
