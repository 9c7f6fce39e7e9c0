//! `wiring.svg`: load cell, amplifier, logger, and drive with supply, driver and trigger. It names signals and wires, and no
//! board or firmware.

use std::fmt::Write;

use pinswitch_friction::published::GRAVITY_M_S2;

use super::{Drive, RigFacts};
use crate::html::escape;

/// Voltage of the supply of the actuator.
pub(crate) const SUPPLY_V: u32 = 12;
/// Width and height of the drawing, pixels.
const SIZE: [u32; 2] = [1180, 640];
/// Height of a line of text in a box, pixels.
const LINE: f64 = 19.0;

/// A box with a title and lines of text.
struct Block<'a> {
    at: [f64; 2],
    size: [f64; 2],
    title: &'a str,
    lines: Vec<String>,
}

impl Block<'_> {
    fn draw(&self, svg: &mut String) {
        let ([x, y], [width, height]) = (self.at, self.size);
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"6\" fill=\"#f4f6f8\" stroke=\"#223\" stroke-width=\"1.6\"/>\n\
             <text x=\"{}\" y=\"{}\" class=\"title\">{}</text>",
            x + 12.0,
            y + 26.0,
            escape(self.title)
        );
        for (i, line) in self.lines.iter().enumerate() {
            text(svg, [x + 12.0, y + 50.0 + LINE * i as f64], "", line);
        }
    }
}

fn text(svg: &mut String, [x, y]: [f64; 2], class: &str, words: &str) {
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"{y}\" class=\"{class}\">{}</text>", escape(words));
}

/// A wire along corners, with an arrow at its end if it carries a signal.
fn wire(svg: &mut String, corners: &[[f64; 2]], colour: &str, has_arrow: bool) {
    let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x},{y}")).collect();
    let arrow = if has_arrow { " marker-end=\"url(#arrow)\"" } else { "" };
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"{arrow}/>",
        points.join(" ")
    );
}

/// Wires of a strain-gauge bridge: signal, usual colour of the insulation, and colour in the drawing.
const BRIDGE: [(&str, &str, &str); 4] =
    [("E+", "red", "#c22"), ("E-", "black", "#111"), ("S+", "green", "#187a3c"), ("S-", "white", "#999")];

/// Returns the wiring sketch.
pub fn wiring_svg(facts: &RigFacts) -> String {
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"DejaVu Sans, Arial, sans-serif\" font-size=\"14\">\n<title>Wiring of {}</title>\n<style>.title {{ font-weight: 700; \
         font-size: 16px }} .small {{ font-size: 12.5px; fill: #333 }} .head {{ font-weight: 700; font-size: 20px }}</style>\n\
         <defs><marker id=\"arrow\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"8\" markerHeight=\"8\" orient=\"auto\">\
         <path d=\"M0,0 L10,5 L0,10 z\" fill=\"#223\"/></marker></defs>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n",
        escape(&facts.name)
    );
    text(&mut svg, [30.0, 36.0], "head", &format!("Wiring of the rig: {}", facts.name));
    measurement(&mut svg, facts);
    match facts.drive {
        Drive::Actuator { full_speed_mm_s } => actuator(&mut svg, facts, full_speed_mm_s),
        Drive::Crank { step_mm } => crank(&mut svg, facts, step_mm),
    }
    let notes = [
        format!(
            "Load = (weight + hook of {} g) x {GRAVITY_M_S2} m/s2; the heaviest is {:.2} N, the cell's range {} N.",
            facts.hook_mass_g,
            facts.heaviest_n(),
            facts.cell_limit_n
        ),
        "Set the zero of the force with the tendon slack. Ground shield and supply at one point.".to_owned(),
        "Colours of the bridge are the usual ones; the data sheet of the cell decides.".to_owned(),
    ];
    for (i, note) in notes.iter().enumerate() {
        text(&mut svg, [30.0, 584.0 + LINE * i as f64], "small", note);
    }
    svg.push_str("</svg>\n");
    svg
}

