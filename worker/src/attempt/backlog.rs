//! What a run has given and nobody could take yet.
//!
//! While the server answers, a full channel makes the run wait, so that a slow server slows the run instead
//! of filling the memory. While it is away the run goes on: points gather here as plain numbers, files wait
//! on the disk anyway, and of checkpoints there is one at a time.
use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use loadframe_api::FileEntry;
use loadframe_run::SavedRun;
use tokio::sync::mpsc::Sender;
use tokio::sync::mpsc::error::TrySendError;

use super::contact::Contact;

/// Numbers of points that may wait for a server that is away: 64 MB. A run that gives more waits.
const WAITING_NUMBERS: usize = 8_000_000;
/// Points that wait are joined up to so many numbers, about as many as go into a report.
const JOINED_NUMBERS: usize = 20_000;
/// How soon a run that waits looks again.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// Something a run gave.
#[derive(Debug)]
pub(super) enum Item {
    Columns(Vec<String>),
    /// Points of the curve, one after the other in one list of numbers.
    Points(Vec<f64>),
    Log(String),
    File(FileEntry, PathBuf),
    Checkpoint(Box<SavedRun>),
}

/// The items that do not fit into the channel, in their order.
#[derive(Debug, Default)]
pub(super) struct Backlog {
    items: VecDeque<Item>,
    /// Numbers of the points among them.
    numbers: usize,
}

impl Backlog {
    /// Sends everything to `channel`, waiting for room in it; while the server is away, whatever does not
    /// fit is kept.
    pub(super) fn send(
        &mut self,
        item: Item,
        channel: &Sender<Item>,
        contact: &Contact,
    ) -> io::Result<()> {
        self.push(item);
        while !self.hand_over(channel)? {
            if contact.is_away() && self.numbers < WAITING_NUMBERS {
                return Ok(());
            }
            std::thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    /// Sends everything to `channel`, waiting for room in it however long that takes.
    pub(super) fn finish(&mut self, channel: &Sender<Item>) -> io::Result<()> {
        while !self.hand_over(channel)? {
            std::thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    fn push(&mut self, item: Item) {
        if let Item::Points(new) = &item {
            self.numbers += new.len();
            if let Some(Item::Points(last)) = self.items.back_mut()
                && last.len() < JOINED_NUMBERS
            {
                last.extend_from_slice(new);
                return;
            }
        }
        self.items.push_back(item);
    }

    /// Sends what there is room for; whether that was all.
    fn hand_over(&mut self, channel: &Sender<Item>) -> io::Result<bool> {
        while let Some(item) = self.items.pop_front() {
            let numbers = match &item {
                Item::Points(numbers) => numbers.len(),
                _ => 0,
            };
            match channel.try_send(item) {
                Ok(()) => self.numbers -= numbers,
                Err(TrySendError::Full(item)) => {
                    self.items.push_front(item);
                    return Ok(false);
                }
                Err(TrySendError::Closed(_)) => {
                    let text = "the server takes no more results of this run";
                    return Err(io::Error::other(text));
                }
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use tokio::sync::mpsc::{Receiver, channel};

    const HOUR: Duration = Duration::from_secs(3600);

    fn numbers(waiting: &mut Receiver<Item>) -> Vec<f64> {
        let mut all = Vec::new();
        while let Ok(item) = waiting.try_recv() {
            match item {
                Item::Points(numbers) => all.extend(numbers),
                Item::Log(line) => all.push(line.parse().expect("a number")),
                item => panic!("{item:?}"),
            }
        }
        all
    }

    #[test]
    fn a_run_goes_on_while_the_server_is_away_and_everything_comes_in_order() {
        let contact = Contact::lasting(HOUR);
        contact.note(false);
        let (send, mut waiting) = channel(2);
        let mut backlog = Backlog::default();
        for index in 0..1000 {
            let item = match index % 100 {
                99 => Item::Log(index.to_string()),
                _ => Item::Points(vec![f64::from(index)]),
            };
            backlog.send(item, &send, &contact).expect("kept");
        }
        // 2 in the channel; of the other 998 all points between two log lines are joined
        assert_eq!((backlog.items.len(), backlog.numbers), (20, 988));
        let finished = std::thread::spawn(move || backlog.finish(&send).map(|()| backlog.numbers));
        let mut all = Vec::new();
        while all.len() < 1000 {
            all.extend(numbers(&mut waiting));
        }
        assert_eq!(all, (0..1000).map(f64::from).collect::<Vec<f64>>());
        assert_eq!(finished.join().expect("no panic").expect("all sent"), 0);
    }

    #[test]
    fn a_run_waits_for_a_server_that_is_there() {
        let contact = Contact::lasting(HOUR);
        let (send, mut waiting) = channel(1);
        let run = std::thread::spawn({
            let contact = Arc::clone(&contact);
            move || {
                let mut backlog = Backlog::default();
                for index in 0..3 {
                    let item = Item::Points(vec![f64::from(index)]);
                    backlog.send(item, &send, &contact).expect("sent");
                }
                backlog.items.len()
            }
        });
        let mut all = Vec::new();
        while all.len() < 3 {
            all.extend(numbers(&mut waiting));
        }
        assert_eq!(
            (all, run.join().expect("no panic")),
            (vec![0.0, 1.0, 2.0], 0)
        );
    }

    #[test]
    fn a_run_that_is_given_up_hears_so() {
        let (send, waiting) = channel(1);
        drop(waiting);
        let contact = Contact::lasting(HOUR);
        let sent = Backlog::default().send(Item::Points(vec![0.0]), &send, &contact);
        assert!(sent.is_err());
    }
}
