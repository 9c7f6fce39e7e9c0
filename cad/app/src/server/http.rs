//! HTTP: answers requests of the server's own pages on this machine, within bounds, and refuses all
//! others.

use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use http_body_util::{BodyExt, Full};
use hyper::body::{Bytes, Incoming};
use hyper::header::{HOST, HeaderValue, ORIGIN};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{HeaderMap, Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use pinswitch_switch::formats::page::PageState;
use tokio::net::TcpListener;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, SemaphorePermit, watch};
use tokio_io_timeout::TimeoutStream;

use super::configurator::Configurator;
use super::state::{State, values_after};
use crate::Answer;

/// Time after which a long poll is answered with the present state; the page then repeats it.
const LONG_POLL_TIMEOUT: Duration = Duration::from_secs(20);
/// Most long polls at once; a page has one.
const MAX_LONG_POLLS: usize = 32;
/// Most open connections; others wait in the queue of the system.
const MAX_CONNECTIONS: usize = 64;
/// Longest request line with headers, in bytes; browsers send less than 2 kB.
const MAX_HEADER_BYTES: usize = 16 * 1024;
/// Most headers of a request.
const MAX_HEADERS: usize = 64;
/// Time in which the headers of a request must arrive.
const HEADER_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest life of a connection, which carries one answer; a search or a calibration takes minutes.
const CONNECTION_TIMEOUT: Duration = Duration::from_secs(600);
/// Time in which the body of a request must arrive.
const BODY_TIMEOUT: Duration = Duration::from_secs(30);
/// Time in which a part of an answer must be taken: a browser takes it at once.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);
/// Most posted requests at once, from their bodies to the end of their answers: slow ones leave connections for pages.
const MAX_POSTS: usize = MAX_CONNECTIONS / 2;
/// Most bytes of all long bodies that arrive or are answered at once. A request beyond it is refused,
/// and can be repeated.
const MAX_ARRIVING_BYTES: usize = 128 << 20;
/// Longest body that does not count: that of a design. All connections together have few of these bytes.
const MAX_SHORT_BODY_BYTES: usize = 64 << 10;
/// Longest body of a request, in bytes. The engine refuses a table of this size and recommends the
/// command line.
const MAX_BODY_BYTES: usize = 64 << 20;
/// Paths to which the page posts requests.
const POST_PATHS: [&str; 2] = ["/answer", "/save"];

/// Everything from which requests are answered.
#[derive(Debug)]
struct Site {
    states: watch::Receiver<State>,
    long_polls: Semaphore,
    /// Posted requests that may still be open at once.
    posts: Arc<Semaphore>,
    /// Bytes that long bodies may still have.
    arriving_bytes: Semaphore,
    address: SocketAddr,
    policy: String,
    configurator: Arc<Configurator>,
}

/// The permit of the posted request of a connection.
type HeldPermit = Mutex<Option<OwnedSemaphorePermit>>;

/// Why the body of a request is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodyError {
    /// It is longer than [`MAX_BODY_BYTES`].
    TooLong,
    /// Other bodies have [`MAX_ARRIVING_BYTES`].
    Busy,
    /// The connection ended.
    Ended,
}

