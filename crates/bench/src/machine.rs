//! Machine and commit of a measurement.

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

/// Returns the commit of the build, marked `-dirty` for modified sources; `unknown` outside of a
/// repository.
pub(crate) fn commit() -> String {
    env!("INCISE_COMMIT").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_has_twelve_digits_or_is_unknown() {
        let commit = commit();
        let digits = commit.strip_suffix("-dirty").unwrap_or(&commit);
        let is_hash = digits.len() >= 12 && digits.chars().all(|c| c.is_ascii_hexdigit());
        assert!(is_hash || commit == "unknown", "{commit}");
    }
}
