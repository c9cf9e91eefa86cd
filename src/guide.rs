//! The user's guide: one page a subject.
//!
//! | subject | page |
//! |---|---|
//! | rigs, grounds and the files of a run | [`scenarios`] |
//! | a rig's own records | [`measured_data`] |
//! | the class of wheel-terrain interaction | [`recognition`] |
//! | terrain parameters | [`identification`] |
//! | departures from the ideal rig | [`effects`] |
//! | why a rig and its simulation differ | [`diagnosis`], tried in [`blind_trials`] |
//! | many runs | [`studies`], on a [`cluster`], as [`data_sets`] |
//! | what is not modelled | [`limits`] |

#[doc = include_str!("guide/blind_trials.md")]
pub mod blind_trials {}
#[doc = include_str!("guide/cluster.md")]
pub mod cluster {}
#[doc = include_str!("guide/data_sets.md")]
pub mod data_sets {}
#[doc = include_str!("guide/diagnosis.md")]
pub mod diagnosis {}
#[doc = include_str!("guide/effects.md")]
pub mod effects {}
#[doc = include_str!("guide/identification.md")]
pub mod identification {}
#[doc = include_str!("guide/limits.md")]
pub mod limits {}
#[doc = include_str!("guide/measured_data.md")]
pub mod measured_data {}
#[doc = include_str!("guide/recognition.md")]
pub mod recognition {}
#[doc = include_str!("guide/scenarios.md")]
pub mod scenarios {}
#[doc = include_str!("guide/studies.md")]
pub mod studies {}
