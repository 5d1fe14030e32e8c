//! `cityweld align`

use crate::Place;
use crate::city::CityIndex;
use crate::export::{
    CityCounts, InputSummary, Output, OutputKind, SfmCounts, alignment_report, start_report, write_alignment,
};
use crate::georeference::Estimate;
use crate::imagery::{LiftedSuperpixels, SuperpixelOptions, lift_superpixels};
use crate::place_search::PlacePrior;
use crate::planes::PreparedCity;
use crate::reconstruction::{Reconstruction, read_reconstruction_with};
use crate::verdict::Verdict;
use anyhow::Result;

use super::args::AlignArgs;
use super::plan::{AlignPlan, file_name};
use super::{Outcome, Session, summary};

pub fn run(args: &AlignArgs, session: &Session) -> Result<Outcome> {
    let plan = AlignPlan::new(args, session.common.seed)?;
    let output = plan.output.as_ref().map(|path| session.begin(path, OutputKind::Folder)).transpose()?;
    carry_out(&plan, output, session)
}

/// Aligns, writes into `output`, puts it in its place and tells; without an output the start alone is told.
pub fn carry_out(plan: &AlignPlan, output: Option<Output>, session: &Session) -> Result<Outcome> {
    let voice = &session.voice;
    let mut inputs = Inputs::read(plan, session)?;
    let Some((output, place)) = output.zip(plan.output.as_ref()) else {
        return tell_start(&inputs, plan, session);
    };
    let options = plan.options(inputs.place());
    let superpixels = inputs.superpixels.as_ref();
    let mut alignment = match &inputs.index {
        None => crate::align(&inputs.city, &inputs.sfm, superpixels, &options, &voice.bar)?,
        Some(index) => {
            let found = crate::align_in_index(index, &inputs.sfm, superpixels, &options, &voice.bar)?;
            inputs.city = found.city;
            found.alignment
        }
    };
    voice.detail(&format!("{}: {}", alignment.verdict.word(), alignment.reason));
    alignment.warnings.splice(0..0, inputs.warnings(plan));

    voice.bar.show("writing", 0, 0);
    let summary = inputs.summary(plan);
    let files = write_alignment(output.path(), &alignment, &summary, &inputs.city.model, &inputs.sfm)?;
    output.commit()?;
    voice.detail(&format!("{} written", place.display()));

    voice.warnings(&alignment.warnings);
    if session.common.json {
        voice.json(&alignment_report(&alignment, &summary)?, Some(place))?;
    } else {
        let table = summary::of_alignment(&alignment, place, &files, voice.seconds());
        voice.result(&table, Some(place))?;
    }
    Ok(if alignment.verdict == Verdict::Aligned { Outcome::Good } else { Outcome::Doubtful })
}

struct Inputs {
    /// Without anything in it where an index is to be searched.
    city: PreparedCity,
    /// Searched by its walls, so that not all of it need be read.
    index: Option<CityIndex>,
    sfm: Reconstruction,
    superpixels: Option<LiftedSuperpixels>,
    /// Without one the city is searched.
    start: Option<KnownStart>,
    prior: PlacePrior,
}

struct KnownStart {
    estimate: Estimate,
    /// From the start to the nearest facet, metres.
    distance_m: f64,
}

/// What `--dry-run` tells.
fn tell_start(inputs: &Inputs, plan: &AlignPlan, session: &Session) -> Result<Outcome> {
    let voice = &session.voice;
    voice.warnings(&inputs.warnings(plan));
    let start = inputs.start.as_ref().map(|known| (&known.estimate, known.distance_m));
    if session.common.json {
        voice.json(&start_report(start)?, None)?;
    } else {
        voice.result(&summary::of_start(start, inputs.prior.near, voice.seconds()), None)?;
    }
    Ok(Outcome::Good)
}

