use evigrid_grid::PlanSpec;

/// Flat indices of the up to eight neighbours of a cell.
pub(crate) fn neighbours(spec: &PlanSpec, flat: usize) -> impl Iterator<Item = usize> + use<> {
    around(spec, flat, 1)
}

/// Flat indices of the cells that are at most `reach` rows and columns away, without the cell itself.
pub(crate) fn around(spec: &PlanSpec, flat: usize, reach: usize) -> impl Iterator<Item = usize> + use<> {
    let ([nx, ny], [i, j]) = (spec.shape(), spec.cell(flat));
    let rows = i.saturating_sub(reach)..(i + reach + 1).min(nx);
    rows.flat_map(move |row| {
        let columns = j.saturating_sub(reach)..(j + reach + 1).min(ny);
        columns.map(move |column| row * ny + column)
    })
    .filter(move |&other| other != flat)
}
