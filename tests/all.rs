//! What the library and the program promise, a subject a file. One binary: linking the library
//! once for each subject took half of a build of the tests.

mod chromium;
mod common;

mod any_scenario;
mod architecture;
mod challenge;
mod cli;
mod convergence;
mod diagnosis;
mod diagnosis_page;
mod ding2011;
mod effects;
mod every_ground;
mod faults;
mod feature_choices;
mod files;
mod gap;
mod ground_effects;
mod identification;
mod identify;
mod identify_claims;
mod import;
mod inspection;
mod inspection_faults;
mod investigation;
mod learning;
mod log_fuzz;
mod logs;
mod measured_soils;
mod outputs;
mod page_in_chromium;
mod physics;
mod read_with_h5py;
mod ready_studies;
mod recognition_faults;
mod recognize;
mod report;
mod scenarios;
mod slate_rig;
mod slurm;
mod steadiness;
mod study;
mod study_diagnosis;
mod thresholds;
mod vibration;
