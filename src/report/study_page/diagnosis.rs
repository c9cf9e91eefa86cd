//! What diagnoses make of the runs.

use super::{Drawing, Shown};
use crate::diagnosis::Answer;
use crate::report::page::{Cell, Column, Figure, Section, Table};
use crate::report::{CampaignBar, campaign_bars};
use crate::study::diagnosis::score::{CampaignScore, DiagnosisScore, Finding, Truth};

impl Shown for DiagnosisScore {
    fn stem(&self) -> Option<&'static str> {
        Some("diagnosis")
    }

    /// How many campaigns are answered rightly, and from where on an effect is named.
    fn answer(&self) -> String {
        let campaigns = &self.campaigns;
        let right = campaigns.iter().filter(|it| is_right(it)).count();
        let mut answer = format!(
            "{right} of {} campaigns are diagnosed correctly.",
            campaigns.len()
        );
        if let Some(named) = named_from(campaigns) {
            answer.push(' ');
            answer.push_str(&named);
        }
        let without = self.without_answer().count();
        if without > 0 {
            answer.push_str(&format!(" {without} cannot be diagnosed."));
        }
        answer
    }

    /// The answers, their probabilities, and the gaps.
    fn sections(&self) -> Vec<Section> {
        let figure = Figure::new(
            answers_by_campaign(self),
            "Probability of the true cause and of all other answers by campaign; at the right the answer, bold if correct.",
        );
        let section = Section::new("Diagnosis of the campaigns")
            .prose(
                "Each campaign is diagnosed like measured runs. The probability of an effect is that of its presence, \
                 alone or with another. Gaps are mean energy scores [standard deviations per statistic] on held-out \
                 conditions; closed is the share of the recalibrated gap that the most probable effect closes.",
            )
            .figure(figure)
            .table(answers(self));
        let without = self.without_answer().map(|campaign| {
            let reason = campaign.result.reason.as_deref().unwrap_or_default();
            vec![Cell::Text(campaign.place()), Cell::text(reason)]
        });
        let without = Table::of(["campaign", "reason"], without);
        vec![section.table(without.captioned("Campaigns without an answer"))]
    }

    fn drawings(&self) -> Vec<Drawing> {
        vec![Drawing::new("diagnosis.svg", answers_by_campaign(self))]
    }
}

fn is_right(campaign: &CampaignScore) -> bool {
    campaign.is_right() == Some(true)
}

/// From which magnitude on the one effect that is swept is named: whatever is above, is. None where
/// anything else is swept.
fn named_from(campaigns: &[CampaignScore]) -> Option<String> {
    let first = campaigns.first()?;
    let [(key, _)] = first.shared.as_slice() else {
        return None;
    };
    let effect = key.strip_prefix("effect.")?;
    if campaigns.iter().any(|it| it.scenario != first.scenario) {
        return None;
    }
    let magnitudes = campaigns
        .iter()
        .filter(|campaign| matches!(campaign.truth, Truth::Effects(_)));
    let magnitudes = magnitudes.map(|it| Some((it.shared[0].1.parse::<f64>().ok()?, is_right(it))));
    let mut magnitudes: Vec<(f64, bool)> = magnitudes.collect::<Option<_>>()?;
    magnitudes.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let named = magnitudes.iter().take_while(|(_, right)| *right);
    Some(match named.last() {
        Some((magnitude, _)) => format!("{effect} is named from {magnitude} on."),
        None => format!("{effect} is not named at its largest magnitude."),
    })
}

/// Probabilities of the truth and of all else, a bar a campaign.
fn answers_by_campaign(score: &DiagnosisScore) -> String {
    let bars: Vec<CampaignBar> = score.campaigns.iter().map(bar).collect();
    campaign_bars(&bars, "What explains the runs of each campaign")
}

fn bar(campaign: &CampaignScore) -> CampaignBar {
    CampaignBar {
        name: campaign.place(),
        probabilities: campaign.finding().map(|it| probabilities(campaign, it)),
        answer: campaign.answer(),
        is_right: is_right(campaign),
    }
}

/// Probabilities [-] of the truth, other effects, parameters, nothing, the unknown, and undecided; each
/// counts once.
fn probabilities(campaign: &CampaignScore, finding: &Finding) -> [f64; 6] {
    let truth = campaign.probability_of_truth().unwrap_or_default();
    let of = |answer: Answer, is_truth: bool| {
        if is_truth {
            0.0
        } else {
            finding.probability(answer.name()).unwrap_or_default()
        }
    };
    let parameter = of(Answer::Parameter, campaign.truth == Truth::Parameter);
    let none = of(Answer::None, campaign.truth == Truth::None);
    let unknown = of(Answer::Unknown, campaign.truth == Truth::Other);
    let undecided = of(Answer::Undecided, false);
    let effects = 1.0 - truth - parameter - none - unknown - undecided;
    [truth, effects.max(0.0), parameter, none, unknown, undecided]
}

