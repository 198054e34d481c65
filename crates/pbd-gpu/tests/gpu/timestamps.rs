//! GPU time of steps, and no cost without a request for it.

use incise_mesh::Surface;
use incise_pbd_gpu::{Context, GpuBackend, Schedule};
use incise_test_support::cpu_gpu_pair::{DT, SCHEDULES, solver_for, with_most_features};
use incise_test_support::gpu::{Needs, trial};
use incise_test_support::surfaces::sphere;
use libtest_mimic::Trial;

pub(crate) fn trials() -> Vec<Trial> {
    let any = Needs::AnyDevice;
    vec![trial("every_timed_step_has_a_time", any, timed)]
}

/// Two steps of a body; whether each has a time, and where the body is then.
fn steps(gpu: &mut GpuBackend, schedule: Schedule) -> ([Option<f64>; 2], Surface) {
    let (material, params) = with_most_features();
    gpu.force_schedule(Some(schedule));
    let mut surface = sphere(3, [0.0; 3]);
    let mut solver = solver_for(&mut surface, &material, schedule);
    let body = gpu.add(&surface, &mut solver).expect("room");
    let times = [(); 2].map(|()| {
        gpu.step([(body, &mut solver)], DT, &params)
            .expect("a step");
        gpu.step_seconds().expect("a device")
    });
    gpu.read(body, &mut surface, &mut solver).expect("a body");
    gpu.remove(body);
    (times, surface)
}

fn timed(context: Context) {
    let has_timestamps = context.has_timestamps();
    let mut gpu = GpuBackend::from_context(context).expect("a device");
    for schedule in SCHEDULES {
        let (none, plain) = steps(&mut gpu, schedule);
        assert_eq!(none, [None; 2], "nobody asked");
        assert_eq!(gpu.time_steps(true).expect("a device"), has_timestamps);
        let (times, surface) = steps(&mut gpu, schedule);
        for time in times {
            assert_eq!(time.is_some(), has_timestamps);
            // A step of six iterations is done after it was begun.
            assert!(time.is_none_or(|t| t.is_finite() && t > 0.0), "{time:?}");
        }
        assert_eq!(gpu.step_seconds().expect("a device"), None, "told once");
        assert_eq!(
            surface.positions(),
            plain.positions(),
            "{}",
            schedule.name()
        );
        assert!(!gpu.time_steps(false).expect("a device"));
        assert_eq!(
            steps(&mut gpu, schedule).0,
            [None; 2],
            "nobody asks any more"
        );
    }
}
