//! The files of the programs: `rig.toml` for `experiment`, `run.toml` for `segment`, `plan.toml` for `simulate`.

use std::fmt::Write;

use pinswitch_friction::published;

use super::{Drive, MOVE_S, RigFacts};

fn list(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|v| format!("{v:?}")).collect();
    format!("[{}]", all.join(", "))
}

/// Returns `rig.toml`.
pub fn rig_toml(facts: &RigFacts) -> String {
    let limits = facts.limits();
    let mut text = format!(
        "# The rig of {}: `pinswitch experiment CALIBRATION --rig rig.toml --out DIR`.\n\
         loads_g = {}   # weights on the hook, without it\n\
         hook_mass_g = {:?}   # part of every load\n\
         speeds_pct = {}   # lowest and highest speed of the drive\n",
        facts.name,
        list(&limits.loads_g),
        facts.hook_mass_g,
        list(&limits.speeds_pct)
    );
    if let Some(full) = limits.full_speed_mm_s {
        let _ = writeln!(text, "full_speed_mm_s = {full:?}   # speed of the actuator at 100 %");
    }
    let _ = write!(
        text,
        "dwells_s = {}\nlayouts = {:?}\nsilicone = {}\nproxy = {}\nplain_wraps_deg = {}\nwrap_angle_deg = {:?}\n\
         stroke_mm = {:?}\nseconds_per_repetition = {:?}\nminutes_per_load_change = {:?}\nminutes_per_mount_change = {:?}\n\
         cell_limit_n = {:?}   # largest force of the load cell\n",
        list(&limits.dwells_s),
        limits.layouts,
        limits.silicone,
        limits.proxy,
        list(&limits.plain_wraps_deg),
        facts.wrap_angle_deg,
        limits.stroke_mm,
        limits.seconds_per_repetition,
        limits.minutes_per_load_change,
        limits.minutes_per_mount_change,
        limits.cell_limit_n
    );
    text
}

/// Returns `run.toml`: the rig, and one log for each run of the sheet.
pub fn run_toml(facts: &RigFacts) -> String {
    let mut text = format!(
        "# The logs of {}: `pinswitch segment run.toml --out plateaus.csv`. Save the log of each run of run-sheet.html under\n\
         # its name here, in this folder, with the columns time_s and force_N, and position_mm and power_W if they are wired.\n\
         # Delete the series that you did not record.\n\
         [rig]\nwrap_angle_deg = {:?}\nhook_mass_g = {:?}   # part of every load\nsample_rate_hz = {:?}\nstroke_mm = {:?}\ndwell_s = {:?}\n",
        facts.name,
        facts.wrap_angle_deg,
        facts.hook_mass_g,
        facts.sample_rate_hz,
        facts.stroke_mm,
        published::DWELL_S
    );
    if let Drive::Actuator { full_speed_mm_s } = facts.drive {
        let _ = writeln!(text, "on_s = {MOVE_S:?}\nfull_speed_mm_s = {full_speed_mm_s:?}   # at 100 %");
    }
    for run in &facts.runs() {
        let substrate = run.substrate.map_or("plain", |s| s.as_str());
        let _ = write!(
            text,
            "\n[[series]]\nfile = \"{}\"\nsubstrate = \"{substrate}\"\npins = {:?}\nload_mass_g = {:?}   # and the hook: {:.3} N\n",
            run.asks,
            run.pins,
            run.load_mass_g,
            facts.load_n(run.load_mass_g)
        );
        if facts.full_speed_mm_s().is_some() {
            let _ = writeln!(text, "speed_pct = {:?}", run.speed_pct);
        }
        text.push_str("sweep = \"up\"\n");
    }
    text
}

/// Returns `plan.toml`: the same runs, to simulate.
pub fn plan_toml(facts: &RigFacts) -> String {
    let limits = facts.limits();
    let mut speeds: Vec<f64> = facts.runs().iter().map(|run| run.speed_pct).collect();
    speeds.truncate(facts.weights_g.len());
    let repetitions = facts.runs().first().map_or([12, 29], |run| run.repetitions);
    format!(
        "# The runs of run-sheet.html for {}: `pinswitch simulate plan.toml --out DIR`. Loads include the paper's hook of {} g.\n\
         seed = 1\nprotocol = \"paper\"   # loads ascending\nwrap_angle_deg = {:?}\nlayouts = {:?}\nsilicone = {}\nproxy = {}\nweights_g = {}\n\
         speeds_pct = {}\ndwells_s = {}\nrepetitions = {repetitions:?}\nrepetitions_spread = 0\n",
        facts.name,
        published::HOOK_MASS_G,
        facts.wrap_angle_deg,
        limits.layouts,
        limits.silicone,
        limits.proxy && !limits.layouts.is_empty(),
        list(&facts.weights_g),
        list(&speeds),
        list(&[published::DWELL_S])
    )
}
