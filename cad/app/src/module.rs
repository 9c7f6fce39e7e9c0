//! Exports of the WebAssembly module: memory for a request, and its answer. The module imports
//! nothing.
//!
//! The page calls `room(length)`, writes its request there as UTF-8, and calls `answer(address,
//! length)`. The result is the address of twelve bytes, little-endian: the kind (0 JSON, 1 the
//! bytes of a file), the length and the address of the content. They stay valid until `free` or the
//! next request.
// The page calls the exports; the compiler sees no caller.
#![allow(unsafe_code, unreachable_pub)]

use std::cell::RefCell;

use crate::{Answer, Engine};

#[derive(Default)]
struct Module {
    engine: Engine,
    request: Vec<u8>,
    content: Vec<u8>,
    header: [u8; 12],
}

thread_local! {
    static MODULE: RefCell<Module> = RefCell::default();
}

/// Allocates memory for a request of `length` bytes and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.request = vec![0; length];
        module.request.as_mut_ptr()
    })
}

/// Answers the request in the memory that [`room`] allocated; returns the address of the header.
#[unsafe(no_mangle)]
pub extern "C" fn answer(_address: *const u8, length: usize) -> *const u8 {
    MODULE.with_borrow_mut(|module| {
        let request = std::mem::take(&mut module.request);
        let text = request.get(..length).map(String::from_utf8_lossy).unwrap_or_default();
        let (kind, content) = match module.engine.answer(&text) {
            Answer::Json(text) => (0u32, text.into_bytes()),
            Answer::Bytes(bytes) => (1u32, bytes),
        };
        module.content = content;
        // Addresses and lengths of wasm32 have 32 bits.
        #[allow(clippy::cast_possible_truncation)]
        let number = |n: usize| (n as u32).to_le_bytes();
        module.header[..4].copy_from_slice(&kind.to_le_bytes());
        module.header[4..8].copy_from_slice(&number(module.content.len()));
        module.header[8..].copy_from_slice(&number(module.content.as_ptr() as usize));
        module.header.as_ptr()
    })
}

/// Frees the content of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn free(_address: *const u8) {
    MODULE.with_borrow_mut(|module| module.content = Vec::new());
}
