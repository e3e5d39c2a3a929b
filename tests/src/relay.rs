//! A relay between a worker and its server that counts what passes and can cut the line at a
//! chosen byte. It stands in for all the places where a machine may die: the code under test knows
//! nothing of it.
use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

/// Decides on each piece that a worker sends.
type Watch = Box<dyn FnMut(&Seen<'_>) -> Cut + Send>;

/// A piece of a request on its way to the server, or the first piece of the answer.
#[derive(Debug)]
pub struct Seen<'a> {
    /// `PUT /v1/worker/leases/.../files/curve.csv?...`
    pub request: &'a str,
    /// Bytes of this request that have passed before this piece.
    pub before: u64,
    /// Bytes of this piece.
    pub bytes: u64,
    /// The answer's status, when this is the answer.
    pub status: Option<u16>,
}

/// What becomes of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    Pass,
    /// Only so many bytes pass, then the line is dead.
    After(u64),
}

/// Listens on a port of its own.
#[derive(Debug)]
pub struct Relay {
    pub url: String,
}

impl Relay {
    /// Starts a relay to `server` (`http://host:port`); `watch` sees every piece before it passes.
    pub fn start(server: &str, watch: impl FnMut(&Seen<'_>) -> Cut + Send + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let server = server.trim_start_matches("http://").to_owned();
        let watch: Arc<Mutex<Watch>> = Arc::new(Mutex::new(Box::new(watch)));
        // lives as long as the test process, as a network does
        thread::spawn(move || {
            for worker in listener.incoming().flatten() {
                if let Ok(server) = TcpStream::connect(&server) {
                    connect(worker, server, &watch);
                }
            }
        });
        Self { url }
    }
}

fn connect(worker: TcpStream, server: TcpStream, watch: &Arc<Mutex<Watch>>) {
    let request = Arc::new(Mutex::new(String::new()));
    let up = (worker.try_clone().unwrap(), server.try_clone().unwrap());
    let (watch_up, watch_down) = (Arc::clone(watch), Arc::clone(watch));
    let request_down = Arc::clone(&request);
    thread::spawn(move || {
        let mut before = 0;
        pump(&up.0, &up.1, |piece| {
            // a client waits for the answer before it sends the next request, so that a request
            // begins at the beginning of a piece
            if let Some(line) = first_line(piece, &["GET /", "PUT /", "POST /"]) {
                *request.lock().unwrap() = line.trim_end_matches(" HTTP/1.1").to_owned();
                before = 0;
            }
            let seen = Seen {
                request: &request.lock().unwrap(),
                before,
                bytes: piece.len() as u64,
                status: None,
            };
            before += seen.bytes;
            (watch_up.lock().unwrap())(&seen)
        });
    });
    thread::spawn(move || {
        pump(&server, &worker, |piece| {
            let Some(line) = first_line(piece, &["HTTP/1.1 "]) else {
                return Cut::Pass;
            };
            let status = line.split(' ').nth(1).and_then(|code| code.parse().ok());
            let seen = Seen {
                request: &request_down.lock().unwrap(),
                before: 0,
                bytes: piece.len() as u64,
                status,
            };
            (watch_down.lock().unwrap())(&seen)
        });
    });
}

/// Copies pieces from one side to the other until one of them ends or `judge` cuts the line.
fn pump(mut from: &TcpStream, mut to: &TcpStream, mut judge: impl FnMut(&[u8]) -> Cut) {
    let mut buffer = vec![0; 16 * 1024];
    while let Ok(length @ 1..) = from.read(&mut buffer) {
        let piece = &buffer[..length];
        let cut = judge(piece);
        let passing = match cut {
            Cut::Pass => length,
            Cut::After(bytes) => usize::try_from(bytes).unwrap().min(length),
        };
        if to.write_all(&piece[..passing]).is_err() || cut != Cut::Pass {
            break;
        }
    }
    let _ = from.shutdown(Shutdown::Both);
    let _ = to.shutdown(Shutdown::Both);
}

/// The first line of `piece`, if it begins in one of these ways.
fn first_line<'a>(piece: &'a [u8], beginnings: &[&str]) -> Option<&'a str> {
    if !beginnings
        .iter()
        .any(|begin| piece.starts_with(begin.as_bytes()))
    {
        return None;
    }
    let end = piece.iter().position(|byte| *byte == b'\r')?;
    std::str::from_utf8(&piece[..end]).ok()
}
