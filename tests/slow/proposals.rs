//! A refused configuration builds once its proposals are followed. `PINSWITCH_CASES=2000` makes a
//! long run.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use pinswitch_switch::config::parameter::Parameter;
use pinswitch_switch::config::{Change, Configuration, Diagnostic, assign};
use pinswitch_switch::feasibility;
use pinswitch_switch::output::BuildError;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Choices of hardware, mount and mould, each with the share of configurations that have it.
const CHOICES: [(f64, &[&str]); 9] = [
    (0.5, &["fasteners.kind=screw", "fasteners.kind=nut-trap", "fasteners.kind=insert"]),
    (0.5, &["mould.kind=split", "mould.kind=one-piece", "mould.kind=none"]),
    (0.5, &["mount.kind=flange", "mount.kind=joint", "mount.kind=rig"]),
    (0.3, &["support.slot_kind=through", "support.slots=occupied"]),
    (0.2, &["tendon.sheath_diameter_mm=3", "tendon.sheath_diameter_mm=2.4"]),
    (0.2, &["fasteners.dowel_diameter_mm=1.5", "fasteners.dowel_diameter_mm=3"]),
    (0.2, &["print.elephant_foot_mm=0.2", "print.elephant_foot_mm=0.4"]),
    (0.1, &["parts.guide_pulley=true", "layout.substrate=abs"]),
    (0.2, &["fasteners.head_recess_mm=1", "mould.overfill_mm=3"]),
];
const PINS: [&str; 5] = [
    "layout.pins=[5, 8, 11]",
    "layout.pins=[4]",
    "layout.pins=[1, 2, 4]",
    "layout.pins=[3, 5, 7, 9, 11, 13]",
    "layout.pins=[8, 15]",
];
/// Parameters that are not varied: they change no part, or only the fineness of its mesh, which
/// takes minutes at the lower end.
const CONSTANT: [&str; 2] = ["mesh.chord_tolerance_mm", "friction.points"];

/// Returns the assignments of a configuration: random values of one or two parameters, of a tenth,
/// or of another share.
fn case(seed: u64) -> Vec<String> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut set = vec![PINS[random.random_range(0..PINS.len())].to_owned()];
    for (share, values) in CHOICES {
        if random.random_range(0.0..1.0) < share {
            set.push(values[random.random_range(0..values.len())].to_owned());
        }
    }
    let fields: Vec<_> = Configuration::PARAMETERS
        .iter()
        .filter(|p| !CONSTANT.contains(&p.path().as_str()))
        .filter_map(|p| Some((p, (p.ends)()?)))
        .collect();
    let mut odd = |random: &mut ChaCha8Rng, i: usize| {
        let (parameter, [low, high]): &(&Parameter<Configuration>, [f64; 2]) = &fields[i];
        let value = match random.random_range(0..4) {
            0 => *low,
            1 => *high,
            _ => low + (high - low) * random.random_range(0.0..1.0),
        };
        let is_whole = (parameter.get)(&Configuration::default()).is_integer();
        let value = if is_whole { value.round() } else { (value * 1e3).round() / 1e3 };
        set.push(format!("{}={value}", parameter.path()));
    };
    let share = match seed % 4 {
        0 | 1 => {
            for _ in 0..=seed % 4 {
                let i = random.random_range(0..fields.len());
                odd(&mut random, i);
            }
            0.0
        }
        2 => 0.1,
        _ => [0.03, 0.3, 1.0][random.random_range(0..3)],
    };
    for i in 0..fields.len() {
        if random.random_range(0.0..1.0) < share {
            odd(&mut random, i);
        }
    }
    set
}

fn configuration(assignments: &[String]) -> Configuration {
    let mut c = Configuration::default();
    assignments.iter().for_each(|a| assign(&mut c, a).unwrap());
    c
}

/// Returns the error of a configuration, or `None` if it builds.
///
/// # Errors
/// An error of the program.
fn refusal(c: &Configuration) -> Result<Option<Diagnostic>, String> {
    match feasibility::design(c.clone()).map_err(BuildError::Configuration).and_then(feasibility::build) {
        Ok(_) => Ok(None),
        Err(BuildError::Configuration(error)) => Ok(Some(error)),
        Err(other) => Err(other.to_string()),
    }
}

fn field_of(error: &Diagnostic) -> String {
    error.location().and_then(|location| location.field.clone()).unwrap_or_default()
}

