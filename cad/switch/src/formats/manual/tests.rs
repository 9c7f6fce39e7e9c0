//! The manual has the sentences of PRINTING.md, and its files are whole.

use super::manual;
use crate::built::Built;
use crate::config::read;
use crate::design::Design;
use crate::formats::guide::inline::plain;
use crate::formats::named;
use crate::prediction::Prediction;
use crate::set::Set;

const SETS: [&str; 4] = [
    "[layout]\npins = [5, 8, 11]\n",
    "[switch]\nname = \"named_with.care\"\n[label]\ntext = \"A-1\"\n[print]\nbed_mm = 62.0\n",
    "[layout]\npins = [5, 8, 11]\nsubstrate = \"abs\"\n[fasteners]\ncount = 0\n",
    "[layout]\npins = [5]\n[mould]\nkind = \"one-piece\"\n[fasteners]\nkind = \"insert\"\n[mount]\nkind = \"flange\"\n",
];

/// Width and height of the pictures in tests, pixels.
const SMALL_PIXELS: (u32, u32) = (320, 220);

/// PRINTING.md, MANUAL.html and MANUAL.pdf, with small pictures.
fn files(text: &str) -> (String, String, Vec<u8>) {
    let built = Built::new(Design::new(read(text, "x.toml").unwrap().0).unwrap()).unwrap();
    let prediction = Prediction::of(built.design());
    let set = Set::new(&built, &prediction, &named(&["guide"]).unwrap()).unwrap();
    let guide = set.files.iter().find(|f| f.name == "PRINTING.md").unwrap().bytes.clone();
    let made = manual(&built, &prediction, &set.manifest, SMALL_PIXELS).unwrap();
    let [html, pdf] =
        ["MANUAL.html", "MANUAL.pdf"].map(|name| made.iter().find(|f| f.name == name).unwrap().bytes.clone());
    (String::from_utf8(guide).unwrap(), String::from_utf8(html).unwrap(), pdf)
}

/// The letters of a text.
fn letters(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Headings, points, cells and sentences of Markdown, without markup and pictures.
fn statements(markdown: &str) -> Vec<String> {
    let mut all = Vec::new();
    for line in markdown.lines().filter(|l| !l.starts_with("![") && !l.starts_with("|--")) {
        if line.contains("--format manual") {
            continue;
        }
        let line = line.trim_start_matches(['#', '-', ' ']);
        let cells: Vec<&str> = match line.strip_prefix('|') {
            // An escaped bar is not the end of a cell.
            Some(row) => row.split(" |").collect(),
            None => line.split(". ").collect(),
        };
        all.extend(cells.iter().map(|cell| letters(&plain(cell.trim()))).filter(|cell| !cell.is_empty()));
    }
    all
}

/// All texts of a PDF in their order: the strings that are shown, literal or hexadecimal.
fn shown_texts(pdf: &[u8]) -> String {
    let mut text = String::new();
    let mut rest = pdf;
    while let Some(end) = rest.windows(4).position(|w| w == b" Tj\n") {
        let before = &rest[..end];
        rest = &rest[end + 4..];
        let line = before.rsplit(|b| *b == b'\n').next().unwrap_or_default();
        if let Some(hexadecimal) = line.strip_prefix(b"<") {
            let digits: Vec<char> =
                hexadecimal.iter().filter(|b| b.is_ascii_hexdigit()).map(|b| *b as char).collect();
            text.extend(
                digits
                    .chunks(2)
                    .map(|d| char::from(u8::from_str_radix(&d.iter().collect::<String>(), 16).unwrap())),
            );
        } else {
            let literal = line.strip_prefix(b"(").unwrap().strip_suffix(b")").unwrap();
            let mut bytes = literal.iter();
            while let Some(byte) = bytes.next() {
                text.push(char::from(if *byte == b'\\' { *bytes.next().unwrap() } else { *byte }));
            }
        }
    }
    letters(&text)
}

/// The text of HTML without tags.
fn html_text(html: &str) -> String {
    let (_, body) = html.split_once("</nav>").unwrap();
    let mut text = String::new();
    for piece in body.split('<').skip(1) {
        text.push_str(piece.split_once('>').unwrap().1);
    }
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
    letters(&text)
}

#[test]
fn every_writer_has_the_same_sentences() {
    for set in SETS {
        let (markdown, html, pdf) = files(set);
        let (of_pdf, of_html) = (shown_texts(&pdf), html_text(&html));
        let all = statements(&markdown);
        assert!(all.len() > 100, "{}", all.len());
        // The title is above the contents.
        for (i, statement) in all.iter().enumerate() {
            assert!(of_pdf.contains(statement), "{set}: not in the PDF: {statement}");
            assert!(i == 0 || of_html.contains(statement), "{set}: not in the HTML: {statement}");
        }
    }
}

#[test]
fn the_page_is_balanced_and_self_contained() {
    for set in SETS {
        let (_, html, _) = files(set);
        let mut open: Vec<&str> = Vec::new();
        for piece in html.split('<').skip(1) {
            let tag = piece.split_once('>').unwrap().0;
            let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
            if tag.starts_with('!') || tag.ends_with('/') || ["meta", "img"].contains(&name) {
                continue;
            }
            if tag.starts_with('/') {
                assert_eq!(open.pop(), Some(name), "{set}: {tag}");
            } else {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "{set}: {open:?}");
        for source in html.split("src=\"").skip(1) {
            assert!(source.starts_with("data:image/png;base64,"), "{set}");
        }
        for link in html.split("href=\"").skip(1) {
            let target = link.split_once('"').unwrap().0.strip_prefix('#').unwrap();
            assert!(html.contains(&format!("id=\"{target}\"")), "{set}: {target}");
        }
        assert!(!html.contains("<script") && !html.contains("url(") && !html.contains("http"), "{set}");
        assert_eq!(html.matches("<img ").count(), html.matches("<img alt=\"").count(), "{set}");
    }
}

/// The table of cross references of a PDF leads to its objects, and every picture of the guide is in both files.
#[test]
fn the_pdf_is_whole() {
    let (markdown, html, pdf) = files(SETS[0]);
    let text = String::from_utf8_lossy(&pdf).into_owned();
    assert!(pdf.starts_with(b"%PDF-") && text.trim_end().ends_with("%%EOF"));
    let at: usize = text.rsplit_once("startxref\n").unwrap().1.lines().next().unwrap().parse().unwrap();
    let table = String::from_utf8_lossy(&pdf[at..]).into_owned();
    let mut lines = table.lines().skip(1);
    let count: usize = lines.next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
    for (number, line) in lines.take(count).enumerate().skip(1) {
        let offset: usize = line.split(' ').next().unwrap().parse().unwrap();
        assert!(pdf[offset..].starts_with(format!("{number} 0 obj").as_bytes()), "object {number}");
    }
    // All pictures except the curve, which is drawn by lines.
    let pictures = markdown.matches("](").count() - 1;
    assert_eq!(html.matches("<img ").count(), pictures);
    assert_eq!(text.matches("/Subtype /Image").count(), pictures);
}
