//! A program as an engine: one JSON object a line on its standard input and output.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

use crate::channel::{Channel, shortened};
use crate::protocol::Ask;
use crate::springs::Springs;

/// Longest line that an engine may answer (bytes).
const LONGEST_LINE: u64 = 16 << 20;
/// How long an engine may take to end by itself after its last request.
const GRACE: Duration = Duration::from_millis(500);

/// Groups of programs that run.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Ends all engines that run, for a program that ends at once itself.
pub fn end_all() {
    running().drain(..).for_each(end);
}

fn running() -> MutexGuard<'static, Vec<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How often it is looked whether the engine still reads what it is sent.
const LOOK: Duration = Duration::from_millis(20);

/// A line that an engine printed.
struct Said {
    line: String,
    /// Whether it printed more before it was asked again.
    follows: bool,
}

/// A running program.
pub struct Pipe {
    child: Child,
    /// `None` after the last request.
    input: Option<ChildStdin>,
    lines: Receiver<Result<Said, String>>,
    timeout: Duration,
    /// By when the engine must have read what it is being sent; `None` while it is not.
    read_by: Arc<Mutex<Option<Instant>>>,
}

impl Pipe {
    /// Time that is waited for an answer unless another is asked for.
    pub const PATIENCE: Duration = Duration::from_secs(60);

    /// Starts a command of a shell. An answer may take as long as `timeout`.
    ///
    /// # Errors
    /// When it does not start, in words.
    pub fn start(command: &str, timeout: Duration) -> Result<Self, String> {
        let mut child = shell(command)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|error| format!("must be a command that starts, found {error}"))?;
        let (input, output) = (child.stdin.take(), child.stdout.take().expect("it is piped"));
        let (sender, lines) = sync_channel(1);
        thread::spawn(move || read_lines(output, &sender));
        let read_by = Arc::default();
        let (group, watched) = (child.id(), Arc::downgrade(&read_by));
        running().push(group);
        thread::spawn(move || end_if_deaf(group, &watched));
        Ok(Self { child, input, lines, timeout, read_by })
    }

    /// Sends a line. An engine that does not read it is ended. One that has ended cannot be written
    /// to, which its missing answer says better.
    fn send(&mut self, line: &str, deadline: Instant) {
        if let Some(input) = &mut self.input {
            *locked(&self.read_by) = Some(deadline);
            let _ = input.write_all(format!("{line}\n").as_bytes()).and_then(|()| input.flush());
            *locked(&self.read_by) = None;
        }
    }

    fn receive(&mut self, deadline: Instant) -> Result<String, String> {
        match self.lines.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(Ok(Said { line, follows: false })) => Ok(line),
            Ok(Ok(Said { line, .. })) => Err(format!("must answer each request once, found more behind {}", shortened(line.trim()))),
            Ok(Err(what)) => Err(what),
            Err(RecvTimeoutError::Timeout) => Err(self.late()),
            Err(RecvTimeoutError::Disconnected) => Err(self.ended(deadline)),
        }
    }

    fn late(&self) -> String {
        format!("must answer within {} s, found nothing", self.timeout.as_secs_f64())
    }

    /// What an engine did that closed its output: it has ended, or will not answer.
    fn ended(&mut self, deadline: Instant) -> String {
        match self.wait_until(deadline) {
            Some(_) if Instant::now() >= deadline => self.late(),
            Some(status) => format!("must answer each request, found its end ({status})"),
            None => "must answer each request, found its output closed".to_owned(),
        }
    }

    /// The code of a program that ends by itself until then.
    fn wait_until(&mut self, deadline: Instant) -> Option<ExitStatus> {
        loop {
            match self.child.try_wait() {
                Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(5)),
                found => return found.ok().flatten(),
            }
        }
    }
}

fn locked(read_by: &Mutex<Option<Instant>>) -> MutexGuard<'_, Option<Instant>> {
    read_by.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends a group of programs that does not read what it is sent, for as long as there is a pipe.
fn end_if_deaf(group: u32, read_by: &Weak<Mutex<Option<Instant>>>) {
    while let Some(read_by) = read_by.upgrade() {
        if locked(&read_by).is_some_and(|deadline| Instant::now() > deadline) {
            return end(group);
        }
        drop(read_by);
        thread::sleep(LOOK);
    }
}

/// Hands on the lines that an engine prints, until it closes its output.
fn read_lines(output: impl Read, lines: &SyncSender<Result<Said, String>>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let read = output.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line);
        let answer = match read {
            Ok(0) => return,
            Ok(_) if !line.ends_with(b"\n") && line.len() as u64 >= LONGEST_LINE => {
                Err(format!("must answer lines of at most {LONGEST_LINE} bytes"))
            }
            Ok(_) => match String::from_utf8(line) {
                Ok(line) => Ok(Said { line, follows: !output.buffer().is_empty() }),
                Err(_) => Err("must answer in UTF-8, found other bytes".to_owned()),
            },
            Err(error) => Err(format!("must answer, found {error}")),
        };
        let is_over = answer.is_err();
        if lines.send(answer).is_err() || is_over {
            return;
        }
    }
}

/// A command as the shell of the system reads it.
fn shell(command: &str) -> Command {
    let (shell, option) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
    let mut started = Command::new(shell);
    started.arg(option).arg(command);
    // What the shell starts belongs to the same group, and is ended with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut started, 0);
    started
}

/// Ends a group of programs.
fn end(group: u32) {
    if cfg!(unix) {
        let _ = Command::new("kill").args(["-KILL", "--", &format!("-{group}")]).stderr(Stdio::null()).status();
    }
}

impl Channel for Pipe {
    fn exchange(&mut self, line: &str, springs: &Arc<Springs>) -> Result<String, String> {
        let deadline = Instant::now() + self.timeout;
        self.send(line, deadline);
        loop {
            let answer = self.receive(deadline)?;
            let ask = match serde_json::from_str::<Ask>(&answer) {
                Ok(ask) => ask,
                Err(error) if answer.contains("\"ask\"") => return Err(format!("wrench: {error}, found {}", shortened(answer.trim()))),
                Err(_) => return Ok(answer),
            };
            self.send(&serde_json::to_string(&springs.answer(&ask)?).expect("numbers are finite"), deadline);
        }
    }
}

/// The engine may end by itself. It is ended if it does not, and so is what it has started.
impl Drop for Pipe {
    fn drop(&mut self) {
        let deadline = Instant::now() + GRACE;
        self.send("{\"call\":\"end\"}", deadline);
        self.input = None;
        self.wait_until(deadline);
        let group = self.child.id();
        running().retain(|other| *other != group);
        end(group);
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