fn answers(score: &DiagnosisScore) -> Table {
    let shared = score.campaigns.first().map(|campaign| &campaign.shared);
    let keys = shared.into_iter().flatten().map(|(key, _)| key.as_str());
    let names = ["scenario"].into_iter().chain(keys);
    let mut columns = Column::named(names.chain(["runs", "truth", "answer"]));
    columns.extend(Column::named([
        "P(truth)",
        "P(none)",
        "P(parameter)",
        "P(unknown)",
        "most probable effect",
        "P(effect)",
        "magnitude",
        "unit",
        "nominal gap",
        "recalibrated",
        "with effect",
        "floor",
    ]));
    columns.push(Column::new("closed", "%"));
    Table::of(columns, score.campaigns.iter().map(row)).captioned("Answers, with 95 % intervals")
}

fn row(campaign: &CampaignScore) -> Vec<Cell> {
    let finding = campaign.finding();
    let mut cells = vec![Cell::text(&campaign.scenario)];
    cells.extend(campaign.shared.iter().map(|(_, value)| Cell::toml(value)));
    cells.push(Cell::Count(campaign.result.runs as u64));
    cells.push(Cell::Text(campaign.truth.to_string()));
    cells.push(Cell::Text(campaign.answer()));
    cells.push(number(campaign.probability_of_truth()));
    let of = |answer: Answer| number(finding.and_then(|it| it.probability(answer.name())));
    cells.extend([Answer::None, Answer::Parameter, Answer::Unknown].map(of));
    match finding.and_then(Finding::likeliest) {
        Some(effect) => cells.extend([
            Cell::text(&effect.name),
            Cell::Number(effect.probability),
            Cell::Estimate(effect.magnitude, effect.ci95),
            Cell::text(&effect.unit),
        ]),
        None => cells.extend([Cell::Missing, Cell::Missing, Cell::Missing, Cell::Missing]),
    }
    let gap = finding.and_then(|it| it.gap);
    cells.extend([
        number(gap.map(|it| it.as_shipped)),
        number(gap.map(|it| it.recalibrated)),
        number(gap.map(|it| it.with_effect)),
        number(gap.map(|it| it.floor)),
    ]);
    let closed = finding.and_then(|it| it.closed);
    cells.push(closed.map_or(Cell::Missing, |closed| {
        let [low, high] = closed.ci95.map(|end| 100.0 * end);
        Cell::Estimate(100.0 * closed.value, [low, high])
    }));
    cells
}

fn number(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, Cell::Number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Answer;
    use crate::study::diagnosis::score::CampaignResult;

    /// A campaign with slip sinkage of a magnitude, which is named or read as parameters.
    fn campaign(magnitude: &str, is_named: bool) -> CampaignScore {
        let name = "slip_sinkage".to_owned();
        let named = if is_named {
            vec![vec![name.clone()]]
        } else {
            Vec::new()
        };
        let known = [("none", 0.25), ("parameter", 0.5), ("undecided", 0.125)];
        CampaignScore {
            campaign: 0,
            scenario: "sand".to_owned(),
            shared: vec![("effect.slip_sinkage".to_owned(), magnitude.to_owned())],
            truth: match magnitude {
                "0.0" => Truth::None,
                _ => Truth::Effects(vec![name]),
            },
            result: CampaignResult {
                runs: 8,
                reason: None,
                finding: Some(Finding {
                    verdict: if is_named {
                        Answer::Effect
                    } else {
                        Answer::Parameter
                    },
                    named,
                    probabilities: known.map(|(name, p)| (name.to_owned(), p)).into(),
                    effects: Vec::new(),
                    gap: None,
                    closed: None,
                }),
            },
        }
    }

    #[test]
    fn an_effect_is_named_from_where_all_larger_ones_are() {
        let answer_of = |campaigns| DiagnosisScore { campaigns }.answer();
        let some = vec![
            campaign("0.0", false),
            campaign("0.1", true),
            campaign("0.2", false),
            campaign("0.4", true),
            campaign("0.8", true),
        ];
        assert_eq!(
            answer_of(some),
            "3 of 5 campaigns are diagnosed correctly. slip_sinkage is named from 0.4 on."
        );
        let none = vec![campaign("0.1", true), campaign("0.2", false)];
        let text = answer_of(none);
        assert!(
            text.ends_with("slip_sinkage is not named at its largest magnitude."),
            "{text}"
        );
    }

    #[test]
    fn the_parts_of_a_bar_sum_to_one_whatever_is_so() {
        for magnitude in ["0.0", "0.8"] {
            let bar = bar(&campaign(magnitude, true));
            let parts = bar.probabilities.unwrap();
            assert_eq!(parts.iter().sum::<f64>(), 1.0, "{parts:?}");
        }
        let score = DiagnosisScore {
            campaigns: vec![campaign("0.0", false), campaign("0.8", true)],
        };
        let section = format!("{:?}", score.sections());
        assert!(section.contains("Diagnosis of the campaigns"));
    }
}
