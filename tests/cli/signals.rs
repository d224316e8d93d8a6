//! A signal ends a render within a second, with the picture so far.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use bspray::picture::{Attribute, Samples, exr, read_image};

use super::run::model;

/// The promise is one second; the rest is for a loaded machine.
const LIMIT: Duration = Duration::from_secs(3);

const SAMPLES: u32 = 100_000;

struct Ended {
    status: ExitStatus,
    stdout: String,
    stderr: String,
    /// From the signal to the end.
    took: Duration,
}

/// Starts a render that would take minutes, and sends it a signal `wait` after it has chosen its camera.
fn interrupted(folder: &Path, signal: &str, wait: Duration) -> Ended {
    let mut child = Command::new(env!("CARGO_BIN_EXE_bspray"))
        .args(["render", &model("cornell-box.obj"), "--json"])
        .args(["--resolution", "160x120", "--spp", &SAMPLES.to_string()])
        .args(["-o", "p.png", "-o", "p.exr"])
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut lines = BufReader::new(child.stderr.take().expect("piped"));
    let mut stderr = String::new();
    while !stderr.contains("camera: ") {
        let read = lines.read_line(&mut stderr).expect("text");
        assert_ne!(read, 0, "ended by itself: {stderr}");
    }
    std::thread::sleep(wait);
    let sent = Instant::now();
    let killed = Command::new("kill")
        .args(["-s", signal, &child.id().to_string()])
        .status();
    assert!(killed.expect("there is a kill").success());
    let (ended, has_ended) = mpsc::channel::<()>();
    let id = child.id().to_string();
    let watchdog = std::thread::spawn(move || {
        // Should it not stop, the test must.
        if has_ended.recv_timeout(5 * LIMIT) == Err(RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-s", "KILL", &id]).status();
        }
    });
    lines.read_to_string(&mut stderr).expect("text");
    let mut stdout = String::new();
    let mut pipe = child.stdout.take().expect("piped");
    pipe.read_to_string(&mut stdout).expect("text");
    let took = sent.elapsed();
    // Its id is its own until it is waited for.
    drop(ended);
    watchdog.join().expect("the watchdog ends");
    let status = child.wait().expect("it ends");
    Ended {
        status,
        stdout,
        stderr,
        took,
    }
}

#[test]
fn a_signal_ends_a_render_with_the_picture_so_far() {
    for signal in ["TERM", "INT"] {
        let folder = tempfile::tempdir().unwrap();
        // The camera is told just before the first ray. Should the signal come in between, there is no picture yet.
        let ended = [100, 1000, 5000]
            .into_iter()
            .map(|ms| interrupted(folder.path(), signal, Duration::from_millis(ms)))
            .find(|e| !e.stderr.contains("before there was a picture"))
            .expect("a render that has begun");
        let Ended {
            status,
            stdout,
            stderr,
            took,
        } = ended;
        assert_eq!(status.code(), Some(4), "SIG{signal}: {stderr}");
        assert!(took < LIMIT, "SIG{signal}: took {took:?}");
        let last = stderr.lines().last().unwrap();
        assert!(last.starts_with("partial: p.png, p.exr"), "{stderr}");
        let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(report["complete"], false);

        let png = std::fs::read(folder.path().join("p.png")).unwrap();
        let image = read_image("p.png", &png).unwrap();
        assert_eq!((image.width, image.height), (160, 120));
        let picture = exr::read(&folder.path().join("p.exr")).unwrap();
        assert_eq!(picture.attributes["bspray/partial"], Attribute::Int(1));
        let Some(Samples::U32(samples)) = picture.channel("samples") else {
            panic!("samples")
        };
        let sum: u64 = samples.iter().map(|&n| u64::from(n)).sum();
        assert!(sum > 0 && sum < 160 * 120 * u64::from(SAMPLES), "{sum}");
        assert_eq!(report["samples"], sum);
        assert_eq!(super::run::names(folder.path()), ["p.exr", "p.png"]);
    }
}
