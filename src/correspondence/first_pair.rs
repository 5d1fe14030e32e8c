//! The first pair of a sample: what each patch may lie on as far as the prior alone says.
//!
//! Method       of every plane that the prior reaches the likelihood is known once and kept, since nothing drawn before changes it; a plane
//!              is drawn by that weight

use nalgebra::Matrix3;

use super::offers::Offers;
use super::rotations::about_up_from;
use super::sample::PatchPlanePair;
use super::sampler::Sampler;
use super::targets::{Target, azimuth};
use super::weighted_choice::Drawn;
use crate::geometry::Vector3;
use crate::robust::Random;

impl Sampler<'_> {
    /// A plane for the first patch of a sample.
    pub(super) fn first_pair(&self, patch: usize, random: &mut Random) -> Option<Drawn<PatchPlanePair>> {
        self.firsts.with(patch, || self.first_offers(patch), |offers| self.draw_first(patch, offers, random))
    }

    fn draw_first(&self, patch: usize, offers: &Offers, random: &mut Random) -> Option<Drawn<PatchPlanePair>> {
        let (id, is_turned_over) = offers.what[random.weighted(&offers.sums)?];
        let normal = self.level_cloud.patches[patch].normal;
        let normal = if is_turned_over { -normal } else { normal };
        Some(Drawn { what: self.pair(patch, normal, id), chance: offers.chance })
    }

    fn first_offers(&self, patch: usize) -> Offers {
        let mut offers = Offers::default();
        for (normal, is_turned_over) in self.level_cloud.patches[patch].sides().zip([false, true]) {
            let offer = |t: &Target, likelihood: f64| offers.add(likelihood, (t.id, is_turned_over));
            if self.up_is_known() {
                self.offer_turned(patch, &normal, offer);
            } else {
                self.offer_leaning(patch, &normal, offer);
            }
        }
        offers.finish()
    }

    /// Planes for the first patch under known up, by the turn about up that leads the patch into each.
    fn offer_turned(&self, patch: usize, normal: &Vector3<f64>, mut offer: impl FnMut(&Target, f64)) {
        let belief = self.belief(Matrix3::identity());
        let has_same_tilt = self.tilted_as(normal);
        self.targets.each_facing(azimuth(normal), self.prior.most_heading_rad(), |t| {
            if has_same_tilt(t) {
                let turned = belief.turned(about_up_from(normal, &t.normal()));
                let likelihood = turned.predict(&self.level_cloud.patches[patch].center).likelihood(t);
                likelihood.into_iter().for_each(|likelihood| offer(t, likelihood));
            }
        });
    }

    /// Planes for the first patch under free up. Its normal is laid onto the plane's; what stays open is a spin about it, which moves the
    /// patch within its plane and not across.
    fn offer_leaning(&self, patch: usize, normal: &Vector3<f64>, mut offer: impl FnMut(&Target, f64)) {
        let belief = self.belief(Matrix3::identity());
        let turn_onto = self.turning(normal);
        for t in self.targets.all() {
            let Some(rotation) = turn_onto(t) else { continue };
            let leaning = belief.turned(rotation).spinning(self.prior.spin_sigma_about(&t.normal()));
            let likelihood = leaning.predict(&self.level_cloud.patches[patch].center).likelihood(t);
            likelihood.into_iter().for_each(|likelihood| offer(t, likelihood));
        }
    }
}
