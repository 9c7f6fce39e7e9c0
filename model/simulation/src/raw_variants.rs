//! Variants of a raw log: rates, jitter, gaps, triggers, clocks, missing columns, power levels, noise
//! and cycles. Each ends with accurate plateaus, or with an error that names the cause.

use std::fmt::Write;

use pinswitch_calibration::segmentation::segment_run;
use pinswitch_calibration::table::PlateauRow;
use pinswitch_friction::Direction::{self, Concentric, Eccentric};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Load in newtons, and the forces on both branches.
const LOAD_N: f64 = 25.0;
const FORCES_N: [f64; 2] = [19.0, 33.0];
/// Moves in each direction, and the travel of each in millimetres.
const MOVES: usize = 6;
const TRAVEL_MM: f64 = 12.0;
/// Bound of the root mean square error of the plateaus in newtons.
const RMS_N: f64 = 0.05;

/// Motion of the actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Moves with rests.
    Rests,
    /// Strokes at a constant speed without rests.
    Triangle,
    /// Sinusoidal strokes.
    Sine,
}

/// A log as a laboratory may record it.
#[derive(Clone, Debug)]
struct Variant {
    name: &'static str,
    shape: Shape,
    rate_hz: f64,
    on_s: f64,
    dwell_s: f64,
    /// Additional rest at the reversal in seconds.
    pause_s: f64,
    /// Rest before the first move in seconds.
    lead_s: f64,
    noise_n: f64,
    /// Sign of the load cell.
    sign: f64,
    /// Step of the load cell in newtons.
    resolution_n: f64,
    /// Standard deviation of the time stamps in sampling periods.
    jitter: f64,
    spike_share: f64,
    lost_share: f64,
    /// Seconds that the logger loses at each start of the motor.
    lost_at_start_s: f64,
    /// A loss of samples from the first to the second time in seconds.
    gap_s: (f64, f64),
    standby_w: f64,
    move_w: [f64; 2],
    /// Force that a move adds while it lasts, in newtons.
    kick_n: f64,
    order: [Direction; 2],
    /// Position in millimetres at the start, and the sign of a release.
    position: (f64, f64),
    /// Columns of the log.
    columns: &'static str,
    /// Name of the column of time, and the text of a stamp.
    clock: (&'static str, fn(f64) -> String),
    /// Additional lines of `[rig]`.
    rig: String,
    /// Whether some moves leave no trace, so that rows may be missing.
    is_partial: bool,
    /// Words of the error; empty for plateaus.
    refusal: &'static str,
}

fn seconds(t: f64) -> String {
    format!("{t:.5}")
}

impl Variant {
    fn new(name: &'static str) -> Self {
        Self {
            name,
            shape: Shape::Rests,
            rate_hz: 200.0,
            on_s: 0.5,
            dwell_s: 3.0,
            pause_s: 2.0,
            lead_s: 2.0,
            noise_n: 0.06,
            sign: 1.0,
            resolution_n: 0.001,
            jitter: 0.0,
            spike_share: 0.0,
            lost_share: 0.0,
            lost_at_start_s: 0.0,
            gap_s: (0.0, 0.0),
            standby_w: 0.2,
            move_w: [8.0, 8.5],
            kick_n: 0.0,
            order: [Eccentric, Concentric],
            position: (0.0, 1.0),
            columns: "force_N,position_mm,power_W",
            clock: ("time_s", seconds),
            rig: String::new(),
            is_partial: false,
            refusal: "",
        }
    }

    fn with(name: &'static str, change: fn(&mut Self)) -> Self {
        let mut variant = Self::new(name);
        change(&mut variant);
        variant
    }

