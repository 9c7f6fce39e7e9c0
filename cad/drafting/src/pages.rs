//! Pages of text, lines and pictures, written as PDF: for documents that belong to drawings, such as manuals.
//!
//! Positions are mm from the lower left corner of a page, and y points up.

use pdf_writer::types::LineCapStyle;
use pdf_writer::{Content, Filter, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};

use super::font::{Weight, width_of};
use super::pdf::{encoded, points};

/// A typeface that every PDF reader has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Typeface {
    /// Helvetica.
    Regular,
    /// Helvetica Bold.
    Bold,
    /// Courier.
    Typewriter,
}

impl Typeface {
    const ALL: [Self; 3] = [Self::Regular, Self::Bold, Self::Typewriter];

    const fn key(self) -> Name<'static> {
        match self {
            Self::Regular => Name(b"R"),
            Self::Bold => Name(b"B"),
            Self::Typewriter => Name(b"T"),
        }
    }

    const fn base(self) -> Name<'static> {
        match self {
            Self::Regular => Name(b"Helvetica"),
            Self::Bold => Name(b"Helvetica-Bold"),
            Self::Typewriter => Name(b"Courier"),
        }
    }

    /// Returns the width of a text in mm. `size_mm` is the size of the font, the distance of lines without leading.
    #[must_use]
    pub fn width_mm(self, text: &str, size_mm: f64) -> f64 {
        let weight = match self {
            Self::Regular => Weight::Regular,
            Self::Bold => Weight::Bold,
            Self::Typewriter => Weight::Fixed,
        };
        width_of(text, weight) * size_mm
    }
}

/// A colour: red, green, blue, from 0 to 1.
pub type Rgb = [f32; 3];

/// Something on a page.
#[derive(Clone, Debug, PartialEq)]
pub enum PageItem {
    /// A text on its baseline.
    Text {
        /// Left end of the baseline.
        at: [f64; 2],
        /// Typeface.
        typeface: Typeface,
        /// Size of the font, mm.
        size_mm: f64,
        /// Colour.
        colour: Rgb,
        /// Text.
        text: String,
    },
    /// A line through points.
    Line {
        /// Points.
        points: Vec<[f64; 2]>,
        /// Width, mm.
        width_mm: f64,
        /// Colour.
        colour: Rgb,
    },
    /// A filled polygon.
    Area {
        /// Corners.
        points: Vec<[f64; 2]>,
        /// Colour.
        colour: Rgb,
    },
    /// A picture.
    Picture {
        /// Index in the list of pictures.
        picture: usize,
        /// Lower left corner.
        at: [f64; 2],
        /// Width and height, mm.
        size_mm: [f64; 2],
    },
}

/// A page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Items, the lowest first.
    pub items: Vec<PageItem>,
}

/// The compressed pixels of a PNG picture with 8 bits per channel, with a palette or with red, green and blue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PngPixels {
    width: u32,
    height: u32,
    palette: Option<Vec<u8>>,
    data: Vec<u8>,
}

impl PngPixels {
    /// Reads a PNG file. `None` for a file that is cut off, and for other kinds: with transparency of each pixel, with greys, or
    /// interlaced.
    #[must_use]
    pub fn new(png: &[u8]) -> Option<Self> {
        let mut rest = png.strip_prefix(b"\x89PNG\r\n\x1a\n")?;
        let mut header = None;
        let (mut palette, mut data) = (None, Vec::new());
        while let Some((length, after)) = rest.split_first_chunk::<4>() {
            let (kind, after) = after.split_first_chunk::<4>()?;
            let (content, after) =
                after.split_at_checked(usize::try_from(u32::from_be_bytes(*length)).ok()?)?;
            match kind {
                b"IHDR" => header = Some(content),
                b"PLTE" => palette = Some(content.to_vec()),
                b"IDAT" => data.extend_from_slice(content),
                _ => {}
            }
            rest = after.get(4..)?;
        }
        if !rest.is_empty() || data.is_empty() {
            return None;
        }
        let (width, header) = header?.split_first_chunk::<4>()?;
        let (height, [8, kind, 0, 0, 0]) = header.split_first_chunk::<4>()? else { return None };
        let palette = match kind {
            2 => None,
            3 => Some(palette?),
            _ => return None,
        };
        Some(Self { width: u32::from_be_bytes(*width), height: u32::from_be_bytes(*height), palette, data })
    }

