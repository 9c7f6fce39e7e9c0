//! A stroke font for engraving: capitals, figures and some signs on a grid 4 wide and 6 high. Strokes meet at wide angles, so
//! that letters have no walls too thin to print.

/// Width of a letter on the grid.
pub(crate) const WIDTH: f64 = 4.0;
/// Height of a letter on the grid.
pub(crate) const HEIGHT: f64 = 6.0;

/// Returns the strokes of a letter as polylines on the grid; none for a space, `None` for a letter that is not in the font.
pub(crate) fn strokes(letter: char) -> Option<Vec<Vec<[f64; 2]>>> {
    // A stroke is a sequence of digit pairs: x, then y.
    let code = match letter {
        'x' => "0044 0440",
        _ => match letter.to_ascii_uppercase() {
            ' ' => "",
            'A' => "000516364540 0343",
            'B' => "00063645443303 3342413000",
            'C' => "4536160501103041",
            'D' => "00062644422000",
            'E' => "46060040 0333",
            'F' => "460600 0333",
            'G' => "460600404333",
            'H' => "0006 4046 0343",
            'I' => "2026 1030 1636",
            'J' => "4641301001",
            'K' => "0006 0323 234546 234140",
            'L' => "060040",
            'M' => "00064640 2622",
            'N' => "00064640",
            'O' => "0040460600",
            'P' => "00063645443303",
            'Q' => "4046060343",
            'R' => "00063645443303 2340",
            'S' => "453616050413334241301001",
            'T' => "0646 2620",
            'U' => "060110304146",
            'V' => "0602204246",
            'W' => "06004046 2024",
            'X' => "0605234140 0001234546",
            'Y' => "0605234546 2320",
            'Z' => "064645010040",
            '0' => "103041453616050110",
            '1' => "2620 1030",
            '2' => "064643030040",
            '3' => "05163645443313 334241301001",
            '4' => "060343 4640",
            '5' => "460603334241301001",
            '6' => "4536160501103041423303",
            '7' => "064640",
            '8' => "133344453616050413 133342413010010213",
            '9' => "0110304145361605041343",
            '-' => "0343",
            '_' => "0040",
            '/' => "0046",
            '.' => "2021",
            ':' => "2122 2425",
            '+' => "2125 0343",
            '=' => "0242 0444",
            '<' => "350331",
            '>' => "154311",
            '(' => "36252130",
            ')' => "16252110",
            _ => return None,
        },
    };
    let digit = |b: u8| f64::from(b - b'0');
    let polyline = |run: &str| run.as_bytes().chunks_exact(2).map(|p| [digit(p[0]), digit(p[1])]).collect();
    Some(code.split_whitespace().map(polyline).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_on_the_grid() {
        let letters = ('A'..='Z').chain('0'..='9').chain("-_/.:+=()<> x".chars());
        for letter in letters {
            for [x, y] in strokes(letter).unwrap().concat() {
                assert!((0.0..=WIDTH).contains(&x) && (0.0..=HEIGHT).contains(&y), "{letter}");
            }
        }
        assert_eq!(strokes('%'), None);
    }
}
