//! The maps of several peak ratios at once against one mapper for each of them: the same to the last bit.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{RIG, Shot, integrate, shot, spec};
use evigrid_core::GrayImage;
use evigrid_cost_curve::{Deviation, PeakRatios, WinnerTakeAll, WinnerTakeAllSettings};
use evigrid_grid::{LogOddsGrid, Mapper, MapperFamily, View};
use proptest::prelude::*;

fn integrate_all(family: &mut PeakRatios, shot: &Shot) {
    let left = GrayImage::new(RIG.width, RIG.height, vec![0; RIG.width * RIG.height]).unwrap();
    let matches = &shot.matches;
    let pose = &shot.pose;
    family.integrate(&View {
        rig: &RIG,
        map_from_left: pose,
        left: &left,
        right: &left,
        matches,
        volume: None,
    });
}

fn bits(map: &LogOddsGrid) -> Vec<u32> {
    map.values().iter().map(|v| v.to_bits()).collect()
}

proptest! {
    // Most of the time goes into tables of profiles.
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_map_is_that_of_its_own_mapper(
        shots in prop::collection::vec(shot(), 1..4),
        // Not sorted, some twice, some that every match passes and some that none does.
        ratios in prop::collection::vec(prop_oneof![4 => 1.0..4.5_f64, 1 => Just(1.0), 1 => Just(2.5)], 1..6),
        check in any::<bool>(),
        constant in any::<bool>(),
    ) {
        let deviation = if constant { Deviation::Constant } else { Deviation::FollowsRange };
        let settings = WinnerTakeAllSettings {
            left_right_check: check, deviation, max_depth_m: 9.0, ..WinnerTakeAllSettings::default()
        };
        let mut family = PeakRatios::new(spec(), settings, &ratios).unwrap();
        shots.iter().for_each(|shot| integrate_all(&mut family, shot));
        for (member, &peak_ratio) in ratios.iter().enumerate() {
            let settings = WinnerTakeAllSettings { peak_ratio, ..settings };
            let mut alone = WinnerTakeAll::new(spec(), settings).unwrap();
            shots.iter().for_each(|shot| integrate(&mut alone, shot));
            prop_assert_eq!(bits(&family.map(member)), bits(alone.map()), "peak ratio {}", peak_ratio);
        }
    }
}

#[test]
fn impossible_ratios_are_refused() {
    let refused = PeakRatios::new(spec(), WinnerTakeAllSettings::default(), &[2.0, 0.5]).unwrap_err();
    assert_eq!(refused.to_string(), "winner-take-all.peak_ratio: expected a number from 1, found 0.5");
}
