//! The object stores of the three clouds, by URL and by the variables that their own tools read.

use std::sync::Arc;
use std::time::Duration;

use object_store::aws::{AmazonS3Builder, AmazonS3ConfigKey};
use object_store::azure::{AzureConfigKey, MicrosoftAzureBuilder};
use object_store::gcp::{GoogleCloudStorageBuilder, GoogleConfigKey};
use object_store::path::Path;
use object_store::{ObjectStore, ObjectStoreScheme, RetryConfig};
use url::Url;

/// How often a request is repeated, after pauses of 0.1 s, 0.2 s and so on; then the run stops, to be taken up later.
const RETRIES: usize = 5;
/// Longest time that repeating goes on.
const RETRY_TIMEOUT: Duration = Duration::from_secs(60);

/// Builds a store: the URL, the variables of its cloud that it knows, and how to repeat.
macro_rules! store {
    ($builder:ty, $key:ty, $prefix:literal, $url:expr) => {{
        let builder = <$builder>::new().with_url($url.to_string()).with_retry(retry());
        let known = variables($prefix).filter_map(|(name, value)| Some((name.parse::<$key>().ok()?, value)));
        let builder = known.fold(builder, |builder, (key, value)| builder.with_config(key, value));
        builder.build().map(|store| Arc::new(store) as Arc<dyn ObjectStore>).map_err(|e| e.to_string())
    }};
}

/// The store and the place in it that `text` names, such as `s3://bucket/sweep`.
///
/// # Errors
/// Why there is none.
pub(super) fn open(text: &str) -> Result<(Arc<dyn ObjectStore>, Path), String> {
    // Who does the encryption is settled once for the process, before a client is made: only the first call takes effect.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let url = Url::parse(text).map_err(|e| e.to_string())?;
    let (scheme, place) = ObjectStoreScheme::parse(&url).map_err(|e| e.to_string())?;
    let store = match scheme {
        ObjectStoreScheme::AmazonS3 => store!(AmazonS3Builder, AmazonS3ConfigKey, "AWS_", url),
        ObjectStoreScheme::GoogleCloudStorage => {
            store!(GoogleCloudStorageBuilder, GoogleConfigKey, "GOOGLE_", url)
        }
        ObjectStoreScheme::MicrosoftAzure => store!(MicrosoftAzureBuilder, AzureConfigKey, "AZURE_", url),
        _ => Err("it is no store".to_owned()),
    };
    Ok((store?, place))
}

fn retry() -> RetryConfig {
    RetryConfig { max_retries: RETRIES, retry_timeout: RETRY_TIMEOUT, ..RetryConfig::default() }
}

/// The variables with this prefix, in lower case, as the keys of a store are named.
fn variables(prefix: &'static str) -> impl Iterator<Item = (String, String)> {
    // A variable that is no text concerns no store.
    std::env::vars_os()
        .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
        .filter(move |(name, _)| name.starts_with(prefix))
        .map(|(name, value)| (name.to_ascii_lowercase(), value))
}
