use super::printout::{blocked, recovery};
use super::*;
use incise_mesh::icosphere;

/// A ball that hangs from its top.
fn ball() -> Scene {
    scenes::hung_model("ball", icosphere(3, 0.5))
}

#[test]
fn frames_after_a_cut_are_measured_against_converged_steps() {
    let scene = ball();
    let rows = measure(&scene, 3, 1).unwrap();
    assert_eq!(rows.len(), 9);
    let of = |solver: &str| -> Vec<&FrameRow> {
        rows.iter().filter(|row| row.solver == solver).collect()
    };
    for row in &rows {
        let (error, drift) = (row.step_error.unwrap(), row.drift.unwrap());
        assert!(error > 0.0 && row.motion.unwrap() > 0.0, "{row:?}");
        // Both references start from the same state in the first frame.
        assert!(row.frame > 1 || (error - drift).abs() < 1e-9, "{row:?}");
    }
    for row in of("sweeps") {
        assert_eq!((row.fresh_error, row.factor_age), (None, None));
    }
    for row in of("auto") {
        assert_eq!(row.factor_age, None, "waves travel 23.5 edges per frame");
    }
    let global = of("global");
    assert!(global[0].step_error > global[0].fresh_error, "{global:?}");
    // The new factor is that of the cut body, which is not cut again.
    for row in &global[2..] {
        assert_eq!(row.step_error, row.fresh_error);
    }
    assert!(recovery(&global).is_some_and(|frames| frames <= 2));
}

#[test]
fn recovery_is_the_first_frame_from_which_all_are_accurate() {
    let row = |frame, ms, step_error, fresh_error| FrameRow {
        body: "ball",
        triangles: 20,
        solver: "global",
        iterations: 8,
        frame,
        ms,
        step_error,
        fresh_error,
        motion: None,
        drift: None,
        factor_age: None,
        machine: String::new(),
        commit: String::new(),
    };
    let rows = [
        row(1, 5.0, Some(1.0), Some(0.1)),
        row(2, 1.0, Some(0.1), Some(0.1)),
        row(3, 1.0, Some(0.3), Some(0.1)),
        row(4, 1.5, Some(0.14), Some(0.1)),
        row(5, 1.0, Some(0.1), Some(0.1)),
    ];
    let rows: Vec<&FrameRow> = rows.iter().collect();
    assert_eq!(recovery(&rows), Some(3));
    assert_eq!(recovery(&rows[..3]), None, "frame 3 is not accurate");
    assert!((blocked(&rows) - 4.0).abs() < 1e-12);
}
