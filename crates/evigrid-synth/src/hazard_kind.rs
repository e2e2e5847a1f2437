use serde::Deserialize;

/// What makes a place dangerous to a robot, or that it is safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HazardKind {
    /// The edge of ground that falls by more than 15 cm.
    DropOff,
    /// The edge of a step of up to 15 cm, up or down.
    Step,
    /// A flight of steps that are too short to stand on.
    Stair,
    /// A hollow with a floor that no ramp leads to.
    Pit,
    /// Level ground that only steps or drop-offs lead to.
    Unreachable,
    /// The open edge beside a ramp.
    RampSide,
    /// A slope that is too steep to drive on.
    Wedge,
    /// Bars and posts that the ground goes on behind.
    Railing,
    /// A top on legs.
    Table,
    /// A thing in the air, lower than the robot is high.
    Overhang,
    /// Any other thing that stands on the ground.
    Obstacle,
    /// No hazard: ground that the robot may drive on.
    #[serde(skip_deserializing)]
    SafeArea,
}

impl HazardKind {
    /// All kinds.
    pub const ALL: [Self; 12] = [
        Self::DropOff,
        Self::Step,
        Self::Stair,
        Self::Pit,
        Self::Unreachable,
        Self::RampSide,
        Self::Wedge,
        Self::Railing,
        Self::Table,
        Self::Overhang,
        Self::Obstacle,
        Self::SafeArea,
    ];

    /// The name in worlds and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::DropOff => "drop-off",
            Self::Step => "step",
            Self::Stair => "stair",
            Self::Pit => "pit",
            Self::Unreachable => "unreachable",
            Self::RampSide => "ramp-side",
            Self::Wedge => "wedge",
            Self::Railing => "railing",
            Self::Table => "table",
            Self::Overhang => "overhang",
            Self::Obstacle => "obstacle",
            Self::SafeArea => "safe-area",
        }
    }

    /// Whether a robot may drive there.
    pub fn is_safe(self) -> bool {
        self == Self::SafeArea
    }
}
