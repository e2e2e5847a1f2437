use serde_json::json;

/// Description of the build and the machine for run.json.
pub fn build_info() -> serde_json::Value {
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("EVIGRID_COMMIT"),
        "profile": if cfg!(debug_assertions) { "debug" } else { "release" },
        "rerun": cfg!(feature = "rerun"),
        "os": std::env::consts::OS,
        "arch": std::env::consts::ARCH,
        "cpu": cpu.map_or("", |(_, name)| name.trim()),
        "threads": std::thread::available_parallelism().map_or(0, usize::from),
    })
}
