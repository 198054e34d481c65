//! Tests of solver, scenes and images on GPUs, in one program that compiles each kernel once.
//!
//! On a strict adapter results equal those of the CPU bit for bit. Without an adapter the tests are
//! ignored, or fail if `INCISE_REQUIRE_GPU` is set. Long ones run with `--ignored`.

#![expect(
    clippy::missing_assert_message,
    reason = "these are tests, which the lint knows by an attribute only"
)]

mod child_process;
mod device;
mod program;
mod render;
mod scene;
mod solver;

use incise_test_support::gpu::{Needs, long, run, trial, trial_alone};
use scene::{backend, models, scenes};
use solver::{bodies, contacts, deltas, growth, kernels, misuse, motion, pipelines, solids, steps};
use std::process::ExitCode;

/// A test that any adapter can run.
const NEEDS_ANY_ADAPTER: &str = "adapters_are_chosen_and_errors_are_typed";

fn main() -> ExitCode {
    if let Some(code) = child_process::call() {
        return code;
    }
    let (any, strict) = (Needs::AnyDevice, Needs::Strict);
    let mut trials = vec![
        // Slow ones first, so that they run side by side.
        trial("steps_match_the_cpu", strict, steps::to_the_bit),
        trial_alone(
            "device_loss_continues_from_the_checkpoint",
            strict,
            backend::lost_after_a_checkpoint,
        ),
        trial("solids_match_the_cpu", strict, solids::to_the_bit),
        trial(
            "solids_in_scenes_match_the_cpu",
            strict,
            scene::solids::to_the_bit,
        ),
        trial("solids_are_close_to_the_cpu", any, solids::within_rounding),
        trial("edits_equal_a_full_upload", strict, deltas::to_the_bit),
        trial("the_gallery", any, program::gallery::few),
        trial("contacts_in_scenes_match_the_cpu", strict, scenes::contacts),
        trial("pictures_of_meshes", any, program::render::pictures),
        trial(
            "rejected_calls_lose_nothing",
            strict,
            misuse::rejected_calls,
        ),
        trial("motions_are_close_to_the_cpu", any, growth::motions),
        trial("bodies_of_a_scene_are_independent", any, scenes::alone),
        trial("kernels_match_the_cpu", strict, kernels::to_the_bit),
        trial(
            "kernels_are_within_rounding",
            any,
            kernels::on_every_adapter,
        ),
        trial(
            "contacts_and_colliders_match_the_cpu",
            strict,
            contacts::to_the_bit,
        ),
        trial(
            "bodies_outgrow_their_workgroup",
            strict,
            growth::out_of_a_workgroup,
        ),
        trial("models_with_a_cut_match_the_cpu", strict, models::few),
        trial("scenes_match_the_cpu", strict, scene::to_the_bit),
        trial("motion_is_reported", strict, motion::reports),
        trial("bodies_are_independent", any, bodies::independent),
        trial_alone("threads_share_a_device", any, bodies::on_threads),
        trial(
            "kernels_are_compiled_when_needed",
            any,
            pipelines::compiled_and_timed,
        ),
        trial("requested_data_is_transferred", any, bodies::transfers),
        trial("scenes_transfer_what_they_need", any, scene::transfers),
        trial("the_backend_is_chosen_per_body", strict, backend::choice),
        trial_alone("device_loss_ends_in_a_fallback", any, backend::device_loss),
        trial_alone(NEEDS_ANY_ADAPTER, any, device::adapters_and_errors),
        trial("images_of_bodies_and_overlays", any, render::content),
        trial("images_and_their_buffers", any, render::images),
        trial("pictures_of_simulations", any, program::simulate::pictures),
        long(trial("the_whole_gallery", any, program::gallery::all)),
        long(trial("all_models_match_the_cpu", strict, models::all)),
        long(trial(
            "random_solids_match_the_cpu",
            strict,
            scene::solids::random,
        )),
        long(trial("closed_forms_hold", any, solver::long::closed_forms)),
        long(trial("stress_tests_hold", any, solver::long::stress)),
    ];
    trials.extend(device::processes::trials());
    run(trials)
}
