//! Findings of one run, as they are made.

use super::{Finding, Severity};
use crate::trace::Trace;

/// Findings of one run, as they are made.
pub(super) struct Doubts {
    run: String,
    simulated: bool,
    findings: Vec<Finding>,
}

impl Doubts {
    /// None yet, on a run of which nothing is known.
    pub(super) fn of(run: &str) -> Self {
        Self {
            run: run.to_owned(),
            simulated: false,
            findings: Vec::new(),
        }
    }

    /// No findings yet. A simulated run has correct labels and signs: its findings are observations only,
    /// without a possible cause, and are no errors.
    pub(super) fn of_trace(run: &str, trace: &Trace) -> Self {
        Self {
            simulated: trace.is_simulated(),
            ..Self::of(run)
        }
    }

    /// Adds the observation `seen` on the run as a whole, and a possible cause `guess`.
    pub(super) fn run(&mut self, severity: Severity, seen: &str, guess: &str) {
        self.add(None, severity, seen, guess);
    }

    /// Adds the observation `seen` on a channel, and a possible cause `guess`.
    pub(super) fn channel(&mut self, channel: &str, severity: Severity, seen: &str, guess: &str) {
        self.add(Some(channel.to_owned()), severity, seen, guess);
    }

    /// Whether one of these channels has a finding that is more than a remark.
    pub(super) fn has_any(&self, channels: &[&str]) -> bool {
        let doubts = self.findings.iter().filter(|f| f.severity > Severity::Info);
        let mut names = doubts.filter_map(|finding| finding.channel.as_deref());
        names.any(|name| channels.contains(&name))
    }

    pub(super) fn into_findings(self) -> Vec<Finding> {
        self.findings
    }

    fn add(&mut self, channel: Option<String>, severity: Severity, seen: &str, guess: &str) {
        let explained = !guess.is_empty() && !self.simulated;
        let message = if explained {
            format!("{seen}: {guess}")
        } else {
            seen.to_owned()
        };
        let severity = if self.simulated {
            severity.min(Severity::Warning)
        } else {
            severity
        };
        self.findings.push(Finding {
            run: self.run.clone(),
            channel,
            severity,
            message,
        });
    }
}
