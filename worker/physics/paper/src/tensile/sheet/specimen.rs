//! The specimen of a test: a network of beams, bars or tubes, made of a sheet that is given or laid.
use loadframe_api::fibre::{Elasticity, Section};
use loadframe_api::spec::paper_tensile::{
    BondsAt, Direction, ExplicitSheet, Level, MadeSheet, Orientation, PaperTensile, Placement,
    Pulp, Specimen as Kind,
};
use loadframe_harness::{Halt, Interrupt, InterruptSource, SimulationError};
use loadframe_numerics::Team;

use super::bonds::{MPA, Side, Strengths, assumed, stiffness};
use super::laid::Laid;
use super::theory::Theory;
use super::tubes::{self, Tubes};
use crate::frame::{self, BeamSection, FrameBond, FrameFibre, FrameModel, Network};
use crate::sheet::{self, SheetError};

/// 1 N in mN.
const N: f64 = 1e3;

/// What is pulled.
pub(super) struct Specimen {
    pub(super) network: Network,
    pub(super) length_mm: f64,
    pub(super) width_mm: f64,
    /// Mass between the jaws over their distance and the width [g/m²].
    pub(super) grammage_g_per_m2: f64,
    /// Least and largest stiffness per area that bonds were given without being asked [N/m/µm²].
    pub(super) assumed_stiffness: Option<[f64; 2]>,
    /// What is known of a sheet that was laid.
    pub(super) laid: Option<Laid>,
    /// What is known of its tubes, if its fibres are such.
    pub(super) tubes: Option<Tubes>,
}

impl Specimen {
    /// Builds the specimen of a spec and its seed; the same on any number of threads.
    ///
    /// # Errors
    /// [`SimulationError::Paper`] when there is no such sheet; a cancel.
    pub(super) fn new(
        spec: &PaperTensile,
        team: &Team,
        interrupt: &dyn InterruptSource,
    ) -> Result<Self, Halt> {
        Ok(match &spec.specimen {
            Kind::Explicit(sheet) => Self::given(spec, sheet)?,
            Kind::Sheet(sheet) => Self::made(spec, sheet, team, interrupt)?,
            Kind::SingleFibre(_) => {
                return Err(SimulationError::of_paper("a single fibre is no sheet").into());
            }
        })
    }

    fn given(spec: &PaperTensile, sheet: &ExplicitSheet) -> Result<Self, SimulationError> {
        let length_um = 1e3 * sheet.length_mm;
        let mut fibres = Vec::with_capacity(sheet.fibres.len());
        let mut sides = Vec::with_capacity(sheet.fibres.len());
        let mut walls = Vec::with_capacity(sheet.fibres.len());
        let mut mass_ug = 0.0;
        for (index, fibre) in sheet.fibres.iter().enumerate() {
            let pulp = spec.pulp_named(&fibre.pulp);
            let pulp = pulp.ok_or_else(|| {
                SimulationError::of_paper(format!("fibre {index} is of an unknown pulp"))
            })?;
            let section = pulp.section().map_err(SimulationError::of_paper)?;
            let beam = beam(spec, pulp, &section);
            mass_ug +=
                beam.line_density_ug_per_um * between_jaws_um(&fibre.centre_line_um, length_um);
            fibres.push(FrameFibre {
                centre_line_um: fibre.centre_line_um.clone(),
                section: beam,
            });
            sides.push(Side {
                thickness_um: section.area_um2() / section.width_um(),
                youngs_modulus_gpa: pulp.youngs_modulus_gpa,
            });
            walls.push((section, elasticity(pulp)?));
        }
        let strengths = Strengths::new(spec);
        let mut bonds = Vec::with_capacity(sheet.bonds.len());
        for (index, bond) in sheet.bonds.iter().enumerate() {
            let [one, other] = bond.fibres.map(|fibre| sides.get(fibre as usize));
            let (Some(&one), Some(&other)) = (one, other) else {
                return Err(SimulationError::of_paper(format!(
                    "bond {index} joins a fibre that is not there"
                )));
            };
            let [normal, shear] = strengths.of(index, bond.area_um2);
            bonds.push(FrameBond {
                fibres: bond.fibres,
                at_um: bond.at_um,
                area_um2: bond.area_um2,
                stiffness_mn_per_um3: stiffness(spec.bond.as_ref(), [one, other]),
                normal_strength_mn: bond.normal_strength_n.map(|given| N * given).or(normal),
                shear_strength_mn: bond.shear_strength_n.map(|given| N * given).or(shear),
            });
        }
        // 1 µg/µm² is 10⁶ g/m²
        let grammage = 1e6 * mass_ug / (length_um * 1e3 * sheet.width_mm);
        let model = model(spec, length_um, spec.model.segment_um);
        let (network, tubes) = tubes::network(spec, &fibres, &walls, &bonds, model)?;
        Ok(Self {
            network,
            length_mm: sheet.length_mm,
            width_mm: sheet.width_mm,
            grammage_g_per_m2: grammage,
            assumed_stiffness: assumed(spec, &bonds),
            laid: None,
            tubes,
        })
    }

