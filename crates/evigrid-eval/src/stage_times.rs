use evigrid_results::StageTime;

use crate::Clock;

/// Takes the times of the stages of one frame.
pub(crate) struct Times<'a> {
    pub clock: &'a dyn Clock,
    pub frame: usize,
    pub list: Vec<StageTime>,
}

impl Times<'_> {
    /// Runs a stage and takes its time.
    pub fn stage<T>(&mut self, stage: &'static str, method: Option<usize>, run: impl FnOnce() -> T) -> T {
        let start = self.clock.now_ms();
        let result = run();
        let ms = self.clock.now_ms() - start;
        self.list.push(StageTime { frame: self.frame, method, stage, ms });
        result
    }
}
