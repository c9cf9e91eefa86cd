//! Pooled uncertainties of similar rows.

use super::row::{SteadyLoad, Uncertainty};

/// Pools the uncertainties of rows cut from time series: root mean square for slip and sinkage; for the
/// forces the root mean square of their ratios to the load.
///
/// A spread from eight blocks is itself uncertain by a quarter. On loose stones it is also correlated with
/// the value: an interval with few resisting stones has less pull and less scatter, so weights from
/// individual spreads would bias every fit towards such intervals. Rows without uncertainties are not
/// changed.
pub fn pool(rows: &mut [&mut SteadyLoad]) {
    let own: Option<Vec<[f64; 5]>> = rows.iter().map(|row| parts(row)).collect();
    let Some(own) = own.filter(|own| !own.is_empty()) else {
        return;
    };
    let pooled: [f64; 5] = std::array::from_fn(|channel| {
        // A row without torque has no uncertainty of it.
        let known = own.iter().map(|parts| parts[channel]);
        let known = known.filter(|part| !part.is_nan());
        let squares: f64 = known.clone().map(|part| part * part).sum();
        libm::sqrt(squares / known.count() as f64)
    });
    for row in rows {
        let [slip, sinkage, pull, load, torque] = pooled;
        row.uncertainty = Some(Uncertainty {
            slip,
            sinkage,
            drawbar_pull: pull * row.load,
            load: load * row.load,
            driving_torque: torque * row.load,
        });
    }
}

/// Uncertainties of a row; those of forces divided by its load.
fn parts(row: &SteadyLoad) -> Option<[f64; 5]> {
    let sd = row.uncertainty?;
    let forces = [sd.drawbar_pull, sd.load, sd.driving_torque].map(|sd| sd / row.load);
    let [pull, load, torque] = forces;
    Some([sd.slip, sd.sinkage, pull, load, torque])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(load: f64, pull_sd: f64) -> SteadyLoad {
        SteadyLoad {
            slip: 0.1,
            sinkage: 0.01,
            drawbar_pull: 20.0,
            load,
            driving_torque: 4.0,
            uncertainty: Some(Uncertainty {
                slip: 0.01,
                sinkage: 0.001,
                drawbar_pull: pull_sd,
                load: 0.01 * load,
                driving_torque: 0.1,
            }),
        }
    }

    #[test]
    fn rows_of_one_load_share_the_root_mean_square_and_a_greater_load_has_its_share() {
        let mut rows = [row(100.0, 3.0), row(100.0, 1.0), row(200.0, 4.0)];
        pool(&mut rows.iter_mut().collect::<Vec<_>>());
        let sd = |row: &SteadyLoad| row.uncertainty.unwrap().drawbar_pull;
        // Ratios to the load: 3, 1 and 2 %.
        let part = (14.0e-4f64 / 3.0).sqrt();
        assert!((sd(&rows[0]) - 100.0 * part).abs() < 1e-12);
        assert_eq!(sd(&rows[0]), sd(&rows[1]));
        assert!((sd(&rows[2]) - 200.0 * part).abs() < 1e-12);
    }

    #[test]
    fn rows_of_which_one_is_without_uncertainty_stay_as_they_are() {
        let unsure = SteadyLoad {
            uncertainty: None,
            ..row(100.0, 3.0)
        };
        let mut rows = [row(100.0, 1.0), unsure];
        let before = rows;
        pool(&mut rows.iter_mut().collect::<Vec<_>>());
        assert_eq!(rows, before);
    }
}
