//! Random configurations, and a corpus of configurations that once failed: each gives valid parts
//! or one clear error, and none panics. `PINSWITCH_CASES=2000` makes a long run.

use std::io::Cursor;
use std::sync::atomic::{AtomicU32, Ordering};

use pinswitch_friction::Substrate;
use pinswitch_solid::files::{read_stl, stl_bytes};
use pinswitch_solid::validity::examine;
use pinswitch_switch::config::{Configuration, MouldKind, SlotKind, Slots, read, to_toml};
use pinswitch_switch::design::Design;
use pinswitch_switch::feasibility;
use pinswitch_switch::output::BuildError;
use pinswitch_switch::parts::{Part, printed, reference_bodies};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// The outcome of a configuration.
pub(super) enum Outcome {
    Parts,
    Refused(String),
}

pub(super) fn build(configuration: &Configuration) -> Result<Outcome, String> {
    let parts = feasibility::design(configuration.clone()).and_then(|design| {
        let all: Vec<Part> = [printed(&design)?, reference_bodies(&design)?].concat();
        Ok((design, all))
    });
    let (design, parts) = match parts {
        Ok(both) => both,
        Err(error) => {
            // Without help, the outline of a part failed; building the set adds the proposals.
            let error = match (error.help(), Design::new(configuration.clone())) {
                (None, Ok(design)) => feasibility::build(design).err().map_or(error, Into::into),
                _ => error,
            };
            let text = error.to_string();
            let field = error.location().and_then(|location| location.field.as_deref());
            let known = Configuration::PARAMETERS.iter().any(|p| field == Some(p.path().as_str()));
            return if known && text.contains(';') { Ok(Outcome::Refused(text)) } else { Err(text) };
        }
    };
    for part in &parts {
        let mesh = match part.print_mesh(&design) {
            Ok(mesh) => mesh,
            // No rule covers a fault that occurs while meshing, but its error must also name a
            // field.
            Err(e) => {
                return match feasibility::build(design) {
                    Err(BuildError::Configuration(e)) => Ok(Outcome::Refused(e.to_string())),
                    _ => Err(format!("{}: {e}", part.name)),
                };
            }
        };
        let expected = part.expectation(&design);
        let bytes = stl_bytes(&mesh).map_err(|e| e.to_string())?;
        let written = read_stl(&mut Cursor::new(bytes)).map_err(|e| e.to_string())?;
        for (form, mesh) in [("mesh", &mesh), ("STL", &written.mesh)] {
            let examination = examine(mesh, &expected);
            if !examination.is_flawless() {
                return Err(format!("{} as {form}: {:?}", part.name, examination.faults));
            }
        }
        if written.contrary_normals > 0 || written.mesh.triangles.len() != mesh.triangles.len() {
            return Err(format!("{}: the STL differs from the mesh", part.name));
        }
    }
    Ok(Outcome::Parts)
}

