//! The clock of all measurements: wall time, and the processor time of the thread that works.

use std::time::Instant;

/// How long something took, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elapsed {
    /// By the clock on the wall.
    pub wall: f64,
    /// Processor time of the thread that asks; the wall's where the system does not tell it. Other work on the machine
    /// hardly changes it.
    pub cpu: f64,
}

/// Measures from its start on. Both ends belong to one thread.
///
/// ```
/// use bspray::analysis::Stopwatch;
/// let watch = Stopwatch::start();
/// let elapsed = watch.elapsed();
/// assert!(elapsed.wall >= 0.0 && elapsed.cpu >= 0.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    cpu: Option<f64>,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self {
            cpu: thread_seconds(),
            wall: Instant::now(),
        }
    }

    /// What has passed since the start.
    pub fn elapsed(&self) -> Elapsed {
        let wall = self.wall.elapsed().as_secs_f64();
        let cpu = self
            .cpu
            .zip(thread_seconds())
            .map_or(wall, |(start, now)| now - start);
        Elapsed { wall, cpu }
    }
}

/// Processor seconds of this thread.
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn thread_seconds() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn thread_seconds() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_costs_wall_time_only_and_work_costs_both() {
        let watch = Stopwatch::start();
        std::thread::sleep(std::time::Duration::from_millis(20));
        let slept = watch.elapsed();
        assert!(slept.wall >= 0.02);
        if cfg!(target_os = "linux") {
            assert!(slept.cpu < slept.wall);
        }
        let watch = Stopwatch::start();
        let work = (0..3_000_000_u64).fold(1, |x, i| std::hint::black_box(x ^ i));
        std::hint::black_box(work);
        assert!(watch.elapsed().cpu > 0.0);
    }
}