    /// Returns the text of the log, and the true plateaus.
    fn log(&self) -> (String, Vec<(Direction, f64)>) {
        let mut random = ChaCha8Rng::seed_from_u64(self.name.bytes().map(u64::from).sum());
        let mut normal = move |scale: f64| -> f64 {
            let value: f64 = StandardNormal.sample(&mut random);
            scale * value
        };
        let (segments, truth) = self.segments(&mut normal);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut text = format!("{},{}\n", self.clock.0, self.columns);
        let end_s: f64 = segments.iter().map(|s| s.length_s).sum();
        let (mut at, mut start_s) = (0, 0.0);
        let (mut force_n, mut from_n) = (segments[0].force_n, segments[0].force_n);
        for i in 0..(end_s * self.rate_hz).floor() as u32 {
            let t = f64::from(i) / self.rate_hz;
            while at + 1 < segments.len() && t >= start_s + segments[at].length_s - 1e-9 {
                start_s += segments[at].length_s;
                from_n = force_n;
                at += 1;
            }
            let s = &segments[at];
            let share = (t - start_s) / s.length_s;
            // The force approaches its new level within the first part of a move, and settles.
            let steepness = if self.shape == Shape::Rests { 12.0 } else { 40.0 };
            let (mut target_n, mut rise) = (s.force_n, 1.0 - (-steepness * share).exp());
            if s.is_move {
                target_n += self.kick_n * s.direction.sign();
            } else {
                rise = 1.0 - (-(t - start_s) / 0.2).exp();
            }
            force_n = from_n + (target_n - from_n) * rise;
            let is_lost = random.random::<f64>() < self.lost_share
                || (s.is_move && self.shape == Shape::Rests && t - start_s < self.lost_at_start_s)
                || (self.gap_s.0..self.gap_s.1).contains(&t);
            let spike_n = if random.random::<f64>() < self.spike_share { 15.0 } else { 0.0 };
            let stamp_s = t + normal(self.jitter / self.rate_hz);
            let reading =
                ((force_n + normal(self.noise_n) + spike_n) / self.resolution_n).round() * self.resolution_n;
            let slot = usize::from(s.direction == Concentric);
            let power_w = if s.is_move { self.move_w[slot] } else { self.standby_w } + normal(0.04);
            let way = match self.shape {
                Shape::Sine => 0.5 * (1.0 - (std::f64::consts::PI * share).cos()),
                _ => share,
            };
            let position_mm =
                self.position.0 + self.position.1 * (s.from_mm + (s.to_mm - s.from_mm) * way) + normal(0.02);
            if is_lost {
                continue;
            }
            let _ = write!(text, "{}", self.clock.1(stamp_s));
            for column in self.columns.split(',') {
                let value = match column {
                    "force_N" | "force_in_N" => self.sign * reading,
                    "position_mm" => position_mm,
                    "power_W" => power_w,
                    "load_measured_N" | "force_out_N" => LOAD_N + 1.0 + normal(0.02),
                    "direction" => {
                        text.push(',');
                        text.push_str(if s.is_move { s.direction.as_str() } else { "" });
                        continue;
                    }
                    _ => 0.0,
                };
                let _ = write!(text, ",{value:.4}");
            }
            text.push('\n');
        }
        (text, truth)
    }

    /// Returns the moves and rests of the log, and the true plateaus.
    fn segments(&self, normal: &mut impl FnMut(f64) -> f64) -> (Vec<Segment>, Vec<(Direction, f64)>) {
        let (mut segments, mut truth) = (Vec::new(), Vec::new());
        let first = self.order[0];
        let mut place_mm = if first == Eccentric { 0.0 } else { MOVES as f64 * TRAVEL_MM };
        if self.lead_s > 0.0 {
            segments.push(Segment::rest(self.lead_s, LOAD_N, first, place_mm));
        }
        let is_cyclic = self.shape != Shape::Rests;
        let moves = if is_cyclic {
            (0..2 * MOVES).map(|i| self.order[i % 2]).collect::<Vec<_>>()
        } else {
            self.order.iter().flat_map(|d| [*d; MOVES]).collect()
        };
        for (i, direction) in moves.iter().enumerate() {
            let slot = usize::from(*direction == Concentric);
            let force_n = FORCES_N[slot] + normal(0.03);
            let travel_mm = if is_cyclic { 60.0 } else { TRAVEL_MM };
            let to_mm = place_mm - direction.sign() * travel_mm;
            segments.push(Segment {
                length_s: self.on_s,
                force_n,
                is_move: true,
                direction: *direction,
                from_mm: place_mm,
                to_mm,
            });
            place_mm = to_mm;
            if !is_cyclic {
                let turns = moves.get(i + 1).is_some_and(|next| next != direction);
                let rest_s = self.dwell_s + if turns { self.pause_s } else { 0.0 };
                segments.push(Segment::rest(rest_s, force_n, *direction, place_mm));
            }
            truth.push((*direction, force_n));
        }
        (segments, truth)
    }

