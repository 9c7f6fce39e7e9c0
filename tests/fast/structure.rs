//! The structure of the source: files of a crate that import each other in a circle cannot be read
//! one at a time, so circles have at most three files. Every crate is complete for a registry.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::harness::repository;

/// Path of a module within its crate.
type Module = Vec<String>;

/// Largest number of files that may import each other in a circle.
const LARGEST_CIRCLE: usize = 3;

/// Collects the modules of a crate with their code, without comments and tests.
fn modules(folder: &Path, at: &[String], all: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let inner = |name: String| at.iter().cloned().chain([name]).collect::<Module>();
        if path.is_dir() {
            modules(&path, &inner(name), all);
        } else if path.extension().is_some_and(|e| e == "rs") && !name.ends_with("tests") {
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            let code: String =
                code.lines().map(|line| line.split("//").next().unwrap_or("").to_owned() + "\n").collect();
            let is_root = ["mod", "lib", "main"].contains(&name.as_str());
            all.entry(if is_root { at.to_vec() } else { inner(name) }).or_default().push_str(&code);
        }
    }
}

/// Returns the paths of a `use` tree such as `a::{b, c::{d, e}}`.
fn paths(tree: &str) -> Vec<String> {
    let Some((prefix, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let body = rest.rsplit_once('}').map_or(rest, |(body, _)| body);
    let (mut depth, mut item, mut items) = (0, String::new(), Vec::new());
    for c in body.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            items.push(std::mem::take(&mut item));
        } else {
            item.push(c);
        }
    }
    items.push(item);
    items
        .iter()
        .filter(|item| !item.trim().is_empty())
        .flat_map(|item| paths(&format!("{prefix}{}", item.trim())))
        .collect()
}

/// Returns the `use` trees of a module, each with whether it re-exports.
fn imports(code: &str) -> Vec<(bool, Vec<String>)> {
    let statements = code.split(';').filter_map(|statement| {
        let (before, tree) = statement
            .rsplit_once("use ")
            .filter(|(before, _)| before.trim_end().is_empty() || before.ends_with(['\n', ' ']))?;
        let last = before.lines().last().unwrap_or_default().trim();
        Some((last.starts_with("pub"), paths(tree)))
    });
    statements.collect()
}

/// Returns the absolute path of what `path` names in `module`; `None` for another crate.
fn absolute(all: &BTreeMap<Module, String>, module: &Module, path: &str) -> Option<Module> {
    let mut parts: Vec<String> = path.split("::").map(str::to_owned).collect();
    let mut base = match parts.first()?.as_str() {
        "crate" => Vec::new(),
        "self" => module.clone(),
        "super" => module[..module.len().checked_sub(1)?].to_vec(),
        name => {
            let child: Module = module.iter().cloned().chain([name.to_owned()]).collect();
            return all.contains_key(&child).then(|| module.iter().cloned().chain(parts).collect());
        }
    };
    parts.remove(0);
    while parts.first().is_some_and(|part| part == "super") {
        base.pop()?;
        parts.remove(0);
    }
    Some(base.into_iter().chain(parts).collect())
}

/// Returns the longest prefix of a path that is a module, with the item that follows.
fn module_of(all: &BTreeMap<Module, String>, path: &Module) -> (Module, Option<String>) {
    let length = (0..=path.len()).rev().find(|n| all.contains_key(&path[..*n])).unwrap_or(0);
    (path[..length].to_vec(), path.get(length).cloned())
}

/// Returns which modules each module imports from; items are followed through re-exports.
fn edges(all: &BTreeMap<Module, String>) -> BTreeMap<Module, BTreeSet<Module>> {
    let mut exports: BTreeMap<(Module, String), Module> = BTreeMap::new();
    for (module, code) in all {
        for path in imports(code).into_iter().filter(|(is_public, _)| *is_public).flat_map(|(_, paths)| paths)
        {
            let Some(path) = absolute(all, module, &path) else { continue };
            if let (target, Some(item)) = module_of(all, &path)
                && target != *module
            {
                exports.insert((module.clone(), item), target);
            }
        }
    }
    let mut edges = BTreeMap::new();
    for (module, code) in all {
        let mut targets = BTreeSet::new();
        let private =
            imports(code).into_iter().filter(|(is_public, _)| !is_public).flat_map(|(_, paths)| paths);
        let is_path = |c: char| c.is_alphanumeric() || "_:".contains(c);
        let inline =
            code.split(|c| !is_path(c)).filter(|w| w.starts_with("crate::") || w.starts_with("super::"));
        for path in private.chain(inline.map(str::to_owned)) {
            let Some(path) = absolute(all, module, &path) else { continue };
            let (mut target, item) = module_of(all, &path);
            while let Some(next) = item.as_ref().and_then(|item| exports.get(&(target.clone(), item.clone())))
            {
                target.clone_from(next);
            }
            if target != *module {
                targets.insert(target);
            }
        }
        edges.insert(module.clone(), targets);
    }
    edges
}

