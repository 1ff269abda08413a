//! The only unsafe code: Embree 4 loaded at run time.
//!
//! Declarations are those of `rtcore_*.h` 4.4. There are bindings on crates.io, but they want an
//! installed Embree when they are built. What is exported is safe: a [`Device`] becomes a [`Scene`],
//! which owns all that Embree reads and is not changed any more.
#![allow(unsafe_code)]

use std::ffi::{CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::ptr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};

use libloading::Library;
use octogrid::TriMesh;

use super::layout::{Packet, RayHit, RtcRay};
use crate::memory::Bytes;

type Handle = *mut c_void;
type Trace<T> = unsafe extern "C" fn(Handle, *mut T, *const Arguments);
type TracePacket<const N: usize> = unsafe extern "C" fn(*const i32, Handle, *mut Packet<N>, *const Arguments);
type Monitor = unsafe extern "C" fn(Handle, isize, bool) -> bool;
type Filter = unsafe extern "C" fn(*const FilterArguments);

const TRIANGLES: u32 = 0;
const INDEX_BUFFER: (u32, u32) = (0, 0x5003);
const VERTEX_BUFFER: (u32, u32) = (1, 0x9003);
const ROBUST: u32 = 1 << 2;
const COHERENT: u32 = 1 << 16;
const INVOKE_FILTER: u32 = 1 << 1;

/// RTCIntersectArguments and RTCOccludedArguments.
#[repr(C)]
pub(super) struct Arguments {
    flags: u32,
    features: u32,
    context: *mut Context,
    filter: Option<Filter>,
    intersect: *const c_void,
    /// Room for fields that a build may have beyond these.
    room: [u64; 2],
}

impl Arguments {
    /// For many calls; coherent rays start and point nearly alike.
    pub(super) fn of(coherent: bool) -> Self {
        Self::new(if coherent { COHERENT } else { 0 })
    }

    fn new(flags: u32) -> Self {
        let (context, intersect) = (ptr::null_mut(), ptr::null());
        Self { flags, features: u32::MAX, context, filter: None, intersect, room: [0; 2] }
    }
}

/// RTCRayQueryContext with a field of our own behind it.
#[repr(C)]
struct Context {
    /// Identifiers of instances, with room for a build with several levels of them.
    instances: [u32; 8],
    hits: u32,
}

/// RTCFilterFunctionNArguments.
#[repr(C)]
struct FilterArguments {
    valid: *mut i32,
    user: Handle,
    context: *mut Context,
    ray: Handle,
    hit: Handle,
    lanes: u32,
}

/// Counts a hit, and rejects it so that the search goes on.
///
/// # Safety
/// Embree calls it for one ray, traced by [`Scene::count`], whose context is a [`Context`].
unsafe extern "C" fn count_and_reject(arguments: *const FilterArguments) {
    // SAFETY: Embree passes a pointer that is good for this call; `valid` has one lane, as the ray is
    // a single one; `context` is what `Scene::count` set, which nothing else touches meanwhile.
    unsafe {
        (*(*arguments).context).hits += 1;
        *(*arguments).valid = 0;
    }
}

/// Keeps account of what Embree allocates; negative when it frees.
///
/// # Safety
/// `meter` is the [`Meter`] of a device that is alive.
unsafe extern "C" fn account(meter: Handle, bytes: isize, _: bool) -> bool {
    // SAFETY: `Device` registers its boxed meter, which it drops after the device only. Atomics make
    // calls from several threads sound.
    let meter = unsafe { &*meter.cast::<Meter>() };
    let held = meter.held.fetch_add(bytes, Relaxed) + bytes;
    meter.peak.fetch_max(held, Relaxed);
    true
}

#[derive(Default)]
struct Meter {
    held: AtomicIsize,
    peak: AtomicIsize,
}

/// Declares the functions and looks them up by name.
macro_rules! functions {
    ($($field:ident = $name:literal: $type:ty,)*) => {
        struct Functions { $($field: $type,)* _library: Library }

        impl Functions {
            /// # Safety
            /// `library` is Embree 4.
            unsafe fn of(library: Library) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those of Embree's headers; `_library` keeps the code loaded.
                Ok(unsafe { Self { $($field: *library.get::<$type>($name)?,)* _library: library } })
            }
        }
    };
}

