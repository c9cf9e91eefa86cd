//! Every campaign of a study diagnosed, one after the other.

use super::Plan;
use super::campaign;
use super::score::{CampaignScore, DiagnosisScore, Finding, Told};
use super::truth;
use crate::diagnosis::condition::LONGEST;
use crate::diagnosis::inference::BaseRates;
use crate::diagnosis::rigs::Origin;
use crate::diagnosis::{self, Investigation, InvestigationError, Settings};
use crate::study::execution::said;
use crate::study::folder::Folder;
use crate::study::group::{self, Group};
use crate::study::shard::{self, Shard, opened, sealed};
use crate::study::{Diagnosing, Study, StudyError};
use crate::trace::Trace;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The folder of simulated statistics.
const BANK: &str = "bank";

/// The folder of what is told of each campaign.
const ANSWERS: &str = "diagnoses";

/// Hears how far the diagnoses are; a `Break` stops them.
pub(in crate::study) type Hear<'h> = &'h (dyn Fn(Diagnosing) -> ControlFlow<()> + Sync);

impl Study {
    /// Diagnoses every campaign that has no answer in the folder, where the study asks for it, on the
    /// threads of the pool that this is called in. No shard is missing.
    ///
    /// # Errors
    /// `StoppedDiagnosing`; `Dataset` where the runs of a shard cannot be read; `File` and `Diagnosis`
    /// where the file system refuses. A campaign that cannot be diagnosed is none: its reason is told.
    pub(in crate::study) fn diagnose(
        &self,
        folder: &Folder,
        hear: Hear,
    ) -> Result<Option<DiagnosisScore>, StudyError> {
        let Some(plan) = &self.diagnosis else {
            return Ok(None);
        };
        folder.make(ANSWERS)?;
        let shards = shard::all(self);
        let groups = group::all(self, &plan.over);
        let asking = Asking {
            study: self,
            plan,
            folder,
            shards: &shards,
            campaigns: groups.len(),
            hear,
        };
        let numbered = groups.iter().enumerate();
        let campaigns = numbered.map(|(number, group)| asking.score(number, group));
        let campaigns = campaigns.collect::<Result<_, _>>()?;
        Ok(Some(DiagnosisScore { campaigns }))
    }
}

struct Asking<'s> {
    study: &'s Study,
    plan: &'s Plan,
    folder: &'s Folder,
    shards: &'s [Shard],
    campaigns: usize,
    hear: Hear<'s>,
}

impl Asking<'_> {
    fn score(&self, number: usize, group: &Group) -> Result<CampaignScore, StudyError> {
        let runs = self.study.scenario_of(group.conditions[0]);
        let against = self.plan.against(&group.scenario);
        Ok(CampaignScore {
            campaign: number,
            scenario: group.scenario.clone(),
            shared: group.shared.clone(),
            truth: truth::of(&runs, against),
            told: self.told(number, group)?,
        })
    }

    /// What is told of a campaign: what is in the folder, or else what comes of it now. Either way it is
    /// read from its text, so that both are the same.
    fn told(&self, number: usize, group: &Group) -> Result<Told, StudyError> {
        let name = format!("{ANSWERS}/{number:05}.toml");
        let heading = format!(
            "# lugwheel campaign {number}, study {}\n",
            self.folder.fingerprint()
        );
        let read = |text: &str| toml::from_str::<Told>(opened(&heading, text)?).ok();
        let known = std::fs::read_to_string(self.folder.path_of(&name));
        if let Some(told) = known.ok().as_deref().and_then(read) {
            return Ok(told);
        }
        let told = self.ask(number, group)?;
        let text = toml::to_string(&told).expect("it holds tables, numbers and names only");
        let text = sealed(&heading, &text);
        self.folder.write(&name, text.as_bytes())?;
        Ok(read(&text).expect("it was written above"))
    }

    fn ask(&self, number: usize, group: &Group) -> Result<Told, StudyError> {
        let at = (self.folder, self.shards);
        let measured = campaign::measured(self.study, at, group)?;
        let runs = measured.len();
        let against = AssertUnwindSafe(|| self.finding(number, group, measured));
        let found = catch_unwind(against)
            .unwrap_or_else(|panic| Err(Halt::Failed(format!("it panicked: {}", said(&*panic)))));
        match found {
            Ok(finding) => Ok(Told {
                runs,
                reason: None,
                finding: Some(finding),
            }),
            Err(Halt::Failed(reason)) => Ok(Told {
                runs,
                reason: Some(reason),
                finding: None,
            }),
            Err(Halt::Refused(error)) => Err(error.into()),
            Err(Halt::Stopped) => Err(StudyError::StoppedDiagnosing {
                answered: number,
                campaigns: self.campaigns,
            }),
        }
    }

    fn finding(&self, number: usize, group: &Group, measured: Vec<Trace>) -> Result<Finding, Halt> {
        let settings = Settings {
            longest: LONGEST,
            budget: self.plan.budget,
            without: self.plan.without.clone(),
            seed: self.study.seed,
            rates: BaseRates::default(),
            // The runs are simulated.
            discrepancy: 0.0,
        };
        let bank = self.folder.path_of(BANK);
        let origin = Origin {
            folder: &bank,
            version: env!("CARGO_PKG_VERSION"),
            seed: settings.seed,
        };
        let against = self.plan.against(&group.scenario);
        let investigation = Investigation::new(&measured, against, &settings, origin)?;
        // Its statistics are taken.
        drop(measured);
        let hear = |now: diagnosis::Progress| {
            (self.hear)(Diagnosing {
                campaign: number,
                campaigns: self.campaigns,
                done: now.done,
                total: now.total,
            })
        };
        let (diagnosis, _) = investigation.run(&hear)?;
        Ok(Finding::of(&diagnosis))
    }
}

/// Why a campaign has no answer.
enum Halt {
    Stopped,
    Refused(InvestigationError),
    Failed(String),
}

impl From<InvestigationError> for Halt {
    fn from(error: InvestigationError) -> Self {
        match error {
            stopped if stopped.is_stopped() => Self::Stopped,
            refused if refused.is_refused() => Self::Refused(refused),
            other => Self::Failed(other.to_string()),
        }
    }
}
