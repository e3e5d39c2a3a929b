//! This machine and this process: name, cores, processor time, memory.
use std::thread::available_parallelism;

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Name of this machine, as people on its network know it.
pub fn host_name() -> String {
    nix::unistd::gethostname()
        .ok()
        .and_then(|name| name.into_string().ok())
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "unknown".to_owned())
}

/// Threads that can run at the same time.
pub fn available_threads() -> usize {
    available_parallelism().map_or(1, usize::from)
}

/// Memory that programs can still take without swapping [MB], within the limit of this process's
/// control group where it has one; `None` where the system does not say.
pub fn free_memory_mb() -> Option<f64> {
    let kind = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let system = System::new_with_specifics(kind);
    let available = system.available_memory();
    let limited = system.cgroup_limits().map(|limits| limits.free_memory);
    let free = limited.map_or(available, |limited| limited.min(available));
    (free > 0).then_some(free as f64 / 1e6)
}

/// Room for files that users can still write in the file system of `folder` [MB]; `None` where the system
/// does not say.
pub fn free_disk_mb(folder: &std::path::Path) -> Option<f64> {
    let about = nix::sys::statvfs::statvfs(folder).ok()?;
    Some(about.blocks_available() as f64 * about.fragment_size() as f64 / 1e6)
}

/// Processor time of this process so far [s], all threads together.
pub(crate) fn processor_time_s() -> f64 {
    use nix::sys::resource::{UsageWho, getrusage};
    let seconds =
        |time: nix::sys::time::TimeVal| time.tv_sec() as f64 + time.tv_usec() as f64 * 1e-6;
    getrusage(UsageWho::RUSAGE_SELF).map_or(0.0, |usage| {
        seconds(usage.user_time()) + seconds(usage.system_time())
    })
}

/// Processor time of the calling thread so far [s].
pub fn thread_processor_time_s() -> f64 {
    use nix::time::{ClockId, clock_gettime};
    clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).map_or(0.0, |time| {
        time.tv_sec() as f64 + time.tv_nsec() as f64 * 1e-9
    })
}

/// Lets [`peak_memory_mb`] start anew, so that a large job does not show in the next one's cost.
pub(crate) fn forget_peak_memory() {
    // 5 resets the mark (proc_pid_clear_refs(5)); without it the mark stays that of the process
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Largest resident memory [MB] since [`forget_peak_memory`]; 0 where the system does not say.
pub(crate) fn peak_memory_mb() -> f64 {
    std::fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| high_water_mark_kb(&status))
        .map_or(0.0, |kilobytes| kilobytes * 1024.0 / 1e6)
}

/// Resident memory of this process now [MB]; 0 where the system does not say.
pub fn resident_memory_mb() -> f64 {
    std::fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| line_kb(&status, "VmRSS:"))
        .map_or(0.0, |kilobytes| kilobytes * 1024.0 / 1e6)
}

fn high_water_mark_kb(status: &str) -> Option<f64> {
    line_kb(status, "VmHWM:")
}

fn line_kb(status: &str, name: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_is_charged_for_its_own_work_only() {
        let before = thread_processor_time_s();
        let busy = std::thread::spawn(|| {
            let begin = thread_processor_time_s();
            while thread_processor_time_s() < begin + 0.05 {}
        });
        busy.join().expect("no panic");
        let waited = thread_processor_time_s() - before;
        assert!((0.0..0.04).contains(&waited), "{waited}");
    }

    #[test]
    fn the_high_water_mark_is_read_from_its_line() {
        let status = "VmPeak:\t  900 kB\nVmHWM:\t   2000 kB\nVmRSS:\t 1 kB\n";
        assert_eq!(high_water_mark_kb(status), Some(2000.0));
        assert_eq!(line_kb(status, "VmRSS:"), Some(1.0));
        assert_eq!(high_water_mark_kb("VmRSS:\t 1 kB\n"), None);
    }
}
