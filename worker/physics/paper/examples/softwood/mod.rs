//! The sheet of softwood that the examples lay.
use loadframe_paper::sheet::{LengthDistribution, Lumen, Orientation, Placement, Pulp, SheetPlan};

pub(crate) const WIDTH_UM: f64 = 28.0;
pub(crate) const WALL_UM: f64 = 2.0;

/// What differs between sheets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Softwood {
    pub(crate) grammage_g_per_m2: f64,
    pub(crate) coarseness_mg_per_m: f64,
    pub(crate) shape_factor: f64,
    pub(crate) flexibility: f64,
}

impl Softwood {
    /// A sheet of this length and width, by deposition.
    pub(crate) fn plan(&self, size_um: [f64; 2]) -> SheetPlan {
        SheetPlan {
            size_um,
            grammage_ug_per_um2: self.grammage_g_per_m2 * 1e-6,
            pulps: vec![Pulp {
                mass_fraction: 1.0,
                length: LengthDistribution::LogNormal {
                    mean_um: 2000.0,
                    variation: 0.4,
                },
                width_um: WIDTH_UM,
                wall_um: WALL_UM,
                coarseness_ug_per_um: 1e-3 * self.coarseness_mg_per_m,
                shape_factor: self.shape_factor,
                lumen: Lumen::Collapsed,
            }],
            orientation: Orientation::Uniform,
            placement: Placement::Deposition {
                flexibility: self.flexibility,
            },
            segment_um: None,
            gap_um: None,
        }
    }
}
