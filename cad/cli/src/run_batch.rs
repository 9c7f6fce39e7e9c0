//! `pinswitch batch SWEEP`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::failure::say;
use super::second_kernel::requested_kernel;
use super::{Failure, print, print_json, slicing};
use pinswitch_batch::{
    CountedSweep, Destination, Estimate, Observer, Options, Reach, RunError, Shard, SweepSource, Tally,
    VariantOutcome, Variants, admit, estimate, mesh_file, partial_folder, run as run_batch, would_fail,
};

/// More variants than this want --yes.
const MAX_WITHOUT_YES: u64 = 10_000;
/// Most threads: more processors than a machine has, and less than a system refuses, or spends its memory on.
const MAX_THREADS: i64 = 256;
/// Interval of progress lines where there is no terminal.
const PROGRESS_INTERVAL: Duration = Duration::from_secs(10);

/// Make every variant of a sweep: parts, curves, one table of all, plots, and a page to look through them.
///
/// A sweep is a base configuration with axes (lists, ranges), a seeded sample (Latin hypercube or random) or a CSV of
/// rows over it, and constraints. DIR gets variants/ID/ with the parts, curve and manifest of each, variants.csv and
/// variants.parquet, curves.svg, threshold.svg and index.html. Equal parts are made once and linked. A run that was
/// stopped, or killed, is taken up by the same command and ends with the same files.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch batch sweep.toml --out out/sweep --dry-run
  pinswitch batch sweep.toml --out out/sweep
  pinswitch batch sweep.toml --out s3://bucket/sweep --shard 2/8   (then: pinswitch merge s3://bucket/sweep)
  pinswitch init sweep --out sweep.toml")]
pub(super) struct Arguments {
    /// The sweep's TOML file; `pinswitch init sweep` writes one to start from.
    sweep: PathBuf,
    /// Folder or object store to write to; the same one takes up a run that was stopped.
    #[arg(long, short, value_name = "DIR|URL", required_unless_present = "dry_run")]
    out: Option<String>,
    /// Let the sweep name files outside its own folder as base, preset or rows.
    #[arg(long)]
    read_outside: bool,
    /// Say how many variants, how long, how large, and what would be refused and why; write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print the estimate of --dry-run, or the tally at the end, as JSON.
    #[arg(long)]
    json: bool,
    /// Make only block K of N; `pinswitch merge` joins them.
    #[arg(long, value_name = "K/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Threads, up to 256 [default: one per processor; 16 for a bucket, which upload at once].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS)
    )]
    threads: u16,
    /// Ask an installed PrusaSlicer (`prusa-slicer` on PATH, or PINSWITCH_SLICER) of every variant: columns print_minutes,
    /// filament_g and filament_m, the sums over its parts.
    #[arg(long)]
    slice: bool,
    /// Verify every mesh with a second geometry kernel, truck-modeling. The manifests record the differences; a variant with
    /// a larger one than the chord tolerance allows fails.
    #[arg(long)]
    verify: bool,
    /// Stop at the first variant that fails.
    #[arg(long)]
    fail_fast: bool,
    /// Make more than 10000 variants.
    #[arg(long)]
    yes: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kernel = requested_kernel(arguments.verify)?;
    let reach = if arguments.read_outside { Reach::Anywhere } else { Reach::Beside };
    let mut source = SweepSource::read_within(&arguments.sweep, reach).map_err(Failure::bad_input)?;
    source.slice = arguments.slice;
    source.verify = arguments.verify;
    let counted = CountedSweep::new(&source).map_err(Failure::bad_input)?;
    let count = counted.count().ok_or_else(|| {
        Failure::bad_input(format!(
            "{}: more variants than can be counted ({}); raise a step, or lower a count",
            arguments.sweep.display(),
            u64::MAX
        ))
    })?;
    let own = arguments.shard.range(count);
    if own.end - own.start > MAX_WITHOUT_YES && !arguments.yes {
        return Err(Failure::bad_input(format!(
            "{}: {} variants are more than {MAX_WITHOUT_YES}; give --yes if you mean it, or --shard",
            arguments.sweep.display(),
            own.end - own.start,
        )));
    }
    if arguments.shard.range(count).is_empty() {
        return Err(Failure::bad_input(format!(
            "--shard {} has no variant: the sweep has {count}; give fewer shards",
            arguments.shard
        )));
    }
    let variants = Variants::new(counted.checked().map_err(Failure::bad_input)?, &source);
    let out = arguments.out.as_deref().unwrap_or_default();
    let open = || Destination::open(out, &partial_folder(arguments.shard)).map_err(Failure::bad_input);
    if arguments.dry_run {
        let mut failing = Vec::new();
        if arguments.out.is_some() {
            let destination = open()?;
            admit(&variants, &source, &destination, arguments.shard).map_err(refused)?;
            failing = would_fail(&destination, &variants, arguments.shard).map_err(Failure::failed)?;
        }
        dry_run(arguments, &variants)?;
        return match failing.first() {
            None => Ok(()),
            Some(first) => Err(Failure::failed(format!(
                "{out}/{first} is in the way, and {} more; variants that need it would fail: move it away, or give another --out",
                failing.len() - 1
            ))),
        };
    }
    let slicer = if arguments.slice { slicing::installed()? } else { None };
    let destination = open()?;
    let progress = Progress::new(own.end - own.start)?;
    let options = Options {
        shard: arguments.shard,
        threads: usize::from(arguments.threads),
        fail_fast: arguments.fail_fast,
        mesh_maker: mesh_file,
        slicer: slicer.as_ref(),
        kernel,
    };
    let outcome = run_batch(&variants, &source, &destination, options, &progress);
    progress.bar.finish_and_clear();
    let tally = outcome.map_err(refused)?;
    report(arguments, out, &tally, &progress)
}

