use anyhow::Result;
use evigrid_core::{Frame, Matching, Mounting, View};
use evigrid_grid::Needs;
use evigrid_methods::Family;
use evigrid_synth::World;
use rayon::prelude::*;

use crate::Config;
use crate::match_source::MatchSource;
use crate::pass::Order;
use crate::stage_times::Times;

/// One setting of the input and of the matcher, with all maps that are made from its matches.
pub(crate) struct Lane {
    source: MatchSource,
    mounting: Option<Mounting>,
    needs: Needs,
    families: Vec<LaneFamily>,
    /// Matches of the current frame.
    matching: Option<Matching>,
}

/// A family of maps, and the entrant that its first map belongs to.
struct LaneFamily {
    family: Family,
    first: usize,
}

impl Lane {
    /// A lane without maps, on a recording of a world if it is synthetic.
    ///
    /// # Errors
    /// As [`MatchSource::new`].
    pub fn new(config: &Config, mounting: Option<Mounting>, world: Option<&World>) -> Result<Self> {
        let (needs, families) = (Needs::NOTHING, Vec::new());
        let source = MatchSource::new(config, mounting, world)?;
        Ok(Self { source, mounting, needs, families, matching: None })
    }

    /// Adds a family of maps whose first one belongs to the entrant `first`; its number.
    pub fn add(&mut self, family: Family, needs: Needs, first: usize) -> usize {
        self.needs = self.needs.and(needs);
        self.families.push(LaneFamily { family, first });
        self.families.len() - 1
    }

    /// A family of maps by its number.
    pub fn family(&self, number: usize) -> &Family {
        &self.families[number].family
    }

    /// Matches of the current frame; `None` if no map needs any.
    pub fn matching(&self) -> Option<&Matching> {
        self.matching.as_ref()
    }

    /// Computes or reads what all maps of the lane share, if any of them needs it.
    pub fn match_pair(&mut self, frame: &Frame, times: &mut Times<'_>) -> Result<()> {
        if self.needs.matches {
            let (source, needs) = (&mut self.source, self.needs);
            self.matching = Some(times.stage("match", None, || source.run(frame, needs))?);
        }
        Ok(())
    }

    /// Integrates the frame into all maps.
    ///
    /// # Errors
    /// If a map cannot take it.
    pub fn integrate(&mut self, frame: &Frame, order: Order, times: &mut Times<'_>) -> Result<()> {
        let nothing;
        let matching = match &self.matching {
            Some(matching) => matching,
            None => {
                nothing = unmatched(frame)?;
                &nothing
            }
        };
        let view = View::new(frame, self.mounting, matching);
        match order {
            Order::SideBySide => self.families.par_iter_mut().try_for_each(|own| own.integrate(&view)),
            Order::InTurn => self.families.iter_mut().try_for_each(|own| {
                let method = Some(own.first);
                times.stage("integrate", method, || own.integrate(&view))
            }),
        }
    }

    /// Gives the buffers of the frame back to the matcher.
    pub fn recycle(&mut self) {
        if let Some(matching) = self.matching.take() {
            self.source.recycle(matching);
        }
    }
}

impl LaneFamily {
    fn integrate(&mut self, view: &View<'_>) -> Result<()> {
        Ok(self.family.mapper.integrate(view)?)
    }
}

/// Matches for methods that look at none: no pixel has a disparity.
fn unmatched(frame: &Frame) -> Result<Matching> {
    let (width, height) = (frame.rig().width, frame.rig().height);
    let nothing = evigrid_core::Disparity::new(width, height, vec![f32::NAN; width * height])?;
    Ok(Matching::from_disparity(nothing))
}
