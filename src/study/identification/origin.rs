//! Whose parameters predict a group.

use super::Plan;
use crate::study::Study;
use crate::study::group::Group;

impl Group {
    /// The group whose parameters predict this one: the same but for the keys of `from` and those
    /// that change together with them.
    pub(super) fn reference<'g>(
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
