//! What was typed.

mod city;
mod values;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::LazyLock;

use clap::{Parser, Subcommand, ValueEnum};

pub use city::CityArgs;
pub use values::{Accuracy, Budget, Near, Probability, Scale, ScaleRange, UpArg};

/// The version, the commit where whoever built it named one in CITYWELD_COMMIT (a package has no repository to ask), and the features.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let commit = option_env!("CITYWELD_COMMIT").filter(|commit| !commit.is_empty());
    let commit = commit.map_or(String::new(), |commit| format!("commit {commit}, "));
    format!("{} ({commit}features: {})", env!("CARGO_PKG_VERSION"), FEATURES.join(", "))
});

/// The cargo features that this program was built with.
const FEATURES: &[&str] = if cfg!(feature = "flatcitybuf") { &["cli", "flatcitybuf"] } else { &["cli"] };

/// Sets structure-from-motion reconstructions into polyhedral city models.
#[derive(Parser, Debug)]
#[command(
    name = "cityweld",
    version = VERSION.as_str(),
    propagate_version = true,
    subcommand_required = true,
    arg_required_else_help = true,
    max_term_width = 110,
    after_help = "Examples:\n  \
        cityweld demo\n  \
        cityweld align city.obj sfm/ --start start.json --labels labels/ -o out\n  \
        cityweld planes city.glb -o planes.glb\n\n\
        Exit status: 0 aligned, or merged; 1 any other verdict; 2 bad input or use, or output that cannot be written; 130 interrupted, nothing left behind."
)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    Align(AlignArgs),
    Merge(MergeArgs),
    Index(IndexArgs),
    Planes(PlanesArgs),
    Inspect(InspectArgs),
    Export(ExportArgs),
    Demo(DemoArgs),
    Solve(SolveArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// What every command takes.
#[derive(clap::Args, Clone, Debug)]
pub struct Common {
    /// Seed of the random draws; same seed, same answer, whatever the number of threads
    #[arg(
        long,
        global = true,
        value_name = "N",
        default_value_t = 0,
        allow_hyphen_values = true,
        help_heading = "Common options"
    )]
    pub seed: u64,
    /// Threads to work with, at least 1 [default: all cores]
    #[arg(
        long,
        global = true,
        value_name = "N",
        allow_hyphen_values = true,
        value_parser = threads,
        help_heading = "Common options"
    )]
    pub threads: Option<NonZeroUsize>,
    /// No progress, no warnings on standard error; errors still come
    #[arg(long, global = true, help_heading = "Common options", conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say on standard error what goes in and how long each step takes
    #[arg(short, long, global = true, help_heading = "Common options")]
    pub verbose: bool,
    /// Replace OUT if an earlier run made it and nothing else was put there
    #[arg(long, global = true, help_heading = "Common options")]
    pub force: bool,
    /// The summary on standard output as JSON
    #[arg(long, global = true, help_heading = "Common options")]
    pub json: bool,
}

/// Find where a reconstruction stands in a city, judge it, write it there
///
/// Writes a folder OUT with alignment.json (verdict, transform, sigmas), scene.glb (city, points and cameras for any
/// viewer), sfm/ (the COLMAP model moved into the city frame) and points.ply. The city frame is right-handed, metres,
/// z up.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    cityweld align city.obj sfm/ --start start.json --labels labels/ -o out\n  \
    cityweld align city.glb cloud.ply --terrain ground.obj --start start.json -o out\n  \
    cityweld align north.city.json south.city.json sfm/ -o out      (several files, one city; the last is the reconstruction)\n  \
    cityweld align city.obj sfm/ --positions photos/ --crs EPSG:28992 -o out\n  \
    cityweld align city.city.json sfm/ -o out                       (anywhere in the city)\n  \
    cityweld align city.city.json sfm/ --near 85120,447250,300 -o out\n  \
    cityweld align city.obj sfm/ --positions geo.txt --points gcp_list.txt --crs EPSG:28992 --dry-run\n\n\
    A start file:\n  \
    {\"scale\": 12.5, \"rotation\": [[1,0,0],[0,1,0],[0,0,1]], \"translation\": [100, 200, 3],\n   \
    \"position_sigma\": 10, \"height_sigma\": 3, \"rotation_sigma_deg\": 10, \"tilt_sigma_deg\": 2, \"scale_sigma\": 0.15}\n\n\
    It says x_city = scale * rotation * x_sfm + translation (metres, rotation row by row), and how far the middle of the \
    reconstruction may be off, one sigma each: metres horizontally and along up, degrees of heading and of tilt, natural \
    logarithm of the scale. The sigmas shown are those of a file that leaves them out. Where nothing is known of the \
    rotation: the identity, rotation_sigma_deg 180, tilt_sigma_deg 60, and translation = place - scale * middle. The \
    alignment.json of an earlier run is a start, too: by its transform, or else its best_candidate.\n\n\
    Exit status: 0 aligned; 1 any other verdict (alignment.json says why).")]
