//! The foreign library behind safe functions: loaded at run time, its functions declared, its handles owned. The only file of this folder with `unsafe` code.
//!
//! The declarations are those of Embree 4's headers; C's enumerations and `ssize_t` are `c_int` and `isize`. No call here changes how this thread rounds or
//! treats denormals: Embree sets its own mode while it builds and takes it back.

use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::error::EmbreeError;
use super::layout::{
    CULLS_BACK_FACES, ForeignRay, ForeignRayHit, INDICES, NO_GEOMETRY, ROBUST, THREE_FLOATS,
    THREE_UINTS, TRIANGLES, VERSION_PARTS, VERTICES, error_words,
};

/// A device, a scene or a geometry.
type Handle = *mut c_void;

/// Told of bytes that were allocated (positive) or are free again; `false` would cancel what is under way.
type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Declares the functions that are used, and how each is found by its name.
macro_rules! functions {
    ($($field:ident = $name:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        struct Functions {
            $($field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            /// # Safety
            /// Functions of these names have the types that Embree 4 declares.
            unsafe fn of(library: &libloading::Library, path: &Path) -> Result<Self, EmbreeError> {
                let lacks = |function| EmbreeError::NotEmbree {
                    path: path.to_owned(),
                    function,
                };
                Ok(Self {
                    $(
                        // SAFETY: the caller's promise.
                        $field: *unsafe { library.get($name) }.map_err(|_| lacks($name))?,
                    )*
                })
            }
        }
    };
}

functions! {
    new_device = "rtcNewDevice": fn(*const c_char) -> Handle;
    release_device = "rtcReleaseDevice": fn(Handle);
    device_error = "rtcGetDeviceError": fn(Handle) -> c_int;
    device_property = "rtcGetDeviceProperty": fn(Handle, c_int) -> isize;
    monitor_memory = "rtcSetDeviceMemoryMonitorFunction": fn(Handle, MemoryMonitor, *mut c_void);
    new_scene = "rtcNewScene": fn(Handle) -> Handle;
    release_scene = "rtcReleaseScene": fn(Handle);
    scene_flags = "rtcSetSceneFlags": fn(Handle, c_int);
    commit_scene = "rtcCommitScene": fn(Handle);
    new_geometry = "rtcNewGeometry": fn(Handle, c_int) -> Handle;
    release_geometry = "rtcReleaseGeometry": fn(Handle);
    new_buffer = "rtcSetNewGeometryBuffer": fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
    commit_geometry = "rtcCommitGeometry": fn(Handle);
    attach_geometry = "rtcAttachGeometryByID": fn(Handle, Handle, c_uint);
    intersect = "rtcIntersect1": fn(Handle, *mut ForeignRayHit, *mut c_void);
    occluded = "rtcOccluded1": fn(Handle, *mut ForeignRay, *mut c_void);
}

/// What a device has allocated, in bytes.
#[derive(Default)]
struct Memory {
    /// And not freed.
    bytes: AtomicI64,
    /// The most that it was since somebody looked.
    peak: AtomicI64,
}

/// The library with a device of its own, which every scene keeps alive.
pub(super) struct Device {
    functions: Functions,
    handle: Handle,
    version: String,
    /// Boxed, since the library has its address.
    memory: Box<Memory>,
    /// Held while a scene is built or released, so that what it allocates is told from what others do.
    changing: Mutex<()>,
}

// SAFETY: a device belongs to no thread, as Embree's manual has it: what it forbids is to change one object from two threads, and the device itself is not
// changed after `load`. Its list of errors is one a thread, its memory is counted by an atomic.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    /// Loads the library, which stays loaded until the program ends, and makes a device with so many threads for building; 0 for one a core.
    pub(super) fn load(path: &Path, threads: usize) -> Result<Self, EmbreeError> {
        // The system looks for a bare name elsewhere, and for the library's own libraries beside the file itself.
        let file = path.canonicalize().map_err(|source| EmbreeError::Missing {
            path: path.to_owned(),
            source,
        })?;
        // SAFETY: what a library does when it is loaded is its own; the user names one to be run.
        let library = unsafe { libloading::Library::new(&file) }.map_err(|error| {
            let words = error.to_string().replace('\n', " ");
            let reason = words.strip_prefix(&format!("{}: ", file.display()));
            EmbreeError::NotALibrary {
                path: path.to_owned(),
                reason: reason.unwrap_or(&words).to_owned(),
            }
        })?;
        // SAFETY: the types are those that Embree 4 declares. Of a library that is not version 4 only the making of a device and its version are used, which
        // are alike in versions 3 and 4.
        let functions = unsafe { Functions::of(&library, path) }?;
        // Its task scheduler may have threads that outlive the device.
        std::mem::forget(library);
        let settings = CString::new(format!("threads={threads}")).expect("no NUL in a number");
        // SAFETY: a string that ends with NUL; the library keeps no pointer to it.
        let handle = unsafe { (functions.new_device)(settings.as_ptr()) };
        let mut device = Self {
            functions,
            handle,
            version: String::new(),
            memory: Box::default(),
            changing: Mutex::new(()),
        };
        if device.handle.is_null() {
            return Err(device.error("cannot start"));
        }
        let parts = VERSION_PARTS.map(|part| device.property(part));
        device.version = parts.map(|part| part.to_string()).join(".");
        if parts[0] != 4 {
            let (path, version) = (path.to_owned(), device.version.clone());
            return Err(EmbreeError::OtherVersion { path, version });
        }
        if device.property(CULLS_BACK_FACES) != 0 {
            let path = path.to_owned();
            return Err(EmbreeError::CullsBackFaces { path });
        }
        let memory: *const Memory = &raw const *device.memory;
        // SAFETY: the memory has this address until the device is dropped, and is dropped after the handle is released.
        unsafe {
            (device.functions.monitor_memory)(device.handle, count_bytes, memory.cast_mut().cast())
        };
        Ok(device)
    }

    /// Major, minor and patch.
    pub(super) fn version(&self) -> &str {
        &self.version
    }

    fn property(&self, property: c_int) -> isize {
        // SAFETY: the handle is a device.
        unsafe { (self.functions.device_property)(self.handle, property) }
    }

    /// The first error of this thread since it was last asked, which is then forgotten.
    fn error_code(&self) -> c_int {
        // SAFETY: the handle is a device, or null for why there is none.
        unsafe { (self.functions.device_error)(self.handle) }
    }

    fn error(&self, doing: &'static str) -> EmbreeError {
        let reason = error_words(self.error_code());
        EmbreeError::Device { doing, reason }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the handle is a device, and every scene that was made with it is released: each keeps this value alive.
            unsafe { (self.functions.release_device)(self.handle) }
        }
    }
}