/// Answers requests until the process ends.
pub(super) async fn serve(
    listener: TcpListener,
    address: SocketAddr,
    states: watch::Receiver<State>,
    configurator: Configurator,
) {
    let site = Arc::new(Site {
        states,
        long_polls: Semaphore::new(MAX_LONG_POLLS),
        posts: Arc::new(Semaphore::new(MAX_POSTS)),
        arriving_bytes: Semaphore::new(MAX_ARRIVING_BYTES),
        address,
        policy: PageState::Served.policy(),
        configurator: Arc::new(configurator),
    });
    let connections = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    while let Ok(permit) = Arc::clone(&connections).acquire_owned().await {
        let Ok((stream, _)) = listener.accept().await else {
            // Usually no file descriptor is free; some will be when connections end.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let site = Arc::clone(&site);
        tokio::spawn(async move {
            // The connection has the permit of its request until the answer is taken.
            let post = Arc::new(Mutex::new(None));
            let service = service_fn(move |request| {
                let (site, post) = (Arc::clone(&site), Arc::clone(&post));
                async move { Ok::<_, Infallible>(site.answer(request, &post).await) }
            });
            let mut stream = TimeoutStream::new(stream);
            stream.set_write_timeout(Some(WRITE_TIMEOUT));
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEADER_TIMEOUT)
                .max_buf_size(MAX_HEADER_BYTES)
                .max_headers(MAX_HEADERS)
                .keep_alive(false)
                .serve_connection(TokioIo::new(Box::pin(stream)), service);
            // A connection that is closed or too slow ends here.
            let _ = tokio::time::timeout(CONNECTION_TIMEOUT, connection).await;
            drop(permit);
        });
    }
}

impl Site {
    async fn answer(&self, request: Request<Incoming>, post: &HeldPermit) -> Response<Full<Bytes>> {
        let path = request.uri().path().to_owned();
        if let Some((status, reason)) = refusal(request.method(), &path, request.headers(), self.address) {
            return self.response(status, "text/plain; charset=utf-8", reason);
        }
        let query = request.uri().query().unwrap_or_default();
        let known = query.strip_prefix("after=").unwrap_or_default();
        match path.as_str() {
            "/" => self.response(StatusCode::OK, "text/html; charset=utf-8", PageState::Served.html()),
            "/start" => {
                let Ok(_permit) = self.long_polls.try_acquire() else {
                    return self.response(
                        StatusCode::SERVICE_UNAVAILABLE,
                        "text/plain",
                        "too many pages are open",
                    );
                };
                let states = self.states.clone();
                let source = self.configurator.source_json();
                let state = values_after(states, known, LONG_POLL_TIMEOUT, &source).await;
                self.response(StatusCode::OK, "application/json", state)
            }
            path if POST_PATHS.contains(&path) => self.answer_post(request.into_body(), path, post).await,
            _ => self.response(StatusCode::NOT_FOUND, "text/plain", "page not found"),
        }
    }

    /// Answers a request of the configurator.
    async fn answer_post(&self, body: Incoming, path: &str, post: &HeldPermit) -> Response<Full<Bytes>> {
        let arrived = match Arc::clone(&self.posts).try_acquire_owned() {
            Ok(permit) => {
                if let Ok(mut held) = post.lock() {
                    *held = Some(permit);
                }
                tokio::time::timeout(BODY_TIMEOUT, self.body(body)).await
            }
            Err(_) => Ok(Err(BodyError::Busy)),
        };
        let (status, reason) = match arrived {
            // The permits are returned after the answer.
            Ok(Ok((request, _permits))) => {
                let configurator = Arc::clone(&self.configurator);
                let answer = match path {
                    "/save" => Answer::Json(configurator.save(request).await),
                    _ => configurator.answer(request).await,
                };
                return match answer {
                    Answer::Json(text) => self.response(StatusCode::OK, "application/json", text),
                    Answer::Bytes(bytes) => self.response(StatusCode::OK, "application/octet-stream", bytes),
                };
            }
            Ok(Err(BodyError::TooLong)) => {
                let reason = format!("the request is larger than {} MB", MAX_BODY_BYTES >> 20);
                (StatusCode::PAYLOAD_TOO_LARGE, reason)
            }
            Ok(Err(BodyError::Busy)) => {
                let reason = "other requests are being answered: repeat it later".to_owned();
                (StatusCode::SERVICE_UNAVAILABLE, reason)
            }
            Ok(Err(BodyError::Ended)) => (StatusCode::BAD_REQUEST, "the request ended early".to_owned()),
            Err(_) => {
                let reason = format!("the request did not arrive within {} s", BODY_TIMEOUT.as_secs());
                (StatusCode::REQUEST_TIMEOUT, reason)
            }
        };
        self.response(status, "text/plain", reason)
    }

