use super::*;
use crate::config::assign;
use crate::design::Design;
use proptest::prelude::*;

fn configured(assignments: &[&str]) -> Configuration {
    let mut c = Configuration::default();
    assign(&mut c, "layout.pins=[5, 8, 11]").unwrap();
    assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
    c
}

/// The published hardness needs a hot cure, which a printed mould does not survive: the layer is post-cured outside of it.
#[test]
fn the_default_layer_is_post_cured() {
    let process = Process::of(&configured(&[]));
    assert_eq!(process.conflicts, []);
    assert_eq!(process.mould_cure, Some(Cure { temperature_c: 25.0, hours: 48.0 }));
    assert_eq!(process.post_cure, Some(Cure { temperature_c: 130.0, hours: 2.0 }));
    assert_eq!(process.hardness_shore_a, Some([50.0, 1.6]));
    assert!((0.03..0.1).contains(&process.modulus_scatter()), "{}", process.modulus_scatter());
}

#[test]
fn without_an_oven_another_product_is_proposed() {
    let process = Process::of(&configured(&["process.oven_c=25"]));
    assert_eq!((process.mould_cure, process.post_cure, process.hardness_shore_a), (None, None, None));
    let [conflict] = process.conflicts.as_slice() else { panic!("{:?}", process.conflicts) };
    assert_eq!(
        conflict.problem,
        "50 Shore A needs a post-cure of Sylgard 184 at 130 C, and process.oven_c is 25"
    );
    assert_eq!(
        conflict.help,
        "set process.silicone to \"smooth-sil-950\", or silicone.hardness_shore_a to 44"
    );
    for fix in ["process.silicone=smooth-sil-950", "silicone.hardness_shore_a=44"] {
        let fixed = Process::of(&configured(&["process.oven_c=25", fix]));
        assert!(fixed.conflicts.is_empty() && fixed.post_cure.is_none(), "{fix}: {fixed:?}");
    }
}

#[test]
fn a_hot_cure_shrinks_and_softens_moulds() {
    let hot = Process::of(&configured(&["mould.shrinkage_pct=0.9"]));
    assert_eq!(hot.mould_cure, Some(Cure { temperature_c: 60.0, hours: 4.0 }));
    let problem = |assignments: &[&str]| Process::of(&configured(assignments)).conflicts[0].problem.clone();
    assert_eq!(
        problem(&["mould.shrinkage_pct=1.5"]),
        "Sylgard 184 shrinks by 1.50 % only when cured at 85 C, and a mould of ABS softens above 70 C"
    );
    assert_eq!(
        problem(&["process.cure_c=60"]),
        "the mould compensates a shrinkage of 0 %, and Sylgard 184 cured at 60 C shrinks by 0.88 %"
    );
    assert_eq!(
        problem(&["process.cure_c=60", "process.material=pla"]),
        "the cure in the mould is at 60 C, and a mould of PLA softens above 45 C"
    );
}

/// The oven bounds the cure in the mould and the post-cure, also after rounding.
#[test]
fn no_cure_is_hotter_than_the_oven() {
    let cold = Process::of(&configured(&[
        "process.oven_c=25",
        "mould.shrinkage_pct=0.9",
        "silicone.hardness_shore_a=46",
    ]));
    let [conflict] = cold.conflicts.as_slice() else { panic!("{:?}", cold.conflicts) };
    assert_eq!(
        conflict.problem,
        "Sylgard 184 shrinks by 0.90 % only when cured at 60 C, and process.oven_c is 25"
    );
    assert_eq!(
        conflict.help,
        "set process.oven_c to 60, or mould.shrinkage_pct to 0.0 and process.cure_c to 0"
    );
    assert_eq!(cold.mould_cure, None);
    let sylgard = SiliconeProduct::Sylgard184.data().unwrap();
    let rounded_up = (440..500).map(|tenths| f64::from(tenths) / 10.0).find_map(|shore_a| {
        let needed_c = sylgard.cure_for(shore_a, ROOM_C)?;
        (rounded_c(needed_c) > needed_c).then_some((shore_a, needed_c))
    });
    let (shore_a, needed_c) = rounded_up.unwrap();
    let exact = Process::of(&configured(&[
        &format!("process.oven_c={needed_c}"),
        &format!("silicone.hardness_shore_a={shore_a}"),
    ]));
    assert_eq!(exact.post_cure.unwrap().temperature_c, needed_c);
}

