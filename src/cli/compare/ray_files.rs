//! Rays that users bring, and rays that they take away.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use bspray::accel::Domain;
use bspray::analysis::{Comparison, NamedRays, RaySet, read_rays, write_rays};
use bspray::scene::Scene;

/// The rays of the files, each under the file's name in lower-case letters, digits and hyphens.
pub(super) fn read(paths: &[PathBuf]) -> anyhow::Result<Vec<NamedRays>> {
    let mut all: Vec<NamedRays> = Vec::new();
    for path in paths {
        let set = read_rays(path)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let base = plain(&stem);
        let is_free = |name: &str| all.iter().all(|other| other.name != name);
        let name = std::iter::once(base.clone())
            .chain((2..).map(|n| format!("{base}-{n}")))
            .find(|name| is_free(name));
        all.push(NamedRays {
            name: name.unwrap_or(base),
            set,
        });
    }
    Ok(all)
}

/// Refuses rays about which structures promise nothing in this scene, such as those that leave the range of `f32` on their way to an object.
pub(super) fn check(paths: &[PathBuf], rays: &[NamedRays], scene: &Scene) -> anyhow::Result<()> {
    // Of a scene that is outside of the domain itself nothing more can be said.
    let Ok(domain) = Domain::of(scene) else {
        return Ok(());
    };
    for (path, named) in paths.iter().zip(rays) {
        for (index, ray) in named.set.rays.iter().enumerate() {
            if let Err(reason) = domain.check(ray) {
                bail!("{}: ray {index}: {reason}", path.display());
            }
        }
    }
    Ok(())
}

/// Writes every set into the folder, which is made if need be, as `NAME.ray`.
pub(super) fn write(folder: &Path, rays: &[NamedRays]) -> anyhow::Result<()> {
    let made = std::fs::create_dir_all(folder);
    made.with_context(|| folder.display().to_string())?;
    for named in rays {
        write_rays(&folder.join(format!("{}.ray", named.name)), &named.set)?;
    }
    Ok(())
}

/// The wrong rays of every method and set that has some: the stem of their file, and the rays.
pub(super) fn wrong(comparison: &Comparison) -> Vec<NamedRays> {
    let mut files = Vec::new();
    for set in &comparison.sets {
        for (m, method) in comparison.methods.iter().enumerate() {
            let wrong = set.wrong.iter().filter(|w| w.faults[m].is_some());
            let rays: Vec<_> = wrong.map(|w| w.ray).collect();
            if !rays.is_empty() {
                files.push(NamedRays {
                    name: format!("wrong-{}-{}", method.contestant.name, set.name),
                    set: RaySet {
                        purpose: set.purpose,
                        rays,
                    },
                });
            }
        }
    }
    files
}

/// In lower-case letters, digits and hyphens.
fn plain(text: &str) -> String {
    let replaced = text.chars().map(|c| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    });
    let name: String = replaced.collect();
    if name.is_empty() {
        "rays".to_owned()
    } else {
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bspray::analysis::RayPurpose;
    use bspray::geometry::Ray;
    use glam::Vec3;

    #[test]
    fn files_of_one_name_stay_apart() {
        let folder = tempfile::tempdir().unwrap();
        let set = RaySet {
            purpose: RayPurpose::Bounce,
            rays: vec![Ray::new(Vec3::ZERO, Vec3::X)],
        };
        let paths: Vec<_> = ["a/My rays.ray", "b/my-rays.ray", "b/other.bin"]
            .map(|name| folder.path().join(name))
            .to_vec();
        for path in &paths {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            write_rays(path, &set).unwrap();
        }
        let names: Vec<_> = read(&paths).unwrap().into_iter().map(|r| r.name).collect();
        assert_eq!(names, ["my-rays", "my-rays-2", "other"]);
    }
}
