//! The commands of Slurm: what is said to them, and how their answers are read.
use std::io::Write;
use std::process::{Command, Stdio};
use std::time::Duration;

use loadframe_worker::duration;

use super::plan::{Allocation, Request};

/// Slurm counts memory in 2^20 bytes.
const BYTES_A_UNIT: f64 = 1_048_576.0;
const BYTES_A_MB: f64 = 1e6;
/// A worker ends when no job came for so long [s].
const EXIT_WHEN_IDLE: &str = "60";
/// A worker told to stop has so long [s], within the 30 s of Slurm's KillWait.
const GRACE: &str = "25";
/// The warning before the end, should the worker not know its time. Slurm may send it a minute earlier still
/// (sbatch(1), `--signal`), so a short allocation goes without.
const SIGNAL: &str = "B:USR1@60";
const SHORTEST_WITH_SIGNAL: Duration = Duration::from_secs(600);

/// What is the same in all arrays that are submitted.
#[derive(Clone, Debug)]
pub(super) struct Submission {
    pub(super) job_name: String,
    pub(super) partition: Option<String>,
    pub(super) account: Option<String>,
    pub(super) threads: u16,
    pub(super) output: String,
    /// Further options for sbatch.
    pub(super) further: Vec<String>,
    /// What runs a worker, in words of a shell.
    pub(super) program: String,
    /// Options for workers.
    pub(super) worker: Vec<String>,
}

impl Submission {
    /// Options of sbatch, see sbatch(1).
    fn options(&self, request: &Request) -> Vec<String> {
        let memory = (request.memory_mb * BYTES_A_MB / BYTES_A_UNIT).ceil();
        let minutes = request.time.as_secs().div_ceil(60);
        let mut options = vec![
            "--parsable".to_owned(),
            format!("--job-name={}", self.job_name),
            format!("--array=0-{}", request.count.saturating_sub(1)),
        ];
        options.extend(
            self.partition
                .iter()
                .map(|name| format!("--partition={name}")),
        );
        options.extend(self.account.iter().map(|name| format!("--account={name}")));
        options.extend([
            "--ntasks=1".to_owned(),
            format!("--cpus-per-task={}", self.threads),
            format!("--mem={memory}M"),
            format!("--time={minutes}"),
            // a node that goes down gives its jobs back at the server; the allocation may begin again
            "--requeue".to_owned(),
            format!("--output={}", self.output),
            "--open-mode=append".to_owned(),
        ]);
        if request.time >= SHORTEST_WITH_SIGNAL {
            options.push(format!("--signal={SIGNAL}"));
        }
        options.extend(self.further.iter().cloned());
        options
    }

    /// What runs on the node. The worker takes the place of the shell, so that signals reach it.
    fn script(&self) -> String {
        let fixed = ["--exit-when-idle", EXIT_WHEN_IDLE, "--grace", GRACE];
        let options = fixed
            .into_iter()
            .chain(self.worker.iter().map(String::as_str));
        let options: Vec<String> = options.map(quoted).collect();
        format!(
            "#!/bin/sh\nexec {} worker {}\n",
            self.program,
            options.join(" ")
        )
    }

    /// The line for a shell that does the same as [`Self::submit`].
    pub(super) fn shown(&self, request: &Request) -> String {
        let options: Vec<String> = self
            .options(request)
            .iter()
            .map(|word| quoted(word))
            .collect();
        format!("sbatch {} <<'END'\n{}END", options.join(" "), self.script())
    }

    /// Submits; the number of the array.
    ///
    /// # Errors
    /// What sbatch said.
    pub(super) fn submit(&self, request: &Request) -> Result<String, String> {
        let mut command = Command::new("sbatch");
        command.args(self.options(request));
        let answer = answer(command, &self.script())?;
        // with clusters, `id;cluster`
        let id = answer.trim().split(';').next().unwrap_or_default();
        match id.is_empty() {
            true => Err("sbatch did not say the number of the job".to_owned()),
            false => Ok(id.to_owned()),
        }
    }
}

/// This user's allocations of a name that have not ended.
///
/// # Errors
/// What squeue said.
pub(super) fn allocations(job_name: &str) -> Result<Vec<Allocation>, String> {
    let mut command = Command::new("squeue");
    command.args(["--me", "--array", "--noheader", "--noconvert"]);
    command.args(["--name", job_name, "--format", "%i|%T|%M|%m|%r"]);
    let text = answer(command, "")?;
    text.lines().map(allocation).collect()
}

/// A line of squeue: number, state, time it has run, memory, reason.
fn allocation(line: &str) -> Result<Allocation, String> {
    let mut fields = line.splitn(5, '|').map(str::trim);
    let mut field = || {
        let text = fields.next().map(str::to_owned);
        text.ok_or_else(|| format!("squeue says {line:?}, which has too few fields"))
    };
    let (id, state, ran, memory, reason) = (field()?, field()?, field()?, field()?, field()?);
    Ok(Allocation {
        id,
        state,
        reason: Some(reason).filter(|reason| !matches!(reason.as_str(), "" | "None")),
        ran: duration(&ran).unwrap_or(Duration::ZERO),
        memory_mb: memory_mb(&memory)
            .ok_or_else(|| format!("squeue says {memory:?} where memory should be"))?,
    })
}