/// Returns the alternatives of a help, each as assignments. A help that omits some of its changes
/// has no alternatives.
fn alternatives(error: &Diagnostic) -> Vec<Vec<String>> {
    let subject = field_of(error);
    let field = |name: &str| if name == "it" { subject.clone() } else { name.to_owned() };
    let assignment = |words: &str| match words.splitn(4, ' ').collect::<Vec<_>>()[..] {
        ["lower" | "raise" | "set", name, "to", value] => Some(format!("{}={value}", field(name))),
        ["set", name, "=", value] => Some(format!("{}={value}", field(name))),
        _ => None,
    };
    let help = error.help().unwrap_or_default();
    if help.is_empty() || help.contains(" more values, ") {
        return Vec::new();
    }
    let marked = help.replace(", or ", "|").replace(", and ", "&");
    let marked = ["lower ", "raise ", "set "]
        .into_iter()
        .fold(marked, |text, verb| text.replace(&format!(", {verb}"), &format!("|{verb}")));
    // Words that are not an instruction become an invalid assignment, which counts as a fault.
    let step = |words: &str| assignment(words).unwrap_or_else(|| words.to_owned());
    marked.split('|').map(|alternative| alternative.split('&').map(step).collect()).collect()
}

/// Returns the field and the problem of an error, without numbers.
fn kind(error: &Diagnostic) -> (String, String) {
    let words = error.problem().chars().filter(|c| !c.is_ascii_digit() && !".-".contains(*c)).collect();
    (field_of(error), words)
}

#[derive(Default)]
struct Tally {
    refused: u64,
    without: u64,
    counts: BTreeMap<&'static str, [u64; 4]>,
    times: Vec<Duration>,
    faults: Vec<String>,
}

fn follow(seed: u64, tally: &Mutex<Tally>) {
    let set = case(seed);
    let c = configuration(&set);
    let start = Instant::now();
    let error = match refusal(&c) {
        Ok(None) => return,
        Ok(Some(error)) => error,
        Err(other) => {
            let mut tally = tally.lock().unwrap();
            tally.refused += 1;
            tally.without += 1;
            tally.faults.push(format!("{seed} {set:?}: {other}"));
            return;
        }
    };
    let time = start.elapsed();
    let mut ways: Vec<(&'static str, Vec<String>)> =
        alternatives(&error).into_iter().map(|way| ("words", way)).collect();
    let assignment = |Change { field, value }: &Change| format!("{field}={value}");
    let changes: Vec<String> = error.changes().iter().map(assignment).collect();
    if !changes.is_empty() {
        ways.push(("changes", changes));
    }
    let mut results = Vec::new();
    for (from, way) in &ways {
        let mut changed = c.clone();
        let next = if way.iter().all(|a| assign(&mut changed, a).is_ok()) {
            refusal(&changed)
        } else {
            Err("an assignment is refused".to_owned())
        };
        let outcome = match &next {
            Ok(None) => 1,
            Ok(Some(next)) if kind(next) == kind(&error) => 3,
            _ => 2,
        };
        results.push((*from, outcome, format!("{seed} {set:?}: {error}\n   {way:?} leads to {next:?}")));
    }
    let mut tally = tally.lock().unwrap();
    tally.refused += 1;
    tally.times.push(time);
    if ways.is_empty() {
        tally.without += 1;
        tally.faults.push(format!("{seed} {set:?}: {error}: no proposal"));
    }
    for (from, outcome, text) in results {
        let counts = tally.counts.entry(from).or_default();
        counts[0] += 1;
        counts[outcome] += 1;
        if outcome > 1 {
            tally.faults.push(text);
        }
    }
}

#[test]
fn followed_proposals_build() {
    let cases = std::env::var("PINSWITCH_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(200u64);
    let (tally, next) = (Mutex::new(Tally::default()), AtomicU64::new(0));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= cases {
                        break;
                    }
                    follow(seed, &tally);
                }
            });
        }
    });
    let mut tally = tally.into_inner().unwrap();
    tally.times.sort();
    let quantile = |q: f64| tally.times.get(((tally.times.len() as f64 - 1.0) * q) as usize);
    println!("{cases} cases, {} refused, {} without a proposal", tally.refused, tally.without);
    for (from, [followed, built, another, same]) in &tally.counts {
        println!(
            "{from}: followed {followed}, built {built}, another refusal {another}, same refusal {same}"
        );
    }
    println!("a refusal takes {:?} in the median, {:?} at 95 %", quantile(0.5), quantile(0.95));
    println!("{}", tally.faults.join("\n"));
    let [followed, built] = [0, 1].map(|i| tally.counts.values().map(|counts| counts[i]).sum::<u64>());
    assert!(tally.without == 0, "{} of {} without a proposal", tally.without, tally.refused);
    assert!(followed >= cases && built * 100 >= followed * 99, "{built} of {followed} build");
}
