// The C example in Rust, without a crate: rustc -L native=PREFIX/lib nearest.rs && ./nearest scene.json 0.1
use std::ffi::{c_char, c_void, CStr, CString};
use std::ptr::{null, null_mut};

#[repr(C)]
struct Distances {
    size: usize,
    distance: *mut f64,
    others: [*mut c_void; 5],
}

#[link(name = "palpate")]
extern "C" {
    fn palpate_error_code(error: *const c_void) -> i32;
    fn palpate_error_sentence(error: *const c_void) -> *const c_char;
    fn palpate_error_free(error: *mut c_void);
    fn palpate_scene_open_file(path: *const c_char, watch: *const c_void, scene: *mut *mut c_void, error: *mut *mut c_void) -> i32;
    fn palpate_scene_close(scene: *mut c_void);
    fn palpate_clearance(scene: *mut c_void, poses: *const f64, count: usize, within: f64, columns: *const Distances,
                         watch: *const c_void, error: *mut *mut c_void) -> i32;
}

/// A scene that is closed when it is dropped, and may be asked by any thread.
struct Scene(*mut c_void);
unsafe impl Send for Scene {}
unsafe impl Sync for Scene {}

fn checked(code: i32, error: *mut c_void) -> Result<(), (i32, String)> {
    if code == 0 {
        return Ok(());
    }
    // SAFETY: a call that failed has set the error, which is ours to free.
    unsafe {
        let sentence = CStr::from_ptr(palpate_error_sentence(error)).to_string_lossy().into_owned();
        let code = palpate_error_code(error);
        palpate_error_free(error);
        Err((code, sentence))
    }
}

impl Scene {
    fn open(path: &str) -> Result<Scene, (i32, String)> {
        let path = CString::new(path).expect("a path has no zero inside");
        let (mut scene, mut error) = (null_mut(), null_mut());
        // SAFETY: the places outlive the call.
        let code = unsafe { palpate_scene_open_file(path.as_ptr(), null(), &mut scene, &mut error) };
        checked(code, error).map(|()| Scene(scene))
    }
    fn clearance(&self, poses: &[[f64; 7]]) -> Result<Vec<f64>, (i32, String)> {
        let mut found = vec![0.0; poses.len()];
        let columns = Distances { size: std::mem::size_of::<Distances>(), distance: found.as_mut_ptr(), others: [null_mut(); 5] };
        let mut error = null_mut();
        // SAFETY: a distance has room for every pose, and an array of arrays has no gaps.
        let code = unsafe { palpate_clearance(self.0, poses.as_ptr().cast(), poses.len(), f64::INFINITY, &columns, null(), &mut error) };
        checked(code, error).map(|()| found)
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: nobody else has the handle.
        unsafe { palpate_scene_close(self.0) }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let height: f64 = arguments[2].parse().expect("a height in metres");
    match Scene::open(&arguments[1]).and_then(|scene| scene.clearance(&[[0.0, 0.0, height, 0.0, 0.0, 0.0, 1.0]])) {
        Ok(found) => println!("{:.6} m free", found[0]),
        Err((code, sentence)) => {
            eprintln!("{sentence}");
            std::process::exit(code);
        }
    }
}
