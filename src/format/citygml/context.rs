//! What holds for an element because of the elements around it.

use super::element::Element;
use crate::format::surfaces::{Lod, SurfaceKind};

/// Copied from an element to those within it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context {
    /// The nearest object around.
    pub object: Option<u32>,
    pub lod: Option<Lod>,
    pub kind: Option<SurfaceKind>,
    /// The solid, by its number in the file.
    pub shell: Option<u32>,
    /// Whether surfaces are turned round, by an odd number of orientations `-`.
    pub is_reversed: bool,
    /// Numbers of a position.
    pub dimension: usize,
    pub purpose: Purpose,
    /// Whether a ring is a hole.
    pub is_hole: bool,
}

/// What a geometry is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// It stands where it is written.
    Scene,
    /// It is placed by implicit geometries.
    Template,
    /// It is a point at which a template is placed.
    ReferencePoint,
}

impl Context {
    pub const OUTERMOST: Context = Context {
        object: None,
        lod: None,
        kind: None,
        shell: None,
        is_reversed: false,
        dimension: 3,
        purpose: Purpose::Scene,
        is_hole: false,
    };
}

/// An element whose end has not come yet.
#[derive(Debug)]
pub(super) struct Open {
    pub element: Element,
    pub context: Context,
    /// `gml:id` of a geometry.
    pub id: Option<Box<str>>,
    /// Surfaces and references that were there before it.
    pub surfaces_before: u32,
    pub links_before: u32,
}
