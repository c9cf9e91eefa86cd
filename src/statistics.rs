//! Statistics of samples: moments, quantiles by definition, shares, intervals.
//!
//! A quantile of few values depends on its definition, and so do published numbers: every definition has a function
//! of its own, named by it (Hyndman and Fan 1996, Am. Stat. 50:361-365).

mod bootstrap;
mod moments;
mod quantile;
mod share;
mod student;

pub use bootstrap::bootstrap;
pub use moments::{batch_means_error, finite_mean, mean, mean_and_variance, standard_deviation};
pub use quantile::{
    median, normal_quantile, quantile_interval, quantile_linear, quantile_nearest_place,
    quantile_nearest_rank, quantile_upper, sorted, upper_median,
};
pub use share::Share;
pub use student::student_quantile;
