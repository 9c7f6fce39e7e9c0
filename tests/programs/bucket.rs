//! A batch in a bucket equals a batch in a folder, object by object. The servers on loopback are
//! moto for S3 and Azurite for Azure, each behind a proxy that can be slow or absent.
//!
//! The tests need the feature `cloud`, moto in `/tmp/pinswitch-buckets` and Azurite in its folder
//! `azurite`; `.ci/run` installs both.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

use crate::harness::{SWEEP, binary, differences, done, hashes, report_skipped, repository, with_sweep};

/// Folder where `.ci/run` installs the servers.
const SERVERS: &str = "/tmp/pinswitch-buckets";
/// Delay of each answer of a slow server.
const SLOW: Duration = Duration::from_millis(120);

/// A server that ends when it is dropped.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// Starts a server and waits until it answers on its port.
fn serve(command: &mut Command, port: u16) -> Server {
    let server = Server(command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap());
    let start = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(start.elapsed() < Duration::from_secs(60), "{command:?} does not answer");
        std::thread::sleep(Duration::from_millis(50));
    }
    server
}

/// Behaviour of a proxy towards its clients.
#[derive(Clone, Copy)]
enum Mood {
    Fine = 0,
    Slow = 1,
    Gone = 2,
}

/// A proxy in front of a server.
struct Proxy {
    port: u16,
    mood: Arc<AtomicU8>,
}

impl Proxy {
    fn before(server: u16) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let (port, mood) = (listener.local_addr().unwrap().port(), Arc::new(AtomicU8::new(0)));
        let shared = Arc::clone(&mood);
        std::thread::spawn(move || {
            for client in listener.incoming().filter_map(Result::ok) {
                let mood = Arc::clone(&shared);
                if mood.load(Ordering::Relaxed) == Mood::Gone as u8 {
                    continue;
                }
                let Ok(server) = TcpStream::connect(("127.0.0.1", server)) else { continue };
                let (to, back) = (client.try_clone().unwrap(), server.try_clone().unwrap());
                let of_client = Arc::clone(&mood);
                std::thread::spawn(move || pass(client, server, &of_client, Duration::ZERO));
                std::thread::spawn(move || pass(back, to, &mood, SLOW));
            }
        });
        Self { port, mood }
    }

    fn be(&self, mood: Mood) {
        self.mood.store(mood as u8, Ordering::Relaxed);
    }
}

/// Copies bytes until one end closes, or the proxy is gone.
fn pass(mut from: TcpStream, mut to: TcpStream, mood: &AtomicU8, delay: Duration) {
    let mut buffer = vec![0; 1 << 16];
    while let Ok(n) = from.read(&mut buffer) {
        let mood = mood.load(Ordering::Relaxed);
        if n == 0 || mood == Mood::Gone as u8 {
            break;
        }
        if mood == Mood::Slow as u8 {
            std::thread::sleep(delay);
        }
        if to.write_all(&buffer[..n]).is_err() {
            break;
        }
    }
    let _ = from.shutdown(std::net::Shutdown::Both);
    let _ = to.shutdown(std::net::Shutdown::Both);
}

/// A bucket, with the URL and the environment variables that give access to it.
struct Bucket {
    folder: tempfile::TempDir,
    /// For example `s3://bucket`.
    url: &'static str,
    variables: Vec<(&'static str, String)>,
}

impl Bucket {
    fn command(&self, arguments: &str) -> Command {
        let mut command = binary();
        command.args(arguments.split(' ')).current_dir(self.folder.path());
        command.envs(self.variables.iter().map(|(name, value)| (name, value)));
        command
    }

