//! Tests of the contract of this crate.

mod bvh;
mod common;
mod crossing;
mod curved;
mod exact;
mod excision;
mod flat;
mod folds;
mod growth;
mod incision;
mod intersect;
mod layers;
mod lineage;
mod mesh_planes;
mod misuse;
mod open;
mod pinched;
mod progress;
mod recut;
mod rest;
mod sheet;
mod stretched;
mod strokes;
mod sweep;
mod tension;
mod threads;
