//! References between surfaces (`xlink:href`), which may come before what they name.

use std::collections::HashMap;
use std::ops::Range;

use crate::format::surface_builder::SurfaceBuilder;
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::SurfaceKind;

/// Steps that following references may take for each surface and reference there is. Chosen: a solid names a surface once,
/// a few composites may stand between; more is a file made to take time.
const STEPS_PER_ITEM: usize = 16;

/// Objects that may stand above one another.
const DEEPEST_PART: usize = 64;

/// A geometry that is named where it might be written.
#[derive(Debug)]
pub(super) struct Link {
    pub href: Box<str>,
    pub kind: Option<SurfaceKind>,
    pub shell: Option<u32>,
    pub is_reversed: bool,
}

/// What was written within a geometry that has an identifier: surfaces, and references to further ones.
#[derive(Clone, Debug)]
struct Target {
    surfaces: Range<u32>,
    links: Range<u32>,
}

/// All references and what they may name.
#[derive(Debug, Default)]
pub(super) struct Links {
    links: Vec<Link>,
    targets: HashMap<Box<str>, Target>,
    /// An object, and the identifier of one of its parts.
    parts: Vec<(u32, Box<str>)>,
}

/// A solid wants a surface for its shell.
struct Claim {
    surface: u32,
    shell: u32,
    is_reversed: bool,
}

impl Links {
    pub fn count(&self) -> u32 {
        self.links.len() as u32
    }

    pub fn add(&mut self, link: Link) {
        self.links.push(link);
    }

    pub fn add_part(&mut self, object: u32, href: &str) {
        self.parts.push((object, href.into()));
    }

    /// Of two geometries with one identifier the first is meant.
    pub fn add_target(&mut self, id: Box<str>, surfaces: Range<u32>, links: Range<u32>) {
        self.targets.entry(id).or_insert(Target { surfaces, links });
    }

    /// Gives every surface that is named its shell and kind, and every part its whole.
    pub fn resolve(&self, builder: &mut SurfaceBuilder) -> Result<(), SurfaceError> {
        let mut steps = STEPS_PER_ITEM * (self.links.len() + builder.file.surfaces.len());
        let mut claims = Vec::new();
        for link in &self.links {
            let found = self.follow(link, &mut steps)?;
            let Some(found) = found else {
                builder.skip(lost(&link.href), 1, || link.href.to_string());
                continue;
            };
            for (surface, is_reversed) in found {
                let record = &mut builder.file.surfaces[surface as usize];
                record.kind = record.kind.or(link.kind);
                claims.extend(link.shell.map(|shell| Claim { surface, shell, is_reversed }));
            }
        }
        grant(&claims, builder);
        self.place_parts(builder);
        Ok(())
    }

    /// The surfaces that a reference comes to in the end, and whether it turns them.
    fn follow(&self, link: &Link, steps: &mut usize) -> Result<Option<Vec<(u32, bool)>>, SurfaceError> {
        let Some(first) = self.target(&link.href) else { return Ok(None) };
        let mut found = Vec::new();
        let mut open = vec![(first, link.is_reversed)];
        while let Some((target, is_reversed)) = open.pop() {
            let cost = 1 + target.surfaces.len() + target.links.len();
            *steps = steps.checked_sub(cost).ok_or_else(|| {
                let problem = "references (xlink:href) lead in a circle or to the same surfaces too often";
                SurfaceError::whole(format!("{problem}; write each surface once")).of(Some(link.href.to_string()))
            })?;
            found.extend(target.surfaces.clone().map(|surface| (surface, is_reversed)));
            let within = &self.links[target.links.start as usize..target.links.end as usize];
            let further = within.iter().filter_map(|link| Some((self.target(&link.href)?, link.is_reversed)));
            open.extend(further.map(|(target, turned)| (target, turned != is_reversed)));
        }
        Ok(Some(found))
    }

    fn target(&self, href: &str) -> Option<&Target> {
        self.targets.get(href.strip_prefix('#')?)
    }

    fn place_parts(&self, builder: &mut SurfaceBuilder) {
        if self.parts.is_empty() {
            return;
        }
        let objects = builder.file.objects.iter().enumerate();
        let by_id: HashMap<String, u32> =
            objects.map(|(number, object)| (object.id.clone(), number as u32)).rev().collect();
        for (whole, href) in &self.parts {
            let part = href.strip_prefix('#').and_then(|id| by_id.get(id)).copied();
            let Some(part) = part.filter(|&part| may_be_part(builder, part, *whole)) else {
                builder.skip(lost(href), 1, || href.to_string());
                continue;
            };
            builder.file.objects[part as usize].parent = Some(*whole);
        }
    }
}

