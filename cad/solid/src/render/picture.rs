//! Pictures in memory, and as PNG.

/// Bits per channel of the colours that a palette distinguishes: steps of 4 of 255 are invisible.
const PALETTE_BITS: u32 = 6;
/// Most colours of a palette.
const PALETTE: usize = 256;

/// A picture: width, height, and rows of red, green, blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Three bytes per pixel.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// Returns the picture as PNG with a palette of at most 256 colours, the most frequent ones. It is a third as large as
    /// that of [`Self::png`].
    ///
    /// # Errors
    /// As [`Self::png`].
    pub fn indexed_png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let (palette, indices) = self.indexed();
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette.concat());
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::NoFilter);
        encoder.write_header()?.write_image_data(&indices)?;
        Ok(bytes)
    }

    /// Returns a palette, and the index of each pixel in it.
    fn indexed(&self) -> (Vec<[u8; 3]>, Vec<u8>) {
        let bin = |rgb: &[u8]| {
            rgb.iter().fold(0, |bin, v| bin << PALETTE_BITS | usize::from(v >> (8 - PALETTE_BITS)))
        };
        let mut counts = vec![0u32; 1 << (3 * PALETTE_BITS)];
        let mut first = vec![[0u8; 3]; counts.len()];
        for rgb in self.pixels.chunks_exact(3) {
            let bin = bin(rgb);
            if counts[bin] == 0 {
                first[bin] = [rgb[0], rgb[1], rgb[2]];
            }
            counts[bin] += 1;
        }
        let mut used: Vec<usize> = (0..counts.len()).filter(|bin| counts[*bin] > 0).collect();
        used.sort_by_key(|bin| (std::cmp::Reverse(counts[*bin]), *bin));
        let palette: Vec<[u8; 3]> = used.iter().take(PALETTE).map(|bin| first[*bin]).collect();
        let nearest = |colour: [u8; 3]| {
            let off =
                |p: &[u8; 3]| -> u32 { (0..3).map(|k| u32::from(p[k].abs_diff(colour[k])).pow(2)).sum() };
            palette.iter().enumerate().min_by_key(|(_, p)| off(p)).map_or(0, |(i, _)| i)
        };
        let mut index_of_bin = vec![0u8; counts.len()];
        for (rank, bin) in used.into_iter().enumerate() {
            let index = if rank < palette.len() { rank } else { nearest(first[bin]) };
            index_of_bin[bin] = u8::try_from(index).unwrap_or(0);
        }
        let indices = self.pixels.chunks_exact(3).map(|rgb| index_of_bin[bin(rgb)]).collect();
        (palette, indices)
    }

    /// Returns the picture as PNG.
    ///
    /// # Errors
    /// That of the encoder; writing to memory does not fail.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::Balanced);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn palettes_keep_the_frequent_colours() {
        // A disc of one colour with a soft rim, and a corner of many colours.
        let pixel = |i: i32| match (i % 512 / 8, i / 512 / 8) {
            (x, y) if x < 12 && y < 12 => [x * 9, y * 9, 80],
            (x, y) => [200, 90, 30].map(|c| c - ((x - 40).pow(2) + (y - 26).pow(2) - 150).clamp(0, 30)),
        };
        let pixels = (0..512 * 384).flat_map(pixel).map(|c| c as u8).collect();
        let picture = Picture { width: 512, height: 384, pixels };
        let (palette, indices) = picture.indexed();
        assert!(palette.len() > 2 && palette.len() <= 256);
        for (rgb, index) in picture.pixels.chunks_exact(3).zip(indices) {
            let off = (0..3).map(|k| rgb[k].abs_diff(palette[usize::from(index)][k])).max().unwrap();
            assert!(off < 4, "{rgb:?} for {:?}", palette[usize::from(index)]);
        }
        assert!(picture.indexed_png().unwrap().len() < picture.png().unwrap().len());
    }
}
