//! A team of threads that runs the chunks of one pass after another.
//!
//! The calling thread is the leader. It publishes a pass, and all members claim its chunks: first
//! those of their own range, which is the same in every pass, then those of others. The leader
//! waits for claimed chunks only, never for a thread. So a thread that joins late, is suspended or
//! never starts costs time, and the pool may be busy with other work. A member without a chunk
//! spins, then yields its core, then parks until the next pass.

use super::parking::Parking;
use std::cell::UnsafeCell;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread;

/// Maximum number of members of a team.
const MAX_MEMBERS: usize = 16;

/// Polls of a waiting thread before it offers its core to other threads.
const SPINS: u32 = 2000;

/// Offers of the core before a member parks; together they last about as long as a wake-up.
const YIELDS: u32 = 100;

/// Runs a chunk of a pass, given its number.
type Run<'a> = dyn Fn(usize) + Sync + 'a;

/// Runs `work` with a team of at most `threads` threads of the current rayon pool.
///
/// `None` takes all threads of the pool. One thread does not touch the pool.
pub(crate) fn with_team<R>(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce(&mut Leader<'_>) -> R,
) -> R {
    let limit = threads.map_or(MAX_MEMBERS, NonZeroUsize::get);
    let members = match limit {
        1 => 1,
        limit => limit.min(rayon::current_num_threads()).min(MAX_MEMBERS),
    };
    let team = Team::new(members);
    if members == 1 {
        return work(&mut Leader(&team));
    }
    rayon::in_place_scope(|scope| {
        for member in 1..members {
            let team = &team;
            scope.spawn(move |_| team.help(member));
        }
        let _end = CloseOnDrop(&team);
        work(&mut Leader(&team))
    })
}

/// The thread that publishes passes.
#[derive(Debug)]
pub(crate) struct Leader<'a>(&'a Team);

impl Leader<'_> {
    /// Returns the number of members of the team.
    pub(crate) fn members(&self) -> usize {
        self.0.members
    }

    /// Runs all chunks of a pass, each once, on the threads of the team.
    pub(crate) fn run(&mut self, chunks: usize, run: &Run<'_>) {
        let team = self.0;
        if team.members == 1 || chunks < 2 {
            (0..chunks).for_each(run);
            return;
        }
        team.publish(chunks, run);
        // Also after a panic, since `run` must outlive the chunks that others have claimed.
        let _finish = FinishOnDrop { team, chunks };
        team.work(0, run);
    }
}

#[derive(Debug)]
struct Team {
    members: usize,
    /// The next chunk (low half) and the end (high half) of every member's range.
    ranges: [Range; MAX_MEMBERS],
    /// Number of finished chunks of the pass.
    finished: AtomicUsize,
    is_closed: AtomicBool,
    parking: Parking,
    pass: Pass,
}

/// A range of chunks in a cache line of its own.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Range(AtomicU64);

/// The published pass.
struct Pass(UnsafeCell<Option<&'static Run<'static>>>);

// SAFETY: the leader writes the pass only while all chunks of the one before are finished, so no
// range has a chunk left. A member reads it only between claiming and finishing a chunk.
// `Team::publish` and `Range::claim` order the accesses.
unsafe impl Sync for Pass {}

impl std::fmt::Debug for Pass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Pass")
    }
}

impl Range {
    /// Returns whether a packed range has a chunk left.
    fn has_chunk(range: u64) -> bool {
        (range & LOW) < (range >> 32)
    }

    /// Returns whether a chunk is left to claim.
    fn is_open(&self) -> bool {
        Self::has_chunk(self.0.load(Ordering::Relaxed))
    }

    /// Returns the next chunk of the range and removes it.
    fn claim(&self) -> Option<usize> {
        // Without this test, the counter of an empty range would overflow.
        if !self.is_open() {
            return None;
        }
        // Acquires the pass that was published with the range.
        let range = self.0.fetch_add(1, Ordering::Acquire);
        Self::has_chunk(range).then_some((range & LOW) as usize)
    }
}

/// The half of a range that holds the next chunk.
const LOW: u64 = 0xffff_ffff;

impl Team {
    fn new(members: usize) -> Self {
        Self {
            members,
            ranges: Default::default(),
            finished: AtomicUsize::new(0),
            is_closed: AtomicBool::new(false),
            parking: Parking::default(),
            pass: Pass(UnsafeCell::new(None)),
        }
    }

