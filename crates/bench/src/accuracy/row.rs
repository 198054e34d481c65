//! One run of a solver.

use super::error::Errors;
use super::substep::Left;
use serde::Serialize;

/// A row of the table behind plots: a scene stepped in one way.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Row {
    pub(super) scene: &'static str,
    pub(super) backend: &'static str,
    pub(super) device: String,
    pub(super) scheme: &'static str,
    pub(super) substeps: u32,
    pub(super) iterations: u32,
    /// The median of all frames, from their start until their end is known.
    pub(super) ms_per_frame: f64,
    /// The part of it until a device has been told what to do; none on the processor.
    pub(super) ms_encode: Option<f64>,
    /// What the device took by its own clock, the median; none on the processor, and on devices that have no clock.
    pub(super) ms_device: Option<f64>,
    pub(super) projections_per_frame: u64,
    /// To the converged implicit step of the same size; none where there is none.
    pub(super) solver_error: Option<Errors>,
    /// What is left of one substep; none where the converged motion is not known.
    pub(super) residuals: Option<Left>,
    /// To what smaller and smaller steps tend to.
    pub(super) total_error: Option<Errors>,
    /// About how far off that is itself, as a total error's positions are. Ten times less than they, or they say
    /// little.
    pub(super) uncertainty: Option<f64>,
    /// Why there are no errors.
    pub(super) refusal: Option<String>,
    pub(super) machine: String,
    pub(super) commit: String,
    pub(super) version: &'static str,
}

impl Row {
    /// Whether the row is the paper's Algorithm 1: one substep, any number of iterations.
    pub(super) fn is_paper(&self) -> bool {
        self.scheme == "pbd" && self.substeps == 1
    }

    /// The error that fronts are made of, where it is known well enough.
    pub(super) fn total(&self) -> Option<f64> {
        let position = self.total_error?.position;
        position.is_finite().then_some(position)
    }
}

/// Rows as a table for other programs.
pub(super) fn csv(rows: &[Row]) -> String {
    let mut text = "scene,backend,scheme,substeps,iterations,ms_per_frame,ms_encode,ms_device,projections_per_frame,solver_position,\
        solver_farthest,solver_force,solver_strain,solver_largest_strain,solver_volume,solver_energy,solver_sag,total_position,total_farthest,\
        total_force,total_strain,total_largest_strain,total_volume,total_energy,total_sag,energy_gap,decrement,primal,dual,uncertainty,commit\n"
        .to_owned();
    for row in rows {
        let mut cells = vec![
            row.scene.to_owned(),
            row.backend.to_owned(),
            row.scheme.to_owned(),
            row.substeps.to_string(),
            row.iterations.to_string(),
            number(Some(row.ms_per_frame)),
            number(row.ms_encode),
            number(row.ms_device),
            row.projections_per_frame.to_string(),
        ];
        for errors in [row.solver_error, row.total_error] {
            cells.extend([
                number(errors.map(|e| e.position)),
                number(errors.map(|e| e.farthest)),
                number(errors.and_then(|e| e.force)),
                number(errors.map(|e| e.strain)),
                number(errors.map(|e| e.largest_strain)),
                number(errors.and_then(|e| e.volume)),
                number(errors.map(|e| e.energy)),
                number(errors.and_then(|e| e.sag)),
            ]);
        }
        cells.extend([
            number(row.residuals.map(|left| left.residuals.energy)),
            number(row.residuals.map(|left| left.residuals.decrement)),
            number(row.residuals.map(|left| left.residuals.primal)),
            number(row.residuals.and_then(|left| left.dual)),
            number(row.uncertainty),
        ]);
        cells.push(row.commit.clone());
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// A number in few digits; nothing for none.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |x| format!("{x:.4e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_as_many_cells_as_names() {
        let errors = Errors {
            position: 0.5,
            ..Errors::default()
        };
        let rows = [
            Row::default(),
            Row {
                total_error: Some(errors),
                ..Row::default()
            },
        ];
        let text = csv(&rows);
        let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert_eq!(line.len(), lines[0].len());
        }
        let position = lines[0].iter().position(|&name| name == "total_position");
        assert_eq!(lines[2][position.unwrap()], "5.0000e-1");
        assert_eq!(lines[1][position.unwrap()], "");
    }
}
