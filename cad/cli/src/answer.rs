//! `pinswitch answer`: one question of the configurator, in a process of its own. What takes seconds to compute ends with it.

use std::io::{BufRead, Read};

use clap::Args;
use pinswitch_app::{Answer, Engine};

use super::{Failure, print};

/// Answer one question of the configurator, from standard input; `view` asks itself so.
///
/// A line gives the length of the question in bytes; the question follows. Standard input is held open for as long as somebody
/// waits: where it ends, so does this.
#[derive(Args, Debug)]
#[command(hide = true)]
pub(super) struct Arguments {}

pub(super) fn run(_: &Arguments) -> Result<(), Failure> {
    let question = asked(&mut std::io::stdin().lock()).map_err(Failure::bad_input)?;
    std::thread::spawn(|| {
        // Who asked has gone: nobody reads the answer.
        let _ = std::io::stdin().lock().read_to_end(&mut Vec::new());
        std::process::exit(1);
    });
    match Engine::default().answer(&question) {
        Answer::Json(text) => print(text.as_bytes()),
        Answer::Bytes(bytes) => print(&bytes),
    }
}

/// The question behind its length.
fn asked(from: &mut impl BufRead) -> Result<String, String> {
    let mut length = String::new();
    from.by_ref().take(32).read_line(&mut length).map_err(|e| e.to_string())?;
    let bytes: usize = length.trim().parse().map_err(|e| format!("the question's length {length:?}: {e}"))?;
    let mut question = Vec::new();
    from.take(bytes as u64).read_to_end(&mut question).map_err(|e| e.to_string())?;
    if question.len() < bytes {
        return Err(format!("the question ends after {} of {bytes} bytes", question.len()));
    }
    String::from_utf8(question).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::asked;

    #[test]
    fn a_question_is_as_long_as_is_said() {
        assert_eq!(asked(&mut &b"3\n{}\nmore"[..]).unwrap(), "{}\n");
        for (given, problem) in
            [(&b"9\n{}"[..], "ends after 2 of 9"), (b"{}", "length"), (b"", "length"), (b"1\n\xff", "utf-8")]
        {
            let error = asked(&mut &*given).unwrap_err();
            assert!(error.contains(problem), "{error}");
        }
    }
}
