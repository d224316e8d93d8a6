//! A film as the picture of its layers, with its camera's matrices: what an EXR file holds of every render.

use glam::{DMat4, DVec4};

use super::aov::{LAYERS, Layer, PARTITION_LAYERS};
use super::film::Film;
use crate::picture::{Attribute, Channel, Picture, Window, attribute};
use crate::scene::CameraFrame;

/// The film as a picture of all [`LAYERS`], and of [`PARTITION_LAYERS`] if it has them, its data window the part that was rendered, with the camera's matrices.
pub fn layers(film: &Film, camera: &CameraFrame) -> Picture {
    let window = film.window;
    let (width, height) = film.size;
    let mut picture = Picture::new(width, height).with_window(Window {
        x: window.x as i32,
        y: window.y as i32,
        width: window.width,
        height: window.height,
    });
    let further = if film.has_fragments {
        PARTITION_LAYERS
    } else {
        &[]
    };
    let all = LAYERS.iter().chain(further);
    for (name, value) in all.flat_map(|layer| layer.channels) {
        picture = picture.with_channel(Channel::new(*name, value.of(film)));
    }
    let [to_camera, to_ndc] = matrices(camera).map(|m| Attribute::M44(m.as_mat4().to_cols_array()));
    let picture = picture.with_attribute(attribute::WORLD_TO_CAMERA, to_camera);
    if camera.has_screen() {
        picture.with_attribute(attribute::WORLD_TO_NDC, to_ndc)
    } else {
        picture
    }
}

/// A film's layers without those that tell of single triangles ([`Layer::is_of_triangles`]), for scenes whose meshes were simplified.
pub fn without_triangles(mut picture: Picture) -> Picture {
    let told = LAYERS.iter().chain(PARTITION_LAYERS);
    let told = told.filter(|layer| layer.is_of_triangles);
    let names: Vec<&str> = told.flat_map(Layer::channels).collect();
    picture
        .channels
        .retain(|c| !names.contains(&c.name.as_str()));
    picture
}

/// World space to OpenEXR's camera space (x right, y up, z forward), and on to x and y from -1 to 1 over the picture.
fn matrices(camera: &CameraFrame) -> [DMat4; 2] {
    let [right, up, back, eye] = camera.world_from_camera();
    let row = |axis: glam::DVec3| axis.extend(-axis.dot(eye));
    let to_camera = DMat4::from_cols(row(right), row(up), row(-back), DVec4::W).transpose();
    let (half_width, half_height) = camera.half_size();
    // Depth is kept as it is: in the perspective case divided by itself, which leaves 1.
    let last = if camera.is_perspective() {
        DVec4::Z
    } else {
        DVec4::W
    };
    let project = DMat4::from_cols(
        DVec4::X / half_width,
        DVec4::Y / half_height,
        DVec4::Z,
        last,
    )
    .transpose();
    [to_camera, project * to_camera]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Samples;
    use crate::render::aov::NOTHING;
    use crate::render::film::PixelRect;
    use crate::scene::{Camera, Projection};
    use glam::{DVec3, Vec3};

    fn camera(projection: Projection) -> CameraFrame {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            focal_point: Vec3::new(4.0, 3.0, 1.0),
            view_up: Vec3::Y,
            projection,
        };
        camera.frame(320, 200).expect("valid")
    }

    #[test]
    fn matrices_take_points_on_a_ray_to_its_pixel() {
        for projection in [
            Projection::Perspective { view_angle: 40.0 },
            Projection::Orthographic { height: 3.0 },
        ] {
            let frame = camera(projection);
            let ray = frame.ray(80.0, 150.0, None);
            let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * 7.0;
            let [to_camera, to_ndc] = matrices(&frame);
            let ndc = to_ndc * point.extend(1.0);
            assert!(
                (ndc.x / ndc.w + 0.5).abs() < 1e-6 && (ndc.y / ndc.w + 0.5).abs() < 1e-6,
                "{ndc}"
            );
            let depth = to_camera.transform_point3(point).z;
            assert!((depth - f64::from(frame.depth(point.as_vec3()))).abs() < 1e-5);
            assert!(
                to_camera
                    .transform_point3(DVec3::new(1.0, 2.0, 3.0))
                    .length()
                    < 1e-12
            );
        }
    }

    #[test]
    fn channel_names_are_unique_and_a_crop_keeps_its_place() {
        let count = LAYERS.iter().flat_map(Layer::channels).count();
        let all = LAYERS.iter().chain(PARTITION_LAYERS);
        let mut names: Vec<_> = all.flat_map(Layer::channels).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|n| n[0] != n[1]));
        let mut film = Film::new(
            (320, 200),
            PixelRect {
                x: 30,
                y: 20,
                width: 5,
                height: 4,
            },
        );
        let picture = layers(&film, &camera(Projection::Perspective { view_angle: 40.0 }));
        assert_eq!(picture.channels.len(), count);
        assert_eq!(
            (picture.display, picture.window.x, picture.window.height),
            ((320, 200), 30, 4)
        );
        assert_eq!(
            picture.channel("id"),
            Some(&Samples::U32(vec![NOTHING; 20]))
        );
        film.has_fragments = true;
        let picture = layers(&film, &camera(Projection::Perspective { view_angle: 40.0 }));
        assert_eq!(picture.channels.len(), names.len());
    }
}
