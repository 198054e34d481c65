//! The stress tests of the solver on the CPU; `tests/tests/gpu` runs them on a GPU.

use incise_tests::stress::{Runner, cases};

fn run(name: &str) {
    let (_, case) = cases()
        .find(|case| case.0 == name)
        .expect("the name of a case");
    case(&mut Runner {
        advance: &mut |surface, solver, dt, params, frames| {
            for _ in 0..frames {
                solver.step(surface, dt, params).expect("a step");
            }
        },
        is_gpu: false,
    });
}

/// Makes a test for every case.
macro_rules! stress_tests {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            run(stringify!($name));
        })*

        #[test]
        fn every_stress_case_has_a_test() {
            let tested = [$(stringify!($name)),*];
            let missing = cases().find(|case| !tested.contains(&case.0));
            assert_eq!(missing.map(|case| case.0), None);
        }
    };
}

stress_tests! {
    crushed_shells_gain_no_energy
    crushed_shells_regain_their_lengths
    a_vertex_pushed_through_a_ball_comes_back
    folded_hinges_unfold
    slivers_gain_no_energy
    vertices_of_any_valence_gain_no_energy
    constraints_without_a_color_gain_no_energy
    open_seams_and_free_vertices_gain_no_energy
    a_body_of_pins_does_not_move
    a_sheet_follows_a_pin_that_leaps
    a_sheet_follows_a_pin_that_turns
    a_pin_that_comes_and_goes_adds_no_energy
    compliances_that_change_add_no_energy
    gravity_that_turns_over_adds_its_work_only
    time_steps_that_change_add_no_energy
    subnormal_compliances_are_rigid
    falls_on_faces_edges_and_corners_add_no_energy
    impacts_add_no_energy_and_stay_above_ground
    a_ball_squeezed_through_itself_recovers
    random_undamped_bodies_gain_no_energy
    a_volume_turned_inside_out_throws_nothing
    an_opened_piece_has_no_volume
}
