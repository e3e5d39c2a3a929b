//! Clients that begin and never finish, over real sockets.
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use loadframe_api::sha256_hex;
use loadframe_server::connections::{ConnectionLimits, Listening};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::time::{sleep, timeout};
use uuid::Uuid;

use crate::support::{Lab, example, request};

/// A request that a moment answers.
const ASK: &str = "GET /v1/jobs?limit=1 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
/// What slow sockets leave of others' 99th percentile at most on a machine without other work.
const LONGEST: Duration = Duration::from_millis(200);
/// What no healthy server takes, on however busy a machine.
const PATIENCE: Duration = Duration::from_secs(20);

/// Limits that a test can wait for.
fn short() -> ConnectionLimits {
    ConnectionLimits {
        head: Duration::from_millis(500),
        idle: Duration::from_millis(500),
        silence: Duration::from_millis(500),
        grace: Duration::from_secs(1),
        bytes_per_s: 1000,
        ..ConnectionLimits::with_places(64)
    }
}

/// Has the lab listen on a free port.
pub(crate) async fn listen(lab: &Lab, limits: ConnectionLimits) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let listening = Listening {
        listener,
        app: lab.router.clone(),
        tls: None,
        limits,
        stopping: lab.state.stopping.clone(),
    };
    tokio::spawn(listening.serve());
    address
}

/// A connection on which `text` has been sent.
async fn say(address: SocketAddr, text: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.expect("a connection");
    stream.write_all(text.as_bytes()).await.expect("sent");
    stream
}

/// The same with a socket that holds little of what comes.
async fn say_and_take_little(address: SocketAddr, text: &str) -> TcpStream {
    let socket = TcpSocket::new_v4().expect("a socket");
    socket.set_recv_buffer_size(4096).expect("a small one");
    let mut stream = socket.connect(address).await.expect("a connection");
    stream.write_all(text.as_bytes()).await.expect("sent");
    stream
}

/// All that comes until the server ends the connection.
async fn rest(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    let end = timeout(PATIENCE, stream.read_to_end(&mut bytes)).await;
    // a reset is an end as well
    let _ = end.expect("the server ends the connection");
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Asks on a connection of its own; how long the whole answer took.
async fn ask(address: SocketAddr) -> Duration {
    let start = Instant::now();
    let mut stream = say(address, ASK).await;
    let answer = rest(&mut stream).await;
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer:?}");
    start.elapsed()
}

fn post(headers: &str, body: &str) -> String {
    format!(
        "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n{headers}\r\n\r\n{body}"
    )
}

