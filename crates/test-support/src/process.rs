//! Runs a test alone in a process of its own.

use std::process::Command;

/// Names the test that a process was started for.
const KEY: &str = "INCISE_TEST_PROCESS";

/// Runs `body` in a process in which no other test runs.
///
/// Allocation counters and loaded libraries belong to a process. The calling test, `name` as the
/// test program lists it, starts its program again for itself alone.
///
/// # Panics
/// If `body` panics there, or no test has that name.
pub fn in_own_process(name: &str, body: impl FnOnce()) {
    if std::env::var(KEY).is_ok_and(|started| started == name) {
        return body();
    }
    let program = std::env::current_exe().expect("the path of this program");
    let output = Command::new(program)
        .args(["--exact", name, "--nocapture", "--test-threads", "1"])
        .env(KEY, name)
        .output()
        .expect("a process");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && printed.contains("1 passed"),
        "{name} in its own process: {printed}{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