    fn output(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Returns the output of a successful run.
    fn done(&self, arguments: &str) -> String {
        let output = self.output(arguments);
        let message = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        assert!(output.status.success(), "{arguments}: {message}");
        message
    }

    /// Returns the message of a run that ends with one error and this code.
    fn refused(&self, code: i32, arguments: &str) -> String {
        let output = self.output(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        let errors: Vec<_> = message.lines().filter(|l| l.starts_with("error: ")).collect();
        assert!(output.status.code() == Some(code) && errors.len() == 1, "{arguments}: {message}");
        assert!(message.len() < 800 && !message.contains("panicked"), "{message}");
        message
    }

    /// Writes the same objects under three prefixes: by one run, by shards with a merge, and by a
    /// run that is killed and resumed.
    fn fill(&self) {
        let url = self.url;
        self.done(&format!("-q batch sweep.toml --out {url}/whole"));
        // Two shards at the same time.
        let shard = |k: u8| format!("-q batch sweep.toml --out {url}/shards --shard {k}/2");
        let mut second = self.command(&shard(2)).spawn().unwrap();
        self.done(&shard(1));
        assert!(second.wait().unwrap().success());
        self.done(&format!("-q merge {url}/shards"));
        let mut child = self.command(&format!("-q batch sweep.toml --out {url}/killed")).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(400));
        child.kill().unwrap();
        child.wait().unwrap();
        self.done(&format!("-q batch sweep.toml --out {url}/killed"));
        let again = self.done(&format!("batch sweep.toml --out {url}/killed"));
        assert!(again.contains("; 12 existed before"), "{again}");
    }

    /// Asserts that uploads to a slow server are concurrent, and that a run whose server disappears
    /// gives one clear error and can be resumed.
    fn survive(&self, proxy: &Proxy) {
        let url = self.url;
        proxy.be(Mood::Slow);
        let start = Instant::now();
        self.done(&format!("-q batch sweep.toml --out {url}/slow"));
        // Two objects for each of 12 variants, and one search and one upload for each of 28 parts.
        let sequential = SLOW * (2 * 12 + 2 * 28);
        assert!(start.elapsed() < sequential * 2 / 3, "{:?}", start.elapsed());
        // The server disappears during the run. If it does so before the run has listed its folder,
        // the run ends with exit code 2, and the next attempt waits longer.
        let until_gone = |wait_ms: u64| {
            proxy.be(Mood::Slow);
            let mut child = self
                .command(&format!("batch sweep.toml --out {url}/gone"))
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            std::thread::sleep(Duration::from_millis(wait_ms));
            proxy.be(Mood::Gone);
            let mut output = String::new();
            child.stderr.take().unwrap().read_to_string(&mut output).unwrap();
            (child.wait().unwrap().code(), output)
        };
        let attempts: Vec<_> = [900, 1500, 2100, 2700].iter().map(|wait_ms| until_gone(*wait_ms)).collect();
        let half_way = attempts.iter().find(|(code, _)| *code == Some(1));
        let output = &half_way.unwrap_or_else(|| panic!("no attempt ended half-way: {attempts:?}")).1;
        let error = &output[output.find("error: ").unwrap()..];
        assert!(error.contains("then run the same command again to resume ("), "{output}");
        assert!(error.contains(" variants are finished)"), "{output}");
        assert!(error.len() < 600 && !output.contains("panicked"), "{output}");
        let error = self.refused(2, &format!("-q batch sweep.toml --out {url}/gone"));
        assert!(
            error.contains(&format!("{url}/gone")) && error.contains("check that the store is reachable"),
            "{error}"
        );
        proxy.be(Mood::Fine);
        self.done(&format!("-q batch sweep.toml --out {url}/gone"));
    }

    /// Asserts that the objects under each prefix are the files of a folder, without the links to
    /// parts, which a bucket does not have.
    fn assert_equals_folder(&self, objects: &BTreeMap<String, String>, prefixes: &[&str]) {
        done(self.folder.path(), &["-q", "batch", "sweep.toml", "--out", "folder"]);
        let mut folder = hashes(&self.folder.path().join("folder"));
        folder.retain(|name, _| !(name.starts_with("variants/") && name.ends_with(".stl")));
        for prefix in prefixes {
            let below = |name: &String| name.strip_prefix(&format!("{prefix}/")).map(str::to_owned);
            let mut there: BTreeMap<_, _> =
                objects.iter().filter_map(|(name, hash)| Some((below(name)?, hash.clone()))).collect();
            there.retain(|name, _| !name.starts_with("shards/"));
            assert_eq!(differences(&folder, &there), Vec::<String>::new(), "{prefix}");
        }
    }
}

#[test]
fn s3_batch_equals_folder_batch() {
    let python = Path::new(SERVERS).join("bin/python");
    if !cfg!(feature = "cloud") {
        return report_skipped("this build writes to folders only; --features cloud adds buckets");
    }
    if !Path::new(SERVERS).join("bin/moto_server").exists() {
        return report_skipped("moto is not in /tmp/pinswitch-buckets; .ci/run installs it");
    }
    let port = free_port();
    let mut moto = Command::new(Path::new(SERVERS).join("bin/moto_server"));
    let _server = serve(moto.args(["-H", "127.0.0.1", "-p", &port.to_string()]), port);
    let ask = |arguments: &[&str]| -> BTreeMap<String, String> {
        let script = repository("tests/programs/bucket.py");
        let output = Command::new(&python).arg(script).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let writer = ask(&["make", &port.to_string()]);
    let proxy = Proxy::before(port);
    let variables = vec![
        ("AWS_ENDPOINT", format!("http://127.0.0.1:{}", proxy.port)),
        ("AWS_ALLOW_HTTP", "true".to_owned()),
        ("AWS_REGION", "us-east-1".to_owned()),
        ("AWS_ACCESS_KEY_ID", writer["key"].clone()),
        ("AWS_SECRET_ACCESS_KEY", writer["secret"].clone()),
    ];
    let mut bucket = Bucket { folder: with_sweep(SWEEP), url: "s3://bucket", variables };
    bucket.fill();
    bucket.survive(&proxy);
    let objects = ask(&["list", &port.to_string(), &writer["key"], &writer["secret"]]);
    bucket.assert_equals_folder(&objects, &["whole", "shards", "killed", "slow", "gone"]);
    // Without write permission, a run and a dry run report an error and write no object.
    for (name, value) in [("AWS_SECRET_ACCESS_KEY", "wrong"), ("AWS_ACCESS_KEY_ID", "unknown")] {
        let right = bucket.variables.clone();
        bucket.variables.iter_mut().filter(|(n, _)| *n == name).for_each(|(_, v)| *v = value.to_owned());
        for more in ["", " --dry-run"] {
            let error = bucket.refused(2, &format!("-q batch sweep.toml --out s3://bucket/wrong{more}"));
            assert!(error.contains("s3://bucket/wrong") && error.contains("403"), "{error}");
        }
        bucket.refused(2, "-q merge s3://bucket/whole");
        bucket.variables = right;
    }
    assert_eq!(ask(&["list", &port.to_string(), &writer["key"], &writer["secret"]]), objects);
}

#[test]
fn azure_batch_equals_folder_batch() {
    let azurite: PathBuf = Path::new(SERVERS).join("azurite/node_modules/.bin/azurite-blob");
    if !cfg!(feature = "cloud") {
        return report_skipped("this build writes to folders only; --features cloud adds buckets");
    }
    if !azurite.exists() {
        return report_skipped("Azurite is not in /tmp/pinswitch-buckets/azurite; .ci/run installs it");
    }
    let port = free_port();
    let folder = with_sweep(SWEEP);
    let mut command = Command::new(&azurite);
    command.args([
        "--inMemoryPersistence",
        "--silent",
        "--skipApiVersionCheck",
        "--blobHost",
        "127.0.0.1",
        "--blobPort",
    ]);
    let _server = serve(command.arg(port.to_string()).current_dir(folder.path()), port);
    let proxy = Proxy::before(port);
    // The public account and key of Azurite.
    let key = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw==";
    let endpoint = format!("http://127.0.0.1:{}/devstoreaccount1", proxy.port);
    let variables = vec![
        ("AZURE_STORAGE_ACCOUNT_NAME", "devstoreaccount1".to_owned()),
        ("AZURE_STORAGE_ACCOUNT_KEY", key.to_owned()),
        ("AZURE_STORAGE_ENDPOINT", endpoint),
        ("AZURE_ALLOW_HTTP", "true".to_owned()),
    ];
    let bucket = Bucket { folder, url: "az://container", variables };
    let script = "const {createHmac}=require('crypto');const [port,key]=process.argv.slice(1);\
        const date=new Date().toUTCString(),version='2021-08-06',account='devstoreaccount1';\
        const headers={'x-ms-date':date,'x-ms-version':version,'content-length':'0'};\
        const text=['PUT','','','','','','','','','','','',`x-ms-date:${date}`,`x-ms-version:${version}`,\
        `/${account}/${account}/container`,'restype:container'].join('\\n');\
        headers.authorization=`SharedKey ${account}:`+createHmac('sha256',Buffer.from(key,'base64')).update(text).digest('base64');\
        require('http').request({port,method:'PUT',path:`/${account}/container?restype=container`,headers},\
        r=>process.exit(r.statusCode==201?0:1)).end();";
    let made = Command::new("node").args(["-e", script, &port.to_string(), key]).status().unwrap();
    assert!(made.success(), "the container cannot be made");
    bucket.fill();
    bucket.survive(&proxy);
    // A merge reads every object back and checks its hash.
    for k in 1..=2 {
        bucket.done(&format!("-q batch sweep.toml --out az://container/merged --shard {k}/2"));
    }
    bucket.done("-q merge az://container/merged --out merged");
    done(bucket.folder.path(), &["-q", "batch", "sweep.toml", "--out", "folder"]);
    let (merged, folder) = (bucket.folder.path().join("merged"), bucket.folder.path().join("folder"));
    let whole = hashes(&folder);
    for (name, hash) in hashes(&merged) {
        assert_eq!(whole[&name], hash, "{name}");
    }
}
