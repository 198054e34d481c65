//! Puts a lattice into a torus, cuts the torus in two, and lets the lattice follow.
//!
//! ```sh
//! cargo run --release -p incise-lattice --example lattice_of_a_torus
//! ```

use incise_cut::{CutParams, Cutter, Sweep};
use incise_lattice::{Lattice, LatticeChange, LatticeParams};
use incise_mesh::torus;
use std::error::Error;
use std::io::{Write, stdout};

fn main() -> Result<(), Box<dyn Error>> {
    let mut body = torus(0.35, 0.15, 48, 24);
    let params = LatticeParams::default();
    let mut out = stdout().lock();
    let mut lattice = Lattice::build(&body, &params)?;
    writeln!(out, "whole: {} copies of cells", lattice.cells.len())?;
    writeln!(out, "       {} nodes", lattice.node_positions.len())?;

    let sweep = Sweep::from_plane([1.0, 0.2, 0.0], 0.01, &body.bounds())?;
    let outcome = Cutter::new(&body).cut(&mut body, &sweep, &CutParams::default())?;
    // The cells stay. Those at the cut have a copy for each half.
    let mut change = LatticeChange::default();
    lattice.follow(&body, &outcome.delta, &mut change);
    writeln!(out, "cut:   {} copies added", change.copies_added.len())?;
    writeln!(out, "       {} copies removed", change.copies_removed.len())?;
    writeln!(out, "       {} nodes added", change.nodes_added.len())?;
    writeln!(out, "       {} nodes removed", change.nodes_removed.len())?;
    Ok(())
}
