use std::collections::BTreeSet;

use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::{GridSpec, Layer};
use rerun::blueprint::components::Eye3DKind;
use rerun::components::ImageFormat;
use rerun::external::re_sdk_types::blueprint::archetypes::{EyeControls3D, LineGrid3D};
use rerun::{SegmentationImage, Transform3D, VoxelGridMap};

use crate::blocks::{Blocks, Change};
use crate::blueprint::Pane;
use crate::camera::CAMERA;
use crate::classes::{CellClass, TrueCells};
use crate::labelled_image::LABELS;
use crate::laser::LASER;
use crate::layout::{bounds, dark};
use crate::part::{Out, Part, Shown, Slot, Start};
use crate::top_view::TopView;
use crate::trajectory::TRAJECTORY;

/// The map of one method in space, below the grid's corner.
fn map_path(method: &str) -> String {
    format!("world/map/{method}")
}

/// The map of one method from above.
fn top_view_path(method: &str) -> String {
    format!("top_view/{method}")
}

/// The voxels of one method, block by block as they change, and their view from above.
#[derive(Debug)]
pub(crate) struct MapPart {
    number: usize,
    method: String,
    spec: GridSpec,
    blocks: Blocks,
    top_view: TopView,
    /// Blocks and classes that have been given their colour and size.
    known: BTreeSet<([usize; 3], CellClass)>,
}

impl Part for MapPart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let corner = self.spec.origin_m().map(|v| v as f32);
        out.always(map_path(&self.method), &Transform3D::from_translation(corner))?;
        out.always(top_view_path(&self.method), &CellClass::annotations())
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let voxels = step.methods[self.number].layers.iter().find_map(Layer::voxels);
        let Some(map) = voxels else { return Ok(()) };
        let truth = step.truth.voxels();
        let truth = truth.map(|t| TrueCells { occupied: t.occupied, observed: t.observed });
        let (changes, slabs) = self.blocks.update(map.values(), truth);
        for change in changes {
            self.write_block(out, change)?;
        }
        if slabs.is_empty() {
            return Ok(());
        }
        for is in slabs {
            self.top_view.draw(self.blocks.numbers(), is);
        }
        let format = ImageFormat::segmentation(self.top_view.size(), rerun::ChannelDatatype::U8);
        let image = SegmentationImage::new(self.top_view.pixels().to_vec(), format);
        out.log(top_view_path(&self.method), &image)
    }

    fn extent_x(&self) -> Option<(usize, usize)> {
        self.occupied_along_x()
    }

    fn panes(&self, shown: &Shown) -> Vec<(Slot, Pane)> {
        vec![(Slot::Space, self.in_space(shown)), (Slot::Above, self.pane_from_above(shown))]
    }
}

impl MapPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        let (spec, method) = (start.info.spec, start.info.methods[number].name.clone());
        let (blocks, top_view) = (Blocks::new(spec), TopView::new(&spec));
        Self { number, method, spec, blocks, top_view, known: BTreeSet::new() }
    }

    /// The map in space, seen from behind and above the first camera.
    fn in_space(&self, shown: &Shown) -> Pane {
        let ([x0, y0, _], c) = (self.spec.origin_m(), self.spec.cell_size_m());
        let along_x = |cells: usize| (x0 + cells as f64 * c) as f32;
        let (from, to) = (along_x(shown.extent_x.0), along_x(shown.extent_x.1 + 1));
        let y = (y0 + self.spec.shape()[1] as f64 * c / 2.0) as f32;
        let length = to - from;
        let eye = EyeControls3D::new()
            .with_kind(Eye3DKind::Orbital)
            .with_position([from - 0.08 * length, y - 0.26 * length, 0.30 * length])
            .with_look_target([from + 0.38 * length, y, 0.0])
            .with_eye_up([0.0, 0.0, 1.0]);
        let colours = if shown.scored {
            "green = right, red = wrong, orange = the truth is unknown there, violet = missed"
        } else {
            "occupied cells"
        };
        let paths = [map_path(&self.method), TRAJECTORY.into(), LASER.into(), CAMERA.into()];
        let pane = Pane::new("3D", format!("{}: {colours}", self.method), "world")
            .with("EyeControls3D", eye)
            .with("Background", dark())
            .with("LineGrid3D", LineGrid3D::new().with_visible(false));
        let mut contents = paths.map(|path| format!("+ /{path}/**")).to_vec();
        contents.push(format!("- /{LABELS}/**"));
        Pane { contents, ..pane }
    }

    /// The map from above, cut to the part that is occupied.
    fn pane_from_above(&self, shown: &Shown) -> Pane {
        let (first, last) = shown.extent_x;
        let area = bounds([first as f64, (last + 1) as f64], [0.0, self.spec.shape()[1] as f64]);
        let title = format!("{} from above: forward is to the right", self.method);
        Pane::new("2D", title, &top_view_path(&self.method))
            .with("VisualBounds2D", area)
            .with("Background", dark())
    }

    fn write_block(&mut self, out: &mut Out<'_>, change: Change) -> Result<()> {
        let Change { block: [i, j, k], class, voxels } = change;
        let path = format!("{}/{}/block_{i}_{j}_{k}", map_path(&self.method), class.name());
        if self.known.insert(([i, j, k], class)) {
            let size = [self.spec.cell_size_m() as f32; 3];
            let mut look = VoxelGridMap::update_fields().with_voxel_size(size).with_colors([class.colour()]);
            if class == CellClass::Missed {
                look = look.with_opacity(0.5);
            }
            out.always(path.as_str(), &look)?;
        }
        out.log(path, &VoxelGridMap::update_fields().with_voxel_indices(voxels))
    }

    /// The cells along x where the map is occupied, first and last; `None` if there are none.
    fn occupied_along_x(&self) -> Option<(usize, usize)> {
        use CellClass::{Hit, Mistake, Occupied, Unobserved};
        let [_, ny, nz] = self.spec.shape();
        let occupied = |&n: &u8| [Hit, Mistake, Occupied, Unobserved].iter().any(|&c| c as u8 == n);
        let first = self.blocks.numbers().iter().position(occupied)?;
        let last = self.blocks.numbers().iter().rposition(occupied)?;
        Some((first / (ny * nz), last / (ny * nz)))
    }
}
