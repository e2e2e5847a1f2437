//! The matchers that find the disparities: the one place to add another.

/// A matcher by its settings.
#[derive(Debug, Clone, Copy)]
pub struct Matcher {
    /// For tables and titles.
    pub name: &'static str,
    /// `SECTION.KEY=VALUE`.
    pub sets: &'static [&'static str],
}

/// All that are compared. The cameras stand 6 cm apart: 64 px are 0.47 m. (The paper uses graph cuts,
/// which take a minute per image here: item `matching`.)
pub const MATCHERS: [Matcher; 2] = [
    Matcher { name: "block matching", sets: &["stereo.disparities=64"] },
    Matcher { name: "semi-global", sets: &["stereo.disparities=64", "stereo.matcher=semi-global"] },
];