    /// Offers the chunks of a pass to all members.
    fn publish(&self, chunks: usize, run: &Run<'_>) {
        self.finished.store(0, Ordering::Relaxed);
        // SAFETY: only the lifetime changes. `FinishOnDrop` waits for every claimed chunk before
        // the borrow ends, and no member uses the pass except for a claimed chunk.
        let run = unsafe { std::mem::transmute::<&Run<'_>, &'static Run<'static>>(run) };
        // SAFETY: see `Pass`; all ranges are empty here.
        unsafe { *self.pass.0.get() = Some(run) };
        for (member, range) in self.ranges[..self.members].iter().enumerate() {
            let next = chunks * member / self.members;
            let end = chunks * (member + 1) / self.members;
            let packed = (end as u64) << 32 | next as u64;
            range.0.store(packed, Ordering::Release);
        }
        self.parking.wake_all();
    }

    /// Returns whether the team is closed; its members then end.
    fn is_closed(&self) -> bool {
        self.is_closed.load(Ordering::Relaxed)
    }

    /// Returns a claimed chunk, from the range of `member` if it has any.
    fn claim(&self, member: usize) -> Option<usize> {
        let (before, from) = self.ranges[..self.members].split_at(member);
        from.iter().chain(before).find_map(Range::claim)
    }

    /// Runs chunks until no one is left to claim.
    fn work(&self, member: usize, run: &Run<'_>) {
        while let Some(chunk) = self.claim(member) {
            let _finished = CountOnDrop(&self.finished);
            run(chunk);
        }
    }

    /// Runs chunks of passes until the team is closed.
    fn help(&self, member: usize) {
        let mut polls = 0;
        while !self.is_closed() {
            if let Some(chunk) = self.claim(member) {
                polls = 0;
                let _finished = CountOnDrop(&self.finished);
                // SAFETY: the claimed chunk is not finished, see `Pass`.
                if let Some(run) = unsafe { *self.pass.0.get() } {
                    run(chunk);
                }
            } else if polls < SPINS + YIELDS {
                wait(&mut polls);
            } else {
                let ranges = &self.ranges[..self.members];
                (self.parking).park_until(|| self.is_closed() || ranges.iter().any(Range::is_open));
                polls = 0;
            }
        }
    }
}

/// Spins for a moment; after many calls it yields the core.
fn wait(polls: &mut u32) {
    if *polls < SPINS {
        std::hint::spin_loop();
    } else {
        thread::yield_now();
    }
    *polls = polls.saturating_add(1);
}

/// Counts a chunk as finished.
struct CountOnDrop<'a>(&'a AtomicUsize);

impl Drop for CountOnDrop<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// Waits until all chunks of a pass are finished; skips those that are not claimed after a panic.
struct FinishOnDrop<'a> {
    team: &'a Team,
    chunks: usize,
}

impl Drop for FinishOnDrop<'_> {
    fn drop(&mut self) {
        while self.team.claim(0).is_some() {
            self.team.finished.fetch_add(1, Ordering::Relaxed);
        }
        let mut polls = 0;
        while self.team.finished.load(Ordering::Acquire) < self.chunks {
            wait(&mut polls);
        }
    }
}

/// Ends the team.
struct CloseOnDrop<'a>(&'a Team);

impl Drop for CloseOnDrop<'_> {
    fn drop(&mut self) {
        self.0.is_closed.store(true, Ordering::Relaxed);
        self.0.parking.wake_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU32;

    fn pool(threads: usize) -> rayon::ThreadPool {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap()
    }

    #[test]
    fn every_chunk_runs_once_and_passes_follow_each_other() {
        for threads in [1, 2, 3, 5, 8] {
            pool(threads).install(|| {
                with_team(None, |leader| {
                    assert_eq!(leader.members(), threads);
                    for pass in 0..500 {
                        let chunks = pass % 40;
                        let counts: Vec<_> = (0..chunks).map(|_| AtomicU32::new(0)).collect();
                        leader.run(chunks, &|chunk| {
                            counts[chunk].fetch_add(1, Ordering::Relaxed);
                        });
                        assert!(counts.into_iter().all(|count| count.into_inner() == 1));
                    }
                });
            });
        }
    }

    #[test]
    fn a_busy_pool_does_not_block_the_leader() {
        let pool = pool(2);
        let is_done = AtomicBool::new(false);
        pool.in_place_scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|_| {
                    while !is_done.load(Ordering::Acquire) {
                        thread::yield_now();
                    }
                });
            }
            let team = Team::new(2);
            let count = AtomicU32::new(0);
            Leader(&team).run(10, &|_| {
                count.fetch_add(1, Ordering::Relaxed);
            });
            is_done.store(true, Ordering::Release);
            assert_eq!(count.into_inner(), 10);
        });
    }

    #[test]
    fn idle_members_park_and_wake_for_the_next_pass() {
        pool(3).install(|| {
            let team = Team::new(3);
            rayon::in_place_scope(|scope| {
                for member in 1..3 {
                    let team = &team;
                    scope.spawn(move |_| team.help(member));
                }
                let _end = CloseOnDrop(&team);
                for _ in 0..20 {
                    while team.parking.parked() < 2 {
                        thread::yield_now();
                    }
                    // Two chunks that wait for each other need two threads.
                    let arrived = AtomicU32::new(0);
                    Leader(&team).run(2, &|_| {
                        arrived.fetch_add(1, Ordering::Relaxed);
                        while arrived.load(Ordering::Relaxed) < 2 {
                            thread::yield_now();
                        }
                    });
                }
            });
        });
    }

    #[test]
    fn a_panic_of_a_chunk_reaches_the_caller() {
        let done = pool(2).install(|| {
            std::panic::catch_unwind(|| {
                with_team(None, |leader| {
                    leader.run(8, &|chunk| assert_ne!(chunk, 5, "a panic"))
                });
            })
        });
        assert!(done.is_err(), "the panic is passed on");
    }

    #[test]
    fn one_thread_runs_without_a_pool() {
        let caller = thread::current().id();
        with_team(NonZeroUsize::new(1), |leader| {
            leader.run(4, &|_| assert_eq!(thread::current().id(), caller));
        });
    }
}
