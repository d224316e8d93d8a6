//! How much memory the models may take: what a file claims is charged here before it is allocated.
//!
//! A charge is never given back, so that it bounds time as well: a small file can ask for the same bytes again and again. What
//! is charged is an estimate, in bytes, mostly from above; a refusal does not depend on the order of charges, only its element does.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Share of the machine's memory that models may take where the user sets no limit: three quarters. The rest is for trees and pictures.
const SHARE: (u64, u64) = (3, 4);

/// Who was refused, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    /// The element, with its line or index.
    pub(super) element: String,
    /// What it would take, of what, and what to do about it.
    pub(super) cause: String,
}

/// The memory of one import; several threads may charge it.
#[derive(Debug)]
pub(super) struct Budget {
    limit: u64,
    used: AtomicU64,
    refusal: Mutex<Option<Refusal>>,
}

impl Budget {
    /// A budget of `limit` bytes, of which `used` are gone.
    pub(super) fn new(limit: u64, used: u64) -> Self {
        Self {
            limit,
            used: AtomicU64::new(used),
            refusal: Mutex::default(),
        }
    }

    /// Takes `bytes` for an element, if they are left.
    ///
    /// # Errors
    /// Why not. After the first refusal there is nothing for anybody, and the import ends with that refusal, whatever becomes of
    /// this error.
    pub(super) fn charge(
        &self,
        bytes: u64,
        element: impl FnOnce() -> String,
    ) -> Result<(), String> {
        let take = |used: u64| used.checked_add(bytes).filter(|&sum| sum <= self.limit);
        let taken = self
            .used
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        let Err(used) = taken else { return Ok(()) };
        let cause = format!(
            "would take {} more memory, {} of {} are used; --memory-limit raises the limit",
            size(bytes),
            size(used.min(self.limit)),
            size(self.limit)
        );
        // Nothing is left for those behind.
        self.used.store(u64::MAX, Ordering::Relaxed);
        let mut refusal = self.refusal.lock().unwrap_or_else(PoisonError::into_inner);
        refusal.get_or_insert_with(|| Refusal {
            element: element(),
            cause: cause.clone(),
        });
        Err(cause)
    }

    /// As [`Self::charge`], for `count` elements of `size` bytes.
    pub(super) fn charge_many(
        &self,
        count: usize,
        size: usize,
        element: impl FnOnce() -> String,
    ) -> Result<(), String> {
        self.charge((count as u64).saturating_mul(size as u64), element)
    }

    /// The first refusal.
    pub(super) fn refusal(&self) -> Option<Refusal> {
        let refusal = self.refusal.lock().unwrap_or_else(PoisonError::into_inner);
        refusal.clone()
    }

    /// Bytes that were charged.
    pub(super) fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }
}

/// The limit where the user sets none, in bytes: a share of the memory of the machine, or of its part for this process (a
/// control group). No limit where that is not known.
pub(super) fn default_limit() -> u64 {
    let machine = std::fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.and_then(|text| {
        let line = text.lines().find_map(|l| l.strip_prefix("MemTotal:"))?;
        let kilobytes = line.trim().strip_suffix("kB")?;
        kilobytes.trim().parse::<u64>().ok()?.checked_mul(1024)
    });
    let group = std::fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let group = group.and_then(|text| text.trim().parse::<u64>().ok());
    let memory = machine.into_iter().chain(group).min();
    memory.map_or(u64::MAX, |bytes| bytes / SHARE.1 * SHARE.0)
}

/// `1.5 GiB`.
fn size(bytes: u64) -> String {
    let mut value = bytes as f64;
    let mut units = ["bytes", "KiB", "MiB", "GiB", "TiB", "PiB"]
        .into_iter()
        .peekable();
    let mut unit = "bytes";
    while let Some(next) = units.next() {
        unit = next;
        if value < 1024.0 || units.peek().is_none() {
            break;
        }
        value /= 1024.0;
    }
    match unit {
        "bytes" => format!("{bytes} {unit}"),
        _ => format!("{value:.1} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_charged_is_gone_and_the_first_refusal_is_kept() {
        let budget = Budget::new(5000, 1000);
        let element = |name: &'static str| move || name.to_owned();
        assert_eq!(budget.charge(3000, element("a")), Ok(()));
        assert_eq!(budget.charge_many(4, 250, element("b")), Ok(()));
        assert_eq!((budget.used(), budget.refusal()), (5000, None));
        let cause = budget.charge(1 << 20, element("c")).unwrap_err();
        let words = "would take 1.0 MiB more memory, 4.9 KiB of 4.9 KiB are used; --memory-limit raises the limit";
        assert_eq!(cause, words);
        assert!(budget.charge(1, element("d")).is_err());
        assert_eq!(budget.refusal().unwrap().element, "c");
    }

    #[test]
    fn charges_beyond_all_numbers_are_refused() {
        let budget = Budget::new(u64::MAX, 1);
        let charge = |bytes| budget.charge(bytes, String::new);
        assert_eq!(charge(u64::MAX - 2), Ok(()));
        assert!(charge(2).is_err());
        assert!(
            Budget::new(10, 0)
                .charge_many(usize::MAX, 3, String::new)
                .is_err()
        );
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(
            [0, 1023, 1536, 3 << 30, u64::MAX].map(size),
            ["0 bytes", "1023 bytes", "1.5 KiB", "3.0 GiB", "16384.0 PiB"]
        );
    }

    #[test]
    fn the_machine_is_large_enough() {
        assert!(default_limit() > 64 << 20);
    }
}
