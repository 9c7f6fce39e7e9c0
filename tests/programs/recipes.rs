//! The recipes for many machines: a Slurm cluster of one node runs the job array, Snakemake runs its
//! workflow, a shell runs the commands of the Nextflow workflow, and a schema checks the Kubernetes Job.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{SWEEP, differences, done, hashes, with_sweep};

fn recipe(name: &str) -> PathBuf {
    crate::harness::repository("templates/batch").join(name).canonicalize().unwrap()
}

/// A Slurm cluster on loopback, whose daemons end when it is dropped.
struct Slurm {
    folder: PathBuf,
    daemons: Vec<Child>,
}

impl Slurm {
    /// Starts munged, slurmctld and slurmd.
    ///
    /// # Errors
    /// The reason why they cannot start here.
    fn start(folder: &Path) -> Result<Self, String> {
        for program in ["munged", "slurmctld", "slurmd", "sbatch", "sinfo"] {
            let location =
                Command::new("sh").args(["-c", &format!("command -v {program}")]).output().unwrap();
            if !location.status.success() {
                return Err(format!("{program} is not installed (Debian: apt-get install slurm-wlm munge)"));
            }
        }
        let user = Command::new("id").arg("-u").output().unwrap().stdout;
        if String::from_utf8_lossy(&user).trim() != "0" {
            return Err("slurmd must be run by an administrator".to_owned());
        }
        let host = String::from_utf8(Command::new("hostname").output().unwrap().stdout).unwrap();
        let (host, at) = (host.trim(), folder.display());
        for inner in ["state", "spool"] {
            std::fs::create_dir_all(folder.join(inner)).unwrap();
        }
        let mut key = vec![0; 1024];
        std::fs::File::open("/dev/urandom").unwrap().read_exact(&mut key).unwrap();
        std::fs::write(folder.join("munge.key"), key).unwrap();
        let mode = Command::new("chmod").arg("400").arg(folder.join("munge.key")).status().unwrap();
        assert!(mode.success());
        let configuration = format!(
            "ClusterName=loopback\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort=26817\nSlurmdPort=26818\n\
             SlurmUser=root\nSlurmdUser=root\nAuthType=auth/munge\nAuthInfo=socket={at}/munge.socket\n\
             CredType=cred/munge\nStateSaveLocation={at}/state\nSlurmdSpoolDir={at}/spool\n\
             SlurmctldPidFile={at}/slurmctld.pid\nSlurmdPidFile={at}/slurmd.pid\n\
             SlurmctldLogFile={at}/slurmctld.log\nSlurmdLogFile={at}/slurmd.log\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSelectType=select/cons_tres\n\
             SelectTypeParameters=CR_CPU\nReturnToService=2\n\
             SchedulerType=sched/builtin\nSchedulerParameters=sched_interval=1,batch_sched_delay=0\nMinJobAge=10\nMailProg=/bin/true\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN\n\
             PartitionName=loopback Nodes={host} Default=YES MaxTime=INFINITE State=UP\n"
        );
        std::fs::write(folder.join("slurm.conf"), configuration).unwrap();
        let mut slurm = Self { folder: folder.to_owned(), daemons: Vec::new() };
        let munge = [
            "key-file=munge.key",
            "socket=munge.socket",
            "pid-file=munged.pid",
            "log-file=munged.log",
            "seed-file=munged.seed",
        ];
        let munge: Vec<_> =
            munge.iter().map(|o| format!("--{}", o.replace('=', &format!("={at}/")))).collect();
        slurm.daemon("munged", &[&["--foreground".to_owned(), "--force".to_owned()][..], &munge].concat())?;
        std::thread::sleep(Duration::from_secs(1));
        slurm.daemon("slurmctld", &["-D".to_owned()])?;
        slurm.daemon("slurmd", &["-D".to_owned(), "-N".to_owned(), host.to_owned()])?;
        let start = Instant::now();
        while !slurm.output("sinfo", &["-h", "-o", "%t"]).contains("idle") {
            if start.elapsed() > Duration::from_secs(60) {
                let log = std::fs::read_to_string(folder.join("slurmctld.log")).unwrap_or_default();
                return Err(format!("Slurm does not start here: {log}"));
            }
            std::thread::sleep(Duration::from_millis(300));
        }
        Ok(slurm)
    }