/// Load cell, amplifier and logger.
fn measurement(svg: &mut String, facts: &RigFacts) {
    let cell = Block {
        at: [30.0, 70.0],
        size: [230.0, 150.0],
        title: "Load cell",
        lines: (facts.cell.split(", ").map(str::to_owned))
            .chain([format!("range {} N", facts.cell_limit_n), "shield: to ground".to_owned()])
            .collect(),
    };
    let amplifier = Block {
        at: [440.0, 70.0],
        size: [230.0, 150.0],
        title: "Bridge amplifier",
        lines: vec![format!("{} Hz or faster", facts.sample_rate_hz)],
    };
    let logger = Block {
        at: [850.0, 70.0],
        size: [300.0, 470.0],
        title: "Logger and control",
        lines: vec![
            format!("{} Hz, CSV, one file per run", facts.sample_rate_hz),
            "columns: time_s, force_N,".to_owned(),
            match facts.drive {
                Drive::Actuator { .. } => "position_mm, power_W".to_owned(),
                Drive::Crank { .. } => "power_W".to_owned(),
            },
        ],
    };
    for block in [&cell, &amplifier, &logger] {
        block.draw(svg);
    }
    for (i, (signal, insulation, colour)) in BRIDGE.iter().enumerate() {
        let y = 102.0 + 32.0 * i as f64;
        wire(svg, &[[260.0, y], [440.0, y]], colour, false);
        text(svg, [285.0, y - 6.0], "small", &format!("{signal} ({insulation})"));
    }
    wire(svg, &[[670.0, 160.0], [850.0, 160.0]], "#223", true);
    text(svg, [690.0, 150.0], "small", "force_N");
}

/// Supply, driver and actuator, with position and trigger.
fn actuator(svg: &mut String, facts: &RigFacts, full_speed_mm_s: f64) {
    let actuator = Block {
        at: [30.0, 300.0],
        size: [230.0, 150.0],
        title: "Linear actuator",
        lines: vec![
            format!("{SUPPLY_V} V, stroke {} mm", facts.stroke_mm),
            format!("100 % = {full_speed_mm_s} mm/s"),
            "M+, M-: motor".to_owned(),
            "P: potentiometer".to_owned(),
        ],
    };
    let driver = Block {
        at: [440.0, 300.0],
        size: [230.0, 150.0],
        title: "H-bridge driver",
        lines: vec![
            "inputs: speed in % (PWM),".to_owned(),
            "direction, enable".to_owned(),
            "retract: concentric".to_owned(),
            "extend: eccentric".to_owned(),
        ],
    };
    let supply = Block {
        at: [440.0, 500.0],
        size: [230.0, 60.0],
        title: "Supply",
        lines: vec![format!("{SUPPLY_V} V, 5 A or more")],
    };
    for block in [&actuator, &driver, &supply] {
        block.draw(svg);
    }
    for (i, (signal, colour)) in [("M+", "#c22"), ("M-", "#111")].iter().enumerate() {
        let y = 350.0 + 40.0 * i as f64;
        wire(svg, &[[440.0, y], [260.0, y]], colour, false);
        text(svg, [330.0, y - 6.0], "small", signal);
    }
    wire(svg, &[[555.0, 500.0], [555.0, 450.0]], "#c22", true);
    text(svg, [566.0, 480.0], "small", "emergency stop");
    wire(svg, &[[145.0, 300.0], [145.0, 262.0], [850.0, 262.0]], "#223", true);
    text(svg, [690.0, 252.0], "small", "P: position_mm");
    wire(svg, &[[670.0, 350.0], [850.0, 350.0]], "#223", true);
    text(svg, [676.0, 340.0], "small", "trigger: enable, power_W");
    wire(svg, &[[850.0, 420.0], [670.0, 420.0]], "#223", true);
    text(svg, [700.0, 410.0], "small", "speed, direction, enable");
    let speeds: Vec<f64> = facts.runs().iter().map(|run| run.speed_pct).collect();
    let ends = [f64::min, f64::max].map(|of| speeds.iter().copied().reduce(of).unwrap_or_default());
    let words = ends.map(|pct| format!("{pct} % = {:.1} mm/s", pct / 100.0 * full_speed_mm_s));
    for (i, line) in
        ["speeds of the paper's protocol:".to_owned(), words[0].clone(), format!("to {}", words[1])]
            .iter()
            .enumerate()
    {
        text(svg, [866.0, 390.0 + 70.0 + LINE * i as f64], "", line);
    }
}

/// The marks of a rig without supply.
fn crank(svg: &mut String, facts: &RigFacts, step_mm: f64) {
    let crank = Block {
        at: [30.0, 300.0],
        size: [230.0, 150.0],
        title: "Hand crank",
        lines: vec![
            format!("{step_mm:.2} mm of tendon per hole"),
            format!("{:.0} holes for the stroke", facts.stroke_mm / step_mm),
            format!("of {} mm", facts.stroke_mm),
            "no supply".to_owned(),
        ],
    };
    let button = Block {
        at: [440.0, 300.0],
        size: [230.0, 150.0],
        title: "Push button",
        lines: vec!["hold it while you turn".to_owned(), "the crank".to_owned()],
    };
    crank.draw(svg);
    button.draw(svg);
    wire(svg, &[[670.0, 350.0], [850.0, 350.0]], "#223", true);
    text(svg, [676.0, 340.0], "small", "trigger: power_W");
    text(svg, [866.0, 460.0], "", "position_mm: not recorded");
}