    fn made(
        spec: &PaperTensile,
        made: &MadeSheet,
        team: &Team,
        interrupt: &dyn InterruptSource,
    ) -> Result<Self, Halt> {
        let pulps: Vec<&Pulp> = spec
            .pulp
            .iter()
            .filter(|pulp| pulp.mass_fraction > 0.0)
            .collect();
        let plan = plan(spec, made, &pulps)?;
        let laid = plan.lay_unless(spec.seed, team, interrupt);
        let whole = laid.map_err(|error| match error {
            SheetError::GivenUp => Halt::Interrupted(Interrupt::Cancel),
            error => SimulationError::of_paper(error).into(),
        })?;
        if interrupt.is_cancelled() {
            return Err(Interrupt::Cancel.into());
        }
        let whole = if spec.test.pulled() == Direction::Cd {
            whole.turned()
        } else {
            whole
        };
        let tested = if spec.test.is_zero_span() {
            at_zero_span(&whole)
        } else {
            whole.coarsened(spec.sheet_segment_um())
        };
        let tested = tested.map_err(SimulationError::of_paper)?;
        let mut fibres = Vec::with_capacity(tested.fibres.len());
        let mut walls = Vec::with_capacity(tested.fibres.len());
        for fibre in &tested.fibres {
            let pulp = pulps[fibre.pulp];
            let section = Section::new(fibre.section.width_um, fibre.section.wall_um);
            let section = section.map_err(SimulationError::of_paper)?;
            fibres.push(FrameFibre {
                centre_line_um: fibre.centre_line_um.clone(),
                section: beam(spec, pulp, &section),
            });
            walls.push((section, elasticity(pulp)?));
        }
        let strengths = Strengths::new(spec);
        let mut bonds = Vec::with_capacity(tested.contacts.len());
        for (index, contact) in tested.contacts.iter().enumerate() {
            let sides = contact.fibres.map(|fibre| {
                let fibre = &tested.fibres[fibre as usize];
                Side {
                    thickness_um: fibre.section.thickness_um,
                    youngs_modulus_gpa: pulps[fibre.pulp].youngs_modulus_gpa,
                }
            });
            let [normal, shear] = strengths.of(index, contact.area_um2);
            bonds.push(FrameBond {
                fibres: contact.fibres,
                at_um: contact.at_um,
                area_um2: contact.area_um2,
                stiffness_mn_per_um3: stiffness(spec.bond.as_ref(), sides),
                normal_strength_mn: normal,
                shear_strength_mn: shear,
            });
        }
        let laid = Laid::measure(&whole, spec, |measured| {
            let shear_mpa = spec.bond.and_then(|bond| bond.shear_strength_mpa);
            Theory::of(&whole, &pulps, &bonds, measured, shear_mpa)
        });
        let length_um = tested.size_um[0];
        if interrupt.is_cancelled() {
            return Err(Interrupt::Cancel.into());
        }
        let model = model(spec, length_um, None);
        let (network, tubes) = tubes::network(spec, &fibres, &walls, &bonds, model)?;
        Ok(Self {
            network,
            length_mm: 1e-3 * length_um,
            width_mm: made.width_mm,
            grammage_g_per_m2: laid.grammage_g_per_m2,
            assumed_stiffness: assumed(spec, &bonds),
            laid: Some(laid),
            tubes,
        })
    }
}

/// A plan as the generator takes it; along the machine the sheet is as long as the test asks.
fn plan(
    spec: &PaperTensile,
    made: &MadeSheet,
    pulps: &[&Pulp],
) -> Result<sheet::SheetPlan, SimulationError> {
    let [length_um, width_um] = [made.length_mm, made.width_mm].map(|size| 1e3 * size);
    let mut of_plan = Vec::with_capacity(pulps.len());
    for pulp in pulps {
        let section = pulp.section().map_err(SimulationError::of_paper)?;
        of_plan.push(sheet::Pulp {
            mass_fraction: pulp.mass_fraction,
            length: lengths(pulp),
            width_um: pulp.width_um,
            wall_um: pulp.wall_um,
            coarseness_ug_per_um: 1e-3 * pulp.coarseness_mg_per_m(&section),
            shape_factor: pulp.shape_factor,
            lumen: sheet::Lumen::Collapsed,
        });
    }
    Ok(sheet::SheetPlan {
        size_um: if spec.test.pulled() == Direction::Cd {
            [width_um, length_um]
        } else {
            [length_um, width_um]
        },
        // 1 g/m² is 10⁻⁶ µg/µm²
        grammage_ug_per_um2: 1e-6 * made.grammage_g_per_m2,
        pulps: of_plan,
        orientation: match &made.orientation {
            Orientation::Uniform => sheet::Orientation::Uniform,
            Orientation::VonMises(von_mises) => sheet::Orientation::VonMises {
                kappa: von_mises.concentration,
            },
            Orientation::Histogram(histogram) => sheet::Orientation::Histogram {
                weights: histogram.densities.clone(),
            },
        },
        placement: match made.placement {
            Placement::Deposition(deposition) => sheet::Placement::Deposition {
                flexibility: deposition.flexibility,
            },
            Placement::Random(random) => sheet::Placement::Random3d {
                thickness_um: random.thickness_um,
            },
        },
        segment_um: None,
        gap_um: None,
    })
}

