use std::collections::BTreeMap;

use evigrid_replay::Sequence;
use evigrid_truth::{LaserTruth, TruthSettings};
use nalgebra::Vector3;

use super::super::fixtures::{a_box, grid, mixture, turned_map, world};
use super::super::surface_points::visible;
use super::*;
use crate::SyntheticSequence;

/// The voxel that a point belongs to.
fn voxel_of(spec: &GridSpec, point: &Point3<f64>) -> Option<usize> {
    spec.cell_of((point.coords + Vector3::repeat(SHIFT_M)).into())
}

#[test]
fn voxels_are_occupied_where_points_of_the_surfaces_fall() {
    let world = mixture();
    for map_from_world in [Pose::identity(), turned_map()] {
        let spec = grid([2.0, 9.0], [-3.0, 5.0], [-0.75, 2.5], 0.25);
        let truth = VoxelTruth::new(&world, spec, &map_from_world, &[0]);
        let objects = objects(&world, &map_from_world, 0.0, |_| true);
        let spacing = 0.25 / 20.0;
        let mut points: BTreeMap<usize, Vec<Point3<f64>>> = BTreeMap::new();
        for point in visible(&objects, spacing) {
            let Some(cell) = voxel_of(&spec, &point) else { continue };
            assert_eq!(truth.state(cell), VoxelState::Occupied, "{point}");
            points.entry(cell).or_default().push(point);
        }
        assert!(points.len() > 1200, "{}", points.len());
        // A surface point is within 0.71 spacings of a point of its shape, and where that is
        // hidden by another shape, the surface goes on there; so a voxel has a point in it or so
        // little of a surface that one is near.
        let mut unseen = 0;
        for voxel in truth.occupied() {
            let cell = spec.flat(voxel.map(i64::from)).unwrap();
            if points.contains_key(&cell) {
                continue;
            }
            unseen += 1;
            let [low, high] = cube(&spec, spec.voxel(cell)).bounds();
            let away = |p: &Point3<f64>| (p.coords - p.coords.sup(&low).inf(&high)).norm();
            let around = (0..27_i64).filter_map(|n| {
                let step = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
                points.get(&spec.flat([0, 1, 2].map(|a| i64::from(voxel[a]) + step[a]))?)
            });
            let nearest = around.flatten().map(away).fold(f64::MAX, f64::min);
            // At the border of the grid the points beyond it are not kept.
            let shape = spec.shape();
            let at_border = (0..3).any(|a| voxel[a] == 0 || voxel[a] as usize == shape[a] - 1);
            assert!(nearest < 1.5 * spacing || at_border, "{voxel:?}: {nearest}");
        }
        assert!(unseen * 50 < points.len(), "{unseen} of {}", points.len());
    }
}

#[test]
fn free_voxels_hold_no_point_of_a_solid_and_hidden_ones_nothing_else() {
    let world = mixture();
    let map_from_world = turned_map();
    let spec = grid([2.0, 9.0], [-3.0, 5.0], [-0.75, 2.5], 0.2);
    let truth = VoxelTruth::new(&world, spec, &map_from_world, &[0, 1, 2]);
    let objects = objects(&world, &map_from_world, 0.0, |_| true);
    let mut count = [0; 3];
    for cell in 0..spec.cell_count() {
        let [low, high] = cube(&spec, spec.voxel(cell)).bounds();
        let inside = (0..60).filter(|&i| {
            // Places that fill the voxel evenly (Roberts' sequence).
            let share = |k: f64| (f64::from(i) * k + 0.5).fract();
            let shares = Vector3::new(share(0.819_172_513), share(0.671_043_607), share(0.549_700_478));
            let point = Point3::from(low + (high - low).component_mul(&shares));
            objects.iter().any(|object| object.contains(&point))
        });
        let inside = inside.count();
        match truth.state(cell) {
            VoxelState::Free => assert_eq!(inside, 0, "{:?}", spec.voxel(cell)),
            VoxelState::Hidden => assert_eq!(inside, 60, "{:?}", spec.voxel(cell)),
            VoxelState::Occupied => {}
        }
        count[truth.state(cell) as usize] += 1;
    }
    assert!(count.iter().all(|&n| n > 1000), "{count:?}");
}

fn states(truth: &VoxelTruth, j: usize, k: usize) -> String {
    let [nx, ny, nz] = truth.spec().shape();
    assert!(j < ny && k < nz);
    let letter = |i| match truth.state((i * ny + j) * nz + k) {
        VoxelState::Free => '.',
        VoxelState::Occupied => '#',
        VoxelState::Hidden => 'o',
    };
    (0..nx).map(letter).collect()
}

#[test]
fn a_surface_on_a_border_belongs_to_the_upper_voxel() {
    // From x = 6 to 8, y = -1 to 1, z = -2 to 0; all borders of voxels.
    let world = world(&[a_box([2.0, 2.0, 2.0], [7.0, 0.0, -1.0], "")]);
    let truth =
        VoxelTruth::new(&world, grid([5.0, 10.0], [-2.0, 2.0], [-3.0, 1.0], 0.5), &Pose::identity(), &[0]);
    let free = "..........";
    // Upwards: below it, its lowest layer, one within it, the one above its upper face, another.
    let layers = [1, 2, 4, 6, 7].map(|k| states(&truth, 4, k));
    assert_eq!(layers, [free, "..#####...", "..#ooo#...", "..#####...", free]);
    let rows = [1, 2, 3, 5, 6, 7].map(|j| states(&truth, j, 4));
    assert_eq!(rows, [free, "..#####...", "..#ooo#...", "..#ooo#...", "..#####...", free]);
    assert_eq!(truth.hidden().len(), 27);
    assert_eq!(truth.occupied().len(), 125 - 27);
    assert!(truth.occupied().is_sorted());
}

