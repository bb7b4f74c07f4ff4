//! A program as an engine: one JSON object a line on its standard input and output.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use crate::channel::Channel;
use crate::protocol::Ask;
use crate::springs::Springs;

/// Longest line that an engine may answer (bytes).
const LONGEST_LINE: u64 = 16 << 20;
/// How long an engine may take to end by itself after its last request.
const GRACE: Duration = Duration::from_millis(500);

/// A running program.
pub struct Pipe {
    child: Child,
    /// `None` after the last request.
    input: Option<ChildStdin>,
    lines: Receiver<Result<String, String>>,
    timeout: Duration,
}

impl Pipe {
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
        Ok(Self { child, input, lines, timeout })
    }

    /// A program that has ended cannot be written to, which its missing answer says better.
    fn send(&mut self, line: &str) {
        if let Some(input) = &mut self.input {
            let _ = input.write_all(format!("{line}\n").as_bytes()).and_then(|()| input.flush());
        }
    }

    fn receive(&mut self) -> Result<String, String> {
        match self.lines.recv_timeout(self.timeout) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => Err(format!("must answer within {} s, found nothing", self.timeout.as_secs_f64())),
            Err(RecvTimeoutError::Disconnected) => Err(self.ended()),
        }
    }

    fn ended(&mut self) -> String {
        let status = self.child.wait().map(|status| status.to_string());
        format!("must answer each request, found its end ({})", status.unwrap_or_else(|error| error.to_string()))
    }
}

/// Hands on the lines that an engine prints, until it closes its output.
fn read_lines(output: impl Read, lines: &SyncSender<Result<String, String>>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let read = output.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line);
        let answer = match read {
            Ok(0) => return,
            Ok(_) if !line.ends_with(b"\n") && line.len() as u64 >= LONGEST_LINE => {
                Err(format!("must answer lines of at most {LONGEST_LINE} bytes"))
            }
            Ok(_) => String::from_utf8(line).map_err(|_| "must answer in UTF-8, found other bytes".to_owned()),
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

/// Ends a program that does not do so by itself, with all that it has started.
fn end(child: &mut Child) {
    if cfg!(unix) {
        let group = format!("-{}", child.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).stderr(Stdio::null()).status();
    }
    let _ = child.kill();
    let _ = child.wait();
}

impl Channel for Pipe {
    fn exchange(&mut self, line: &str, springs: &Arc<Springs>) -> Result<String, String> {
        self.send(line);
        loop {
            let answer = self.receive()?;
            let Ok(ask) = serde_json::from_str::<Ask>(&answer) else { return Ok(answer) };
            self.send(&serde_json::to_string(&springs.answer(&ask)).expect("numbers are plain data"));
        }
    }
}

/// The engine may end by itself; it is ended if it does not.
impl Drop for Pipe {
    fn drop(&mut self) {
        if let Some(mut input) = self.input.take() {
            let _ = input.write_all(b"{\"call\":\"end\"}\n");
        }
        let pause = Duration::from_millis(5);
        for _ in 0..GRACE.as_millis() / pause.as_millis() {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            thread::sleep(pause);
        }
        end(&mut self.child);
    }
}
