//! JSON documents with their own checksum, which reveals a damaged or edited file.

use sha2::{Digest, Sha256};

use super::hexadecimal;

/// Text between the document and its hash.
const KEY: &str = ",\n  \"checksum\": \"";
/// Text after the hash.
const END: &str = "\"\n}\n";

/// Appends the key `checksum` to an indented JSON object: the SHA-256 of all bytes before it.
pub fn with_checksum(mut json: Vec<u8>) -> Vec<u8> {
    while json.last().is_some_and(|b| b"\n}".contains(b)) {
        // The brace of an inner object at the end is indented, and stays.
        let is_last_brace = json.last() == Some(&b'}');
        json.pop();
        if is_last_brace {
            break;
        }
    }
    while json.last() == Some(&b'\n') {
        json.pop();
    }
    let hash = hexadecimal(&Sha256::digest(&json));
    json.extend([KEY, &hash, END].concat().into_bytes());
    json
}

/// Returns whether these are unchanged bytes from [`with_checksum`].
pub fn has_valid_checksum(bytes: &[u8]) -> bool {
    let hash_length = 2 * Sha256::output_size();
    let Some(at) = bytes.len().checked_sub(KEY.len() + hash_length + END.len()) else { return false };
    let (json, rest) = bytes.split_at(at);
    rest == [KEY, &hexadecimal(&Sha256::digest(json)), END].concat().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_detect_any_flipped_bit() {
        for value in [serde_json::json!({"a": [1, {"b": {}}]}), serde_json::json!({"z": {"y": {"x": 1}}})] {
            for end in ["", "\n"] {
                let mut bytes = serde_json::to_vec_pretty(&value).unwrap();
                bytes.extend(end.as_bytes());
                let document = with_checksum(bytes);
                let mut read: serde_json::Value = serde_json::from_slice(&document).unwrap();
                assert!(read.as_object_mut().unwrap().remove("checksum").is_some());
                assert_eq!(read, value);
                assert!(has_valid_checksum(&document));
                for bit in 0..8 * document.len() {
                    let mut damaged = document.clone();
                    damaged[bit / 8] ^= 1 << (bit % 8);
                    assert!(!has_valid_checksum(&damaged), "bit {bit}");
                }
                for length in 0..document.len() {
                    assert!(!has_valid_checksum(&document[..length]));
                }
            }
        }
    }
}