fn refused(error: RunError) -> Failure {
    match error {
        RunError::Stamp(_) | RunError::Unusable(_) => Failure::bad_input(error),
        other => Failure::failed(other),
    }
}

fn report(arguments: &Arguments, out: &str, tally: &Tally, progress: &Progress) -> Result<(), Failure> {
    if arguments.json {
        print_json(tally)?;
    }
    log::info!("{out}: {} variants made, {} refused, {} failed", tally.made, tally.refused, tally.failed);
    log::info!(
        "{} part files, {} of them different: {} kept in {}",
        tally.parts,
        tally.distinct_parts,
        size(tally.part_bytes as f64),
        size(tally.distinct_bytes as f64)
    );
    let (seconds, before) = (progress.start.elapsed().as_secs_f64(), progress.before.load(Ordering::Relaxed));
    let new = progress.bar.position() - before;
    log::info!("{new} in {seconds:.1} s, {:.0} a second; {before} were there before", new as f64 / seconds);
    if tally.failed > 0 {
        return Err(Failure::failed(format!(
            "{} variants failed; column reason of variants.csv says why, the same command tries them again",
            tally.failed
        )));
    }
    Ok(())
}

/// Progress as a bar on a terminal or as lines in a pipe, and Ctrl-C.
struct Progress {
    bar: ProgressBar,
    start: Instant,
    before: AtomicU64,
    stop: Arc<AtomicBool>,
    /// Seconds after the start at which the next line is due, where there is no terminal.
    due_s: AtomicU64,
}

impl Progress {
    fn new(count: u64) -> Result<Self, Failure> {
        let bar = ProgressBar::new(count);
        let form = "{bar:30} {pos} of {len} variants, {per_sec}, {eta} left {msg}";
        bar.set_style(ProgressStyle::with_template(form).map_err(Failure::failed)?);
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                // Asked twice: every file on disk is whole at any moment.
                std::process::exit(1);
            }
            say("finishing what is begun; once more stops at once");
        })
        .map_err(Failure::failed)?;
        Ok(Self {
            bar,
            start: Instant::now(),
            before: AtomicU64::new(0),
            stop,
            due_s: AtomicU64::new(PROGRESS_INTERVAL.as_secs()),
        })
    }
}

