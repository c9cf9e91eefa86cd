//! Diagnoses as text for reading.

use super::score::{CampaignScore, DiagnosisScore, Finding};
use crate::study::table::bare;
use crate::table::{Cell, Table};
use crate::trace::behind_number;
use std::fmt;

/// Names of the columns.
const COLUMNS: [&str; 7] = [
    "campaign",
    "runs",
    "truth",
    "answer",
    "P [%]",
    "most probable effect",
    "closed [%]",
];

impl fmt::Display for DiagnosisScore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let right = self
            .campaigns
            .iter()
            .filter(|it| it.is_right() == Some(true));
        writeln!(
            f,
            "{} campaigns, {} answered correctly, {} without an answer. P: posterior probability of the true cause;\n\
             of an effect, that it is present, alone or with another. Closed: share of the recalibrated gap that the\n\
             most probable effect closes. In brackets 95 % intervals.\n",
            self.campaigns.len(),
            right.count(),
            self.without_answer().count()
        )?;
        let table = Table::of(COLUMNS, self.campaigns.iter().map(cells));
        f.write_str(&table.to_text(2))?;
        let mut without = self.without_answer().peekable();
        if without.peek().is_some() {
            writeln!(f, "\nNo answer:")?;
        }
        without.try_for_each(|campaign| {
            let reason = campaign.result.reason.as_deref().unwrap_or_default();
            writeln!(f, "  {}: {reason}", campaign.place())
        })
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
}

fn cells(campaign: &CampaignScore) -> Vec<Cell> {
    let percent = |share: f64| format!("{:.0}", 100.0 * share);
    let p = campaign.probability_of_truth();
    let finding = campaign.finding();
    let closed = finding.and_then(|it| it.closed).map(|closed| {
        let [value, low, high] = [closed.value, closed.ci95[0], closed.ci95[1]].map(percent);
        format!("{value} [{low}, {high}]")
    });
    [
        campaign.place(),
        campaign.result.runs.to_string(),
        campaign.truth.to_string(),
        campaign.answer(),
        p.map_or_else(String::new, percent),
        finding.and_then(effect).unwrap_or_default(),
        closed.unwrap_or_default(),
    ]
    .map(Cell::Text)
    .to_vec()
}

/// The likeliest effect with its magnitude.
fn effect(finding: &Finding) -> Option<String> {
    let effect = finding.likeliest()?;
    let [low, high] = effect.ci95;
    let unit = behind_number(&effect.unit);
    Some(format!(
        "{} {:.3}{unit} [{low:.3}, {high:.3}], {:.0} %",
        effect.name,
        effect.magnitude,
        100.0 * effect.probability
    ))
}

#[cfg(test)]
mod tests {
    use super::super::score::Truth;
    use super::super::score::tests::campaign;
    use super::*;
    use crate::diagnosis::Answer;

    #[test]
    fn the_table_has_a_line_a_campaign_and_the_reasons_of_those_without_an_answer() {
        let truth = Truth::Effects(vec!["slip_sinkage".to_owned()]);
        let answered = campaign(truth, Answer::Effect, &[&["slip_sinkage", "slope"]]);
        let mut other = answered.clone();
        other.result.finding = None;
        other.result.reason = Some("too little driving".to_owned());
        let campaigns = vec![answered, other];
        let text = DiagnosisScore { campaigns }.to_string();
        assert!(text.starts_with("2 campaigns, 1 answered correctly, 1 without an answer."));
        let row = text.lines().find(|line| line.contains("[0.250, inf]"));
        let expected =
            "sand, effect.slip_sinkage = 0.4  6     slip_sinkage  slip_sinkage or slope  75";
        assert!(row.unwrap().trim_start().starts_with(expected), "{text}");
        assert!(text.ends_with("sand, effect.slip_sinkage = 0.4: too little driving\n"));
    }
}
