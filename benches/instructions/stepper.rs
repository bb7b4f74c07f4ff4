//! Counts the instructions of a hot path: a child runs it, and is taken through it one machine
//! instruction at a time.
//!
//! The child warms up, stops itself before and after the counted calls, and all between is stepped
//! by ptrace. That counts what the processor was told to do, not how long it took: the same program
//! repeats its count exactly, on a loaded machine too. For it to be the same, the child gets
//! nothing that differs from run to run or from place to place: no environment, one name, addresses
//! in fixed places, and libc's variants for the oldest processors.

use std::io;
use std::process::{Child, Command, ExitCode, Stdio};

use nix::errno::Errno;
use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::sys::personality::{self, Persona};
use nix::sys::ptrace;
use nix::sys::signal::{Signal, raise};
use nix::sys::wait::{WaitStatus, waitpid};
use nix::unistd::Pid;

use crate::paths::{self, HotPath};

/// Exit code of a child that may not be traced.
const NOT_PERMITTED: u8 = 4;
/// The first argument of a child.
pub const CHILD: &str = "--stepped-child";
/// libc chooses copies and sines by the processor that it finds. Without these features it takes
/// those of every x86-64; elsewhere nothing has these names.
const OLDEST_PROCESSOR: &str = "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-FMA4,-ERMS,-FSRM";

/// Why there is no count.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    #[error("{0}")]
    Unavailable(&'static str),
    #[error("the stepped process could not be started or stepped: {0}")]
    System(#[from] io::Error),
    #[error("the stepped process ended early: {0}")]
    Ended(String),
}

const NO_PTRACE: StepError = StepError::Unavailable("ptrace is not permitted here");

impl From<Errno> for StepError {
    fn from(errno: Errno) -> Self {
        match errno {
            Errno::EPERM | Errno::EACCES | Errno::ENOSYS => NO_PTRACE,
            other => StepError::System(other.into()),
        }
    }
}

/// Addresses in fixed places for the children of this process; whether that is permitted.
pub fn fix_addresses() -> bool {
    personality::get().and_then(|persona| personality::set(persona | Persona::ADDR_NO_RANDOMIZE)).is_ok()
}

/// Instructions of all counted calls of a hot path.
///
/// # Errors
/// When the child could not be stepped to the end.
pub fn count(path: &HotPath) -> Result<u64, StepError> {
    let home = stay_on_one_processor();
    // Only the thread that starts a child may step it.
    let child = Command::new("/proc/self/exe")
        .args([CHILD, path.name])
        .env_clear()
        .env("GLIBC_TUNABLES", OLDEST_PROCESSOR)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()?;
    let count = Stepped { child }.count();
    if let Some(home) = home {
        // Failing, the next child shares this processor: slower, no less right.
        let _ = sched_setaffinity(THIS_THREAD, &home);
    }
    count
}

const THIS_THREAD: Pid = Pid::from_raw(0);

/// Stepper and child take turns: on one processor they need not wake each other across two. The set
/// of before, where that succeeded.
fn stay_on_one_processor() -> Option<CpuSet> {
    let all = sched_getaffinity(THIS_THREAD).ok()?;
    let own = rayon::current_thread_index().unwrap_or(0);
    let mut allowed = (0..CpuSet::count()).filter(|cpu| all.is_set(*cpu).unwrap_or(false)).cycle().skip(own);
    let mut one = CpuSet::new();
    one.set(allowed.next()?).ok()?;
    sched_setaffinity(THIS_THREAD, &one).ok().map(|()| all)
}

/// A child that is killed when nobody steps it any more.
struct Stepped {
    child: Child,
}

impl Stepped {
    fn count(&self) -> Result<u64, StepError> {
        let pid = Pid::from_raw(self.child.id() as i32);
        match waitpid(pid, None)? {
            WaitStatus::Stopped(_, Signal::SIGSTOP) => {}
            WaitStatus::Exited(_, code) if code == i32::from(NOT_PERMITTED) => return Err(NO_PTRACE),
            other => return Err(StepError::Ended(format!("{other:?}"))),
        }
        ptrace::setoptions(pid, ptrace::Options::PTRACE_O_EXITKILL)?;
        let mut n_instructions = 0;
        loop {
            ptrace::step(pid, None)?;
            match waitpid(pid, None)? {
                WaitStatus::Stopped(_, Signal::SIGTRAP) => n_instructions += 1,
                WaitStatus::Stopped(_, Signal::SIGSTOP) => return Ok(n_instructions),
                other => return Err(StepError::Ended(format!("{other:?}"))),
            }
        }
    }
}

impl Drop for Stepped {
    fn drop(&mut self) {
        // Both fail only where it has ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The child's part.
pub fn run_child(name: &str) -> ExitCode {
    let Some(path) = paths::find(name) else { return ExitCode::from(2) };
    let mut call = (path.prepare)();
    if ptrace::traceme().is_err() {
        return ExitCode::from(NOT_PERMITTED);
    }
    let stop = || raise(Signal::SIGSTOP).expect("a process may stop itself");
    stop();
    (0..path.n_calls).for_each(|_| call());
    stop();
    ExitCode::SUCCESS
}