pub struct AlignArgs {
    /// City model: CityJSON, CityGML, OBJ, glTF, 3D Tiles, STL, PLY with faces, footprints (Shapefile, GeoPackage), a folder of tiles, or an index
    /// (.cwi); several files or folders are one city
    #[arg(value_name = "CITY", num_args = 1.., required = true)]
    pub city: Vec<PathBuf>,
    /// Reconstruction, after CITY: a COLMAP folder; a cloud (PLY, LAS, LAZ, E57); what OpenSfM, ODM, nerfstudio, OpenMVG, Bundler or VisualSFM wrote
    #[arg(value_name = "SFM", required = true)]
    pub sfm: PathBuf,
    /// Folder to make; must not exist (see --force)
    #[arg(short, long, value_name = "OUT", required_unless_present = "dry_run")]
    pub output: Option<PathBuf>,
    /// Coarse place of the reconstruction: JSON (see below), a matrix of 4 x 4 as text, or the alignment.json of an earlier run. Several
    /// of --start, --positions and --points must agree within four sigmas, and are averaged
    #[arg(long, value_name = "FILE")]
    pub start: Option<PathBuf>,
    /// Where the photographs were taken: a folder of photographs (EXIF GPS), database.db of COLMAP, reconstruction.json of OpenSfM, geo.txt
    /// of ODM, a table with a header (Metashape, RealityScan), or lines of name, X, Y, Z [default: --photos, where nothing else is given]
    #[arg(long, value_name = "SOURCE")]
    pub positions: Option<PathBuf>,
    /// Control points: lines x y z X Y Z [sigma [name]] (reconstruction, then city), or gcp_list.txt of ODM; the word check at the end of
    /// a line keeps its point out and has its residual reported
    #[arg(long, value_name = "FILE")]
    pub points: Option<PathBuf>,
    /// Where the middle of the reconstruction may be: searched within that radius, with nothing else known. X,Y[,Z],RADIUS in metres of the city; or
    /// LATITUDE,LONGITUDE,RADIUSm in degrees (WGS 84), the radius in metres with the letter m
    /// [default: without any of --start, --positions, --points, the whole city is searched by the walls of the reconstruction]
    #[arg(long, value_name = "PLACE,RADIUS", allow_hyphen_values = true, conflicts_with_all = ["start", "positions", "points"])]
    pub near: Option<Near>,
    /// Read and check everything, tell the start and its distance from the city, write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Folder of label images (PNG, grey, 8 or 16 bit; 0 is no superpixel), named as the photographs
    #[arg(long, value_name = "DIR")]
    pub labels: Option<PathBuf>,
    /// Folder of the photographs (JPEG or PNG), named as in the reconstruction
    #[arg(long, value_name = "DIR")]
    pub photos: Option<PathBuf>,
    /// Scale that is known, metres per reconstruction unit: held exactly, in place of the start's [default: free]
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    pub scale: Option<Scale>,
    /// Scale that is known in part, metres per reconstruction unit: without a start the city is searched at no other
    #[arg(long, value_name = "LEAST,MOST", conflicts_with_all = ["scale", "start", "positions", "points"])]
    pub scale_range: Option<ScaleRange>,
    /// Seconds after which no more of the city is searched where there is no start: what was left out is told, and then the verdict is
    /// ambiguous or failed; a search that is done before then answers as without [default: all of it is searched]
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["start", "positions", "points"])]
    pub budget: Option<Budget>,
    /// What every freedom must be held to, one sigma in metres at the scene's radius, for the verdict to be aligned [default: 0.35 or 1 % of
    /// the radius, whichever is more]
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub accuracy: Option<Accuracy>,
    /// Up in the reconstruction's frame: auto (walls, floors, cameras and start tell together), none (not used: the search turns
    /// freely, as far as three sigmas of the start's tilt), or X,Y,Z of any length
    #[arg(long, value_name = "UP", default_value = "auto", allow_hyphen_values = true)]
    pub up: UpArg,
    /// Probability of a wrong pose called aligned that may be taken, above 0 and below 1
    #[arg(long, value_name = "CHANCE", default_value = "0.001", allow_hyphen_values = true)]
    pub false_alarm: Probability,
    /// Classes of a LAS, LAZ or COPC cloud whose points take part, such as 2,6 [default: all but noise, 7 and 18]
    #[arg(long, value_name = "CLASSES", value_delimiter = ',', allow_hyphen_values = true)]
    pub classes: Vec<u8>,
    #[command(flatten)]
    pub city_options: CityArgs,
}