    /// Returns height over width.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        f64::from(self.height) / f64::from(self.width)
    }
}

/// Writes pages of `size_mm` as a PDF with a title. The file contains no date, and is the same on every machine.
///
/// ```
/// use pinswitch_drafting::{Page, PageItem, Typeface, pages_pdf};
///
/// let text = PageItem::Text {
///     at: [20.0, 270.0],
///     typeface: Typeface::Bold,
///     size_mm: 6.0,
///     colour: [0.0; 3],
///     text: "How to make a press".to_owned(),
/// };
/// let pdf = pages_pdf(&[Page { items: vec![text] }], &[], [210.0, 297.0], "Press");
/// assert!(pdf.starts_with(b"%PDF-"));
/// ```
#[must_use]
pub fn pages_pdf(pages: &[Page], pictures: &[PngPixels], size_mm: [f64; 2], title: &str) -> Vec<u8> {
    let number = |i: usize| Ref::new(i32::try_from(i).unwrap_or(i32::MAX));
    let (catalog, tree, info) = (number(1), number(2), number(3));
    let font = |i: usize| number(4 + i);
    let picture = |i: usize| number(4 + Typeface::ALL.len() + i);
    let page = |i: usize| number(4 + Typeface::ALL.len() + pictures.len() + 2 * i);
    let content = |i: usize| number(5 + Typeface::ALL.len() + pictures.len() + 2 * i);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(tree).lang(TextStr("en"));
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("pinswitch"));
    let count = i32::try_from(pages.len()).unwrap_or(i32::MAX);
    pdf.pages(tree).kids((0..pages.len()).map(page)).count(count);
    for (i, typeface) in Typeface::ALL.into_iter().enumerate() {
        pdf.type1_font(font(i)).base_font(typeface.base()).encoding_predefined(Name(b"WinAnsiEncoding"));
    }
    for (i, pixels) in pictures.iter().enumerate() {
        write_picture(&mut pdf, picture(i), pixels);
    }
    for (i, p) in pages.iter().enumerate() {
        let mut entry = pdf.page(page(i));
        entry.media_box(Rect::new(0.0, 0.0, points(size_mm[0]), points(size_mm[1])));
        entry.parent(tree).contents(content(i));
        let mut resources = entry.resources();
        let mut fonts = resources.fonts();
        for (i, typeface) in Typeface::ALL.into_iter().enumerate() {
            fonts.pair(typeface.key(), font(i));
        }
        fonts.finish();
        let mut objects = resources.x_objects();
        for item in &p.items {
            if let PageItem::Picture { picture: index, .. } = item {
                objects.pair(Name(picture_key(*index).as_bytes()), picture(*index));
            }
        }
        objects.finish();
        resources.finish();
        entry.finish();
        pdf.stream(content(i), &page_content(p));
    }
    pdf.finish()
}

fn picture_key(index: usize) -> String {
    format!("P{index}")
}

/// Writes a picture with the compression of its PNG file, which PDF shares.
fn write_picture(pdf: &mut Pdf, reference: Ref, pixels: &PngPixels) {
    let columns = i32::try_from(pixels.width).unwrap_or(i32::MAX);
    let mut image = pdf.image_xobject(reference, &pixels.data);
    image.filter(Filter::FlateDecode);
    image.width(columns).height(i32::try_from(pixels.height).unwrap_or(i32::MAX)).bits_per_component(8);
    let colours = match &pixels.palette {
        Some(palette) => {
            let most = i32::try_from(palette.len() / 3).unwrap_or(1) - 1;
            image.color_space().indexed(Name(b"DeviceRGB"), most, palette);
            1
        }
        None => {
            image.color_space().device_rgb();
            3
        }
    };
    // The predictors of PNG, one for each row.
    let mut parameters = image.decode_parms();
    parameters.pair(Name(b"Predictor"), 15).pair(Name(b"Colors"), colours);
    parameters.pair(Name(b"BitsPerComponent"), 8).pair(Name(b"Columns"), columns);
}

