//! JSON documents that bear their own hash, so that a damaged or edited one is not taken for what was written.

use sha2::{Digest, Sha256};

use super::hexadecimal;

/// What comes between the document and its hash.
const KEY: &str = ",\n  \"checksum\": \"";
/// What comes after the hash.
const END: &str = "\"\n}\n";

/// A JSON object, indented, with `checksum` as its last key: the SHA-256 of all bytes before it.
pub(super) fn seal(mut json: Vec<u8>) -> Vec<u8> {
    while json.last().is_some_and(|b| b"\n}".contains(b)) {
        // An inner object at the end keeps its brace: it is indented.
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

/// Whether these are the bytes that [`seal`] made.
pub(super) fn is_sealed(bytes: &[u8]) -> bool {
    let hash_length = 2 * Sha256::output_size();
    let Some(at) = bytes.len().checked_sub(KEY.len() + hash_length + END.len()) else { return false };
    let (json, rest) = bytes.split_at(at);
    rest == [KEY, &hexadecimal(&Sha256::digest(json)), END].concat().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sealed_document_is_json_and_any_flipped_bit_is_seen() {
        for value in [serde_json::json!({"a": [1, {"b": {}}]}), serde_json::json!({"z": {"y": {"x": 1}}})] {
            for end in ["", "\n"] {
                let mut bytes = serde_json::to_vec_pretty(&value).unwrap();
                bytes.extend(end.as_bytes());
                let sealed = seal(bytes);
                let mut read: serde_json::Value = serde_json::from_slice(&sealed).unwrap();
                assert!(read.as_object_mut().unwrap().remove("checksum").is_some());
                assert_eq!(read, value);
                assert!(is_sealed(&sealed));
                for bit in 0..8 * sealed.len() {
                    let mut damaged = sealed.clone();
                    damaged[bit / 8] ^= 1 << (bit % 8);
                    assert!(!is_sealed(&damaged), "bit {bit}");
                }
                for length in 0..sealed.len() {
                    assert!(!is_sealed(&sealed[..length]));
                }
            }
        }
    }
}