/// Join partial reconstructions of one place into one, and account for everything
///
/// Parts are joined over photographs of the same name (one is enough), or over a city. Writes a folder OUT with merge.json
/// (verdict, each part's transform, edges, ledger), sfm/ (one COLMAP model), scene.glb (one colour per part) and
/// points.ply. The frame is the first placed part's, or the city's (metres, z up).
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    cityweld merge part_a part_b -o out\n  \
    cityweld merge colmap/sparse -o out\n  \
    cityweld merge part_a part_b part_c --photos photos/ -o out\n  \
    cityweld merge part_a part_b --city city.obj -o out\n  \
    cityweld merge part_a part_b --city city.gml --crs EPSG:25832 --positions geo.txt -o out\n  \
    cityweld merge part_a part_b --city city.obj --start a.json --start b.json -o out\n\n\
    Exit status: 0 all parts are merged; 1 any other verdict (merge.json says why).")]
pub struct MergeArgs {
    /// Partial reconstructions (COLMAP folders, clouds, what other tools wrote): two or more, or one folder that holds them
    #[arg(value_name = "PART", num_args = 1.., required = true)]
    pub parts: Vec<PathBuf>,
    /// Folder to make; must not exist (see --force)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Folder of the photographs (JPEG or PNG), named as in the reconstructions; the shared ones are enough
    #[arg(long, value_name = "DIR")]
    pub photos: Option<PathBuf>,
    /// Folder of label images (PNG, grey, 8 or 16 bit; 0 is no superpixel), named as the photographs
    #[arg(long, value_name = "DIR")]
    pub labels: Option<PathBuf>,
    /// What of the shared photographs is used: point pairs, camera poses and, with --photos or --labels, planes of
    /// superpixels; or those planes alone, to study them
    #[arg(long, value_name = "WHICH", value_enum, default_value_t = EvidenceArg::All)]
    pub evidence: EvidenceArg,
    /// City model in which the parts meet (as CITY of `align`), once for every file or folder of it; without --start and --positions each part is
    /// searched in the whole of it
    #[arg(long, value_name = "CITY")]
    pub city: Vec<PathBuf>,
    /// Coarse place of a part in the city, JSON (see `align --help`), or its alignment.json; once for every part, in their order
    #[arg(long, value_name = "FILE")]
    pub start: Vec<PathBuf>,
    /// Where the photographs of all parts were taken (as --positions of `align`), matched by name; a part with none of them is searched in
    /// the whole city [default: --photos, where no --start is given]
    #[arg(long, value_name = "SOURCE")]
    pub positions: Option<PathBuf>,
    /// Probability of a wrong place called right that may be taken, of a part in the city as well as between parts; above 0 and below 1
    #[arg(long, value_name = "CHANCE", default_value = "0.001", allow_hyphen_values = true)]
    pub false_alarm: Probability,
    /// Classes of a LAS, LAZ or COPC cloud whose points take part, such as 2,6 [default: all but noise, 7 and 18]
    #[arg(long, value_name = "CLASSES", value_delimiter = ',', allow_hyphen_values = true)]
    pub classes: Vec<u8>,
    #[command(flatten)]
    pub city_options: CityArgs,
}

/// Prepare a city once: an index that is read in its place, as a whole or the part that a job touches
///
/// Writes one file (.cwi): the model in blocks of 250 m, what can be seen of each, its walls. It is given as CITY wherever one is asked
/// for; with a start or --near only the blocks in reach are read. What says how CITY is to be read (--terrain, --lod, ...) is said here and
/// not again. An index whose city has changed is refused.
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  \
    cityweld index city.city.jsonl -o city.cwi\n  \
    cityweld index tiles/ --terrain ground.obj -o city.cwi\n  \
    cityweld align city.cwi sfm/ --near 85120,447250,300 -o out")]
pub struct IndexArgs {
    /// City model, as CITY of `align`; several files or folders are one city
    #[arg(value_name = "CITY", num_args = 1.., required = true)]
    pub city: Vec<PathBuf>,
    /// File to write, .cwi by custom; must not exist (see --force)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub city_options: CityArgs,
}

/// Show what the program sees in a city model: counts, extent, planes, warnings
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Example:\n  cityweld planes city.obj --terrain ground.obj -o planes.glb")]
pub struct PlanesArgs {
    /// City model, as CITY of `align`; several files or folders are one city
    #[arg(value_name = "CITY", num_args = 1.., required = true)]
    pub city: Vec<PathBuf>,
    /// File to write: .glb (coloured by plane) or .json
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub city_options: CityArgs,
}