fn lengths(pulp: &Pulp) -> sheet::LengthDistribution {
    let mean_um = 1e3 * pulp.mean_length_mm();
    if pulp.measured.is_some() {
        let fibres = pulp.fibres().map(|fibre| sheet::MeasuredFibre {
            length_um: 1e3 * fibre.length_mm,
            width_um: fibre.width_um,
            wall_um: fibre.wall_um,
            shape_factor: fibre.shape_factor,
        });
        sheet::LengthDistribution::Measured(fibres.collect())
    } else if pulp.length_variation > 0.0 {
        sheet::LengthDistribution::LogNormal {
            mean_um,
            variation: pulp.length_variation,
        }
    } else {
        sheet::LengthDistribution::Fixed { length_um: mean_um }
    }
}

/// What lies between jaws that close to the width of the widest fibre in the middle of a sheet: pieces of
/// fibres, without bonds. Closer, pieces would be shorter than they are wide.
fn at_zero_span(whole: &sheet::Sheet) -> Result<sheet::Sheet, sheet::SheetError> {
    let widths = whole.fibres.iter().map(|fibre| fibre.section.width_um);
    let [length_um, width_um] = whole.size_um;
    let span_um = widths.fold(0.0, f64::max).min(length_um);
    let mut strip = whole.strip([0.5 * (length_um - span_um), 0.0], [span_um, width_um])?;
    strip.contacts.clear();
    Ok(strip)
}

/// The section of a beam: a round tube, whatever its fibre looks like in the sheet.
fn beam(spec: &PaperTensile, pulp: &Pulp, section: &Section) -> BeamSection {
    let ratio = pulp.poisson_ratio;
    // a thin round tube [Cowper1966]
    let thin_tube = 2.0 * (1.0 + ratio) / (4.0 + 3.0 * ratio);
    BeamSection {
        area_um2: section.area_um2(),
        inertia_um4: section.inertia_um4(),
        polar_um4: section.polar_um4(),
        youngs_modulus_gpa: pulp.youngs_modulus_gpa,
        shear_modulus_gpa: pulp.shear_modulus_gpa,
        shear_coefficient: spec.model.shear_coefficient.unwrap_or(thin_tube),
        strength_gpa: pulp.strength_mpa.map(|strength| MPA * strength),
        width_um: section.width_um(),
        // 1 mg/m is 10⁻³ µg/µm
        line_density_ug_per_um: 1e-3 * pulp.coarseness_mg_per_m(section),
        yielding: pulp.yielding.map(|yielding| frame::Yielding {
            stress_gpa: MPA * yielding.stress_mpa,
            hardening_modulus_gpa: yielding.hardening_modulus_gpa,
        }),
    }
}

fn elasticity(pulp: &Pulp) -> Result<Elasticity, SimulationError> {
    pulp.elasticity().map_err(SimulationError::of_paper)
}

fn model(spec: &PaperTensile, length_um: f64, segment_um: Option<f64>) -> FrameModel {
    FrameModel {
        level: match spec.level() {
            Level::Truss => frame::Level::Truss,
            Level::Beam => frame::Level::Beam,
            Level::Tube => frame::Level::Tube,
        },
        segment_um,
        attachment: match spec.accuracy.knobs().bonds_at {
            BondsAt::Nodes => frame::Attachment::Node,
            BondsAt::Inside => frame::Attachment::Inside,
        },
        length_um,
    }
}

/// Length of a line within 0 ≤ x ≤ `length_um` [µm].
fn between_jaws_um(line: &[[f64; 3]], length_um: f64) -> f64 {
    line.windows(2)
        .map(|ends| {
            let parts = (0..3).map(|axis| (ends[1][axis] - ends[0][axis]).powi(2));
            let whole = parts.sum::<f64>().sqrt();
            let [low, high] = [ends[0][0].min(ends[1][0]), ends[0][0].max(ends[1][0])];
            if high > low {
                let inside = (high.min(length_um) - low.max(0.0)).max(0.0);
                whole * inside / (high - low)
            } else if (0.0..=length_um).contains(&low) {
                whole
            } else {
                0.0
            }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lies_between_the_jaws_has_mass() {
        // 3-4-5: half of the first part lies before the jaw, the second wholly between, the third beyond
        let line = [
            [-30.0, 0.0, 0.0],
            [30.0, 80.0, 0.0],
            [30.0, 90.0, 0.0],
            [130.0, 90.0, 0.0],
        ];
        assert!((between_jaws_um(&line, 100.0) - (50.0 + 10.0 + 70.0)).abs() < 1e-12);
    }
}
