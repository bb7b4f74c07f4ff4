//! HTTP and WebSocket on the loopback interface.
//!
//! Only who has the link gets in: it holds a random token, and the host and the origin of a request
//! must be those of this server, so that no page from elsewhere can ask it anything. Nothing is
//! written. Sizes, rates, the number of pages and the time that the head of a request may take are
//! bounded.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::ws::{CloseFrame, Message, WebSocket, WebSocketUpgrade};
use axum::extract::{RawQuery, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use serde_json::Value;
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::sync::watch;

use super::message::{Ask, Tell};
use super::page;
use super::scene::LiveScene;
use super::session::{Gone, Session};
use super::verdict::Judge;
use cohaul::stop::Stop;
use cohaul_report::json;

/// Bytes of a message at most: a scene with thousands of waypoints.
const LONGEST_MESSAGE: usize = 4 << 20;
const MOST_PAGES: usize = 16;
/// Messages of a page in a second, on the mean of some seconds: a hand moves 60 times a second.
const MOST_MESSAGES_A_SECOND: f64 = 300.0;
const MOST_AT_ONCE: f64 = 900.0;
/// Messages of a page that make no sense at most.
const MOST_MALFORMED: usize = 100;
/// Messages of a page at most that wait for its runs.
const MOST_WAITING: usize = 10_000;
/// Time after which messages that wait are offered to the runs again.
const AGAIN: Duration = Duration::from_millis(2);
/// Time that the head of a request may take: browsers send it at once.
const LONGEST_HEAD: Duration = Duration::from_secs(5);
/// Time that a page has to hear why it is closed.
const FAREWELL: Duration = Duration::from_millis(500);
/// Port that is taken if it is free, so that a browser finds again what it has kept of a page.
const USUAL_PORT: u16 = 7329;

/// Why a page is closed: code of the WebSocket and reason.
type Farewell = (u16, &'static str);
const ENDED: Farewell = (1001, "the server has ended");
const FAILED: Farewell = (1011, "its runs have failed");

/// Of a page that broke the rules.
fn broke(rule: &'static str) -> Farewell {
    (1008, rule)
}

#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    #[error("--port: must be a free port of 127.0.0.1, found {port}: {source}")]
    Port { port: u16, source: std::io::Error },
    #[error("the page cannot be served: {0}")]
    System(std::io::Error),
    #[error("no random numbers from the system: {0}")]
    Token(getrandom::Error),
}

pub struct Server {
    listener: TcpListener,
    shared: Arc<Shared>,
    end: watch::Sender<bool>,
}

struct Shared {
    token: String,
    port: u16,
    scene: LiveScene,
    n_pages: AtomicUsize,
    /// Held by the one comparison that runs.
    turn: Arc<Mutex<()>>,
    /// Whether the server ends.
    ends: watch::Receiver<bool>,
    /// The scenario that a page handed back; `None` on a server that does not wait for one.
    handed: Option<OnceLock<Value>>,
}

impl Server {
    /// A server of this scene at a port of the loopback interface, or at the usual or any free one
    /// for port 0. Whether it waits for a page to `hand_back` its scene is shown there.
    ///
    /// # Errors
    /// When the port is taken, or the system has no random numbers.
    pub fn bind(port: u16, scene: LiveScene, hand_back: bool) -> Result<Self, ServerError> {
        let at = |port| TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
        let usual = if port == 0 { at(USUAL_PORT).ok() } else { None };
        let listener = usual.map_or_else(|| at(port), Ok).map_err(|source| ServerError::Port { port, source })?;
        let port = listener.local_addr().map_err(ServerError::System)?.port();
        let mut random = [0; 16];
        getrandom::fill(&mut random).map_err(ServerError::Token)?;
        let token = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let (end, ends) = watch::channel(false);
        let shared =
            Shared { token, port, scene, n_pages: AtomicUsize::new(0), turn: Arc::default(), ends, handed: hand_back.then(OnceLock::new) };
        Ok(Self { listener, shared: Arc::new(shared), end })
    }

    pub fn link(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.shared.port, self.shared.token)
    }

    /// Serves pages as long as `goes_on` says so, or until one hands its scenario back, which is
    /// returned. All sessions end with it, and their pages hear why.
    ///
    /// # Errors
    /// When the system refuses a server.
    pub fn serve(self, goes_on: impl Fn() -> bool) -> Result<Option<Value>, ServerError> {
        self.listener.set_nonblocking(true).map_err(ServerError::System)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(ServerError::System)?;
        let shared = Arc::clone(&self.shared);
        let app = Router::new().route("/", get(page)).route("/socket", get(socket)).with_state(self.shared);
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener)?;
            let stopped = async {
                while goes_on() && shared.handed().is_none() {
                    tokio::time::sleep(Duration::from_millis(50)).await;
                }
            };
            tokio::select! {
                () = accept(&listener, &app) => {}
                () = stopped => {}
            }
            let _ = self.end.send(true);
            let last = Instant::now() + FAREWELL;
            while shared.n_pages.load(Ordering::Relaxed) > 0 && Instant::now() < last {
                tokio::time::sleep(Duration::from_millis(10)).await;
            }
            Ok(shared.handed().cloned())
        });
        served.map_err(ServerError::System)
    }
}

