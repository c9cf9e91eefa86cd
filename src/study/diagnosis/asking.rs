//! Every campaign of a study diagnosed, one after the other.

use super::Plan;
use super::campaign;
use super::score::{CampaignResult, CampaignScore, DiagnosisScore, Finding};
use super::truth;
use crate::diagnosis::condition::LONGEST;
use crate::diagnosis::inference::BaseRates;
use crate::diagnosis::rigs::Origin;
use crate::diagnosis::{self, Investigation, InvestigationError, Settings};
use crate::scenario::caught::caught;
use crate::study::analysis::Finished;
use crate::study::group::{self, Group};
use crate::study::shard::{opened, sealed};
use crate::study::{Diagnosing, StudyError};
use crate::trace::Trace;

/// The folder of simulated statistics.
const BANK: &str = "bank";

/// The folder of the results of each campaign.
const ANSWERS: &str = "diagnoses";

/// Diagnoses every campaign that has no answer in the folder, on the threads of the pool that this is called in.
///
/// # Errors
/// `StoppedDiagnosing`; `Dataset` where the runs of a shard cannot be read; `File` and `Diagnosis`
/// where the file system refuses. A campaign that cannot be diagnosed is no error: its reason is stored.
pub(super) fn score(plan: &Plan, done: &Finished) -> Result<DiagnosisScore, StudyError> {
    done.folder.make(ANSWERS)?;
    let groups = group::all(done.study, &plan.over);
    let asking = Asking {
        done,
        plan,
        campaigns: groups.len(),
    };
    let numbered = groups.iter().enumerate();
    let campaigns = numbered.map(|(number, group)| asking.score(number, group));
    let campaigns = campaigns.collect::<Result<_, _>>()?;
    Ok(DiagnosisScore { campaigns })
}

struct Asking<'s> {
    done: &'s Finished<'s>,
    plan: &'s Plan,
    campaigns: usize,
}

impl Asking<'_> {
    fn score(&self, number: usize, group: &Group) -> Result<CampaignScore, StudyError> {
        let runs = self.done.study.scenario_of(group.conditions[0]);
        let against = self.plan.against(&group.scenario);
        Ok(CampaignScore {
            campaign: number,
            scenario: group.scenario.clone(),
            shared: group.shared.clone(),
            truth: truth::of(&runs, against),
            result: self.result(number, group)?,
        })
    }

    /// The result of a campaign: that in the folder, or else a new one. Either way it is
    /// read from its text, so that both are the same.
    fn result(&self, number: usize, group: &Group) -> Result<CampaignResult, StudyError> {
        let name = format!("{ANSWERS}/{number:05}.toml");
        let heading = format!(
            "# lugwheel campaign {number}, study {}\n",
            self.done.folder.fingerprint()
        );
        let read = |text: &str| toml::from_str::<CampaignResult>(opened(&heading, text)?).ok();
        let known = std::fs::read_to_string(self.done.folder.path_of(&name));
        if let Some(result) = known.ok().as_deref().and_then(read) {
            return Ok(result);
        }
        let result = self.ask(number, group)?;
        let text = toml::to_string(&result).expect("it holds tables, numbers and names only");
        let text = sealed(&heading, &text);
        self.done.folder.write(&name, text.as_bytes())?;
        Ok(read(&text).expect("it was written above"))
    }

    fn ask(&self, number: usize, group: &Group) -> Result<CampaignResult, StudyError> {
        let measured = campaign::measured(self.done, group)?;
        let runs = measured.len();
        match caught(|| self.finding(number, group, measured), Halt::Failed) {
            Ok(finding) => Ok(CampaignResult {
                runs,
                reason: None,
                finding: Some(finding),
            }),
            Err(Halt::Failed(reason)) => Ok(CampaignResult {
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
            seed: self.done.study.seed,
            rates: BaseRates::default(),
            // The runs are simulated.
            discrepancy: 0.0,
            ablation: None,
            without_next_run: false,
        };
        let bank = self.done.folder.path_of(BANK);
        let origin = Origin {
            folder: &bank,
            version: env!("CARGO_PKG_VERSION"),
            seed: settings.seed,
        };
        let against = self.plan.against(&group.scenario);
        let investigation = Investigation::new(&measured, against, &settings, origin)?;
        // Its statistics are taken.
        drop(measured);
        let on_progress = |now: diagnosis::Progress| {
            (self.done.on_progress)(Some(Diagnosing {
                campaign: number,
                campaigns: self.campaigns,
                done: now.done,
                total: now.total,
            }))
        };
        let (diagnosis, _) = investigation.run(&on_progress)?;
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
