//! The `[identification]` of a study file: terrain parameters from the steady loads of its runs, their
//! predictions, and the benefit of selecting the model by class.
//!
//! A *fit* joins the runs that differ only in the keys of `over`, by default the slip; such runs are a
//! *group*. Three models are fitted to every group, those of ALCT, SLCT and LEIS: one is that of the class
//! recognised, one that of the class of the ground's label, and LEIS is the model without selection. A rim
//! held above the ground by its lugs has no sinkage, which the model of LEIS needs: [`RIGID_SINKAGE`] is
//! used.
//!
//! Rows of a group have [pooled](crate::identification::pool) uncertainties; for drifting quantities the
//! change over the interval is added ([`SteadyRow`](crate::identification::SteadyRow)).
//!
//! The class recognised is the most frequent result of [`improved`](crate::recognition::improved) over the
//! windows of the group other than UWTIC; UWTIC where there is no other.
//!
//! `steady.csv` has one row a steady interval:
//!
//! | columns | content |
//! |---|---|
//! | `run`, `condition`, `repeat` | numbers from 0 |
//! | `scenario`, every swept key | the condition |
//! | `label`, `label_class` | the ground, and its class |
//! | `answered_alct` ... `answered_uwtic` | answers to the run's windows |
//! | `recognized` | the most frequent of them, UWTIC aside |
//! | `slip`, `sinkage_m`, `drawbar_pull_n`, `load_n`, `driving_torque_n_m` | means |
//! | `slip_sd`, ... | their standard uncertainties, empty where they are not known |
//! | `from_s`, `to_s` | the interval |
//! | `drawbar_pull_drift_n_s`, ... | rate of change where it drifts in the interval |
//! | `reason` | why there is no steady interval; empty where there is |
//!
//! Results are in `identification.csv`, see [`score`].
//!
//! [`RIGID_SINKAGE`]: crate::identification::RIGID_SINKAGE

mod csv;
mod elsewhere;
mod fit;
mod origin;
mod own;
mod repeats;
pub mod score;
mod scoring;
mod steady;

use super::analysis::{Analysis, Finished, Observed, Report};
use super::group::{self, Group, check_over, slip_of, swept};
use super::table::{Columns, NoRows, Stop};
use super::{Reading, Study, StudyError, flatten};
use crate::document::Misfit;
use crate::identification::{Cylinder, Force, Law, Own, Setting};
use crate::quantity::RangeError;
use crate::scenario::Scenario;
use crate::soil::closed_form::Rim;
use crate::terrain::TerrainSpec;
use crate::terrain::class::Wtic;
use score::IdentificationScore;
use serde::{Deserialize, Serialize};
use steady::IntervalRow;

/// Why a fit joins swept keys only.
const NOT_SWEPT: &str = "parameters show in how loads change with slip: sweep it, or name the key that changes the slip in `over`";

/// An `[identification]` before its checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct IdentificationTable {
    over: Option<Vec<String>>,
    from: Option<toml::Table>,
    #[serde(default)]
    cylinder: Cylinder,
    exit_angle: Option<f64>,
    #[serde(default)]
    law: LawKey,
    published: Option<Published>,
}

/// Which equations give the loads in soil that lugs enter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LawKey {
    /// Eq. (62)-(66).
    #[default]
    Paper,
    /// The quadrature over rim and lugs, with the scenario's stress distribution, density and `c_3`.
    Own,
}

/// Published errors [%] of pull, load and torque, by class (Table 7).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "UPPERCASE")]
pub struct Published {
    alct: [f64; 3],
    slct: [f64; 3],
    leis: [f64; 3],
}

impl Published {
    /// The error [%] of a force on ground of a class; none of UWTIC.
    pub fn error(&self, class: Wtic, force: Force) -> Option<f64> {
        let errors = match class {
            Wtic::Alct => self.alct,
            Wtic::Slct => self.slct,
            Wtic::Leis => self.leis,
            Wtic::Uwtic => return None,
        };
        Some(errors[force as usize])
    }
}

/// How the steady loads of a study are identified.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    /// Keys whose conditions a fit joins.
    over: Vec<String>,
    /// Keys and values, as TOML, of the groups whose parameters predict those of the others.
    from: Vec<(String, String)>,
    cylinder: Cylinder,
    /// `c_3` [-]; unless given 0 by the paper's equations, the soil's own by the quadrature.
    exit_angle: Option<f64>,
    law: LawKey,
    published: Option<Published>,
}

impl Plan {
    /// Conventions of the equations for a scenario's wheel and soil.
    fn setting(&self, scenario: &Scenario) -> Setting {
        let soil = own::soil(scenario).filter(|_| self.law == LawKey::Own);
        let own_exit = soil.map_or(0.0, |soil| soil.exit_angle);
        Setting {
            lug_height: scenario.wheel.lug_height(),
            cylinder: self.cylinder,
            exit_angle: self.exit_angle.unwrap_or(own_exit),
            law: soil.map_or(Law::Paper, |soil| {
                Law::Own(Own {
                    lugs: scenario.wheel.lugs,
                    convention: soil.convention,
                    bulk_density: soil.bulk_density,
                })
            }),
            ..Setting::new(Rim::from(&scenario.wheel))
        }
    }
}

