//! Why a job waits: what it needs, held against every worker that is there.
use loadframe_api::{Calibration, JobKind, NeedsView, WaitCode, WaitingView};
use uuid::Uuid;

use super::Store;
use super::database::{query_as, row};
use super::encoding::{parsed, variant};
use super::error::{Result, StoreError};
use crate::queue::Refusal;
use crate::queue::needs::{Lack, Needs, Offer, core_seconds, version};

row! {
    struct WaitingRow {
        status: String,
        kind: String,
        owner_name: Option<String>,
        most_running: Option<u32>,
        running: u32,
        memory_mb: i64,
        disk_mb: i64,
        core_s: i64,
        threads: u32,
        release: u32,
    }
}

row! {
    struct WorkerRow {
        kinds: String,
        memory_mb: Option<f64>,
        disk_mb: Option<f64>,
        ends_at: Option<i64>,
        threads: u32,
        release: Option<u32>,
        bond_evaluations_per_s: Option<f64>,
        is_set_aside: bool,
    }
}

impl WorkerRow {
    fn offer(&self, now: i64) -> Result<Offer> {
        let left = self.ends_at.map(|ends_at| (ends_at - now) as f64 / 1000.0);
        let speed = self
            .bond_evaluations_per_s
            .map(|bond_evaluations_per_s| Calibration {
                bond_evaluations_per_s,
            });
        Ok(Offer {
            kinds: parsed(&self.kinds, "kinds")?,
            memory_mb: self.memory_mb,
            disk_mb: self.disk_mb,
            core_s: core_seconds(left, speed),
            threads: self.threads,
            release: self.release,
        })
    }
}

impl Store {
    /// Why a queued job does not run yet.
    ///
    /// # Errors
    /// [`StoreError::NotFound`]; [`StoreError::Conflict`] when it is not queued.
    pub async fn waiting(&self, id: Uuid) -> Result<WaitingView> {
        let now = self.now().as_millis();
        let row: Option<WaitingRow> = query_as(
            "SELECT j.status, j.kind, p.name AS owner_name, p.most_running,
                (SELECT COUNT(*) FROM attempts a JOIN jobs r ON r.seq = a.job
                 WHERE a.ended_at IS NULL AND r.owner = j.owner) AS running,
                n.memory_mb, n.disk_mb, n.core_s, n.threads, n.release
             FROM jobs j JOIN needs n ON n.id = j.needs LEFT JOIN people p ON p.id = j.owner
             WHERE j.id = ?",
        )
        .bind(id)
        .fetch_optional(self.lookups())
        .await?;
        let row = row.ok_or_else(|| StoreError::NotFound(format!("job {id}")))?;
        if row.status != "queued" {
            return Err(StoreError::Conflict(Refusal::NotQueued.to_string()));
        }
        let workers: Vec<WorkerRow> = query_as(
            "SELECT kinds, memory_mb, disk_mb, ends_at, threads, release, bond_evaluations_per_s,
                EXISTS (SELECT 1 FROM machines m WHERE m.host = w.host AND m.worker_name = w.name
                    AND m.until > ?) AS is_set_aside
             FROM workers w WHERE last_seen_at >= ?",
        )
        .bind(now)
        .bind(self.alive_since())
        .fetch_all(self.lookups())
        .await?;
        let position = self.job(id).await?.position;
        let kind = variant::<JobKind>(&row.kind)?;
        let needs = Needs {
            memory_mb: row.memory_mb,
            disk_mb: row.disk_mb,
            core_s: row.core_s,
            threads: row.threads,
            release: row.release,
        };
        let offers = workers.iter().map(|worker| worker.offer(now));
        let offers = offers.collect::<Result<Vec<Offer>>>()?;
        let fits = |offer: &&Offer| needs.lacks(kind, offer).is_empty();
        let suitable = offers.iter().filter(fits).count();
        let ready = workers.iter().zip(&offers);
        let ready = ready.filter(|(worker, offer)| !worker.is_set_aside && fits(offer));
        let (code, reason) = if suitable == 0 {
            why_none_fits(&needs, kind, &offers)
        } else if let (Some(most), Some(name)) = (row.most_running, &row.owner_name)
            && row.running >= most
        {
            let sentence = format!(
                "{} of {name}'s jobs run, and {most} may at once",
                row.running
            );
            (WaitCode::RunningLimit, sentence)
        } else if ready.count() == 0 {
            let sentence = "the machines that suit it are given no jobs after faults, for a while";
            (WaitCode::SetAside, sentence.to_owned())
        } else {
            (WaitCode::Turn, told_turn(suitable, offers.len()))
        };
        Ok(WaitingView {
            code,
            reason,
            position,
            needs: view(&needs),
            workers: count(offers.len()),
            suitable: count(suitable),
        })
    }
}

fn count(of: usize) -> u32 {
    u32::try_from(of).unwrap_or(u32::MAX)
}

fn view(needs: &Needs) -> NeedsView {
    NeedsView {
        memory_mb: needs.memory_mb as f64,
        disk_mb: needs.disk_mb as f64,
        core_s: needs.core_s as f64,
        threads: needs.threads,
        version: (needs.release > 0).then(|| version(needs.release)),
    }
}

fn told_turn(suitable: usize, all: usize) -> String {
    let who = match suitable {
        1 => "one worker that suits it is".to_owned(),
        many => format!("{many} workers that suit it are"),
    };
    let rest = match all - suitable {
        0 => String::new(),
        others => format!(" ({others} more do not)"),
    };
    format!("{who} there{rest}; it runs when its turn comes")
}

