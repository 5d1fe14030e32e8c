//! How much of a scan is done, and whether it goes on.

use crate::observer::{Cancelled, Observer, Stage, check_cancelled};

pub struct Effort<'a> {
    is_over: &'a dyn Fn() -> bool,
    observer: &'a dyn Observer,
    /// Walls of the city, once for each view.
    all: usize,
    done: usize,
    poses: u64,
    stopped: bool,
}

impl Effort<'_> {
    pub fn new<'a>(all: usize, is_over: &'a dyn Fn() -> bool, observer: &'a dyn Observer) -> Effort<'a> {
        Effort { is_over, observer, all, done: 0, poses: 0, stopped: false }
    }

    /// Asked before each round: whether there is no time for it.
    pub fn is_over(&mut self) -> bool {
        self.stopped = self.stopped || (self.is_over)();
        self.stopped
    }

    pub fn begin_round(&self) -> Result<(), Cancelled> {
        self.observer.progress(Stage::Places, self.done, self.all);
        check_cancelled(self.observer)
    }

    pub fn add(&mut self, walls: usize, poses: u64) {
        self.done += walls;
        self.poses += poses;
    }

    /// Share of the walls of the city that poses were tied to.
    pub fn share(&self) -> f64 {
        if self.all == 0 { 1.0 } else { self.done as f64 / self.all as f64 }
    }

    /// Poses that were looked at, and those that would have been.
    pub fn poses(&self) -> u64 {
        (self.poses as f64 / self.share().max(f64::MIN_POSITIVE)) as u64
    }
}
