//! Ctrl-C in mid-run: exit code 130, and nothing left behind.
#![cfg(unix)]

use super::{PROGRAM, folder, listing};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

const SIZE: usize = 2500;

/// Writes noise as a raw raster with an ENVI header: a peak every nine cells.
fn noise(folder: &Path) {
    let mut state = 1_u32;
    let mut bytes = Vec::with_capacity(SIZE * SIZE * 2);
    for _ in 0..SIZE * SIZE {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        bytes.extend(((state >> 20) as i16).to_le_bytes());
    }
    fs::write(folder.join("noise.bin"), bytes).expect("cells");
    let header = format!(
        "ENVI\nsamples = {SIZE}\nlines = {SIZE}\nbands = 1\nheader offset = 0\nfile type = ENVI Standard\n\
         data type = 2\ninterleave = bsq\nbyte order = 0\nmap info = {{UTM, 1, 1, 500000, 5200000, 30, 30, 32, North, WGS-84}}\n"
    );
    fs::write(folder.join("noise.hdr"), header).expect("a header");
}

/// Waits until the program would notice an interrupt, or is over.
fn until_it_listens(child: &mut Child) {
    let status = format!("/proc/{}/status", child.id());
    if !Path::new("/proc/self/status").exists() {
        thread::sleep(Duration::from_millis(500));
        return;
    }
    let listens = || {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        // Bit 1 is signal 2, SIGINT.
        caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 2 != 0)
    };
    while !listens() && child.try_wait().expect("its state").is_none() {
        thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn nothing_is_left_behind() {
    let dir = folder();
    noise(dir.path());
    let before = listing(dir.path());
    let mut interrupted = 0;
    for (output, delay_ms) in
        [("a.gpkg", 0), ("b.csv", 0), ("c.gpkg", 400), ("d.gpkg", 1500), ("e.csv", 2500), ("f.fgb", 4000)]
    {
        let mut command = Command::new(PROGRAM);
        command.current_dir(dir.path()).args(["peaks", "noise.bin", output, "--min-prominence", "0", "--json"]);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        until_it_listens(&mut child);
        // Later ones fall into measuring and writing, on most machines.
        thread::sleep(Duration::from_millis(delay_ms));
        let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status();
        killed.expect("kill runs");
        let ended = child.wait_with_output().expect("the program ends");
        let said = String::from_utf8_lossy(&ended.stderr);
        let document: Value = serde_json::from_slice(&ended.stdout).expect("one JSON document");
        match ended.status.code() {
            Some(130) => {
                interrupted += 1;
                assert!(said.contains("interrupted; nothing was written"), "{output}: {said}");
                assert_eq!(document["error"]["kind"], "interrupted", "{output}");
            }
            // It was faster: then all is there.
            Some(0) => {
                for file in document["outputs"].as_array().expect("outputs") {
                    fs::remove_file(dir.path().join(file.as_str().expect("a path"))).expect("the output is there");
                }
            }
            other => panic!("{output}: exit code {other:?}: {said}"),
        }
        assert_eq!(listing(dir.path()), before, "{output} after {delay_ms} ms");
    }
    // Reading and measuring so many cells takes longer than telling it to stop.
    assert!(interrupted > 0, "no run was interrupted");
}

/// Starts the program and ends it with a signal after a while; returns how it ended.
fn ended(folder: &Path, arguments: &[&str], signal: &str, delay_ms: u64) -> std::process::ExitStatus {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().expect("the program starts");
    until_it_listens(&mut child);
    thread::sleep(Duration::from_millis(delay_ms));
    let killed = Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status();
    killed.expect("kill runs");
    child.wait().expect("the program ends")
}

#[test]
fn containers_are_whole_or_not_there() {
    let dir = folder();
    noise(dir.path());
    let encode = ["encode", "noise.bin", "out.oro", "--tile-size", "64"];
    assert!(Command::new(PROGRAM).current_dir(dir.path()).args(encode).output().expect("it runs").status.success());
    fs::rename(dir.path().join("out.oro"), dir.path().join("whole.oro")).expect("renamed");
    let whole = fs::read(dir.path().join("whole.oro")).expect("the container");
    let decode = ["decode", "whole.oro", "out.tif"];
    let before = listing(dir.path());
    for (signal, arguments, out) in [
        ("-INT", &encode[..], "out.oro"),
        ("-KILL", &encode, "out.oro"),
        ("-INT", &decode, "out.tif"),
        ("-KILL", &decode, "out.tif"),
    ] {
        for delay_ms in [0, 10, 30, 100, 300] {
            let status = ended(dir.path(), arguments, signal, delay_ms);
            let found = listing(dir.path());
            if found.iter().any(|name| name == out) {
                // It was done before it was ended.
                let bytes = fs::read(dir.path().join(out)).expect("the output");
                assert!(out != "out.oro" || bytes == whole, "{signal} {delay_ms}: a half file");
                assert!(bytes.len() > 100_000, "{signal} {delay_ms}: a half file");
                fs::remove_file(dir.path().join(out)).expect("removed");
            } else {
                assert!(!status.success(), "{signal} {delay_ms}: {out} is not there");
            }
            for name in listing(dir.path()) {
                // Nobody can tidy up after being killed, but what is left has a name of its own.
                if signal == "-KILL" && name.starts_with(".orograph-") {
                    let path = dir.path().join(name);
                    if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }.expect("removed");
                }
            }
            assert_eq!(listing(dir.path()), before, "{signal} {delay_ms} {out}");
        }
    }
}
