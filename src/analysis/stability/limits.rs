//! Limits that a child process sets itself before it does what may run away.

/// Ends this process when it uses more memory (bytes of address space) or processor time (seconds) than this. Does nothing where the system has no such limits.
#[cfg(any(target_os = "linux", target_os = "macos"))]
pub(super) fn limit_this_process(memory_bytes: u64, cpu_seconds: u64) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let limit = |most| Rlimit {
        current: Some(most),
        maximum: Some(most),
    };
    // Without them the parent's clock ends the process, as long as the parent lives.
    let _ = setrlimit(Resource::As, limit(memory_bytes));
    let _ = setrlimit(Resource::Cpu, limit(cpu_seconds));
}

/// Ends this process when it uses more than this, where the system can; here it cannot.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
pub(super) fn limit_this_process(_memory_bytes: u64, _cpu_seconds: u64) {}
