use crate::Lattice;

impl Lattice<2> {
    /// Flat indices of the up to eight neighbours of a cell, in order.
    #[inline]
    pub fn neighbours(&self, flat: usize) -> impl Iterator<Item = usize> + use<> {
        let ([nx, ny], [i, j]) = (self.shape(), self.cell(flat));
        let (mut found, mut count) = ([0; 8], 0);
        for [di, dj] in [[-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 1], [1, -1], [1, 0], [1, 1]] {
            let (row, column) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
            if row < nx && column < ny {
                found[count] = row * ny + column;
                count += 1;
            }
        }
        found.into_iter().take(count)
    }

    /// Flat indices of the cells that are at most `reach` rows and columns away, without the cell itself, in
    /// order.
    pub fn around(&self, flat: usize, reach: usize) -> impl Iterator<Item = usize> + use<> {
        let ([nx, ny], [i, j]) = (self.shape(), self.cell(flat));
        let rows = i.saturating_sub(reach)..(i + reach + 1).min(nx);
        rows.flat_map(move |row| {
            let columns = j.saturating_sub(reach)..(j + reach + 1).min(ny);
            columns.map(move |column| row * ny + column)
        })
        .filter(move |&other| other != flat)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::PlanSpec;

    #[test]
    fn neighbours_are_the_cells_around() {
        for (x_m, y_m) in [(5.0, 4.0), (1.0, 3.0), (2.0, 1.0), (1.0, 1.0)] {
            let plan = PlanSpec::of_area([0.0, x_m], [0.0, y_m], 1.0).unwrap();
            for flat in 0..plan.cell_count() {
                assert!(plan.neighbours(flat).eq(plan.around(flat, 1)), "{flat} of {x_m} by {y_m}");
            }
        }
    }
}
