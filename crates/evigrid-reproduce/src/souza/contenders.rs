//! The matchers that are compared, with their settings.

use evigrid_stereo::{
    GraphCutSettings, MatcherKind, PixelCost, PreFilter, SemiGlobalSettings, StereoSettings,
};

/// A matcher as a user would set it.
pub struct Contender {
    pub name: &'static str,
    pub settings: StereoSettings,
    /// Whether matches count only if the right image's agree within a pixel.
    pub checked: bool,
}

/// Settings are those that OpenCV's documentation recommends; none was fitted to these data.
pub fn contenders(disparities: usize) -> Vec<Contender> {
    let block = StereoSettings { disparities, ..Default::default() };
    let filtered = StereoSettings {
        pre_filter: PreFilter::Normalized,
        texture_threshold: 10,
        uniqueness_percent: 15,
        speckle_pixels: 100,
        speckle_step_px: 1.0,
        ..block
    };
    let semi_global = StereoSettings { matcher: MatcherKind::SemiGlobal, ..block };
    let unique = StereoSettings { uniqueness_percent: 5, ..semi_global };
    // One round: more take minutes per image, and lower the energy but not the errors (table of variants).
    let one_round = GraphCutSettings { max_rounds: 1, ..Default::default() };
    let graph_cuts = StereoSettings { matcher: MatcherKind::GraphCuts, graph_cuts: one_round, ..block };
    let contender = |name, settings, checked| Contender { name, settings, checked };
    vec![
        contender("block 7x7", block, false),
        contender("block 7x7, left-right check", block, true),
        contender("block 7x7, Souza's filters", filtered, false),
        contender("semi-global", semi_global, false),
        contender("semi-global, uniqueness 5, left-right check", unique, true),
        contender("graph cuts, one round", graph_cuts, false),
    ]
}

/// Semi-global matching with one setting changed, uniqueness 5 and the left-right check.
pub fn variants(disparities: usize) -> Vec<Contender> {
    let block = StereoSettings { disparities, uniqueness_percent: 5, ..Default::default() };
    let base = SemiGlobalSettings::default();
    let with = |semi_global| StereoSettings { matcher: MatcherKind::SemiGlobal, semi_global, ..block };
    let contender = |name, settings| Contender { name, settings, checked: true };
    vec![
        contender("semi-global", with(base)),
        contender("speckles 100", StereoSettings { speckle_pixels: 100, ..with(base) }),
        contender("4 paths", with(SemiGlobalSettings { paths: 4, ..base })),
        contender("adapted p2", with(SemiGlobalSettings { adapt_p2: true, ..base })),
        contender(
            "absolute differences",
            with(SemiGlobalSettings { pixel_cost: PixelCost::AbsoluteDifference, ..base }),
        ),
        contender(
            "census, p1 40, p2 160",
            with(SemiGlobalSettings { pixel_cost: PixelCost::Census, p1: 40, p2: 160, ..base }),
        ),
        contender("block 7x7", block),
        contender(
            "graph cuts, four rounds",
            StereoSettings { matcher: MatcherKind::GraphCuts, uniqueness_percent: 0, ..block },
        ),
    ]
}
