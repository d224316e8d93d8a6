//! Limits that a child process sets itself before it does what may run away.

use std::process::ExitStatus;

/// Ends this process when it uses more memory (bytes of address space) or processor time (seconds) than this. Does nothing where the system has no such limits.
#[cfg(any(target_os = "linux", target_os = "macos"))]
pub(super) fn limit_this_process(memory_bytes: u64, cpu_seconds: u64) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let limit = |current, maximum| Rlimit {
        current: Some(current),
        maximum: Some(maximum),
    };
    // Without them the parent's clock ends the process, as long as the parent lives.
    let _ = setrlimit(Resource::As, limit(memory_bytes, memory_bytes));
    // At the lower one the system sends the signal that `is_out_of_time` knows; at the other it ends the process whatever that does.
    let _ = setrlimit(Resource::Cpu, limit(cpu_seconds, cpu_seconds + 1));
}

/// Ends this process when it uses more than this, where the system can; here it cannot.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub(super) fn limit_this_process(_memory_bytes: u64, _cpu_seconds: u64) {}

/// Whether the system ended a process for its processor time.
#[cfg(any(target_os = "linux", target_os = "macos"))]
pub(super) fn is_out_of_time(status: ExitStatus) -> bool {
    use std::os::unix::process::ExitStatusExt;
    status.signal() == Some(rustix::process::Signal::XCPU.as_raw())
}

/// Whether the system ended a process for its processor time; here it does not.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub(super) fn is_out_of_time(_status: ExitStatus) -> bool {
    false
}