#[test]
fn the_interface_of_solids_that_abut_is_hidden() {
    let abutting = |gap: f64| {
        let world = world(&[
            a_box([1.3, 2.0, 2.0], [6.0 + 0.65, 0.0, 0.0], ""),
            a_box([1.7, 2.0, 2.0], [7.3 + 0.85 + gap, 0.0, 0.0], ""),
        ]);
        let spec = grid([5.0, 10.0], [-2.0, 2.0], [-2.0, 2.0], 0.5);
        states(&VoxelTruth::new(&world, spec, &Pose::identity(), &[0]), 4, 4)
    };
    assert_eq!(abutting(0.0), "..#ooooo#.");
    assert_eq!(abutting(0.1), "..#o#ooo#.");
}

#[test]
fn what_moves_is_occupied_at_any_time_and_hides_at_all_times_only() {
    // At x = 6 to 8 in frame 0, then 0.5 m further each frame; over a floor, with a post that it runs over.
    let mover = a_box([2.0, 1.0, 1.0], [7.0, 0.0, 0.5], "motion = { velocity_mps = [5.0, 0.0, 0.0] }");
    let post = a_box([0.2, 0.2, 0.6], [7.35, 0.1, 0.5], "");
    let world = world(&[a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], ""), mover, post]);
    let spec = grid([5.0, 11.0], [-2.0, 2.0], [-1.0, 2.0], 0.5);
    let truth = |frames: &[usize]| VoxelTruth::new(&world, spec, &Pose::identity(), frames);
    let layer = |frames: &[usize], k: usize| states(&truth(frames), 4, k);
    // The layer that the mover fills with its upper half, in which the post stands.
    assert_eq!(layer(&[0], 3), "..#ooo#.....");
    assert_eq!(layer(&[1], 3), "...#ooo#....");
    assert_eq!(layer(&[2], 3), "....#ooo#...");
    assert_eq!(layer(&[0, 1, 2], 3), "..###o###...");
    assert_eq!(layer(&[], 3), "....#.......");
    assert_eq!(layer(&[0, 1], 3), "..##oo##....");
    // Below the floor's face nothing changes, on it everything is occupied.
    assert_eq!(layer(&[0, 1, 2], 1), "oooooooooooo");
    assert_eq!(layer(&[0, 1], 2), "############"[..4].to_owned() + "oo" + "######");
    assert_eq!(truth(&[0, 2]).states(), truth(&[2, 0]).states());
}

#[test]
fn what_a_thing_that_leaves_has_hidden_is_free() {
    // At x = 6 to 8 in frame 0, at 10 to 12 in frame 1.
    let mover = a_box([2.0, 2.0, 2.0], [7.0, 0.0, 0.5], "motion = { velocity_mps = [40.0, 0.0, 0.0] }");
    let spec = grid([5.0, 11.0], [-2.0, 2.0], [-1.0, 2.0], 0.5);
    let truth = VoxelTruth::new(&world(&[mover]), spec, &Pose::identity(), &[0, 1]);
    assert_eq!(states(&truth, 4, 3), "..#...#...#.");
}

#[test]
fn the_fast_way_finds_what_a_loop_over_all_voxels_and_shapes_finds() {
    let world = mixture();
    let spec = grid([0.0, 11.0], [-4.0, 5.0], [-2.0, 3.0], 0.3);
    let truth = VoxelTruth::new(&world, spec, &turned_map(), &[0]);
    let all = objects(&world, &turned_map(), 0.0, |_| true);
    for cell in 0..spec.cell_count() {
        let slow = classify(&cube(&spec, spec.voxel(cell)), all.iter());
        assert_eq!(truth.state(cell), slow, "{:?}", spec.voxel(cell));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap();
    let again = pool.install(|| VoxelTruth::new(&world, spec, &turned_map(), &[0]));
    assert_eq!(again.states(), truth.states());
}

#[test]
fn a_laser_without_noise_marks_occupied_voxels_and_looks_through_free_ones() {
    let worlds = [mixture(), World::from_toml(include_str!("../../tests/box.toml")).unwrap()];
    for world in worlds {
        let map_from_world = turned_map();
        let spec = grid([0.0, 16.0], [-6.0, 6.0], [-1.0, 3.0], 0.2);
        let frames = [0, 1, 2];
        let truth = VoxelTruth::new(&world, spec, &map_from_world, &frames);
        let all = objects(&world, &map_from_world, 0.0, |_| true);
        let mut laser = LaserTruth::new(spec, TruthSettings::default()).unwrap();
        let sequence = SyntheticSequence::new(world);
        for frame in frames {
            let frame = sequence.frame(frame, &map_from_world).unwrap();
            laser.add_scan(frame.laser().unwrap());
        }
        let (mut marked, mut seen_through, mut on_border) = (0, 0, 0);
        for cell in 0..spec.cell_count() {
            if laser.occupied()[cell] {
                marked += 1;
                if truth.state(cell) != VoxelState::Occupied {
                    // Points are in single precision, so the surface may be this far beyond the border.
                    on_border += 1;
                    let mut cube = cube(&spec, spec.voxel(cell));
                    cube.half_m += 1e-5;
                    assert_eq!(classify(&cube, all.iter()), VoxelState::Occupied, "{:?}", spec.voxel(cell));
                }
            } else if laser.observed()[cell] {
                seen_through += 1;
                assert_ne!(truth.state(cell), VoxelState::Hidden, "{:?}", spec.voxel(cell));
            }
        }
        assert!(
            marked > 500 && seen_through > 5000 && on_border * 100 < marked,
            "{marked} {seen_through} {on_border}"
        );
    }
}
