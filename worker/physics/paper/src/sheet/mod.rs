//! Fibres laid down to a sheet, and where they touch.
//!
//! A [`SheetPlan`] says what pulps, how much of them and how they are laid; [`SheetPlan::lay`] gives
//! the [`Sheet`]: centre lines of fibres, cut at the sheet's edges, and the contacts between them.
//! [`contacts()`] finds those of centre lines that came from elsewhere. [`Statistics`] are measured on
//! any sheet, and [`Sheet::strip`], [`Sheet::turned`] and [`Sheet::coarsened`] prepare one for a test.
//!
//! In this order: a `pulp` gives sizes, `orientation` an angle, `curl` an arc; the arc is put
//! somewhere around the sheet and what lies inside is kept (`polyline`); `deposition` lets it settle on
//! the fibres below; `lay` counts the mass; `contacts` finds who touches whom.
//!
//! The room knows no mechanics: what a contact carries, and whether it is bonded, is said elsewhere.
mod contacts;
mod curl;
mod deposition;
mod error;
mod lay;
mod orientation;
mod plan;
mod polyline;
mod pulp;
mod raster;
mod statistics;
mod strip;
#[cfg(test)]
mod tests;

pub use contacts::contacts;
pub use curl::half_angle;
pub use error::SheetError;
pub use orientation::Orientation;
pub use plan::{Expected, Placement, SheetPlan};
pub use pulp::{FibreSection, LengthDistribution, Lumen, MeasuredFibre, Pulp, wall_area_um2};
pub use statistics::{Histogram, Statistics};

/// Fibres in the rectangle 0 ≤ x ≤ size, 0 ≤ y ≤ size, and their contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Length along x, the pulling direction, and width along y [µm].
    pub size_um: [f64; 2],
    /// In the order in which they were laid.
    pub fibres: Vec<SheetFibre>,
    /// By the first fibre, then the second, then the place on the first.
    pub contacts: Vec<Contact>,
}

/// One fibre, or one piece of a fibre that the sheet's edges cut in several.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetFibre {
    /// Place of its pulp in the plan.
    pub pulp: usize,
    pub section: FibreSection,
    /// At least two points [µm]; where the sheet's edge cuts it, exactly on the edge.
    pub centre_line_um: Vec<[f64; 3]>,
}

/// A region where two fibres touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The lower number first.
    pub fibres: [u32; 2],
    /// Arc lengths [µm] from each fibre's start.
    pub at_um: [f64; 2],
    /// Area [µm²] that both fibres cover, seen from above.
    pub area_um2: f64,
}

impl SheetFibre {
    /// Length of the centre line [µm].
    pub fn length_um(&self) -> f64 {
        polyline::length(&self.centre_line_um)
    }

    /// Mass [µg].
    pub fn mass_ug(&self) -> f64 {
        self.section.coarseness_ug_per_um * self.length_um()
    }
}

impl Sheet {
    /// Area of the sheet [µm²].
    pub fn area_um2(&self) -> f64 {
        self.size_um[0] * self.size_um[1]
    }
}
