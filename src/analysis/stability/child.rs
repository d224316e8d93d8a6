//! Work that may run away or end the process, in a process of its own.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use super::ending::Ending;
use super::judged::{CellReply, Judged};
use super::limits::{is_out_of_time, limit_this_process};
use super::methods::Method;
use super::results::Cell;
use super::sweeps::Sweep;
use crate::accel::Embree;

/// Memory that a child may use, in bytes of address space: enough for every method that ends, and too little to hurt the machine.
const MEMORY: u64 = 4 << 30;

/// How often a child is looked at.
const LOOK: Duration = Duration::from_millis(5);

/// How to start a child: a program that calls [`answer`] with the arguments that follow `arguments`.
#[derive(Clone, Debug)]
pub struct Isolation {
    /// The program, usually this one.
    pub program: PathBuf,
    /// Its first arguments.
    pub arguments: Vec<OsString>,
    /// Seconds of processor time until it is ended.
    pub seconds: u32,
}

/// One method at one step of one sweep.
#[derive(Clone, Debug)]
pub struct CellTask {
    /// The sweep's name.
    pub sweep: String,
    /// The index of the step.
    pub step: usize,
    /// The method's name.
    pub method: String,
    /// Most rays.
    pub rays: usize,
    /// Changes every random number.
    pub seed: u64,
}

/// Seconds by the clock for each second of processor time: a child ends itself by the latter, so that a busy machine blames nobody. The parent's clock is for those that sleep, and
/// for systems without such limits.
const WAITED: u64 = 8;

/// Does the task in this process, under limits on its memory and time, and returns the result as JSON. For child processes.
///
/// # Errors
/// Names and steps that there are not, and a method that needs Embree without it.
pub fn answer(task: &CellTask, seconds: u32, embree: Option<&Embree>) -> Result<String, String> {
    let sweep = Sweep::named(&task.sweep)?;
    let method: Method = task.method.parse()?;
    let values = sweep.values();
    let value = values
        .get(task.step)
        .ok_or_else(|| format!("{} has {} steps", sweep.name, values.len()))?;
    if method.needs_embree() && embree.is_none() {
        return Err(format!("{} needs Embree", method.name()));
    }
    limit_this_process(MEMORY, u64::from(seconds));
    let case = sweep.case(*value, task.rays, task.seed);
    let reply = Judged::of(&case).cell(method, embree);
    serde_json::to_string(&reply).map_err(|error| error.to_string())
}

/// Has a child do the task.
pub(super) fn ask(isolation: &Isolation, task: &CellTask) -> CellReply {
    let ended = |ending| CellReply {
        cell: Cell {
            ending,
            ..Cell::default()
        },
        wrong: None,
    };
    let died = |how: String| ended(Ending::Died { how });
    let started = Command::new(&isolation.program)
        .args(&isolation.arguments)
        .args([&task.sweep, &task.step.to_string(), &task.method])
        .args([
            task.rays.to_string(),
            task.seed.to_string(),
            isolation.seconds.to_string(),
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match started {
        Ok(child) => child,
        Err(error) => return died(format!("did not start: {error}")),
    };
    let seconds = isolation.seconds;
    let did_not_end = || ended(Ending::DidNotEnd { seconds });
    match wait(&mut child, Duration::from_secs(u64::from(seconds) * WAITED)) {
        Err(error) => return died(error.to_string()),
        Ok(false) => return did_not_end(),
        Ok(true) => {}
    }
    match child.wait_with_output() {
        Err(error) => died(error.to_string()),
        Ok(output) if is_out_of_time(output.status) => did_not_end(),
        Ok(output) if output.status.success() => serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|error| died(format!("unreadable answer: {error}"))),
        Ok(output) => died(how(output.status, &String::from_utf8_lossy(&output.stderr))),
    }
}

/// Waits for the end, and makes one when the time is over: `false`. What a child writes fits into its pipes.
fn wait(child: &mut Child, limit: Duration) -> std::io::Result<bool> {
    let begun = Instant::now();
    while child.try_wait()?.is_none() {
        if begun.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(false);
        }
        std::thread::sleep(LOOK);
    }
    Ok(true)
}

/// Why a process ended as it did.
fn how(status: ExitStatus, said: &str) -> String {
    if said.contains("overflowed its stack") {
        "stack overflow".to_owned()
    } else if said.contains("memory allocation of") {
        format!("out of memory ({} GiB)", MEMORY >> 30)
    } else if let Some(line) = said.lines().find(|l| l.contains("panicked at")) {
        format!("panic: {line}")
    } else {
        status.to_string()
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    fn run(script: &str) -> Ending {
        let isolation = Isolation {
            program: "/bin/sh".into(),
            arguments: vec!["-c".into(), script.into()],
            seconds: 1,
        };
        let task = CellTask {
            sweep: String::new(),
            step: 0,
            method: String::new(),
            rays: 0,
            seed: 0,
        };
        ask(&isolation, &task).cell.ending
    }

    #[test]
    fn each_end_of_a_child_has_its_name() {
        let died = |how: &str| Ending::Died {
            how: how.to_owned(),
        };
        let did_not_end = Ending::DidNotEnd { seconds: 1 };
        assert_eq!(run("sleep 20"), did_not_end);
        assert_eq!(run("ulimit -S -t 1; while :; do :; done"), did_not_end);
        assert_eq!(
            run("echo thread main has overflowed its stack >&2; kill -ABRT $$"),
            died("stack overflow")
        );
        assert_eq!(
            run("echo memory allocation of 9 bytes failed >&2; exit 3"),
            died("out of memory (4 GiB)")
        );
        assert!(matches!(run("kill -SEGV $$"), Ending::Died { how } if how.contains("signal: 11")));
        assert!(matches!(run("echo no"), Ending::Died { how } if how.contains("unreadable")));
    }

    #[test]
    fn a_reply_is_read_as_it_was_written() {
        let case = Sweep::named("coincident").unwrap().case(30.0, 20, 1);
        let reply = Judged::of(&case).cell(Method::ObvhsBvh2, None);
        assert!(reply.cell.rays > 0);
        let text = serde_json::to_string(&reply).unwrap();
        let read: CellReply = serde_json::from_str(&text).unwrap();
        assert_eq!((read.cell, read.wrong), (reply.cell, reply.wrong));
    }

    #[test]
    fn tasks_that_there_are_not_are_refused() {
        let refused = |sweep: &str, step, method: &str| {
            let task = CellTask {
                sweep: sweep.to_owned(),
                step,
                method: method.to_owned(),
                rays: 1,
                seed: 0,
            };
            answer(&task, 1, None).expect_err("no such task")
        };
        assert!(refused("coincidence", 0, "bsp").contains("coincidence"));
        assert!(refused("coincident", 0, "bspp").contains("bspp"));
        assert_eq!(refused("coincident", 0, "embree"), "embree needs Embree");
        assert_eq!(refused("coincident", 99, "bsp"), "coincident has 12 steps");
    }
}
