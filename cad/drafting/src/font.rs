//! Widths of text in Helvetica, which every PDF reader has. Arial and Liberation Sans have the same widths.

/// Height of a capital letter over the size of the font: Helvetica's is 718 thousandths.
pub(super) const CAPITAL_PER_EM: f64 = 0.718;
/// Descent of letters such as g below the baseline, over the size of the font.
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

/// The same in Helvetica Bold.
#[rustfmt::skip]
const BOLD: [u16; 95] = [
    278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 333, 333, 584, 584, 584, 611,
    975, 722, 722, 722, 722, 667, 611, 778, 722, 278, 556, 722, 611, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 333, 278, 333, 584, 556,
    333, 556, 611, 556, 611, 556, 333, 611, 611, 278, 278, 556, 278, 889, 611, 611,
    611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389, 280, 389, 584,
];
/// Width of every character of Courier.
const FIXED: u16 = 600;

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
/// Width of any other character, an upper bound for every script.
const OTHER: u16 = 1000;

fn width_thousandths(character: char) -> u16 {
    let code = character as usize;
    let ascii = code.checked_sub(0x20).and_then(|i| ASCII.get(i));
    ascii.or_else(|| code.checked_sub(0xa0).and_then(|i| LATIN.get(i))).copied().unwrap_or(OTHER)
}

/// Weight of a typeface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    /// Helvetica.
    Regular,
    /// Helvetica Bold. Letters beyond ASCII have the widths of Helvetica.
    Bold,
    /// Courier.
    Fixed,
}

/// Width of a text over the size of the font.
pub(super) fn width_of(text: &str, weight: Weight) -> f64 {
    let width = |c: char| match weight {
        Weight::Regular => width_thousandths(c),
        Weight::Bold => {
            let known = (c as usize).checked_sub(0x20).and_then(|i| BOLD.get(i).copied());
            known.unwrap_or_else(|| width_thousandths(c))
        }
        Weight::Fixed => FIXED,
    };
    text.chars().map(|c| f64::from(width(c))).sum::<f64>() / 1000.0
}

/// Width in mm of `text` whose capitals are `height_mm` high.
pub(super) fn text_width_mm(text: &str, height_mm: f64) -> f64 {
    text.chars().map(|c| f64::from(width_thousandths(c))).sum::<f64>() / 1000.0 * height_mm / CAPITAL_PER_EM
}

/// Distance of baselines over the height of capitals.
pub(super) const LINE_PER_CAPITAL: f64 = 1.45;

/// Breaks a text into lines that fit into a box of `width_mm` by `room_mm`; returns the lines and the height of their
/// capitals, at most `height_mm`. A text that would be smaller than `least_mm` in one line gets more lines. Nothing is cut:
/// longer texts become smaller.
pub(super) fn fit_text(
    text: &str,
    height_mm: f64,
    least_mm: f64,
    [width_mm, room_mm]: [f64; 2],
) -> (Vec<String>, f64) {
    let mut best = (vec![text.to_owned()], 0.0);
    for lines in 1..=MOST_LINES {
        // Lines start as high as the box allows, and shrink until the text fits.
        let of_room = room_mm / (1.0 + LINE_PER_CAPITAL * (lines - 1) as f64);
        let mut height = height_mm.min(of_room.max(if lines == 1 { height_mm } else { 0.0 }));
        let mut broken = broken(text, height, width_mm);
        for _ in 0..SHRINKINGS {
            if broken.len() <= lines && broken.iter().all(|l| text_width_mm(l, height) <= width_mm + 1e-9) {
                break;
            }
            height *= SHRINKING;
            broken = self::broken(text, height, width_mm);
        }
        if height > best.1 {
            best = (broken, height);
        }
        if best.1 >= least_mm {
            break;
        }
    }
    best
}

/// Most lines into which a text is broken.
const MOST_LINES: usize = 6;
/// Factor by which a text shrinks until it fits, and the most steps.
const SHRINKING: f64 = 0.97;
const SHRINKINGS: u32 = 120;

/// Breaks a text into lines of at most `width_mm`, after a space or a mark where possible.
fn broken(text: &str, height_mm: f64, width_mm: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest = text;
    while text_width_mm(rest, height_mm) > width_mm + 1e-9 {
        let ends = rest.char_indices().map(|(i, c)| i + c.len_utf8());
        let fits: Vec<usize> =
            ends.take_while(|i| text_width_mm(&rest[..*i], height_mm) <= width_mm).collect();
        let Some(longest) = fits.last().copied() else { break };
        let is_seam = |i: &&usize| rest[..**i].ends_with([' ', '/', '-', '_', ',']);
        let seam = fits.iter().rev().find(is_seam).copied().filter(|i| 2 * i > longest);
        let (line, after) = rest.split_at(seam.unwrap_or(longest));
        lines.push(line.trim_end().to_owned());
        rest = after;
    }
    lines.push(rest.to_owned());
    lines
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
    fn long_texts_shrink_and_break() {
        assert_eq!(fit_text("abc", 5.0, 1.8, [100.0, 6.0]), (vec!["abc".to_owned()], 5.0));
        let long = "a very long name of a switch, too long for a single line of a title block ".repeat(2);
        for (text, width) in
            [(long.as_str(), 60.0), (&"W".repeat(160), 60.0), (&"\u{30b9}".repeat(120), 30.0)]
        {
            let (lines, height) = fit_text(text, 3.0, 1.4, [width, 6.0]);
            let letters = |t: &str| t.chars().filter(|c| *c != ' ').collect::<String>();
            assert_eq!(letters(&lines.concat()), letters(text), "nothing is lost");
            assert!(lines.len() > 1 && height > 0.4, "{height}");
            assert!(lines.iter().all(|l| text_width_mm(l, height) <= width + 1e-9));
            assert!(height * (1.0 + LINE_PER_CAPITAL * (lines.len() - 1) as f64) <= 6.0 + 1e-9);
        }
    }
}
