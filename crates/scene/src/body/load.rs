//! Completes and validates a loaded [`Body`].

use super::Body;
use crate::save::LoadError;

impl Body {
    /// Completes a body that was read with serde, the `index`-th of a scene with `blades` blades.
    ///
    /// # Errors
    /// [`LoadError`] of the body.
    pub(crate) fn finish_load(&mut self, index: usize, blades: usize) -> Result<(), LoadError> {
        let surface = self.surface.finish_load();
        surface.map_err(|error| LoadError::Surface { index, error })?;
        let solver = self.solver.finish_load(&self.surface);
        solver.map_err(|error| LoadError::Solver { index, error })?;
        let cutter = self.cutter.finish_load(&self.surface);
        cutter.map_err(|error| LoadError::Bvh { index, error })?;
        for (_, incision) in &self.incisions {
            let incision = incision.validate();
            incision.map_err(|error| LoadError::Incision { index, error })?;
        }
        let mut numbers: Vec<usize> = self.incisions.iter().map(|(blade, _)| *blade).collect();
        numbers.sort_unstable();
        let is_known = numbers.last().is_none_or(|&last| last < blades);
        if !is_known || !numbers.is_sorted_by(|a, b| a < b) {
            return Err(LoadError::Array { array: "incisions" });
        }
        self.topology_version = self.surface.fingerprint();
        self.version_before_cut = self.topology_version;
        Ok(())
    }
}
