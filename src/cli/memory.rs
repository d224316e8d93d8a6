//! The program's allocator: the system's, which counts bytes on its way: an atomic addition and an atomic maximum for each allocation.
//!
//! What that costs a render, reading and building included (path traced, one sample, callgrind): 0.29 % of the instructions for the 69,451 triangles of the bunny at 96x64, 0.015 %
//! for `lecture-objects` at 60x40. In user seconds of both threads it cannot be told (bunny, 240x180, 4 samples, seven runs in turns: medians 0.213 with and 0.214 without, runs from 0.201
//! to 0.232).

use bspray::analysis::MemoryMeter;
use peakmem_alloc::{PeakMemAlloc, PeakMemAllocTrait};
use std::alloc::System;

#[global_allocator]
static HEAP: PeakMemAlloc<System> = PeakMemAlloc::system();

/// What is on the heap.
pub(super) const METER: MemoryMeter = MemoryMeter {
    reset: || HEAP.reset_peak_memory(),
    peak: || HEAP.get_peak_memory(),
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_freed_again_counts_and_what_was_there_does_not() {
        let before = vec![1_u8; 3_000_000];
        let (after, bytes) = METER.of(|| {
            drop(std::hint::black_box(vec![1_u8; 50_000_000]));
            std::hint::black_box(vec![1_u8; 1_000_000])
        });
        assert_eq!((before.len(), after.len()), (3_000_000, 1_000_000));
        // Other tests run at the same time.
        assert!((40_000_000..5_000_000_000).contains(&bytes), "{bytes}");
    }
}
