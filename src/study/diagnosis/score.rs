//! What the diagnoses of a study came to.
//!
//! `diagnosis.csv` has a row for every campaign:
//!
//! | columns | hold |
//! |---|---|
//! | `campaign` | number from 0 |
//! | `scenario`, every swept key not joined | its runs |
//! | `runs` | runs that did not fail |
//! | `truth` | what the runs have beyond what they were held against: `none`, `parameter`, effects joined by `and`, `other` |
//! | `verdict`, `named` | the answer; effects that cannot be distinguished are joined by `or`, several by `and` |
//! | `right` | whether that is the truth: `true` or `false` |
//! | `p_true` | probability [-] of the truth; of an effect, that it is there, alone or with another |
//! | `p_none`, `p_parameter`, `p_unknown`, `p_undecided` | probabilities [-] |
//! | `effect`, `p_effect` | the likeliest effect, and the probability [-] that it is there |
//! | `magnitude`, `magnitude_low`, `magnitude_high`, `unit` | its magnitude with its 95 % interval; empty where unbounded |
//! | `gap_as_shipped`, `gap_recalibrated`, `gap_with_effect`, `gap_floor` | mean energy scores [spreads of replicates per statistic] on held-out conditions |
//! | `closed`, `closed_low`, `closed_high` | share [-] of the recalibrated gap that the effect closes, with its 95 % interval |
//! | `reason` | why there is no answer; empty where there is |

use crate::diagnosis::{Answer, Diagnosis, Gaps};
use crate::gap::Closed;
use crate::study::table::bare;
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// What the diagnoses of a study came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiagnosisScore {
    /// Every campaign.
    pub campaigns: Vec<CampaignScore>,
}

/// A campaign and its diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CampaignScore {
    /// Number, from 0.
    pub campaign: usize,
    /// The scenario of its runs.
    pub scenario: String,
    /// Swept keys that all its runs share, and their values as TOML.
    pub shared: Vec<(String, String)>,
    /// What its runs have beyond what they were held against.
    pub truth: Truth,
    /// What came of it.
    #[serde(flatten)]
    pub result: CampaignResult,
}

/// What runs have that they are not known to have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Truth {
    /// Nothing.
    None,
    /// Parameters off the values that they are held to have.
    Parameter,
    /// Effects, by name with the channel.
    Effects(Vec<String>),
    /// Something that is neither effect nor parameter.
    Other,
}

/// `none`, `parameter`, effects joined by `and`, `other`.
impl fmt::Display for Truth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Parameter => f.write_str("parameter"),
            Self::Effects(names) => f.write_str(&names.join(" and ")),
            Self::Other => f.write_str("other"),
        }
    }
}

impl Serialize for Truth {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// What came of a campaign: an answer, or the reason why there is none.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CampaignResult {
    /// Runs that did not fail.
    pub runs: usize,
    /// Why there is no answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finding: Option<Finding>,
}

/// What a diagnosis answered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What explains the runs.
    pub verdict: Answer,
    /// The effect or effects of the verdict, each with those that the runs cannot distinguish from it.
    pub named: Vec<Vec<String>>,
    /// Probability [-] of `none`, `parameter`, `unknown`, `undecided`, each effect and each pair
    /// (`e+f`); they sum to one.
    pub probabilities: BTreeMap<String, f64>,
    /// The effects that were tried, likeliest first.
    pub effects: Vec<FoundEffect>,
    /// How far apart runs and simulation are; none without effects to try.
    pub gap: Option<Gaps>,
    /// Share [-] of the recalibrated gap that the likeliest effect or effects close.
    pub closed: Option<Closed>,
}

/// An effect that may be the cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoundEffect {
    /// Name with the channel.
    pub name: String,
    /// Probability [-] that it is there, alone or with another.
    pub probability: f64,
    /// Magnitude where it is there, in `unit`.
    pub magnitude: f64,
    /// 95 % interval of the magnitude, in `unit`.
    pub ci95: [f64; 2],
    /// Unit of the magnitude; `-` where it has none.
    pub unit: String,
}

impl DiagnosisScore {
    /// Campaigns without an answer.
    pub fn without_answer(&self) -> impl Iterator<Item = &CampaignScore> {
        let all = self.campaigns.iter();
        all.filter(|campaign| campaign.result.finding.is_none())
    }
}

impl CampaignScore {
    /// Its scenario and the values of its swept keys.
    pub fn place(&self) -> String {
        let values = self.shared.iter();
        let values = values.map(|(key, value)| format!(", {key} = {}", bare(value)));
        std::iter::once(self.scenario.clone())
            .chain(values)
            .collect()
    }

    /// Its verdict and what that names, in a few words.
    pub fn answer(&self) -> String {
        let Some(finding) = self.finding() else {
            return "no answer".to_owned();
        };
        if finding.named.is_empty() {
            finding.verdict().to_owned()
        } else {
            finding.named()
        }
    }

    /// The answer, where there is one.
    pub fn finding(&self) -> Option<&Finding> {
        self.result.finding.as_ref()
    }