/// A configured temperature that contradicts the mould is refused, and the proposals build.
#[test]
fn contradicting_cures_are_refused() {
    for assignments in [
        &["process.cure_c=60"][..],
        &["process.cure_c=10"],
        &["process.cure_c=60", "mould.shrinkage_pct=0.9", "process.material=pla"],
        &["process.cure_c=100", "mould.shrinkage_pct=1.9"],
        &["process.cure_c=60", "mould.shrinkage_pct=0.9", "process.silicone=smooth-sil-950"],
    ] {
        let c = configured(assignments);
        let error = Design::new(c.clone()).unwrap_err();
        assert_eq!(error.location().unwrap().field.as_deref(), Some("process.cure_c"), "{error}");
        let proposal = crate::feasibility::repair(&c).unwrap().unwrap();
        assert!(Design::new(proposal.configuration).is_ok(), "{assignments:?}");
    }
    assert!(Design::new(configured(&["process.cure_c=60", "mould.shrinkage_pct=0.9"])).is_ok());
}

/// A layer that cannot be made is never promised.
#[test]
fn a_conflict_extrapolates_the_prediction() {
    use pinswitch_friction::PredictionStatus::{Extrapolated, Published};
    let status = |assignments: &[&str]| {
        crate::prediction::predicted_curve(&Design::new(configured(assignments)).unwrap()).status
    };
    assert_eq!(status(&[]), Published);
    for assignment in [
        "process.oven_c=25",
        "mould.shrinkage_pct=1.5",
        "process.silicone=smooth-sil-950",
        "process.pins=music-wire",
        "process.coating=ptfe",
    ] {
        assert_eq!(status(&[assignment]), Extrapolated, "{assignment}");
    }
}

#[test]
fn durations_follow_the_schedule() {
    let sylgard = SiliconeProduct::Sylgard184.data().unwrap();
    let hours = |c: f64| sylgard.cure_at(c).hours;
    assert_eq!([25.0, 60.0].map(hours), [48.0, 4.0]);
    assert!((hours(100.0) - 7.0 / 12.0).abs() < 1e-9);
    assert!(hours(40.0) < 48.0 && hours(40.0) > 4.0);
    assert_eq!(sylgard.cure_at(125.0).to_string(), "20 min at 125 \u{b0}C");
    assert_eq!(sylgard.cure_at(60.0).to_string(), "4 h at 60 \u{b0}C");
}

proptest! {
    /// The cure of the guide gives the hardness of the curve and the shrinkage of the mould, whatever is configured; and the
    /// mould survives it.
    #[test]
    fn the_cure_gives_the_configured_layer(
        hardness in 20.0..70.0f64,
        shrinkage in 0.0..3.0f64,
        cure_c in prop_oneof![Just(0.0), 18.0..150.0f64],
        oven_c in 20.0..250.0f64,
        material in prop::sample::select(vec!["abs", "petg", "pla", "resin"]),
        silicone in prop::sample::select(vec!["sylgard-184", "smooth-sil-950", "smooth-sil-940", "dragon-skin-30", "elastosil-m-4601"]),
    ) {
        let c = configured(&[
            &format!("silicone.hardness_shore_a={hardness:?}"),
            &format!("mould.shrinkage_pct={shrinkage:?}"),
            &format!("process.cure_c={cure_c:?}"),
            &format!("process.oven_c={oven_c:?}"),
            &format!("process.material={material}"),
            &format!("process.silicone={silicone}"),
        ]);
        let process = Process::of(&c);
        prop_assert_eq!(process.mould_cure.is_some(), process.conflicts.is_empty());
        if let (Some(cure), Some(silicone)) = (process.mould_cure, process.silicone) {
            prop_assert!(cure.temperature_c <= process.material.hottest_cure_c);
            prop_assert!(cure.hours > 0.0 && cure.hours <= 48.0);
            let shrinks = silicone.shrinkage_pct(cure.temperature_c, process.material);
            prop_assert!((shrinks - shrinkage).abs() <= SHRINKAGE_TOLERANCE_PCT);
            let hottest = process.post_cure.map_or(cure.temperature_c, |post| post.temperature_c);
            prop_assert!(hottest <= oven_c.max(ROOM_C));
            let got = silicone.hardness_shore_a(hottest);
            prop_assert!((got - hardness).abs() <= silicone.hardness_scatter_shore_a + 0.15, "{got} for {hardness}");
        }
    }
}
