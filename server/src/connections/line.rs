//! A connection's bytes, ended when its client does not go on.
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Instant, Sleep, sleep_until};

use super::limits::ConnectionLimits;
use super::pace::Pace;
use super::standing::{Phase, Standing};

/// Bytes to and from a client.
///
/// Whoever reads or writes has to be told of every wait that is too long: an error of the kind
/// [`io::ErrorKind::TimedOut`] then ends the connection. Waiting for the server costs a client
/// nothing: a body is only waited for while it is read.
#[derive(Debug)]
pub(super) struct Line<S> {
    inner: S,
    limits: ConnectionLimits,
    standing: Arc<Standing>,
    read: Watch,
    write: Watch,
    /// The phase that `read` is of.
    phase: Phase,
}

/// One direction: since when the other side is waited for, and how long it may be.
#[derive(Debug, Default)]
struct Watch {
    pace: Pace,
    since: Option<Instant>,
    timer: Option<Pin<Box<Sleep>>>,
}

impl Watch {
    /// A wait goes on until `deadline`; `Ready` when that has passed.
    fn wait(&mut self, deadline: Instant, context: &mut Context<'_>) -> Poll<io::Error> {
        let timer = self
            .timer
            .get_or_insert_with(|| Box::pin(sleep_until(deadline)));
        if timer.deadline() != deadline {
            timer.as_mut().reset(deadline);
        }
        ready!(timer.as_mut().poll(context));
        metrics::counter!("loadframe_connections_ended_total", "cause" => "slow").increment(1);
        let sentence = "the client did not go on in time";
        Poll::Ready(io::Error::new(io::ErrorKind::TimedOut, sentence))
    }

    /// Since when it is waited, which may be now.
    fn begin(&mut self) -> Instant {
        *self.since.get_or_insert_with(Instant::now)
    }

    fn moved(&mut self, bytes: usize) {
        let waited = self
            .since
            .take()
            .map_or_else(Default::default, |since| since.elapsed());
        self.pace.moved(bytes, waited);
    }
}

impl<S> Line<S> {
    pub(super) fn new(inner: S, standing: Arc<Standing>, limits: ConnectionLimits) -> Self {
        let mut line = Self {
            inner,
            limits,
            phase: standing.phase(),
            standing,
            read: Watch::default(),
            write: Watch::default(),
        };
        line.read.begin();
        line
    }

    /// Follows the connection into the phase that it is in now.
    fn follow(&mut self) {
        let phase = self.standing.phase();
        if phase != self.phase {
            self.phase = phase;
            self.read.since = None;
            self.read.pace = Pace::default();
            if phase == Phase::Answer {
                self.write.pace = Pace::default();
            }
        }
    }

    /// Until when the client's next bytes are waited for; an answer may take as long as it takes.
    fn read_deadline(&mut self) -> Option<Instant> {
        let longest = match self.phase {
            Phase::Head => self.limits.head,
            Phase::Idle => self.limits.idle,
            Phase::Body => self.read.pace.longest_wait(&self.limits),
            Phase::Answer => return None,
        };
        Some(self.read.begin() + longest)
    }

    /// Notes that bytes came. A head is one wait from its first byte to its last.
    fn received(&mut self, bytes: usize) {
        match self.phase {
            Phase::Idle => {
                self.standing.enter(Phase::Head);
                self.follow();
                self.read.begin();
            }
            Phase::Body => {
                self.read.moved(bytes);
                self.standing.read();
            }
            Phase::Head | Phase::Answer => {}
        }
    }

    /// Judges what a write came to.
    fn written(
        &mut self,
        result: Poll<io::Result<usize>>,
        context: &mut Context<'_>,
    ) -> Poll<io::Result<usize>> {
        match result {
            Poll::Ready(Ok(bytes)) => {
                self.write.moved(bytes);
                self.standing.written();
                Poll::Ready(Ok(bytes))
            }
            Poll::Ready(Err(error)) => Poll::Ready(Err(error)),
            Poll::Pending => {
                self.standing.wait_to_write();
                let deadline = self.write.begin() + self.write.pace.longest_wait(&self.limits);
                self.write.wait(deadline, context).map(Err)
            }
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Line<S> {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let line = self.get_mut();
        line.follow();
        let before = buffer.filled().len();
        match Pin::new(&mut line.inner).poll_read(context, buffer) {
            Poll::Ready(result) => {
                line.received(buffer.filled().len() - before);
                Poll::Ready(result)
            }
            Poll::Pending => {
                let Some(deadline) = line.read_deadline() else {
                    line.standing.wake_at_end(context.waker());
                    return Poll::Pending;
                };
                line.standing.wait_to_read();
                line.read.wait(deadline, context).map(Err)
            }
        }
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Line<S> {
    fn poll_write(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let line = self.get_mut();
        line.follow();
        let result = Pin::new(&mut line.inner).poll_write(context, bytes);
        line.written(result, context)
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let line = self.get_mut();
        line.follow();
        let result = Pin::new(&mut line.inner).poll_write_vectored(context, bytes);
        line.written(result, context)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().inner).poll_flush(context)
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().inner).poll_shutdown(context)
    }
}
