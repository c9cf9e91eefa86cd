//! The user's guide: one page a subject.
//!
//! | subject | page |
//! |---|---|
//! | rigs, grounds and the files of a run | [`scenarios`] |
//! | a rig's own records | [`measured_data`] |
//! | a run to look at | [`figures`] |
//! | the class of wheel-terrain interaction | [`recognition`] |
//! | terrain parameters | [`identification`] |
//! | departures from the ideal rig | [`effects`] |
//! | why a rig and its simulation differ | [`diagnosis`], tried in [`blind_trials`] |
//! | many runs | [`studies`], on a [`cluster`], as [`data_sets`] |
//! | what is not modelled | [`limits`] |

/// A page. Of two definitions of a link the first counts: here those of rustdoc, on other readers those at the page's end.
macro_rules! page {
    ($name:ident) => {
        #[doc = "[blind_trials]: crate::guide::blind_trials"]
        #[doc = "[cluster]: crate::guide::cluster"]
        #[doc = "[data_sets]: crate::guide::data_sets"]
        #[doc = "[diagnosis]: crate::guide::diagnosis"]
        #[doc = "[effects]: crate::guide::effects"]
        #[doc = "[figures]: crate::guide::figures"]
        #[doc = "[identification]: crate::guide::identification"]
        #[doc = "[limits]: crate::guide::limits"]
        #[doc = "[measured_data]: crate::guide::measured_data"]
        #[doc = "[recognition]: crate::guide::recognition"]
        #[doc = "[scenarios]: crate::guide::scenarios"]
        #[doc = "[studies]: crate::guide::studies"]
        #[doc = ""]
        #[doc = include_str!(concat!("guide/", stringify!($name), ".md"))]
        pub mod $name {}
    };
}

page!(blind_trials);
page!(cluster);
page!(data_sets);
page!(diagnosis);
page!(effects);
page!(figures);
page!(identification);
page!(limits);
page!(measured_data);
page!(recognition);
page!(scenarios);
page!(studies);
