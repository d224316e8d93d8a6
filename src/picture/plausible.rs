//! Whether a header's sizes can be true, before any memory is asked for them.

use super::Window;

/// Bytes of a block that are allowed in any file: tiles may be larger than the picture.
const ANY_BLOCK: u128 = 64 << 20;

/// How much larger than all parts together their common window may be.
const SPREAD: u128 = 16;

/// What a header says of one part of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartSize {
    /// The pixels that it holds.
    pub window: Window,
    /// Width and height of a block in pixels.
    pub block: (u64, u64),
    /// How many channels it has.
    pub channels: u64,
    /// Bytes of a pixel's channels together.
    pub bytes_per_pixel: u64,
    /// Most bytes that a byte of the file can be unpacked to.
    pub packing: u64,
}

/// The window around all parts; `None` where a file of `file_length` bytes cannot fill it.
pub(super) fn common_window(parts: &[PartSize], file_length: u64) -> Option<Window> {
    let mut common: Option<Window> = None;
    let mut sum_of_parts = 0;
    for part in parts {
        let limit = u128::from(file_length) * u128::from(part.packing);
        let bytes = |pixels: u128| pixels.saturating_mul(u128::from(part.bytes_per_pixel));
        let in_part = bytes(u128::from(part.window.pixels()));
        let in_block = bytes(u128::from(part.block.0) * u128::from(part.block.1));
        if in_part > limit || in_block > limit.max(ANY_BLOCK) {
            return None;
        }
        sum_of_parts += in_part;
        common = Some(common.map_or(part.window, |window| enclosing(window, part.window)));
    }
    let common = common?;
    let spread: u128 = parts
        .iter()
        .map(|part| u128::from(common.pixels()) * u128::from(part.bytes_per_pixel))
        .sum();
    (spread <= sum_of_parts * SPREAD).then_some(common)
}

fn enclosing(a: Window, b: Window) -> Window {
    let (x, width) = enclosing_range((a.x, a.width), (b.x, b.width));
    let (y, height) = enclosing_range((a.y, a.height), (b.y, b.height));
    Window {
        x,
        y,
        width,
        height,
    }
}

fn enclosing_range(a: (i32, u32), b: (i32, u32)) -> (i32, u32) {
    let end = |(start, length): (i32, u32)| i64::from(start) + i64::from(length);
    let start = a.0.min(b.0);
    let length = end(a).max(end(b)) - i64::from(start);
    (start, u32::try_from(length).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(x: i32, y: i32, width: u32, height: u32) -> PartSize {
        PartSize {
            window: Window {
                x,
                y,
                width,
                height,
            },
            block: (u64::from(width), 16),
            channels: 3,
            bytes_per_pixel: 6,
            packing: 1000,
        }
    }

    #[test]
    fn the_common_window_encloses_all_parts() {
        let parts = [part(-5, 2, 10, 3), part(3, 1, 4, 2)];
        let expected = Window {
            x: -5,
            y: 1,
            width: 12,
            height: 4,
        };
        assert_eq!(common_window(&parts, 1000), Some(expected));
    }

    #[test]
    fn sizes_out_of_proportion_are_refused() {
        assert!(common_window(&[part(0, 0, 1000, 1000)], 6000).is_some());
        assert!(common_window(&[part(0, 0, 1000, 1001)], 6000).is_none());
        assert!(common_window(&[part(0, 0, u32::MAX, u32::MAX)], u64::MAX).is_some());
        let huge_tile = PartSize {
            block: (1 << 31, 1 << 31),
            ..part(0, 0, 1, 1)
        };
        assert!(common_window(&[huge_tile], 1000).is_none());
        let far = [part(-1_000_000, 0, 9, 9), part(1_000_000, 0, 9, 9)];
        assert!(common_window(&far, 1 << 20).is_none());
        assert!(common_window(&[], 1000).is_none());
    }
}
