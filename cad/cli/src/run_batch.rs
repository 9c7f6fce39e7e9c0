//! `pinswitch batch SWEEP`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use pinswitch_batch::{
    Destination, Estimate, Observer, Options, Reach, RunError, Shard, SweepSource, Tally, UncheckedSweep,
    VariantOutcome, Variants, check_destination, estimate, mesh_file, obstructed_paths, partial_folder,
    run as run_batch,
};
use pinswitch_diagnostic::{Diagnostic, Location, codes};

use super::second_kernel::requested_kernel;
use super::terminal::print_line;
use super::write::lock_policy;
use super::{Failure, print_json, print_text, slicing};

/// Most variants without `--yes`.
const MAX_WITHOUT_YES: u64 = 10_000;
/// Most threads: more than the processors of a machine, and fewer than exhaust its memory or the system's limit.
const MAX_THREADS: i64 = 256;
/// Interval of progress lines without a terminal.
const PROGRESS_INTERVAL: Duration = Duration::from_secs(10);

/// Make every variant of a sweep, with one table, plots and a page to browse.
///
/// A sweep varies a base configuration by axes (lists, ranges), by a seeded sample (Latin hypercube or random) or by the
/// rows of a CSV, within constraints. The output has variants/ID/ with the parts, the curve and the manifest of each
/// variant, variants.csv and variants.parquet, curves.svg, threshold.svg and index.html. Equal parts are made once and
/// linked. The same command resumes a run that was stopped or killed, and ends with the same files.
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  pinswitch batch sweep.toml --out out/sweep --dry-run
  pinswitch batch sweep.toml --out out/sweep
  pinswitch batch sweep.toml --out s3://bucket/sweep --shard 2/8   (then: pinswitch merge s3://bucket/sweep)
  pinswitch init sweep --out sweep.toml")]
pub(super) struct Arguments {
    /// TOML file of the sweep; `pinswitch init sweep` writes one to start from.
    sweep: PathBuf,
    /// Folder or object store for the output; give the same one to resume a run.
    #[arg(long, short, value_name = "DIR|URL", required_unless_present = "dry_run")]
    out: Option<String>,
    /// Allow base, preset and rows outside the folder of the sweep.
    #[arg(long)]
    read_outside: bool,
    /// Estimate variants, time and size, and list the refused variants with reasons; write nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print the estimate of --dry-run, or the tally at the end, as JSON.
    #[arg(long)]
    json: bool,
    /// Make only block K of N; `pinswitch merge` joins the blocks.
    #[arg(long, value_name = "K/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Threads, up to 256 [default: one per processor; for a bucket 16, which upload in parallel].
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS)
    )]
    threads: u16,
    /// Slice every variant with an installed PrusaSlicer (`prusa-slicer` on PATH, or PINSWITCH_SLICER); adds the columns
    /// print_minutes, filament_g and filament_m, summed over the parts.
    #[arg(long)]
    slice: bool,
    /// Verify every mesh with a second geometry kernel, truck-modeling. The manifests record the differences; a variant with
    /// a larger one than the chord tolerance allows fails.
    #[arg(long)]
    verify: bool,
    /// Stop at the first variant that fails.
    #[arg(long)]
    fail_fast: bool,
    /// Allow more than 10000 variants.
    #[arg(long)]
    yes: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kernel = requested_kernel(arguments.verify)?;
    let reach = if arguments.read_outside { Reach::Anywhere } else { Reach::SweepFolder };
    let mut source = SweepSource::read_within(&arguments.sweep, reach).map_err(Failure::bad_input)?;
    source.slice = arguments.slice;
    source.verify = arguments.verify;
    let counted = UncheckedSweep::new(&source).map_err(Failure::bad_input)?;
    let count = count(arguments, &counted)?;
    let range = arguments.shard.range(count);
    let variants = Variants::new(counted.check().map_err(Failure::bad_input)?, &source);
    let out = arguments.out.as_deref().unwrap_or_default();
    let open = || {
        let destination =
            Destination::open(out, &partial_folder(arguments.shard)).map_err(Failure::bad_input)?;
        Ok::<_, Failure>(destination.with_lock_policy(lock_policy()))
    };
    if arguments.dry_run {
        let mut failing = Vec::new();
        if arguments.out.is_some() {
            let destination = open()?;
            check_destination(&variants, &source, &destination, arguments.shard).map_err(refused)?;
            failing = obstructed_paths(&destination, &variants, arguments.shard).map_err(Failure::failed)?;
        }
        dry_run(arguments, &variants)?;
        return match failing.first() {
            None => Ok(()),
            Some(first) => {
                let problem = match failing.len() - 1 {
                    0 => "blocks the output: its variant would fail".to_owned(),
                    more => {
                        format!("blocks the output, and {more} other paths do: their variants would fail")
                    }
                };
                Err(Failure::failed(
                    Diagnostic::new(codes::CANNOT_WRITE, problem)
                        .with_location(Location::file(format!("{out}/{first}")))
                        .with_help("move it away, or give another --out"),
                ))
            }
        };
    }
    let slicer = if arguments.slice { slicing::installed()? } else { None };
    let destination = open()?;
    let progress = Progress::new(range.end - range.start)?;
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

