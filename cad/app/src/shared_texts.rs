//! Texts that the module and the page both contain, such as the libraries of `report.html`.

/// Overwrites each of `texts` in a module with zeros, which take no room when they are packed; the worker inserts them again before
/// it compiles the module. Returns the offset of each text in bytes; `None` for one that the module does not contain.
pub fn clear_texts(module: &mut [u8], texts: &[&str]) -> Vec<Option<usize>> {
    texts.iter().map(|text| clear_text(module, text)).collect()
}

fn clear_text(bytes: &mut [u8], text: &str) -> Option<usize> {
    let offset = bytes.windows(text.len().max(1)).position(|window| window == text.as_bytes())?;
    bytes.get_mut(offset..offset + text.len())?.fill(0);
    Some(offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_become_zeros() {
        let mut module = b"..a text of the page too..".to_vec();
        let offsets = clear_texts(&mut module, &["a text of the page too", "another"]);
        assert_eq!(offsets, [Some(2), None]);
        assert_eq!(module, b"..\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0..");
    }
}
