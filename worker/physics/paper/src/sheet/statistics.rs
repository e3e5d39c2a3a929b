//! What a sheet measures.
use std::f64::consts::PI;

use super::Sheet;
use super::raster::Raster;

/// Most pixels of a measurement: a sheet of 10 mm by 15 mm has pixels of 6 µm, a larger one coarser.
const MOST_PIXELS: f64 = 4e6;
/// Share of the surface that stands above (and below) the planes between which the peaks' thickness is
/// measured: the very highest peak says more about the sheet's size than about the sheet.
const PEAKS: f64 = 0.01;
/// 1 µg/µm³ in kg/m³.
const KG_PER_M3: f64 = 1e9;

/// Measures of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Length of all fibres [µm].
    pub fibre_length_um: f64,
    /// Mass per area [µg/µm²].
    pub grammage_ug_per_um2: f64,
    /// Fibre layers over a point of the sheet, on average [-]: area of all fibres seen from above,
    /// width times projected length, over that of the sheet.
    pub coverage: f64,
    /// Share of the area that at least one fibre covers [-]; 1 − exp(−coverage) when fibres lie at
    /// random.
    pub covered_share: f64,
    /// Distance [µm] between the highest and the lowest fibre surface over a point, on average over
    /// the whole area, nothing where there is no fibre.
    pub mean_thickness_um: f64,
    /// Distance [µm] of two planes, one above and one below the sheet, that one per cent of its
    /// surfaces each reach beyond. What a gauge with hard platens reads lies between the mean and
    /// this, since it presses peaks down.
    pub peak_thickness_um: f64,
    /// Grammage over mean thickness [kg/m³].
    pub apparent_density_kg_per_m3: f64,
    /// Contacts on a fibre, on average; every contact is on two.
    pub contacts_per_fibre: f64,
    /// Area of all contacts over that of one side of all fibres, width times length [-]: a contact
    /// bonds its area on two fibres, and each has two sides. May exceed 1 where fibres go through one
    /// another.
    pub relative_bonded_area: f64,
    /// Length [µm] between neighbouring contacts of a fibre, on average; nothing when no fibre has
    /// two.
    pub free_length_um: Option<f64>,
    /// Mean fibre length [µm], every piece counting once.
    pub mean_length_um: f64,
    /// Mean fibre width [µm] weighted by length.
    pub mean_width_um: f64,
    /// Mean fibre length [µm] weighted by length.
    pub length_weighted_um: f64,
    /// Lengths from 0 to the longest.
    pub lengths_um: Histogram,
    /// Angles [rad] of segments to x, from 0 to π.
    pub angles_rad: Histogram,
    /// ⟨cos 2θ⟩ over the length of the fibres [-]: 0 without a direction, 1 all along x.
    pub anisotropy: f64,
}

/// Shares in equally wide bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Bins lie between 0 and this.
    pub upper: f64,
    /// Share of the number, of fibres or segments [-].
    pub by_number: Vec<f64>,
    /// Share of the length [-].
    pub by_length: Vec<f64>,
}

impl Histogram {
    fn new(upper: f64, bins: usize, values: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut by_number = vec![0.0; bins];
        let mut by_length = vec![0.0; bins];
        for (value, length) in values {
            let bin = ((value / upper * bins as f64) as usize).min(bins - 1);
            by_number[bin] += 1.0;
            by_length[bin] += length;
        }
        for shares in [&mut by_number, &mut by_length] {
            let sum: f64 = shares.iter().sum();
            shares.iter_mut().for_each(|share| *share /= sum);
        }
        Self {
            upper,
            by_number,
            by_length,
        }
    }
}