/// A part has one whole, which is not part of it in turn.
fn may_be_part(builder: &SurfaceBuilder, part: u32, whole: u32) -> bool {
    let objects = &builder.file.objects;
    let mut above = std::iter::successors(Some(whole), |&object| objects[object as usize].parent);
    let is_above = above.by_ref().take(DEEPEST_PART).any(|object| object == part);
    objects[part as usize].parent.is_none() && !is_above && above.next().is_none()
}

/// A surface belongs to the first solid that has it as it is, else to the first that has it turned round, and is turned
/// for that one.
fn grant(claims: &[Claim], builder: &mut SurfaceBuilder) {
    for wanted in [false, true] {
        for claim in claims.iter().filter(|claim| claim.is_reversed == wanted) {
            let record = &mut builder.file.surfaces[claim.surface as usize];
            match record.shell {
                None => {
                    record.shell = Some(claim.shell);
                    if claim.is_reversed {
                        builder.reverse(claim.surface as usize);
                    }
                }
                Some(shell) if shell == claim.shell => {}
                Some(_) => {
                    let object = record.object;
                    let example = builder.object_id(Some(object)).unwrap_or_default();
                    builder.skip("second solids of a surface that two solids share", 1, || example);
                }
            }
        }
    }
}

fn lost(href: &str) -> &'static str {
    if href.starts_with('#') {
        "references to surfaces that are not there"
    } else {
        "references to surfaces in other files"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::surface_builder::SurfaceTraits;

    fn scene(surfaces: u32) -> SurfaceBuilder {
        let mut builder = SurfaceBuilder::default();
        builder.add_object("house".to_owned(), "Building", None);
        for _ in 0..surfaces {
            builder.add_surface([&[[0.0; 3], [1.0; 3], [2.0; 3]][..]], SurfaceTraits::default()).unwrap();
        }
        builder
    }

    fn link(href: &str, shell: Option<u32>, is_reversed: bool) -> Link {
        Link { href: href.into(), kind: Some(SurfaceKind::Roof), shell, is_reversed }
    }

    #[test]
    fn a_turn_within_a_turn_is_none() {
        for (outer, inner, first_corner) in [(false, false, 0), (true, false, 2), (false, true, 2), (true, true, 0)] {
            let mut builder = scene(1);
            let mut links = Links::default();
            links.add_target("surface".into(), 0..1, 0..0);
            links.add(link("#surface", None, inner));
            links.add_target("oriented".into(), 1..1, 0..1);
            links.add(link("#oriented", Some(4), outer));
            links.resolve(&mut builder).unwrap();
            assert_eq!((builder.file.surfaces[0].shell, builder.file.corners[0]), (Some(4), first_corner));
        }
    }

    #[test]
    fn a_kind_that_is_known_is_kept() {
        let mut builder = scene(2);
        builder.file.surfaces[0].kind = Some(SurfaceKind::Wall);
        let mut links = Links::default();
        links.add_target("both".into(), 0..2, 0..0);
        links.add(link("#both", None, false));
        links.resolve(&mut builder).unwrap();
        let kinds: Vec<_> = builder.file.surfaces.iter().map(|surface| surface.kind).collect();
        assert_eq!(kinds, [Some(SurfaceKind::Wall), Some(SurfaceKind::Roof)]);
    }

    #[test]
    fn of_two_geometries_with_one_name_the_first_is_meant() {
        let mut builder = scene(2);
        let mut links = Links::default();
        links.add_target("twice".into(), 1..2, 0..0);
        links.add_target("twice".into(), 0..1, 0..0);
        links.add(link("#twice", Some(0), false));
        links.resolve(&mut builder).unwrap();
        assert_eq!(builder.file.surfaces.iter().map(|surface| surface.shell).collect::<Vec<_>>(), [None, Some(0)]);
    }

    #[test]
    fn a_pyramid_of_references_is_refused_before_it_takes_time() {
        let mut builder = scene(1);
        let mut links = Links::default();
        links.add_target("0".into(), 0..1, 0..0);
        for level in 1..60 {
            let before = links.count();
            let href = format!("#{}", level - 1);
            (0..2).for_each(|_| links.add(link(&href, None, false)));
            links.add_target(level.to_string().into(), 1..1, before..links.count());
        }
        links.add(link("#59", Some(0), false));
        assert!(links.resolve(&mut builder).unwrap_err().to_string().contains("too often"));
    }
}
