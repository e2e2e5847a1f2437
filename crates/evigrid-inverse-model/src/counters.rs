/// The counts of Andert 2009, Table I, for one image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counters {
    /// Coordinate transfers, from pixel to grid or back: of lines one per used pixel and one for the camera's
    /// centre, of rays one per cell and five for the camera's centre and the image's corners.
    pub coordinate_transfers: u64,
    /// Accesses to pixels of the disparity image or its pyramid: of lines those that have a disparity (with a
    /// pyramid also those that are split), of rays those in the windows of all cells.
    pub used_pixels: u64,
    /// Lines drawn; 0 for rays.
    pub lines: u64,
    /// P values assigned to cells: of lines the cells of all of them, of rays all cells of the sensor's box.
    pub cells_drawn: u64,
    /// Different cells among the cells drawn: of rays all cells of the sensor's box, whatever is said of
    /// them.
    pub different_cells: u64,
    /// Cells of which the image says something: of lines the different cells, of rays those that see a pixel
    /// and are not hidden.
    pub touched_cells: u64,
}

impl Counters {
    /// Sets how many cells the image says something of.
    pub(crate) fn count(&mut self, touched: u64) {
        self.touched_cells = touched;
        // Of rays the different cells are known from the box.
        if self.different_cells == 0 {
            self.different_cells = touched;
        }
    }
}