functions! {
    new_device = "rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Handle,
    release_device = "rtcReleaseDevice": unsafe extern "C" fn(Handle),
    set_monitor = "rtcSetDeviceMemoryMonitorFunction": unsafe extern "C" fn(Handle, Monitor, Handle),
    new_scene = "rtcNewScene": unsafe extern "C" fn(Handle) -> Handle,
    release_scene = "rtcReleaseScene": unsafe extern "C" fn(Handle),
    set_quality = "rtcSetSceneBuildQuality": unsafe extern "C" fn(Handle, u32),
    set_flags = "rtcSetSceneFlags": unsafe extern "C" fn(Handle, u32),
    new_geometry = "rtcNewGeometry": unsafe extern "C" fn(Handle, u32) -> Handle,
    release_geometry = "rtcReleaseGeometry": unsafe extern "C" fn(Handle),
    share_buffer = "rtcSetSharedGeometryBuffer":
        unsafe extern "C" fn(Handle, u32, u32, u32, *const c_void, usize, usize, usize),
    set_geometry_quality = "rtcSetGeometryBuildQuality": unsafe extern "C" fn(Handle, u32),
    commit_geometry = "rtcCommitGeometry": unsafe extern "C" fn(Handle),
    attach_geometry = "rtcAttachGeometry": unsafe extern "C" fn(Handle, Handle) -> u32,
    commit_scene = "rtcCommitScene": unsafe extern "C" fn(Handle),
    intersect1 = "rtcIntersect1": Trace<RayHit>,
    intersect8 = "rtcIntersect8": TracePacket<8>,
    intersect16 = "rtcIntersect16": TracePacket<16>,
    occluded1 = "rtcOccluded1": Trace<RtcRay>,
    occluded8 = "rtcOccluded8": TracePacket<8>,
    occluded16 = "rtcOccluded16": TracePacket<16>,
}

/// Whether there is a library to load.
pub(crate) fn library_is_there() -> bool {
    library().is_some()
}

/// What `PEERS_EMBREE` names, else what `setup.sh` has fetched.
fn library() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("PEERS_EMBREE") {
        return Some(path.into());
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(".cache/embreex.libs");
    let mut files = std::fs::read_dir(folder).ok()?.flatten();
    files.find(|file| file.file_name().to_string_lossy().starts_with("libembree4")).map(|file| file.path())
}

fn functions() -> &'static Functions {
    static FUNCTIONS: OnceLock<Functions> = OnceLock::new();
    FUNCTIONS.get_or_init(|| {
        let path = library().expect("setup.sh has fetched Embree");
        // SAFETY: loading Embree runs no code of it but harmless constructors.
        let loaded = unsafe { Library::new(path).and_then(|library| Functions::of(library)) };
        loaded.expect("Embree 4 loads")
    })
}

/// An Embree device with a mesh to be built, so that its number of threads holds for that build only.
pub(super) struct Device {
    handle: Handle,
    meter: Box<Meter>,
    vertices: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

// SAFETY: Embree's functions may be called from any thread.
unsafe impl Send for Device {}
// SAFETY: `&Device` gives no access.
unsafe impl Sync for Device {}

impl Device {
    /// A device for builds with that many threads. The copies stand for its user's own arrays.
    pub(super) fn new(threads: usize, mesh: TriMesh<'_>) -> Self {
        let mut vertices = mesh.vertices().to_vec();
        // Embree reads 16 bytes at each vertex.
        vertices.push([0.0; 3]);
        let options = CString::new(format!("threads={threads}")).expect("no zero in it");
        let meter = Box::<Meter>::default();
        // SAFETY: the string ends with a zero and is read within the call; the meter is boxed and
        // outlives the device, see `drop`.
        let handle = unsafe {
            let device = (functions().new_device)(options.as_ptr());
            assert!(!device.is_null(), "Embree starts");
            (functions().set_monitor)(device, account, ptr::from_ref(&*meter).cast_mut().cast());
            device
        };
        Self { handle, meter, vertices, triangles: mesh.triangles().to_vec() }
    }

