//! The walk from a tileset down to its finest content.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix4, Point3, Vector3};

use super::content::{Batched, Container, parts_of};
use super::earth::local_from_ecef;
use super::mesh::{Placement, add_model};
use super::tree::{Refine, Slot, Tile, Tileset, UpAxis, is_tileset};
use crate::format::file::{LARGEST_MODEL_BYTES, read_regular};
use crate::format::surface_builder::SurfaceBuilder;
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::SurfaceFile;
use crate::format::uri::{percent_decoded, shortened};
use crate::geometry::Similarity;

/// Tilesets within one another; a country's are three deep.
const DEEPEST_TILESET: usize = 16;

/// Composite tiles within one another.
const DEEPEST_COMPOSITE: usize = 4;

/// Corners and positions of all tiles: memory for this many is what a large machine has.
const MOST_ELEMENTS: usize = 1 << 27;

/// The longest tileset.json, bytes. Chosen: a million tiles.
const LARGEST_TILESET_BYTES: u64 = 1 << 30;

/// All surfaces of a tileset, and where they stand on the earth.
#[derive(Debug)]
pub struct TilesetFile {
    /// Triangles; z up.
    pub surfaces: SurfaceFile,
    /// The turn that was made from earth-centred coordinates (ECEF of WGS 84, EPSG:4978): x east, y north, z height above the
    /// ellipsoid. `None` where the coordinates are as the tiles have them.
    pub local_from_ecef: Option<Similarity>,
    /// Distance of neighbouring numbers in the models: no finer than this are positions known, metres.
    pub spacing_m: f64,
}

impl TilesetFile {
    /// Where the local plane touches the ellipsoid, latitude and longitude in degrees; `None` where the coordinates are not earth-centred.
    pub fn tangent(&self) -> Option<[f64; 2]> {
        // Up of the local frame is the ellipsoid's normal, whose angles are the geodetic latitude and longitude.
        let up = self.local_from_ecef.as_ref()?.rotation.inverse() * Vector3::z();
        Some([up.z.clamp(-1.0, 1.0).asin().to_degrees(), up.y.atan2(up.x).to_degrees()])
    }
}

/// Reads `tileset.json` and all that it names.
pub fn read_tileset(path: &Path) -> Result<TilesetFile, SurfaceError> {
    let mut walk = Walk::default();
    walk.tileset(path, Matrix4::identity(), None)?;
    walk.builder.file.format = format!("3D Tiles {}", walk.version.clone().unwrap_or_default());
    Ok(walk.finish())
}

/// Reads one tile by itself (b3dm, cmpt) from its bytes; `path` is where they are from.
pub fn read_tile(bytes: &[u8], path: &Path) -> Result<TilesetFile, SurfaceError> {
    let what = match Container::of(bytes) {
        Container::Instanced => Some("an instanced 3D model (i3dm)"),
        Container::Points => Some("a point cloud tile (pnts)"),
        _ => None,
    };
    if let Some(what) = what {
        let problem = format!("this is {what} of 3D Tiles, which is not read; expected a batched model (b3dm) or glTF");
        return Err(SurfaceError::whole(problem));
    }
    let mut walk = Walk::default();
    walk.content(bytes, path, Matrix4::identity(), 0)?;
    walk.builder.file.format = "3D Tiles tile (b3dm)".to_owned();
    Ok(walk.finish())
}

#[derive(Default)]
struct Walk {
    builder: SurfaceBuilder,
    version: Option<String>,
    up: UpAxis,
    /// Tilesets that are being read, the outermost first, by their real paths.
    open: Vec<PathBuf>,
    bytes: u64,
    spacing_m: f64,
}

impl Walk {
    fn finish(mut self) -> TilesetFile {
        let local_from_ecef = local_from_ecef(&self.builder.file.positions);
        if let Some(local) = &local_from_ecef {
            for position in &mut self.builder.file.positions {
                *position = (local.rotation * Point3::from(*position) + local.translation).into();
            }
        }
        TilesetFile { surfaces: self.builder.file, local_from_ecef, spacing_m: self.spacing_m }
    }

    fn tileset(&mut self, path: &Path, parent: Matrix4<f64>, refine: Option<Refine>) -> Result<(), SurfaceError> {
        let bytes = self.read(path, LARGEST_TILESET_BYTES)?;
        self.tileset_of(&bytes, path, parent, refine).map_err(|error| error.in_file(path))
    }

    fn tileset_of(
        &mut self,
        bytes: &[u8],
        path: &Path,
        parent: Matrix4<f64>,
        refine: Option<Refine>,
    ) -> Result<(), SurfaceError> {
        let real = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if self.open.contains(&real) {
            return Err(SurfaceError::whole(
                "the tileset names itself, by way of others or at once; expected a tree of tilesets",
            ));
        }
        if self.open.len() >= DEEPEST_TILESET {
            return Err(SurfaceError::whole(format!(
                "more than {DEEPEST_TILESET} tilesets stand within one another; write fewer levels"
            )));
        }
        let Tileset { version, up, root } = Tileset::parse(bytes)?;
        self.version.get_or_insert(version);
        let up_before = std::mem::replace(&mut self.up, up);
        self.open.push(real);
        let folder = path.parent().unwrap_or(Path::new(""));
        let walked = self.tile(&root, folder, parent, refine.unwrap_or(Refine::Replace));
        self.open.pop();
        self.up = up_before;
        walked
    }

