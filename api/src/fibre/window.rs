//! Which lengths of a segment the closed form allows, and the one that is taken.
//!
//! With r = l/c and h as in [`Segment::diagonal_part`], k_ST1 = (E A/N l)(1 - h), so that
//!
//! ```text
//! springs along the fibre  > 0   h < 1                      r < √(ν + q E A/(G A_T))
//! springs across, between  ≥ 0   h ≥ ν r/(1 + ν r)
//! springs across, at ends  ≥ 0   h ≥ 2 ν r/(1 + 2 ν r)
//! ```
//!
//! h - m'ν r/(1 + m'ν r) is convex and negative at r² = ν, so that each lower bound is one root, found
//! by bisection to the last bit.
use super::{Elasticity, FibreError, Ring, Section, Segment, Springs};

/// Lengths of a segment [µm] without negative springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Springs across a ring between two segments are not negative from here.
    pub from_between_um: f64,
    /// All springs across are not negative from here.
    pub from_um: f64,
    /// Springs along the fibre are above 0 up to here.
    pub to_um: f64,
}

/// What to do where the closed form has a negative spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnInadmissible {
    /// Take the shortest segment of the window instead.
    Refine,
    /// Refuse.
    Reject,
    /// Keep the segment, give up equation (5), and lower G as far as needed.
    Robust,
}

/// How a fibre is divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Division {
    pub points_on_ring: usize,
    pub ring: Ring,
    /// Wanted length of a segment [µm]; the shortest of the window if not given. That bends most like
    /// the wall: E I is 0.8 to 0.96 of the wall's there on the gyration ring, and goes to 0 with the
    /// springs along the fibre at the other side.
    pub segment_um: Option<f64>,
    pub on_inadmissible: OnInadmissible,
}

/// A fibre's segments and springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Divided {
    pub segments: usize,
    pub segment: Segment,
    pub springs: Springs,
    pub window: Window,
    /// Whether the wanted segment was given up for one from the window.
    pub is_refined: bool,
}

impl Window {
    /// The window for rings of N points on a circle of diameter Φ [µm].
    ///
    /// # Errors
    /// Those of [`Segment::new`].
    pub fn new(
        points_on_ring: usize,
        diameter_um: f64,
        section: &Section,
        elasticity: &Elasticity,
    ) -> Result<Self, FibreError> {
        let nu = elasticity.poisson_ratio();
        let unit = Segment::new(points_on_ring, diameter_um, diameter_um)?;
        let chord = unit.chord_um();
        // h = steepness (r² - ν)
        let steepness = unit.diagonal_part(section, elasticity) / (unit.slenderness().powi(2) - nu);
        let highest = (nu + 1.0 / steepness).sqrt();
        let lowest = |factor: f64| {
            let excess = |r: f64| {
                let across = factor * nu * r;
                steepness * (r * r - nu) - across / (1.0 + across)
            };
            let (mut below, mut above) = (nu.sqrt(), highest);
            loop {
                let middle = 0.5 * (below + above);
                if middle <= below || middle >= above {
                    return above;
                }
                if excess(middle) < 0.0 {
                    below = middle;
                } else {
                    above = middle;
                }
            }
        };
        Ok(Self {
            from_between_um: lowest(1.0) * chord,
            from_um: lowest(2.0) * chord,
            to_um: highest * chord,
        })
    }

    /// Whether a segment [µm] lies in the window.
    pub fn admits(&self, segment_um: f64) -> bool {
        segment_um >= self.from_um && segment_um < self.to_um
    }

    /// Largest number of admissible segments of a fibre [µm].
    fn most_segments(&self, length_um: f64) -> Result<usize, FibreError> {
        let most = (length_um / self.from_um).floor() as usize;
        if most == 0 || !self.admits(length_um / most as f64) {
            return Err(FibreError::NoWholeNumber {
                length_um,
                from_um: self.from_um,
                to_um: self.to_um,
            });
        }
        Ok(most)
    }
}

