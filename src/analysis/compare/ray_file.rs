//! Files of rays, so that the same rays can be asked of other programs, and theirs of these structures.
//!
//! All numbers are little-endian, and nothing stands between them:
//!
//! | bytes | what |
//! |---|---|
//! | 4 | `BRAY` |
//! | 4 | `u32`, 1: the version |
//! | 4 | `u32`, the number of rays |
//! | 4 | `u32`, what they are for: 0 eye, 1 shadow, 2 ambient occlusion, 3 bounce, 4 mirror, 5 refraction |
//! | 32 a ray | 8 `f32`: origin (x, y, z), direction (x, y, z), least and greatest `t`, in units of the direction's length |
//!
//! A ray without an end is written with the greatest `t` 1e30; one of 1e30 and more, or infinite, is read as one without an end. Shadow and ambient rays ask whether
//! anything is hit, the others for the nearest hit. A ray's pixel, which only screen extents look at, is not in a file.

use std::fs::File;
use std::io::{BufReader, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::analysis::view_rays::{RayPurpose, RaySet};
use crate::geometry::{Interval, Ray, RayOrigin};
use crate::picture::replace_file;
use glam::Vec3;

const MAGIC: [u8; 4] = *b"BRAY";
const VERSION: u32 = 1;

/// The greatest `t` of a ray without an end.
const ENDLESS: f32 = 1e30;

/// Most rays of a file: some gigabytes of rays and answers.
const MOST_RAYS: u32 = 1 << 24;

/// Why a file of rays cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum RayFileError {
    /// The system says so.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it says.
        cause: std::io::Error,
    },
    /// It is no file of rays, or one that ends too soon.
    #[error("{}: {cause}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// A ray that cannot be traced.
    #[error("{}: ray {index}: {cause}", path.display())]
    Ray {
        /// The file.
        path: PathBuf,
        /// Its number, counted from 0.
        index: u32,
        /// What is wrong.
        cause: &'static str,
    },
}

/// Reads a file of rays. Memory grows with what is read, not with what the file claims.
///
/// # Errors
/// What the system says; a file of another kind, version or length; the first ray that cannot be traced.
pub fn read_rays(path: &Path) -> Result<RaySet, RayFileError> {
    let io = |cause| RayFileError::Io {
        path: path.to_owned(),
        cause,
    };
    let malformed = |cause: String| RayFileError::Malformed {
        path: path.to_owned(),
        cause,
    };
    if path.is_dir() {
        return Err(malformed("is a directory".to_owned()));
    }
    let mut file = BufReader::new(File::open(path).map_err(io)?);
    let mut header = [0; 16];
    match file.read_exact(&mut header) {
        Err(e) if e.kind() == ErrorKind::UnexpectedEof => {
            let words = "is no file of rays: it has not even the 16 bytes of a header";
            return Err(malformed(words.to_owned()));
        }
        other => other.map_err(io)?,
    }
    if header[..4] != MAGIC {
        let words = "is no file of rays: it does not begin with BRAY";
        return Err(malformed(words.to_owned()));
    }
    let [version, count, code] = [4, 8, 12]
        .map(|at| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]));
    if version != VERSION {
        return Err(malformed(format!(
            "version {version} of the format is not known, only {VERSION}"
        )));
    }
    let purpose = purpose_of(code).ok_or_else(|| {
        malformed(format!(
            "rays of kind {code} are not known, only 0 to 5 (see `bspray compare --help`)"
        ))
    })?;
    if count > MOST_RAYS {
        return Err(malformed(format!(
            "{count} rays are more than the {MOST_RAYS} of a file"
        )));
    }
    let mut rays = Vec::new();
    for index in 0..count {
        let mut bytes = [0; 32];
        match file.read_exact(&mut bytes) {
            Err(e) if e.kind() == ErrorKind::UnexpectedEof => {
                return Err(malformed(format!(
                    "ends within ray {index} of the {count} that its header claims"
                )));
            }
            other => other.map_err(io)?,
        }
        let ray = ray_of(&bytes, purpose);
        rays.push(ray.map_err(|cause| RayFileError::Ray {
            path: path.to_owned(),
            index,
            cause,
        })?);
    }
    if file.read(&mut [0]).map_err(io)? > 0 {
        return Err(malformed(format!(
            "goes on behind the {count} rays that its header claims"
        )));
    }
    Ok(RaySet { purpose, rays })
}

