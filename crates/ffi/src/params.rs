//! Parameter structs of the header, and their conversion to those of the libraries.
//!
//! Each has an `incise_..._init` function that writes the defaults of the libraries.

mod cut;
mod scene;

pub use cut::{CutParams, FillParams, INCISE_CAPS_ALL_LOOPS, INCISE_CAPS_BODIES, INCISE_CAPS_NONE};
pub use scene::{
    Collider, INCISE_BACKEND_AUTO, INCISE_BACKEND_CPU, INCISE_BACKEND_GPU, INCISE_COLLIDER_BOX,
    INCISE_COLLIDER_CAPSULE, INCISE_COLLIDER_PLANE, INCISE_COLLIDER_SPHERE, INCISE_DENSITY_AREA,
    INCISE_DENSITY_VOLUME, INCISE_MATERIAL_CLOTH, INCISE_MATERIAL_LIMP_SHELL,
    INCISE_MATERIAL_SHELL, INCISE_MATERIAL_SOFT_BODY, INCISE_STIFFNESS_COMPLIANCE,
    INCISE_STIFFNESS_NONE, INCISE_STIFFNESS_PBD, Material, SceneParams,
};