/// `1024M` and its like, of a node. `None` for what is no memory.
fn memory_mb(text: &str) -> Option<f64> {
    let text = text.trim_end_matches(['c', 'n']);
    let digits = text.trim_end_matches(['K', 'M', 'G', 'T']);
    let units = match &text[digits.len()..] {
        "K" => 1.0 / 1024.0,
        "" | "M" => 1.0,
        "G" => 1024.0,
        "T" => 1024.0 * 1024.0,
        _ => return None,
    };
    let number: f64 = digits.parse().ok()?;
    let memory = number * units * BYTES_A_UNIT / BYTES_A_MB;
    // "inf" and "nan" are numbers to the parser
    (memory.is_finite() && memory >= 0.0).then_some(memory)
}

/// Runs a command that gets `input`; what it answers, or what it says against it.
fn answer(mut command: Command, input: &str) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let failed = |error: std::io::Error| format!("{name}: {error}");
    let piped = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().map_err(failed)?;
    if let Some(mut stdin) = child.stdin.take() {
        // who does not read it says why below
        let _ = stdin.write_all(input.as_bytes());
    }
    let output = child.wait_with_output().map_err(failed)?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    match output.status.success() {
        true => Ok(text(&output.stdout)),
        false => {
            let said = text(&output.stderr).replace('\n', "; ");
            Err(match said.is_empty() {
                true => format!("{name} ended with {}", output.status),
                false => said,
            })
        }
    }
}

/// A word of a shell that stands for `text`.
pub(super) fn quoted(text: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_=./:@%+,".contains(&byte);
    match !text.is_empty() && text.bytes().all(is_plain) {
        true => text.to_owned(),
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn submission() -> Submission {
        Submission {
            job_name: "loadframe".to_owned(),
            partition: Some("long".to_owned()),
            account: None,
            threads: 2,
            output: "a b-%A.log".to_owned(),
            further: vec!["--qos=low".to_owned()],
            program: "/opt/loadframe".to_owned(),
            worker: vec!["--server".to_owned(), "https://lab".to_owned()],
        }
    }

    #[test]
    fn the_line_that_is_shown_is_the_one_that_is_submitted() {
        let request = Request {
            count: 3,
            memory_mb: 1000.0,
            time: Duration::from_secs(3601),
        };
        // 1000 × 10^6 / 2^20 = 953.7; 3601 s are 61 begun minutes
        let line = "sbatch --parsable --job-name=loadframe --array=0-2 --partition=long --ntasks=1 \
            --cpus-per-task=2 --mem=954M --time=61 --requeue \
            '--output=a b-%A.log' --open-mode=append --signal=B:USR1@60 --qos=low <<'END'\n#!/bin/sh\n\
            exec /opt/loadframe worker --exit-when-idle 60 --grace 25 --server https://lab\nEND";
        assert_eq!(submission().shown(&request), line);
        let short = Request {
            time: Duration::from_secs(120),
            ..request
        };
        assert!(!submission().shown(&short).contains("--signal"));
    }

    #[test]
    fn lines_of_squeue_are_read_and_others_refused() {
        let read = allocation("12_3|PENDING|0:00|954M|Priority").expect("a line");
        assert_eq!((read.id.as_str(), read.state.as_str()), ("12_3", "PENDING"));
        assert_eq!(read.reason.as_deref(), Some("Priority"));
        // what was asked for as 1000 MB is not a little less when it is read
        assert!((1000.0..1001.0).contains(&read.memory_mb), "{read:?}");
        let running = allocation("12_4|RUNNING|1-00:00:01|1G|None").expect("a line");
        assert_eq!(running.ran, Duration::from_secs(86_401));
        assert_eq!(running.reason, None);
        assert!(allocation("12_4|RUNNING").is_err());
        assert!(allocation("12_4|RUNNING|0:01|much|None").is_err());
    }

    proptest! {
        /// Slurm's words reach this program from another one, of any version and in any language.
        #[test]
        fn whatever_squeue_says_is_read_or_refused(
            line in r"[ -~é]{0,40}(\|[0-9a-zA-Z:.+_ -]{0,12}){0,6}",
            ran in r"([0-9]{0,11}-)?[0-9]{0,11}(:[0-9]{0,11}){0,4}",
            memory in r"-?([0-9.e+]{0,12}|inf|nan)[KMGTPcn]{0,3}",
        ) {
            let own = format!("1|RUNNING|{ran}|{memory}|None");
            for line in [line, own] {
                if let Ok(read) = allocation(&line) {
                    prop_assert!(read.memory_mb.is_finite() && read.memory_mb >= 0.0, "{:?}", read);
                }
            }
        }
    }

    #[test]
    fn what_a_command_says_against_it_is_told() {
        let mut shell = Command::new("sh");
        shell.args(["-c", "cat >&2; exit 1"]);
        assert_eq!(
            answer(shell, "no\nsuch partition"),
            Err("no; such partition".to_owned())
        );
        let missing = answer(Command::new("no-such-command"), "").expect_err("missing");
        assert!(missing.starts_with("no-such-command: "), "{missing}");
    }

    #[test]
    fn words_mean_in_a_shell_what_they_are() {
        assert_eq!(quoted("--mem=5M"), "--mem=5M");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("a'b $c"), r"'a'\''b $c'");
    }
}