    fn daemon(&mut self, program: &str, arguments: &[String]) -> Result<(), String> {
        let child = self
            .command(program)
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("{program} cannot be started: {e}"))?;
        self.daemons.push(child);
        Ok(())
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.folder.join("slurm.conf")).current_dir(&self.folder);
        command
    }

    fn output(&self, program: &str, arguments: &[&str]) -> String {
        let output = self.command(program).args(arguments).output().unwrap();
        String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

#[test]
fn slurm_array_equals_one_run() {
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    let slurm = match Slurm::start(path) {
        Ok(slurm) => slurm,
        Err(reason) => {
            crate::harness::report_skipped(&reason);
            return;
        }
    };
    // The two commands in the head of the recipe.
    let binary = env!("CARGO_BIN_EXE_pinswitch");
    let export = format!("--export=ALL,PINSWITCH={binary},SWEEP=sweep.toml,OUT=array");
    let script = recipe("slurm.sbatch");
    let array = slurm.output("sbatch", &["--parsable", "--array=1-3", &export, script.to_str().unwrap()]);
    let array = array.trim();
    assert!(array.parse::<u32>().is_ok(), "{array}");
    let after = format!("--dependency=afterok:{array}");
    let merge = format!("'{binary}' merge \"$OUT\"");
    let merged =
        slurm.output("sbatch", &["--parsable", "--wait", &after, "--export=ALL,OUT=array", "--wrap", &merge]);
    let logs = || -> String {
        let files = std::fs::read_dir(path).unwrap().map(|e| e.unwrap().path());
        files
            .filter(|p| p.extension().is_some_and(|e| e == "out"))
            .map(|p| std::fs::read_to_string(p).unwrap())
            .collect()
    };
    assert!(path.join("array/index.html").exists(), "{merged}: {}", logs());
    drop(slurm);
    assert_equals_one_run(path, "array");
}

/// Asserts that the merged batch in the folder `out` has the files of one run.
fn assert_equals_one_run(path: &Path, out: &str) {
    done(path, &["batch", "sweep.toml", "--out", "whole"]);
    let mut merged = hashes(&path.join(out));
    merged.retain(|name, _| !name.starts_with("shards/"));
    assert_eq!(differences(&hashes(&path.join("whole")), &merged), Vec::<String>::new());
}

#[test]
fn snakemake_workflow_equals_one_run() {
    if Command::new("snakemake").arg("--version").output().is_err() {
        crate::harness::report_skipped("snakemake is not installed (pip install snakemake)");
        return;
    }
    let folder = with_sweep(SWEEP);
    let path = folder.path();
    let run = || {
        let output = Command::new("snakemake")
            .arg("--snakefile")
            .arg(recipe("Snakefile"))
            .args(["--cores", "2", "--config", "sweep=sweep.toml", "out=made/snakes", "shards=3"])
            .arg(format!("pinswitch={}", env!("CARGO_BIN_EXE_pinswitch")))
            .env("XDG_CACHE_HOME", path.join("cache"))
            .current_dir(path)
            .output()
            .unwrap();
        let message = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(output.status.success(), "{message}");
        message
    };
    run();
    assert_equals_one_run(path, "made/snakes");
    // Every shard is finished.
    assert!(run().contains("Nothing to be done"));
}

/// Replaces the variables of the workflow and runs its commands in a shell: Nextflow itself cannot be installed
/// without its own server.
#[test]
fn nextflow_commands_equal_one_run() {
    let text = std::fs::read_to_string(recipe("pinswitch.nf")).unwrap();
    let scripts: Vec<_> =
        text.lines().filter_map(|line| line.trim().strip_prefix("script: \"")?.strip_suffix('"')).collect();
    let [shard, merge] = scripts[..] else { panic!("{scripts:?}") };
    let folder = with_sweep(SWEEP);
    let run = |script: &str, k: u32| {
        let values = [
            ("${params.pinswitch}", env!("CARGO_BIN_EXE_pinswitch")),
            ("${params.sweep}", "sweep.toml"),
            ("${params.out}", "flow"),
            ("${params.shards}", "3"),
            ("${task.cpus}", "2"),
            ("${k}", &k.to_string()),
        ];
        let script =
            values.iter().fold(script.to_owned(), |script, (name, value)| script.replace(name, value));
        assert!(!script.contains('$'), "{script}");
        let status = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).status().unwrap();
        assert!(status.success(), "{script}");
    };
    (1..=3).for_each(|k| run(shard, k));
    run(merge, 0);
    assert_equals_one_run(folder.path(), "flow");
}

#[test]
fn kubernetes_job_matches_schema() {
    let packed = include_bytes!("../data/kubernetes/job-batch-v1.34.json.gz");
    let mut schema = String::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_string(&mut schema).unwrap();
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let text = std::fs::read_to_string(recipe("kubernetes-job.yaml")).unwrap();
    let job: serde_json::Value = serde_saphyr::from_str(&text).unwrap();
    let errors: Vec<_> = validator.iter_errors(&job).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    // The schema refuses an unknown key.
    let misspelt: serde_json::Value =
        serde_saphyr::from_str(&text.replace("completionMode", "completionsMode")).unwrap();
    assert!(!validator.is_valid(&misspelt));
    let spec = &job["spec"];
    let command = spec["template"]["spec"]["containers"][0]["args"][0].as_str().unwrap();
    assert_eq!(spec["completionMode"], "Indexed");
    assert!(command.contains(&format!("+ 1))/{}\"", spec["completions"])), "{command}");
    // A shell computes the shard of each pod in the command's arguments.
    for (index, shard) in [("0", "1/8"), ("7", "8/8")] {
        let shown = command.replace("exec pinswitch", "echo");
        let message =
            Command::new("sh").args(["-c", &shown]).env("JOB_COMPLETION_INDEX", index).output().unwrap();
        let message = String::from_utf8(message.stdout).unwrap();
        assert_eq!(
            message.trim(),
            format!("batch /sweep/sweep.toml --out s3://bucket/sweep --shard {shard} --yes")
        );
    }
}
