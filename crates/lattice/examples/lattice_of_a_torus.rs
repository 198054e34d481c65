//! Puts a lattice into a torus, cuts the torus in two, and puts lattices into the halves.
//!
//! ```sh
//! cargo run --release -p incise-lattice --example lattice_of_a_torus
//! ```

use incise_cut::{CutParams, Cutter, Sweep};
use incise_lattice::{Lattice, LatticeParams};
use incise_mesh::torus;
use std::error::Error;
use std::io::{Write, stdout};

fn main() -> Result<(), Box<dyn Error>> {
    let mut body = torus(0.35, 0.15, 48, 24);
    let params = LatticeParams::default();
    let mut out = stdout().lock();
    let whole = Lattice::build(&body, &params)?;
    writeln!(out, "whole: {} copies of cells", whole.cells.len())?;
    writeln!(out, "       {} nodes", whole.node_positions.len())?;

    let sweep = Sweep::from_plane([1.0, 0.2, 0.0], 0.01, &body.bounds())?;
    let _ = Cutter::new(&body).cut(&mut body, &sweep, &CutParams::default())?;
    // The cells stay. Those at the cut have a copy for each half.
    let cut = Lattice::in_grid(&body, whole.grid);
    writeln!(out, "cut:   {} copies of cells", cut.cells.len())?;
    writeln!(out, "       {} nodes", cut.node_positions.len())?;
    Ok(())
}
