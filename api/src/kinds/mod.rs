//! The one list of job kinds. A new kind is a line here, a file in `spec/`, an example in
//! `api/examples/` and an engine in `loadframe-physics`; the compiler and the tests ask for the rest.
//!
//! [`kind`] makes of the list what needs no spec (names, texts, examples), [`spec`] what does.

/// Hands the list to a macro: variant, name on the wire, the spec's type, title, what the test does,
/// and examples, of which the first has the kind's name and is the one to start from.
macro_rules! list_of_kinds {
    ($make:ident) => {
        $make! {
            NonwovenTensile("nonwoven_tensile"): spec::nonwoven_tensile::NonwovenTensile,
                "Nonwoven tensile test",
                "A fabric of bonds is pulled until it parts; every strain step is brought to equilibrium.",
                ["nonwoven_tensile", "nonwoven_tensile_quick", "nonwoven_tensile_network",
                    "nonwoven_tensile_repeats", "nonwoven_tensile_directions",
                    "nonwoven_tensile_cycles"];
            GranularScene("granular_scene"): spec::granular_scene::GranularScene,
                "Granular scene",
                "Spheres and clumps between planes and surfaces of triangles, in contact with friction, moved step by step through the stages you give.",
                ["granular_scene", "granular_scene_clump_drop", "granular_scene_breaking_clump",
                    "granular_scene_hopper", "granular_scene_angle_of_repose",
                    "granular_scene_rolling", "granular_scene_bent_rod"];
            Triaxial("triaxial"): spec::soil::SoilTriaxial,
                "Triaxial test",
                "Soil is pressed on all sides and then shortened at constant confining pressure: deviator stress, volume, friction angles at peak and critical state.",
                ["triaxial"];
            DirectShear("direct_shear"): spec::soil::SoilDirectShear,
                "Direct shear test",
                "The halves of a box of soil are moved past each other under a normal stress: shear stress, dilatancy, friction angles.",
                ["direct_shear"];
            BallastOedometer("ballast_oedometer"): spec::ballast::BallastOedometer,
                "Ballast oedometer",
                "Ballast is poured into a cylinder, compacted, and pressed by a plate: stiffness, void ratio, modulus.",
                ["ballast_oedometer"];
            BallastBox("ballast_box"): spec::ballast::BallastBox,
                "Ballast box test",
                "A sleeper on ballast in a box is loaded again and again: settlement by cycle.",
                ["ballast_box"];
            BallastRailbed("ballast_railbed"): spec::ballast::BallastRailbed,
                "Rail bed",
                "Half a cross-section of a track with its sleeper, shoulder and soft ground under the load of a wheel.",
                ["ballast_railbed", "ballast_railbed_cycles", "ballast_railbed_breakable"];
            CompositeBending("composite_bending"): spec::composite_bending::CompositeBending,
                "Composite bending",
                "A section of fibres or plies in a matrix is held and loaded, bent on rollers, pulled or sheared: deflections, moduli, stresses.",
                ["composite_bending", "composite_bending_three_point", "composite_bending_paper",
                    "composite_bending_break", "composite_bending_delaminate", "composite_bending_peel"];
            CompositeCell("composite_cell"): spec::composite_cell::CompositeCell,
                "Composite cell",
                "Fibres in a matrix, seen along them: the elastic constants of the composite, beside the bounds that theory sets.",
                ["composite_cell", "composite_cell_hexagonal"];
            PaperTensile("paper_tensile"): spec::paper_tensile::PaperTensile,
                "Paper tensile test",
                "A sheet of pulp fibres that are bonded where they touch is pulled until it breaks; or one fibre, a hollow tube of springs, is pulled, twisted, bent or pushed until it buckles.",
                ["paper_tensile", "paper_tensile_buckling", "paper_tensile_sheet",
                    "paper_tensile_directions", "paper_tensile_lap", "paper_tensile_zero_span",
                    "paper_tensile_measured", "paper_tensile_yielding", "paper_tensile_tubes", "paper_tensile_dynamics"];
            Calibrate("calibrate"): spec::calibrate::Calibrate,
                "Calibration",
                "Parameters of any other job are fitted to what was measured, with intervals, over the same specimens at every trial.",
                ["calibrate", "calibrate_pet", "calibrate_ballast", "calibrate_paper"];
        }
    };
}

mod kind;
mod spec;

pub use kind::{Example, JobKind, UnknownKind};
pub use spec::JobSpec;
pub(crate) use spec::SpecVisitor;
