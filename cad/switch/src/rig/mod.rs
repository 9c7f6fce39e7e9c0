//! The test rig beyond its printed parts: bolts, bought bodies and facts (cad/doc/rig.md).

mod bolts;
mod facts;
mod hardware;

pub(crate) use bolts::{RigBolts, bolt_mm};
pub use facts::rig_facts;
pub(crate) use hardware::rig_hardware;

#[cfg(test)]
mod tests {
    use crate::built::Built;
    use crate::config::{Configuration, assign};
    use crate::feasibility;
    use pinswitch_report::rig::{BoughtItem, bill_csv};

    fn with_all(assignments: &[&str]) -> Configuration {
        let mut c = Configuration::default();
        for a in ["mount.kind=rig", "layout.pins=[5, 8, 11]"].iter().chain(assignments) {
            assign(&mut c, a).unwrap();
        }
        c
    }

    /// Both ends of the range of every parameter of the rig are built, or refused with a remedy that builds.
    #[test]
    fn ends_of_ranges_build_or_are_refused() {
        let (mut made, mut refused) = (0, 0);
        for parameter in Configuration::PARAMETERS.iter().filter(|p| p.section == "rig") {
            for end in (parameter.ends)().into_iter().flatten() {
                for kind in [&["rig.cell=bar", "rig.drive=crank"][..], &[]] {
                    let set = format!("{}={end}", parameter.path());
                    let all: Vec<&str> = kind.iter().copied().chain([set.as_str()]).collect();
                    match feasibility::design(with_all(&all)) {
                        Ok(design) => {
                            let built = Built::new(design);
                            assert!(built.is_ok(), "{all:?}: {}", built.unwrap_err());
                            made += 1;
                        }
                        Err(error) => {
                            assert!(!error.changes().is_empty(), "{all:?}: {error}");
                            refused += 1;
                        }
                    }
                }
            }
        }
        assert!(made > 60 && refused > 5, "{made} {refused}");
    }

    /// The bill has a bolt, a nut or a screw for each of those in the assembly.
    #[test]
    fn the_bill_counts_the_bodies_of_the_assembly() {
        use crate::hardware::{HardwareKind, hardware};
        for set in [
            &[][..],
            &["rig.cell=bar", "rig.drive=crank", "print.bed_mm=165"],
            &["tendon.sheath_diameter_mm=4"],
        ] {
            let design = feasibility::design(with_all(set)).unwrap();
            let facts = super::rig_facts(&design).unwrap();
            let all = hardware(&design);
            let bodies = |kind: HardwareKind| all.iter().filter(|body| body.kind == kind).count();
            let sum = |is: &dyn Fn(&BoughtItem) -> bool| -> usize {
                facts.items.iter().filter(|item| is(item)).map(|item| item.quantity).sum()
            };
            let of = |words: &'static str, purpose: &'static str| {
                sum(&move |item| item.item.starts_with(words) && item.purpose.contains(purpose))
            };
            assert_eq!(of("Bearing 608", ""), bodies(HardwareKind::Bearing), "{set:?}");
            assert_eq!(of("Hexagon bolt M8", "guide pulleys"), bodies(HardwareKind::Bolt), "{set:?}");
            assert_eq!(of("Hexagon bolt M6", "feet"), bodies(HardwareKind::FootBolt), "{set:?}");
            assert_eq!(of("Nut M6", "feet"), bodies(HardwareKind::FootNut), "{set:?}");
            assert_eq!(of("Washer M6", "feet"), bodies(HardwareKind::FootWasher), "{set:?}");
            assert_eq!(of("Hexagon bolt", "joint"), bodies(HardwareKind::SpliceBolt), "{set:?}");
            let drive = ["actuator", "tendon on the cell mount", "drum", "knob"];
            let drive: usize = drive.iter().map(|purpose| of("Hexagon bolt", purpose)).sum();
            assert_eq!(drive, bodies(HardwareKind::DriveBolt), "{set:?}");
            assert!(bill_csv(&facts).contains("Hook of 62.53 g"), "{set:?}");
        }
    }
}