/// Serves each connection beside the others. A connection that fails is its own affair, and so is
/// one that the system cannot accept now.
async fn accept(listener: &tokio::net::TcpListener, app: &Router) {
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(FAREWELL).await;
            continue;
        };
        let service = TowerToHyperService::new(app.clone());
        let mut serving = http1::Builder::new();
        serving.timer(TokioTimer::new()).header_read_timeout(LONGEST_HEAD);
        tokio::spawn(serving.serve_connection(TokioIo::new(stream), service).with_upgrades());
    }
}

impl Shared {
    fn handed(&self) -> Option<&Value> {
        self.handed.as_ref()?.get()
    }

    /// # Errors
    /// When the request is for another host, or without the token.
    fn check(&self, headers: &HeaderMap, query: Option<&str>) -> Result<(), Refusal> {
        let host = text(headers, header::HOST);
        if !self.hosts().iter().any(|own| Some(own.as_str()) == host) {
            return Err(Refusal(StatusCode::FORBIDDEN, "This page is served to its own address only."));
        }
        let token = query.unwrap_or_default().split('&').find_map(|part| part.strip_prefix("token=")).unwrap_or_default();
        // All bytes are compared, so that the time tells nothing of the token.
        let differs =
            token.bytes().zip(self.token.bytes()).fold(token.len() ^ self.token.len(), |so_far, (a, b)| so_far | usize::from(a ^ b));
        if differs == 0 {
            Ok(())
        } else {
            Err(Refusal(StatusCode::FORBIDDEN, "Open the whole link that `cohaul view` printed: it holds a token."))
        }
    }

    fn hosts(&self) -> [String; 2] {
        ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port))
    }
}

struct Refusal(StatusCode, &'static str);

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.0, format!("{}\n", self.1)).into_response()
    }
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

async fn page(State(shared): State<Arc<Shared>>, headers: HeaderMap, RawQuery(query): RawQuery) -> Response {
    if let Err(refusal) = shared.check(&headers, query.as_deref()) {
        return refusal.into_response();
    }
    let (html, policy) = page::html(shared.handed.is_some());
    let headers = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8".to_owned()),
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::REFERRER_POLICY, "no-referrer".to_owned()),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff".to_owned()),
        (header::CACHE_CONTROL, "no-store".to_owned()),
    ];
    (headers, html).into_response()
}

