//! The whole cost curve by Bayes' rule: the project's own variant of Brandao et al., derived in
//! docs/cost-curve-bayes.md.

pub mod first_obstacle;
mod look;
mod looks;
mod mapper;
mod ray_sections;
mod settings;

pub use mapper::CostCurveBayes;
pub use settings::CostCurveBayesSettings;
