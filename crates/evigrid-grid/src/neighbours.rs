use crate::Lattice;

impl Lattice<2> {
    /// Flat indices of the up to eight neighbours of a cell, in order.
    pub fn neighbours(&self, flat: usize) -> impl Iterator<Item = usize> + use<> {
        self.around(flat, 1)
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