/// Returns configurations over the whole range of sizes, with dependent values, so that many can be
/// built.
pub(super) fn configurations() -> impl Strategy<Value = Configuration> {
    let shape = (8.0..120.0f64, 20.0..340.0f64, 1usize..=40, 0.15..2.0f64, -3.0..-1.0f64);
    let layer = (0.5..4.0f64, 0.0..1.0f64, 4.0..30.0f64, 0.5..1.0f64, 0.0..2.0f64);
    let choices = (0usize..2, 0usize..2, 0usize..3, 0usize..2, 0usize..5);
    let extras = (0.0..0.4f64, 0.0..4.0f64, 0.0..2.0f64, 0.1..0.5f64, any::<u64>(), any::<bool>());
    (shape, layer, choices, extras).prop_map(|(shape, layer, choices, extras)| {
        let (radius, span, grooves, groove, tolerance) = shape;
        let (thickness, margin, width, pin, wall) = layer;
        let (slots, kind, mould, substrate, fasteners) = choices;
        let (foot, draft, shrinkage, least_wall, occupied, pulley) = extras;
        let mut c = Configuration::default();
        c.shell.outer_radius_mm = radius;
        c.segment.span_deg = span;
        c.segment.grooves = grooves;
        c.segment.groove_radius_mm = groove;
        c.mesh.chord_tolerance_mm = 10f64.powf(tolerance);
        c.silicone.thickness_mm = groove + thickness;
        c.segment.end_margin_mm = margin;
        c.shell.width_mm = width;
        c.pins.diameter_mm = 2.0 * groove * pin - c.pins.tolerance_mm;
        c.shell.wall_mm = groove + 1.0 + 3.0 * wall + if fasteners > 0 { 4.5 } else { 0.0 };
        c.layout.wrap_angle_deg = c.layout.wrap_angle_deg.min(span);
        c.layout.pins = (1..=grooves).filter(|i| occupied >> (i % 64) & 1 == 1).collect();
        c.support.slots = [Slots::All, Slots::Occupied][slots];
        c.support.slot_kind = [SlotKind::Blind, SlotKind::Through][kind];
        c.support.plate_mm = 1.5 + c.pins.diameter_mm * 1.5;
        c.support.rise_mm = 1.0 + c.pins.diameter_mm;
        c.mould.kind = [MouldKind::Split, MouldKind::OnePiece, MouldKind::None][mould];
        c.mould.draft_deg = draft;
        c.mould.shrinkage_pct = shrinkage;
        c.layout.substrate = [Substrate::Silicone, Substrate::Abs][substrate];
        c.fasteners.count = fasteners;
        c.print.elephant_foot_mm = if foot < 0.2 { 0.0 } else { foot - 0.2 };
        c.print.least_wall_mm = least_wall;
        c.print.bed_mm = 400.0;
        c.tendon.rope_diameter_mm = 0.6;
        c.parts.guide_pulley = pulley;
        c
    })
}

#[test]
fn random_configurations_build_or_fail_clearly() {
    let cases = std::env::var("PINSWITCH_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(60);
    let (built, refused) = (AtomicU32::new(0), AtomicU32::new(0));
    let mut runner = TestRunner::new_with_rng(
        Config { cases, failure_persistence: None, max_shrink_iters: 200, ..Config::default() },
        TestRng::deterministic_rng(RngAlgorithm::ChaCha),
    );
    let outcome = runner.run(&configurations(), |configuration| {
        match build(&configuration) {
            Ok(Outcome::Parts) => built.fetch_add(1, Ordering::Relaxed),
            Ok(Outcome::Refused(_)) => refused.fetch_add(1, Ordering::Relaxed),
            Err(fault) => {
                // The first printed configuration is the original; the others are proptest's
                // simplifications.
                eprintln!("{fault}\nin\n{}", to_toml(&configuration));
                return Err(TestCaseError::fail(format!("{fault}\nin\n{}", to_toml(&configuration))));
            }
        };
        Ok(())
    });
    let (built, refused) = (built.into_inner(), refused.into_inner());
    println!("{built} built and valid, {refused} refused with one clear error");
    outcome.unwrap_or_else(|e| panic!("{e}"));
    // The test proves nothing if few configurations can be built.
    assert!(built * 3 >= cases, "only {built} of {cases} could be built");
}

#[test]
fn corpus_configurations_have_their_outcome() {
    let folder = crate::harness::repository("tests/corpus");
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    names.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    names.sort();
    assert!(!names.is_empty());
    for path in names {
        let text = std::fs::read_to_string(&path).unwrap();
        let (configuration, _) = read(&text, &path.to_string_lossy()).unwrap();
        // The first line gives the expected outcome: "# builds" or "# refused: FIELD".
        match (text.lines().next().unwrap(), build(&configuration).unwrap()) {
            (line, Outcome::Parts) => assert!(line.starts_with("# builds"), "{}: {line}", path.display()),
            (line, Outcome::Refused(error)) => {
                let field =
                    line.strip_prefix("# refused: ").unwrap_or_else(|| panic!("{}: {error}", path.display()));
                assert!(error.starts_with(field), "{}: {error}", path.display());
            }
        }
    }
}
