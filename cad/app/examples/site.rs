//! Writes the configurator as one file: `cargo run -p pinswitch-app --example site -- MODULE.wasm
//! FOLDER`. The page contains the module, so that a double click opens it. `cad/app/build` compiles
//! the module and runs this.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use lzma_rust2::{CheckType, LzmaOptions, XzOptions, XzWriter};
use pinswitch_app::page::{LIBRARIES, PackedModule, configurator_html};
use pinswitch_app::strip::strip;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [module, folder] = arguments.as_slice() else {
        return Err("expected two arguments: the module and the folder of the site".into());
    };
    let stripped = strip(&std::fs::read(module)?, &LIBRARIES)
        .ok_or_else(|| format!("{} is not a WebAssembly module", module.display()))?;
    let module = PackedModule {
        base64: STANDARD.encode(xz(&stripped.bytes)?),
        library_offsets: stripped.text_offsets,
    };
    std::fs::create_dir_all(folder)?;
    let page = folder.join("index.html");
    std::fs::write(&page, configurator_html(Some(&module)))?;
    println!("{}", page.display());
    Ok(())
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
