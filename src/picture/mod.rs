//! Pictures: layers of channels to and from EXR, colours to PNG and JPEG through a tone map, images of models to pixels.
