//! Pixels as a PNG file.

use crate::error::{Error, ErrorKind, Result};

/// Opaque pixels, row by row, red, green and blue a byte each, as the bytes of a PNG.
///
/// The fast compressor: a third of tiny-skia's own time, for a smaller file.
///
/// # Errors
/// `Output` when the encoder refuses, as with a side of 0.
pub(super) fn encode(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>> {
    let mut data = Vec::new();
    let mut encoder = png::Encoder::new(&mut data, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels)).map_err(|e| {
        Error::new(ErrorKind::Output, format!("the picture cannot be encoded as PNG ({e}); ask for a narrower one"))
    })?;
    Ok(data)
}
