//! A part of a model, and a model as a file again.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::{CityModel, CitySource, Facet, FacetId, ObjectId};
use crate::format::obj::{ObjFile, ObjGroup, ObjObject, write_obj};

impl CityModel {
    /// The facets that are kept, with what they use, counted anew; same origin, no warnings.
    pub fn subset(&self, keep: impl Fn(FacetId) -> bool) -> CityModel {
        let (crs, part_of) = (self.crs.clone(), self.part_of);
        let mut kept = CityModel { origin: self.origin, crs, part_of, ..CityModel::default() };
        let mut vertex_of = vec![None; self.vertices.len()];
        let mut object_of = vec![None; self.objects.len()];
        // What is kept before each facet, to count the files' shares anew.
        let mut facets_before = vec![0];
        let mut objects_before = vec![0];
        for (id, facet) in self.facets_with_ids() {
            if keep(id) {
                let object = *object_of[facet.object.0 as usize].get_or_insert_with(|| {
                    kept.objects.push(self.object_name(facet.object).to_owned());
                    kept.objects.len() as u32 - 1
                });
                self.copy_facet(facet, ObjectId(object), &mut kept, &mut vertex_of);
            }
            facets_before.push(kept.facets.len() as u32);
            objects_before.push(kept.objects.len() as u32);
        }
        // Where facets were taken away by hand, the sources may count more than there are.
        let at = |facet: u32| (facet as usize).min(self.facets.len());
        for source in &self.sources {
            let (start, end) = (at(source.facets.start), at(source.facets.end));
            let facets = facets_before[start]..facets_before[end];
            let objects = objects_before[start]..objects_before[end];
            kept.sources.push(CitySource { facets, objects, ..source.clone() });
        }
        kept
    }

    fn copy_facet(&self, facet: &Facet, object: ObjectId, kept: &mut CityModel, vertex_of: &mut [Option<u32>]) {
        let mut moved = |vertex: u32| {
            *vertex_of[vertex as usize].get_or_insert_with(|| {
                kept.vertices.push(self.vertices[vertex as usize]);
                kept.vertices.len() as u32 - 1
            })
        };
        let outline = facet.outline.iter().map(|&vertex| moved(vertex)).collect();
        let holes = facet.holes.iter().map(|hole| hole.iter().map(|&vertex| moved(vertex)).collect()).collect();
        let start = kept.triangles.len() as u32;
        let triangles = &self.triangles[facet.triangles.start as usize..facet.triangles.end as usize];
        kept.triangles.extend(triangles.iter().map(|triangle| triangle.map(&mut moved)));
        let exposed = self.exposed.get(facet.triangles.start as usize..facet.triangles.end as usize);
        kept.exposed.extend_from_slice(exposed.unwrap_or_default());
        let triangles = start..kept.triangles.len() as u32;
        kept.facets.push(Facet { outline, holes, object, triangles, ..facet.clone() });
    }

    /// Writes all outlines as OBJ polygons in file coordinates, one `o` an object; a facet with holes, which OBJ does not have, as
    /// its triangles.
    pub fn write_obj(&self, path: &Path) -> io::Result<()> {
        let mut out = BufWriter::new(File::create(path)?);
        write_obj(&mut out, &self.to_obj())?;
        out.flush()
    }

    fn to_obj(&self) -> ObjFile {
        let mut file = ObjFile {
            positions: self.vertices.iter().map(|vertex| (vertex + self.origin).into()).collect(),
            ..ObjFile::default()
        };
        let mut order: Vec<&Facet> = self.facets.iter().collect();
        order.sort_by_key(|facet| facet.object);
        for facets in order.chunk_by(|a, b| a.object == b.object) {
            let first = file.face_ends.len();
            for facet in facets {
                if facet.holes.is_empty() {
                    file.corners.extend(&facet.outline);
                    file.face_ends.push(file.corners.len() as u32);
                    continue;
                }
                for triangle in &self.triangles[facet.triangles.start as usize..facet.triangles.end as usize] {
                    file.corners.extend(triangle);
                    file.face_ends.push(file.corners.len() as u32);
                }
            }
            let groups = vec![ObjGroup { name: None, faces: first..file.face_ends.len() }];
            let name = Some(self.object_name(facets[0].object).to_owned());
            file.objects.push(ObjObject { name, groups });
        }
        file
    }
}