/// Adds to what was registered with it.
///
/// # Safety
/// `memory` is a [`Memory`].
unsafe extern "C" fn count_bytes(memory: *mut c_void, bytes: isize, _is_done: bool) -> bool {
    // SAFETY: the caller's promise.
    let memory = unsafe { &*memory.cast::<Memory>().cast_const() };
    let bytes = bytes as i64;
    let now = memory.bytes.fetch_add(bytes, Ordering::Relaxed) + bytes;
    memory.peak.fetch_max(now, Ordering::Relaxed);
    true
}

/// Triangles of a scene: corners in world space and three of their indices for each triangle. The place in the list is the geometry's name.
pub(super) struct Geometry<'a> {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: &'a [[u32; 3]],
}

/// A scene that is built, and does not change any more.
pub(super) struct Committed {
    device: Arc<Device>,
    handle: Handle,
    bytes: u64,
    peak_bytes: u64,
}

// SAFETY: a scene belongs to no thread, and after `build` it is only asked for hits, which Embree's manual allows from any number of threads at once.
unsafe impl Send for Committed {}
// SAFETY: as above.
unsafe impl Sync for Committed {}

impl Committed {
    /// Builds a scene with Embree's default quality.
    pub(super) fn build(
        device: &Arc<Device>,
        is_robust: bool,
        geometries: &[Geometry],
    ) -> Result<Self, EmbreeError> {
        let _changing = lock(&device.changing);
        let api = &device.functions;
        let memory = &device.memory;
        let before = memory.bytes.load(Ordering::Relaxed);
        memory.peak.store(before, Ordering::Relaxed);
        // SAFETY: the handle is a device.
        let handle = unsafe { (api.new_scene)(device.handle) };
        if handle.is_null() {
            return Err(device.error("cannot make a scene"));
        }
        let committed = Unlocked(device, handle);
        // SAFETY: the handle is a scene that nobody else has.
        unsafe { (api.scene_flags)(handle, if is_robust { ROBUST } else { 0 }) };
        for (name, geometry) in (0..NO_GEOMETRY).zip(geometries) {
            if !geometry.triangles.is_empty() {
                attach(device, handle, name, geometry)?;
            }
        }
        // SAFETY: as above.
        unsafe { (api.commit_scene)(handle) };
        match device.error_code() {
            0 => {}
            code => {
                let (doing, reason) = ("cannot build the scene", error_words(code));
                return Err(EmbreeError::Device { doing, reason });
            }
        }
        std::mem::forget(committed);
        let since = |bytes: &AtomicI64| {
            u64::try_from(bytes.load(Ordering::Relaxed) - before).unwrap_or_default()
        };
        Ok(Self {
            device: Arc::clone(device),
            handle,
            bytes: since(&memory.bytes),
            peak_bytes: since(&memory.peak),
        })
    }