    /// Builds the scene.
    pub(super) fn build(self, quality: u32, robust: bool) -> Scene {
        let f = functions();
        // SAFETY: the handles are those just made; the buffers are owned by `self`, which the scene
        // keeps unchanged as long as it lives. Indices are within the vertices, as `TriMesh` has
        // checked, and the vertices have 16 bytes to read at the last one.
        let handle = unsafe {
            let scene = (f.new_scene)(self.handle);
            (f.set_quality)(scene, quality);
            (f.set_flags)(scene, if robust { ROBUST } else { 0 });
            let geometry = (f.new_geometry)(self.handle, TRIANGLES);
            (f.set_geometry_quality)(geometry, quality);
            let share =
                |(kind, format), data, len| (f.share_buffer)(geometry, kind, 0, format, data, 0, 12, len);
            share(VERTEX_BUFFER, self.vertices.as_ptr().cast(), self.vertices.len() - 1);
            share(INDEX_BUFFER, self.triangles.as_ptr().cast(), self.triangles.len());
            (f.commit_geometry)(geometry);
            (f.attach_geometry)(scene, geometry);
            (f.release_geometry)(geometry);
            (f.commit_scene)(scene);
            scene
        };
        Scene { handle, functions: f, device: self }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the handle is good and not used any more; the meter is dropped after this.
        unsafe { (functions().release_device)(self.handle) }
    }
}

/// A built scene.
pub(super) struct Scene {
    handle: Handle,
    functions: &'static Functions,
    /// Dropped after the scene is released.
    device: Device,
}

// SAFETY: a committed scene may be traced from any thread and from several at once.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the handle is good and not used any more.
        unsafe { (self.functions.release_scene)(self.handle) }
    }
}

impl Scene {
    /// Finds the closest hit.
    #[inline(always)]
    pub(super) fn intersect(&self, hit: &mut RayHit, arguments: &Arguments) {
        // SAFETY: the scene is committed; ray and arguments are laid out and aligned as Embree's.
        unsafe { (self.functions.intersect1)(self.handle, hit, arguments) }
    }

    /// Sets `t_far` to minus infinity where there is any hit.
    #[inline(always)]
    pub(super) fn occluded(&self, ray: &mut RtcRay, arguments: &Arguments) {
        // SAFETY: as in `intersect`.
        unsafe { (self.functions.occluded1)(self.handle, ray, arguments) }
    }

    /// The number of hits.
    #[inline(always)]
    pub(super) fn count(&self, hit: &mut RayHit) -> u32 {
        let mut context = Context { instances: [u32::MAX; 8], hits: 0 };
        let mut arguments = Arguments::new(INVOKE_FILTER);
        arguments.context = &raw mut context;
        arguments.filter = Some(count_and_reject);
        // SAFETY: as in `intersect`; the context lives during the call, and holds what the filter needs.
        unsafe { (self.functions.intersect1)(self.handle, hit, &arguments) };
        context.hits
    }

    /// Finds the closest hit of each lane in use.
    #[inline(always)]
    pub(super) fn intersect8(&self, packet: &mut Packet<8>, arguments: &Arguments) {
        // SAFETY: as in `intersect`; mask and packet have the eight lanes that this function is for.
        unsafe { (self.functions.intersect8)(packet.valid.0.as_ptr(), self.handle, packet, arguments) }
    }

    /// Finds the closest hit of each lane in use.
    #[inline(always)]
    pub(super) fn intersect16(&self, packet: &mut Packet<16>, arguments: &Arguments) {
        // SAFETY: as in `intersect8`, with 16 lanes.
        unsafe { (self.functions.intersect16)(packet.valid.0.as_ptr(), self.handle, packet, arguments) }
    }

    /// As [`Scene::occluded`] for each lane in use.
    #[inline(always)]
    pub(super) fn occluded8(&self, packet: &mut Packet<8>, arguments: &Arguments) {
        // SAFETY: as in `intersect8`; a packet begins with its rays, the only part that is used.
        unsafe { (self.functions.occluded8)(packet.valid.0.as_ptr(), self.handle, packet, arguments) }
    }

    /// As [`Scene::occluded`] for each lane in use.
    #[inline(always)]
    pub(super) fn occluded16(&self, packet: &mut Packet<16>, arguments: &Arguments) {
        // SAFETY: as in `occluded8`, with 16 lanes.
        unsafe { (self.functions.occluded16)(packet.valid.0.as_ptr(), self.handle, packet, arguments) }
    }

    /// Its memory as Embree's monitor saw it.
    pub(super) fn bytes(&self) -> Bytes {
        let read = |bytes: &AtomicIsize| bytes.load(Relaxed).max(0) as usize;
        Bytes { held: read(&self.device.meter.held), peak: read(&self.device.meter.peak) }
    }
}
