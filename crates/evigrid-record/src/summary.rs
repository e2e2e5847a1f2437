use anyhow::Result;
use evigrid_results::{RunInfo, RunResult, markdown_summary};
use rerun::TextDocument;
use rerun::components::MediaType;

use crate::blueprint::Pane;
use crate::part::{Out, Part, Shown, Slot, Start};

/// The summary of the run.
const SUMMARY: &str = "summary";

/// The page that a run ends with.
pub(crate) struct SummaryPart {
    info: RunInfo,
}

impl SummaryPart {
    pub fn new(start: Start<'_>) -> Self {
        Self { info: start.info.clone() }
    }
}

impl Part for SummaryPart {
    fn end(&mut self, out: &mut Out<'_>, result: &RunResult) -> Result<()> {
        let text = markdown_summary(&self.info, result);
        out.always(SUMMARY, &TextDocument::new(text).with_media_type(MediaType::MARKDOWN))
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        vec![(
            Slot::Text,
            Pane { contents: vec![format!("+ /{SUMMARY}")], ..Pane::new("TextDocument", "summary", SUMMARY) },
        )]
    }
}