#[tokio::test(flavor = "multi_thread")]
async fn whoever_begins_and_leaves_makes_room_for_others() {
    let lab = Lab::open().await;
    let limits = ConnectionLimits {
        head: PATIENCE,
        silence: PATIENCE,
        grace: PATIENCE,
        ..short()
    };
    let address = listen(&lab, limits).await;
    let beginnings = [
        String::new(),
        "GET /v1/jobs HT".to_owned(),
        post("Content-Length: 40000", "{"),
        post("Transfer-Encoding: chunked", "1\r\n{\r\n"),
    ];
    // ten times as many as one address has places, all of which would be held for long
    let mut held = Vec::new();
    for number in 0..320 {
        let beginning = &beginnings[number % beginnings.len()];
        held.push(say(address, beginning).await);
        if number % 40 == 39 {
            ask(address).await;
        }
    }
    // the first was ended for them, and the last was not
    assert_eq!(rest(&mut held[0]).await, "");
    let last = held.last_mut().expect("many");
    let silent = timeout(Duration::from_millis(100), last.read_u8()).await;
    assert!(silent.is_err(), "{silent:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn heads_and_pauses_between_requests_end_in_time_however_they_drip() {
    let lab = Lab::open().await;
    let address = listen(&lab, short()).await;
    let mut nothing = say(address, "").await;
    assert_eq!(rest(&mut nothing).await, "");
    let start = Instant::now();
    let mut dripping = say(address, "GET / HTTP/1.1\r\n").await;
    let is_ended = async {
        while dripping.write_all(b"X: y\r\n").await.is_ok() {
            sleep(Duration::from_millis(50)).await;
        }
    };
    timeout(PATIENCE, is_ended).await.expect("it is ended");
    assert!(start.elapsed() >= Duration::from_millis(500));
    let mut idle = say(address, &ASK.replace("close", "keep-alive")).await;
    assert!(rest(&mut idle).await.starts_with("HTTP/1.1 200"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_body_that_stalls_or_drips_is_told_that_it_is_too_slow() {
    let lab = Lab::open().await;
    let address = listen(&lab, short()).await;
    let mut stalled = say(address, &post("Transfer-Encoding: chunked", "1\r\n{\r\n")).await;
    let answer = rest(&mut stalled).await;
    assert!(answer.starts_with("HTTP/1.1 408"), "{answer:?}");
    assert!(answer.contains("/problems/too-slow"), "{answer:?}");

    let mut dripping = say(address, &post("Content-Length: 40000", "{")).await;
    let (mut reading, mut writing) = dripping.split();
    let drip = async {
        // 20 bytes a second, where 1000 are asked
        while writing.write_all(b" ").await.is_ok() {
            sleep(Duration::from_millis(50)).await;
        }
    };
    let mut answer = vec![0; 12];
    let told = async { timeout(PATIENCE, reading.read_exact(&mut answer)).await };
    tokio::select! {
        () = drip => {}
        told = told => drop(told.expect("an answer").expect("an answer")),
    }
    assert_eq!(&answer, b"HTTP/1.1 408");

    // who is slow but keeps the pace is taken: 4 kB in pieces over more than silence and grace
    let body = format!("{}{}", example(), " ".repeat(4000));
    let length = format!("Content-Length: {}\r\nConnection: close", body.len());
    let mut steady = say(address, &post(&length, "")).await;
    for piece in body.as_bytes().chunks(body.len().div_ceil(16)) {
        sleep(Duration::from_millis(100)).await;
        steady.write_all(piece).await.expect("taken");
    }
    let answer = rest(&mut steady).await;
    assert!(answer.starts_with("HTTP/1.1 201"), "{answer:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_that_stalls_ends_and_what_has_arrived_is_not_sent_again() {
    let lab = Lab::open().await;
    lab.submit().await;
    let lease = lab.claim().await;
    let address = listen(&lab, short()).await;
    let content = "0123456789".repeat(200_000);
    let (begun, rest_of_it) = content.split_at(1_500_000);
    let sha256 = sha256_hex(content.as_bytes());
    let token = lease.token.to_string();
    let path = format!("/v1/worker/leases/{}", lease.id);
    let head = format!(
        "PUT {path}/files/a.bin?sha256={sha256} HTTP/1.1\r\nHost: localhost\r\nLoadframe-Lease-Token: {token}\r\nContent-Length: {}\r\n\r\n",
        content.len()
    );
    let mut stalled = say(address, &format!("{head}{begun}")).await;
    let answer = rest(&mut stalled).await;
    assert!(answer.starts_with("HTTP/1.1 408"), "{answer:?}");
    let token = [("loadframe-lease-token", token.as_str())];
    let part = format!("{path}/uploads/{sha256}");
    let kept = lab.get_with(&part, &token).await.json();
    assert_eq!(kept["bytes"], begun.len());
    let put = async |from: usize, body: &str| {
        let path = format!("{path}/files/a.bin?sha256={sha256}&from={from}");
        lab.send(request("PUT", &path, &token, body)).await
    };
    let stored = put(begun.len(), rest_of_it).await;
    assert_eq!(
        (stored.status, &stored.json()["bytes"]),
        (200, &content.len().into())
    );
    assert_eq!(lab.get_with(&part, &token).await.json()["bytes"], 0);
    // of what is not kept, the sender is told to ask again
    put(7, &content[7..]).await.problem(503, "busy");
}

/// Bytes that do not compress.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 1_u32;
    let noise = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    noise.take(count).collect()
}

fn archive_of(id: Uuid) -> String {
    format!(
        "GET /v1/jobs/{id}/archive.zip HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"
    )
}

/// Reads an archive to its end; its bytes.
async fn read_all(stream: &mut TcpStream) -> usize {
    let mut bytes = Vec::new();
    let read = timeout(PATIENCE, stream.read_to_end(&mut bytes)).await;
    read.expect("in time").expect("no break");
    assert!(bytes.starts_with(b"HTTP/1.1 200"));
    bytes.len()
}

#[tokio::test(flavor = "multi_thread")]
async fn forty_readers_that_do_not_read_keep_no_archive_from_others() {
    // more than sockets hold
    let noise = noise(6 << 20);
    let lab = Lab::open().await;
    let id = lab.finished(&[("noise.vtp", &noise)]).await;
    // none of the forty is ended for what it does, nor for want of places
    let limits = ConnectionLimits {
        silence: 10 * PATIENCE,
        grace: 10 * PATIENCE,
        ..ConnectionLimits::with_places(256)
    };
    let address = listen(&lab, limits).await;
    let mut readers = Vec::new();
    for _ in 0..40 {
        readers.push(say_and_take_little(address, &archive_of(id)).await);
    }
    for reader in &readers {
        let begun = timeout(PATIENCE, reader.peek(&mut [0])).await;
        assert_eq!(begun.expect("in time").expect("an answer"), 1);
    }
    for _ in 0..3 {
        let mut other = say(address, &archive_of(id)).await;
        assert!(read_all(&mut other).await > noise.len());
    }
    // they were there all the while: who reads after all, as every eighth does, gets everything
    for reader in readers.iter_mut().step_by(8) {
        assert!(read_all(reader).await > noise.len());
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn readers_that_do_not_read_are_ended() {
    // more than sockets hold
    let noise = noise(6 << 20);
    let lab = Lab::open().await;
    let id = lab.finished(&[("noise.vtp", &noise)]).await;
    let address = listen(&lab, short()).await;
    let mut readers = Vec::new();
    for _ in 0..8 {
        readers.push(say_and_take_little(address, &archive_of(id)).await);
    }
    // far longer than they may be silent
    sleep(Duration::from_secs(5)).await;
    let mut shortest = usize::MAX;
    for reader in &mut readers {
        let mut bytes = Vec::new();
        let read = timeout(PATIENCE, reader.read_to_end(&mut bytes)).await;
        let _ = read.expect("the server ended the connection");
        shortest = shortest.min(bytes.len());
    }
    assert!(shortest < noise.len(), "{shortest} bytes");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_stops_ends_what_is_idle_and_finishes_what_it_began() {
    let lab = Lab::open().await;
    let limits = ConnectionLimits {
        idle: PATIENCE,
        head: PATIENCE,
        ..short()
    };
    let address = listen(&lab, limits).await;
    let mut idle = say(address, &ASK.replace("close", "keep-alive")).await;
    let mut first = [0; 12];
    idle.read_exact(&mut first).await.expect("an answer");
    let length = format!("Content-Length: {}", example().len());
    let mut begun = say(address, &post(&length, "")).await;
    // the server has seen the head before it is told to stop
    sleep(Duration::from_millis(200)).await;
    lab.state.stopping.cancel();
    begun.write_all(example().as_bytes()).await.expect("taken");
    let answer = rest(&mut begun).await;
    assert!(answer.starts_with("HTTP/1.1 201"), "{answer:?}");
    rest(&mut idle).await;
    assert!(TcpStream::connect(address).await.is_err());
}

/// `cargo test --release -p loadframe-server --test http slow_sockets -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread")]
#[ignore = "takes half a minute and thousands of file descriptors; prints figures"]
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn two_thousand_slow_sockets_leave_others_below_200_ms() {
    let lab = Lab::open().await;
    let address = listen(&lab, ConnectionLimits::default()).await;
    let kinds = [
        ("nothing at all", String::new()),
        ("half a head", "GET /v1/jobs HT".to_owned()),
        (
            "a body without a length",
            post("Transfer-Encoding: chunked", "1\r\n{\r\n"),
        ),
        ("a body without its end", post("Content-Length: 60000", "{")),
        (
            "a large body without its end",
            post("Content-Length: 30000000", "{"),
        ),
    ];
    // on a machine that has other work, what nobody disturbs takes as long as it takes
    let mut undisturbed = Duration::ZERO;
    for (what, beginning) in &kinds {
        for count in [0, 2000, 5000] {
            let mut held = Vec::new();
            for _ in 0..count {
                held.push(say(address, beginning).await);
            }
            let mut times = Vec::new();
            for _ in 0..100 {
                times.push(ask(address).await);
            }
            times.sort();
            let (median, p99, longest) = (times[50], times[98], times[99]);
            eprintln!(
                "{count:5} sockets with {what}: median {median:.1?}, p99 {p99:.1?}, longest {longest:.1?}"
            );
            if count == 0 {
                undisturbed = p99;
            }
            assert!(p99 < LONGEST.max(2 * undisturbed));
        }
    }
}

/// `cargo test --release -p loadframe-server --test http forty_readers -- --ignored --nocapture`
#[tokio::test(flavor = "multi_thread")]
#[ignore = "writes and reads gigabytes; prints figures"]
#[allow(clippy::print_stderr, reason = "the figures are what it is for")]
async fn forty_readers_that_do_not_read_leave_others_their_archives() {
    let noise = noise(32 << 20);
    let lab = Lab::open().await;
    let id = lab.finished(&[("noise.vtp", &noise)]).await;
    let address = listen(&lab, ConnectionLimits::default()).await;
    let path = format!("/v1/jobs/{id}/archive.zip");
    for count in [0, 40, 400] {
        let mut readers = Vec::new();
        for _ in 0..count {
            let ask = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n");
            readers.push(say_and_take_little(address, &ask).await);
        }
        let mut times = Vec::new();
        for _ in 0..3 {
            let start = Instant::now();
            let answer = lab.get(&path).await;
            assert!(answer.status == 200 && answer.body.len() > noise.len());
            times.push(start.elapsed());
        }
        let asked = ask(address).await;
        eprintln!(
            "{count:3} readers that do not read: archives of 32 MB in {times:?}, a list in {asked:?}"
        );
    }
}
