//! CityGML 1, 2 and 3 in one pass over the XML: every polygon with its object, level of detail, kind and solid.
//!
//! Namespaces are told by their local names alone, since files use default and odd prefixes. What stands around a polygon is one
//! `context::Context`, copied from element to element on the way down. A solid names its polygons by `xlink:href`, before or
//! after they are written: references are kept and resolved at the end (`links.rs`), as are implicit geometries (`implicit.rs`).

mod attributes;
mod context;
mod element;
mod implicit;
mod links;
mod numbers;
mod polygon;
mod reader;
mod reference_system;
mod scene;
mod source;
#[cfg(test)]
mod tests;

pub use reader::{is_citygml, read_citygml};
