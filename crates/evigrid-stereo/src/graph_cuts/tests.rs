use super::*;
use proptest::prelude::*;

fn image(width: usize, height: usize, pixels: &[u8]) -> GrayImage {
    let pixels = pixels.iter().copied().cycle().take(width * height).collect();
    GrayImage::new(width, height, pixels).unwrap()
}

fn settings() -> impl Strategy<Value = GraphCutSettings> {
    (1..40_usize, 0..60_u16, 1..8_usize, 0..5_usize, 0..3_usize, 0..300_usize).prop_map(
        |(cutoff, lambda, occlusion_penalty, smoothness, smoothness_at_edges, edge)| GraphCutSettings {
            cutoff,
            lambda: f32::from(lambda),
            occlusion_penalty,
            smoothness,
            smoothness_at_edges,
            edge: edge.min(256),
            max_rounds: 4,
        },
    )
}

/// The energy by its definition: over all assignments, and all pairs of neighbouring ones.
fn slow_energy(energy: &Energy, labels: &[u16]) -> i64 {
    let Shape { width, disparities, .. } = energy.shape;
    let mut sum = 0;
    for (label, i) in (0..disparities as u16).flat_map(|d| (0..labels.len()).map(move |i| (d, i))) {
        let shift = energy.shift(label);
        if i % width < shift {
            continue;
        }
        let active = |i: usize| labels[i] == label;
        if active(i) {
            sum += i64::from(energy.active_cost(i, shift));
        }
        energy.for_neighbours(i, shift, |j, penalty| {
            if j > i && active(i) != active(j) {
                sum += i64::from(penalty);
            }
        });
    }
    sum
}

/// No two left pixels match the same right one.
fn is_unique(energy: &Energy, labels: &[u16]) -> bool {
    let mut taken = vec![false; labels.len()];
    labels.iter().enumerate().filter(|(_, label)| **label != OCCLUDED).all(|(i, &label)| {
        let shift = energy.shift(label);
        energy.exists(i, shift) && !std::mem::replace(&mut taken[i - shift], true)
    })
}

/// The lowest energy of all expansions of a label: every pixel keeps its label, gives it up, or takes the new
/// one.
fn best_expansion(energy: &Energy, labels: &[u16], label: u16) -> i64 {
    let mut moved = labels.to_vec();
    best_from(energy, labels, label, 0, &mut moved)
}

fn best_from(energy: &Energy, labels: &[u16], label: u16, i: usize, moved: &mut [u16]) -> i64 {
    if i == labels.len() {
        return if is_unique(energy, moved) { slow_energy(energy, moved) } else { i64::MAX };
    }
    let mut choices = vec![OCCLUDED];
    if labels[i] != OCCLUDED && labels[i] != label {
        choices.push(labels[i]);
    }
    if energy.exists(i, energy.shift(label)) {
        choices.push(label);
    }
    let mut best = i64::MAX;
    for choice in choices {
        moved[i] = choice;
        best = best.min(best_from(energy, labels, label, i + 1, moved));
    }
    best
}

fn bytes(count: usize) -> impl Strategy<Value = Vec<u8>> {
    // Few grey levels, so that there are ties and flat places.
    proptest::collection::vec((0..6_u8).prop_map(|v| 9 * v), count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_move_is_the_best_of_all(
        (width, height) in prop_oneof![Just((4_usize, 2_usize)), Just((3, 3)), Just((8, 1)), Just((2, 4))],
        min_disparity in 0..2_usize, disparities in 1..4_usize, settings in settings(),
        left in bytes(9), right in bytes(9),
    ) {
        let shape = Shape { width, height, min_disparity, disparities };
        let energy = Energy::new(&settings, shape, &image(width, height, &left), &image(width, height, &right));
        let mut labels = Labels::occluded(width * height);
        let mut expansion = Expansion::new(width * height);
        let mut now = 0;
        for label in (0..disparities as u16).chain(0..disparities as u16) {
            let best = best_expansion(&energy, &labels.left, label);
            now = expansion.run(&energy, &mut labels, now, label);
            prop_assert_eq!(now, best);
            prop_assert_eq!(now, slow_energy(&energy, &labels.left));
            prop_assert!(is_unique(&energy, &labels.left));
        }
    }

    #[test]
    fn energy_never_rises_and_is_that_of_the_labels(
        (width, height) in (1..40_usize, 1..20_usize), min_disparity in 0..4_usize, disparities in 1..12_usize,
        settings in settings(), left in bytes(211), right in bytes(211),
    ) {
        let shape = Shape { width, height, min_disparity, disparities };
        let energy = Energy::new(&settings, shape, &image(width, height, &left), &image(width, height, &right));
        let mut energies = vec![0];
        let labels = minimise(&energy, 4, |now| energies.push(now));
        prop_assert!(energies.is_sorted_by(|a, b| a >= b), "{energies:?}");
        prop_assert_eq!(energies.last().copied(), Some(slow_energy(&energy, &labels.left)));
        prop_assert_eq!(energy.of(&labels.left), slow_energy(&energy, &labels.left));
        prop_assert!(is_unique(&energy, &labels.left));
    }
}