async fn socket(State(shared): State<Arc<Shared>>, headers: HeaderMap, RawQuery(query): RawQuery, upgrade: WebSocketUpgrade) -> Response {
    let origin = text(&headers, header::ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
    if !shared.hosts().iter().any(|own| Some(own.as_str()) == origin) {
        return Refusal(StatusCode::FORBIDDEN, "Only the page of this server may ask it anything.").into_response();
    }
    if let Err(refusal) = shared.check(&headers, query.as_deref()) {
        return refusal.into_response();
    }
    if shared.n_pages.fetch_add(1, Ordering::Relaxed) >= MOST_PAGES {
        shared.n_pages.fetch_sub(1, Ordering::Relaxed);
        return Refusal(StatusCode::SERVICE_UNAVAILABLE, "Too many pages are open.").into_response();
    }
    let upgrade = upgrade.max_message_size(LONGEST_MESSAGE).max_frame_size(LONGEST_MESSAGE);
    let failed = Arc::clone(&shared);
    upgrade
        .on_failed_upgrade(move |_| {
            failed.n_pages.fetch_sub(1, Ordering::Relaxed);
        })
        .on_upgrade(async move |socket| {
            serve_page(&shared, socket).await;
            shared.n_pages.fetch_sub(1, Ordering::Relaxed);
        })
}

/// A page from its opening to its end. Its runs have a thread of their own, which ends when either
/// channel does, and at once when the page is closed.
async fn serve_page(shared: &Arc<Shared>, mut socket: WebSocket) {
    let (ask, asks) = sync_channel(64);
    let (tell, mut told) = channel(8);
    let (scene, judge) = (shared.scene.clone(), Judge::new(Arc::clone(&shared.turn)));
    let (tell_page, stop) = (tell.clone(), Stop::default());
    let (of_session, of_server) = (stop.clone(), Arc::clone(shared));
    thread::spawn(move || {
        let tell = move |what: Tell| {
            if let (Tell::Handed(saved), Some(handed)) = (&what, &of_server.handed) {
                let _ = handed.set(saved.scenario.clone());
            }
            send(&tell_page, &what)
        };
        let _: Option<Result<(), Gone>> = of_session.run(|| Session::new(&scene, judge, tell).run(scene, &asks));
    });
    drop(tell);
    let mut ends = shared.ends.clone();
    let end = tokio::select! {
        end = talk(&mut socket, ask, &mut told) => end,
        _ = ends.wait_for(|ends| *ends) => Some(ENDED),
    };
    stop.ask();
    drop(told);
    let Some((code, reason)) = end else { return };
    let farewell = async {
        socket.send(Message::Close(Some(CloseFrame { code, reason: reason.into() }))).await.ok()?;
        // What the page has sent meanwhile is read, so that it hears the reason.
        while socket.recv().await?.is_ok() {}
        Some(())
    };
    let _ = tokio::time::timeout(FAREWELL, farewell).await;
}

/// Hands messages to and fro until one side ends; why, if that is not the page. The page is
/// heard also while the runs are slow to answer, so that its end ends them.
async fn talk(socket: &mut WebSocket, ask: SyncSender<Ask>, told: &mut Receiver<String>) -> Option<Farewell> {
    let (mut budget, mut last, mut n_malformed) = (MOST_AT_ONCE, Instant::now(), 0);
    let mut waiting: VecDeque<Ask> = VecDeque::new();
    loop {
        while let Some(asked) = waiting.pop_front() {
            match ask.try_send(asked) {
                Ok(()) => {}
                Err(TrySendError::Full(back)) => {
                    waiting.push_front(back);
                    break;
                }
                Err(TrySendError::Disconnected(_)) => return Some(FAILED),
            }
        }
        let message = tokio::select! {
            line = told.recv() => {
                let Some(line) = line else { return Some(FAILED) };
                socket.send(Message::Text(line.into())).await.ok()?;
                continue;
            }
            message = socket.recv() => message?.ok()?,
            () = tokio::time::sleep(AGAIN), if !waiting.is_empty() => continue,
        };
        budget = MOST_AT_ONCE.min(budget + MOST_MESSAGES_A_SECOND * last.elapsed().as_secs_f64()) - 1.0;
        last = Instant::now();
        if budget < 0.0 {
            return Some(broke("too many messages"));
        }
        let read = match &message {
            Message::Text(text) => serde_json::from_str(text.as_str()).map_err(|error| error.to_string()),
            Message::Binary(_) => Err("must be text".to_owned()),
            Message::Ping(_) | Message::Pong(_) => continue,
            Message::Close(_) => return None,
        };
        match read {
            Ok(_) if waiting.len() >= MOST_WAITING => return Some(broke("too many messages that wait for an answer")),
            Ok(asked) => waiting.push_back(asked),
            Err(why) => {
                n_malformed += 1;
                if n_malformed > MOST_MALFORMED {
                    return Some(broke("too many messages that make no sense"));
                }
                let refused = Tell::refused(format!("a message: {why}"));
                if let Ok(line) = json::line(&refused) {
                    socket.send(Message::Text(line.into())).await.ok()?;
                }
            }
        }
    }
}

/// Hands a message to the page; waits while the page has some to read.
fn send(page: &Sender<String>, what: &Tell) -> Result<(), Gone> {
    let line = json::line(what).or_else(|error| json::line(&Tell::Refused { why: error.to_string() })).map_err(|_| Gone)?;
    page.blocking_send(line).map_err(|_| Gone)
}
