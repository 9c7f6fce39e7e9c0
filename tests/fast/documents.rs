//! Citations and links: every path to a document resolves, every effect has its section, and README
//! lists every command.

use std::path::{Path, PathBuf};

use crate::harness::{binary, repository};

/// Collects the texts of this repository that may cite a document, without generated and foreign
/// ones.
fn texts(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !["target", "out", ".git", "node_modules"].contains(&name.as_str()) {
                texts(&path, files);
            }
        } else if [".rs", ".md", ".toml", ".html", ".js", ".py", ".cff"].iter().any(|e| name.ends_with(e))
            && !name.contains(".min.")
        {
            files.push(path);
        }
    }
}

/// Returns the words of a text that end in `.md`, without punctuation.
fn cited(text: &str) -> impl Iterator<Item = &str> {
    let is_path = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    text.split(move |c| !is_path(c)).filter(|word| word.len() > 3 && word.ends_with(".md"))
}

#[test]
fn cited_documents_exist() {
    // Files that runs write.
    const OUTPUTS: [&str; 2] = ["PRINTING.md", "MEASURED.md"];
    let mut files = Vec::new();
    texts(&repository(""), &mut files);
    let mut citations = 0;
    for file in &files {
        let Ok(text) = std::fs::read_to_string(file) else { continue };
        for path in cited(&text).filter(|path| !OUTPUTS.contains(path) && !path.starts_with('.')) {
            let sibling = file.parent().unwrap().join(path);
            assert!(
                sibling.exists() || repository(path).exists(),
                "{} cites {path}, which does not exist",
                file.display()
            );
            citations += 1;
        }
    }
    assert!(citations > 50, "only {citations} citations were found");
}

/// Returns the anchors of the headings of a document as renderers of Markdown make them: lower
/// case, spaces as hyphens, and no other punctuation than hyphens and underscores.
fn anchors(text: &str) -> Vec<String> {
    let anchor = |heading: &str| -> String {
        let kept = heading.to_lowercase().replace(' ', "-");
        kept.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
    };
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#').trim())).collect()
}

#[test]
fn links_between_documents_resolve() {
    let mut files = Vec::new();
    texts(&repository(""), &mut files);
    let (mut links, mut places) = (0, 0);
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "md")) {
        let text = std::fs::read_to_string(file).unwrap();
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.starts_with("http") || link.contains(' ') {
                continue;
            }
            let (path, place) = link.split_once('#').unwrap_or((link, ""));
            let linked = if path.is_empty() { file.clone() } else { file.parent().unwrap().join(path) };
            assert!(linked.exists(), "{} links {link}", file.display());
            links += 1;
            if !place.is_empty() {
                let headings = anchors(&std::fs::read_to_string(&linked).unwrap());
                assert!(headings.iter().any(|h| h == place), "{} links {link}: {headings:?}", file.display());
                places += 1;
            }
        }
    }
    assert!(links > 20 && places > 10, "only {links} links to {places} headings were found");
}

#[test]
fn every_effect_has_its_section() {
    let catalogue = std::fs::read_to_string(repository("model/doc/effect-catalogue.md")).unwrap();
    for effect in pinswitch_calibration::effects::CATALOGUE {
        assert!(catalogue.contains(&format!("### `{}`\n", effect.id())), "no section for {}", effect.id());
    }
}

#[test]
fn readme_lists_every_command() {
    let help = String::from_utf8(binary().arg("--help").output().unwrap().stdout).unwrap();
    let commands = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let readme = std::fs::read_to_string(repository("README.md")).unwrap();
    // Lines with more indent continue the previous one.
    let commands = commands.filter(|l| !l.starts_with("   "));
    for command in commands.filter_map(|l| l.split_whitespace().next()).filter(|c| *c != "help") {
        assert!(
            readme.contains(&format!("pinswitch {command}")) || readme.contains(&format!("`{command}`")),
            "{command}"
        );
    }
}

/// The members of the workspace, as Cargo.toml lists them.
fn workspace_members() -> Vec<String> {
    let manifest: toml_edit::DocumentMut =
        std::fs::read_to_string(repository("Cargo.toml")).unwrap().parse().unwrap();
    let members = manifest["workspace"]["members"].as_array().unwrap();
    members.iter().map(|member| member.as_str().unwrap().to_owned()).collect()
}

#[test]
fn contributing_maps_every_crate() {
    let contributing = std::fs::read_to_string(repository("CONTRIBUTING.md")).unwrap();
    let (_, table) = contributing.split_once("| crate | content |\n").unwrap();
    let rows = table.lines().skip(1).take_while(|line| line.starts_with('|'));
    let mapped: Vec<_> = rows.filter_map(|row| row.split('`').nth(1).map(str::to_owned)).collect();
    let mut members = workspace_members();
    members.sort();
    assert_eq!(mapped, members);
}

/// Figures age unseen where they are typed: every sentence of the ledger of measurements is in the
/// documents that it names.
#[test]
fn measured_figures_are_current() {
    let ledger = std::fs::read_to_string(repository("cad/benches/ledger.json")).unwrap();
    let ledger: serde_json::Value = serde_json::from_str(&ledger).unwrap();
    let figures = ledger["figures"].as_object().unwrap();
    assert!(figures.len() > 5);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for (name, figure) in figures {
        let sentence = words(figure["text"].as_str().unwrap());
        for document in figure["documents"].as_array().unwrap() {
            let document = document.as_str().unwrap();
            let text = std::fs::read_to_string(repository(document)).unwrap();
            assert!(
                words(&text).contains(&sentence),
                "{document} does not contain the figure \"{name}\": {sentence:?}; see cad/benches/ledger.py"
            );
        }
    }
}
