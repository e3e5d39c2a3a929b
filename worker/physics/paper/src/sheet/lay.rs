//! Fibres laid one after the other until the sheet has its mass.
use loadframe_harness::rng::{Purpose, Streams};
use loadframe_harness::{InterruptSource, Uninterrupted};
use loadframe_numerics::Team;
use rand::RngExt as _;

use super::deposition::Bed;
use super::error::SheetError;
use super::plan::{Placement, SheetPlan};
use super::polyline::{self, Piece};
use super::pulp::{FibreSize, Pulp};
use super::{Sheet, SheetFibre, contacts, curl};

/// Streams of a pulp are this far from those of the next.
const STREAMS_PER_PULP: usize = 1 << 40;
/// Fibres of a pulp that are drawn between two looks for a cancel: far less than a second of work.
const DRAWN_BETWEEN_LOOKS: usize = 256;

impl SheetPlan {
    /// Lays the sheet of a seed; the same on any number of threads.
    ///
    /// Middles of fibres are uniform in a rectangle that is larger than the sheet by half the
    /// longest fibre on every side, and what lies in the sheet is kept: it is then as dense at its
    /// edges as anywhere. Pieces shorter than a fibre is wide are left out, they have no room for a
    /// contact. Of several pulps the one that is furthest behind comes next, so that they are mixed
    /// through the thickness; the last fibre of each is cut to what is missing of its mass.
    ///
    /// Fibres are numbered along the sheet, by where they have their middle.
    ///
    /// A fibre on a slope is longer than its projection. What it gains is cut from its free ends, so
    /// that lengths are those that were drawn.
    ///
    /// # Errors
    /// See [`SheetError`].
    pub fn lay(&self, seed: u64, team: &Team) -> Result<Sheet, SheetError> {
        self.lay_unless(seed, team, &Uninterrupted)
    }

    /// The same, given up at a cancel.
    ///
    /// # Errors
    /// [`SheetError::GivenUp`]; as [`Self::lay`].
    pub fn lay_unless(
        &self,
        seed: u64,
        team: &Team,
        interrupt: &dyn InterruptSource,
    ) -> Result<Sheet, SheetError> {
        self.validate()?;
        let mut fibres = self.lay_fibres(seed, interrupt)?;
        fibres.shrink_to_fit();
        // bonds then join what is near one another in memory, too: of 36 000 fibres as a truss an iteration takes a
        // tenth less time
        fibres.sort_by(|a, b| middle_um(a).total_cmp(&middle_um(b)));
        if interrupt.is_cancelled() {
            return Err(SheetError::GivenUp);
        }
        let contacts = contacts(&fibres, self.gap(), team);
        Ok(Sheet {
            size_um: self.size_um,
            fibres,
            contacts,
        })
    }

    /// Its fibres, one after the other.
    pub(super) fn lay_fibres(
        &self,
        seed: u64,
        interrupt: &dyn InterruptSource,
    ) -> Result<Vec<SheetFibre>, SheetError> {
        let area = self.size_um[0] * self.size_um[1];
        let sources = self.pulps.iter().enumerate().map(|(index, pulp)| {
            let source = Source::new(pulp, index, self.grammage_ug_per_um2 * area);
            let length_um = source.target_ug / pulp.coarseness_ug_per_um;
            // the last piece of a pulp has to be as long as it is wide
            if length_um < source.widest_um {
                return Err(SheetError::TooLittle {
                    pulp: index,
                    length_um,
                    width_um: source.widest_um,
                });
            }
            Ok(source)
        });
        let mut sources: Vec<Source<'_>> = sources.collect::<Result<_, _>>()?;
        let draws = Draws::new(self, seed);
        let mut bed = match self.placement {
            Placement::Random3d { .. } => None,
            Placement::Deposition { flexibility } => {
                Some(Bed::new(self.size_um, self.segment(), flexibility))
            }
        };
        let mut fibres = Vec::new();
        while let Some(source) = furthest_behind(&mut sources) {
            // a suspended one would never come further; most fibres may fall beside a small sheet
            if source.drawn % DRAWN_BETWEEN_LOOKS == 0 && interrupt.is_cancelled() {
                return Err(SheetError::GivenUp);
            }
            let size = source.pulp.draw(&mut draws.sizes.of(source.stream()));
            let pieces = draws.place(source, size);
            source.drawn += 1;
            for piece in pieces {
                if source.is_complete {
                    break;
                }
                let Some((points, is_last)) = settled(piece, size, source, bed.as_mut()) else {
                    continue;
                };
                if let Some(bed) = &mut bed {
                    bed.cover(&points, size.section);
                }
                let fibre = SheetFibre {
                    pulp: source.index,
                    section: size.section,
                    centre_line_um: points,
                };
                source.laid_ug += fibre.mass_ug();
                source.is_complete = is_last;
                fibres.push(fibre);
            }
        }
        Ok(fibres)
    }
}

