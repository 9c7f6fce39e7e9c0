//! What the WebAssembly module exports: room for a question, and its answer. It imports nothing.
//!
//! The page asks for `room(length)`, writes its question there as UTF-8, and calls `answer(place, length)`. That gives the
//! place of twelve bytes, little-endian: the kind (0 JSON, 1 bytes of a file), the length and the place of the content,
//! which stay until `free` or the next question.
// The page calls these, which the compiler does not see.
#![allow(unsafe_code, unreachable_pub)]

use std::cell::RefCell;

use crate::{Answer, Engine};

#[derive(Default)]
struct Module {
    engine: Engine,
    question: Vec<u8>,
    content: Vec<u8>,
    header: [u8; 12],
}

thread_local! {
    static MODULE: RefCell<Module> = RefCell::default();
}

/// Room for a question of `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.question = vec![0; length];
        module.question.as_mut_ptr()
    })
}

/// The place of the answer to the question that was written into the room.
#[unsafe(no_mangle)]
pub extern "C" fn answer(_place: *const u8, length: usize) -> *const u8 {
    MODULE.with_borrow_mut(|module| {
        let question = std::mem::take(&mut module.question);
        let text = question.get(..length).map(String::from_utf8_lossy).unwrap_or_default();
        let (kind, content) = match module.engine.answer(&text) {
            Answer::Json(text) => (0u32, text.into_bytes()),
            Answer::Bytes(bytes) => (1u32, bytes),
        };
        module.content = content;
        // Places and lengths of a module of 32 bits.
        #[allow(clippy::cast_possible_truncation)]
        let number = |n: usize| (n as u32).to_le_bytes();
        module.header[..4].copy_from_slice(&kind.to_le_bytes());
        module.header[4..8].copy_from_slice(&number(module.content.len()));
        module.header[8..].copy_from_slice(&number(module.content.as_ptr() as usize));
        module.header.as_ptr()
    })
}

/// Gives the room of the last answer back.
#[unsafe(no_mangle)]
pub extern "C" fn free(_place: *const u8) {
    MODULE.with_borrow_mut(|module| module.content = Vec::new());
}
