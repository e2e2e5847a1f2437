//! Blur within the methods, against blur of a whole image's grid.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{CELL_M, all, bits, spec, wall};
use evigrid_grid::logit;
use evigrid_inverse_model::{
    BlurKind, InverseModelMapper, LinePyramidSettings, LineSettings, PoseDeviation, RayPyramidSettings,
    RaySettings, SouzaSettings,
};

#[test]
fn every_method_can_be_blurred() {
    let blur = BlurKind::Distance;
    let blurred = [
        InverseModelMapper::line(spec(), LineSettings { blur, ..LineSettings::default() }),
        InverseModelMapper::line_pyramid(
            spec(),
            LinePyramidSettings { blur, ..LinePyramidSettings::default() },
        ),
        InverseModelMapper::ray(spec(), RaySettings { blur, ..RaySettings::default() }),
        InverseModelMapper::ray_pyramid(spec(), RayPyramidSettings { blur, ..RayPyramidSettings::default() }),
        InverseModelMapper::souza(spec(), SouzaSettings { blur, ..SouzaSettings::default() }),
    ];
    let settings = LineSettings::default();
    let deviation = PoseDeviation {
        kind: blur,
        translation_m: settings.blur_translation_m,
        angle: settings.blur_angle_deg.to_radians(),
    };
    for (mut found, mut plain) in blurred.map(Result::unwrap).into_iter().zip(all(spec())) {
        let shot = wall(6.0);
        shot.integrate(&mut found);
        let (drawn, _) = shot.with(|view| plain.single_image(view));
        let expected = evigrid_inverse_model::blurred(&drawn, shot.camera().into(), &deviation);
        assert!(expected.touched().count() > drawn.touched().count());
        assert_eq!(bits(found.map()), bits(&expected));
    }
}

/// With a prior other than 0.5, blurring says nothing of cells far from all that was seen.
#[test]
fn blur_spreads_what_an_image_adds_to_the_prior() {
    let prior = SouzaSettings { prior_probability: 0.4, motion_error_per_m: 0.0, ..SouzaSettings::default() };
    let blur = SouzaSettings { blur: BlurKind::Constant, blur_translation_m: CELL_M, ..prior };
    let [mut plain, mut blurred] =
        [prior, blur].map(|settings| InverseModelMapper::souza(spec(), settings).unwrap());
    let shot = wall(6.0);
    shot.integrate(&mut plain);
    shot.integrate(&mut blurred);
    let l0 = logit(0.4) as f32;
    let drawn = plain.map();
    let mut halo = 0;
    for (cell, l) in blurred.map().touched() {
        // Three deviations along each axis: only cells that add something can move the prior, and by no more
        // than they add.
        let voxel = spec().voxel(cell).map(|v| v as i64);
        let near = (-3..=3_i64).flat_map(|i| (-3..=3).flat_map(move |j| (-3..=3).map(move |k| [i, j, k])));
        let seen = near.filter_map(|d| {
            let other = spec().flat([voxel[0] + d[0], voxel[1] + d[1], voxel[2] + d[2]])?;
            Some((drawn.log_odds(other)? - l0).abs())
        });
        let most = seen.fold(0.0, f32::max);
        halo += usize::from(drawn.log_odds(cell).is_none());
        assert!((l - l0).abs() <= most + 1e-5, "cell {cell}: {l}");
        if drawn.log_odds(cell).is_none() {
            assert!((l - l0).abs() < 0.6 * most, "cell {cell}: {l}");
        }
    }
    assert!(halo > 100, "{halo}");
}
