//! Measures the body size from which the GPU is faster than the CPU.

use super::backend::GpuBackend;
use super::error::GpuError;
use crate::material::Material;
use crate::solver::Solver;
use crate::step::params::SolverParams;
use incise_mesh::{Surface, icosphere};
use std::time::{Duration, Instant};

/// Subdivisions of the spheres: 80 to 81,920 triangles, three constraints a triangle.
const SUBDIVISIONS: std::ops::RangeInclusive<u32> = 1..=6;
/// Frames of one measurement, of which there are [`REPEATS`]; the fastest counts.
const FRAMES: u32 = 6;
const REPEATS: u32 = 3;
/// Time limit per frame; larger spheres are skipped once one exceeds it.
const PATIENCE: Duration = Duration::from_millis(60);

/// Measurement of one size.
#[derive(Debug, Clone, Copy)]
struct Measured {
    constraints: usize,
    cpu: Duration,
    device: Duration,
}

impl GpuBackend {
    /// Returns the number of constraints from which the GPU is faster than the CPU.
    ///
    /// Steps spheres of increasing size on both with frames of `dt` \[s\], for a fraction of a
    /// second. Returns `None` if the CPU always wins. Results vary from call to call. Resident
    /// bodies are not affected.
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
                // Bodies that do not fit stay on the CPU.
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

    /// Returns the GPU time of a frame of a body.
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

/// Returns the shortest time per frame of several runs, after a warm-up run.
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

/// Returns the smallest size from which the GPU wins every time.
fn wins_from(measured: &[Measured]) -> Option<usize> {
    let wins = measured.iter().rev().take_while(|m| m.device < m.cpu);
    wins.last().map(|m| m.constraints)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gpu_is_used_from_the_size_where_it_always_wins() {
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
