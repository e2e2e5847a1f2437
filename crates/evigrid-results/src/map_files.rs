use anyhow::{Context, Result};
use evigrid_grid::{HybridModel, Layer, LayerKind};

use crate::ros_map::{write_ros_picture, write_ros_yaml};
use crate::writer::{MethodLayer, layers};
use crate::{
    MethodMaps, PendingFile, ResultsFolder, RunInfo, SealedFile, TruthFile, files, write_layer, write_model,
    write_safety, write_truth,
};

/// Files of maps and truth.
#[derive(Debug)]
pub(crate) struct MapFiles {
    layers: Vec<LayerFile>,
    truth: PendingFile,
    safety_truth: PendingFile,
}

/// The files of one layer of a method.
#[derive(Debug)]
struct LayerFile {
    method: usize,
    kind: LayerKind,
    file: PendingFile,
    /// Of a safety map alone.
    safety: Option<SafetyFiles>,
}

/// A safety map for ROS's map_server, and the 3-D model behind it.
#[derive(Debug)]
struct SafetyFiles {
    /// Name of the picture in its folder.
    name: String,
    picture: PendingFile,
    yaml: PendingFile,
    model: PendingFile,
}

impl MapFiles {
    pub fn create(folder: &ResultsFolder, info: &RunInfo) -> Result<Self> {
        let layers = layers(info).map(|layer| LayerFile::create(folder, &layer));
        Ok(Self {
            layers: layers.collect::<Result<_>>()?,
            truth: folder.create(files::TRUTH)?,
            safety_truth: folder.create(files::SAFETY_TRUTH)?,
        })
    }

    pub fn finish(
        self,
        info: &RunInfo,
        maps: &[MethodMaps<'_>],
        truth: Option<TruthFile<'_>>,
        sealed: &mut Vec<SealedFile>,
    ) -> Result<()> {
        for file in self.layers {
            let (method, kind) = (file.method, file.kind);
            let maps = maps.get(method);
            let layer = maps.and_then(|maps| maps.layers.iter().find(|l| l.kind() == kind));
            let name = &info.methods[method].name;
            let layer = layer.with_context(|| format!("{name}: expected {}, found none", kind.name()))?;
            file.finish(layer, maps.and_then(|maps| maps.hybrid.as_ref()), sealed)?;
        }
        if let Some(voxels) = truth.and_then(|truth| truth.voxels) {
            sealed.push(write_truth(self.truth, &voxels)?);
        }
        if let Some(safety) = truth.and_then(|truth| truth.safety) {
            sealed.push(write_safety(self.safety_truth, safety)?);
        }
        Ok(())
    }
}

impl LayerFile {
    fn create(folder: &ResultsFolder, layer: &MethodLayer<'_>) -> Result<Self> {
        let MethodLayer { method, name, kind } = *layer;
        let is_safety = kind == LayerKind::Safety;
        Ok(Self {
            method,
            kind,
            file: folder.create(&files::map(kind).of(name))?,
            safety: is_safety.then(|| SafetyFiles::create(folder, name)).transpose()?,
        })
    }

    fn finish(
        self,
        layer: &Layer<'_>,
        model: Option<&HybridModel>,
        sealed: &mut Vec<SealedFile>,
    ) -> Result<()> {
        sealed.push(write_layer(self.file, layer)?);
        let (Some(files), Some(map)) = (self.safety, layer.safety()) else { return Ok(()) };
        sealed.push(write_ros_picture(files.picture, map)?);
        sealed.push(write_ros_yaml(files.yaml, &files.name, map)?);
        if let Some(model) = model {
            sealed.push(write_model(files.model, map, model)?);
        }
        Ok(())
    }
}

impl SafetyFiles {
    fn create(folder: &ResultsFolder, method: &str) -> Result<Self> {
        let name = files::ROS_PICTURE.of(method);
        Ok(Self {
            picture: folder.create(&name)?,
            yaml: folder.create(&files::ROS_YAML.of(method))?,
            model: folder.create(&files::MODEL.of(method))?,
            name,
        })
    }
}
