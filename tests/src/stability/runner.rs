//! Runs stress cases on the CPU or a GPU.

use super::{Found, Outcome};
use incise_mesh::{Surface, TopologyDelta};
use incise_models::scenes::unit_size;
use incise_models::{Model, build_model};
#[cfg(feature = "gpu")]
use incise_pbd_gpu::{AdapterRequest, GpuBackend, GpuBody, GpuError};
use incise_pbd_gpu::{Material, Solver, SolverParams};
use incise_scene::{BackendChoice, BackendRequest};
use incise_test_support::energy::{EnergyBudget, Limits, batches};
use incise_test_support::params::set_ground;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};
use std::thread;

/// A mesh of cases over models, of [one size](unit_size).
#[derive(Debug)]
pub struct Subject {
    /// The name of the model or of its file.
    pub name: String,
    /// The surface.
    pub surface: Surface,
}

impl Subject {
    /// Returns a subject; none for a mesh without an extent.
    #[must_use]
    pub fn new(name: String, surface: Surface) -> Option<Self> {
        let surface = unit_size(surface)?;
        Some(Self { name, surface })
    }

    /// Returns the built-in models.
    pub(super) fn built_in() -> Vec<Self> {
        let of = |model: Model| Self::new(model.name().to_owned(), build_model(model));
        Model::ALL.into_iter().filter_map(of).collect()
    }

    pub(super) fn triangles(&self) -> usize {
        self.surface.topology().triangle_count()
    }
}

/// The backend of stress cases, and their models.
#[derive(Debug)]
pub struct Runner {
    /// The models of cases over models, smallest first and each once.
    subjects: OnceLock<Vec<Subject>>,
    /// Drops of each model in `drop`, runs of each mesh in `still`; `None` leaves them to the case.
    pub samples: Option<u32>,
    /// Text in the description of drops; others are left out.
    pub matching: Option<String>,
    /// The backend of scenes.
    pub(super) backend: BackendRequest,
    /// The GPU of bodies without a scene.
    #[cfg(feature = "gpu")]
    gpu: Option<Mutex<GpuBackend>>,
}

impl Runner {
    /// Runs cases on the CPU.
    #[must_use]
    pub fn cpu() -> Self {
        Self {
            subjects: OnceLock::new(),
            samples: None,
            matching: None,
            backend: BackendRequest::default(),
            #[cfg(feature = "gpu")]
            gpu: None,
        }
    }

    /// Runs cases on a GPU with a part of its name, or on the best one; software if there is no
    /// other. Also returns its name and driver.
    ///
    /// # Errors
    /// When there is no such GPU.
    #[cfg(feature = "gpu")]
    pub fn gpu(adapter: Option<&str>) -> Result<(Self, String), GpuError> {
        let request = AdapterRequest::any(adapter.map(str::to_owned));
        let gpu = GpuBackend::new(&request)?;
        let described = format!("{} ({})", gpu.adapter().name, gpu.adapter().driver);
        let backend = BackendRequest {
            choice: BackendChoice::Gpu,
            adapter: request.name,
            allow_software: true,
            min_gpu_constraints: None,
        };
        let runner = Self {
            backend,
            gpu: Some(Mutex::new(gpu)),
            ..Self::cpu()
        };
        Ok((runner, described))
    }

    /// Replaces the built-in models.
    #[must_use]
    pub fn with_subjects(self, mut subjects: Vec<Subject>) -> Self {
        subjects.sort_by_key(Subject::triangles);
        subjects.dedup_by(|next, first| next.surface.positions() == first.surface.positions());
        let subjects = subjects.into();
        Self { subjects, ..self }
    }

    /// Returns the models up to a number of triangles that are closed.
    pub(super) fn closed_subjects(&self, triangles: usize) -> impl Iterator<Item = &Subject> {
        (self.subjects().iter()).filter(move |subject| {
            subject.triangles() <= triangles && subject.surface.topology().is_closed()
        })
    }

    pub(super) fn subjects(&self) -> &[Subject] {
        // In the order of their triangles already.
        self.subjects.get_or_init(Subject::built_in)
    }

    /// Runs every item: side by side on the CPU, one after the other on a GPU.
    pub fn each<T: Sync, R: Send>(&self, items: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
        match self.backend.choice {
            BackendChoice::Gpu => items.iter().map(run).collect(),
            _ => side_by_side(items, run),
        }
    }

    /// Sets up a body without a scene; it may be deformed.
    pub(super) fn body(&self, mut surface: Surface, material: &Material) -> Found<Body<'_>> {
        let solver = Solver::new(&mut surface, material)?;
        self.body_with(surface, solver)
    }

    /// Adds a body as [`Runner::body`], above a horizontal plane through the origin.
    pub(super) fn body_on_ground(
        &self,
        mut surface: Surface,
        material: &Material,
    ) -> Found<Body<'_>> {
        let mut solver = Solver::new(&mut surface, material)?;
        set_ground(&mut solver, 0.0);
        self.body_with(surface, solver)
    }

    /// Adds a body as [`Runner::body`], with a given solver.
    pub(super) fn body_with(&self, surface: Surface, solver: Solver) -> Found<Body<'_>> {
        let mut body = Body {
            surface,
            solver,
            runner: self,
            #[cfg(feature = "gpu")]
            place: None,
        };
        body.upload()?;
        Ok(body)
    }
}

