//! The maps of several peak ratios at once against one mapper for each of them: the same to the last bit.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{bits, integrate, shot, spec};
use evigrid_cost_curve::{Deviation, PeakRatios, WinnerTakeAll, WinnerTakeAllSettings};
use evigrid_grid::{LayerKind, MapperFamily, Method};
use proptest::prelude::*;

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
        shots.iter().for_each(|shot| shot.with(|view| family.integrate(view)).unwrap());
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

#[test]
fn only_settings_that_differ_in_the_peak_ratio_share() {
    let base = WinnerTakeAllSettings::default();
    let other = WinnerTakeAllSettings { peak_ratio: 4.0, ..base };
    assert!(WinnerTakeAll::shares(&base, &base) && WinnerTakeAll::shares(&base, &other));
    assert!(!WinnerTakeAll::shares(&base, &WinnerTakeAllSettings { left_right_check: false, ..other }));
    let family = WinnerTakeAll::build_family(spec(), &[base, other]).unwrap().unwrap();
    for member in 0..2 {
        let kinds: Vec<_> = family.layers(member).iter().map(|layer| layer.kind()).collect();
        assert_eq!(kinds, [LayerKind::Voxels]);
    }
    let impossible = WinnerTakeAllSettings { peak_ratio: 0.5, ..base };
    assert!(WinnerTakeAll::build_family(spec(), &[base, impossible]).is_err());
}