/// Divides a fibre of this length [µm] into equal segments.
///
/// A wanted length is kept as nearly as a whole number of segments allows. Where that is not
/// admissible, [`OnInadmissible`] decides.
///
/// # Errors
/// Values out of range, [`FibreError::Inadmissible`] (reject), [`FibreError::NoWholeNumber`] (refine),
/// [`FibreError::TooShort`] (robust).
pub fn divide(
    length_um: f64,
    section: &Section,
    elasticity: &Elasticity,
    division: &Division,
) -> Result<Divided, FibreError> {
    if !(length_um.is_finite() && length_um > 0.0) {
        return Err(FibreError::out_of_range(
            "fibre length",
            "µm",
            length_um,
            "above 0",
        ));
    }
    let diameter = section.ring_diameter_um(division.ring)?;
    let points = division.points_on_ring;
    let window = Window::new(points, diameter, section, elasticity)?;
    let of = |segments: usize, is_refined: bool| -> Result<Divided, FibreError> {
        let segment = Segment::new(points, diameter, length_um / segments as f64)?;
        let springs = if window.admits(segment.length_um()) {
            let mut springs = segment.closed_form(section, elasticity);
            // at the very edge of the window round-off may leave less than the 0 that is meant
            springs.across[1] = springs.across[1].max(0.0);
            springs
        } else {
            segment.robust(section, elasticity)?
        };
        Ok(Divided {
            segments,
            segment,
            springs,
            window,
            is_refined,
        })
    };
    let nearest = |segment_um: f64| ((length_um / segment_um).round() as usize).max(1);
    if let Some(wanted) = division.segment_um {
        // refuses what is not a length
        Segment::new(points, diameter, wanted)?;
        let segments = nearest(wanted);
        if window.admits(length_um / segments as f64) {
            return of(segments, false);
        }
        match division.on_inadmissible {
            OnInadmissible::Robust => return of(segments, false),
            OnInadmissible::Reject => {
                return Err(FibreError::Inadmissible {
                    given_um: length_um / segments as f64,
                    from_um: window.from_um,
                    to_um: window.to_um,
                });
            }
            OnInadmissible::Refine => {}
        }
    }
    of(
        window.most_segments(length_um)?,
        division.segment_um.is_some(),
    )
}

/// The same of a fibre of a sheet, which has whatever length it has, or an edge has left it: where no whole number of
/// admissible segments makes it up, it gets as few as are short enough, in the robust form. Segments that are too short
/// keep E, ν and G.
///
/// [`OnInadmissible::Reject`] asks of the wanted length of a segment that it is admissible itself, not of what a whole
/// number makes of it.
///
/// # Errors
/// Values out of range, [`FibreError::Inadmissible`] (reject), [`FibreError::TooShort`] where the whole fibre is shorter than
/// a segment can be.
pub fn divide_piece(
    length_um: f64,
    section: &Section,
    elasticity: &Elasticity,
    division: &Division,
) -> Result<Divided, FibreError> {
    let mut own = *division;
    if let (OnInadmissible::Reject, Some(wanted)) = (division.on_inadmissible, division.segment_um)
    {
        let diameter = section.ring_diameter_um(division.ring)?;
        let window = Window::new(division.points_on_ring, diameter, section, elasticity)?;
        if !window.admits(wanted) {
            return Err(FibreError::Inadmissible {
                given_um: wanted,
                from_um: window.from_um,
                to_um: window.to_um,
            });
        }
        own.on_inadmissible = OnInadmissible::Refine;
    }
    match divide(length_um, section, elasticity, &own) {
        Err(FibreError::NoWholeNumber { to_um, .. }) => {
            own.on_inadmissible = OnInadmissible::Robust;
            let mut segments = (length_um / to_um).ceil();
            loop {
                own.segment_um = Some(length_um / segments);
                match divide(length_um, section, elasticity, &own) {
                    Err(FibreError::TooShort { .. }) if segments > 1.0 => segments -= 1.0,
                    divided => return divided,
                }
            }
        }
        divided => divided,
    }
}