#[cfg(feature = "gpu")]
fn lock(gpu: &Mutex<GpuBackend>) -> std::sync::MutexGuard<'_, GpuBackend> {
    gpu.lock()
        .expect("runs on a GPU end the process when they panic")
}

/// A body in motion; dropping it removes it from the GPU.
#[derive(Debug)]
pub(super) struct Body<'a> {
    pub(super) surface: Surface,
    pub(super) solver: Solver,
    #[cfg_attr(
        not(feature = "gpu"),
        expect(dead_code, reason = "only GPUs are shared")
    )]
    runner: &'a Runner,
    #[cfg(feature = "gpu")]
    place: Option<GpuBody>,
}

impl Body<'_> {
    /// Adds the body to the GPU, or uploads its edits.
    fn upload(&mut self) -> Found<()> {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.runner.gpu {
            match self.place {
                Some(place) => lock(gpu).update(place, &self.surface, &mut self.solver)?,
                None => self.place = Some(lock(gpu).add(&self.surface, &mut self.solver)?),
            }
        }
        Ok(())
    }

    /// Steps by frames of `dt` \[s\]; surface and solver are up to date after the last.
    pub(super) fn advance(&mut self, dt: f32, params: &SolverParams, frames: u32) -> Found<()> {
        #[cfg(feature = "gpu")]
        if let (Some(gpu), Some(place)) = (&self.runner.gpu, self.place) {
            let mut gpu = lock(gpu);
            for _ in 0..frames {
                gpu.step([(place, &mut self.solver)], dt, params)?;
            }
            return Ok(gpu.read(place, &mut self.surface, &mut self.solver)?);
        }
        for _ in 0..frames {
            self.solver.step(&mut self.surface, dt, params)?;
        }
        Ok(())
    }

    /// Follows an edit of the surface.
    pub(super) fn follow(&mut self, delta: &TopologyDelta) -> Found<()> {
        self.solver.apply_delta(&mut self.surface, delta)?;
        self.upload()
    }

    /// Runs frames within limits; the value is the largest energy relative to the start.
    ///
    /// Calls `watch` with the number of every frame at its end.
    pub(super) fn watched(
        &mut self,
        dt: f32,
        params: &SolverParams,
        frames: u32,
        limits: Limits,
        mut watch: impl FnMut(&Self, u32) -> Found<()>,
    ) -> Found<Outcome> {
        let mut budget = EnergyBudget::new(&self.surface, &self.solver, params, limits);
        for frame in 0..frames {
            self.advance(dt, params, 1)?;
            budget.record(&self.surface, &self.solver, params, f64::from(dt));
            watch(self, frame)?;
        }
        budget.record_end(&self.surface, &self.solver);
        Ok(Outcome {
            values: vec![Some(budget.ratio)],
            // The energy bounds the speed already: a limit of speed alone is no second invariant.
            limits: budget.share.filter(|_| limits.has_more_than_energy()),
        })
    }

    /// Returns the energies of a run as [`Body::watched`], without a watch.
    pub(super) fn energy_over(
        &mut self,
        dt: f32,
        params: &SolverParams,
        frames: u32,
        limits: Limits,
    ) -> Found<Outcome> {
        self.watched(dt, params, frames, limits, |_, _| Ok(()))
    }

    /// Returns the largest strain of an edge.
    pub(super) fn largest_strain(&self) -> f64 {
        let mut largest = 0.0_f64;
        for batch in batches(self.solver.stretch()) {
            for (&[a, b], &rest) in batch.vertices().iter().zip(batch.rest()) {
                let length = (self.surface.position(a) - self.surface.position(b)).norm();
                largest = largest.max((length / f64::from(rest) - 1.0).abs());
            }
        }
        largest
    }
}

#[cfg(feature = "gpu")]
impl Drop for Body<'_> {
    fn drop(&mut self) {
        if let (Some(gpu), Some(place)) = (&self.runner.gpu, self.place) {
            lock(gpu).remove(place);
        }
    }
}

/// Runs every item and returns the results in the order of the items.
///
/// A thread takes the next item when it is done with one. Each has a thread pool of its own, so
/// that a run neither waits for others nor depends on their number.
///
/// # Panics
/// If a run does.
pub fn side_by_side<T: Sync, R: Send>(items: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let threads = thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
        // Without a pool of its own it shares the global one: slower, not different.
        let _pool = pool.use_current_thread().build();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(i) else { return };
            let result = run(item);
            (done.lock().expect("no thread panics with it")).push((i, result));
        }
    };
    thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            scope.spawn(work);
        }
    });
    let mut done = done.into_inner().expect("no thread panics with it");
    done.sort_unstable_by_key(|&(i, _)| i);
    done.into_iter().map(|(_, result)| result).collect()
}
