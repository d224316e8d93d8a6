//! A film as people see it: exposure, tone map, overlay, and codes for PNG and JPEG.

use bspray::picture::{Raster, RasterPixels, ToneMap, exposure_factor, srgb};
use bspray::render::{Film, Integrator, Overlay};
use clap::Args;
use glam::Vec3;

use super::values;

/// How radiance becomes display light.
#[derive(Args, Debug)]
#[command(next_help_heading = "Display")]
pub(super) struct DisplayArgs {
    /// From radiance to display light, for PNG and JPEG: pbr-neutral, aces, reinhard or clip [default: pbr-neutral, and
    /// clip for the integrators that do not compute light]
    #[arg(long, value_name = "NAME")]
    tonemap: Option<ToneMap>,
    /// Exposure of PNG and JPEG in stops (EV), each of which doubles the light
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = 0.0,
        value_parser = values::finite,
        allow_hyphen_values = true
    )]
    exposure: f32,
}

impl DisplayArgs {
    /// What light is multiplied by.
    pub(super) fn exposure_factor(&self) -> f32 {
        exposure_factor(self.exposure)
    }

    fn tonemap_of(&self, integrator: Integrator) -> ToneMap {
        self.tonemap.unwrap_or(if integrator.computes_light() {
            ToneMap::PbrNeutral
        } else {
            ToneMap::Clip
        })
    }

    /// The surfaces of the film alone, with their coverage as alpha, and with other colours where it was denoised.
    pub(super) fn cut_out(
        &self,
        film: &Film,
        denoised: Option<&[Vec3]>,
        integrator: Integrator,
    ) -> Raster {
        let tonemap = self.tonemap_of(integrator);
        let factor = self.exposure_factor();
        let means = film.map(|pixel| {
            let mean = pixel.sum.mean();
            (mean.color, mean.alpha)
        });
        let color = |(index, (color, alpha)): (usize, &(Vec3, f32))| {
            let color = denoised.map_or(*color, |denoised| denoised[index]);
            // PNG's colours are not multiplied by alpha.
            let color = color * (factor / alpha.max(f32::MIN_POSITIVE));
            let [r, g, b] = match matches!(integrator, Integrator::Normals) {
                // Codes as they are, not light.
                true => color.to_array().map(srgb::decode),
                false => tonemap.apply(color.to_array()),
            };
            [r, g, b, *alpha]
        };
        let pixels: Vec<_> = means.iter().enumerate().map(color).collect();
        Raster::from_rgba(film.window.width, film.window.height, &pixels)
    }

    /// The film as people see it, with other colours of surfaces where it was denoised. Normals are numbers, not light, and are stored as they are.
    pub(super) fn raster(
        &self,
        film: &Film,
        denoised: Option<&[Vec3]>,
        integrator: Integrator,
        overlay: Option<&Overlay>,
    ) -> Raster {
        let tonemap = self.tonemap_of(integrator);
        let factor = self.exposure_factor();
        let mut pixels: Vec<_> = light(film, denoised)
            .into_iter()
            .map(|light| tonemap.apply((light * factor).to_array()))
            .collect();
        let (width, height) = (film.window.width, film.window.height);
        if !matches!(integrator, Integrator::Normals) {
            if let Some(overlay) = overlay {
                overlay.lay_over(&mut pixels);
            }
            return Raster::from_rgb(width, height, &pixels);
        }
        let mut codes: Vec<_> = pixels.iter().map(|c| c.map(srgb::unit_to_u8)).collect();
        if let Some(overlay) = overlay {
            // The codes are shown as light, and an overlay lies over light.
            let mut light: Vec<_> = codes
                .iter()
                .map(|c| c.map(|code| srgb::LINEAR_OF_U8[usize::from(code)]))
                .collect();
            overlay.lay_over(&mut light);
            codes = light.iter().map(|c| c.map(srgb::u8_of_linear)).collect();
        }
        Raster {
            width,
            height,
            pixels: RasterPixels::Rgb(codes),
        }
    }
}

/// Linear radiance of surfaces, which are the film's or those given, and of what is behind them.
pub(super) fn light(film: &Film, denoised: Option<&[Vec3]>) -> Vec<Vec3> {
    let mut light = film.map(|pixel| {
        let mean = pixel.sum.mean();
        match denoised {
            Some(_) => mean.backdrop,
            None => mean.color + mean.backdrop,
        }
    });
    for (light, color) in light.iter_mut().zip(denoised.unwrap_or_default()) {
        *light += *color;
    }
    light
}
