//! Raw records as the specifications of the file formats write them, both directions.

pub mod obj;