impl Statistics {
    /// Measures a sheet with at least one fibre, with histograms of so many bins; nothing of one
    /// without.
    pub fn of(sheet: &Sheet, bins: usize) -> Option<Self> {
        if sheet.fibres.is_empty() || bins == 0 {
            return None;
        }
        let area = sheet.area_um2();
        let lengths: Vec<f64> = sheet.fibres.iter().map(|fibre| fibre.length_um()).collect();
        let total: f64 = lengths.iter().sum();
        let fibres = || sheet.fibres.iter().zip(&lengths);
        let mass: f64 = fibres()
            .map(|(fibre, length)| fibre.section.coarseness_ug_per_um * length)
            .sum();
        let one_side: f64 = fibres()
            .map(|(fibre, length)| fibre.section.width_um * length)
            .sum();
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let segments = || {
            let windows = sheet.fibres.iter().flat_map(|fibre| {
                let width = fibre.section.width_um;
                fibre
                    .centre_line_um
                    .windows(2)
                    .map(move |ends| (ends, width))
            });
            windows.map(|(ends, width)| {
                let [x, y] = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
                (x, y, x.hypot(y), width)
            })
        };
        let projected: f64 = segments().map(|(_, _, length, _)| length).sum();
        let seen: f64 = segments().map(|(_, _, length, width)| length * width).sum();
        let aligned: f64 = segments()
            .filter(|(_, _, length, _)| *length > 0.0)
            .map(|(x, y, length, _)| (x * x - y * y) / length)
            .sum();
        let surfaces = Surfaces::of(sheet);
        let thickness = surfaces.mean_thickness_um();
        let grammage = mass / area;
        Some(Self {
            fibre_length_um: total,
            grammage_ug_per_um2: grammage,
            coverage: seen / area,
            covered_share: surfaces.covered_share(),
            mean_thickness_um: thickness,
            peak_thickness_um: surfaces.peak_thickness_um(),
            apparent_density_kg_per_m3: grammage / thickness * KG_PER_M3,
            contacts_per_fibre: 2.0 * sheet.contacts.len() as f64 / lengths.len() as f64,
            // an empty sum of floats is -0
            relative_bonded_area: sheet
                .contacts
                .iter()
                .fold(0.0, |sum, contact| sum + contact.area_um2)
                / one_side,
            free_length_um: free_length(sheet),
            mean_length_um: total / lengths.len() as f64,
            mean_width_um: one_side / total,
            length_weighted_um: lengths.iter().map(|length| length * length).sum::<f64>() / total,
            lengths_um: Histogram::new(
                longest,
                bins,
                lengths.iter().map(|length| (*length, *length)),
            ),
            angles_rad: Histogram::new(
                PI,
                bins,
                segments().map(|(x, y, length, _)| (y.atan2(x).rem_euclid(PI), length)),
            ),
            anisotropy: aligned / projected,
        })
    }
}

/// Mean distance of neighbouring contacts on their fibres [µm].
fn free_length(sheet: &Sheet) -> Option<f64> {
    let mut places: Vec<(u32, f64)> = sheet
        .contacts
        .iter()
        .flat_map(|contact| [0, 1].map(|side| (contact.fibres[side], contact.at_um[side])))
        .collect();
    places.sort_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
    let neighbours = places.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let (count, sum) = neighbours.fold((0_u32, 0.0), |(count, sum), pair| {
        (count + 1, sum + (pair[1].1 - pair[0].1))
    });
    (count > 0).then(|| sum / f64::from(count))
}

/// Upper and lower surface of a sheet in pixels.
struct Surfaces {
    pixels: usize,
    /// Of covered pixels [µm].
    tops_um: Vec<f64>,
    bottoms_um: Vec<f64>,
}

impl Surfaces {
    fn of(sheet: &Sheet) -> Self {
        let widths = sheet.fibres.iter().map(|fibre| fibre.section.width_um);
        let narrowest = widths.fold(f64::INFINITY, f64::min);
        let pixel = (0.25 * narrowest).max((sheet.area_um2() / MOST_PIXELS).sqrt());
        let raster = Raster::new(sheet.size_um, pixel);
        let mut tops = vec![f64::NEG_INFINITY; raster.pixels()];
        let mut bottoms = vec![f64::INFINITY; raster.pixels()];
        for fibre in &sheet.fibres {
            let half = 0.5 * fibre.section.thickness_um;
            raster.under(&fibre.centre_line_um, fibre.section.width_um, |under| {
                tops[under.pixel] = tops[under.pixel].max(under.height_um + half);
                bottoms[under.pixel] = bottoms[under.pixel].min(under.height_um - half);
            });
        }
        tops.retain(|top| top.is_finite());
        bottoms.retain(|bottom| bottom.is_finite());
        Self {
            pixels: raster.pixels(),
            tops_um: tops,
            bottoms_um: bottoms,
        }
    }