/// Show what the program sees in any input: a city, a reconstruction, photographs, positions, control points
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Example:\n  cityweld inspect city.obj sfm/ photos/ geo.txt gcp_list.txt --json\n\n\
    With --json: an array with one object for each path.\n\n\
    Exit status: 0 all are told; 2 one cannot be read.")]
pub struct InspectArgs {
    /// Files and folders
    #[arg(value_name = "PATH", num_args = 1.., required = true)]
    pub paths: Vec<PathBuf>,
}

/// Print what a shell needs to complete the words of a command line
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Example:\n  cityweld completions bash > ~/.local/share/bash-completion/completions/cityweld")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: clap_complete::Shell,
}

/// Print a manual page (roff), or write all of them
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Examples:\n  cityweld man align | man -l -\n  cityweld man -o ~/.local/share/man/man1")]
pub struct ManArgs {
    /// The command whose page it is [default: the program]
    #[arg(value_name = "COMMAND")]
    pub command: Option<String>,
    /// Folder to write the pages of the program and of all commands to
    #[arg(short, long, value_name = "DIR", conflicts_with = "command")]
    pub output: Option<PathBuf>,
}

/// Write a given (or edited) alignment again, in the formats asked for
#[derive(clap::Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  cityweld export city.obj sfm/ --alignment out/alignment.json --format glb,ply -o again"
)]
pub struct ExportArgs {
    /// City model: CityJSON, CityGML, OBJ, glTF, 3D Tiles, STL, PLY with faces, footprints (Shapefile, GeoPackage), a folder of tiles, or an index
    /// (.cwi); several files or folders are one city
    #[arg(value_name = "CITY", num_args = 1.., required = true)]
    pub city: Vec<PathBuf>,
    /// Reconstruction, after CITY: a COLMAP folder; a cloud (PLY, LAS, LAZ, E57); what OpenSfM, ODM, nerfstudio, OpenMVG, Bundler or VisualSFM wrote
    #[arg(value_name = "SFM", required = true)]
    pub sfm: PathBuf,
    /// alignment.json whose transform (or else best_candidate) is used
    #[arg(long, value_name = "FILE")]
    pub alignment: PathBuf,
    /// Folder to make; must not exist (see --force)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// glb: scene.glb; colmap: sfm/; ply: points.ply [default: all that the reconstruction allows]. colmap alone is not
    /// replaced by --force, as nothing tells it from a model of your own
    #[arg(long, value_name = "FORMATS", value_enum, value_delimiter = ',')]
    pub format: Vec<FormatArg>,
    /// Classes of a LAS, LAZ or COPC cloud whose points take part, such as 2,6 [default: all but noise, 7 and 18]
    #[arg(long, value_name = "CLASSES", value_delimiter = ',', allow_hyphen_values = true)]
    pub classes: Vec<u8>,
    #[command(flatten)]
    pub city_options: CityArgs,
}

/// Align the sample that is inside the program: a city block of Rotterdam and a reconstruction of it
#[derive(clap::Args, Clone, Debug)]
pub struct DemoArgs {
    /// Folder to make; must not exist (see --force)
    #[arg(short, long, value_name = "OUT", default_value = "cityweld-demo")]
    pub output: PathBuf,
}

/// Run the minimal solvers on one point-to-plane problem and print all poses as JSON
#[derive(clap::Args, Clone, Debug)]
#[command(after_help = "Example:\n  \
    echo '{\"kind\": \"rigid\", \"points\": [[1,2,0],[3,1,0],[2,5,0],[0,1,4],[0,2,1],[3,0,2]],\n         \
    \"planes\": [{\"normal\": [0,0,1], \"offset\": 0}, {\"normal\": [1,0,0], \"offset\": 0},\n                    \
    {\"normal\": [0,1,0], \"offset\": 0}],\n         \
    \"pairs\": [[0,0],[1,0],[2,0],[3,1],[4,1],[5,2]]}' | cityweld solve -\n\n\
    Point i lies on plane j for each pair [i, j]; a plane is normal . x + offset = 0. assets/problem.schema.json \
    describes problem and answer.\n\n\
    Exit status: 0 all poses are told; 1 the pose is not determined, and why; 2 no problem, or one that is ill-formed.")]
pub struct SolveArgs {
    /// The problem, JSON; `-` is standard input
    #[arg(value_name = "PROBLEM.json")]
    pub problem: String,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvidenceArg {
    All,
    Planes,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatArg {
    Glb,
    Colmap,
    Ply,
}

fn threads(text: &str) -> Result<NonZeroUsize, &'static str> {
    text.parse().map_err(|_| "expected a whole number of 1 or more")
}

#[cfg(test)]
mod tests;
