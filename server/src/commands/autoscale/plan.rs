//! How many machines are short, and how large.
use std::time::Duration;

use loadframe_api::allocations::Backlog;

/// An allocation that has run for less than this has not had the time to take a job [s].
const STARTING: Duration = Duration::from_secs(60);
/// Work that an allocation is worth its start for [s].
const WORTH_A_START_S: f64 = 60.0;
/// What a worker takes beside its job [MB].
const BESIDE_MB: f64 = 500.0;
/// Shortest time asked for, and what is added to a job's time: estimates may be twice too low, and the
/// worker stops before the end.
const SHORTEST: Duration = Duration::from_secs(900);
const TIMES_ESTIMATE: f64 = 3.0;

/// An allocation as the batch system lists it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Allocation {
    pub(super) id: String,
    pub(super) state: String,
    pub(super) reason: Option<String>,
    /// How long it has run.
    pub(super) ran: Duration,
    pub(super) memory_mb: f64,
}

impl Allocation {
    /// Whether it will still take a job that waits now.
    fn is_coming(&self) -> bool {
        match self.state.as_str() {
            "PENDING" | "CONFIGURING" | "REQUEUED" | "REQUEUE_HOLD" | "RESV_DEL_HOLD" => true,
            "RUNNING" => self.ran < STARTING,
            _ => false,
        }
    }
}

/// Allocations of one size to ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Request {
    pub(super) count: u32,
    pub(super) memory_mb: f64,
    pub(super) time: Duration,
}

/// Memory that is asked for, for jobs that need so much [MB].
fn asked(memory_mb: f64) -> f64 {
    memory_mb + BESIDE_MB
}

/// What is to be asked for, the largest first: for every waiting job one allocation of the memory it
/// needs, less those that are coming, but no more than are worth their start by the work that waits, and
/// never more than `limit` in all.
pub(super) fn requests(
    backlog: &Backlog,
    allocations: &[Allocation],
    limit: u32,
    longest: Duration,
) -> Vec<Request> {
    let held = u32::try_from(allocations.len()).unwrap_or(u32::MAX);
    let mut room = limit.saturating_sub(held);
    let mut coming: Vec<f64> = allocations
        .iter()
        .filter(|allocation| allocation.is_coming())
        .map(|allocation| allocation.memory_mb)
        .collect();
    coming.sort_by(f64::total_cmp);
    let mut requests = Vec::new();
    for class in backlog.classes.iter().rev() {
        let memory_mb = asked(class.memory_mb);
        let worth = (class.total_wall_s / WORTH_A_START_S).ceil().max(1.0);
        let wanted = class.jobs.min(worth as u64);
        let mut short = 0;
        for _ in 0..wanted {
            // the smallest that is coming and large enough; what is larger may serve larger jobs
            let first = coming.partition_point(|coming| *coming < memory_mb);
            if first < coming.len() {
                coming.remove(first);
            } else {
                short += 1;
            }
        }
        let count = u32::try_from(short).unwrap_or(u32::MAX).min(room);
        room -= count;
        if count > 0 {
            let needed = Duration::from_secs_f64(
                (class.longest_wall_s * TIMES_ESTIMATE).min(longest.as_secs_f64()),
            );
            requests.push(Request {
                count,
                memory_mb,
                time: (SHORTEST + needed).min(longest),
            });
        }
    }
    requests
}

#[cfg(test)]
mod tests {
    use super::*;
    use loadframe_api::allocations::BacklogClass;

    const HOUR: Duration = Duration::from_secs(3600);

    fn backlog(classes: &[(f64, u64, f64)]) -> Backlog {
        let class = |(memory_mb, jobs, wall_s): &(f64, u64, f64)| BacklogClass {
            memory_mb: *memory_mb,
            jobs: *jobs,
            longest_wall_s: *wall_s,
            total_wall_s: *wall_s * *jobs as f64,
        };
        Backlog {
            waiting: classes.iter().map(|(_, jobs, _)| jobs).sum(),
            classes: classes.iter().map(class).collect(),
        }
    }

    fn allocation(state: &str, ran_s: u64, memory_mb: f64) -> Allocation {
        Allocation {
            id: "7_0".to_owned(),
            state: state.to_owned(),
            reason: None,
            ran: Duration::from_secs(ran_s),
            memory_mb,
        }
    }

    fn counts(requests: &[Request]) -> Vec<(u32, f64)> {
        let count = |request: &Request| (request.count, request.memory_mb);
        requests.iter().map(count).collect()
    }

    #[test]
    fn nothing_that_waits_asks_for_nothing() {
        assert_eq!(requests(&backlog(&[]), &[], 10, HOUR), []);
    }

    #[test]
    fn every_job_gets_one_of_its_size_up_to_the_limit_the_largest_first() {
        let backlog = backlog(&[(500.0, 5, 600.0), (4000.0, 2, 600.0)]);
        let all = requests(&backlog, &[], 10, HOUR);
        assert_eq!(counts(&all), [(2, 4500.0), (5, 1000.0)]);
        assert_eq!(
            counts(&requests(&backlog, &[], 3, HOUR)),
            [(2, 4500.0), (1, 1000.0)]
        );
        let running = [allocation("RUNNING", 500, 1000.0)];
        assert_eq!(
            counts(&requests(&backlog, &running, 3, HOUR)),
            [(2, 4500.0)]
        );
    }

    #[test]
    fn what_is_coming_is_not_asked_for_again_and_what_works_is_no_help() {
        let backlog = backlog(&[(500.0, 3, 600.0), (4000.0, 1, 600.0)]);
        let allocations = [
            allocation("PENDING", 0, 1000.0),
            allocation("RUNNING", 5, 1000.0),
            allocation("RUNNING", 500, 4500.0),
            allocation("COMPLETING", 500, 1000.0),
        ];
        // one large, and 3 less the two that are coming
        let short = requests(&backlog, &allocations, 10, HOUR);
        assert_eq!(counts(&short), [(1, 4500.0), (1, 1000.0)]);
        // a large one that is coming serves a small job when no large one waits
        let small = self::backlog(&[(500.0, 1, 600.0)]);
        let coming = [allocation("PENDING", 0, 4500.0)];
        assert_eq!(requests(&small, &coming, 10, HOUR), []);
    }

    #[test]
    fn a_thousand_jobs_of_a_second_are_not_worth_a_thousand_starts() {
        // 1000 s of work in pieces of a minute: 16.7
        let short = requests(&backlog(&[(500.0, 1000, 1.0)]), &[], 100, HOUR);
        assert_eq!(counts(&short), [(17, 1000.0)]);
    }

    #[test]
    fn the_time_is_three_times_the_longest_estimate_and_what_starting_takes() {
        let time =
            |wall_s, longest| requests(&backlog(&[(500.0, 1, wall_s)]), &[], 1, longest)[0].time;
        // 900 + 3 × 300
        assert_eq!(time(300.0, HOUR), Duration::from_secs(1800));
        assert_eq!(time(1e9, HOUR), HOUR);
        assert_eq!(
            time(300.0, Duration::from_secs(60)),
            Duration::from_secs(60)
        );
    }
}