    /// Segments the log, and compares the rows with the truth.
    fn check(&self) -> Result<(), String> {
        let (text, truth) = self.log();
        let run = format!(
            "[rig]\nwrap_angle_deg = 60.0\n{}\n[[series]]\nfile = \"a.csv\"\nsubstrate = \"plain\"\npins = []\n\
             load_mass_g = {}\n",
            self.rig,
            LOAD_N / 9.80665e-3
        );
        let rows = segment_run(&run, "run.toml", |_| std::io::Result::Ok(text.clone().into_bytes()));
        let rows = match rows {
            Ok(run) => run.rows,
            Err(e) if !self.refusal.is_empty() && e.to_string().contains(self.refusal) => return Ok(()),
            Err(e) => return Err(format!("{}: {e}", self.name)),
        };
        if !self.refusal.is_empty() {
            return Err(format!("{}: accepted with {} rows", self.name, rows.len()));
        }
        if self.is_partial {
            let is_right = |r: &PlateauRow| {
                let slot = usize::from(r.direction == Concentric);
                (r.force_n - FORCES_N[slot]).abs() < 0.1
            };
            let wrong = rows.iter().filter(|r| !is_right(r)).count();
            return if wrong == 0 { Ok(()) } else { Err(format!("{}: {wrong} wrong rows", self.name)) };
        }
        compare(&rows, &truth).map_err(|e| format!("{}: {e}", self.name))
    }
}

/// A move or a rest.
struct Segment {
    length_s: f64,
    force_n: f64,
    is_move: bool,
    direction: Direction,
    from_mm: f64,
    to_mm: f64,
}

impl Segment {
    fn rest(length_s: f64, force_n: f64, direction: Direction, place_mm: f64) -> Self {
        Self { length_s, force_n, is_move: false, direction, from_mm: place_mm, to_mm: place_mm }
    }
}

fn compare(rows: &[PlateauRow], truth: &[(Direction, f64)]) -> Result<(), String> {
    let word = |d: &Direction| if *d == Eccentric { 'e' } else { 'c' };
    let read: String = rows.iter().map(|r| word(&r.direction)).collect();
    let expected: String = truth.iter().map(|t| word(&t.0)).collect();
    if read != expected {
        let forces: Vec<f64> = rows.iter().map(|r| r.force_n.round()).collect();
        return Err(format!("directions {read}, expected {expected}, forces {forces:?}"));
    }
    let sum: f64 = rows.iter().zip(truth).map(|(r, t)| (r.force_n - t.1).powi(2)).sum();
    let rms = (sum / rows.len() as f64).sqrt();
    if rms < RMS_N { Ok(()) } else { Err(format!("{rms:.3} N rms")) }
}

/// Declared times, as in a complete description.
const DECLARED: &str = "on_s = 0.5\ndwell_s = 3.0\nsample_rate_hz = 200.0";

fn variants() -> Vec<Variant> {
    let with: fn(&'static str, fn(&mut Variant)) -> Variant = Variant::with;
    vec![
        Variant::new("plain"),
        // Rates.
        with("10 Hz", |v| v.rate_hz = 10.0),
        with("10 Hz without power", |v| (v.rate_hz, v.columns) = (10.0, "force_N,position_mm")),
        with("83 Hz", |v| v.rate_hz = 83.0),
        with("2 kHz", |v| v.rate_hz = 2000.0),
        with("10 kHz", |v| {
            v.rate_hz = 10_000.0;
            v.clock = ("time_s", |t| format!("{t:.6}"));
        }),
        // Jitter, gaps and lost samples.
        with("jitter", |v| v.jitter = 0.25),
        with("lost samples", |v| v.lost_share = 0.05),
        with("lost at the start of the motor", |v| v.lost_at_start_s = 0.36),
        with("whole moves lost", |v| (v.lost_at_start_s, v.columns) = (0.5, "force_N,position_mm")),
        with("gap in a rest", |v| v.gap_s = (10.0, 11.2)),
        // Triggers.
        with("starts with the motor", |v| v.lead_s = 0.0),
        with("starts with the motor, concentric", |v| {
            (v.lead_s, v.order, v.position.0) = (0.0, [Concentric, Eccentric], 70.0);
        }),
        with("starts with the motor, by force", |v| {
            (v.lead_s, v.columns, v.kick_n) = (0.0, "force_N,power_W", 1.0);
        }),
        // Clocks.
        with("milliseconds", |v| v.clock = ("time_ms", |t| format!("{:.0}", 1e3 * t))),
        with("milliseconds named seconds", |v| v.clock = ("time_s", |t| format!("{:.0}", 1e3 * t))),
        with("microseconds", |v| v.clock = ("time_us", |t| format!("{:.0}", 1e6 * t))),
        with("Unix time", |v| v.clock = ("time_s", |t| format!("{:.4}", 1.7e9 + t))),
        with("Unix milliseconds", |v| v.clock = ("timestamp", |t| format!("{:.0}", 1e3 * (1.7e9 + t)))),
        with("dates", |v| {
            v.clock = ("timestamp", |t| {
                format!("2026-03-01T23:{:02}:{:06.3}", 59 - u32::from(t < 20.0), (t + 40.0) % 60.0)
            });
            v.pause_s = 0.0;
        }),
        with("counter of 16 bits", |v| {
            v.clock = ("time_ms", |t| format!("{:.0}", (1e3 * t + 50_000.0).round() % 65_536.0));
        }),
        with("counter of 32 bits", |v| {
            v.clock =
                ("time_ms", |t| format!("{:.0}", (1e3 * t + 4_294_960_000.0).round() % 4_294_967_296.0));
        }),
        with("reset", |v| {
            v.clock = ("time_s", |t| format!("{:.4}", if t < 20.0 { 5.0 + t } else { t - 20.0 }))
        }),
        // Columns.
        with("force and power", |v| v.columns = "force_N,power_W"),
        with("force and position", |v| v.columns = "force_N,position_mm"),
        with("force only, with a kick", |v| (v.columns, v.kick_n) = ("force_N", 1.0)),
        with("force only, without a kick", |v| {
            (v.columns, v.rig) = ("force_N", DECLARED.to_owned());
            v.is_partial = true;
        }),
        with("reversed position", |v| v.position = (300.0, -1.0)),
        with("direction column", |v| v.columns = "force_N,power_W,direction"),
        with("both ends", |v| v.columns = "force_in_N,force_out_N,position_mm"),
        with("no force", |v| (v.columns, v.refusal) = ("position_mm,power_W", "column 'force_N' is missing")),
        // Power.
        with("standby of 2.5 W", |v| v.standby_w = 2.5),
        with("moves at 1.5 W", |v| v.move_w = [1.5, 1.5]),
        with("regeneration", |v| v.move_w = [-4.0, 8.0]),
        with("power of another device", |v| (v.standby_w, v.move_w) = (5.0, [5.0, 5.0])),
        // Noise.
        with("noise", |v| v.noise_n = 0.3),
        with("spikes", |v| v.spike_share = 0.01),
        with("coarse cell", |v| (v.resolution_n, v.noise_n) = (0.05, 0.02)),
        with("negative force", |v| (v.sign, v.refusal) = (-1.0, "the force is negative")),
        // Dwell.
        with("dwell of 1.5 s", |v| (v.dwell_s, v.rig) = (1.5, DECLARED.to_owned())),
        with("dwell of 8 s", |v| (v.dwell_s, v.rig) = (8.0, DECLARED.to_owned())),
        with("dwell of 20 s, moves of 4 s", |v| (v.dwell_s, v.on_s) = (20.0, 4.0)),
        with("concentric first", |v| v.order = [Concentric, Eccentric]),
        // Cycles.
        with("triangle", |v| (v.shape, v.on_s) = (Shape::Triangle, 4.0)),
        with("sine", |v| (v.shape, v.on_s) = (Shape::Sine, 4.0)),
        with("slow triangle at 10 Hz", |v| {
            (v.shape, v.on_s, v.rate_hz, v.columns) = (Shape::Triangle, 20.0, 10.0, "force_N,position_mm");
        }),
        with("sine without power", |v| {
            (v.shape, v.on_s, v.columns) = (Shape::Sine, 2.0, "force_N,position_mm");
        }),
        with("triangle, force only", |v| (v.shape, v.on_s, v.columns) = (Shape::Triangle, 4.0, "force_N")),
    ]
}

#[test]
fn variants_are_accurate_or_refused() {
    let variants = variants();
    assert!(variants.len() >= 40);
    let failures: Vec<String> = variants.iter().filter_map(|v| v.check().err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
