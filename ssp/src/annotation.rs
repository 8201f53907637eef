//! Our annotations: what a scenario has and SSP lacks. Local names begin with `Acroscope`, so that they can't be taken for
//! another tool's.

/// `type` of each `Annotation`.
pub(crate) const TYPE: &str = "org.acroscope";
/// The namespace.
pub(crate) const NAMESPACE: &str = "urn:acroscope:ssp:1";
/// On a component: `interval`, `offset`, `retry`, `isolate`, `step_limit`, `memory_limit`.
pub(crate) const UNIT: &str = "AcroscopeUnit";
/// On a connection: `latency`, `jitter`, `drop`, `hold`, `seed`.
pub(crate) const CONNECTION: &str = "AcroscopeConnection";
/// On the whole: `start`, `stop`, `algorithm`, `seed`, `record`; holds [`RECORD`], [`SOURCE`], [`REPORT`].
pub(crate) const EXPERIMENT: &str = "AcroscopeExperiment";
/// `name` and `value` of one of the algorithm's options.
pub(crate) const OPTION: &str = "AcroscopeOption";
/// `pattern` of what is recorded.
pub(crate) const RECORD: &str = "AcroscopeRecord";
/// A signal from outside: `to`, `kind`, and `type` with `value`, or `file` with `column`.
pub(crate) const SOURCE: &str = "AcroscopeSource";
/// `source`, the file with the table `[report]`.
pub(crate) const REPORT: &str = "AcroscopeReport";
