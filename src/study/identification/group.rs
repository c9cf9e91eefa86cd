//! Which conditions of a study belong to one fit.

use super::Plan;
use crate::study::Study;

/// The conditions whose rows one fit joins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    /// Name of the scenario.
    pub scenario: String,
    /// Swept keys that do not change within the group, and their values as TOML.
    pub shared: Vec<(String, String)>,
    /// Numbers of its conditions.
    pub conditions: Vec<u64>,
}

/// The groups of a study, in the order of their first conditions.
pub(super) fn all(study: &Study, plan: &Plan) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for condition in 0..study.condition_count() {
        let (scenario, mut shared) = place(study, condition);
        shared.retain(|(key, _)| !plan.over.contains(key));
        let known = groups
            .iter_mut()
            .find(|group| group.scenario == scenario && group.shared == shared);
        match known {
            Some(group) => group.conditions.push(condition),
            None => groups.push(Group {
                scenario,
                shared,
                conditions: vec![condition],
            }),
        }
    }
    groups
}

/// The scenario of a condition, and the swept keys with their values.
fn place(study: &Study, condition: u64) -> (String, Vec<(String, String)>) {
    let (named, entries) = study.condition(condition);
    let rows = study.sweeps.iter().zip(entries);
    let values = rows.flat_map(|(sweep, entry)| sweep.keys.iter().zip(&sweep.rows[entry]));
    let values = values.map(|(key, value)| (key.clone(), value.clone()));
    (named.name.clone(), values.collect())
}

/// The value of a swept key in a condition, as TOML.
pub(super) fn value_in(study: &Study, condition: u64, key: &str) -> Option<String> {
    let (_, values) = place(study, condition);
    let found = values.into_iter().find(|(swept, _)| swept == key);
    found.map(|(_, value)| value)
}

impl Group {
    /// The group whose parameters predict this one: the same but for the keys of `from` and those
    /// that change together with them.
    pub fn reference<'g>(
        &self,
        study: &Study,
        plan: &Plan,
        groups: &'g [Self],
    ) -> Option<&'g Self> {
        let from = &plan.from;
        let sweeps = study.sweeps.iter();
        let moved: Vec<&String> = sweeps
            .filter(|sweep| from.iter().any(|(key, _)| sweep.keys.contains(key)))
            .flat_map(|sweep| &sweep.keys)
            .collect();
        let agrees = |(key, value): &(String, String)| {
            let wanted = from.iter().find(|(named, _)| named == key);
            match wanted {
                Some((_, wanted)) => wanted == value,
                None => moved.contains(&key) || self.shared.contains(&(key.clone(), value.clone())),
            }
        };
        let found = groups
            .iter()
            .find(|group| group.scenario == self.scenario && group.shared.iter().all(agrees));
        found.filter(|group| !from.is_empty() && *group != self)
    }
}
