//! Ctrl-C: what is half made goes away, then the program ends with the status that shells expect.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::export::{Discard, Output, OutputError, OutputKind, Replace};

/// 128 + SIGINT, as shells have it.
const EXIT_INTERRUPTED: i32 = 130;

/// A limit on the size of files then fails the write that passes it, which is told, instead of ending the program.
pub fn outlive_file_limits() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Knows what to remove when the user interrupts.
#[derive(Clone, Default)]
pub struct Interrupt {
    raised: Arc<AtomicBool>,
    under_way: Arc<Mutex<Vec<Discard>>>,
}

impl Interrupt {
    /// Listens for interruptions from now on.
    pub fn listen() -> Interrupt {
        let interrupt = Interrupt::default();
        let heard = interrupt.clone();
        // Without a handler the system ends the program at once, which is worse only for a half-made folder.
        let _ = ctrlc::set_handler(move || {
            heard.raised.store(true, Ordering::SeqCst);
            for discard in heard.under_way.lock().unwrap_or_else(PoisonError::into_inner).iter() {
                discard.discard();
            }
            std::process::exit(EXIT_INTERRUPTED);
        });
        interrupt
    }

    /// Begins output that is removed if an interruption comes before it is whole. The list is held meanwhile, so that
    /// an interruption finds the folder in it or comes before there is one.
    pub fn begin(&self, target: &Path, kind: OutputKind, replace: Replace) -> Result<Output, OutputError> {
        let mut under_way = self.under_way.lock().unwrap_or_else(PoisonError::into_inner);
        let output = Output::begin(target, kind, replace)?;
        under_way.push(output.discard());
        Ok(output)
    }

    /// Lets an interruption under way end the program: the errors that it caused are not told.
    pub fn give_way(&self) {
        while self.raised.load(Ordering::SeqCst) {
            std::thread::park();
        }
    }
}