    /// Content that is replaced by finer one is not read.
    fn tile(&mut self, tile: &Tile, folder: &Path, parent: Matrix4<f64>, refine: Refine) -> Result<(), SurfaceError> {
        if tile.is_implicit {
            let problem = "the tileset has implicit tiling, which is not read; export it with its tiles written out";
            return Err(SurfaceError::whole(problem));
        }
        let root_from_tile = match tile.transform {
            Some(matrix) => parent * checked(matrix)?,
            None => parent,
        };
        let refine = tile.refine.unwrap_or(refine);
        let children = || tile.children.iter().filter_map(|Slot(child)| child.as_deref());
        if refine == Refine::Add || !children().any(Tile::has_content) {
            for uri in &tile.contents {
                self.named(uri, folder, root_from_tile, refine)?;
            }
        }
        children().try_for_each(|child| self.tile(child, folder, root_from_tile, refine))
    }

    fn named(
        &mut self,
        uri: &str,
        folder: &Path,
        root_from_tile: Matrix4<f64>,
        refine: Refine,
    ) -> Result<(), SurfaceError> {
        let path = folder.join(relative_path(uri)?);
        let bytes = self.read(&path, LARGEST_MODEL_BYTES)?;
        if is_tileset(&bytes) {
            return self.tileset_of(&bytes, &path, root_from_tile, Some(refine)).map_err(|error| error.in_file(&path));
        }
        self.content(&bytes, &path, root_from_tile, 0).map_err(|error| error.in_file(&path))
    }

    fn content(
        &mut self,
        bytes: &[u8],
        path: &Path,
        root_from_tile: Matrix4<f64>,
        depth: usize,
    ) -> Result<(), SurfaceError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut placement =
            Placement { root_from_tile, center: [0.0; 3], up: self.up, name: &name, feature_names: &[] };
        match Container::of(bytes) {
            Container::Other => self.model(bytes, path, &placement),
            Container::Batched => {
                let Batched { glb, center, names } = Batched::of(bytes)?;
                (placement.center, placement.feature_names) = (center, &names);
                self.model(glb, path, &placement)
            }
            Container::Composite if depth >= DEEPEST_COMPOSITE => Err(SurfaceError::whole(format!(
                "more than {DEEPEST_COMPOSITE} composite tiles stand within one another; write fewer"
            ))),
            Container::Composite => {
                parts_of(bytes)?.into_iter().try_for_each(|part| self.content(part, path, root_from_tile, depth + 1))
            }
            Container::Instanced => {
                self.builder.skip("instanced models (i3dm)", 1, || name.clone());
                Ok(())
            }
            Container::Points => {
                self.builder.skip("tiles of points (pnts)", 1, || name.clone());
                Ok(())
            }
        }
    }

    fn model(&mut self, bytes: &[u8], path: &Path, placement: &Placement<'_>) -> Result<(), SurfaceError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let spacing_m = add_model(bytes, folder, placement, &mut self.builder)?;
        self.spacing_m = self.spacing_m.max(spacing_m);
        if self.builder.file.positions.len() + self.builder.file.corners.len() > MOST_ELEMENTS {
            return Err(SurfaceError::whole(format!(
                "the tiles come to more than {MOST_ELEMENTS} positions and corners; take a part of the tileset"
            )));
        }
        Ok(())
    }

    fn read(&mut self, path: &Path, limit: u64) -> Result<Vec<u8>, SurfaceError> {
        let bytes = read_regular(path, limit.min(LARGEST_MODEL_BYTES - self.bytes)).map_err(|error| {
            let problem = format!("the tileset names a file that cannot be read: {error}; get the whole tileset");
            SurfaceError::whole(problem).in_file(path)
        })?;
        // A name counts too, or many empty files would cost nothing.
        self.bytes = (self.bytes + bytes.len() as u64 + 4096).min(LARGEST_MODEL_BYTES);
        Ok(bytes)
    }
}

/// A transform must keep points where numbers can say it.
fn checked(matrix: Matrix4<f64>) -> Result<Matrix4<f64>, SurfaceError> {
    let is_affine = [matrix[(3, 0)], matrix[(3, 1)], matrix[(3, 2)], matrix[(3, 3)]] == [0.0, 0.0, 0.0, 1.0];
    if !is_affine || !matrix.iter().all(|value| value.is_finite()) {
        let problem = "a tile's transform is not affine; expected 16 numbers column by column, every fourth 0 0 0 1";
        return Err(SurfaceError::whole(problem));
    }
    Ok(matrix)
}

/// The path that a URI means, from the folder of the tileset. Folders above are allowed: tilesets share them.
fn relative_path(uri: &str) -> Result<PathBuf, SurfaceError> {
    let refused = |reason: &str| Err(SurfaceError::whole(format!("content `{}` {reason}", shortened(uri))));
    if uri.contains("://") || uri.starts_with("//") {
        return refused("is a web address, from which nothing is read; get the tileset with its tiles");
    }
    if uri.starts_with("data:") {
        return refused("stands in the tileset itself, which is not read; write it to a file");
    }
    let without_query = uri.split(['?', '#']).next().unwrap_or_default();
    match percent_decoded(without_query) {
        Some(path) if !path.is_empty() && !path.starts_with('/') && !path.contains([':', '\\', '\0']) => {
            Ok(PathBuf::from(path))
        }
        _ => refused("is no relative path; name it from the folder of the tileset"),
    }
}
