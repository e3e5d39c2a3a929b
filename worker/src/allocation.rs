//! The allocation of a batch system that this process lives in, and how long it lasts.
//!
//! What it knows: the words of Slurm. What it does not know: what a worker does with the time. Its end is
//! read once: who shortens an allocation later is heard of by the batch system's SIGTERM, and who
//! lengthens it gets workers that end in time for the end before.
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Slurm counts memory in 2^20 bytes.
const MEGABYTES_A_UNIT: f64 = 1.048_576;

/// A job of a batch system.
#[derive(Clone, Debug, PartialEq)]
pub struct Allocation {
    /// What the batch system's own commands call it, such as `4711` or `4711_3`.
    pub id: String,
    /// Time until its end; `None` when it has none, or nobody says.
    pub left: Option<Duration>,
    /// Memory that it may take on this node [MB], where Slurm was told.
    pub memory_mb: Option<f64>,
}

impl Allocation {
    /// The Slurm job that this process runs in, if it does.
    pub fn of_slurm() -> Option<Self> {
        let variable = |name: &str| std::env::var(name).ok();
        Self::read(variable, time_left, SystemTime::now())
    }

    /// From variables of the environment (sbatch(1), "OUTPUT ENVIRONMENT VARIABLES"). `SLURM_JOB_END_TIME`
    /// [s since 1970] is newer than Slurm 22.05; where it is missing, `ask` is asked for what
    /// squeue(1) calls `TimeLeft` of the job with a given number.
    fn read(
        variable: impl Fn(&str) -> Option<String>,
        ask: impl Fn(&str) -> Option<String>,
        now: SystemTime,
    ) -> Option<Self> {
        let job = variable("SLURM_JOB_ID").filter(|job| !job.is_empty())?;
        let array = variable("SLURM_ARRAY_JOB_ID").zip(variable("SLURM_ARRAY_TASK_ID"));
        let end = variable("SLURM_JOB_END_TIME").and_then(|end| end.trim().parse().ok());
        let number = |name| variable(name).and_then(|text| text.trim().parse::<f64>().ok());
        // in units of 2^20 bytes; of the two there is one, by how memory was asked for
        let memory = number("SLURM_MEM_PER_NODE").or_else(|| {
            Some(number("SLURM_MEM_PER_CPU")? * number("SLURM_CPUS_ON_NODE").unwrap_or(1.0))
        });
        let id = array.map_or(job, |(array, task)| format!("{array}_{task}"));
        let left = match end.map(Duration::from_secs) {
            Some(end) => {
                let now = now.duration_since(UNIX_EPOCH).unwrap_or_default();
                Some(end.saturating_sub(now))
            }
            None => ask(&id).as_deref().and_then(duration),
        };
        Some(Self {
            id,
            left,
            memory_mb: memory
                .filter(|mb| mb.is_finite() && *mb > 0.0)
                .map(|mb| mb * MEGABYTES_A_UNIT),
        })
    }
}

/// What squeue says of a job's time; nothing where there is no squeue.
fn time_left(job: &str) -> Option<String> {
    let asked = Command::new("squeue")
        .args(["--noheader", "--jobs", job, "--Format", "TimeLeft"])
        .stdin(Stdio::null())
        .output();
    let answer = asked.ok().filter(|answer| answer.status.success())?;
    String::from_utf8(answer.stdout).ok()
}

/// A time as Slurm writes it: `days-hours:minutes:seconds`, with what is nought in front left out.
/// `None` for `UNLIMITED` and whatever else is no time.
pub fn duration(text: &str) -> Option<Duration> {
    let text = text.trim();
    let (days, clock) = text.split_once('-').unwrap_or(("0", text));
    let fields = clock.split(':').map(|field| field.parse::<u32>().ok());
    let fields: Vec<u32> = fields.collect::<Option<_>>()?;
    let seconds = match fields[..] {
        [minutes, seconds] => 60 * u64::from(minutes) + u64::from(seconds),
        [hours, minutes, seconds] => {
            3600 * u64::from(hours) + 60 * u64::from(minutes) + u64::from(seconds)
        }
        _ => return None,
    };
    let days: u32 = days.parse().ok()?;
    Some(Duration::from_secs(86_400 * u64::from(days) + seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)], squeue: Option<&str>, now: u64) -> Option<Allocation> {
        let variable = |name: &str| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        };
        let ask = |_: &str| squeue.map(str::to_owned);
        Allocation::read(variable, ask, UNIX_EPOCH + Duration::from_secs(now))
    }

    #[test]
    fn outside_slurm_there_is_no_allocation() {
        assert_eq!(read(&[], Some("1:00"), 0), None);
        assert_eq!(read(&[("SLURM_JOB_ID", "")], Some("1:00"), 0), None);
    }

    #[test]
    fn the_end_that_slurm_tells_counts_before_what_squeue_says() {
        let variables = [("SLURM_JOB_ID", "7"), ("SLURM_JOB_END_TIME", "1000")];
        let allocation = read(&variables, Some("9:00"), 400).expect("an allocation");
        assert_eq!(allocation.id, "7");
        assert_eq!(allocation.left, Some(Duration::from_secs(600)));
        // one that is over has no time left, rather than much
        let over = read(&variables, None, 2000).expect("an allocation");
        assert_eq!(over.left, Some(Duration::ZERO));
    }

    #[test]
    fn a_task_of_an_array_has_the_name_that_scancel_takes() {
        let variables = [
            ("SLURM_JOB_ID", "12"),
            ("SLURM_ARRAY_JOB_ID", "11"),
            ("SLURM_ARRAY_TASK_ID", "3"),
        ];
        let allocation = read(&variables, Some("   1-02:03:04\n"), 0).expect("an allocation");
        assert_eq!(allocation.id, "11_3");
        // 86 400 + 2 × 3600 + 3 × 60 + 4
        assert_eq!(allocation.left, Some(Duration::from_secs(93_784)));
    }

    #[test]
    fn memory_is_that_of_the_node_however_it_was_asked_for() {
        let memory = |variables: &[(&str, &str)]| {
            let variables: Vec<_> = [("SLURM_JOB_ID", "7")]
                .iter()
                .chain(variables)
                .copied()
                .collect();
            read(&variables, None, 0).expect("an allocation").memory_mb
        };
        assert_eq!(memory(&[]), None);
        // 1000 × 2^20 bytes
        assert_eq!(memory(&[("SLURM_MEM_PER_NODE", "1000")]), Some(1048.576));
        let by_core = [("SLURM_MEM_PER_CPU", "500"), ("SLURM_CPUS_ON_NODE", "2")];
        assert_eq!(memory(&by_core), Some(1048.576));
        // all of the node's
        assert_eq!(memory(&[("SLURM_MEM_PER_NODE", "0")]), None);
    }

    #[test]
    fn what_is_no_time_is_none() {
        assert_eq!(duration("5:07"), Some(Duration::from_secs(307)));
        for none in [
            "UNLIMITED",
            "INVALID",
            "",
            "5",
            "-1:00",
            "1:2:3:4",
            "NOT_SET",
        ] {
            assert_eq!(duration(none), None, "{none}");
        }
    }
}