    /// What the library allocated for the scene: tree, triangles and the buffers that they came in.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The most that it had allocated at once to build it.
    pub(super) fn peak_bytes(&self) -> u64 {
        self.peak_bytes
    }

    /// The nearest hit, written into what was asked.
    #[inline]
    pub(super) fn closest(&self, mut asked: ForeignRayHit) -> ForeignRayHit {
        // SAFETY: the scene is committed; the structure has the layout and the alignment that the library asks for, and is no smaller than its own.
        unsafe {
            (self.device.functions.intersect)(self.handle, &raw mut asked, std::ptr::null_mut());
        }
        asked
    }

    /// Whether there is any hit.
    #[inline]
    pub(super) fn any(&self, mut asked: ForeignRay) -> bool {
        // SAFETY: as above.
        unsafe {
            (self.device.functions.occluded)(self.handle, &raw mut asked, std::ptr::null_mut());
        }
        asked.far < 0.0
    }
}

impl Drop for Committed {
    fn drop(&mut self) {
        let _changing = lock(&self.device.changing);
        drop(Unlocked(&self.device, self.handle));
    }
}

/// A scene that is released when this is dropped, under the lock of whoever has it.
struct Unlocked<'a>(&'a Device, Handle);

impl Drop for Unlocked<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is a scene, and nobody asks it any more.
        unsafe { (self.0.functions.release_scene)(self.1) }
    }
}

fn lock(changing: &Mutex<()>) -> std::sync::MutexGuard<'_, ()> {
    // It guards no data that a panic could leave half done.
    changing.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Gives the scene a geometry under that name.
fn attach(
    device: &Device,
    scene: Handle,
    name: u32,
    geometry: &Geometry,
) -> Result<(), EmbreeError> {
    let (api, positions, triangles) = (&device.functions, &geometry.positions, geometry.triangles);
    // The library does not look.
    let is_in_range = |i: &u32| (*i as usize) < positions.len();
    assert!(
        triangles.iter().flatten().all(is_in_range),
        "triangles name corners that there are"
    );
    // SAFETY: the handle is a device.
    let handle = unsafe { (api.new_geometry)(device.handle, TRIANGLES) };
    if handle.is_null() {
        return Err(device.error("cannot make a geometry"));
    }
    let filled = fill(device, handle, VERTICES, THREE_FLOATS, positions)
        && fill(device, handle, INDICES, THREE_UINTS, triangles);
    // SAFETY: both handles are of this device and used by this thread alone. The scene keeps what is attached.
    unsafe {
        if filled {
            (api.commit_geometry)(handle);
            (api.attach_geometry)(scene, handle, name);
        }
        (api.release_geometry)(handle);
    }
    if filled {
        Ok(())
    } else {
        Err(device.error("cannot hold the triangles"))
    }
}

/// Copies items of three 32-bit words into a new buffer of the library's; `false` if it has no room.
fn fill<T: bytemuck::Pod>(
    device: &Device,
    geometry: Handle,
    buffer: c_int,
    format: c_int,
    items: &[[T; 3]],
) -> bool {
    let size = size_of::<[T; 3]>();
    // SAFETY: the handle is a geometry that nobody else has. The library returns room for that many items of that size, which is its own and overlaps nothing.
    unsafe {
        let room = (device.functions.new_buffer)(geometry, buffer, 0, format, size, items.len());
        if room.is_null() {
            return false;
        }
        items
            .as_ptr()
            .copy_to_nonoverlapping(room.cast(), items.len());
    }
    true
}