/// Counts the variants of a sweep.
///
/// # Errors
/// [`Failure::bad_input`] if there are too many, or none in the requested shard.
fn count(arguments: &Arguments, sweep: &UncheckedSweep) -> Result<u64, Failure> {
    let file = || Location::file(arguments.sweep.display().to_string());
    let count = sweep.count().ok_or_else(|| {
        Failure::bad_input(
            Diagnostic::new(codes::TOO_MANY_VARIANTS, format!("more than {} variants", u64::MAX))
                .with_location(file())
                .with_help("raise a step, or lower a count"),
        )
    })?;
    let range = arguments.shard.range(count);
    let variants = range.end - range.start;
    if variants > MAX_WITHOUT_YES && !arguments.yes {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::TOO_MANY_VARIANTS,
                format!("{variants} variants are more than {MAX_WITHOUT_YES}"),
            )
            .with_location(file())
            .with_help("allow them with --yes, or make a part of them with --shard"),
        ));
    }
    if range.is_empty() {
        return Err(Failure::bad_input(
            Diagnostic::new(
                codes::INVALID_SHARD,
                format!("no variant is in this shard: the sweep has {count}"),
            )
            .with_location(Location::field("--shard", arguments.shard.to_string()))
            .with_help("give fewer shards"),
        ));
    }
    Ok(count)
}

fn refused(error: RunError) -> Failure {
    if error.is_bad_input() { Failure::bad_input(error) } else { Failure::failed(error) }
}

fn report(arguments: &Arguments, out: &str, tally: &Tally, progress: &Progress) -> Result<(), Failure> {
    if arguments.json {
        print_json(tally)?;
    }
    log::info!("{out}: {}", tally.summary());
    log::info!(
        "{} part files, {} of them distinct: {} stored in {}",
        tally.parts,
        tally.distinct_parts,
        size(tally.part_bytes as f64),
        size(tally.distinct_bytes as f64)
    );
    let (seconds, before) = (progress.start.elapsed().as_secs_f64(), progress.before.load(Ordering::Relaxed));
    let new = progress.bar.position() - before;
    let rate = new as f64 / seconds;
    log::info!("{new} variants in {seconds:.1} s, {rate:.0} per second; {before} existed before");
    if tally.failed > 0 {
        return Err(Failure::failed(
            Diagnostic::new(codes::VARIANTS_FAILED, format!("{} variants failed", tally.failed))
                .with_help("see column reason of variants.csv; run the same command to try them again"),
        ));
    }
    Ok(())
}

/// Progress, as a bar on a terminal or as lines in a pipe, and the handler of Ctrl-C.
struct Progress {
    bar: ProgressBar,
    start: Instant,
    before: AtomicU64,
    stop: Arc<AtomicBool>,
    /// Seconds after the start at which the next line is due, without a terminal.
    due_s: AtomicU64,
}

impl Progress {
    fn new(count: u64) -> Result<Self, Failure> {
        let bar = ProgressBar::new(count);
        let template = "{bar:30} {pos} of {len} variants, {per_sec}, {eta} left {msg}";
        let style = ProgressStyle::with_template(template);
        bar.set_style(style.map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?);
        if log::max_level() < log::LevelFilter::Info {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                // The second time: every file on disk is whole at any moment.
                std::process::exit(1);
            }
            print_line("finishing the variants in progress; press Ctrl-C again to stop now");
        })
        .map_err(|e| Failure::failed(Diagnostic::from_error(codes::INTERNAL_ERROR, e)))?;
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
            log::info!("{done} of {of} variants, {rate:.0} per second, {} left", HumanDuration(left));
        }
    }

    fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn dry_run(arguments: &Arguments, variants: &Variants) -> Result<(), Failure> {
    let threads = usize::from(arguments.threads);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| Failure::failed(Diagnostic::from_error(codes::CANNOT_START, e)))?;
    let threads = pool.current_num_threads();
    let estimate =
        pool.install(|| estimate(variants, arguments.shard, threads, mesh_file)).map_err(Failure::failed)?;
    if arguments.slice {
        log::info!("--slice takes some seconds more per distinct part, which the time does not include");
    }
    if arguments.verify {
        log::info!("--verify takes up to a second more for each different part, which this does not count");
    }
    if arguments.json { print_json(&estimate) } else { print_text(&describe(variants, &estimate)) }
}

fn describe(variants: &Variants, estimate: &Estimate) -> String {
    let sweep = variants.sweep();
    let fields: Vec<_> = variants.fields().map(|f| f.path()).collect();
    let mut text = format!("{}: {} variants over {}\n", sweep.name, estimate.variants, fields.join(", "));
    let refused: u64 = estimate.refused.iter().map(|r| r.count).sum();
    if estimate.checked < estimate.variants {
        text += &format!("checked: {} of them, evenly spaced\n", estimate.checked);
    }
    text += &format!("refused: {refused}\n");
    for kind in &estimate.refused {
        text +=
            &format!("  {} for {}, such as {}:\n    {}\n", kind.count, kind.kind, kind.example, kind.reason);
    }
    text += &format!("made: {}\n", estimate.made);
    if let Some(measured) = &estimate.measured {
        text += &format!(
            "time: about {} on {} threads; {:.1} ms per variant, measured on {}\n",
            time(estimate.seconds),
            estimate.threads,
            measured.seconds_per_variant * 1e3,
            measured.variants
        );
        text += &format!(
            "size: about {}; {} per variant, {} before equal parts are linked\n",
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
    fn threads_are_bounded() {
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
