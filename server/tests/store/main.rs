//! What every store must hold, whatever lies beneath it: the rules of the queue, seen from outside.
mod claims;
mod curves;
mod endings;
mod events;
mod files;
mod lab;
mod recovery;
mod requests;
mod submissions;
mod sweeping;
mod tokens;
