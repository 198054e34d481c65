//! What a number was measured on.

/// The processor's name and its number of threads.
pub(crate) fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    format!("{name}, {threads} threads")
}

/// The commit that the program was built from, with a mark when its sources differed from it; `unknown` when they
/// were no repository.
pub(crate) fn commit() -> String {
    env!("INCISE_COMMIT").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_is_twelve_digits_and_a_mark_or_unknown() {
        let commit = commit();
        let digits = commit.strip_suffix("-dirty").unwrap_or(&commit);
        let is_hash = digits.len() >= 12 && digits.chars().all(|c| c.is_ascii_hexdigit());
        assert!(is_hash || commit == "unknown", "{commit}");
    }
}
