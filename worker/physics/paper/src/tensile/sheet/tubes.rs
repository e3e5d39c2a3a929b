//! A sheet of tubes: every fibre divided and followed by rings, and what is to be known of that.
use loadframe_api::fibre::{Divided, Elasticity, Section, divide_piece, line_length_um};
use loadframe_api::spec::paper_tensile::{OnInadmissible, PaperTensile};
use loadframe_harness::{ReportBuilder, SimulationError};

use crate::fibre::Tube;
use crate::fibre::measure::{self, Constants};
use crate::frame::{FrameBond, FrameFibre, FrameModel, Level, Network};
use crate::tensile::report::{constants_check, miss};

/// What the tubes of a sheet are.
pub(super) struct Tubes {
    points: usize,
    springs: usize,
    /// Fibres with another segment than was asked for.
    refined: usize,
    /// Fibres of the robust form, and the least of the shear modulus that is left of them, over what was given.
    robust: usize,
    least_shear: f64,
    /// Shortest and longest segment [µm].
    segments_um: [f64; 2],
    /// Window of the longest fibre.
    window_um: [f64; 2],
    /// What the longest fibre's tube is, beside what its wall is.
    constants: Constants,
    elasticity: Elasticity,
    wall_bending_mn_um2: f64,
    miss: f64,
}

/// The network, and what its tubes are where the model has such; `walls` are those of all fibres.
///
/// # Errors
/// [`SimulationError::Paper`] when a fibre cannot be divided, or turns too sharply for its rings.
pub(super) fn network(
    spec: &PaperTensile,
    fibres: &[FrameFibre],
    walls: &[(Section, Elasticity)],
    bonds: &[FrameBond],
    model: FrameModel,
) -> Result<(Network, Option<Tubes>), SimulationError> {
    if model.level != Level::Tube {
        let network = Network::new(fibres, bonds, model)?;
        let network = match spec.model.taut_strain {
            Some(strain) => network.with_taut_bars(strain)?,
            None => network,
        };
        return Ok((network, None));
    }
    let division = spec.model.division();
    let mut tubes = Vec::with_capacity(fibres.len());
    let mut all: Vec<(f64, Divided)> = Vec::with_capacity(fibres.len());
    for (number, (fibre, (section, elasticity))) in fibres.iter().zip(walls).enumerate() {
        let of_fibre = |error| SimulationError::of_paper(format!("fibre {number}: {error}"));
        let length_um = line_length_um(&fibre.centre_line_um);
        let divided = divide_piece(length_um, section, elasticity, &division).map_err(of_fibre)?;
        tubes.push(Tube::along_line(&fibre.centre_line_um, &divided).map_err(of_fibre)?);
        all.push((length_um, divided));
    }
    let network = Network::of_tubes(fibres, &tubes, bonds, model)?;
    let tubes = Tubes::of(&tubes, &all, walls)?;
    Ok((network, tubes))
}

impl Tubes {
    fn of(
        tubes: &[Tube],
        all: &[(f64, Divided)],
        walls: &[(Section, Elasticity)],
    ) -> Result<Option<Self>, SimulationError> {
        let longest = (0..all.len()).max_by(|&a, &b| all[a].0.total_cmp(&all[b].0));
        let Some(longest) = longest else {
            return Ok(None);
        };
        let (divided, (section, elasticity)) = (&all[longest].1, &walls[longest]);
        let constants = measure::constants(divided, section)?;
        let robust = || {
            all.iter()
                .zip(walls)
                .filter(|((_, one), _)| one.springs.is_robust)
        };
        let shares = robust().map(|((_, one), (_, given))| {
            one.springs.shear_modulus_gpa / given.shear_modulus_gpa()
        });
        let segments = || all.iter().map(|(_, one)| one.segment.length_um());
        Ok(Some(Self {
            points: tubes.iter().map(|tube| tube.places_um().len()).sum(),
            springs: tubes.iter().map(|tube| tube.springs().len()).sum(),
            refined: all.iter().filter(|(_, one)| one.is_refined).count(),
            robust: robust().count(),
            least_shear: shares.fold(1.0, f64::min),
            segments_um: [
                segments().fold(f64::INFINITY, f64::min),
                segments().fold(0.0, f64::max),
            ],
            window_um: [divided.window.from_um, divided.window.to_um],
            constants,
            elasticity: *elasticity,
            wall_bending_mn_um2: elasticity.youngs_modulus_gpa() * section.inertia_um4(),
            miss: miss(elasticity, divided, &constants),
        }))
    }

    /// A line for the log.
    pub(super) fn described(&self) -> String {
        let [from, to] = self.segments_um;
        format!(
            "tubes of {} points and {} springs, segments of {from:.2} to {to:.2} µm",
            self.points, self.springs
        )
    }

    /// Results, checks and work of tubes.
    pub(super) fn report(&self, report: &mut ReportBuilder) {
        // mN µm² is 10⁻¹⁵ N m²
        let newton_m2 = 1e-15;
        let constants = &self.constants;
        for (name, value, unit, about) in [
            (
                "axial_modulus",
                constants.axial_modulus_gpa,
                "GPa",
                "E of the longest fibre's tube, pulled.",
            ),
            (
                "axial_modulus_given",
                self.elasticity.youngs_modulus_gpa(),
                "GPa",
                "E that was put in.",
            ),
            (
                "shear_modulus",
                constants.shear_modulus_gpa,
                "GPa",
                "G of the longest fibre's tube, twisted.",
            ),
            (
                "shear_modulus_given",
                self.elasticity.shear_modulus_gpa(),
                "GPa",
                "G that was put in.",
            ),
            (
                "bending_stiffness",
                newton_m2 * constants.bending_stiffness_mn_um2,
                "N m2",
                "E I of the longest fibre's tube, bent by moments.",
            ),
            (
                "bending_stiffness_of_wall",
                newton_m2 * self.wall_bending_mn_um2,
                "N m2",
                "E I of its wall, which a beam has. The springs are not made for it, and the tube has less.",
            ),
        ] {
            report.result(name, value, unit, about);
        }
        constants_check(report, self.miss);
        report.work("points", self.points as u64);
        report.work("springs", self.springs as u64);
    }

    /// What was not done as it was asked.
    pub(super) fn warn(&self, report: &mut ReportBuilder, spec: &PaperTensile) {
        let fibres = spec.model;
        let ([shortest, longest], [from, to]) = (self.segments_um, self.window_um);
        if let Some(wanted) = fibres.segment_um
            && self.refined > 0
        {
            report.warn(
                "refined_segment",
                format!(
                    "{} fibres have no segments of {wanted} µm, for these or what a whole number makes of them need \
                     springs of negative stiffness; theirs are {shortest:.4} to {longest:.4} µm long, and the \
                     window of the longest fibre is {from:.4} to {to:.4} µm",
                    self.refined
                ),
            );
        }
        if self.robust > 0 {
            let why = match fibres.on_inadmissible {
                OnInadmissible::Robust if fibres.segment_um.is_some() => "",
                _ => ", for no whole number of admissible segments makes up their length",
            };
            report.warn(
                "robust_springs",
                format!(
                    "{} fibres have springs around and along of unlike modulus{why}; the least shear modulus of \
                     them is {:.1} % of the given one",
                    self.robust,
                    100.0 * self.least_shear
                ),
            );
        }
    }
}