/// Returns the modules that can be reached from one.
fn reachable(edges: &BTreeMap<Module, BTreeSet<Module>>, from: &Module) -> BTreeSet<Module> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from.clone()]);
    while let Some(module) = open.pop() {
        for next in edges.get(&module).into_iter().flatten() {
            if reached.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    reached
}

#[test]
fn circles_of_files_are_small() {
    let mut files = 0;
    for group in ["cad", "model"] {
        for entry in std::fs::read_dir(repository(group)).unwrap() {
            let source = entry.unwrap().path().join("src");
            if !source.is_dir() {
                continue;
            }
            let mut all = BTreeMap::new();
            modules(&source, &[], &mut all);
            files += all.len();
            let edges = edges(&all);
            let reach: BTreeMap<_, _> =
                all.keys().map(|module| (module, reachable(&edges, module))).collect();
            for (module, reached) in &reach {
                let circle: Vec<String> = reached
                    .iter()
                    .filter(|other| reach[other].contains(*module))
                    .map(|m| m.join("/"))
                    .collect();
                assert!(circle.len() <= LARGEST_CIRCLE, "{}: {circle:?} import each other", source.display());
            }
        }
    }
    assert!(files > 300, "only {files} files were read");
}

/// The search for feasible values builds parts; what needs both is in the folder `warnings`.
#[test]
fn parts_do_not_import_their_users() {
    let mut all = BTreeMap::new();
    modules(&repository("cad/switch/src"), &[], &mut all);
    let edges = edges(&all);
    let in_folder = |module: &Module, folder: &str| module.first().is_some_and(|name| name == folder);
    let parts: Vec<_> = edges.iter().filter(|(module, _)| in_folder(module, "parts")).collect();
    assert!(parts.len() > 15, "only {} files of parts were read", parts.len());
    for (module, targets) in parts {
        let users =
            targets.iter().filter(|target| ["feasibility", "warnings"].iter().any(|f| in_folder(target, f)));
        assert_eq!(users.collect::<Vec<_>>(), Vec::<&Module>::new(), "{}", module.join("/"));
    }
}

#[test]
fn a_circle_of_four_files_is_found() {
    let file = |code: &str| code.to_owned();
    let all: BTreeMap<Module, String> = [
        (vec![], file("mod a;\npub use a::A;\n")),
        (vec!["a".to_owned()], file("use crate::b::{B, c::C};\n")),
        (vec!["b".to_owned()], file("fn f() { super::d::g() }\n")),
        (vec!["b".to_owned(), "c".to_owned()], file("use super::super::d::D;\n")),
        (vec!["d".to_owned()], file("use crate::A;\n")),
    ]
    .into();
    let edges = edges(&all);
    let a = vec!["a".to_owned()];
    let reached = reachable(&edges, &a);
    assert!(reached.contains(&a) && reached.len() == 4 && !reached.contains(&vec![]), "{edges:?}");
}

/// A registry shows these, and a package without its license cannot be used.
#[test]
fn crates_have_license_and_description() {
    let workspace: toml_edit::DocumentMut =
        std::fs::read_to_string(repository("Cargo.toml")).unwrap().parse().unwrap();
    let members = workspace["workspace"]["members"].as_array().unwrap();
    assert!(members.len() > 15, "only {} crates were read", members.len());
    let license = std::fs::read(repository("LICENSE")).unwrap();
    for member in members {
        let folder = repository(member.as_str().unwrap());
        let manifest: toml_edit::DocumentMut =
            std::fs::read_to_string(folder.join("Cargo.toml")).unwrap().parse().unwrap();
        let package = &manifest["package"];
        let crate_name = folder.display();
        let is_filled = |text: Option<&str>| text.is_some_and(|text| !text.trim().is_empty());
        assert!(is_filled(package["description"].as_str()), "{crate_name} has no description");
        let has_readme = package.get("readme").is_some_and(|readme| {
            readme.get("workspace").is_some_and(|w| w.as_bool() == Some(true)) || is_filled(readme.as_str())
        });
        assert!(has_readme, "{crate_name} has no readme");
        let keywords = package.get("keywords").and_then(|k| k.as_array()).map_or(0, |k| k.len());
        assert!((1..=5).contains(&keywords), "{crate_name} has {keywords} keywords, not 1 to 5");
        let file = folder.join("LICENSE");
        assert!(file.is_symlink(), "{crate_name} has no link to the license");
        assert_eq!(std::fs::read(file).unwrap(), license, "{crate_name} has another license");
    }
}
