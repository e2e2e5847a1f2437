use anyhow::Result;

use crate::output::print;

/// `evigrid metrics`: the one table of metrics, as docs/metrics.md has it.
pub fn metrics() -> Result<()> {
    print(&evigrid_metrics::metrics_markdown())
}
