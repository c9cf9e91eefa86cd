//! Diagnoses as CSV, a row a campaign.

use super::score::{CampaignScore, DiagnosisScore, Finding};
use crate::study::table::{bare, cell, line};

/// Columns after those of the campaign's swept keys.
const COLUMNS: [&str; 24] = [
    "runs",
    "truth",
    "verdict",
    "named",
    "right",
    "p_true",
    "p_none",
    "p_parameter",
    "p_unknown",
    "p_undecided",
    "effect",
    "p_effect",
    "magnitude",
    "magnitude_low",
    "magnitude_high",
    "unit",
    "gap_as_shipped",
    "gap_recalibrated",
    "gap_with_effect",
    "gap_floor",
    "closed",
    "closed_low",
    "closed_high",
    "reason",
];

impl DiagnosisScore {
    /// One row for every campaign, see the [module](super::score).
    pub fn to_csv(&self) -> String {
        let shared = self.campaigns.first().map(|campaign| &campaign.shared);
        let keys = shared.into_iter().flatten().map(|(key, _)| key.as_str());
        let names = ["campaign", "scenario"].into_iter().chain(keys);
        let names = names.chain(COLUMNS).map(str::to_owned);
        let header = line(&names.collect::<Vec<_>>());
        let rows = self.campaigns.iter().map(|campaign| line(&cells(campaign)));
        std::iter::once(header).chain(rows).collect()
    }
}

fn cells(campaign: &CampaignScore) -> Vec<String> {
    let mut cells = vec![campaign.campaign.to_string(), campaign.scenario.clone()];
    cells.extend(campaign.shared.iter().map(|(_, value)| bare(value)));
    cells.push(campaign.result.runs.to_string());
    cells.push(campaign.truth.to_string());
    let finding = campaign.finding();
    let text = |of: fn(&Finding) -> String| finding.map_or_else(String::new, of);
    cells.push(text(|it| it.verdict().to_owned()));
    cells.push(text(Finding::named));
    let right = campaign.is_right();
    cells.push(right.map_or_else(String::new, |right| right.to_string()));
    cells.push(cell(campaign.probability_of_truth()));
    cells.extend(
        ["none", "parameter", "unknown", "undecided"]
            .map(|name| cell(finding.and_then(|it| it.probability(name)))),
    );
    cells.extend(likeliest(finding));
    cells.extend(distances(finding));
    cells.push(campaign.result.reason.clone().unwrap_or_default());
    cells
}

fn likeliest(finding: Option<&Finding>) -> Vec<String> {
    let Some(effect) = finding.and_then(Finding::likeliest) else {
        return vec![String::new(); 6];
    };
    let [low, high] = effect.ci95;
    let numbers = [effect.probability, effect.magnitude, low, high];
    let mut cells = vec![effect.name.clone()];
    cells.extend(numbers.map(|number| cell(Some(number))));
    cells.push(effect.unit.clone());
    cells
}

fn distances(finding: Option<&Finding>) -> [String; 7] {
    let gap = finding.and_then(|it| it.gap);
    let closed = finding.and_then(|it| it.closed);
    [
        gap.map(|it| it.as_shipped),
        gap.map(|it| it.recalibrated),
        gap.map(|it| it.with_effect),
        gap.map(|it| it.floor),
        closed.map(|it| it.value),
        closed.map(|it| it.ci95[0]),
        closed.map(|it| it.ci95[1]),
    ]
    .map(cell)
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
        assert_eq!(reader.headers().unwrap().len(), 3 + COLUMNS.len());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(&rows[0][7], "true");
        assert_eq!(&rows[1][26], "1 s of driving, which is too little");
    }
}