    fn covered_share(&self) -> f64 {
        self.tops_um.len() as f64 / self.pixels as f64
    }

    fn mean_thickness_um(&self) -> f64 {
        let sum = |heights: &[f64]| heights.iter().sum::<f64>();
        (sum(&self.tops_um) - sum(&self.bottoms_um)) / self.pixels as f64
    }

    fn peak_thickness_um(&self) -> f64 {
        let quantile = |heights: &[f64], share: f64| {
            let mut heights = heights.to_vec();
            let index = (share * (heights.len() - 1) as f64).round() as usize;
            *heights.select_nth_unstable_by(index, f64::total_cmp).1
        };
        quantile(&self.tops_um, 1.0 - PEAKS) - quantile(&self.bottoms_um, PEAKS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sheet::{Contact, FibreSection, SheetFibre};

    /// Two fibres of 20 µm by 6 µm cross on 200 µm by 100 µm: one along x of 200 µm, one along y of
    /// 100 µm that lies on it.
    #[test]
    fn two_crossing_fibres_by_hand() {
        let fibre = |ends: [[f64; 3]; 2]| SheetFibre {
            pulp: 0,
            section: FibreSection {
                width_um: 20.0,
                wall_um: 2.0,
                thickness_um: 6.0,
                coarseness_ug_per_um: 2e-4,
            },
            centre_line_um: ends.to_vec(),
        };
        let sheet = Sheet {
            size_um: [200.0, 100.0],
            fibres: vec![
                fibre([[0.0, 50.0, 3.0], [200.0, 50.0, 3.0]]),
                fibre([[90.0, 0.0, 9.0], [90.0, 100.0, 9.0]]),
            ],
            contacts: [40.0, 70.0]
                .map(|at| Contact {
                    fibres: [0, 1],
                    at_um: [at, 0.5 * at],
                    area_um2: 400.0,
                })
                .into(),
        };
        let row = Statistics::of(&sheet, 4).expect("there are fibres");
        let assert_close = |one: f64, other: f64| {
            assert!(
                (one - other).abs() < 1e-12 * other.abs().max(1.0),
                "{one} {other}"
            );
        };
        assert_close(row.fibre_length_um, 300.0);
        assert_close(row.grammage_ug_per_um2 / (300.0 * 2e-4 / 2e4), 1.0);
        assert_close(row.coverage, 300.0 * 20.0 / 2e4);
        // 20 · 200 + 20 · 100 less the 20 · 20 that both cover
        assert_close(row.covered_share, 5600.0 / 2e4);
        // 3600 and 1600 of one fibre, 400 of both
        assert_close(row.mean_thickness_um, (5200.0 * 6.0 + 400.0 * 12.0) / 2e4);
        assert_close(row.peak_thickness_um, 12.0);
        assert_close(row.contacts_per_fibre, 2.0);
        assert_close(row.relative_bonded_area, 800.0 / (300.0 * 20.0));
        assert_close(
            row.free_length_um.expect("two contacts"),
            0.5 * (30.0 + 15.0),
        );
        assert_close(row.mean_length_um, 150.0);
        assert_close(row.mean_width_um, 20.0);
        assert_close(
            row.length_weighted_um,
            (200.0 * 200.0 + 100.0 * 100.0) / 300.0,
        );
        assert_close(row.anisotropy, (200.0 - 100.0) / 300.0);
        assert_eq!(row.lengths_um.by_number, [0.0, 0.0, 0.5, 0.5]);
        assert_close(row.lengths_um.by_length[2], 1.0 / 3.0);
        assert_close(row.angles_rad.by_length[0], 2.0 / 3.0);
        assert_close(row.angles_rad.by_length[2], 1.0 / 3.0);
    }
}
