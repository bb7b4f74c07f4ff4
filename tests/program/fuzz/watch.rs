//! A stop for work that takes too long.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{LazyLock, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use cohaul::stop::Stop;

/// Time that work may take from the request to stop to its end: the program promises 0.2 s, and the
/// machine may be busy.
pub const TO_STOP: Duration = Duration::from_secs(3);
/// Time after which work is taken for endless.
const ENDLESS: Duration = Duration::from_secs(60);

struct Watched {
    stop: Stop,
    until: Instant,
    about: String,
}

static WATCHED: LazyLock<Mutex<BTreeMap<u64, Watched>>> = LazyLock::new(|| {
    thread::spawn(|| {
        loop {
            thread::sleep(Duration::from_millis(10));
            look();
        }
    });
    Mutex::default()
});

fn look() {
    let now = Instant::now();
    for Watched { stop, until, about } in WATCHED.lock().expect("it never panics").values() {
        if now > *until {
            stop.ask();
        }
        if now > *until + ENDLESS {
            eprintln!("{about}: it does not end");
            std::process::exit(1);
        }
    }
}

/// Result of the work, or `None` if it was stopped after `limit`; and how long it took.
pub fn within<T>(limit: Duration, about: &str, work: impl FnOnce() -> T) -> (Option<T>, Duration) {
    /// Ends the watch, also when the work unwinds.
    struct End(u64);
    impl Drop for End {
        fn drop(&mut self) {
            WATCHED.lock().expect("it never panics").remove(&self.0);
        }
    }
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let (number, stop, clock) = (NEXT.fetch_add(1, Ordering::Relaxed), Stop::default(), Instant::now());
    let watched = Watched { stop: stop.clone(), until: clock + limit, about: about.to_owned() };
    WATCHED.lock().expect("it never panics").insert(number, watched);
    let _end = End(number);
    let done = stop.run(work);
    (done, clock.elapsed())
}