impl Analysis for Plan {
    const ROWS: Option<&'static str> = Some("steady");
    type Plan = IdentificationTable;
    type Row = IntervalRow;
    type Score = IdentificationScore;

    fn read(table: IdentificationTable, file: &Reading) -> Result<Self, Misfit> {
        let study = file.study;
        let over = table.over.unwrap_or_else(|| slip_of(study));
        check_over(study, &over, NOT_SWEPT).map_err(file.at("identification.over"))?;
        let from = read_from(study, &over, table.from.unwrap_or_default());
        let exit_angle = table.exit_angle;
        let given = exit_angle.unwrap_or(0.0);
        let from = from.map_err(file.at("identification.from"))?;
        RangeError::check("exit angle coefficient", "-", given, [-1.0, 0.0])
            .map_err(file.at("identification.exit_angle"))?;
        if table.law == LawKey::Own && table.cylinder != Cylinder::Rim {
            let message = "the quadrature models rim and lugs separately; omit cylinder";
            return Err(file.at("identification.cylinder")(message));
        }
        let plan = Self {
            over,
            from,
            cylinder: table.cylinder,
            exit_angle,
            law: table.law,
            published: table.published,
        };
        plan.check_published()
            .map_err(file.at("identification.published"))?;
        let groups = group::all(study, &plan.over);
        groups
            .iter()
            .try_for_each(|group| check_group(study, group))
            .map_err(file.at("identification.over"))?;
        groups
            .iter()
            .try_for_each(|group| plan.check_reference(study, group, &groups))
            .map_err(file.at("identification.from"))?;
        Ok(plan)
    }

    fn columns(&self, study: &Study) -> Columns {
        steady::columns(study)
    }

    fn rows(&self, run: &Observed, _: &mut Stop) -> Result<Vec<IntervalRow>, NoRows> {
        steady::rows(run)
    }

    fn score(
        &self,
        done: &Finished,
        rows: Vec<IntervalRow>,
    ) -> Result<IdentificationScore, StudyError> {
        scoring::score(self, done, &rows)
    }

    fn report(score: &IdentificationScore) -> Option<Report> {
        Some(Report {
            stem: "identification",
            rows: "rows",
            table: "steady.csv",
            csv: Some(score.to_csv()),
        })
    }
}

impl Plan {
    /// The parameters of one rim do not predict another: the model does not separate the width from the
    /// soil's modulus.
    fn check_reference(
        &self,
        study: &Study,
        group: &Group,
        groups: &[Group],
    ) -> Result<(), String> {
        let setting = |group: &Group| self.setting(&study.scenario_of(group.conditions[0]));
        let surface = |group: &Group| setting(group).surface();
        let other = group.reference(study, self, groups);
        if other.is_none_or(|other| surface(other) == surface(group)) {
            return Ok(());
        }
        Err("the parameters of one rim do not predict the loads of another; sweep its radius and width in another study".to_owned())
    }

    fn check_published(&self) -> Result<(), RangeError> {
        let published = self.published.into_iter();
        let mut errors = published.flat_map(|it| [it.alct, it.slct, it.leis].concat());
        errors.try_for_each(|error| RangeError::positive("published error", "%", error).map(drop))
    }
}

fn read_from(
    study: &Study,
    over: &[String],
    from: toml::Table,
) -> Result<Vec<(String, String)>, String> {
    let mut values = Vec::new();
    flatten("", &from, &mut values);
    for (key, value) in &values {
        if over.contains(key) {
            return Err(format!(
                "every fit joins all values of `{key}`, so it cannot distinguish fits"
            ));
        }
        let Some(known) = study.values_of(key) else {
            let swept = swept(study);
            return Err(format!("`{key}` is not swept; {swept}"));
        };
        let known: Vec<&str> = known.collect();
        if !known.contains(&value.as_str()) {
            return Err(format!(
                "`{key}` is never {value}; its values are {}",
                known.join(", ")
            ));
        }
    }
    Ok(values)
}

/// A fit is of one wheel on one ground, at two conditions or more.
fn check_group(study: &Study, group: &Group) -> Result<(), String> {
    let of = |condition: &u64| study.scenario_of(*condition);
    let first = of(&group.conditions[0]);
    if let TerrainSpec::Sequence(_) = first.terrain {
        return Err(format!(
            "{} crosses several grounds, and a fit is of one",
            group.scenario
        ));
    }
    if group.conditions.len() < 2 {
        return Err(
            "every fit would be of one condition; parameters show in how loads change with slip, so sweep two values or more"
                .to_owned(),
        );
    }
    let same = |condition: &u64| {
        let scenario = of(condition);
        scenario.wheel == first.wheel && scenario.terrain == first.terrain
    };
    if group.conditions.iter().all(same) {
        return Ok(());
    }
    Err("a fit is of one wheel on one ground; omit keys of either from `over`".to_owned())
}
