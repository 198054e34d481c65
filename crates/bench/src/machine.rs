//! Machine and commit of a measurement.

/// The commit of the build, marked `-dirty` for modified sources; `unknown` outside of a
/// repository.
pub(crate) const COMMIT: &str = env!("INCISE_COMMIT");

/// Returns the CPU's name and its number of threads.
pub(crate) fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    format!("{name}, {threads} threads")
}
