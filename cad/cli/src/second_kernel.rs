//! The second kernel of `--verify`.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_solid::verification::{Kernel, second_kernel};

use super::Failure;

/// Returns the second kernel of this build, if it is requested.
///
/// # Errors
/// Exit code 2 in a build without one.
pub(super) fn requested_kernel(is_requested: bool) -> Result<Option<Kernel>, Failure> {
    if is_requested { available(second_kernel()).map(Some) } else { Ok(None) }
}

fn available(kernel: Option<Kernel>) -> Result<Kernel, Failure> {
    kernel.ok_or_else(|| {
        let location = Location { field: Some("--verify".to_owned()), ..Location::default() };
        Failure::bad_input(
            Diagnostic::new(
                codes::FEATURE_NOT_BUILT,
                "this build has no second kernel to verify meshes with",
            )
            .with_location(location)
            .with_help("build it with the default features, or with --features truck"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_without_kernel_refuses_the_option() {
        let failure = format!("{:?}", available(None).unwrap_err());
        for words in ["--verify", "no second kernel", "--features truck"] {
            assert!(failure.contains(words), "{failure}");
        }
        assert!(requested_kernel(false).unwrap().is_none());
        assert_eq!(requested_kernel(true).is_ok(), cfg!(feature = "truck"));
    }
}
