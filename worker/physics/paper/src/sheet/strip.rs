//! Sheets made from a sheet: cut out, turned, with fewer points.
use super::error::{SheetError, check};
use super::polyline::{self, Piece};
use super::{Contact, Sheet, SheetFibre};

impl Sheet {
    /// The strip of a size [µm] whose lower left corner lies at `corner_um` of this sheet; that corner
    /// is its origin. Fibres are cut at its edges, exactly on them; pieces shorter than they are wide
    /// are left out, and of the contacts those between pieces that are left remain.
    ///
    /// # Errors
    /// When the strip is not within the sheet or has no area.
    pub fn strip(&self, corner_um: [f64; 2], size_um: [f64; 2]) -> Result<Self, SheetError> {
        for (axis, name) in ["x", "y"].iter().enumerate() {
            let (corner, size, whole) = (corner_um[axis], size_um[axis], self.size_um[axis]);
            let is_inside = (0.0..whole).contains(&corner);
            let allowed = format!("from 0 to the sheet's {whole} um");
            check(
                is_inside,
                format!("{name} of the strip"),
                corner,
                "um",
                allowed,
            )?;
            // a strip as long as the sheet may be written in another unit
            let most = whole - corner;
            let is_size = size > 0.0 && size <= most * (1.0 + 1e-12);
            let allowed = format!("above 0, up to the {most} um that are left of the sheet");
            check(
                is_size,
                format!("size of the strip along {name}"),
                size,
                "um",
                allowed,
            )?;
        }
        let mut fibres = Vec::new();
        // for every fibre its pieces in the strip, and the number of the first of them
        let mut pieces: Vec<(usize, Vec<Piece>)> = Vec::with_capacity(self.fibres.len());
        for fibre in &self.fibres {
            let moved: Vec<[f64; 3]> = fibre
                .centre_line_um
                .iter()
                .map(|[x, y, z]| [x - corner_um[0], y - corner_um[1], *z])
                .collect();
            let mut kept = polyline::cut(&moved, size_um);
            kept.retain(|piece| polyline::length(&piece.points) >= fibre.section.width_um);
            let first = fibres.len();
            fibres.extend(kept.iter().map(|piece| SheetFibre {
                centre_line_um: piece.points.clone(),
                ..*fibre
            }));
            pieces.push((first, kept));
        }
        let on_piece = |fibre: u32, at_um: f64| {
            let (first, pieces) = &pieces[fibre as usize];
            let has = |piece: &Piece| (piece.span_um[0]..=piece.span_um[1]).contains(&at_um);
            let index = pieces.iter().position(has)?;
            let piece = &pieces[index];
            let length = polyline::length(&piece.points);
            let at = (at_um - piece.span_um[0]).min(length);
            Some(((first + index) as u32, at))
        };
        let contacts = self.contacts.iter().filter_map(|contact| {
            let [one, other] = contact.fibres;
            let one = on_piece(one, contact.at_um[0])?;
            let other = on_piece(other, contact.at_um[1])?;
            Some(Contact {
                fibres: [one.0, other.0],
                at_um: [one.1, other.1],
                area_um2: contact.area_um2,
            })
        });
        let mut contacts: Vec<Contact> = contacts.collect();
        contacts.sort_by_key(|contact| contact.fibres);
        Ok(Self {
            size_um,
            fibres,
            contacts,
        })
    }

    /// A quarter turn: what ran along y, across the machine, runs along x, the pulling direction.
    pub fn turned(&self) -> Self {
        let mut sheet = self.clone();
        sheet.size_um = [self.size_um[1], self.size_um[0]];
        for fibre in &mut sheet.fibres {
            for point in &mut fibre.centre_line_um {
                let [x, y, z] = *point;
                *point = [y, self.size_um[0] - x, z];
            }
        }
        sheet
    }

    /// The same sheet with centre lines of segments of about one length [µm], for models that pay for
    /// every point. Points lie on the lines they replace, contacts at the same share of their segment;
    /// areas and the fibres' mass per length are left. Lines are shorter by what their segments cut off
    /// of waves and curls, so that masses and lengths are to be measured before.
    ///
    /// # Errors
    /// When the length is not above 0.
    pub fn coarsened(&self, segment_um: f64) -> Result<Self, SheetError> {
        let is_length = segment_um > 0.0 && segment_um.is_finite();
        check(is_length, "segment", segment_um, "um", "above 0")?;
        let coarse: Vec<Coarse> = self
            .fibres
            .iter()
            .map(|fibre| Coarse::new(&fibre.centre_line_um, segment_um))
            .collect();
        let contacts = self.contacts.iter().map(|contact| {
            let at = |side: usize| {
                let fibre = &coarse[contact.fibres[side] as usize];
                fibre.arc_at(contact.at_um[side])
            };
            Contact {
                at_um: [at(0), at(1)],
                ..*contact
            }
        });
        let contacts = contacts.collect();
        let fibres = self.fibres.iter().zip(coarse);
        Ok(Self {
            size_um: self.size_um,
            fibres: fibres
                .map(|(fibre, coarse)| SheetFibre {
                    centre_line_um: coarse.points,
                    ..*fibre
                })
                .collect(),
            contacts,
        })
    }
}

/// A line of equal parts of another.
struct Coarse {
    points: Vec<[f64; 3]>,
    arcs: Vec<f64>,
    /// Length of the line it replaces.
    whole_um: f64,
}

impl Coarse {
    fn new(line: &[[f64; 3]], segment_um: f64) -> Self {
        let arcs = polyline::arc_lengths(line);
        let whole_um = arcs[arcs.len() - 1];
        let count = ((whole_um / segment_um).ceil() as usize).clamp(1, line.len().max(2) - 1);
        let mut points = vec![line[0]];
        for index in 1..count {
            let arc = whole_um * index as f64 / count as f64;
            let end = arcs.partition_point(|&before| before < arc).max(1);
            let share = (arc - arcs[end - 1]) / (arcs[end] - arcs[end - 1]);
            points.push(polyline::between(line[end - 1], line[end], share));
        }
        points.push(line[line.len() - 1]);
        let arcs = polyline::arc_lengths(&points);
        Self {
            points,
            arcs,
            whole_um,
        }
    }

    /// The arc length of what was at `at_um` of the line it replaces.
    fn arc_at(&self, at_um: f64) -> f64 {
        let segments = self.points.len() - 1;
        let place = (at_um / self.whole_um).clamp(0.0, 1.0) * segments as f64;
        let segment = (place as usize).min(segments - 1);
        let [from, to] = [self.arcs[segment], self.arcs[segment + 1]];
        from + (place - segment as f64) * (to - from)
    }
}