fn read_sfm(plan: &AlignPlan, session: &Session) -> Result<Reconstruction> {
    let voice = &session.voice;
    voice.bar.show("reading the reconstruction", 0, 0);
    let sfm = read_reconstruction_with(&plan.sfm, &plan.sfm_options)?;
    voice.detail(&format!("reconstruction: {} points, {} images", sfm.points.len(), sfm.images.len()));
    Ok(sfm)
}

impl Inputs {
    fn read(plan: &AlignPlan, session: &Session) -> Result<Inputs> {
        let voice = &session.voice;
        // Of an index only what the start can reach is read, so the start comes first.
        let index = plan.city.index()?;
        let frame = index.as_ref().map(CityIndex::read_frame).transpose()?;
        let early = frame.as_ref().map(|_| read_sfm(plan, session)).transpose()?;
        let within = match frame.as_ref().zip(early.as_ref()) {
            Some((frame, sfm)) => plan.place.surroundings(sfm, frame, plan.fixed_scale())?,
            None => None,
        };
        voice.bar.show("reading the city", 0, 0);
        let index = index.filter(|_| plan.place.is_anywhere());
        let city = match frame.filter(|_| index.is_some()) {
            Some(frame) => frame,
            None => plan.city.read(within.as_ref())?,
        };
        voice.detail(&format!("city: {} facets of {} objects are read", city.facets.len(), city.objects.len()));
        let prior = plan.place.prior(&city)?;
        let sfm = early.map_or_else(|| read_sfm(plan, session), Ok)?;
        let start = match plan.place.estimate(&sfm, &city)? {
            Some(estimate) => {
                let distance_m = estimate.distance_to_city(&sfm.points, &city).inspect_err(|_| {
                    // A unit or an axis that is not what it was taken for leads a start away.
                    voice.warnings(&city.warnings.iter().map(ToString::to_string).collect::<Vec<_>>());
                })?;
                voice.detail(&format!("start: {}; {distance_m:.1} m from the nearest facet", estimate.source));
                Some(KnownStart { estimate, distance_m })
            }
            None => {
                voice.detail("start: none, the city is searched");
                None
            }
        };
        // A dry run does without what takes minutes.
        let superpixels = match plan.superpixels.as_ref().filter(|_| plan.output.is_some()) {
            None => None,
            Some(source) => {
                let lifted = lift_superpixels(&sfm, source, &SuperpixelOptions::default(), &voice.bar)?;
                voice.detail(&format!("superpixels: {}", lifted.superpixels.len()));
                Some(lifted)
            }
        };
        Ok(Inputs { city: PreparedCity::new(city), index, sfm, superpixels, start, prior })
    }

    fn place(&self) -> Place {
        self.start.as_ref().map_or(Place::Anywhere(self.prior), |known| Place::Start(known.estimate.start))
    }

    /// What was tolerated while reading, once each.
    fn warnings(&self, plan: &AlignPlan) -> Vec<String> {
        let mut warnings = plan.warnings.clone();
        warnings.extend(self.city.model.warnings.iter().map(ToString::to_string));
        warnings.extend(self.sfm.warnings.iter().map(ToString::to_string));
        if let Some(known) = self.start.as_ref().filter(|_| plan.has_budget()) {
            warnings.push(format!(
                "--budget is of no use: the city is not searched, the start is known ({})",
                known.estimate.source
            ));
        }
        warnings.extend(self.start.iter().flat_map(|known| &known.estimate.warnings).cloned());
        warnings.extend(self.superpixels.iter().flat_map(|lifted| &lifted.warnings).map(ToString::to_string));
        warnings
    }

    fn summary(&self, plan: &AlignPlan) -> InputSummary {
        let superpixels = self.superpixels.as_ref().map(|lifted| lifted.superpixels.len());
        InputSummary {
            city: CityCounts::of(&self.city.model, plan.city.names()),
            sfm: SfmCounts::of(&self.sfm, file_name(&plan.sfm), superpixels),
            prior: self.start.as_ref().map(|known| known.estimate.clone()),
        }
    }
}
