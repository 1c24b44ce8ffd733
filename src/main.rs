//! The program `orograph`: arguments in, exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    keep_memory();
    ExitCode::from(orograph::cli::run(std::env::args_os()))
}

/// Keeps freed memory for the next tile: the C library would give it back and fetch it again page by page, which takes
/// up to a quarter of the time of encoding and decoding.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn keep_memory() {
    /// The most that the C library takes for this one.
    const LARGE: std::ffi::c_int = 32 << 20;
    /// Freed memory that stays.
    const SPARE: std::ffi::c_int = 256 << 20;
    #[allow(unsafe_code, reason = "a C function of two numbers that sets parameters of the allocator")]
    // SAFETY: no other thread runs yet, and values out of range are refused, which is no harm.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        libc::mallopt(libc::M_TRIM_THRESHOLD, SPARE);
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn keep_memory() {}