/// Why no worker is suitable: what all lack, with the most that any of them has.
fn why_none_fits(needs: &Needs, kind: JobKind, offers: &[Offer]) -> (WaitCode, String) {
    if offers.is_empty() {
        let sentence = "no worker is there; start one with `loadframe worker`";
        return (WaitCode::NoWorker, sentence.to_owned());
    }
    let lacks: Vec<Vec<Lack>> = offers.iter().map(|of| needs.lacks(kind, of)).collect();
    let order = [
        Lack::Kind,
        Lack::Release,
        Lack::Memory,
        Lack::Disk,
        Lack::Threads,
        Lack::Time,
    ];
    let mut order = order.into_iter();
    let of_all = order.find(|lack| lacks.iter().all(|lacking| lacking.contains(lack)));
    let most = |of: fn(&Offer) -> Option<f64>| offers.iter().filter_map(of).fold(0.0, f64::max);
    match of_all {
        Some(Lack::Kind) => (WaitCode::Kind, format!("no worker computes {kind}")),
        Some(Lack::Release) => {
            let newest = offers.iter().filter_map(|of| of.release).max().unwrap_or(0);
            let sentence = format!(
                "its spec is of version {}; the newest worker has version {}",
                version(needs.release),
                version(newest)
            );
            (WaitCode::Version, sentence)
        }
        Some(Lack::Memory) => (
            WaitCode::Memory,
            format!(
                "it needs {} of memory; the largest worker has {} free",
                size(needs.memory_mb as f64),
                size(most(|of| of.memory_mb))
            ),
        ),
        Some(Lack::Disk) => (
            WaitCode::Disk,
            format!(
                "it needs {} for its files; the roomiest worker has {}",
                size(needs.disk_mb as f64),
                size(most(|of| of.disk_mb))
            ),
        ),
        Some(Lack::Threads) => {
            let most = offers.iter().map(|of| of.threads).max().unwrap_or(0);
            let sentence = format!(
                "it asks for {} threads; the most that a worker has is {most}",
                needs.threads
            );
            (WaitCode::Threads, sentence)
        }
        Some(Lack::Time) => (
            WaitCode::Time,
            format!(
                "it needs {} in one go; the worker that stays longest has {} left (of a typical core)",
                span(needs.core_s as f64),
                span(most(|of| of.core_s))
            ),
        ),
        None => {
            let sentence = format!(
                "no single worker has all that it needs: {} of memory, {} for files and {} threads",
                size(needs.memory_mb as f64),
                size(needs.disk_mb as f64),
                needs.threads
            );
            (WaitCode::NoSingleWorker, sentence)
        }
    }
}

/// A size in the unit that reads best; what a machine has is rounded down, so that it never looks enough.
fn size(megabytes: f64) -> String {
    if megabytes >= 1000.0 {
        format!("{} GB", (megabytes / 100.0).floor() / 10.0)
    } else {
        format!("{:.0} MB", megabytes.floor())
    }
}

fn span(seconds: f64) -> String {
    match seconds {
        s if s >= 7200.0 => format!("{:.1} h", s / 3600.0),
        s if s >= 120.0 => format!("{:.0} min", (s / 60.0).floor()),
        s => format!("{:.0} s", s.floor()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEEDS: Needs = Needs {
        memory_mb: 14_000,
        disk_mb: 10,
        core_s: 60,
        threads: 1,
        release: 2_000,
    };

    fn offer(memory_mb: f64, threads: u32) -> Offer {
        Offer {
            kinds: JobKind::ALL.to_vec(),
            memory_mb: Some(memory_mb),
            disk_mb: None,
            core_s: None,
            threads,
            release: Some(2_000),
        }
    }

    #[test]
    fn what_all_lack_is_told_with_the_most_that_any_has() {
        let why =
            |needs: &Needs, offers: &[Offer]| why_none_fits(needs, JobKind::GranularScene, offers);
        let (code, sentence) = why(&NEEDS, &[offer(8_000.0, 1), offer(2_000.0, 8)]);
        assert_eq!(code, WaitCode::Memory);
        assert_eq!(
            sentence,
            "it needs 14 GB of memory; the largest worker has 8 GB free"
        );
        let many = Needs {
            threads: 8,
            ..NEEDS
        };
        let (code, sentence) = why(&many, &[offer(16_000.0, 4), offer(8_000.0, 8)]);
        assert_eq!(code, WaitCode::NoSingleWorker);
        assert!(sentence.contains("14 GB of memory"), "{sentence}");
        let mut old = offer(16_000.0, 1);
        old.release = Some(1_000);
        let (code, sentence) = why(&NEEDS, &[old]);
        assert_eq!(code, WaitCode::Version);
        assert_eq!(
            sentence,
            "its spec is of version 0.2.0; the newest worker has version 0.1.0"
        );
        let mut short = offer(16_000.0, 1);
        short.core_s = Some(59.5);
        let (code, sentence) = why(&NEEDS, &[short]);
        assert_eq!(code, WaitCode::Time);
        assert!(sentence.contains("60 s in one go") && sentence.contains("59 s left"));
        assert_eq!(why(&NEEDS, &[]).0, WaitCode::NoWorker);
    }

    #[test]
    fn sizes_and_spans_read_well_and_never_look_larger_than_they_are() {
        assert_eq!(
            [7_990.0, 980.9, 14_000.0].map(size),
            ["7.9 GB", "980 MB", "14 GB"]
        );
        assert_eq!(
            [60.0, 7_100.0, 9_000.0].map(span),
            ["60 s", "118 min", "2.5 h"]
        );
    }
}
