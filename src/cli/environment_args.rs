//! Arguments that choose the light from infinitely far.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, anyhow};
use bspray::picture::{mend_texels, read_image, srgb};
use bspray::render::{Daylight, Environment, SkyMode};
use clap::{Args, ValueEnum};
use glam::Vec3;

use super::{output, values};

/// The light from infinitely far. Without any of these the models' own light counts, or else a sky.
#[derive(Args, Debug)]
#[command(next_help_heading = "Environment")]
pub(super) struct EnvironmentArgs {
    /// Which sky lights the scene; `auto`: the studio's, if the models have no light of their own, or a sun but no sky
    #[arg(long, value_enum, value_name = "WHICH", default_value_t = SkyName::Auto)]
    sky: SkyName,
    /// Light the scene by an equirectangular picture (.exr, .hdr; others are taken as sRGB). Its middle shows what lies at +X, three quarters of its width +Z (-Y with --up +Z)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["sky", "background_color"])]
    hdri_file: Option<PathBuf>,
    /// Turn that picture about the upward axis, in degrees, counter-clockwise as seen from above
    #[arg(long, value_name = "DEGREES", value_parser = values::finite, allow_hyphen_values = true, default_value_t = 0.0,
        requires = "hdri_file")]
    hdri_rotation: f32,
    /// Multiply the light of that picture
    #[arg(long, value_name = "FACTOR", value_parser = values::positive, default_value_t = 1.0, requires = "hdri_file")]
    hdri_strength: f32,
    /// Light the scene evenly from all sides: linear radiance, or an sRGB colour
    #[arg(long, value_name = "R,G,B|#RRGGBB", value_parser = color, conflicts_with = "sky")]
    background_color: Option<Vec3>,
    /// Leave the picture transparent (in .jpg black) behind all surfaces; what lights them stays
    #[arg(long)]
    no_background: bool,
    /// Where the sun of the physical sky stands, as a direction from the scene to it; implies --sky physical
    #[arg(long, value_name = "X,Y,Z", value_parser = values::direction, allow_hyphen_values = true,
        conflicts_with_all = ["sun_elevation", "hdri_file", "background_color"])]
    sun_direction: Option<Vec3>,
    /// Height of that sun over the horizon, in degrees, -18 to 90; implies --sky physical
    #[arg(long, value_name = "DEGREES", value_parser = elevation, allow_hyphen_values = true,
        conflicts_with_all = ["hdri_file", "background_color"])]
    sun_elevation: Option<f32>,
    /// Haze of the physical sky: 1 for the purest air, 2 for a very clear day, 10 for haze [default: 2.5]; implies --sky physical
    #[arg(long, value_name = "RATIO", value_parser = turbidity, conflicts_with_all = ["hdri_file", "background_color"])]
    turbidity: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SkyName {
    Auto,
    /// The studio's: a soft gradient, and a sun with soft shadows
    On,
    /// The sky and sun of a clear day, by what air and haze scatter
    Physical,
    /// None
    Off,
}

impl EnvironmentArgs {
    /// When our own sky lights the scene.
    pub(super) fn sky_mode(&self) -> SkyMode {
        match self.sky {
            SkyName::Auto => SkyMode::Auto,
            SkyName::On | SkyName::Physical => SkyMode::On,
            SkyName::Off => SkyMode::Off,
        }
    }

    /// Whether there is nothing behind all surfaces.
    pub(super) fn is_transparent(&self) -> bool {
        self.no_background
    }

    /// The picture's file, if the light is one.
    pub(super) fn file(&self) -> Option<&Path> {
        self.hdri_file.as_deref()
    }

    /// The light that takes the place of our own sky, under the upward axis `up`.
    ///
    /// # Errors
    /// The picture cannot be read.
    pub(super) fn environment(&self, up: Vec3) -> anyhow::Result<Option<Arc<Environment>>> {
        if let Some(path) = self.file() {
            return self.picture(path, up).map(|e| Some(Arc::new(e)));
        }
        if let Some(color) = self.background_color {
            return Ok(Some(Arc::new(Environment::constant(color))));
        }
        let has_wishes = self.sun_direction.is_some()
            || self.sun_elevation.is_some()
            || self.turbidity.is_some();
        if self.sky != SkyName::Physical && !has_wishes {
            return Ok(None);
        }
        let mut daylight = Daylight::default();
        if let Some(direction) = self.sun_direction {
            daylight = daylight.with_sun(direction, up);
        }
        if let Some(elevation) = self.sun_elevation {
            daylight.elevation = f64::from(elevation);
        }
        if let Some(turbidity) = self.turbidity {
            daylight.turbidity = f64::from(turbidity);
        }
        Ok(Some(Arc::new(Environment::daylight(&daylight, up))))
    }

    fn picture(&self, path: &Path, up: Vec3) -> anyhow::Result<Environment> {
        let bytes = std::fs::read(path).with_context(|| format!("{}", path.display()))?;
        let mut image = read_image(&path.to_string_lossy(), &bytes)?;
        let mended = mend_texels(&mut image);
        if mended > 0 {
            let path = path.display();
            output::message(&format!(
                "{path}: {mended} texels are negative, infinite or no numbers: mended"
            ));
        }
        let rotation = f64::from(self.hdri_rotation);
        Environment::image(image, up, rotation, self.hdri_strength)
            .ok_or_else(|| anyhow!("{}: has no pixels", path.display()))
    }
}

/// `R,G,B`, linear, or `#RRGGBB`, sRGB.
fn color(text: &str) -> Result<Vec3, String> {
    let form = "want R,G,B of 0 or more, linear, or #RRGGBB";
    if let Some(digits) = text.strip_prefix('#') {
        let code = u32::from_str_radix(digits, 16).ok();
        let code = code.filter(|_| digits.len() == 6 && !digits.starts_with('+'));
        let [_, r, g, b] = code.ok_or(form)?.to_be_bytes();
        return Ok(Vec3::from_array(
            [r, g, b].map(|c| srgb::LINEAR_OF_U8[usize::from(c)]),
        ));
    }
    let color = values::vector(text).map_err(|_| form.to_owned())?;
    if color.min_element() < 0.0 {
        return Err(form.to_owned());
    }
    Ok(color)
}

fn elevation(text: &str) -> Result<f32, String> {
    within(text, -18.0, 90.0)
}

fn turbidity(text: &str) -> Result<f32, String> {
    within(text, 1.0, 20.0)
}

fn within(text: &str, least: f32, most: f32) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("want a number from {least} to {most}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_linear_numbers_or_srgb_codes() {
        assert_eq!(color("0.5,2,0"), Ok(Vec3::new(0.5, 2.0, 0.0)));
        let found = color("#ff8000").expect("a colour");
        assert!((found - Vec3::new(1.0, 0.2158605, 0.0)).abs().max_element() < 1e-6);
        for bad in [
            "", "#ff", "#gg0000", "#+f0000", "1,2", "-1,0,0", "red", "nan,0,0",
        ] {
            assert!(color(bad).is_err(), "{bad}");
        }
    }
}