impl Observer for Progress {
    fn variant_done(&self, outcome: &VariantOutcome) {
        if matches!(outcome, VariantOutcome::Made { reused: true, .. }) {
            self.before.fetch_add(1, Ordering::Relaxed);
        }
        self.bar.inc(1);
        let (elapsed, due) = (self.start.elapsed(), self.due_s.load(Ordering::Relaxed));
        let next = elapsed.as_secs() + PROGRESS_INTERVAL.as_secs();
        let exchange = |due| self.due_s.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed);
        if self.bar.is_hidden() && elapsed.as_secs() >= due && exchange(due).is_ok() {
            let (done, of) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let rate = done as f64 / elapsed.as_secs_f64();
            let left = Duration::from_secs_f64((of.saturating_sub(done)) as f64 / rate.max(1e-9));
            log::info!("{done} of {of} variants, {rate:.0} a second, {} left", HumanDuration(left));
        }
    }

    fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn dry_run(arguments: &Arguments, variants: &Variants) -> Result<(), Failure> {
    let threads = usize::from(arguments.threads);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::failed)?;
    let threads = pool.current_num_threads();
    let estimate =
        pool.install(|| estimate(variants, arguments.shard, threads, mesh_file)).map_err(Failure::failed)?;
    if arguments.slice {
        log::info!(
            "--slice takes seconds more for each part that is like no other, which this does not count"
        );
    }
    if arguments.verify {
        log::info!("--verify takes up to a second more for each different part, which this does not count");
    }
    if arguments.json { print_json(&estimate) } else { print(describe(variants, &estimate).as_bytes()) }
}

fn describe(variants: &Variants, estimate: &Estimate) -> String {
    let sweep = variants.sweep();
    let fields: Vec<_> = variants.fields().map(|f| f.path()).collect();
    let mut text = format!("{}: {} variants over {}\n", sweep.name, estimate.variants, fields.join(", "));
    let refused: u64 = estimate.refused.iter().map(|r| r.count).sum();
    if estimate.checked < estimate.variants {
        text += &format!("checked are {} of them, evenly taken\n", estimate.checked);
    }
    text += &format!("refused: {refused}\n");
    for kind in &estimate.refused {
        text +=
            &format!("  {} for {}, such as {}:\n    {}\n", kind.count, kind.kind, kind.example, kind.reason);
    }
    text += &format!("made: {}\n", estimate.made);
    if let Some(measured) = &estimate.measured {
        text += &format!(
            "time: about {} on {} threads; {:.1} ms a variant, measured on {}\n",
            time(estimate.seconds),
            estimate.threads,
            measured.seconds_per_variant * 1e3,
            measured.variants
        );
        text += &format!(
            "size: about {}; {} a variant, of {} before equal parts are linked\n",
            size(estimate.bytes),
            size(measured.bytes_per_variant),
            size(measured.bytes_unshared)
        );
    }
    text
}

fn time(seconds: f64) -> String {
    if seconds < 120.0 {
        format!("{seconds:.1} s")
    } else {
        HumanDuration(Duration::from_secs_f64(seconds)).to_string()
    }
}

fn size(bytes: f64) -> String {
    match bytes {
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Program {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn threads_are_as_many_as_a_machine_can_have() {
        let threads = |count: &str| {
            let line = ["batch", "sweep.toml", "--dry-run", "--threads", count];
            Program::try_parse_from(line).map(|p| p.arguments.threads).map_err(|e| e.to_string())
        };
        assert_eq!((threads("0"), threads("256")), (Ok(0), Ok(256)));
        for beyond in ["257", "100000000"] {
            assert!(threads(beyond).unwrap_err().contains("0..=256"), "{beyond}");
        }
    }
}
