//! From which size on a device is faster than the processor: measured, not guessed.

use super::backend::GpuBackend;
use super::error::GpuError;
use crate::material::Material;
use crate::params::SolverParams;
use crate::solver::Solver;
use incise_mesh::{Surface, icosphere};
use std::time::{Duration, Instant};

/// Subdivisions of the spheres: 80 to 81,920 triangles, three constraints a triangle.
const SUBDIVISIONS: std::ops::RangeInclusive<u32> = 1..=6;
/// Frames of one measurement, of which there are [`REPEATS`]; the fastest counts.
const FRAMES: u32 = 6;
const REPEATS: u32 = 3;
/// Larger spheres are not tried when one took longer \[a frame\]: the answer is clear or hopeless by
/// then.
const PATIENCE: Duration = Duration::from_millis(60);

/// What one size took.
#[derive(Debug, Clone, Copy)]
struct Measured {
    constraints: usize,
    cpu: Duration,
    device: Duration,
}

impl GpuBackend {
    /// How many constraints a body must have for this device to step it faster than the processor does,
    /// with frames of `dt` \[s\]. `None` if it never did. Steps spheres of growing size on both for a
    /// part of a second; what is measured may differ from call to call. Bodies that are on the device are
    /// left alone.
    ///
    /// # Errors
    /// As [`GpuBackend::step`].
    pub fn calibrate(&mut self, dt: f32, params: &SolverParams) -> Result<Option<usize>, GpuError> {
        params.check(dt)?;
        let mut measured = Vec::new();
        for subdivisions in SUBDIVISIONS {
            let mut surface = icosphere(subdivisions, 1.0);
            let Ok(mut solver) = Solver::new(&mut surface, &Material::default()) else {
                break;
            };
            let constraints = solver.stretch().len() + solver.bending().map_or(0, |set| set.len());
            let device = match self.time(&surface, &mut solver, dt, params) {
                Ok(time) => time,
                // What does not fit is not faster.
                Err(GpuError::BufferTooLarge { .. } | GpuError::OutOfMemory { .. }) => break,
                Err(error) => return Err(error),
            };
            let cpu = fastest(|| {
                for _ in 0..FRAMES {
                    solver.step(&mut surface, dt, params)?;
                }
                Ok(())
            })?;
            measured.push(Measured {
                constraints,
                cpu,
                device,
            });
            if cpu.max(device) > PATIENCE {
                break;
            }
        }
        Ok(wins_from(&measured))
    }

    /// How long the device takes for a frame of a body.
    fn time(
        &mut self,
        surface: &Surface,
        solver: &mut Solver,
        dt: f32,
        params: &SolverParams,
    ) -> Result<Duration, GpuError> {
        let body = self.add(surface, solver)?;
        let time = fastest(|| {
            for _ in 0..FRAMES {
                self.step([(body, &mut *solver)], dt, params)?;
            }
            self.wait()
        });
        self.remove(body);
        time
    }
}

/// The fastest of a few runs, by frame. One before them warms up.
fn fastest(mut run: impl FnMut() -> Result<(), GpuError>) -> Result<Duration, GpuError> {
    run()?;
    let mut best = Duration::MAX;
    for _ in 0..REPEATS {
        let begin = Instant::now();
        run()?;
        best = best.min(begin.elapsed() / FRAMES);
    }
    Ok(best)
}

/// The smallest size from which on the device won every time.
fn wins_from(measured: &[Measured]) -> Option<usize> {
    let wins = measured.iter().rev().take_while(|m| m.device < m.cpu);
    wins.last().map(|m| m.constraints)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_is_taken_from_where_it_wins_for_good() {
        let sizes = |times: &[(u64, u64)]| {
            let measured: Vec<Measured> = (1..)
                .zip(times)
                .map(|(i, &(cpu, device))| Measured {
                    constraints: 100 * i,
                    cpu: Duration::from_millis(cpu),
                    device: Duration::from_millis(device),
                })
                .collect();
            wins_from(&measured)
        };
        assert_eq!(sizes(&[]), None, "nothing was measured");
        assert_eq!(sizes(&[(1, 2), (4, 4)]), None, "a draw is no win");
        assert_eq!(sizes(&[(1, 2), (4, 3), (16, 5)]), Some(200), "the middle");
        assert_eq!(sizes(&[(3, 2), (4, 5), (16, 5)]), Some(300), "once is not");
        assert_eq!(sizes(&[(3, 2), (4, 3)]), Some(100), "always");
    }
}
