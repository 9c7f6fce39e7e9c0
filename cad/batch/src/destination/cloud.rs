//! The object stores of three clouds, by URL and the environment variables of their own tools.

use std::error::Error;
use std::sync::Arc;
use std::time::Duration;

use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey};
use object_store::azure::{AzureConfigKey, MicrosoftAzureBuilder};
use object_store::gcp::{GoogleCloudStorageBuilder, GoogleConfigKey};
use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreScheme, RetryConfig};
use pinswitch_diagnostic::codes;
use url::Url;

use super::{DestinationError, unknown_store};

/// Retries of a request, after pauses of 0.1 s, 0.2 s and so on; then the run stops, and can be
/// resumed.
const RETRIES: usize = 5;
/// Longest time for all retries of a request.
const RETRY_TIMEOUT: Duration = Duration::from_secs(60);

/// Builds a store from its URL and the known variables of its cloud.
macro_rules! store {
    ($builder:ty, $key:ty, $prefix:literal, $url:expr) => {{
        let builder = <$builder>::new().with_url($url.to_string()).with_retry(retry());
        let known = variables($prefix).filter_map(|(name, value)| Some((name.parse::<$key>().ok()?, value)));
        let builder = known.fold(builder, |builder, (key, value)| builder.with_config(key, value));
        builder
            .build()
            .map(|store| Arc::new(store) as Arc<dyn ObjectStore>)
            .map_err(|e| invalid_url($url.as_str(), e))
    }};
}

/// Opens the store of a URL such as `s3://bucket/sweep`; returns it with the path in it.
///
/// # Errors
/// A URL of an unknown store, and a store with invalid settings.
pub(super) fn open(text: &str) -> Result<(Arc<dyn ObjectStore>, Path), DestinationError> {
    // The provider of encryption is set once per process, before the first client; later calls have
    // no effect.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let url = Url::parse(text).map_err(|e| invalid_url(text, e))?;
    let (scheme, path) = ObjectStoreScheme::parse(&url).map_err(|e| invalid_url(text, e))?;
    let store = match scheme {
        ObjectStoreScheme::AmazonS3 => store!(AmazonS3Builder, AmazonS3ConfigKey, "AWS_", url),
        ObjectStoreScheme::GoogleCloudStorage => {
            store!(GoogleCloudStorageBuilder, GoogleConfigKey, "GOOGLE_", url)
        }
        ObjectStoreScheme::MicrosoftAzure => store!(MicrosoftAzureBuilder, AzureConfigKey, "AZURE_", url),
        _ => Err(unknown_store(codes::UNKNOWN_WORD, text, "unknown store")),
    };
    Ok((store?, path))
}

/// The error of a URL or of the settings of its store.
fn invalid_url(url: &str, error: impl Error + Send + Sync + 'static) -> DestinationError {
    unknown_store(codes::MALFORMED_VALUE, url, error.to_string()).with_source(error)
}

fn retry() -> RetryConfig {
    RetryConfig { max_retries: RETRIES, retry_timeout: RETRY_TIMEOUT, ..RetryConfig::default() }
}

/// Returns the environment variables with this prefix, in lower case like the keys of a store.
fn variables(prefix: &'static str) -> impl Iterator<Item = (String, String)> {
    // Variables of stores are UTF-8.
    std::env::vars_os()
        .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
        .filter(move |(name, _)| name.starts_with(prefix))
        .map(|(name, value)| (name.to_ascii_lowercase(), value))
}
