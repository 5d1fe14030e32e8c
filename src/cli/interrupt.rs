//! Ctrl-C: what is half made goes away, then the program ends with the status that shells expect.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use cityweld::export::{Discard, Output};

/// 128 + SIGINT, as shells have it.
const EXIT_INTERRUPTED: i32 = 130;

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

    /// Has `output` removed if an interruption comes before it is whole.
    pub fn guard(&self, output: &Output) {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner).push(output.discard());
    }

    /// Lets an interruption under way end the program: the errors that it caused are not told.
    pub fn give_way(&self) {
        while self.raised.load(Ordering::SeqCst) {
            std::thread::park();
        }
    }
}
