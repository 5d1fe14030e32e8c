//! Files to city model, on one page: which format each is, one frame for all, polygons, model.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::build::build;
use super::files::{CityFiles, open};
use super::frame::Frame;
use super::levels::choose;
use super::recognise::{Format, is_index_at, recognise};
use super::source::Source;
use super::tiles::{keep_filled, shared_names};
use super::units::guess;
use super::upright::odd_up;
use super::warning::{CityDefect, CityPlace, CityWarning};
use super::{CityContents, CityError, CityIndex, CityModel, CityOptions, CityRole, CityUnit, CityUp, PlanBox};
use crate::format::citygml::{is_citygml, read_citygml};
use crate::format::cityjson::read_cityjson;
use crate::format::file::open_regular;
use crate::format::footprints::{read_geopackage, read_shapefile};
use crate::format::gltf::{GltfFile, read_gltf};
use crate::format::meshes::{read_ply_mesh, read_stl};
use crate::format::obj::{ObjFile, read_obj};
use crate::format::surfaces::SurfaceFile;
use crate::format::tileset::{TilesetFile, read_tile, read_tileset};

/// Reads CITY (a file, or a folder of tiles) and further meshes (terrain) into one model with one common origin.
pub fn read_city(city: &Path, terrain: &[PathBuf], options: &CityOptions) -> Result<CityModel, CityError> {
    read_city_files(&[city.to_owned()], terrain, options)
}

/// As [`read_city_files`]; of a city that is an index, only the blocks that a box of plan touches.
pub fn read_city_within(
    city: &[PathBuf],
    terrain: &[PathBuf],
    options: &CityOptions,
    within: &PlanBox,
) -> Result<CityModel, CityError> {
    match index_of(city, terrain, options)? {
        Some(index) => index.read_within(within),
        None => read_city_files(city, terrain, options),
    }
}

/// The index that is given as the city; whatever else is given with it was to be told when it was made.
fn index_of(city: &[PathBuf], terrain: &[PathBuf], options: &CityOptions) -> Result<Option<CityIndex>, CityError> {
    let Some(index) = city.iter().find(|path| is_index_at(path)) else { return Ok(None) };
    let found = match () {
        () if city.len() > 1 => "the other files",
        () if !terrain.is_empty() => "the terrain",
        () if *options != CityOptions::default() => "the options of the city",
        () => return CityIndex::open(index).map(Some),
    };
    Err(CityError::IndexNotAlone { path: index.clone(), found })
}

/// As [`read_city`], of several files or folders that are one city.
pub fn read_city_files(city: &[PathBuf], terrain: &[PathBuf], options: &CityOptions) -> Result<CityModel, CityError> {
    if let Some(index) = index_of(city, terrain, options)? {
        return index.read_all();
    }
    let mut parsed = Vec::new();
    let mut warnings = Vec::new();
    for (paths, role) in [(city, CityRole::City), (terrain, CityRole::Terrain)] {
        for path in paths {
            let before = parsed.len();
            let mut files = CityFiles::at(path)?;
            for path in std::mem::take(&mut files.paths) {
                parsed.extend(files.taken(&path, Parsed::read(&path, role, options))?);
            }
            warnings.extend(files.rest(parsed.len() - before)?);
        }
    }
    let (model, judged) = placed(parsed, options)?;
    Ok(model.with_warnings_first(warnings.into_iter().chain(judged).collect()))
}

/// What each file of a city holds, by its path, whether or not anything in it can be aligned with.
pub fn read_city_contents(city: &[PathBuf], options: &CityOptions) -> Result<Vec<(PathBuf, CityContents)>, CityError> {
    if let Some(index) = index_of(city, &[], options)? {
        return Ok(index.contents());
    }
    let mut contents = Vec::new();
    for path in city {
        let before = contents.len();
        let mut files = CityFiles::at(path)?;
        for path in std::mem::take(&mut files.paths) {
            let parsed = files.taken(&path, Parsed::read(&path, CityRole::City, options))?;
            contents.extend(parsed.map(|parsed| (parsed.path.clone(), parsed.contents())));
        }
        files.rest(contents.len() - before)?;
    }
    Ok(contents)
}

/// Brings all files into one frame and builds the model; with what concerns the city as a whole.
fn placed(parsed: Vec<Parsed>, options: &CityOptions) -> Result<(CityModel, Vec<CityWarning>), CityError> {
    let surfaces: Vec<&SurfaceFile> = parsed.iter().filter_map(Parsed::surfaces).collect();
    let frame = Frame::of(&surfaces, options);
    let without_use = options.without_use(&surfaces);
    let up_of_first = parsed.first().map_or(CityUp::Z, |file| file.up(options));
    let sources: Vec<Source> = parsed.into_iter().map(|file| file.into_source(&frame, options)).collect();
    let sources = keep_filled(sources)?;
    sources.iter().try_for_each(Source::check_reach)?;
    let first = sources.first().map_or(PathBuf::new(), |source| source.path.clone());
    let of_city = |defect| {
        let example = CityPlace { path: first.clone(), line: None, object: String::new() };
        CityWarning { defect, count: 1, example }
    };
    let guess = if options.unit.is_none() { guess(&sources) } else { None };
    let odd_heights = guess.map(|guess| CityDefect::OddHeights { unit: guess.unit, height: guess.height });
    let shared_names = shared_names(&sources);
    let mut model = build(sources)?;
    let decided = without_use
        .into_iter()
        .chain(frame.defects.iter().cloned())
        .chain(odd_heights)
        .chain(odd_up(&model, up_of_first));
    let warnings = decided.map(of_city).chain(shared_names).collect();
    model.crs = frame.crs;
    Ok((model, warnings))
}