/// Writes a file of rays; it is complete or not there.
///
/// # Errors
/// What the system says.
pub fn write_rays(path: &Path, set: &RaySet) -> Result<(), RayFileError> {
    let count = set.rays.len() as u32;
    let write = |file: &mut File| {
        let mut out = BufWriter::new(file);
        out.write_all(&MAGIC)?;
        for number in [VERSION, count, code_of(set.purpose)] {
            out.write_all(&number.to_le_bytes())?;
        }
        for ray in &set.rays {
            let [ox, oy, oz] = ray.origin.to_array();
            let [dx, dy, dz] = ray.direction.to_array();
            let Interval { min, max } = ray.interval;
            for number in [ox, oy, oz, dx, dy, dz, min, max.min(ENDLESS)] {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        out.flush()
    };
    replace_file(path, write).map_err(|cause| RayFileError::Io {
        path: path.to_owned(),
        cause,
    })
}

fn ray_of(bytes: &[u8; 32], purpose: RayPurpose) -> Result<Ray, &'static str> {
    let number = |i: usize| {
        let at = 4 * i;
        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    };
    let [origin, direction] = [0, 3].map(|i| Vec3::new(number(i), number(i + 1), number(i + 2)));
    let (min, max) = (number(6), number(7));
    if !origin.is_finite() {
        return Err("its origin is not finite");
    }
    if !direction.is_finite() {
        return Err("its direction is not finite");
    }
    if direction == Vec3::ZERO {
        return Err("its direction is zero");
    }
    if !min.is_finite() || max.is_nan() {
        return Err("its interval is not a range of numbers");
    }
    let max = if max >= ENDLESS { f32::INFINITY } else { max };
    if min > max {
        return Err("its interval is empty");
    }
    let source = RayOrigin {
        depth: u32::from(purpose != RayPurpose::Eye),
        pixel: None,
    };
    Ok(Ray {
        interval: Interval::new(min, max),
        source,
        ..Ray::new(origin, direction)
    })
}

const fn code_of(purpose: RayPurpose) -> u32 {
    match purpose {
        RayPurpose::Eye => 0,
        RayPurpose::Shadow => 1,
        RayPurpose::Ambient => 2,
        RayPurpose::Bounce => 3,
        RayPurpose::Mirror => 4,
        RayPurpose::Refraction => 5,
    }
}

fn purpose_of(code: u32) -> Option<RayPurpose> {
    RayPurpose::ALL.into_iter().find(|&p| code_of(p) == code)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three(purpose: RayPurpose) -> RaySet {
        let source = RayOrigin {
            depth: u32::from(purpose != RayPurpose::Eye),
            pixel: None,
        };
        let ray = |x: f32, max| Ray {
            source,
            ..Ray::new(Vec3::new(x, 2.0, -0.0), Vec3::new(1.0, x, 3.0))
                .within(Interval::new(0.25, max))
        };
        RaySet {
            purpose,
            rays: vec![ray(0.1, 7.0), ray(1e-42, f32::INFINITY), ray(-3.0, 0.25)],
        }
    }

    /// The bytes of a good file.
    fn bytes() -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("good.ray");
        write_rays(&path, &three(RayPurpose::Mirror)).unwrap();
        std::fs::read(path).unwrap()
    }

    fn read(bytes: &[u8]) -> Result<RaySet, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.ray");
        std::fs::write(&path, bytes).unwrap();
        read_rays(&path).map_err(|error| {
            let error = error.to_string();
            error.split_once("x.ray: ").unwrap().1.to_owned()
        })
    }

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ray");
        for purpose in RayPurpose::ALL {
            let set = three(purpose);
            write_rays(&path, &set).unwrap();
            assert_eq!(std::fs::metadata(&path).unwrap().len(), 16 + 3 * 32);
            let read = read_rays(&path).unwrap();
            assert_eq!((read.purpose, &read.rays), (purpose, &set.rays));
        }
    }

    #[test]
    fn a_file_is_laid_out_as_it_is_documented() {
        let bytes = bytes();
        assert_eq!(bytes[..4], *b"BRAY");
        assert_eq!(bytes[4..16], [1, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0]);
        assert_eq!(bytes[16..20], 0.1_f32.to_le_bytes());
        assert_eq!(bytes[16 + 28..16 + 32], 7.0_f32.to_le_bytes());
        assert_eq!(bytes[16 + 60..16 + 64], 1e30_f32.to_le_bytes());
    }

    #[test]
    fn infinite_ends_are_read_as_such() {
        let mut bytes = bytes();
        for end in [f32::INFINITY, 1e30, 2e30] {
            bytes[44..48].copy_from_slice(&end.to_le_bytes());
            assert_eq!(read(&bytes).unwrap().rays[0].interval.max, f32::INFINITY);
        }
    }

    #[test]
    fn what_is_wrong_is_said_in_a_line() {
        let good = bytes();
        let put = |at: usize, bytes: &[u8]| {
            let mut bad = good.clone();
            bad[at..at + bytes.len()].copy_from_slice(bytes);
            read(&bad).unwrap_err()
        };
        let float = |at: usize, x: f32| put(at, &x.to_le_bytes());
        assert!(read(b"").unwrap_err().contains("16 bytes"));
        assert!(put(0, b"BTRI").contains("begin with BRAY"));
        assert!(put(4, &[2]).contains("version 2"));
        assert!(put(12, &[9]).contains("kind 9"));
        // What a header claims is believed only as far as there are bytes.
        assert!(put(8, &[255, 255, 255]).contains("ends within ray 3 of the 16777215"));
        assert!(put(8, &[255; 4]).contains("4294967295 rays are more than"));
        assert!(put(8, &[2]).contains("goes on behind the 2 rays"));
        assert!(
            read(&good[..good.len() - 1])
                .unwrap_err()
                .contains("within ray 2")
        );
        assert_eq!(float(48, f32::NAN), "ray 1: its origin is not finite");
        assert_eq!(
            float(48 + 12, f32::INFINITY),
            "ray 1: its direction is not finite"
        );
        assert_eq!(put(28, &[0; 12]), "ray 0: its direction is zero");
        assert_eq!(float(16 + 28, 0.2), "ray 0: its interval is empty");
        let words = "ray 0: its interval is not a range of numbers";
        assert_eq!(float(16 + 28, f32::NAN), words);
        assert_eq!(float(16 + 24, f32::NEG_INFINITY), words);
    }

    #[test]
    fn random_bytes_never_panic() {
        use crate::analysis::random::Random;
        let good = bytes();
        for case in 0..300 {
            let mut random = Random::new(5, "rays", case);
            let mut bad = good.clone();
            for _ in 0..3 {
                let at = random.below(bad.len());
                bad[at] = random.below(256) as u8;
            }
            bad.truncate(random.below(bad.len() + 1));
            if let Ok(set) = read(&bad) {
                assert!(set.rays.iter().all(Ray::is_traceable));
            }
        }
    }
}
