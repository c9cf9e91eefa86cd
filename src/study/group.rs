//! Which conditions of a study belong together: those that differ in some keys only.

use super::Study;

/// Conditions that belong together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    /// Name of the scenario.
    pub scenario: String,
    /// Swept keys that do not change within the group, and their values as TOML.
    pub shared: Vec<(String, String)>,
    /// Numbers of its conditions.
    pub conditions: Vec<u64>,
}

/// The conditions that differ in the keys of `over` only, in the order of the first ones.
pub(super) fn all(study: &Study, over: &[String]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for condition in 0..study.condition_count() {
        let (scenario, mut shared) = place(study, condition);
        shared.retain(|(key, _)| !over.contains(key));
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

/// Refuses keys that no group can join, for this reason where one is not swept.
pub(super) fn check_over(study: &Study, over: &[String], not_swept: &str) -> Result<(), String> {
    if over.is_empty() {
        return Err("name a swept key or more, the slip for one".to_owned());
    }
    for (index, key) in over.iter().enumerate() {
        if study.values_of(key).is_none() {
            return Err(format!(
                "`{key}` is not swept, and {not_swept}; {}",
                swept(study)
            ));
        }
        if over[..index].contains(key) {
            return Err(format!("`{key}` is named twice"));
        }
    }
    Ok(())
}

/// The slip, the default key joined by groups.
pub(super) fn slip_of(study: &Study) -> Vec<String> {
    vec![format!("{}.slip", study.scenario_of(0).rig.path())]
}

/// The swept keys, for a message.
pub(super) fn swept(study: &Study) -> String {
    let keys: Vec<&str> = study.keys().collect();
    match keys.as_slice() {
        [] => "nothing is swept".to_owned(),
        keys => format!("swept are `{}`", keys.join("`, `")),
    }
}
