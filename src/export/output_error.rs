//! Why an output could not be begun or put in its place.

use std::io::Error;
use std::path::PathBuf;

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error(
        "the output exists already; name another place, or give --force to replace what an earlier run made: {}",
        path.display()
    )]
    Exists { path: PathBuf },
    #[error(
        "{} would be lost, which no earlier run made, and --force replaces only what one made; move it away or name \
         another place with -o: {}",
        foreign.display(),
        path.display()
    )]
    Foreign { path: PathBuf, foreign: PathBuf },
    #[error("another run is making this output; wait for it or name another place with -o: {}", path.display())]
    Busy { path: PathBuf },
    #[error("the output cannot grow beside its place; remove what is in the way, or name another place: {}", path.display())]
    InTheWay { path: PathBuf },
    #[error("the output needs a name of its own, not a root, \".\" or \"..\": {}", path.display())]
    NoName { path: PathBuf },
    #[error("the folder that shall hold the output does not exist; make it first: {}", path.display())]
    NoParent { path: PathBuf },
    #[error("the output would lie inside a file, expected a folder: {}", path.display())]
    ParentIsAFile { path: PathBuf },
    #[error("cannot write the output: {source}: {}", path.display())]
    Io { path: PathBuf, source: Error },
    #[error("interrupted, nothing was written: {}", path.display())]
    Interrupted { path: PathBuf },
}
