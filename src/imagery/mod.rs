//! Photographs, label images and superpixels; which points of a reconstruction fall on which superpixel.
