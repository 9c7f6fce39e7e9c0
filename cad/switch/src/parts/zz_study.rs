//! temporary
use super::{printed, reference_bodies};
use crate::config::{Configuration, read};
use crate::design::Design;
use pinswitch_solid::profile::ChordTolerance;
use pinswitch_solid::verification::{second_kernel, verify};

#[test]
fn zz_study() {
    let kernel = second_kernel().unwrap();
    let mut files: Vec<_> = ["../../templates", "../../tests/golden", "../../tests/corpus"]
        .iter()
        .flat_map(|d| std::fs::read_dir(d).unwrap())
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    let only = std::env::var("ZZ_ONLY").unwrap_or_default();
    let tolerances: Vec<f64> =
        std::env::var("ZZ_TOL").unwrap_or("0.01".into()).split(',').map(|t| t.parse().unwrap()).collect();
    let mut worst: [(f64, String); 5] = Default::default();
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        if !name.contains(&only) {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let Ok((c, _)) = read(&text, &name) else { continue };
        let _: &Configuration = &c;
        let Ok(design) = Design::new(c) else { continue };
        let (Ok(parts), Ok(bodies)) = (printed(&design), reference_bodies(&design)) else { continue };
        for part in parts.iter().chain(&bodies) {
            for t in &tolerances {
                let tolerance = ChordTolerance::new(*t).unwrap();
                let Ok(mesh) = part.solid.mesh(tolerance) else { continue };
                let start = std::time::Instant::now();
                match verify(&part.solid, &mesh, tolerance, kernel) {
                    Ok(v) => {
                        let r = [
                            v.volume_relative / v.volume_limit,
                            v.area_relative / v.area_limit,
                            v.bounds_mm / v.bounds_limit_mm,
                            v.distance_mm[0] / v.distance_limit_mm[0],
                            v.distance_mm[1] / v.distance_limit_mm[1],
                        ];
                        for (w, x) in worst.iter_mut().zip(r) {
                            if x > w.0 {
                                *w = (x, format!("{name}/{} at {t}: {v:?}", part.name));
                            }
                        }
                        if std::env::var("ZZ_ALL").is_ok() {
                            println!(
                                "{name}/{} {t}: {r:.3?} vol limit {:.2e} area limit {:.2e} {:.0} ms",
                                part.name,
                                v.volume_limit,
                                v.area_limit,
                                start.elapsed().as_secs_f64() * 1e3
                            );
                        }
                    }
                    Err(e) => println!("FAIL {name}/{} {t}: {e}", part.name),
                }
            }
        }
    }
    for w in worst {
        println!("worst {:.3} {}", w.0, w.1);
    }
}