    /// Collects the body of a request, with permits for its bytes if it is long. Bytes without a
    /// permit are dropped.
    async fn body(&self, mut body: Incoming) -> Result<(Bytes, Option<SemaphorePermit<'_>>), BodyError> {
        let (mut bytes, mut permits) = (Vec::new(), None::<SemaphorePermit<'_>>);
        while let Some(frame) = body.frame().await {
            let Ok(chunk) = frame.map_err(|_| BodyError::Ended)?.into_data() else { continue };
            let length = bytes.len() + chunk.len();
            if length > MAX_BODY_BYTES {
                return Err(BodyError::TooLong);
            }
            let held = permits.as_ref().map_or(0, SemaphorePermit::num_permits);
            // Vectors grow by doubling: what is counted is what is reserved.
            if length > bytes.capacity() {
                let reserved = length.next_power_of_two();
                if reserved > MAX_SHORT_BODY_BYTES {
                    let more = u32::try_from(reserved - held).map_err(|_| BodyError::TooLong)?;
                    let more = self.arriving_bytes.try_acquire_many(more).map_err(|_| BodyError::Busy)?;
                    match &mut permits {
                        Some(permits) => permits.merge(more),
                        None => permits = Some(more),
                    }
                }
                bytes.reserve_exact(reserved - bytes.len());
            }
            bytes.extend_from_slice(&chunk);
        }
        Ok((bytes.into(), permits))
    }

    fn response(&self, status: StatusCode, kind: &str, content: impl Into<Bytes>) -> Response<Full<Bytes>> {
        let mut response = Response::new(Full::new(content.into()));
        *response.status_mut() = status;
        let headers = response.headers_mut();
        for (name, value) in [
            ("content-type", kind),
            ("content-security-policy", &self.policy),
            ("x-content-type-options", "nosniff"),
            ("x-frame-options", "DENY"),
            ("cross-origin-resource-policy", "same-origin"),
            ("referrer-policy", "no-referrer"),
            ("cache-control", "no-store"),
        ] {
            if let Ok(value) = HeaderValue::from_str(value) {
                headers.insert(name, value);
            }
        }
        if status == StatusCode::METHOD_NOT_ALLOWED {
            headers.insert("allow", HeaderValue::from_static("GET, HEAD"));
        }
        response
    }
}

/// Returns why a request is refused: it would change something, or comes from another site's page.
/// `Host` shows a name that was bound to this address (DNS rebinding), `Origin` another page.
fn refusal(
    method: &Method,
    path: &str,
    headers: &HeaderMap,
    address: SocketAddr,
) -> Option<(StatusCode, &'static str)> {
    let is_post = *method == Method::POST && POST_PATHS.contains(&path);
    // Browsers send Origin with every POST.
    if is_post && !headers.contains_key(ORIGIN) {
        return Some((
            StatusCode::FORBIDDEN,
            "missing Origin: the request is not from a page of this server",
        ));
    }
    if !is_post && (!matches!(*method, Method::GET | Method::HEAD) || POST_PATHS.contains(&path)) {
        return Some((StatusCode::METHOD_NOT_ALLOWED, "only GET and HEAD are allowed"));
    }
    let mut hosts = headers.get_all(HOST).iter();
    let is_host = |host: &HeaderValue| host.to_str().is_ok_and(|host| is_own(host, address));
    if !matches!((hosts.next(), hosts.next()), (Some(host), None) if is_host(host)) {
        return Some((StatusCode::FORBIDDEN, "Host is not this machine: open the address that view printed"));
    }
    let is_origin = |origin: &HeaderValue| {
        origin.to_str().is_ok_and(|o| o.strip_prefix("http://").is_some_and(|host| is_own(host, address)))
    };
    let is_foreign = headers.get("sec-fetch-site").is_some_and(|site| site == "cross-site");
    let navigates = headers.get("sec-fetch-mode").is_some_and(|mode| mode == "navigate");
    if !headers.get_all(ORIGIN).iter().all(is_origin) || (is_foreign && !navigates) {
        return Some((StatusCode::FORBIDDEN, "Origin is another page: open the address that view printed"));
    }
    None
}

/// Whether `host` names this server: a loopback name with the port, or the address on which it
/// listens.
fn is_own(host: &str, address: SocketAddr) -> bool {
    let port = address.port();
    let is_loopback = ["localhost", "127.0.0.1", "[::1]"].iter().any(|name| {
        host.eq_ignore_ascii_case(&format!("{name}:{port}"))
            || (port == 80 && host.eq_ignore_ascii_case(name))
    });
    is_loopback || host == address.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(method: Method, headers: &[(&'static str, &'static str)]) -> Option<u16> {
        let headers = headers
            .iter()
            .map(|(name, value)| (name.parse().unwrap(), HeaderValue::from_static(value)))
            .collect();
        status_at("/", method, &headers)
    }

    fn status_at(path: &str, method: Method, headers: &HeaderMap) -> Option<u16> {
        refusal(&method, path, headers, SocketAddr::from(([127, 0, 0, 1], 8737)))
            .map(|(status, _)| status.as_u16())
    }

    #[test]
    fn other_hosts_are_refused() {
        for own in ["127.0.0.1:8737", "localhost:8737", "LocalHost:8737", "[::1]:8737"] {
            assert_eq!(status(Method::GET, &[("host", own)]), None, "{own}");
            assert_eq!(status(Method::HEAD, &[("host", own)]), None, "{own}");
        }
        for foreign in ["evil.example:8737", "127.0.0.1:1", "127.0.0.1", "localhost.evil.example:8737", ""] {
            assert_eq!(status(Method::GET, &[("host", foreign)]), Some(403), "{foreign}");
        }
        assert_eq!(status(Method::GET, &[]), Some(403));
        assert_eq!(status(Method::GET, &[("host", "localhost:8737"), ("host", "evil.example")]), Some(403));
    }

    #[test]
    fn other_origins_are_refused() {
        let host = ("host", "127.0.0.1:8737");
        assert_eq!(status(Method::GET, &[host, ("origin", "http://127.0.0.1:8737")]), None);
        for foreign in ["http://evil.example", "null", "https://127.0.0.1:8737", "http://127.0.0.1:1"] {
            assert_eq!(status(Method::GET, &[host, ("origin", foreign)]), Some(403), "{foreign}");
        }
        assert_eq!(status(Method::GET, &[host, ("sec-fetch-site", "cross-site")]), Some(403));
        // A link on another page.
        let link = [host, ("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "navigate")];
        assert_eq!(status(Method::GET, &link), None);
    }

    #[test]
    fn posts_need_their_own_origin() {
        let headers = |origin: Option<&'static str>| {
            let mut headers = HeaderMap::new();
            headers.insert("host", HeaderValue::from_static("127.0.0.1:8737"));
            headers.extend(origin.map(|o| (ORIGIN, HeaderValue::from_static(o))));
            headers
        };
        let own = headers(Some("http://127.0.0.1:8737"));
        for path in POST_PATHS {
            assert_eq!(status_at(path, Method::POST, &own), None);
            assert_eq!(status_at(path, Method::GET, &own), Some(405));
            assert_eq!(status_at(path, Method::POST, &headers(None)), Some(403));
            for foreign in ["http://evil.example", "null", "http://127.0.0.1:1"] {
                assert_eq!(status_at(path, Method::POST, &headers(Some(foreign))), Some(403), "{foreign}");
            }
        }
        assert_eq!(status_at("/start", Method::POST, &own), Some(405));
    }

    #[test]
    fn other_methods_are_refused() {
        for method in
            [Method::POST, Method::PUT, Method::DELETE, Method::TRACE, Method::OPTIONS, Method::CONNECT]
        {
            assert_eq!(status(method, &[("host", "127.0.0.1:8737")]), Some(405));
        }
    }
}