fn page_content(page: &Page) -> Vec<u8> {
    let mut content = Content::new();
    content.set_line_cap(LineCapStyle::RoundCap);
    for item in &page.items {
        match item {
            PageItem::Text { at, typeface, size_mm, colour, text } => {
                let [red, green, blue] = *colour;
                content.begin_text().set_fill_rgb(red, green, blue);
                content.set_font(typeface.key(), points(*size_mm));
                content.set_text_matrix([1.0, 0.0, 0.0, 1.0, points(at[0]), points(at[1])]);
                content.show(Str(&encoded(text))).end_text();
            }
            PageItem::Line { points: corners, width_mm, colour } => {
                let [red, green, blue] = *colour;
                content.set_stroke_rgb(red, green, blue).set_line_width(points(*width_mm));
                trace(&mut content, corners);
                content.stroke();
            }
            PageItem::Area { points: corners, colour } => {
                let [red, green, blue] = *colour;
                content.set_fill_rgb(red, green, blue);
                trace(&mut content, corners);
                content.close_path().fill_nonzero();
            }
            PageItem::Picture { picture, at, size_mm } => {
                content.save_state();
                let [width, height] = size_mm.map(points);
                content.transform([width, 0.0, 0.0, height, points(at[0]), points(at[1])]);
                content.x_object(Name(picture_key(*picture).as_bytes())).restore_state();
            }
        }
    }
    content.finish().to_vec()
}

fn trace(content: &mut Content, corners: &[[f64; 2]]) {
    for (i, [x, y]) in corners.iter().enumerate() {
        if i == 0 {
            content.move_to(points(*x), points(*y));
        } else {
            content.line_to(points(*x), points(*y));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PNG file of chunks; their checksums are not read.
    fn png(kind: u8, chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        let header = [0, 0, 0, 4, 0, 0, 0, 2, 8, kind, 0, 0, 0];
        for (name, content) in [(b"IHDR", &header[..])].iter().chain(chunks) {
            bytes.extend(u32::try_from(content.len()).unwrap().to_be_bytes());
            bytes.extend(*name);
            bytes.extend(*content);
            bytes.extend([0; 4]);
        }
        bytes
    }

    #[test]
    fn pictures_keep_their_compression() {
        let indexed = png(3, &[(b"PLTE", &[1, 2, 3]), (b"IDAT", &[7, 8]), (b"IDAT", &[9]), (b"IEND", &[])]);
        let pixels = PngPixels::new(&indexed).unwrap();
        assert_eq!((pixels.aspect(), &pixels.data[..]), (0.5, &[7, 8, 9][..]));
        let pdf = pages_pdf(
            &[Page { items: vec![PageItem::Picture { picture: 0, at: [0.0; 2], size_mm: [40.0, 20.0] }] }],
            &[pixels],
            [210.0, 297.0],
            "x",
        );
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.contains("/Predictor 15") && text.contains("/Indexed") && text.contains("/P0"));
    }

    #[test]
    fn other_files_are_no_pictures() {
        let whole = png(2, &[(b"IDAT", &[7])]);
        assert!(PngPixels::new(&whole).is_some());
        for end in 0..whole.len() {
            assert_eq!(PngPixels::new(&whole[..end]), None, "{end}");
        }
        // A palette without colours, and greys.
        assert_eq!(PngPixels::new(&png(3, &[])), None);
        assert_eq!(PngPixels::new(&png(0, &[])), None);
        assert_eq!(PngPixels::new(b"GIF89a"), None);
    }

    #[test]
    fn widths_depend_on_the_typeface() {
        let width = |t: Typeface| t.width_mm("Mill 3", 10.0);
        // Adobe's metrics: M, i, l, l, space, 3.
        let expected = [0.833 + 3.0 * 0.222 + 0.278 + 0.556, 0.833 + 3.0 * 0.278 + 0.278 + 0.556, 6.0 * 0.6];
        for (typeface, em) in Typeface::ALL.into_iter().zip(expected) {
            assert!((width(typeface) - 10.0 * em).abs() < 1e-9, "{typeface:?}: {}", width(typeface));
        }
    }
}
