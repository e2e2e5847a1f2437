//! What holds for every method that maps whole cost curves, whatever its model.
#![allow(clippy::unwrap_used, missing_docs, dead_code)]

use evigrid_core::NO_COST;
use evigrid_grid::{MapError, Mapper, Method};

use super::volumes::{Shot, uniform};
use super::{bits, spec};

/// Curves that every mapper must cope with, and the smallest disparity of each.
pub const ODD_CURVES: [(&[u16], usize); 6] = [
    (&[500, 500, 500, 500, 500], 0), // a constant curve
    (&[0, 0, 0], 1),
    (&[NO_COST, 300, NO_COST, 70, NO_COST], 0), // missing costs
    (&[40], 1),                                 // one disparity only
    (&[40], 0),
    (&[65_534, 0, 65_534], 2),
];

/// An empty map over the grid of the tests.
fn mapper<M: Method>(settings: &M::Settings) -> Box<dyn Mapper> {
    M::build(spec(), settings).unwrap()
}

/// The numbers of the mapper's only map to the last bit.
fn map_bits(mapper: &dyn Mapper) -> Vec<u32> {
    let layers = mapper.layers();
    assert_eq!(layers.len(), 1);
    bits(layers[0].voxels().unwrap())
}

pub fn any_number_of_threads_makes_the_same_map<M: Method>(settings: &M::Settings, shots: &[Shot]) {
    let [one, two, five] = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut mapper = mapper::<M>(settings);
        pool.install(|| shots.iter().for_each(|shot| mapper.integrate(&shot.view()).unwrap()));
        map_bits(&*mapper)
    });
    assert_eq!(one, two);
    assert_eq!(one, five);
}

/// A frame in which nothing is measured leaves the map empty.
pub fn no_measurement_says_nothing<M: Method>() {
    let mut mapper = mapper::<M>(&M::Settings::default());
    mapper.integrate(&uniform(&[NO_COST; 4], 0, [9, 9]).view()).unwrap();
    assert_eq!(mapper.layers()[0].voxels().unwrap().touched().count(), 0);
}

/// The error names the costs, and the map stays as it was.
pub fn a_view_without_costs_is_refused<M: Method>() {
    let shot = uniform(&[9000, 9000, 0, 9000], 0, [80, 80]);
    let mut mapper = mapper::<M>(&M::Settings::default());
    mapper.integrate(&shot.view()).unwrap();
    let before = map_bits(&*mapper);
    let error = mapper.integrate(&shot.without_costs().view()).unwrap_err();
    assert_eq!(error, MapError::Lacks("matching costs"));
    assert_eq!(error.to_string(), "expected matching costs, found none");
    assert_eq!(map_bits(&*mapper), before);
}
