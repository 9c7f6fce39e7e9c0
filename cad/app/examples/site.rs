//! Writes the configurator as one file: `cargo run -p pinswitch-app --example site -- MODULE.wasm
//! FOLDER`. The page contains the module, so that a double click opens it. `cad/app/build` compiles
//! the module and runs this.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use lzma_rust2::{CheckType, LzmaOptions, XzOptions, XzWriter};
use pinswitch_app::shared_texts::clear_texts;
use pinswitch_switch::formats::page::{PackedModule, PageState, SHARED_TEXTS, worker_script};
use walrus::{ModuleConfig, passes};

/// Exports that the page uses.
const EXPORTS: [&str; 4] = ["memory", "room", "answer", "free"];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [module, folder] = arguments.as_slice() else {
        return Err("expected two arguments: the module and the folder of the site".into());
    };
    let mut bytes = reachable(&std::fs::read(module)?)
        .map_err(|error| format!("{} is not a WebAssembly module: {error}", module.display()))?;
    let offsets = clear_texts(&mut bytes, &SHARED_TEXTS);
    if let Some(missing) = offsets.iter().position(Option::is_none) {
        return Err(format!("text {missing} of the page is not in the module, which would be larger").into());
    }
    let module = PackedModule { base64: STANDARD.encode(xz(&bytes)?), worker: worker_script(), offsets };
    std::fs::create_dir_all(folder)?;
    let page = folder.join("index.html");
    std::fs::write(&page, PageState::File(&module).html())?;
    println!("{}", page.display());
    Ok(())
}

/// Returns a module with what its page can reach: libraries export functions to a tool for bindings that it does not use.
fn reachable(module: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut config = ModuleConfig::new();
    config.generate_producers_section(false).generate_name_section(false).generate_dwarf(false);
    let mut module = config.parse(module)?;
    let is_unused = |name: &str| !EXPORTS.contains(&name);
    let unused: Vec<_> =
        module.exports.iter().filter(|export| is_unused(&export.name)).map(|export| export.id()).collect();
    unused.into_iter().for_each(|export| module.exports.delete(export));
    let customs: Vec<_> = module.customs.iter().map(|(custom, _)| custom).collect();
    customs.into_iter().for_each(|custom| drop(module.customs.delete(custom)));
    passes::gc::run(&mut module);
    Ok(module.emit_wasm())
}

/// Packs a module as XZ. `lc` is the maximum, since in code the previous byte predicts the next one
/// better than its alignment does.
fn xz(module: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut options = XzOptions::with_preset(9);
    options.lzma_options = LzmaOptions { lc: 4, lp: 0, pb: 0, nice_len: 273, ..LzmaOptions::with_preset(9) };
    // A browser allocates the whole dictionary: it is not larger than a module needs.
    options.lzma_options.dict_size = 1 << 23;
    options.set_check_sum_type(CheckType::Crc32);
    let mut writer = XzWriter::new(Vec::new(), options)?;
    writer.write_all(module)?;
    Ok(writer.finish()?)
}
