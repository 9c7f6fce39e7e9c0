//! How wide a text is: Helvetica, whose widths every PDF reader knows, and which Arial and Liberation Sans share.

/// Height of a capital letter over the size of the font: Helvetica's is 718 thousandths.
pub const CAPITAL_PER_EM: f64 = 0.718;
/// How far letters such as g reach below their line, over the size of the font.
pub(super) const DESCENT_PER_EM: f64 = 0.207;

/// Widths of the characters from space to tilde, thousandths of the size (Adobe's metrics of Helvetica).
#[rustfmt::skip]
const ASCII: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,
    333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,
    556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Widths of U+00A0 to U+00FF.
#[rustfmt::skip]
const LATIN: [u16; 96] = [
    278, 333, 556, 556, 556, 556, 260, 556, 333, 737, 370, 556, 584, 333, 737, 333,
    400, 584, 333, 333, 333, 556, 537, 278, 333, 333, 365, 556, 834, 834, 834, 611,
    667, 667, 667, 667, 667, 667, 1000, 722, 667, 667, 667, 667, 278, 278, 278, 278,
    722, 722, 778, 778, 778, 778, 778, 584, 778, 722, 722, 722, 722, 667, 667, 611,
    556, 556, 556, 556, 556, 556, 889, 500, 556, 556, 556, 556, 278, 278, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 584, 611, 556, 556, 556, 556, 500, 556, 500,
];
/// Width of any other character: no letter of any script is wider than its size.
const OTHER: u16 = 1000;

fn width_thousandths(character: char) -> u16 {
    let code = character as usize;
    let ascii = code.checked_sub(0x20).and_then(|i| ASCII.get(i));
    ascii.or_else(|| code.checked_sub(0xa0).and_then(|i| LATIN.get(i))).copied().unwrap_or(OTHER)
}

/// Width in mm of `text` whose capitals are `height_mm` high.
#[must_use]
pub fn text_width_mm(text: &str, height_mm: f64) -> f64 {
    text.chars().map(|c| f64::from(width_thousandths(c))).sum::<f64>() / 1000.0 * height_mm / CAPITAL_PER_EM
}

/// `text` and the height of its capitals, as near to `height_mm` as `width_mm` allows and no less than `least_mm`; what is
/// still too long loses its end.
#[must_use]
pub fn fitted(text: &str, height_mm: f64, least_mm: f64, width_mm: f64) -> (String, f64) {
    let wanted = text_width_mm(text, height_mm);
    let height = if wanted > width_mm { (height_mm * width_mm / wanted).max(least_mm) } else { height_mm };
    let mut kept = text.to_owned();
    while text_width_mm(&kept, height) > width_mm + 1e-9 {
        let shorter: Vec<char> = kept.trim_end_matches('.').chars().collect();
        if shorter.is_empty() {
            break;
        }
        kept = shorter[..shorter.len() - 1].iter().collect::<String>() + "...";
        if shorter.len() == 1 {
            kept = String::new();
        }
    }
    (kept, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font() {
        // Adobe's metrics: R 722, period 278, five 556, and the degree sign 400.
        let em = 2.5 / CAPITAL_PER_EM;
        assert!((text_width_mm("R0.5\u{b0}", 2.5) - (0.722 + 2.0 * 0.556 + 0.278 + 0.4) * em).abs() < 1e-12);
    }

    #[test]
    fn a_text_that_is_too_long_shrinks_and_then_loses_its_end() {
        assert_eq!(fitted("abc", 5.0, 1.8, 100.0), ("abc".to_owned(), 5.0));
        let long = "a very long name of a switch, which nobody would write on a title block".repeat(2);
        let (kept, height) = fitted(&long, 5.0, 1.8, 60.0);
        assert!(height >= 1.8 && kept.ends_with("...") && text_width_mm(&kept, height) <= 60.0 + 1e-9);
        assert_eq!(fitted("abc", 5.0, 5.0, 0.1).0, "");
    }
}