/// Where along the sheet a fibre has its middle [µm].
fn middle_um(fibre: &SheetFibre) -> f64 {
    let line = &fibre.centre_line_um;
    line[line.len() / 2][0]
}

/// A pulp and how much of it lies in the sheet.
struct Source<'a> {
    pulp: &'a Pulp,
    index: usize,
    longest_um: f64,
    widest_um: f64,
    target_ug: f64,
    laid_ug: f64,
    /// Fibres drawn, in the sheet or beside it.
    drawn: usize,
    /// Its last piece was cut to what was missing.
    is_complete: bool,
}

impl<'a> Source<'a> {
    fn new(pulp: &'a Pulp, index: usize, sheet_ug: f64) -> Self {
        Self {
            pulp,
            index,
            longest_um: pulp.longest_um(),
            widest_um: pulp.widest_um(),
            target_ug: pulp.mass_fraction * sheet_ug,
            laid_ug: 0.0,
            drawn: 0,
            is_complete: false,
        }
    }

    fn stream(&self) -> usize {
        self.index * STREAMS_PER_PULP + self.drawn
    }
}

/// The pulp of which the least share is laid; nothing when all have their mass.
fn furthest_behind<'a, 'b>(sources: &'b mut [Source<'a>]) -> Option<&'b mut Source<'a>> {
    let share = |source: &Source<'_>| source.laid_ug / source.target_ug;
    let missing = sources.iter_mut().filter(|source| !source.is_complete);
    missing.min_by(|one, other| share(one).total_cmp(&share(other)))
}

/// Random places of fibres.
struct Draws<'a> {
    plan: &'a SheetPlan,
    sizes: Streams,
    places: Streams,
}

impl<'a> Draws<'a> {
    fn new(plan: &'a SheetPlan, seed: u64) -> Self {
        Self {
            plan,
            sizes: Streams::new(seed, Purpose::FibreSizes),
            places: Streams::new(seed, Purpose::FibrePlaces),
        }
    }

    /// What lies in the sheet of the next fibre of a pulp.
    fn place(&self, source: &Source<'_>, size: FibreSize) -> Vec<Piece> {
        let mut random = self.places.of(source.stream());
        let margin = 0.5 * source.longest_um;
        let middle = self
            .plan
            .size_um
            .map(|side| (side + 2.0 * margin) * random.random::<f64>() - margin);
        let height = random.random::<f64>();
        let side = if random.random::<bool>() { 1.0 } else { -1.0 };
        // no point of a fibre is further from its middle than half its length
        let reach = 0.5 * size.length_um;
        let is_near =
            |axis: usize| middle[axis] > -reach && middle[axis] < self.plan.size_um[axis] + reach;
        if !(is_near(0) && is_near(1)) {
            return Vec::new();
        }
        let (sine, cosine) = self.plan.orientation.draw(&mut random).sin_cos();
        let z = match self.plan.placement {
            Placement::Deposition { .. } => 0.0,
            Placement::Random3d { thickness_um } => {
                let thickness = size.section.thickness_um;
                0.5 * thickness + height * (thickness_um - thickness)
            }
        };
        let segments = (size.length_um / self.plan.segment()).ceil().max(1.0) as usize;
        let arc = curl::arc(size.length_um, size.shape_factor, segments);
        let points: Vec<[f64; 3]> = arc
            .iter()
            .map(|&[x, y]| {
                let y = side * y;
                [
                    middle[0] + cosine * x - sine * y,
                    middle[1] + sine * x + cosine * y,
                    z,
                ]
            })
            .collect();
        polyline::cut(&points, self.plan.size_um)
    }
}

/// The centre line of a piece in its last place and length, and whether its pulp then has its mass;
/// nothing of one too short.
fn settled(
    piece: Piece,
    size: FibreSize,
    source: &Source<'_>,
    bed: Option<&mut Bed>,
) -> Option<(Vec<[f64; 3]>, bool)> {
    let shortest = size.section.width_um;
    let flat = polyline::length(&piece.points);
    if flat < shortest {
        return None;
    }
    let mut points = piece.points;
    if let Some(bed) = bed {
        bed.settle(&mut points, size.section);
        let gain = polyline::length(&points) - flat;
        points = match piece.is_cut {
            [false, false] => polyline::part(&points, 0.5 * gain, 0.5 * gain + flat),
            [true, false] => polyline::part(&points, 0.0, flat),
            [false, true] => polyline::part(&points, gain, gain + flat),
            // what climbs between two edges is there
            [true, true] => points,
        };
    }
    let missing = (source.target_ug - source.laid_ug) / size.section.coarseness_ug_per_um;
    let length = polyline::length(&points);
    // either with room for another piece, or all that is missing
    let is_last = length >= missing;
    let kept = if is_last {
        missing
    } else {
        length.min(missing - source.widest_um)
    };
    // what the piece before left for this one is as long as a width but for rounding
    let is_room = kept >= shortest * (1.0 - 1e-9);
    is_room.then(|| (polyline::shortened(points, kept), is_last))
}
