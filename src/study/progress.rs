//! How far an execution of a study is.

/// How far a study is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Runs done, including those of reused shards.
    pub done: u64,
    /// Runs to do.
    pub total: u64,
    /// Runs that failed since this execution began.
    pub failed: u64,
    /// Where the diagnoses are, once all runs are done.
    pub diagnosing: Option<Diagnosing>,
}

/// How far the diagnoses of a study are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Diagnosing {
    /// Number of the campaign, from 0.
    pub campaign: usize,
    /// Campaigns.
    pub campaigns: usize,
    /// Steps done of its present stage.
    pub done: u64,
    /// Steps of that stage.
    pub total: u64,
}
