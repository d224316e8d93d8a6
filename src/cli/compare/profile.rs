//! How much is measured: `--quick`, the usual, `--thorough`, and what is given by number instead.

use clap::Args;

use crate::cli::values;

/// Arguments for how much is measured.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct ProfileArgs {
    /// Few rays: 640x360 pixels, 20000 rays of each kind
    #[arg(long, conflicts_with = "thorough")]
    quick: bool,
    /// Many rays, often: 1920x1080 pixels, 1000000 rays of each kind, 25 repetitions; takes minutes
    #[arg(long)]
    thorough: bool,
    /// Width and height of the view, in pixels [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    resolution: Option<(u32, u32)>,
    /// Most rays of each kind; of a view with more pixels, tiles are chosen by chance [default: 200000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=values::MOST_RAYS))]
    max_rays: Option<u32>,
    /// How often each structure is timed on the same rays; fewer than 6 tell no difference [default: 9]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: Option<u32>,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Profile {
    /// Width and height of the view, in pixels.
    pub(super) size: (u32, u32),
    /// Most rays of each kind.
    pub(super) rays: u32,
    /// How often each structure is timed. From nine on intervals cover what they say.
    pub(super) repetitions: u32,
}

const QUICK: Profile = Profile {
    size: (640, 360),
    rays: 20_000,
    repetitions: 9,
};

const USUAL: Profile = Profile {
    size: (1280, 720),
    rays: 200_000,
    repetitions: 9,
};

const THOROUGH: Profile = Profile {
    size: (1920, 1080),
    rays: 1_000_000,
    repetitions: 25,
};

impl Profile {
    /// Most rays that any kind can have: of a view, one a pixel.
    pub(super) fn most_rays(&self) -> usize {
        let pixels = u64::from(self.size.0) * u64::from(self.size.1);
        pixels.min(u64::from(self.rays)) as usize
    }
}

impl ProfileArgs {
    /// What is named by number wins.
    pub(super) fn profile(&self) -> Profile {
        let named = match (self.quick, self.thorough) {
            (true, _) => QUICK,
            (_, true) => THOROUGH,
            _ => USUAL,
        };
        Profile {
            size: self.resolution.unwrap_or(named.size),
            rays: self.max_rays.unwrap_or(named.rays),
            repetitions: self.repetitions.unwrap_or(named.repetitions),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_win_over_names() {
        let args = ProfileArgs {
            quick: true,
            thorough: false,
            resolution: None,
            max_rays: Some(7),
            repetitions: None,
        };
        assert_eq!(args.profile(), Profile { rays: 7, ..QUICK });
        assert_eq!(args.profile().most_rays(), 7);
        let usual = ProfileArgs {
            quick: false,
            max_rays: None,
            ..args
        };
        assert_eq!(usual.profile(), USUAL);
        let small = ProfileArgs {
            resolution: Some((12, 8)),
            ..usual
        };
        assert_eq!(small.profile().most_rays(), 96);
    }
}
