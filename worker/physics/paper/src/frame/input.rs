//! What a network is described by.
use super::error::{FrameError, check};

/// The cross-section of a fibre and what it is made of; the same about both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamSection {
    /// Area of the wall [µm²].
    pub area_um2: f64,
    /// Second moment of area about either axis [µm⁴].
    pub inertia_um4: f64,
    /// Torsion constant [µm⁴].
    pub polar_um4: f64,
    /// Young's modulus along the fibre [GPa].
    pub youngs_modulus_gpa: f64,
    /// Shear modulus [GPa].
    pub shear_modulus_gpa: f64,
    /// Timoshenko's shear coefficient [-]: share of the area that carries shear.
    pub shear_coefficient: f64,
    /// Tensile stress at which the fibre breaks [GPa]; none: it never does.
    pub strength_gpa: Option<f64>,
    /// Outer width [µm]: bending stress is taken at half of it.
    pub width_um: f64,
    /// Mass per length [µg/µm]: what only motion asks for.
    pub line_density_ug_per_um: f64,
    /// Where it yields along itself; none: it is elastic until it breaks.
    pub yielding: Option<Yielding>,
}

/// Stress over strain of two straight lines: what the force along a fibre yields at, and how it goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yielding {
    /// Stress at which it yields first, pulled or pushed [GPa].
    pub stress_gpa: f64,
    /// Slope of stress over strain beyond [GPa], above 0 and below Young's modulus.
    pub hardening_modulus_gpa: f64,
}

/// A fibre: its centre line, point by point [µm], and its section.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFibre {
    pub centre_line_um: Vec<[f64; 3]>,
    pub section: BeamSection,
}

/// A bond between two fibres, unstrained as given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameBond {
    pub fibres: [u32; 2],
    /// Arc length from each fibre's start [µm].
    pub at_um: [f64; 2],
    /// Bonded area a [µm²].
    pub area_um2: f64,
    /// Stiffness per area s [mN/µm³]: the bond has s a against displacement and s a²/12 against rotation.
    pub stiffness_mn_per_um3: f64,
    /// Force that opens it [mN]; none: no opening force breaks it.
    pub normal_strength_mn: Option<f64>,
    /// Force along its face that breaks it [mN]; none: no shear breaks it.
    pub shear_strength_mn: Option<f64>,
}

/// What fibres are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Level {
    /// Timoshenko beams: extension, bending, shear and torsion; bonds hold rotations, too.
    #[default]
    Beam,
    /// Bars: extension only; bonds hold displacements only.
    Truss,
    /// Tubes of points and springs ([`crate::fibre::Tube`]); bonds hold the points of rings around them.
    Tube,
}

/// Where bonds hold their fibres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Attachment {
    /// At a node of their own: what bonds do to a fibre between them is exact.
    #[default]
    Node,
    /// Where they are, between nodes that know nothing of them: fewer nodes, and a little too stiff.
    Inside,
}

/// How a network is built from its description.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameModel {
    pub level: Level,
    /// Longest segment [µm]; none: nodes are at the given points, and at the bonds if those have any, alone.
    pub segment_um: Option<f64>,
    pub attachment: Attachment,
    /// Distance of the jaws [µm]: points at x ≤ 0 or x ≥ this are held.
    pub length_um: f64,
}

impl FrameModel {
    pub(crate) fn check(&self) -> Result<(), FrameError> {
        let length = self.length_um;
        check(
            || "distance of the jaws [um]".into(),
            length,
            length > 0.0,
            "above 0",
        )?;
        match self.segment_um {
            Some(segment) => check(
                || "longest segment [um]".into(),
                segment,
                segment > 0.0,
                "above 0",
            ),
            None => Ok(()),
        }
    }
}

impl BeamSection {
    pub(crate) fn check(&self, fibre: usize) -> Result<(), FrameError> {
        for (name, value) in [
            ("area [um2]", self.area_um2),
            ("second moment of area [um4]", self.inertia_um4),
            ("torsion constant [um4]", self.polar_um4),
            ("Young's modulus [GPa]", self.youngs_modulus_gpa),
            ("shear modulus [GPa]", self.shear_modulus_gpa),
            ("shear coefficient", self.shear_coefficient),
            ("width [um]", self.width_um),
            ("strength [GPa]", self.strength_gpa.unwrap_or(1.0)),
            ("mass per length [ug/um]", self.line_density_ug_per_um),
        ] {
            check(
                || format!("{name} of fibre {fibre}"),
                value,
                value > 0.0,
                "above 0",
            )?;
        }
        let Some(yielding) = self.yielding else {
            return Ok(());
        };
        let (stress, slope) = (yielding.stress_gpa, yielding.hardening_modulus_gpa);
        check(
            || format!("yield stress [GPa] of fibre {fibre}"),
            stress,
            stress > 0.0,
            "above 0",
        )?;
        check(
            || format!("hardening modulus [GPa] of fibre {fibre}"),
            slope,
            slope > 0.0 && slope < self.youngs_modulus_gpa,
            "above 0 and below Young's modulus",
        )
    }
}

impl FrameBond {
    pub(crate) fn check(&self, bond: usize) -> Result<(), FrameError> {
        for (name, value) in [
            ("area [um2]", self.area_um2),
            ("stiffness [mN/um3]", self.stiffness_mn_per_um3),
        ] {
            check(
                || format!("{name} of bond {bond}"),
                value,
                value > 0.0,
                "above 0",
            )?;
        }
        for (name, value) in [
            ("normal strength [mN]", self.normal_strength_mn),
            ("shear strength [mN]", self.shear_strength_mn),
        ] {
            if let Some(value) = value {
                check(
                    || format!("{name} of bond {bond}"),
                    value,
                    value >= 0.0,
                    "0 or above, or none",
                )?;
            }
        }
        Ok(())
    }

    /// Whether it breaks under no force at all: it is no bond.
    pub(crate) fn is_void(&self) -> bool {
        let is_nil = |strength: Option<f64>| strength.is_some_and(|value| value <= 0.0);
        is_nil(self.normal_strength_mn) && is_nil(self.shear_strength_mn)
    }
}

/// A force [mN] and a moment [mN µm] on a node; their directions stay as given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeLoad {
    pub node: usize,
    pub force_mn: [f64; 3],
    pub moment_mn_um: [f64; 3],
}
