//! Choice of the equations for a wheel's rows.

use super::Convention;
use super::parameter_order::values_by_name;
use super::wheel::WheelOfRun;
use crate::identification::{
    Identification, Law, Own, Scope, Setting, SteadyLoad, TerrainParameters,
};
use crate::soil::StressConvention;
use crate::terrain::class::Wtic;
use crate::wheel::Lugs;
use clap::ValueEnum;
use serde::Serialize;

/// Bulk density [kg/m³] of dry sand, as in the ready scenarios.
const DRY_SAND: f64 = 1600.0;
/// Default exit angle coefficient `c_3` [-]: dry sand, as in the ready scenarios.
const EXIT_ANGLE: f64 = -0.2;
/// Default lug thickness [m]: that of the ready scenarios.
const THICKNESS: f64 = 0.003;

/// Which law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LawName {
    /// Quadrature of stress over rim and lugs, as simulated
    Own,
    /// Eq. (62)-(66), a smooth cylinder
    Paper,
}

/// Stress distribution over the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StressName {
    /// Wong and Reece
    WongReece,
    /// The paper's triangles
    Triangular,
}

impl StressName {
    fn convention(self) -> StressConvention {
        match self {
            Self::WongReece => StressConvention::WongReece,
            Self::Triangular => StressConvention::Triangular,
        }
    }
}

/// The law of a fit with its inputs.
#[derive(Debug, Clone, Copy)]
pub struct Chosen {
    /// The law.
    pub law: Law,
    /// `c_3` [-].
    pub exit_angle: f64,
    /// Whether the lug thickness is the default and not known.
    pub thickness_assumed: bool,
}

/// Fit of the same rows with the alternative stress distribution.
#[derive(Debug, Clone, Serialize)]
pub struct OtherStress {
    /// Which.
    pub stress: StressConvention,
    /// The parameters by name.
    #[serde(serialize_with = "values_by_name")]
    pub parameters: TerrainParameters,
    /// Sum of squares per degree of freedom [-].
    pub reduced_chi_square: f64,
}

impl OtherStress {
    /// The fit by the quadrature with the stress distribution other than that of the setting; `None` for the
    /// paper's equations, which have only one.
    pub fn of(rows: &[SteadyLoad], class: Wtic, setting: &Setting) -> Option<Self> {
        let Law::Own(own) = setting.law else {
            return None;
        };
        let stress = match own.convention {
            StressConvention::WongReece => StressConvention::Triangular,
            StressConvention::Triangular => StressConvention::WongReece,
        };
        let law = Law::Own(Own {
            convention: stress,
            ..own
        });
        let setting = Setting { law, ..*setting };
        let identification = Identification::new(rows, class, &setting).ok()?;
        let estimate = identification.estimate().ok()?;
        Some(Self {
            stress,
            parameters: estimate.terrain,
            reduced_chi_square: estimate.reduced_chi_square(),
        })
    }
}

/// The law as reported in results.
#[derive(Debug, Clone, Serialize)]
pub struct LawReport {
    /// `own` or `paper`.
    pub law: &'static str,
    /// Stress distribution over the contact.
    pub stress: StressConvention,
    /// Bulk density [kg/m³]; none where it has no effect.
    pub bulk_density_kg_m3: Option<f64>,
    /// Lug thickness [m]; none where it has no effect.
    pub lug_thickness_m: Option<f64>,
    /// Whether that is the default and not known.
    pub lug_thickness_assumed: bool,
}

impl Chosen {
    /// The law given on the command line; by default the quadrature in soil that lugs enter, for a wheel with
    /// known lugs (for a smooth one only under several loads), unless an option requires the paper's
    /// equations.
    ///
    /// # Errors
    /// Why the quadrature given cannot be used.
    pub fn of(
        convention: &Convention,
        wheel: &WheelOfRun,
        class: Wtic,
        rows: &[SteadyLoad],
    ) -> Result<Self, String> {
        let paper = Ok(Self {
            law: Law::Paper,
            exit_angle: convention.exit_angle.unwrap_or(0.0),
            thickness_assumed: false,
        });
        let lugs = wheel.lugs();
        let known = lugs.are_none() || lugs.count.is_some() && !lugs.height.is_nan();
        let is_smooth_under_one_load = || lugs.are_none() && Scope::is_one_load(rows);
        match convention.law {
            Some(LawName::Paper) => return paper,
            None if class != Wtic::Leis || convention.is_of_paper() => return paper,
            None if !known || is_smooth_under_one_load() => return paper,
            Some(LawName::Own) if class != Wtic::Leis => {
                return Err(format!(
                    "--law own applies to soil that lugs enter, not to class {class}; omit it or give --class LEIS"
                ));
            }
            Some(LawName::Own) if !known => {
                return Err(
                    "--law own needs lug_count and lug_height_m of the wheel (0 of a smooth one): state them in the \
                     campaign and import it again"
                        .to_owned(),
                );
            }
            Some(LawName::Own) if convention.is_of_paper() => {
                return Err(
                    "the quadrature models rim and lugs separately: omit --cylinder or --law own"
                        .to_owned(),
                );
            }
            None | Some(LawName::Own) => {}
        }
        let thickness = convention.lug_thickness.or(wheel.lug_thickness_m);
        let count = lugs.count.filter(|count| *count > 0);
        let lugs = count.map(|count| Lugs {
            count,
            height: lugs.height,
            thickness: thickness.unwrap_or(THICKNESS),
            edge_radius: None,
        });
        Ok(Self {
            thickness_assumed: lugs.is_some() && thickness.is_none(),
            law: Law::Own(Own {
                lugs,
                convention: convention.stress.convention(),
                bulk_density: convention.bulk_density.unwrap_or(DRY_SAND),
            }),
            exit_angle: convention.exit_angle.unwrap_or(EXIT_ANGLE),
        })
    }

    /// In results.
    pub fn report(&self) -> LawReport {
        match self.law {
            Law::Paper => LawReport {
                law: "paper",
                stress: StressConvention::Triangular,
                bulk_density_kg_m3: None,
                lug_thickness_m: None,
                lug_thickness_assumed: false,
            },
            Law::Own(own) => LawReport {
                law: "own",
                stress: own.convention,
                bulk_density_kg_m3: own.lugs.map(|_| own.bulk_density),
                lug_thickness_m: own.lugs.map(|lugs| lugs.thickness),
                lug_thickness_assumed: self.thickness_assumed,
            },
        }
    }
}
