//! Files that are complete or not there: written under another name, then renamed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Error, ErrorKind, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Writes a file through `write`, so that `path` holds either all of the new content or what it held before.
///
/// The content goes to a new file in the same folder, to the disk, and then takes the place of `path`; after an error or a
/// panic the new file is removed. `write` gets the file empty, open for reading, writing and seeking. A new file has the
/// permissions that the user's umask gives; one that is replaced keeps its own. A link is followed. What is no
/// regular file (`/dev/stdout`, a pipe) gets the finished content copied.
///
/// # Errors
/// Those of `write`, and errors of the system: no such folder, a directory of that name, a file that is read-only, no space.
pub fn replace_file<E: From<Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<(), E>,
) -> Result<(), E> {
    let existing = match fs::metadata(path) {
        Ok(metadata) => Some(metadata),
        Err(e) if e.kind() == ErrorKind::NotFound => None,
        Err(e) => return Err(e.into()),
    };
    let target = match existing {
        Some(_) => fs::canonicalize(path)?,
        None => path.to_owned(),
    };
    if let Some(metadata) = &existing {
        if metadata.is_dir() {
            return Err(Error::new(ErrorKind::IsADirectory, "is a directory").into());
        }
        if !metadata.is_file() {
            let mut content = tempfile::tempfile()?;
            write(&mut content)?;
            content.seek(SeekFrom::Start(0))?;
            io::copy(
                &mut content,
                &mut OpenOptions::new().write(true).open(&target)?,
            )?;
            return Ok(());
        }
        if metadata.permissions().readonly() {
            return Err(Error::new(ErrorKind::PermissionDenied, "is read-only").into());
        }
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let words = "cannot be written: its folder does not exist";
        return Err(Error::new(ErrorKind::NotFound, words).into());
    }
    let mut temporary = Temporary::create(folder)?;
    write(&mut temporary.file)?;
    if let Some(metadata) = existing {
        temporary.file.set_permissions(metadata.permissions())?;
    }
    // Not for power cuts alone: network disks report a full quota only here.
    temporary.file.sync_all()?;
    temporary.rename(&target)?;
    Ok(())
}

/// A new file that is removed when it is dropped.
struct Temporary {
    file: File,
    /// `None` once the file has its final name.
    path: Option<PathBuf>,
}

impl Temporary {
    fn create(folder: &Path) -> io::Result<Self> {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        loop {
            // Short and without the target's name, which may be as long as names can be.
            let number = COUNTER.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!(".bspray-{}-{number}.tmp", std::process::id()));
            match OpenOptions::new()
                .read(true)
                .write(true)
                .create_new(true)
                .open(&path)
            {
                Ok(file) => {
                    return Ok(Self {
                        file,
                        path: Some(path),
                    });
                }
                // Left behind by a process that was killed and had our number.
                Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
    }

    fn rename(mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.path {
            fs::rename(path, target)?;
        }
        self.path = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            // The error that led here is the one to report.
            let _ = fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn put(path: &Path, text: &str) -> io::Result<()> {
        replace_file(path, |file| file.write_all(text.as_bytes()))
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_created_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        put(&path, "longer text").unwrap();
        put(&path, "short").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "short");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_or_panic_on_the_way_leaves_the_old_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        put(&path, "old").unwrap();
        let failed: io::Result<()> = replace_file(&path, |file| {
            file.write_all(b"half")?;
            Err(Error::other("stop"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "stop");
        let panicked = std::panic::catch_unwind(|| {
            let _: io::Result<()> = replace_file(&path, |_| std::panic::panic_any("stop"));
        });
        assert!(panicked.is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn directories_and_missing_folders_are_named_as_such() {
        let folder = tempfile::tempdir().unwrap();
        let error = put(folder.path(), "x").unwrap_err();
        assert_eq!(error.to_string(), "is a directory");
        let error = put(&folder.path().join("no/such.txt"), "x").unwrap_err();
        assert!(error.to_string().contains("folder does not exist"));
        let error = put(Path::new(""), "x").unwrap_err();
        assert!(!error.to_string().is_empty());
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    fn a_read_only_file_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        put(&path, "old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert_eq!(put(&path, "new").unwrap_err().to_string(), "is read-only");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_one_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let folder = tempfile::tempdir().unwrap();
        let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
        put(&ours, "x").unwrap();
        fs::write(&theirs, "x").unwrap();
        assert_eq!(mode(&ours), mode(&theirs));
        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        put(&ours, "y").unwrap();
        assert_eq!(mode(&ours), 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_devices_are_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        put(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        put(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        put(Path::new("/dev/null"), "gone").unwrap();
        let kind = fs::metadata("/dev/null").unwrap().file_type();
        assert!(kind.is_char_device());
    }
}