/// A file as its format has it.
struct Parsed {
    path: PathBuf,
    role: CityRole,
    content: Content,
}

enum Content {
    Obj(ObjFile),
    Gltf(GltfFile),
    Surfaces(SurfaceFile),
}

/// CityGML is read as it comes, however long it is; `None` where the file is something else.
fn citygml_at(path: &Path) -> Result<Option<SurfaceFile>, CityError> {
    let unreadable = |reason| CityError::Unreadable { path: path.to_owned(), reason };
    let mut file = BufReader::with_capacity(BEGINNING_BYTES, open_regular(path).map_err(unreadable)?);
    if !is_citygml(file.fill_buf().map_err(unreadable)?) {
        return Ok(None);
    }
    let failed = |error| CityError::Surfaces { path: path.to_owned(), error: Box::new(error) };
    read_citygml(file).map(Some).map_err(failed)
}

/// Bytes that tell whether a file is CityGML.
const BEGINNING_BYTES: usize = 1 << 16;

/// Tiles with where they stand on the earth, if they say it.
fn surfaces_of_tiles(tiles: TilesetFile) -> SurfaceFile {
    let crs = tiles.tangent().map(|[latitude, longitude]| {
        format!("east, north, up at {latitude:.7}, {longitude:.7} (WGS 84), set upright from earth-centred coordinates")
    });
    SurfaceFile { step: Some(tiles.spacing_m), crs, ..tiles.surfaces }
}

impl Parsed {
    fn read(path: &Path, role: CityRole, options: &CityOptions) -> Result<Parsed, CityError> {
        let content = match citygml_at(path)? {
            Some(file) => Content::Surfaces(file),
            None => Parsed::content(path, options)?,
        };
        Ok(Parsed { path: path.to_owned(), role, content })
    }

    fn content(path: &Path, options: &CityOptions) -> Result<Content, CityError> {
        let bytes = open(path)?;
        let of_path = || path.to_owned();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let surfaces = match recognise(&bytes, path)? {
            Format::Gltf => {
                let file = read_gltf(&bytes, path.parent().unwrap_or(Path::new("")));
                return file
                    .map(Content::Gltf)
                    .map_err(|error| CityError::Gltf { path: of_path(), error: Box::new(error) });
            }
            Format::CityJson => {
                let file = read_cityjson(&bytes);
                return file
                    .map(Content::Surfaces)
                    .map_err(|error| CityError::CityJson { path: of_path(), error: Box::new(error) });
            }
            #[cfg(feature = "flatcitybuf")]
            Format::FlatCityBuf => crate::format::flatcitybuf::read_flatcitybuf(&bytes),
            Format::Obj => {
                return read_obj(&bytes).map(Content::Obj).map_err(|error| CityError::Obj { path: of_path(), error });
            }
            Format::Tileset => read_tileset(path).map(surfaces_of_tiles),
            Format::Tile => read_tile(&bytes, path).map(surfaces_of_tiles),
            Format::Shapefile => read_shapefile(path, &options.footprints),
            Format::GeoPackage => read_geopackage(path, &options.footprints),
            Format::Stl => read_stl(&bytes, &name),
            Format::PlyMesh => read_ply_mesh(&bytes, &name),
        };
        surfaces.map(Content::Surfaces).map_err(|error| CityError::Surfaces { path: of_path(), error: Box::new(error) })
    }

    fn surfaces(&self) -> Option<&SurfaceFile> {
        match &self.content {
            Content::Surfaces(file) => Some(file),
            _ => None,
        }
    }

    fn contents(&self) -> CityContents {
        match &self.content {
            Content::Obj(file) => CityContents::plain("OBJ", file.objects.len(), file.face_ends.len()),
            Content::Gltf(file) => {
                let triangles = file.parts.iter().map(|part| part.triangles.len()).sum();
                CityContents::plain("glTF 2.0", file.parts.len(), triangles)
            }
            Content::Surfaces(file) => CityContents::of(file),
        }
    }

    /// The axis that points up in the file.
    fn up(&self, options: &CityOptions) -> CityUp {
        let own = if matches!(self.content, Content::Gltf(_)) { CityUp::Y } else { CityUp::Z };
        options.up.unwrap_or(own)
    }

    fn into_source(self, frame: &Frame, options: &CityOptions) -> Source {
        let up = self.up(options);
        let (path, role) = (&self.path, self.role);
        let mut source = match self.content {
            Content::Obj(file) => Source::from_obj(path, role, file),
            Content::Gltf(file) => Source::from_gltf(path, role, file),
            Content::Surfaces(file) => {
                let chosen = choose(&file, options.lod, role);
                Source::from_surfaces(path, role, file, &chosen, frame)
            }
        };
        source.turn(up);
        // What was projected is in metres already.
        let unit = if frame.projection.is_some() { CityUnit::Metre } else { options.unit.unwrap_or_default() };
        source.scale_and_shift(unit.metres(), options.origin);
        source
    }
}
