use std::collections::BTreeSet;
use std::io::Write;

use anyhow::Result;
use evigrid_grid::{GridSpec, LogOddsGrid};
use rerun::components::ImageFormat;
use rerun::datatypes::{AnnotationInfo, ClassDescription};
use rerun::{AnnotationContext, SegmentationImage, TimePoint, Transform3D, VoxelGridMap};

use crate::blocks::{Blocks, Change};
use crate::classes::{CellClass, Laser};
use crate::rrd::{Rrd, Store};
use crate::top_view::TopView;

/// The map of one method in space, below the grid's corner.
pub(crate) fn map_path(method: &str) -> String {
    format!("world/map/{method}")
}

/// The map of one method from above.
pub(crate) fn top_view_path(method: &str) -> String {
    format!("top_view/{method}")
}

/// Writes the map of one method: its voxels, block by block as they change, and its view from above.
#[derive(Debug)]
pub(crate) struct MapWriter {
    spec: GridSpec,
    blocks: Blocks,
    top_view: TopView,
    /// Blocks and classes that have been given their colour and size.
    known: BTreeSet<([usize; 3], CellClass)>,
}

impl MapWriter {
    pub fn new(spec: GridSpec) -> Self {
        Self { spec, blocks: Blocks::new(spec), top_view: TopView::new(&spec), known: BTreeSet::new() }
    }

    /// What holds at all times.
    pub fn begin<W: Write>(&self, rrd: &mut Rrd<W>, store: &mut Store, method: &str) -> Result<()> {
        let always = TimePoint::default();
        let corner = self.spec.origin_m().map(|v| v as f32);
        rrd.log(store, map_path(method), &always, &Transform3D::from_translation(corner))?;
        let classes = CellClass::ALL.map(|class| {
            let [r, g, b] = class.rgb();
            let colour = rerun::datatypes::Rgba32::from_rgb(r, g, b);
            ClassDescription::from(AnnotationInfo::from((class as u16, class.label(), colour)))
        });
        rrd.log(store, top_view_path(method), &always, &AnnotationContext::new(classes))
    }

    /// The map after one frame.
    pub fn frame<W: Write>(
        &mut self,
        rrd: &mut Rrd<W>,
        store: &mut Store,
        at: &TimePoint,
        (method, map): (&str, &LogOddsGrid),
        laser: Option<Laser<'_>>,
    ) -> Result<()> {
        let (changes, slabs) = self.blocks.update(map.values(), laser);
        for change in changes {
            self.write_block(rrd, store, at, method, change)?;
        }
        if slabs.is_empty() {
            return Ok(());
        }
        for is in slabs {
            self.top_view.draw(self.blocks.numbers(), is);
        }
        let format = ImageFormat::segmentation(self.top_view.size(), rerun::ChannelDatatype::U8);
        let image = SegmentationImage::new(self.top_view.pixels().to_vec(), format);
        rrd.log(store, top_view_path(method), at, &image)
    }

    fn write_block<W: Write>(
        &mut self,
        rrd: &mut Rrd<W>,
        store: &mut Store,
        at: &TimePoint,
        method: &str,
        change: Change,
    ) -> Result<()> {
        let Change { block: [i, j, k], class, voxels } = change;
        let path = format!("{}/{}/block_{i}_{j}_{k}", map_path(method), class.name());
        if self.known.insert(([i, j, k], class)) {
            let size = [self.spec.cell_size_m() as f32; 3];
            let mut look = VoxelGridMap::update_fields().with_voxel_size(size).with_colors([class.colour()]);
            if class == CellClass::Missed {
                look = look.with_opacity(0.5);
            }
            rrd.log(store, path.as_str(), &TimePoint::default(), &look)?;
        }
        rrd.log(store, path, at, &VoxelGridMap::update_fields().with_voxel_indices(voxels))
    }

    /// The cells along x where the map is occupied, first and last; `None` if there are none.
    pub fn extent_x(&self) -> Option<(usize, usize)> {
        use CellClass::{Hit, Mistake, Occupied, Unobserved};
        let [_, ny, nz] = self.spec.shape();
        let occupied = |&n: &u8| [Hit, Mistake, Occupied, Unobserved].iter().any(|&c| c as u8 == n);
        let first = self.blocks.numbers().iter().position(occupied)?;
        let last = self.blocks.numbers().iter().rposition(occupied)?;
        Some((first / (ny * nz), last / (ny * nz)))
    }
}