    /// Whether the answer is the truth: with effects, whether it names them, or what the runs cannot
    /// distinguish from them, and no others. None without an answer.
    pub fn is_right(&self) -> Option<bool> {
        let Finding { verdict, named, .. } = self.finding()?;
        Some(match &self.truth {
            Truth::None => *verdict == Answer::None,
            Truth::Parameter => *verdict == Answer::Parameter,
            Truth::Other => *verdict == Answer::Unknown,
            Truth::Effects(effects) => {
                let is_named = |effect| named.iter().any(|set| set.contains(effect));
                effects.len() == named.len() && effects.iter().all(is_named)
            }
        })
    }

    /// Probability [-] of the truth: of one effect, that it is there, alone or with another. None
    /// without an answer, and of effects that were not tried.
    pub fn probability_of_truth(&self) -> Option<f64> {
        let finding = self.finding()?;
        match &self.truth {
            Truth::None => finding.probability("none"),
            Truth::Parameter => finding.probability("parameter"),
            Truth::Other => finding.probability("unknown"),
            Truth::Effects(names) => match names.as_slice() {
                [one] => {
                    let mut effects = finding.effects.iter();
                    let found = effects.find(|effect| effect.name == *one);
                    found.map(|effect| effect.probability)
                }
                [a, b] => [[a, b], [b, a]]
                    .iter()
                    .find_map(|[a, b]| finding.probability(&format!("{a}+{b}"))),
                _ => None,
            },
        }
    }
}

impl Finding {
    pub(super) fn of(diagnosis: &Diagnosis) -> Self {
        let verdict = &diagnosis.verdict;
        let effects = verdict.effects.iter().map(|effect| FoundEffect {
            name: effect.name.clone(),
            probability: effect.probability,
            magnitude: effect.magnitude,
            ci95: effect.ci95,
            unit: effect.unit.to_owned(),
        });
        Self {
            verdict: verdict.verdict,
            named: verdict.named.clone(),
            probabilities: verdict.probabilities.clone(),
            effects: effects.collect(),
            gap: diagnosis.gap,
            closed: diagnosis.closed,
        }
    }

    /// Probability [-] of `none`, `parameter`, `unknown`, `undecided`, an effect alone or a pair
    /// (`e+f`); none where it was not tried.
    pub fn probability(&self, explanation: &str) -> Option<f64> {
        self.probabilities.get(explanation).copied()
    }

    /// The likeliest effect; none where none was tried.
    pub fn likeliest(&self) -> Option<&FoundEffect> {
        self.effects.first()
    }

    /// The verdict in a word.
    pub fn verdict(&self) -> &'static str {
        self.verdict.name()
    }

    /// What is named: effects that cannot be distinguished joined by `or`, several by `and`; empty where
    /// nothing is.
    pub fn named(&self) -> String {
        let sets = self.named.iter().map(|set| set.join(" or "));
        sets.collect::<Vec<_>>().join(" and ")
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn campaign(truth: Truth, verdict: Answer, named: &[&[&str]]) -> CampaignScore {
        let named = named.iter().map(|set| set.iter().map(|&it| it.to_owned()));
        let effect = FoundEffect {
            name: "slip_sinkage".to_owned(),
            probability: 0.75,
            magnitude: 0.5,
            ci95: [0.25, f64::INFINITY],
            unit: "-".to_owned(),
        };
        let probabilities = [
            ("none", 0.125),
            ("slip_sinkage", 0.5),
            ("slope+slip_sinkage", 0.25),
        ];
        let probabilities = probabilities.map(|(name, p)| (name.to_owned(), p));
        CampaignScore {
            campaign: 0,
            scenario: "sand".to_owned(),
            shared: vec![("effect.slip_sinkage".to_owned(), "0.4".to_owned())],
            truth,
            result: CampaignResult {
                runs: 6,
                reason: None,
                finding: Some(Finding {
                    verdict,
                    named: named.map(Iterator::collect).collect(),
                    probabilities: probabilities.into(),
                    effects: vec![effect],
                    gap: None,
                    closed: None,
                }),
            },
        }
    }

    fn effects(names: &[&str]) -> Truth {
        Truth::Effects(names.iter().map(|&name| name.to_owned()).collect())
    }

    #[test]
    fn an_answer_is_right_where_it_names_all_that_is_withheld_and_no_more() {
        let one = effects(&["slip_sinkage"]);
        let is_right = |truth: &Truth, verdict, named: &[&[&str]]| {
            campaign(truth.clone(), verdict, named).is_right().unwrap()
        };
        let alike: &[&str] = &["slope", "slip_sinkage"];
        assert!(is_right(&one, Answer::Effect, &[alike]));
        assert!(!is_right(&one, Answer::Effect, &[&["slope"]]));
        assert!(!is_right(
            &one,
            Answer::Effects,
            &[alike, &["low_pass.normal_force"]]
        ));
        assert!(!is_right(&one, Answer::Parameter, &[]));
        assert!(is_right(&Truth::None, Answer::None, &[]));
        assert!(is_right(&Truth::Other, Answer::Unknown, &[]));
    }

    #[test]
    fn the_truth_of_two_effects_is_as_probable_as_their_pair_in_either_order() {
        let p = |truth| campaign(truth, Answer::Undecided, &[]).probability_of_truth();
        assert_eq!(p(effects(&["slip_sinkage", "slope"])), Some(0.25));
        assert_eq!(p(effects(&["slip_sinkage"])), Some(0.75));
        assert_eq!(p(effects(&["bulldozing"])), None);
        assert_eq!(p(Truth::None), Some(0.125));
    }
}
