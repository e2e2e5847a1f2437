use evigrid_core::SettingError;
use evigrid_grid::{GridSpec, LayerKind, Mapper, MapperFamily, Method, Needs};

use super::mapper::WinnerTakeAll;
use super::peak_ratios::PeakRatios;
use super::settings::WinnerTakeAllSettings;

impl Method for WinnerTakeAll {
    const NAME: &'static str = "winner-take-all";
    const SUMMARY: &'static str = "Elfes' inverse model with a Gaussian around the best match of each pixel: \
        the baseline of Brandao et al.";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = WinnerTakeAllSettings;

    fn check(settings: &WinnerTakeAllSettings) -> Result<(), SettingError> {
        settings.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &WinnerTakeAllSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self::new(spec, *settings)?))
    }

    /// Maps that differ in nothing but the peak ratio share their drawing ([`PeakRatios`]).
    fn shares(a: &WinnerTakeAllSettings, b: &WinnerTakeAllSettings) -> bool {
        WinnerTakeAllSettings { peak_ratio: b.peak_ratio, ..*a } == *b
    }

    fn build_family(
        spec: GridSpec,
        settings: &[WinnerTakeAllSettings],
    ) -> Result<Option<Box<dyn MapperFamily>>, SettingError> {
        let Some(&shared) = settings.first() else { return Ok(None) };
        let ratios: Vec<f64> = settings.iter().map(|settings| settings.peak_ratio).collect();
        Ok(Some(Box::new(PeakRatios::new(spec, shared, &ratios)?)))
    }
}
