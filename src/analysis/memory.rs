//! How much memory a piece of work takes, where somebody counts: a program whose allocator does so passes it on.

/// A count of bytes on the heap of this process, of all threads together.
#[derive(Clone, Copy, Debug)]
pub struct MemoryMeter {
    /// Begins to count: what is there now is 0.
    pub reset: fn(),
    /// Most bytes that were there at once since then.
    pub peak: fn() -> usize,
}

impl MemoryMeter {
    /// Does the work, and tells the most bytes that it had at once beyond those that were there before.
    pub fn of<T>(&self, work: impl FnOnce() -> T) -> (T, u64) {
        (self.reset)();
        let done = work();
        (done, (self.peak)() as u64)
    }
}
