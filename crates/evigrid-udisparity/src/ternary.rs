use crate::{Parameters, Pixels};

/// The ternary grid of the paper's Fig. 5: only the highest disparity of each column counts. In front of it cells are
/// free (P_FN), at it occupied (1 - P_FP), behind it unknown (0.5). A column that shows the road alone is free as a
/// whole, one that shows nothing unknown.
///
/// Rows of as many cells as the image has columns, for the disparities from 1 on, into `grid`.
pub fn ternary(pixels: &Pixels, parameters: &Parameters, grid: &mut [f32]) {
    let mut highest = vec![None; pixels.width];
    let rows = pixels.obstacles.chunks_exact(pixels.width).zip(pixels.road.chunks_exact(pixels.width));
    for (obstacles, road) in rows {
        for ((highest, &obstacle), &road) in highest.iter_mut().zip(obstacles).zip(road) {
            if obstacle != 0 || road != 0 {
                *highest = Some(highest.unwrap_or(0).max(obstacle));
            }
        }
    }
    let (free, occupied) = (parameters.false_negative as f32, 1.0 - parameters.false_positive as f32);
    for (index, row) in grid.chunks_exact_mut(pixels.width).enumerate() {
        for (cell, highest) in row.iter_mut().zip(&highest) {
            *cell = match highest.map(|highest| (index + 1).cmp(&usize::from(highest))) {
                Some(std::cmp::Ordering::Greater) => free,
                Some(std::cmp::Ordering::Equal) => occupied,
                Some(std::cmp::Ordering::Less) | None => 0.5,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_disparity_of_a_column_counts() {
        // Columns: obstacles at 3 and 1; nothing; road alone; an obstacle beyond the grid.
        let pixels = Pixels {
            width: 4,
            height: 2,
            obstacles: vec![3, 0, 0, 9, 1, 0, 0, 0],
            road: vec![0, 0, 2, 0, 0, 0, 0, 0],
        };
        let parameters =
            Parameters { false_positive: 0.1, false_negative: 0.02, tau_obstacle: 0.1, tau_road: 0.1 };
        let mut grid = vec![0.0; 16];
        ternary(&pixels, &parameters, &mut grid);
        let column = |u: usize| [0, 1, 2, 3].map(|d| grid[d * 4 + u]);
        assert_eq!(column(0), [0.5, 0.5, 0.9, 0.02]);
        assert_eq!([column(1), column(2), column(3)], [[0.5; 4], [0.02; 4], [0.5; 4]]);
    }
}
