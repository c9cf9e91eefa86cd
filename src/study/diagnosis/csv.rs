//! Diagnoses as CSV, a row a campaign.

use super::score::{CampaignScore, DiagnosisScore, Finding};
use crate::diagnosis::Answer;
use crate::study::cells::Number;
use crate::study::table::{Columns, bare, to_csv};
use serde::Serialize;

/// A campaign, see the [module](super::score).
#[derive(Serialize)]
struct CampaignRow<'s> {
    campaign: usize,
    scenario: &'s str,
    /// Values of the swept keys that all its runs share.
    shared: Vec<String>,
    runs: usize,
    truth: String,
    verdict: &'static str,
    named: String,
    right: Option<bool>,
    p_true: Number,
    /// Of none, parameter, unknown and undecided.
    probabilities: [Number; 4],
    effect: &'s str,
    /// Probability, magnitude and its interval.
    magnitude: [Number; 4],
    unit: &'s str,
    gaps: [Number; 4],
    /// Value and interval.
    closed: [Number; 3],
    reason: &'s str,
}

impl DiagnosisScore {
    /// One row for every campaign, see the [module](super::score).
    pub fn to_csv(&self) -> String {
        let shared = self.campaigns.first().map(|campaign| &campaign.shared);
        let keys = shared.into_iter().flatten().map(|(key, _)| [key.as_str()]);
        let columns = Columns::default()
            .with(["campaign", "scenario"])
            .list(keys)
            .with(["runs", "truth", "verdict", "named", "right", "p_true"])
            .with(["p_none", "p_parameter", "p_unknown", "p_undecided"])
            .with(["effect", "p_effect"])
            .with(["magnitude", "magnitude_low", "magnitude_high", "unit"])
            .with(["gap_as_shipped", "gap_recalibrated", "gap_with_effect"])
            .with(["gap_floor", "closed", "closed_low", "closed_high", "reason"]);
        to_csv(&columns, self.campaigns.iter().map(CampaignRow::of))
    }
}

impl<'s> CampaignRow<'s> {
    fn of(campaign: &'s CampaignScore) -> Self {
        let finding = campaign.finding();
        let effect = finding.and_then(Finding::likeliest);
        let gap = finding.and_then(|it| it.gap);
        let closed = finding.and_then(|it| it.closed);
        let magnitude = effect.map(|it| [it.probability, it.magnitude, it.ci95[0], it.ci95[1]]);
        let answers = [
            Answer::None,
            Answer::Parameter,
            Answer::Unknown,
            Answer::Undecided,
        ];
        Self {
            campaign: campaign.campaign,
            scenario: &campaign.scenario,
            shared: campaign.shared.iter().map(|(_, it)| bare(it)).collect(),
            runs: campaign.result.runs,
            truth: campaign.truth.to_string(),
            verdict: finding.map_or("", Finding::verdict),
            named: finding.map_or_else(String::new, Finding::named),
            right: campaign.is_right(),
            p_true: campaign.probability_of_truth().into(),
            probabilities: answers
                .map(|answer| finding.and_then(|it| it.probability(answer.name())).into()),
            effect: effect.map_or("", |it| &it.name),
            magnitude: Number::of_all(magnitude),
            unit: effect.map_or("", |it| &it.unit),
            gaps: Number::of_all(
                gap.map(|it| [it.as_shipped, it.recalibrated, it.with_effect, it.floor]),
            ),
            closed: Number::of_all(closed.map(|it| [it.value, it.ci95[0], it.ci95[1]])),
            reason: campaign.result.reason.as_deref().unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::score::Truth;
    use super::super::score::tests::campaign;
    use super::*;
    use crate::diagnosis::Answer;

    #[test]
    fn every_row_has_a_cell_for_every_column_with_and_without_an_answer() {
        let answered = campaign(Truth::None, Answer::None, &[]);
        let mut other = answered.clone();
        other.result.finding = None;
        other.result.reason = Some("1 s of driving, which is too little".to_owned());
        let campaigns = vec![answered, other];
        let text = DiagnosisScore { campaigns }.to_csv();
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap().len(), 27);
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(&rows[0][7], "true");
        assert_eq!(&rows[1][26], "1 s of driving, which is too little");
    }
}
